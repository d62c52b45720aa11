#!/usr/bin/env python3
"""Judge of what is said of axes that lag (`following`): does `control_um` hold where each axis is a loop of the first
order behind its command?

    lag.py --vpost target/release/vpost --programs 20 [--seed 1] [--keep DIR]
    lag.py --vpost target/release/vpost --programs 20 --interpreter

Programs of programs.py and of this file (circles of 2 to 40 mm radius, right and sharp corners, polylines, short
segments, F100 to F3000) run through LinuxCNC's motion controller, as G61 and as G64 P0.01, on a machine without errors.
The axes' recorded commands, straight from one millisecond to the next, go through loops y' = k (x - y) + f x' of which
each axis has its own k (20 to 200 1/s) and f (0 to 1), or all the same; these are solved exactly. With `--interpreter`
the commands are those of LinuxCNC's stand-alone interpreter, run with trapezoids of speed that stop behind each block.

The tip must stay within `control_um` of the programmed path, half an output step of each axis and what the recording
itself is off; profiles name these loops, with and without the acceleration of the rig. On circles alone, where all
loops are alike, the radius by least squares where the speed is steady (ISO 230-4) must be smaller by what -v says of
arcs, within 10 %. At the F which the warning names the tip must be within the tolerance. Exit status 1 where one of
these does not hold. Rows that feed count; the rapid behind them, whose way is not promised, is in the table alone.
There is a dwell between a rapid and the feed behind it, but in `hops` and in a quarter of the others (`no dwell`).
"""

import collections
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import numpy as np

import campaign
import canon
import judge
import programs
import rig

MODES = {"G61": 0.0, "G64 P0.01": 0.01}  # with what they may leave at a corner, mm
ZERO_MM = (100.0, 110.0, 60.0)
PERIOD_S = 1e-3
SUBSTEPS = 2
WITHIN = 0.10
ROUNDED_UM = 0.06  # -v says tenths
RECORDED_MM = 5e-4  # what commands each millisecond may be off under G61
LONGEST_S = 12.0
SLOWEST_S = 60.0
NEAR_MM = 2.0
BEHIND = "rapid"  # the row of the last rapid, whose way is not promised
SAID = re.compile(r"axes that lag add up to ([\d.]+) um (at corners|on arcs)")
NAMED = re.compile(r"VP0529\]: axes that lag.*?help: F(\d+) mm/min", re.S)


class Loops:
    """Position loops of X, Y and Z: gain k, 1/s, and the share of the speed that is fed forward."""

    def __init__(self, chance, alike, told):
        drawn = [self.drawn(chance)] * 3 if alike else [self.drawn(chance) for _ in "XYZ"]
        self.gain, self.forward = (np.array(column) for column in zip(*drawn))
        self.alike, self.told = alike, told

    @staticmethod
    def drawn(chance):
        gain = round(math.exp(chance.uniform(math.log(20), math.log(200))), 1)
        return gain, chance.choice([0.0, round(chance.uniform(0, 1), 2), round(chance.uniform(0.7, 1), 2)])

    def __str__(self):
        return f"k {self.gain.tolist()} f {self.forward.tolist()}{', acceleration told' if self.told else ''}"

    def behind(self, commands):
        """Command less place of each axis, mm, `SUBSTEPS` rows for each of the commands (n, 3) but the first; they
        stand at first. Exact for commands that are straight in between."""
        commanded = fine(commands)
        found = np.empty_like(commanded)
        step_s = PERIOD_S / SUBSTEPS
        for axis, (gain, forward) in enumerate(zip(self.gain, self.forward)):
            kept = math.exp(-gain * step_s)
            speeds = np.repeat(np.diff(commands[:, axis]) / PERIOD_S, SUBSTEPS)
            pushed = ((1 - forward) / gain * (1 - kept) * speeds).tolist()
            error, column = 0.0, []
            for push in pushed:
                error = error * kept + push
                column.append(error)
            found[:, axis] = column
        return commanded, found

    def profile(self, folder):
        """That of a machine that is right but for these loops."""
        told = f"acceleration_mm_s2 = {rig.LIMITS['MAX_ACCELERATION']}, " if self.told else ""
        gain, forward = (
            str(values[0]) if self.alike else f"[{', '.join(map(str, values))}]"
            for values in (self.gain, self.forward)
        )
        zero = ", ".join(map(str, ZERO_MM))
        lines = ["format = 1", 'name = "rig"', 'chain = "[w b X Y Z t]"']
        lines.append(
            f'control = {{ dialect = "linuxcnc", {told}following = {{ gain_1_s = {gain}, feed_forward = {forward} }} }}'
        )
        lines += [f"axis.{axis} = {{ travel_mm = [-2000, 2000], resolution_mm = 0.001 }}" for axis in "XYZ"]
        lines.append(f'work_offsets_mm = {{ G54 = {{ at = [{zero}], zero = "true" }} }}')
        path = folder / "lag.toml"
        path.write_text("\n".join(lines) + "\n")
        return path


