#!/usr/bin/python3
"""Judges a corrected program without a line of the product's code.

Both programs are interpreted by LinuxCNC's own interpreter; the corrected one then goes through a small
forward model of the machine, and the path that the tool takes is compared with the path that the
original programs. Prints JSON. Exit status: 0 the correction holds, 1 it does not, 2 usage or input,
3 the interpreter is not installed.
"""

import argparse
import json
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from interpreter import Unreadable, interpret  # noqa: E402
from machine import Machine, OutsideVolume  # noqa: E402

# How far along the path a sample may be from where its way so far puts it, mm.
SLACK_MM = 0.7
# Weight of that distance when the path passes the same place twice.
ORDER_WEIGHT = 1e-5
# Share by which the time of a stretch of feed moves may change, and what a correction may add per move.
TIME_SHARE, TIME_PER_MOVE_MM = 0.005, 0.02
# The longest approach to a corrected start.
APPROACH_MM = 1.0
# An axis that stands differs by no more between start and end of a move.
LAST_BITS_MM = 1e-6
# A cycle goes to its hole at the level above it with the correction of the hole itself; the end of a rapid that
# another rapid follows may be off by what the machine leans over that height (30 mm at 1 mrad).
ON_THE_WAY_UM = 30.0


def distance(a, b):
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


def length(move):
    return move.arc.length if move.arc else distance(move.start, move.end)


def point(move, t):
    """Point of a move at a share of its way."""
    if move.arc:
        return move.arc.at(t) if t < 1.0 else move.end
    a, b = move.start, move.end
    return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]))


def descend(arc, p, t, low, high):
    """Share of the way where the distance to p is least near t: Newton's rule on its square, safe steps only."""
    u, v, w = arc.axes
    growth, rise = arc.radii[1] - arc.radii[0], arc.heights[1] - arc.heights[0]
    for _ in range(6):
        q = arc.at(t)
        radius = arc.radii[0] + t * growth
        ru, rv = (q[u] - arc.centre[0]) / radius, (q[v] - arc.centre[1]) / radius
        du, dv = growth * ru - arc.sweep * radius * rv, growth * rv + arc.sweep * radius * ru
        # The pull along the path, and how it changes: the path's own speed less its bend towards p.
        pull = (p[u] - q[u]) * du + (p[v] - q[v]) * dv + (p[w] - q[w]) * rise
        speed = du * du + dv * dv + rise * rise
        bend = -arc.sweep * arc.sweep * radius * ((p[u] - q[u]) * ru + (p[v] - q[v]) * rv)
        step = pull / max(speed - bend, 0.25 * speed)
        t = min(max(t + step, low), high)
        if abs(step) < 1e-12:
            break
    return t


def nearest(move, p, low, high):
    """Share of the way, from `low` to `high`, of the move's point nearest to p."""
    if move.arc:
        arc = move.arc
        u, v, _ = arc.axes
        angle = math.atan2(p[v] - arc.centre[1], p[u] - arc.centre[0]) - arc.angle
        turn = 2.0 * math.pi
        angle += turn * round((0.5 * (low + high) * arc.sweep - angle) / turn)
        options = [min(max((angle + k * turn) / arc.sweep, low), high) for k in (-1, 0, 1)]
        if arc.heights[0] != arc.heights[1]:
            # On a helix the nearest point is neither at the same angle nor at the same height.
            height = (p[arc.axes[2]] - arc.heights[0]) / (arc.heights[1] - arc.heights[0])
            options += [min(max(height, low), high)]
            options = [descend(arc, p, t, low, high) for t in options]
        return min(options, key=lambda t: distance(point(move, t), p))
    a, b = move.start, move.end
    d = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    if square == 0.0:
        return 1.0
    t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1] + (p[2] - a[2]) * d[2]) / square
    return min(max(t, low), high)


