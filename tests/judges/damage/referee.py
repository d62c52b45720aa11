"""Says whether a corrected program makes the same part: path, positioning, order and process.

Both programs are read by reader.py. The corrected one is taken through the forward model of machine.py with play followed
along the commands, and the tips are compared with the programmed path in the way of Frechet's distance: for each tip, the
stretches of the programmed path within the limit that can be reached from those of the tip before, going on by as much as
the tip went on. If none is left the path was left, if the end is not reached something is missing. Each tip must run under
the process (feed, spindle, coolant, tool, compensation, cycle) of the programmed motion that it stands for; events must
follow in the same order at the same places; rapids must end where they should.
"""

import math

import numpy

from machine import Sides
from reader import Event

# Beyond what the promise allows: rounding of this model against others, mm.
MARGIN = 0.03e-3
# Rapids may be off by this many times what a feed may (docs/reference.md).
RAPID_FACTOR = 4.0
# A motion in a cycle goes across with the correction of the hole, not with its own, mm.
CYCLE_LEAN = 0.03
# Feed moves that bring an axis to its side of the play before a cut are this short, mm.
APPROACH = 0.12
# At the level above a hole the tool is in the air, and a feed in the other direction than before begins with the play:
# within this of that level a hole may be off by the play of the drilling axis, mm.
TOP = 0.1
# Chord error of the polyline that stands for a programmed arc, mm.
CHORD = 0.04e-3


def sample(motion, play, step=1.0):
    """Axis commands along a motion, its start included, for the play has moved by then."""
    if motion.rapid:
        return numpy.array([motion.end])
    shares = [0.0, 1.0]
    n = max(1, math.ceil(motion.length / step))
    if motion.arc:
        arc = motion.arc
        n = max(n, math.ceil(abs(arc.sweep) / 0.15), 2)
        lo, hi = sorted((arc.angle, arc.angle + arc.sweep))
        radius = max(arc.radii)
        near = [0.0] + ([s * math.sqrt(2e-3 * h / radius) for h in (0.5, 1, 2, 4, 8, 16) for s in (-1, 1)] if play else [])
        quarter = math.ceil(lo / (math.pi / 2))
        while quarter * math.pi / 2 <= hi:
            for d in near:
                shares.append((quarter * math.pi / 2 + d - arc.angle) / arc.sweep)
            quarter += 1
    elif play:
        for axis in range(3):
            way = abs(motion.end[axis] - motion.start[axis])
            if way > 0:
                shares += [h * 1e-3 / way for h in (0.5, 1, 2, 4, 6, 8, 10, 13, 17, 22)]
    shares += [k / n for k in range(1, n)]
    shares = sorted({s for s in shares if s == 0 or 1e-12 < s <= 1.0})
    if motion.arc:
        return numpy.array([motion.arc.at(s) for s in shares[:-1]] + [motion.end])
    a, b = numpy.array(motion.start), numpy.array(motion.end)
    return a + numpy.outer(shares, b - a)


class Path:
    """A stretch of programmed feed motions as a polyline of tips."""

    def __init__(self, motions):
        points, owner, self.vertices = [numpy.array(motions[0].start)], [], []
        way = 0.0
        tool = numpy.array(motions[0].tool)
        self.motions = motions
        ways = [0.0]
        for index, motion in enumerate(motions):
            if motion.arc:
                radius = max(motion.arc.radii)
                n = max(8, math.ceil(abs(motion.arc.sweep) / math.sqrt(8 * CHORD / radius)))
                new = [numpy.array(motion.arc.at(k / n)) for k in range(1, n)] + [numpy.array(motion.end)]
            else:
                new = [numpy.array(motion.end)]
            for p in new:
                way += math.dist(p, points[-1])
                points.append(p)
                ways.append(way)
                owner.append(index)
            self.vertices.append((way, new[-1] + tool, index))
        self.points, self.ways, self.owner = numpy.array(points) + tool, numpy.array(ways), numpy.array(owner)
        self.length = way
        self.starts = [0.0] + [v[0] for v in self.vertices]

    def near(self, p, eps, low, high):
        """Intervals of the way, between low and high, within eps of p."""
        first = max(int(numpy.searchsorted(self.ways, low, side="left")) - 1, 0)
        last = min(int(numpy.searchsorted(self.ways, high, side="right")), len(self.ways) - 1)
        a, b = self.points[first:last], self.points[first + 1 : last + 1]
        d = b - a
        square = (d * d).sum(axis=1)
        span = self.ways[first + 1 : last + 1] - self.ways[first:last]
        rel = p - a
        safe = numpy.where(square > 0, square, 1.0)
        t = (rel * d).sum(axis=1) / safe
        off = (rel * rel).sum(axis=1) - t * t * square
        half = eps * eps - off
        out = []
        for k in numpy.nonzero(half >= 0)[0]:
            if square[k] == 0:
                out.append((self.ways[first + k], self.ways[first + k]))
                continue
            width = math.sqrt(half[k] / square[k])
            lo, hi = max(t[k] - width, 0.0), min(t[k] + width, 1.0)
            if lo <= hi:
                lo, hi = self.ways[first + k] + lo * span[k], self.ways[first + k] + hi * span[k]
                lo, hi = max(lo, low), min(hi, high)
                if lo <= hi:
                    out.append((lo, hi))
        merged = []
        for lo, hi in out:
            if merged and lo <= merged[-1][1] + 1e-9:
                merged[-1] = (merged[-1][0], max(hi, merged[-1][1]))
            else:
                merged.append((lo, hi))
        return merged

    def owners(self, lo, hi):
        """Motions that a stretch of the way touches."""
        return [k for k in range(len(self.motions)) if self.starts[k] <= hi and self.starts[k + 1] >= lo]