def fine(commands):
    """Commands with those in between, each straight to the next."""
    shares = np.arange(1, SUBSTEPS + 1) / SUBSTEPS
    return (commands[:-1, None, :] + np.diff(commands, axis=0)[:, None, :] * shares[:, None]).reshape(-1, 3)


def feed_for(chance, length_mm, slowest=100.0):
    """F that takes no longer than `LONGEST_S`, mm/min."""
    low = max(slowest, length_mm / LONGEST_S * 60)
    return round(math.exp(chance.uniform(math.log(low), math.log(max(low, 3000)))))


def circle(writer, chance):
    """Full circles, one after the other in one block."""
    r = round(math.exp(chance.uniform(math.log(2), math.log(40))), 3)
    turns = max(1, round(30 / r))
    programs.begin(writer, 50 + r, 50, -1.0, 600)
    writer.feed(f=feed_for(chance, 2 * math.pi * r * turns), x=50 + r)
    writer.arc("G3", (50, 50), (50 + r, 50))
    writer.path += writer.path[-programs.CHORDS :] * (turns - 1)
    writer.blocks[-1] += f" P{turns}"


def polyline(writer, chance, count, sides, angles):
    """Lines of `sides` mm that turn by `angles` degrees, to either side."""
    length = count * sum(sides) / 2
    at, way = np.array([50.0, 50.0]), chance.uniform(0, 360)
    programs.begin(writer, *at, -1.0, 600)
    f = feed_for(chance, length)
    for k in range(count):
        at = at + chance.uniform(*sides) * np.array([math.cos(math.radians(way)), math.sin(math.radians(way))])
        writer.feed(x=at[0], y=at[1], f=f if k == 0 else None)
        way += chance.choice([-1, 1]) * chance.uniform(*angles)


def right(writer, chance):
    polyline(writer, chance, 8, (3, 12), (90, 90))


def sharp(writer, chance):
    polyline(writer, chance, 8, (3, 12), (100, 178))


def corners(writer, chance):
    polyline(writer, chance, 10, (2, 8), (5, 120))


def short(writer, chance):
    """Segments that are shorter than it takes a loop to settle."""
    polyline(writer, chance, 40, (0.1, 1.0), (0, 60))


def pocket(writer, chance):
    """Lines and small quarter circles that go on from one to the next."""
    r, side = round(chance.uniform(2, 8), 3), round(chance.uniform(1, 10), 3)
    programs.begin(writer, 50, 50, -1.0, 600)
    f = feed_for(chance, 4 * side + 2 * math.pi * r)
    writer.feed(x=50 + side, f=f)
    x, y, w = 50 + side, 50 + r, 2 * r + side
    writer.arc("G3", (x, y), (x + r, y))
    writer.feed(y=y + side)
    writer.arc("G3", (x, y + side), (x, 50 + w))
    writer.feed(x=50)
    writer.arc("G3", (50, y + side), (50 - r, y + side))
    writer.feed(y=y)
    writer.arc("G3", (50, y), (50, 50))


def hops(writer, chance):
    """Feeds between rapids at the same height."""
    programs.begin(writer, 50, 50, -1.0, 600)
    f = feed_for(chance, 80, slowest=300.0)
    for k in range(6):
        writer.feed(x=50 + chance.uniform(5, 20), f=f if k == 0 else None)
        writer.rapid(x=50.0)
        writer.feed(y=53 + 3 * k)


OWN = {kind.__name__: kind for kind in (circle, right, sharp, corners, short, pocket, hops)}
KINDS = OWN | programs.KINDS
ORDER = ["circle", "right", "sharp", "arcs", "circle", "short", "corners", "pocket", "circle", "plate", "wave", "helix"]
ORDER += ["hops", "raster", "zigzag"]