def runs(moves):
    """Stretches of rapids and stretches of feed moves, in turn."""
    out = []
    for index, move in enumerate(moves):
        kind = "exempt" if move.exempt else "rapid" if move.rapid else "feed"
        if not out or out[-1][0] != kind:
            out.append((kind, []))
        out[-1][1].append(index)
    return out


class Path:
    """A stretch of feed moves as the path to be kept, with the way along it."""

    def __init__(self, moves, shift):
        self.moves, self.shift = moves, shift
        self.lengths = [length(move) for move in moves]
        self.ways = [0.0]
        for one in self.lengths:
            self.ways.append(self.ways[-1] + one)

    def project(self, p, way, first):
        """(distance, way along the path, index) of the point nearest to p not far from `way`."""
        p = (p[0] - self.shift[0], p[1] - self.shift[1], p[2] - self.shift[2])
        while first > 0 and self.ways[first] > way - SLACK_MM:
            first -= 1
        while first + 1 < len(self.moves) and self.ways[first + 1] < way - SLACK_MM:
            first += 1
        best, index = None, first
        while index < len(self.moves) and (best is None or self.ways[index] <= way + SLACK_MM):
            span = self.lengths[index]
            low = high = 1.0
            if span > 0.0:
                low = min(max((way - SLACK_MM - self.ways[index]) / span, 0.0), 1.0)
                high = min(max((way + SLACK_MM - self.ways[index]) / span, 0.0), 1.0)
            t = nearest(self.moves[index], p, low, high)
            at = self.ways[index] + t * span
            d = distance(point(self.moves[index], t), p)
            score = d + ORDER_WEIGHT * abs(at - way)
            if best is None or score < best[0]:
                best = (score, d, at, index)
            index += 1
        return best[1:]


class Worst:
    """The largest of something, and where."""

    def __init__(self):
        self.um, self.line = 0.0, None

    def see(self, mm, line):
        if self.line is None or mm * 1e3 > self.um:
            self.um, self.line = mm * 1e3, line

    def json(self):
        return {"um": round(self.um, 4), "line": self.line}


