#!/usr/bin/env python3
"""Judge of `vpost restart`: does a program that begins at a line go on as the whole program does from there?

    restart.py --vpost target/release/vpost --interpreter --lines 5000 [--seed 1] [--only KIND,...] [--keep DIR]
    restart.py --vpost target/release/vpost --rig --programs 20 --lines 10 [--seed 1] [--keep DIR]

Programs are those of posts.py, corrected for a machine of machine.py where vpost corrects them, as posted else. With
`--interpreter` LinuxCNC's stand-alone interpreter reads both: where line N begins the state must be the same, axes
must stand at the same place and hang on the same side of their play, all canonical calls from there on must be the
same; and what comes before must reach that place from above: no way across below the highest Z that the program
commanded with that tool and offset before, no way down elsewhere, the last of it under feed and with the spindle on.
With `--rig` both run through the motion controller, on a machine that has play: all of the tip's way from N on must be
where that of the whole program is.

A line may be refused: by exit status 1, with nothing on standard output and its number in the message; a line before
it that the message names must then be possible. A refusal for which this judge sees no reason is counted; more than
one in twenty of them are wrong, as is everything else (exit status 1).
"""

import collections
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
import posts
import rig
from machine import Machine, played

SAME_MM = 6e-4  # half the last digit of a word, and of what the interpreter prints
SAME_INCH = 1.1e-4
FIRM = 0.7  # of half a play: the interpreter prints inches to 2.5 um
HIGHER_MM = 7.5
TIMID = 0.05
RIG_MM = 1.5e-3
RIG_MODES = ["G61", "G61.1", "G64 P0.01"]
NEAR_START_MM = 1.0  # a control that rounds corners cannot round the one where it starts
RIG_KINDS = [
    "plate", "slots", "helix", "other_planes", "raster", "spline", "holes", "pecks", "tools", "zeros", "increments",
    "inches", "inverse_time", "shifted", "numbered", "switches", "radii", "ramps",
]


class Wrong(Exception):
    """What is not as it should be."""


def controls():
    return rig.Control(posts.ZEROS_MM, lengths_mm=posts.LENGTHS_MM)


class Played(Machine):
    """A crooked machine with play, whose profile knows tools and zeros of posts.py."""

    def __init__(self, chance):
        super().__init__(chance)
        self.half_play_um = [chance.uniform(4, 12) for _ in "XYZ"]

    def write(self, folder):
        path = super().write(folder)
        lines = [line for line in path.read_text().splitlines() if not line.startswith("work_offsets_mm")]
        zeros = ", ".join(f'{name} = {{ at = {list(zero)}, zero = "true" }}' for name, zero in posts.ZEROS_MM.items())
        lengths = ", ".join(f"H{number} = {length}" for number, length in posts.LENGTHS_MM.items())
        lines.append(f"work_offsets_mm = {{ {zeros} }}")
        lines.append(f"tool = {{ lengths_mm = {{ {lengths} }} }}")
        lines.append('program = { tool_change = { keeps = "XYZ" } }')
        path.write_text("\n".join(lines) + "\n")
        return path


class Restarted:
    """What `vpost restart` makes of a line."""

    def __init__(self, vpost, program, line, profile, safe=None):
        command = [vpost, "restart", program, "--line", str(line), "-m", profile]
        command += ["--safe-z", f"{safe:.3f}"] if safe is not None else []
        ran = subprocess.run(command, capture_output=True)
        self.line, self.said, self.text = line, ran.stderr.decode(errors="replace"), ran.stdout
        self.safe, self.status = safe, ran.returncode
        if ran.returncode not in (0, 1):
            raise Wrong(f"exit status {ran.returncode}: {self.said}")
        self.refused = ran.returncode == 1
        if self.refused and ran.stdout:
            raise Wrong("refused, and something was written")
        if self.refused and not re.search(rf"\b{line}\b", self.said):
            raise Wrong(f"refused, and the line is not named: {self.said}")

    def before(self):
        """A line before it that a refusal names, or None."""
        named = [int(number) for number in re.findall(r"\bline (\d+)", self.said)]
        earlier = [number for number in named if number < self.line]
        return max(earlier) if earlier else None

    def begins(self, whole):
        """Line (1-based) at which its tail begins, which has to be that of the whole program."""
        tail = whole.splitlines(keepends=True)[self.line - 1 :]
        own = self.text.splitlines(keepends=True)
        if own[len(own) - len(tail) :] != tail:
            raise Wrong("it does not end with the lines of the program")
        return len(own) - len(tail) + 1