class Program:
    """Text by mode, path and where on it the first feed begins, mm."""

    def __init__(self, number, seed):
        chance = random.Random(f"lag {seed} {number}")
        self.kind, self.chance = ORDER[number % len(ORDER)], chance
        writer = programs.Writer("MODE")
        KINDS[self.kind](writer, chance)
        self.dwells = number % 4 != 3
        text = writer.text().decode()
        if self.dwells:
            text = text.replace("G0 Z2.000\n", "G0 Z2.000\nG4 P0.6\n")
        if self.kind in programs.KINDS:
            share = chance.uniform(0.3, 1)
            text = re.sub(r"F(\d+)", lambda match: f"F{round(int(match[1]) * share)}", text)
        self.text = text
        self.path = np.array([*writer.path, [*writer.path[-1][:2], 20.0]]) + ZERO_MM
        self.name = f"p{number:03}_{self.kind}"

    def row(self):
        return self.kind if self.dwells else "no dwell"

    def texts(self):
        return {mode: self.text.replace("MODE", mode).encode() for mode in MODES}


class Said:
    """What vpost says of a program on a machine with loops, um."""

    def __init__(self, vpost, text, loops, folder, tolerance_um=1.0):
        given, made, summary = (folder / name for name in ("in.ngc", "out.ngc", "summary.json"))
        given.write_bytes(text)
        command = [vpost, given, "-m", loops.profile(folder), "-o", made, "--summary", summary, "-v"]
        ran = subprocess.run([*command, "--tolerance", f"{tolerance_um:g}"], capture_output=True, text=True)
        if ran.returncode or made.read_bytes() != text:
            raise RuntimeError(f"exit status {ran.returncode}, or it was changed: {ran.stderr}")
        self.control_um = json.loads(summary.read_text())["control_um"]
        self.parts_um = {where: float(much) for much, where in SAID.findall(ran.stderr)}
        self.named = min((int(f) for f in NAMED.findall(ran.stderr)), default=None)


class Motion:
    """What the axes were told each millisecond, which rows feed, and which are behind the last feed."""

    def __init__(self, commands, feeds):
        self.commands, self.feeds = commands[:, :3], feeds
        self.behind = np.arange(len(feeds)) > np.flatnonzero(feeds)[-1]

    def off(self, path, loops=None):
        """Distances of the tip from the path, mm: the largest of rows that feed, and of the rapid behind; of the
        commands themselves where no loops are given."""
        commanded, error = loops.behind(self.commands) if loops else (fine(self.commands), np.zeros(3))
        error = np.broadcast_to(error, commanded.shape)
        feeds, behind = (np.repeat(which[1:], SUBSTEPS) for which in (self.feeds, self.behind))
        found = nearest(commanded, error, path, feeds | behind)
        return float(found[feeds].max()), float(found[behind].max(initial=0.0))


def nearest(commanded, error, path, which):
    """Distance of each of the tips that count from the part of the path near its command by the way gone, mm; 0 of the
    others."""
    ways = np.linalg.norm(np.diff(path, axis=0), axis=1)
    path, ways = path[np.r_[True, ways > 0]], ways[ways > 0]
    start, way, at_path = path[:-1], np.diff(path, axis=0), np.r_[0.0, np.cumsum(ways)]
    gone = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(commanded, axis=0), axis=1))]
    gone += at_path[-1] - gone[-1]
    tips, reach = commanded - error, np.linalg.norm(error, axis=1) + NEAR_MM
    low = np.clip(np.searchsorted(at_path, gone - 1.5 * reach) - 1, 0, len(ways) - 1)
    high = np.clip(np.searchsorted(at_path, gone + reach), 1, len(ways))
    found = np.zeros(len(tips))
    rows = np.flatnonzero(which)
    rows = rows[np.argsort((high - low)[rows])]
    for part in np.array_split(rows, 1 + int((high - low)[rows].sum() // 500_000)):
        pieces = np.minimum(low[part, None] + np.arange((high - low)[part].max(initial=1)), len(ways) - 1)
        to = tips[part, None, :] - start[pieces]
        share = np.clip((to * way[pieces]).sum(2) / ways[pieces] ** 2, 0.0, 1.0)
        found[part] = np.sqrt(((to - share[:, :, None] * way[pieces]) ** 2).sum(2).min(1))
    return found


def trapezoid(text):
    """Commands of each millisecond by the interpreter's way, stopping behind each block, as G61 does."""
    control = rig.Control({"G54": ZERO_MM})
    most, rapid = rig.LIMITS["MAX_ACCELERATION"], rig.LIMITS["MAX_VELOCITY"]
    places, feeds, waits = [np.array([ZERO_MM])], [np.array([False])], b"G4 " in text
    was_rapid = False
    for move in canon.Run(canon.calls(text, control), chord_deg=0.05).moves:
        fed = move.name != "STRAIGHT_TRAVERSE"
        if fed and was_rapid and waits:
            places.append(np.repeat(move.corners[:1], 600, axis=0))
            feeds.append(np.zeros(600, dtype=bool))
            waits = False
        was_rapid = not fed
        at = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(move.corners, axis=0), axis=1))]
        if at[-1] == 0:
            continue
        speed = move.state["SET_FEED_RATE"][0] / 60 if fed else rapid
        gone = profile_of_speed(at[-1], speed, most)
        places.append(np.stack([np.interp(gone, at, move.corners[:, axis]) for axis in range(3)], axis=1))
        feeds.append(np.full(len(gone), fed))
    places.append(np.repeat(places[-1][-1:], 300, axis=0))
    feeds.append(np.zeros(300, dtype=bool))
    return Motion(np.vstack(places), np.concatenate(feeds))