class Runs:
    """A program as feeds and rapids in turn, each with its motions, its samples and the events in it."""

    def __init__(self, items, machine=None, start=None):
        self.runs = []
        sides = Sides(machine, start) if machine else None
        self.machine = machine
        count, order = 0, []
        for item in items:
            if isinstance(item, Event):
                order.append((item.name, item.line, len(self.runs), len(self.runs[-1]["motions"]) if self.runs else 0))
                if sides and (item.name == "M6" or item.name.startswith("reference")):
                    for axis in range(3):
                        if item.name == "M6" or "XYZ"[axis] in item.name.split()[1]:
                            sides.lose(axis)
                continue
            kind = "rapid" if item.rapid else "feed"
            if not self.runs or self.runs[-1]["kind"] != kind:
                self.runs.append({"kind": kind, "motions": [], "tips": [], "sure": []})
            run = self.runs[-1]
            run["motions"].append(item)
            if sides:
                tips, sure = self.tips(item, sides)
                run["tips"].append(tips)
                run["sure"].append(sure)
            count += 1
        self.events = order

    def tips(self, motion, sides):
        machine = self.machine
        if not motion.known:
            for axis in range(3):
                if motion.end[axis] is not None:
                    sides.follow(axis, numpy.array([motion.end[axis]]))
            if None in motion.end:
                return None, False
            q = numpy.array([motion.end])
        else:
            q = sample(motion, machine.has_play)
            w = numpy.empty_like(q)
            certain = True
            for axis in range(3):
                w[:, axis], one = sides.follow(axis, q[:, axis])
                certain = certain and bool(one.all())
            return machine.forward(q, w, motion.tool), certain
        w = numpy.array([sides.w])
        return machine.forward(q, w, motion.tool), all(sides.sure)


class Verdict:
    """What was found."""

    def __init__(self):
        self.failures, self.largest = [], 0.0

    def say(self, text):
        self.failures.append(text)


def same_process(one, two):
    for a, b in zip(one, two):
        if a == b:
            continue
        if isinstance(a, float) and isinstance(b, float) and abs(a - b) <= 2e-3 * max(abs(a), abs(b)):
            continue
        return False
    return True


PROCESS = ("feed mode", "feed", "spindle", "speed", "coolant", "tool", "length", "compensation", "cycle", "path mode")


def limit_of(motions, machine):
    step = max(m.step for m in motions)
    return machine.tolerance + math.sqrt(3) / 2 * step + MARGIN


class Allowed:
    """What a motion may be off: the promise; in cycles bound to the spindle what the product says of them (VP0506)."""

    def __init__(self, limit, declared=0.0, play=0.0):
        self.limit, self.declared, self.play = limit, declared, play

    def times(self, factor):
        return Allowed(self.limit * factor, self.declared * factor, self.play)

    def of(self, path, way):
        hole = path.motions[0]
        eps = self.limit + (max(self.declared - self.limit, 0.0) + self.play if hole.process[8] else 0.0)
        if hole.cycle and (way < TOP or way > path.length - TOP):
            eps += self.play
        return eps