def same_call(one, other, may):
    """Whether two calls do the same, places within the last digit of the unit in force."""
    if one == other:
        return True
    if one[0] != other[0] or one[0] not in canon.MOTIONS:
        return False
    values = [canon.numbers(words) for words in (one[1], other[1])]
    return len(values[0]) == len(values[1]) and max(abs(a - b) for a, b in zip(*values)) <= may


def hangs(way, half_play_um):
    """By axis: where it stands against its screw at the end of a way, in halves of its play."""
    half_mm = np.array(half_play_um) * 1e-3
    return (played(way, half_mm)[-1] - way[-1]) / half_mm


def safe_height(run):
    """Highest Z that was commanded with the tool and the offset of the end, program mm; None where nothing was."""
    kept = ("CHANGE_TOOL", "SET_G5X_OFFSET", "SET_G92_OFFSET", "USE_TOOL_LENGTH_OFFSET")
    heights = [
        move.program_z[1:].max()
        for move in run.moves
        if move.changes(2) and all(move.state.get(key) == run.state.get(key) for key in kept)
    ]
    return max(heights) if heights else None


def counts(key, then):
    """Whether a state still holds in the calls behind it when it is used: F when something is fed, others when it moves."""
    for name, _ in then:
        if canon.OF_ONE_STATE.get(name, name) == key:
            return False
        if name in canon.MOTIONS and not (key == "SET_FEED_RATE" and name == "STRAIGHT_TRAVERSE"):
            return True
    return False


def feeds_so(first, then, axis, given):
    """Whether the whole feeds anything, behind its first calls, before an axis has taken up its play anew."""
    whole, begins = canon.Run(first + then), len(canon.Run(first).moves)
    column = "XYZ".index(axis)
    play_mm = 2e-3 * given.machine.half_play_um[column]
    place = whole.moves[begins - 1].corners[-1, column] if begins else 0.0
    for move in whole.moves[begins:]:
        if np.abs(move.corners[:, column] - place).max() > play_mm:
            return move.name != "STRAIGHT_TRAVERSE" and not_alone(move, column)
        if move.name != "STRAIGHT_TRAVERSE":
            return True
    return False


def not_alone(move, column):
    """Whether a motion leads along other axes too."""
    return any(move.changes(other) for other in range(3) if other != column)


def approach(run, whole, safe):
    """What comes before the line: from above, down where it goes on, the spindle on. `safe` is program mm."""
    end = whole.at
    shift = run.shift()
    raised = False
    for move in run.moves:
        z = move.corners[:, 2] - shift[2]
        across = move.changes(0) or move.changes(1)
        if across and move.name == "ARC_FEED":
            raise Wrong("an arc comes before the line")
        if safe is None:
            continue
        if across and not raised:
            raise Wrong("X or Y moves before Z was raised")
        if across and min(z) < safe - SAME_MM:
            raise Wrong(f"a way across at Z{min(z):.3f}, below {safe:.3f}")
        if not across and z[-1] < safe - SAME_MM:
            if np.abs(move.corners[-1, :2] - end[:2]).max() > SAME_MM:
                raise Wrong(f"down to Z{z[-1]:.3f} where the line does not begin")
            if move.state.get("spindle") != whole.state.get("spindle"):
                raise Wrong("down without its spindle")
        raised = raised or move.changes(2)
    fed = whole.moves and whole.moves[-1].name != "STRAIGHT_TRAVERSE"
    down = [move for move in run.moves if move.changes(2) and move.corners[-1, 2] < move.corners[0, 2]]
    if fed and safe is not None and end[2] - shift[2] < safe - SAME_MM and down and down[-1].name != "STRAIGHT_FEED":
        raise Wrong("the last way down is no feed")