def profile_of_speed(length, speed, most):
    """Way gone each millisecond from rest to rest, mm."""
    speed = min(speed, math.sqrt(length * most))
    ramp_s, whole_s = speed / most, length / speed + speed / most
    times = np.r_[np.arange(PERIOD_S, whole_s, PERIOD_S), whole_s]
    left = np.maximum(0, whole_s - times)
    up, down = np.minimum(times, ramp_s), np.minimum(left, ramp_s)
    steady = np.clip(times - ramp_s, 0, whole_s - 2 * ramp_s)
    slowing = np.where(left < ramp_s, ramp_s**2 - down**2, 0.0)
    return 0.5 * most * (up**2 + slowing) + speed * steady


def smaller_um(motion, loops, r_mm):
    """By how much a circle comes out small where its speed is steady, um, by least squares; None where nothing is."""
    commanded, error = loops.behind(motion.commands)
    step_s = PERIOD_S / SUBSTEPS
    speed = np.linalg.norm(np.diff(commanded, axis=0), axis=1) / step_s
    flat = np.repeat(motion.feeds[1:], SUBSTEPS)[1:] & (np.ptp(np.c_[commanded[1:, 2], commanded[:-1, 2]], axis=1) == 0)
    steady = np.flatnonzero(flat & (speed > 0.999 * speed[flat].max(initial=0.0)))
    steady = steady[int(12 / loops.gain[:2].min() / step_s) :]
    if len(steady) < 10 or len(steady) * speed[steady[0]] * step_s < math.pi / 2 * r_mm:
        return None
    tips = (commanded - error)[steady + 1, :2]
    design = np.c_[2 * tips, np.ones(len(tips))]
    middle = tips.mean(0)
    design[:, :2] -= 2 * middle
    found = np.linalg.lstsq(design, ((tips - middle) ** 2).sum(1), rcond=None)[0]
    return (r_mm - math.sqrt(found[2] + found[0] ** 2 + found[1] ** 2)) * 1e3


class Tally:
    """What came of it."""

    def __init__(self, keep):
        self.keep, self.wrong = keep, []
        self.table = collections.defaultdict(list)
        self.circles, self.slowed = [], []

    def fault(self, name, why, text, loops):
        self.wrong.append(f"{name}: {why}; {loops}")
        print(self.wrong[-1], flush=True)
        if self.keep:
            folder = self.keep / f"{len(self.wrong)}_{name.replace(' ', '_')}"
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "program.ngc").write_bytes(text)
            (folder / "why.txt").write_text(self.wrong[-1] + "\n")
            loops.profile(folder)

    def told(self):
        print(f"{'mode':10} {'kind':10} runs  came um  said um  largest came/said  outside")
        for (mode, kind), rows in sorted(self.table.items()):
            came, said, outside = zip(*rows)
            share = max(c / s for c, s in zip(came, said) if s) if any(said) else 0.0
            print(f"{mode:10} {kind:10} {len(rows):4} {max(came):8.2f} {max(said):8.2f} {share:18.3f} {sum(outside):8}")
        if self.circles:
            parts = [came / said for said, came in self.circles if said > 1]
            shares = f"came/said {min(parts):.3f} to {max(parts):.3f} where 1 um and more are said" if parts else ""
            print(f"circles: {len(self.circles)} {shares}")
        if self.slowed:
            print(f"F that was named: {len(self.slowed)} runs, largest came/tolerance {max(self.slowed):.3f}")
        print("\n".join(self.wrong) if self.wrong else "none is farther off than was said")
        return bool(self.table) and not self.wrong