def follow(path, motions, tips, allowed):
    """Walks the tips along the path. Returns (failure or None, places): places of each motion's end on the way."""
    limit = allowed.limit
    back = slack = 3 * limit
    reach = [(0.0, 0.0)]
    before = None
    places, ends = [], []
    for motion, block in zip(motions, tips):
        for p in block:
            step = math.dist(p, before) if before is not None else 0.0
            free = []
            for lo, hi in reach:
                eps = max(allowed.of(path, lo), allowed.of(path, hi + step))
                more = slack + (allowed.play if eps > limit else 0.0)
                free += path.near(p, eps, max(lo - back, 0.0), min(hi + step + more, path.length))
            free.sort()
            now = []
            for lo, hi in free:
                if now and lo <= now[-1][1] + 1e-9:
                    now[-1] = (now[-1][0], max(now[-1][1], hi))
                else:
                    now.append((lo, hi))
            if not now:
                way = reach[0][0]
                owner = path.owners(way, reach[-1][1] + step)
                off = min((path.points - p) @ numpy.ones(3) * 0 + numpy.linalg.norm(path.points - p, axis=1))
                return (motion.line, [path.motions[k].line for k in owner], p, off, way), places
            owners = {k for lo, hi in now for k in path.owners(lo - slack, hi + slack)}
            if not any(same_process(path.motions[k].process, motion.process) for k in owners):
                k = min(owners)
                what = [n for n, a, b in zip(PROCESS, path.motions[k].process, motion.process) if not same_process((a,), (b,))]
                return ("process", motion.line, path.motions[k].line, what, path.motions[k].process, motion.process), places
            ends.append((now, p, before))
            reach, before = now, p
        places.append(reach)
    if reach[-1][1] < path.length - slack - (allowed.play if path.motions[0].cycle else 0.0):
        return ("end", motions[-1].line, path.motions[path.owners(reach[-1][1], reach[-1][1])[0]].line, path.length - reach[-1][1]), places
    for way, vertex, index in path.vertices:
        motion = path.motions[index]
        eps = allowed.of(path, way)
        best = math.inf
        for now, p, prior in ends:
            if any(lo - slack - 1.1 <= way <= hi + slack + 1.1 for lo, hi in now):
                best = min(best, math.dist(p, vertex) if prior is None else to_segment(prior, p, vertex))
        if best > eps:
            return ("corner", motion.line, best), places
    return None, places


def to_segment(a, b, p):
    d = b - a
    square = float(d @ d)
    t = 0.0 if square == 0 else min(max(float((p - a) @ d) / square, 0.0), 1.0)
    return math.dist(a + t * d, p)


def tidy(runs, limit):
    """Merges feed runs that only take up play (the tool stands still) into the rapids around them."""
    out = []
    for run in runs:
        if run["kind"] == "feed" and sum(m.length for m in run["motions"]) <= APPROACH:
            tips = [t for t in run["tips"] if t is not None]
            if tips and numpy.linalg.norm(numpy.concatenate(tips) - tips[0][0], axis=1).max() <= 4 * limit:
                run = dict(run, kind="rapid", still=True)
        if out and out[-1]["kind"] == run["kind"]:
            last = out[-1]
            out[-1] = dict(last, motions=last["motions"] + run["motions"], tips=last["tips"] + run["tips"], sure=last["sure"] + run["sure"])
        else:
            out.append(run)
    return out


def judge(items_in, items_out, machine, start=None, declared=0.0):
    """The whole comparison; failures in words, and whether play was on an unknown side anywhere that feeds."""
    verdict = Verdict()
    one, two = Runs(items_in), Runs(items_out, machine, start)
    check_events(one, two, verdict)
    limit = machine.tolerance + math.sqrt(3) / 2 * 0.001 + MARGIN
    short = sum(sum(m.length for m in r["motions"]) <= APPROACH for r in one.runs if r["kind"] == "feed")
    runs_in = one.runs
    runs_out = two.runs if short else tidy(two.runs, limit)
    if [r["kind"] for r in runs_in] != [r["kind"] for r in runs_out]:
        at = next((k for k, (a, b) in enumerate(zip(runs_in, runs_out)) if a["kind"] != b["kind"]), min(len(runs_in), len(runs_out)))
        where = runs_out[at]["motions"][0].line if at < len(runs_out) else "end"
        verdict.say(f"rapids and feeds do not follow each other as programmed ({len(runs_in)}, {len(runs_out)} in the output), from line {where}")
        return verdict
    before = None
    for a, b in zip(runs_in, runs_out):
        # Under cutter compensation look-ahead counts blocks: none may come in between (docs/dialects.md).
        counts = [sum(m.process[7][0] != 40 for m in run["motions"]) for run in (a, b)]
        if counts[0] != counts[1]:
            verdict.say(f"compensation: {counts[1]} feeds for {counts[0]} under G41 or G42, from line {b['motions'][0].line}")
        if a["kind"] == "feed":
            judge_feed(a, b, machine, verdict, declared)
        else:
            judge_rapids(a, b, machine, verdict, before is not None and before["motions"][-1].cycle)
        before = a
    return verdict