def compare(whole, given, restarted):
    """Both programs as the interpreter has them; Wrong where they differ."""
    first, then = canon.split(whole)
    begins = restarted.begins(given.text)
    try:
        own, own_then = canon.split(canon.calls(canon.marked(restarted.text, begins), controls()))
    except canon.Refused as why:
        raise Wrong(f"the interpreter refuses it: {why}") from why
    whole, run = canon.Run(first), canon.Run(own)
    for key in sorted(set(whole.state) | set(run.state)):
        if whole.state.get(key) != run.state.get(key) and counts(key, then):
            raise Wrong(f"{key}: {whole.state.get(key)} in the whole, {run.state.get(key)} in the restarted program")
    unit = whole.unit
    if np.abs(whole.at - run.at).max() > (SAME_MM if unit == 1.0 else SAME_INCH * unit):
        raise Wrong(f"begins at {run.at}, the whole is at {whole.at}")
    for k, (one, other) in enumerate(zip(then, own_then)):
        if one[0] == "USE_LENGTH_UNITS":
            unit = canon.INCH_MM if "INCHES" in one[1] else 1.0
        if not same_call(one, other, SAME_MM if unit == 1.0 else SAME_INCH):
            raise Wrong(f"call {k} from the line on: {one} in the whole, {other} in the restarted program")
    if len(then) != len(own_then):
        raise Wrong(f"{len(own_then)} calls from the line on, the whole has {len(then)}")
    if whole.moves:
        side, own_side = (hangs(one.way(), given.machine.half_play_um) for one in (whole, run))
        for axis, one, other in zip("XYZ", side, own_side):
            if abs(one) > FIRM and abs(one - other) > 1 - FIRM and feeds_so(first, then, axis, given):
                raise Wrong(f"{axis} hangs at {other:+.2f} of its play, in the whole at {one:+.2f}")
        approach(run, whole, safe_height(whole) if restarted.safe is None else restarted.safe)


def reasons(given, whole, line):
    """Why a restart at a line may be refused."""
    text = given.text
    before = b"\n".join(text.splitlines()[: line - 1]).decode().upper()
    code = re.sub(r"\([^)]*\)|;.*", "", before)
    found = []
    if re.search(r"\bO\d+\s*SUB", code):
        found.append("subprograms")
    if "#" in re.sub(r"\([^)]*\)|;.*", "", text.decode().upper()):
        found.append("variables")
    cutter = re.findall(r"\bG4[012](?:\.1)?(?![\d.])", code)
    if cutter and cutter[-1] != "G40":
        found.append("cutter compensation")
    try:
        run = canon.Run(canon.split(whole)[0])
    except canon.Refused:
        return [*found, "the line is not run once"]
    safe = safe_height(run)
    if safe is None:
        return [*found, "no height is known"]
    named = [any(move.changes(axis) for move in since_change(run)) for axis in range(3)]
    if not all(named):
        found.append("not all axes are named since start or tool change")
    if hangs(run.way(), given.machine.half_play_um)[2] < 0 and run.at[2] - run.shift()[2] < safe - SAME_MM:
        found.append("Z goes up in the material")
    last = [move for move in run.moves if move.changes(0) or move.changes(1) or move.changes(2)]
    if last and last[-1].program_z[-1] > safe + SAME_MM:
        found.append("above all that was commanded")
    return found


def since_change(run):
    """Moves since the tool, its length or the offset last changed."""
    kept = ("CHANGE_TOOL", "SET_G5X_OFFSET", "SET_G92_OFFSET", "USE_TOOL_LENGTH_OFFSET")
    found = []
    for move in reversed(run.moves):
        if any(move.state.get(key) != run.state.get(key) for key in kept):
            break
        found.append(move)
    return found


class Given:
    """A program, its profile and the folder it lies in."""

    def __init__(self, vpost, kind, chance, folder, mode=None):
        self.vpost, self.kind, self.folder = vpost, kind, folder
        self.machine = Played(chance)
        self.profile = self.machine.write(folder)
        posted = posts.make(kind, chance, mode)
        corrected, self.why = judge.correct(vpost, self.profile, posted, folder)
        self.text = posted if corrected is None else corrected
        self.corrected = corrected is not None
        self.path = folder / "whole.ngc"
        self.path.write_bytes(self.text)
        self.count = len(self.text.splitlines())

    def restarted(self, line, safe=None):
        return Restarted(self.vpost, self.path, line, self.profile, safe)