def one(tally, program, mode, text, motion, loops, said):
    """Holds one motion with one set of loops against what was said of it."""
    name = f"{program.name} {mode}"
    if said.control_um is None:
        tally.fault(name, "it is not known", text, loops)
        return
    recorded_um = max(0.0, motion.off(program.path)[0] - MODES[mode]) * 1e3
    may_um = said.control_um + (judge.HALF_STEP_MM + judge.SLACK_MM + RECORDED_MM) * 1e3
    came, behind = (1e3 * off for off in motion.off(program.path, loops))
    for kind, off_um in ((program.row(), came), (BEHIND, behind)):
        tally.table[mode, kind].append((off_um, said.control_um, off_um > may_um))
    if came > may_um:
        tally.fault(name, f"{came:.2f} um, said are {said.control_um:.2f}", text, loops)
    if recorded_um > RECORDED_MM * 1e3:
        tally.fault(name, f"the commands alone are {recorded_um:.2f} um off", text, loops)
    if program.kind == "circle" and loops.alike:
        r_mm = abs(float(re.search(r"I(-?[\d.]+)", program.text)[1]))
        small = smaller_um(motion, loops, r_mm)
        if small is not None:
            arcs = said.parts_um.get("on arcs", 0.0)
            tally.circles.append((arcs, small))
            if abs(small - arcs) > WITHIN * arcs + ROUNDED_UM:
                tally.fault(name, f"the circle is {small:.2f} um smaller, said are {arcs:.2f}", text, loops)


def slower(text, named):
    """The program with no F above the one that a warning names."""
    return re.sub(rb"F(\d+)", lambda match: b"F%d" % min(int(match[1]), named), text)


def asked(tally, vpost, program, texts, loops, chance):
    """Runs for an F that is named at a tolerance which some of the loops do not keep: name, text, tolerance, um."""
    mode = chance.choice(sorted(MODES))
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        said = Said(vpost, texts[mode], loops, folder)
        if not said.control_um or said.named is None:
            return None
        tolerance_um = round(max(said.parts_um.values(), default=0.0) * chance.uniform(0.4, 0.8), 1)
        if tolerance_um < 0.5:
            return None
        named = Said(vpost, texts[mode], loops, folder, tolerance_um).named
    if named is None:
        tally.fault(program.name, f"no F is named at {tolerance_um} um", texts[mode], loops)
        return None
    length_mm = np.linalg.norm(np.diff(program.path, axis=0), axis=1).sum()
    if length_mm / max(named, 1) * 60 > SLOWEST_S:
        return None
    return mode, slower(texts[mode], named), tolerance_um, named


def motions(texts, interpreter):
    """By name: what the axes are told."""
    if interpreter:
        return {name: trapezoid(text) for name, text in texts.items() if b"G61" in text}
    recorded = rig.run(texts, rig.Control({"G54": ZERO_MM}))
    return {
        name: Motion(rows, np.isin(rows[:, 3].astype(int), sorted(judge.feed_lines(texts[name]))))
        for name, rows in recorded.items()
    }


def one_program(given, tally, number):
    """A program in both modes with some sets of loops, and slower where a warning names an F."""
    program = Program(number, given.seed)
    chance = program.chance
    sets = [Loops(chance, alike, told) for alike in (True, False) for told in (True, False)]
    by_mode = program.texts()
    texts = {f"{number}_{mode.split()[0]}": text for mode, text in by_mode.items()}
    loops = chance.choice(sets)
    slow = asked(tally, given.vpost, program, by_mode, loops, chance)
    if slow:
        texts[f"{number}_slow"] = slow[1]
    made = motions(texts, given.interpreter)
    with tempfile.TemporaryDirectory() as temporary:
        for mode, text in by_mode.items():
            motion = made.get(f"{number}_{mode.split()[0]}")
            for which in sets if motion else ():
                said = Said(given.vpost, text, which, pathlib.Path(temporary))
                one(tally, program, mode, text, motion, which, said)
    if slow and f"{number}_slow" in made:
        mode, text, tolerance_um, named = slow
        off_um = 1e3 * made[f"{number}_slow"].off(program.path, loops)[0]
        may_um = tolerance_um + (judge.HALF_STEP_MM + judge.SLACK_MM + RECORDED_MM + MODES[mode]) * 1e3
        tally.slowed.append(off_um / (tolerance_um + MODES[mode] * 1e3))
        if off_um > may_um:
            why = f"{off_um:.2f} um at F{named}, which is named for {tolerance_um} um"
            tally.fault(f"{program.name} {mode} slow", why, text, loops)
    print(f"{program.name}: {len(made)} runs", flush=True)


def main():
    arguments = campaign.parser(__doc__, programs=len(ORDER), first=0)
    arguments.add_argument("--interpreter", action="store_true")
    given = arguments.parse_args()
    tally = Tally(given.keep)
    for number in range(given.first, given.first + given.programs):
        one_program(given, tally, number)
    return 0 if tally.told() else 1


if __name__ == "__main__":
    sys.exit(main())