class Judge:
    """One comparison."""

    def __init__(self, machine, step_mm):
        self.machine, self.step = machine, step_mm
        self.failures, self.samples = [], 0

    def command(self, move, program):
        """Axis command of a program point (work offset included) with the move's tool."""
        if move.tool is None:
            return program
        t = self.machine.tool_vector(move.tool)
        return (program[0] - t[0], program[1] - t[1], program[2] - t[2])

    def tip(self, move, program):
        """Where the machine takes the tool."""
        return self.machine.forward(self.command(move, program), self.machine.tool_vector(move.tool))

    def tip_anywhere(self, move, program):
        """The same; beyond the calibrated volume with the errors of its nearest point."""
        command = self.command(move, program)
        inside = self.machine.clamp(command)
        tip = self.machine.forward(inside, self.machine.tool_vector(move.tool))
        return tuple(t + c - i for t, c, i in zip(tip, command, inside))

    def nominal(self, move, program):
        """Where the program wants the tool."""
        c, t = self.command(move, program), self.machine.tool_vector(move.tool)
        return (c[0] + t[0], c[1] + t[1], c[2] + t[2])

    def point_deviation(self, move, asked, written, axes=range(3)):
        """How far the tool is, along some axes, from the point asked for; beyond the volume the nearest point's correction is right."""
        command = self.command(move, asked)
        shift = tuple(w - a for w, a in zip(written, asked))
        inside = self.machine.clamp(command)
        tool = self.machine.tool_vector(move.tool)
        tip = self.machine.forward(tuple(c + s for c, s in zip(inside, shift)), tool)
        return math.sqrt(sum((tip[k] - inside[k] - tool[k]) ** 2 for k in axes))

    def trace(self, moves):
        """Samples of a stretch through the machine: (tool position, way since the last one, move)."""
        yield self.tip(moves[0], moves[0].start), 0.0, moves[0]
        for move in moves:
            span = length(move)
            count = max(2, math.ceil(span / self.step)) if span > 0.0 else 1
            if move.arc:
                count = max(count, math.ceil(abs(move.arc.sweep) / 0.1))
            for k in range(1, count + 1):
                self.samples += 1
                yield self.tip(move, point(move, k / count)), span / count, move

    def without_approach(self, wanted, taken):
        """Rapids bring their own axes only: short moves to the start bring the others, before anything is cut."""
        start = self.nominal(wanted[0], wanted[0].start)
        away = lambda move: distance(self.tip(move, move.start), start)
        while len(taken) > 1 and length(taken[0]) < APPROACH_MM and away(taken[1]) < away(taken[0]):
            taken = taken[1:]
        return taken

    def feed(self, wanted, taken, worst, reached):
        """Compares one stretch: the path both ways."""
        path = Path(wanted, tuple(n - s for n, s in zip(self.nominal(wanted[0], wanted[0].start), wanted[0].start)))
        way, first, trail = 0.0, 0, []
        for tip, advance, move in self.trace(taken):
            d, way, first = path.project(tip, way + advance, first)
            worst.see(d, move.line)
            trail.append((way, tip))
        if reached is None:
            return path.ways[-1]
        # Every corner of the wanted path must be met by the taken one.
        low = 0
        corners = [(0.0, wanted[0].start, wanted[0])] + [(path.ways[k + 1], m.end, m) for k, m in enumerate(wanted)]
        for way, corner, move in corners:
            while low + 1 < len(trail) and trail[low + 1][0] < way - SLACK_MM:
                low += 1
            target, best, k = self.nominal(move, corner), math.inf, low
            # One sample more: the corner may lie between two.
            while k < len(trail) and (best == math.inf or trail[max(k - 1, 0)][0] <= way + SLACK_MM):
                best = min(best, distance(trail[k][1], target))
                if k > 0:
                    best = min(best, to_segment(trail[k - 1][1], trail[k][1], target))
                k += 1
            reached.see(best, move.line)
        return path.ways[-1]

    def judge(self, original, corrected, limit_um):
        (moves_in, events_in), (moves_out, events_out) = original, corrected
        before, after, reached = Worst(), Worst(), Worst()
        rapids, on_the_way, event_place = Worst(), Worst(), Worst()
        runs_in, runs_out = runs(moves_in), runs(moves_out)
        if [kind for kind, _ in runs_in] != [kind for kind, _ in runs_out]:
            at = next((k for k, (a, b) in enumerate(zip(runs_in, runs_out)) if a[0] != b[0]), min(len(runs_in), len(runs_out)))
            line = moves_out[runs_out[at][1][0]].line if at < len(runs_out) else None
            self.failures.append(f"rapids and feeds do not follow each other as in the original, from line {line}")
        # Only a cycle goes both at rapid and at feed rate on one line.
        cycle_lines = {move.line for move in moves_in if move.rapid} & {move.line for move in moves_in if not move.rapid}
        skipped = 0
        for (kind, a), (other, b) in zip(runs_in, runs_out):
            if kind != other:
                break
            wanted, taken = [moves_in[k] for k in a], [moves_out[k] for k in b]
            in_cycle = kind == "rapid" and any(move.line in cycle_lines for move in wanted)
            if in_cycle:
                self.way_round(wanted, taken, on_the_way)
                if b[-1] + 1 == len(moves_out):
                    continue
                # In one move or in three: where the next feed starts is what counts.
                wanted, taken = wanted[-1:], taken[-1:]
            if kind != "feed" and len(wanted) != len(taken):
                self.failures.append(f"{len(taken)} {kind} moves for {len(wanted)} of the original, from line {taken[0].line}")
                continue
            if kind == "exempt":
                for one, two, following in zip(wanted, taken, wanted[1:] + [None]):
                    if following is not None and following.line == one.line:
                        # By way of a point that G91 measures from where the axes stand.
                        continue
                    named = [axis for axis, letter in enumerate("XYZ") if letter in one.named]
                    if any(one.end[axis] != two.end[axis] for axis in named):
                        rapids.see(distance(one.end, two.end), two.line)
            elif kind == "rapid":
                for one, two in zip(wanted, taken):
                    if not one.known:
                        skipped += 1
                        continue
                    # A positioning block brings its own axes to their place, and leaves the others where they are.
                    own = range(3) if in_cycle else one.own
                    rapids.see(self.point_deviation(one, one.end, two.end, own), two.line)
                    if any(abs(two.end[k] - two.start[k]) > LAST_BITS_MM for k in range(3) if k not in own):
                        self.failures.append(f"line {two.line}: a rapid moves an axis that the original does not name")
            else:
                if any(move.tool != wanted[0].tool for move in wanted + taken):
                    self.failures.append(f"line {wanted[0].line}: the tool changes between feed moves")
                self.feed(wanted, wanted, before, None)
                taken = self.without_approach(wanted, taken)
                self.feed(wanted, taken, after, reached)
                self.check_time(wanted, taken)
        self.check_events(events_in, events_out, moves_in, moves_out, cycle_lines, event_place)
        for name, worst in (("path", after), ("corner", reached), ("rapid end", rapids), ("place of an event", event_place)):
            if worst.um > limit_um:
                self.failures.append(f"{name}: {worst.um:.3f} um at line {worst.line}, allowed {limit_um:.3f}")
        if on_the_way.um > ON_THE_WAY_UM:
            self.failures.append(f"rapid on the way: {on_the_way.um:.3f} um at line {on_the_way.line}")
        return {
            "ok": not self.failures,
            "limit_um": round(limit_um, 4),
            "before": before.json(),
            "after": after.json(),
            "corners": reached.json(),
            "rapid_ends": rapids.json(),
            "events": {"count": len(events_in), **event_place.json()},
            "counts": {
                "moves_in": len(moves_in),
                "moves_out": len(moves_out),
                "arcs_in": sum(1 for move in moves_in if move.arc),
                "arcs_out": sum(1 for move in moves_out if move.arc),
                "rapids": sum(1 for move in moves_in if move.rapid),
                "rapids_from_unknown_positions": skipped,
                "samples": self.samples,
            },
            "failures": self.failures,
        }

    def way_round(self, wanted, taken, worst):
        """A cycle's rapids between two feeds, both ways: the tool leaves the hole and comes to the next as it should."""
        if not wanted[0].start_known:
            return
        path = [self.nominal(wanted[0], wanted[0].start)] + [self.nominal(move, move.end) for move in wanted]
        tips = [self.tip_anywhere(taken[0], taken[0].start)] + [self.tip_anywhere(move, move.end) for move in taken]
        for corners, other in ((path, tips), (tips, path)):
            for corner in corners:
                worst.see(min(to_segment(a, b, corner) for a, b in zip(other, other[1:])), taken[0].line)

    def check_time(self, wanted, taken):
        """Feeds: the stretch takes as long as before."""
        if any(move.feed <= 0.0 for move in wanted + taken):
            return
        time_in = sum(length(move) / move.feed for move in wanted)
        time_out = sum(length(move) / move.feed for move in taken)
        slowest = min(move.feed for move in wanted)
        if abs(time_out - time_in) > TIME_SHARE * time_in + TIME_PER_MOVE_MM * len(wanted) / slowest:
            self.failures.append(
                f"line {taken[0].line}: feed moves take {time_out * 60:.3f} s, {time_in * 60:.3f} s in the original"
            )

    def check_events(self, events_in, events_out, moves_in, moves_out, cycle_lines, worst):
        """M, S, T words and dwells: the same ones in the same order at the same places."""
        names_in, names_out = [e[0] for e in events_in], [e[0] for e in events_out]
        if names_in != names_out:
            at = next((k for k, (a, b) in enumerate(zip(names_in, names_out)) if a != b), min(len(names_in), len(names_out)))
            found = f"{names_out[at]} in line {events_out[at][1]}" if at < len(names_out) else "nothing more"
            wanted = f"{names_in[at]} of line {events_in[at][1]}" if at < len(names_in) else "nothing more"
            self.failures.append(f"M, S, T and dwells differ: {found}, expected {wanted}")
            return
        for (_, _, k), (_, line, m) in zip(events_in, events_out):
            if k == 0 or m == 0:
                if k != m:
                    self.failures.append(f"line {line}: an event changed places with the first motion")
                continue
            one, two = moves_in[k - 1], moves_out[m - 1]
            if one.known and not one.exempt and one.line not in cycle_lines:
                worst.see(self.point_deviation(one, one.end, two.end, one.own if one.rapid else range(3)), line)