class Tally:
    """What became of the lines."""

    def __init__(self, keep):
        self.keep, self.wrong, self.timid, self.done = keep, [], [], 0
        self.kinds = collections.defaultdict(collections.Counter)
        self.excused = collections.Counter()

    def fault(self, given, line, why, restarted=None):
        self.kinds[given.kind]["wrong"] += 1
        self.wrong.append(f"{given.kind} line {line}: {why}")
        print(self.wrong[-1], flush=True)
        if self.keep:
            folder = self.keep / f"{given.kind}_{len(self.wrong)}"
            folder.mkdir(parents=True, exist_ok=True)
            for file in given.folder.iterdir():
                (folder / file.name).write_bytes(file.read_bytes())
            text = restarted.text if restarted else b""
            (folder / "restarted.ngc").write_bytes(text)
            (folder / "why.txt").write_text(f"line {line}\n{why}\n{restarted.said if restarted else ''}")

    def refusal(self, given, line, excuses, said):
        self.kinds[given.kind]["refused"] += 1
        self.excused[", ".join(excuses) or "no reason seen"] += 1
        if not excuses:
            first = next((row for row in said.splitlines() if row.startswith("error")), said[:200])
            self.timid.append(f"{given.kind} line {line}: {first}")

    def told(self):
        """The table; whether all is as it should be."""
        print(f"{'kind':16} lines  same refused wrong")
        for kind, counted in sorted(self.kinds.items()):
            print(f"{kind:16} {counted.total():5} {counted['same']:5} {counted['refused']:7} {counted['wrong']:5}")
        print("refused for:", *(f"\n  {count:5} {why}" for why, count in self.excused.most_common()))
        print(*(f"no reason seen: {line}\n" for line in self.timid[:20]), sep="", end="")
        whole = sum(counted.total() for counted in self.kinds.values())
        print(f"{whole} lines, {len(self.wrong)} outside, {len(self.timid)} refused without a reason that was seen")
        return whole > 0 and not self.wrong and len(self.timid) <= TIMID * whole


def one_line(given, line, tally, follow=True):
    """Judges one line by the interpreter; the line that a refusal names in its place too."""
    restarted = None
    try:
        whole = canon.calls(canon.marked(given.text, line), controls())
        restarted = given.restarted(line, asked_height(whole) if line % 5 == 0 else None)
        if restarted.refused:
            tally.refusal(given, line, reasons(given, whole, line), restarted.said)
            if follow and (before := restarted.before()):
                named_line(given, before, tally)
            return
        compare(whole, given, restarted)
        tally.kinds[given.kind]["same"] += 1
    except Wrong as why:
        tally.fault(given, line, str(why), restarted)


def asked_height(whole):
    """A height above all that was commanded, which a user may ask for, program mm."""
    try:
        safe = safe_height(canon.Run(canon.split(whole)[0]))
    except canon.Refused:
        return None
    return None if safe is None else safe + HIGHER_MM


def beyond(given, tally):
    """Lines that the program does not have are refused."""
    for line in (0, given.count + 1):
        ran = subprocess.run(
            [given.vpost, "restart", given.path, "--line", str(line), "-m", given.profile], capture_output=True
        )
        if ran.returncode not in (1, 2) or ran.stdout or not ran.stderr:
            tally.fault(given, line, f"it has {given.count} lines: exit status {ran.returncode}")


def named_line(given, line, tally):
    """A line at which a refusal says that a restart is possible."""
    restarted = given.restarted(line)
    if restarted.refused:
        raise Wrong(f"line {line}, which a refusal names, is refused: {restarted.said}")
    try:
        compare(canon.calls(canon.marked(given.text, line), controls()), given, restarted)
    except Wrong as why:
        raise Wrong(f"at line {line}, which a refusal names: {why}") from why