def judge_feed(a, b, machine, verdict, declared):
    if any(m.tool != a["motions"][0].tool for m in a["motions"] + b["motions"]):
        if [m.tool for m in a["motions"]][0] != b["motions"][0].tool:
            verdict.say(f"tool: line {b['motions'][0].line}")
            return
    limit = limit_of(a["motions"], machine)
    if not all(b["sure"]):
        # The side is not known: as far off as the play may make it, and said so by a warning.
        limit += sum(machine.largest_play(k) for k in range(3))
    path = Path(a["motions"])
    allowed = Allowed(limit, declared, machine.largest_play(2))
    found = None
    # Feed moves to a corrected start, a few micrometres each, may come before.
    skipped, way = 0, 0.0
    while True:
        found, _ = follow(path, b["motions"][skipped:], b["tips"][skipped:], allowed)
        way += b["motions"][skipped].length
        if found is None or way > APPROACH or skipped + 1 >= len(b["motions"]):
            break
        skipped += 1
    if found is None:
        check_time(a, b, skipped, verdict)
        return
    found, _ = follow(path, b["motions"], b["tips"], allowed)
    if found[0] == "process":
        verdict.say(f"process: line {found[1]} for line {found[2]} of the original: {found[3]}, {found[4]} expected, {found[5]}")
    elif found[0] == "end":
        verdict.say(f"missing: {found[3]:.4f} mm of the way up to line {found[2]} of the original are not cut")
    elif found[0] == "corner":
        name = "peck" if path.motions[0].peck else "corner"
        verdict.say(f"{name}: line {found[1]} of the original is passed at {found[2] * 1e3:.2f} um, allowed {limit * 1e3:.2f}")
    else:
        line, original, p, off, at = found
        factor = next((f for f in (1.02, 1.1, 1.3, 1.6, 2, 3, 5, 10, 30) if follow(path, b["motions"], b["tips"], allowed.times(f))[0] is None), None)
        size = f"{limit * factor * 1e3:.2f}" if factor else "more than 30 times"
        verdict.say(f"path: line {line} (original {original[:4]}) off by up to {size} um, allowed {limit * 1e3:.2f}; way {at:.3f} of {path.length:.3f}")


def check_time(a, b, skipped, verdict):
    """The feed motions take as long as before: 0.5 % and what the correction adds."""
    total = []
    for motions in (a["motions"], b["motions"]):
        time = 0.0
        for motion in motions:
            if motion.minutes is not None:
                # A motion of no length takes no time anywhere.
                time += motion.minutes if motion.length > 0 or motion.start != motion.end else 0.0
            elif motion.process[1]:
                time += motion.length / motion.process[1]
        total.append(time)
    feeds = [m.process[1] for m in a["motions"] if m.process[1]]
    inverse = [m.length / m.minutes for m in a["motions"] if m.minutes and m.length > 0]
    slowest = min(feeds + inverse + [1e9])
    # 20 um more for each motion.
    if abs(total[1] - total[0]) > 0.005 * total[0] + 0.03 * len(b["motions"]) / slowest:
        verdict.say(f"time: feeds from line {b['motions'][0].line} take {total[1] * 60:.3f} s, programmed {total[0] * 60:.3f} s")
    for motion in b["motions"]:
        if motion.minutes is not None and motion.length > 0 and motion.length / motion.minutes > 40 * max(inverse + [1.0]) + 100:
            verdict.say(f"time: line {motion.line} goes {motion.length:.4f} mm at {motion.length / motion.minutes:.0f} mm/min (G93), {max(inverse + [0]):.0f} programmed")
            break