def to_segment(a, b, p):
    """Distance of p from the segment ab."""
    d = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    if square == 0.0:
        return distance(a, p)
    t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1] + (p[2] - a[2]) * d[2]) / square
    t = min(max(t, 0.0), 1.0)
    return distance((a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]), p)


def judge(raw_in, raw_out, machine, tolerance_um=1.0, resolution_um=1.0, step_mm=1.0, least_increment=None):
    """The whole comparison of two programs (bytes) as the dictionary that is printed."""
    original = interpret(raw_in, machine.offsets, least_increment)
    corrected = interpret(raw_out, machine.offsets, least_increment)
    limit_um = tolerance_um + math.sqrt(3.0) * 0.5 * resolution_um
    return Judge(machine, step_mm).judge(original, corrected, limit_um)


def load_machine(path, work_offsets, tools):
    """Machine of a profile (.toml) or of JSON with the same keys, with offsets and tools from the command line."""
    if path.endswith(".json"):
        with open(path, encoding="utf-8") as file:
            profile = json.load(file)
    else:
        import tomllib

        with open(path, "rb") as file:
            profile = tomllib.load(file)
    machine = Machine(profile, os.path.dirname(os.path.abspath(path)))
    for text in work_offsets:
        name, values = text.split("=")
        machine.offsets[name] = tuple(float(value) for value in values.split(","))
    for text in tools:
        name, values = text.split("=")
        values = [float(value) for value in values.split(",")]
        machine.lengths[name] = values[0] if len(values) == 1 else values
    return machine


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--in", dest="original", metavar="IN.nc")
    parser.add_argument("--out", dest="corrected", metavar="OUT.nc")
    parser.add_argument("--model", metavar="PROFILE.toml|MODEL.json")
    parser.add_argument("--work-offset", action="append", default=[], metavar="G54=X,Y,Z")
    parser.add_argument("--tool", action="append", default=[], metavar="H1=LENGTH")
    parser.add_argument("--tolerance", type=float, default=1.0, metavar="UM")
    parser.add_argument("--resolution", type=float, default=1.0, metavar="UM", help="output step of an axis")
    parser.add_argument("--step", type=float, default=1.0, metavar="MM", help="distance of samples along the path")
    parser.add_argument("--least-increment", type=int, metavar="DECIMALS", help="X100 means 100 of these (3: 0.1 mm)")
    parser.add_argument("--self-test", action="store_true", help="programs that must pass, and some that must not")
    arguments = parser.parse_args()
    try:
        import gcode  # noqa: F401
    except ImportError:
        print("referee: no module gcode; apt-get install --no-install-recommends linuxcnc-uspace", file=sys.stderr)
        return 3
    if arguments.self_test:
        import self_test

        return self_test.run()
    if not (arguments.original and arguments.corrected and arguments.model):
        parser.error("--in, --out and --model are needed")
    try:
        machine = load_machine(arguments.model, arguments.work_offset, arguments.tool)
        with open(arguments.original, "rb") as file:
            raw_in = file.read()
        with open(arguments.corrected, "rb") as file:
            raw_out = file.read()
        result = judge(
            raw_in, raw_out, machine, arguments.tolerance, arguments.resolution, arguments.step, arguments.least_increment
        )
    except (Unreadable, OutsideVolume, ValueError, KeyError, OSError) as error:
        print(f"referee: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(json.dumps(result, indent=1))
    return 0 if result["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