def by_interpreter(given, tally):
    """Random lines of random programs."""
    kinds = given.only.split(",") if given.only else sorted(posts.KINDS)
    number = done = 0
    while done < given.lines:
        chance = random.Random(f"restart {given.seed} {number}")
        kind = kinds[number % len(kinds)]
        number += 1
        with tempfile.TemporaryDirectory() as temporary:
            program = Given(given.vpost, kind, chance, pathlib.Path(temporary))
            beyond(program, tally)
            lines = chance.sample(range(2, program.count), min(20, program.count - 2, given.lines - done))
            for line in lines:
                one_line(program, line, tally)
                done += 1


def tail_tips(recorded, machine, begins):
    """Way of the tip from a line on, machine mm, without standing rows, and whether each row feeds."""
    tips = machine.tip_mm(recorded[:, :3])
    lines = recorded[:, 3].astype(int)
    at = np.flatnonzero(lines >= begins)
    if not len(at):
        return tips[:0]
    tips = tips[at[0] :]
    moved = np.r_[True, np.abs(np.diff(tips, axis=0)).max(1) > 1e-9]
    return tips[moved]


def compare_ways(whole, own, blend_mm):
    """Both ways of the tip from a line on, each against the other; Wrong where they part."""
    if len(whole) < 2 or len(own) < 2:
        if abs(len(whole) - len(own)) > 2:
            raise Wrong(f"{len(own)} places from the line on, the whole has {len(whole)}")
        return 0.0
    worst = 0.0
    for points, path in ((own, whole), (whole, own)):
        off = judge.distances(points, path)
        begin = np.linalg.norm(points - path[0], axis=1)
        may = np.where(begin <= NEAR_START_MM, RIG_MM + blend_mm, RIG_MM)
        if (off > may).any():
            k = int((off - may).argmax())
            raise Wrong(f"the tip is {off[k] * 1e3:.2f} um off the other way, {begin[k]:.2f} mm from where it begins")
        worst = max(worst, float(off[begin > NEAR_START_MM].max(initial=0.0)))
    return worst


def by_rig(given, tally):
    """Programs with lines, whole and restarted, each program in one start of the controller."""
    worst = 0.0
    for number in range(given.first, given.first + given.programs):
        chance = random.Random(f"rig {given.seed} {number}")
        kind = RIG_KINDS[number % len(RIG_KINDS)]
        with tempfile.TemporaryDirectory() as temporary:
            mode = chance.choice(RIG_MODES)
            program = Given(given.vpost, kind, chance, pathlib.Path(temporary), mode)
            texts, made = {"a_whole": program.text}, {}
            for line in chance.sample(range(2, program.count), min(given.lines, program.count - 2)):
                try:
                    one = program.restarted(line)
                    if one.refused:
                        whole = canon.calls(canon.marked(program.text, line), controls())
                        tally.refusal(program, line, reasons(program, whole, line), one.said)
                        continue
                    made[line], texts[f"b_{line:05}"] = (one, one.begins(program.text)), one.text
                except Wrong as why:
                    tally.fault(program, line, str(why))
            recorded = rig.run(texts, controls())
            for line, (one, begins) in made.items():
                try:
                    ways = [
                        tail_tips(recorded["a_whole"], program.machine, line),
                        tail_tips(recorded[f"b_{line:05}"], program.machine, begins),
                    ]
                    worst = max(worst, compare_ways(*ways, 0.02 if "P" in mode else 0.0))
                    tally.kinds[kind]["same"] += 1
                except Wrong as why:
                    tally.fault(program, line, f"{mode}: {why}", one)
            print(f"{kind} {mode}: {len(made)} lines, worst so far {worst * 1e3:.3f} um", flush=True)


def main():
    arguments = campaign.parser(__doc__, programs=20, first=0)
    arguments.add_argument("--interpreter", action="store_true")
    arguments.add_argument("--rig", action="store_true")
    arguments.add_argument("--lines", type=int, default=10, help="in all, of each program with --rig")
    arguments.add_argument("--only", default="")
    given = arguments.parse_args()
    if given.interpreter == given.rig:
        arguments.error("one of --interpreter and --rig")
    tally = Tally(given.keep)
    (by_interpreter if given.interpreter else by_rig)(given, tally)
    return 0 if tally.told() else 1


if __name__ == "__main__":
    sys.exit(main())