def judge_rapids(a, b, machine, verdict, behind_a_hole):
    limit = limit_of(a["motions"], machine)
    wanted = [numpy.array(m.end) + m.tool if None not in m.end else None for m in a["motions"]]
    got = [t[-1] if t is not None else None for t in b["tips"]]
    cycle = behind_a_hole or any(m.cycle for m in a["motions"] + b["motions"])
    sure = all(b["sure"])
    allowed = RAPID_FACTOR * limit + (0.0 if sure else sum(machine.largest_play(k) for k in range(3)))
    still = b.get("still") or any(not m.rapid for m in b["motions"])
    if len(wanted) == len(got) and not cycle:
        for one, two, programmed, m in zip(wanted, got, a["motions"], b["motions"]):
            if one is not None and two is not None:
                # A positioning block carries its own axes only: one that stands in both keeps its last correction.
                both = (programmed, m)
                stands = [all(each.start[k] is not None and each.start[k] == each.end[k] for each in both) for k in range(3)]
                one = numpy.where(stands, two, one)
            if (one is None) != (two is None):
                verdict.say(f"rapid: line {m.line} goes to a place that only one of the programs knows")
            elif one is not None and math.dist(one, two) > allowed:
                verdict.say(f"rapid: line {m.line} ends {math.dist(one, two) * 1e3:.1f} um off, allowed {allowed * 1e3:.1f}")
        return
    if not cycle and not still:
        verdict.say(f"rapid: {len(got)} for {len(wanted)} of the original, from line {b['motions'][0].line}")
        return
    # Both begin where the feed before them ended.
    if None not in a["motions"][0].start and None not in b["motions"][0].start:
        wanted.insert(0, numpy.array(a["motions"][0].start) + a["motions"][0].tool)
        got.insert(0, wanted[0])
    if any(v is None for v in wanted) or any(v is None for v in got):
        if cycle:
            return
        wanted = [v for v in wanted if v is not None]
        got = [v for v in got if v is not None]
        if not wanted or not got:
            return
    for chain, other, name in ((wanted, got, "not reached"), (got, wanted, "added")):
        at, flat = 0, numpy.array([1.0, 1.0, 0.0])
        lines = a["motions"] if chain is wanted else b["motions"]
        for k, p in enumerate(chain):
            segments = [(other[max(j - 1, 0)], other[j]) for j in range(len(other))]
            best = None
            for j in range(at, len(segments)):
                if to_segment(segments[j][0], segments[j][1], p) <= allowed + CYCLE_LEAN:
                    best = j
                    break
            if best is None:
                first = chain is got and k == 0 and cycle
                # A hole may be gone to at the initial level where the program goes at R: higher up, over the same line.
                higher = chain is got and cycle and any(
                    to_segment(i * flat, j * flat, p * flat) <= allowed + CYCLE_LEAN and p[2] > max(i[2], j[2]) for i, j in segments
                )
                if not first and not higher:
                    verdict.say(f"rapid: a place of line {lines[max(min(k - 1, len(lines) - 1), 0)].line} is {name}")
                    return
            else:
                at = best


def check_events(one, two, verdict):
    names_in, names_out = [e[0] for e in one.events], [e[0] for e in two.events]
    if names_in != names_out:
        at = next((k for k, (x, y) in enumerate(zip(names_in, names_out)) if x != y), min(len(names_in), len(names_out)))
        found = f"{names_out[at]} in line {two.events[at][1]}" if at < len(names_out) else "nothing more"
        wanted = f"{names_in[at]} of line {one.events[at][1]}" if at < len(names_in) else "nothing more"
        verdict.say(f"events: {found}, expected {wanted}")
        return
    for (name, line, run, count), (_, line_out, run_out, count_out) in zip(one.events, two.events):
        place_in = place(one, run, count)
        place_out = place(two, run_out, count_out)
        if place_in is None or place_out is None:
            continue
        if math.dist(place_in, place_out) > 0.4:
            verdict.say(f"events: {name} of line {line} comes in line {line_out} at another place")
            return
    # Between the same feeds: how many feeds of some length lie before.
    for (name, line, run, count), (_, line_out, run_out, count_out) in zip(one.events, two.events):
        before = feed_way(one, run, count)
        after = feed_way(two, run_out, count_out)
        if abs(before - after) > 0.2 + 2e-3 * before + 0.025 * (run_out + count_out):
            verdict.say(f"events: {name} of line {line} comes in line {line_out}, {after:.2f} mm of feed before it, {before:.2f} programmed")
            return


def place(program, run, count):
    if run == 0:
        return None
    motion = program.runs[run - 1]["motions"][count - 1]
    return None if None in motion.end else motion.end


def feed_way(program, run, count):
    if "ways" not in program.__dict__:
        program.ways = []
        way = 0.0
        for r in program.runs:
            ways = []
            for m in r["motions"]:
                way += m.length if r["kind"] == "feed" else 0.0
                ways.append(way)
            program.ways.append(ways)
    return program.ways[run - 1][count - 1] if run else 0.0
