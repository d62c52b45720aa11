#!/usr/bin/env python3
"""Judge of the loop: a machine is measured on the rig, diagnosed, corrected and measured again; is it better by what
was said?

    loop.py --vpost target/release/vpost --machines 20 [--seed 1] [--interpreter] [--keep DIR]

A measuring program runs through LinuxCNC's motion controller under exact stop and stands at each place; the tip there,
with 0.5 um of noise, an offset for each line and a frame that is turned, is what `vpost diagnose` is given, other
lines are the hold-out. Then the same program and a part, both corrected by the profile that was written, run again.
Wrong (exit status 1) is a machine of which a cause is neither named nor in the set, whose part's error goes down by
less than 95 %, or whose rows of the hold-out shrink by more than five points more or less than was said. Errors are
counted as a part and an instrument have them: less the shift and turn of the whole, before and after alike; play
counts as the axes were dragged.
"""

import json
import random
import re
import subprocess
import sys

import numpy as np

import campaign
import canon
import judge
import rig
from causes import TRAVEL_MM, Caused
from machine import AXES
from programs import Writer

NOISE_UM = 0.5
OFFSET_UM, TURN_URAD = 20.0, 40.0  # of each line's zero, of the instrument's frame
DWELL_S, SETTLED_MS = 0.05, 8
DOWN, POINTS = 0.95, 0.05
ATTEMPTS = 3
STEP_MM = 0.5  # of a way that the interpreter says
READINGS = 2  # at each stop
COLUMNS = "run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,dir_x,dir_y,dir_z,repeat,u_um"


class Late(RuntimeError):
    """The controller, which has no real-time kernel here, fell behind by a whole dwell."""


def lines(chance):
    """Measured and held-out lines: name, places (n, 3) in machine mm; passed both ways."""
    low, high = (np.array([TRAVEL_MM[axis][k] for axis in AXES]) for k in (0, 1))
    span = high - low
    found = []
    for axis in range(3):
        for number, beside in enumerate(((0.5, 0.5), (0.12, 0.85), (0.88, 0.2))):
            shares = np.linspace(0.02, 0.98, 17 if number == 0 else 9)
            shares[1:-1] += [chance.uniform(-0.4, 0.4) * (shares[1] - shares[0]) for _ in shares[1:-1]]
            places = np.empty((len(shares), 3))
            for other, share in zip((k for k in range(3) if k != axis), beside):
                places[:, other] = low[other] + span[other] * share
            places[:, axis] = low[axis] + span[axis] * shares
            found.append((f"{AXES[axis]}{number}", places))
    for number, ends in enumerate((((0.03, 0.03, 0.03), (0.97, 0.97, 0.97)), ((0.97, 0.03, 0.05), (0.03, 0.97, 0.95)))):
        share = np.sort([chance.uniform(0, 1) for _ in range(9)])[:, None]
        found.append((f"D{number}", low + span * (np.array(ends[0]) * (1 - share) + np.array(ends[1]) * share)))
    held = []
    for number in range(4):
        ends = [np.array([chance.uniform(0.05, 0.95) for _ in AXES]) for _ in range(2)]
        share = np.sort([chance.uniform(0, 1) for _ in range(7)])[:, None]
        held.append((f"H{number}", low + span * (ends[0] * (1 - share) + ends[1] * share)))
    return found, held


def sides_known(writer, zero_mm):
    """Rapids that take up every axis' play, as ways from a tool change do."""
    for share in (0.5, 0.45):
        place = [TRAVEL_MM[axis][0] + share * (TRAVEL_MM[axis][1] - TRAVEL_MM[axis][0]) for axis in AXES]
        writer.rapid(**dict(zip("xyz", place - zero_mm)))


def measuring_program(lines, zero_mm):
    """Text, and of each stop the line's name and the place, machine mm."""
    writer, stops = Writer("G61"), []
    sides_known(writer, zero_mm)
    for name, places in lines:
        first = places[0] - zero_mm
        writer.rapid(z=first[2])
        writer.rapid(x=first[0], y=first[1])
        for place in [*places, *places[-2::-1]]:
            writer.feed(**dict(zip("xyz", place - zero_mm)), f=60000)
            writer.dwell(DWELL_S)
            stops.append((name, np.round(place - zero_mm, 3) + zero_mm))
    writer.blocks.append("M2")
    return ("\n".join(writer.blocks) + "\n").encode(), stops


def part_program(zero_mm):
    """Contours on two levels of the travel, with arcs and slants, and their path from the zero."""
    writer = Writer("G61")
    low, high = (np.array([TRAVEL_MM[axis][k] for axis in AXES]) - zero_mm for k in (0, 1))
    x, y, z = np.linspace(low + 15, high - 15, 5).T
    sides_known(writer, zero_mm)
    for level in (0, 4):
        writer.rapid(z=z[level])
        writer.rapid(x=x[0], y=y[0])
        writer.feed(x=x[4], f=24000)
        writer.feed(y=y[4])
        writer.feed(x=x[0], z=z[2])
        writer.feed(y=y[0], z=z[level])
        writer.feed(x=x[1], y=y[2], z=z[4 - level])
        middle = (float(x[2]), float(round(writer.path[-1][1], 3)))
        writer.arc("G3", middle, (round(2 * middle[0] - writer.path[-1][0], 3), middle[1]))
        writer.feed(x=x[4], y=y[4], z=z[2])
        writer.feed(x=x[2], y=y[0])
    writer.blocks.append("M2")
    return ("\n".join(writer.blocks) + "\n").encode(), np.array(writer.path)


def unrecorded(text, control):
    """What a control that keeps to its path would be recorded with, by the interpreter: axes in mm, line; no times."""
    moves = canon.Run(canon.calls(text, control), chord_deg=0.2).moves
    blocks = enumerate(text.decode().splitlines(), 1)
    lines = [number for number, block in blocks if re.search(r"[XYZ][-.\d]", block) and not block.startswith("(")]
    if len(lines) != len(moves):
        raise RuntimeError(f"{len(moves)} motions of {len(lines)} blocks")
    rows = [np.zeros((1, 4))]
    for number, move in zip(lines, moves):
        for start, end in zip(move.corners[:-1], move.corners[1:]):
            share = np.linspace(0, 1, max(1, int(np.linalg.norm(end - start) / STEP_MM)) + 1)[1:, None]
            rows.append(np.c_[start + share * (end - start), np.full(len(share), number)])
        rows.append(np.r_[move.corners[-1], 0.0][None, :])
    return np.vstack(rows)


def settled(recorded, row):
    """The first row from one on at which nothing moves."""
    steps = np.abs(np.diff(recorded[row : row + SETTLED_MS, :3], axis=0)).max(1)
    still = np.flatnonzero(steps < 1e-7)
    if not len(still):
        raise Late(f"nothing stands behind row {row} of the recording")
    return row + int(still[0])


def stands(recorded, text, count):
    """Rows of the recording in which the axes stand at the dwells of a program: ends of the last motion before each."""
    lines, found, since = recorded[:, 3].astype(int), [], 1
    last = {line: row for row, line in enumerate(lines)}
    for number, block in enumerate(text.decode().splitlines(), 1):
        if not block.startswith("G4 "):
            continue
        ran = [line for line in range(since, number) if line in last]
        found.append(settled(recorded, last[ran[-1]]) if ran else found[-1])
        since = number
    if len(found) != count:
        raise RuntimeError(f"{len(found)} stops of {count} are in the recording")
    return np.array(found)


def sides(recorded):
    """By row and axis: the sign of its last motion, 0 where it has not moved."""
    steps = np.sign(np.diff(recorded[:, :3], axis=0, prepend=recorded[:1, :3]))
    for axis in range(3):
        moved = np.where(steps[:, axis] != 0, np.arange(len(steps)), 0)
        steps[:, axis] = steps[np.maximum.accumulate(moved), axis]
    return steps.astype(int)


def deviations(recorded, text, stops, machine):
    """Tip less place at each stop, um, and from which side each axis came there."""
    at = stands(recorded, text, len(stops))
    places = np.array([place for _, place in stops])
    away = np.abs(recorded[at, :3] - places).max(1)
    if away.max() > 1.0:
        raise RuntimeError(f"stop {away.argmax()} of the recording is {away.max():.3f} mm off its place")
    return (machine.tip_mm(recorded[:, :3])[at] - places) * 1e3, sides(recorded)[at]


def instrument(path, stops, off_um, sides, chance):
    """Writes what an instrument reads of them: an offset a line, a turned frame, noise, two readings a stop."""
    turn = np.array([chance.gauss(0, TURN_URAD) for _ in AXES]) * 1e-3
    offset = {name: [chance.uniform(-OFFSET_UM, OFFSET_UM) for _ in AXES] for name, _ in stops}
    lines = [COLUMNS]
    for (name, place), off, side in zip(stops, off_um, sides):
        for reading in range(READINGS):
            read = off + offset[name] + np.cross(turn, place) + [chance.gauss(0, NOISE_UM) for _ in AXES]
            cells = [*(f"{value:.4f}" for value in [*place, *read]), *map(str, side), str(reading + 1), str(NOISE_UM)]
            lines.append(",".join([name, *cells]))
    path.write_text("\n".join(lines) + "\n")


def turns(places):
    """What turns of a frame make of places, a column for each axis: (3 n, 3)."""
    columns = [np.cross(axis, places).ravel() for axis in np.eye(3)]
    return np.array(columns).T


def left_um(stops, off_um):
    """RMS of the deviations, um, less the shift of each line and one turn of all."""
    names = sorted({name for name, _ in stops})
    shifts = np.zeros((len(stops), 3, 3 * len(names)))
    for row, (name, _) in enumerate(stops):
        for axis in range(3):
            shifts[row, axis, 3 * names.index(name) + axis] = 1.0
    places = np.array([place for _, place in stops])
    matrix = np.hstack([shifts.reshape(3 * len(stops), -1), turns(places - places.mean(0)) * 1e-2])
    flat = off_um.ravel()
    return rms((flat - matrix @ np.linalg.lstsq(matrix, flat, rcond=None)[0]).reshape(-1, 3))


def rms(vectors):
    return float(np.sqrt((vectors**2).sum(1).mean()))


def part_um(recorded, text, machine, path):
    """RMS distance of the tip from a part's path, um: from that of the datum, and less shift and turn of the whole."""
    tips, _ = judge.on_path(recorded, judge.feed_lines(text), machine, path)
    tips = tips[::2]
    off, piece = judge.offsets(tips, path)
    way = path[1:] - path[:-1]
    along = way[piece] / np.maximum(np.linalg.norm(way[piece], axis=1), 1e-12)[:, None]
    square = np.eye(3) - along[:, :, None] * along[:, None, :]
    off = np.einsum("nij,nj->ni", square, off)
    moves = np.concatenate([np.tile(np.eye(3), (len(tips), 1)), turns(tips - tips.mean(0)) * 1e-2], axis=1)
    matrix = np.einsum("nij,njk->nik", square, moves.reshape(len(tips), 3, 6)).reshape(-1, 6)
    best = np.linalg.lstsq(matrix, off.ravel(), rcond=None)[0]
    return rms(off) * 1e3, rms((off.ravel() - matrix @ best).reshape(-1, 3)) * 1e3


class Found:
    """What `vpost diagnose` says of a machine."""

    def __init__(self, vpost, folder):
        self.profile = folder / "found.toml"
        command = [vpost, "diagnose", folder / "rows.csv", "-m", folder / "machine.toml"]
        command += ["--holdout", folder / "held.csv", "--json", folder / "diagnosis.json"]
        command += ["--write-profile", self.profile]
        ran = subprocess.run(command, capture_output=True, text=True)
        self.said = ran.stdout + ran.stderr
        if ran.returncode:
            raise RuntimeError(f"diagnose ends with {ran.returncode}: {self.said}")
        told = json.loads((folder / "diagnosis.json").read_text())
        self.verdict, self.causes = told["verdict"], told["causes"]
        self.named = [cause["effect"] for cause in self.causes]
        self.rivals = {name for cause in self.causes for name in cause.get("cannot_be_told_from") or []}
        forecast = (self.causes[-1].get("shrink_predicted") or {}) if self.causes else {}
        self.forecast = forecast.get("mid")


class Case:
    """A machine and its programs."""

    def __init__(self, number, given):
        self.chance = random.Random(f"loop {given.seed} {number}")
        self.name, self.vpost, self.interpreter = f"m{number}", given.vpost, given.interpreter
        self.machine = Caused(self.chance, self.chance.randint(2, 6))
        measured, held = lines(self.chance)
        self.held_names = {name for name, _ in held}
        self.text, self.stops = measuring_program(measured + held, self.machine.zero_mm)
        self.held = np.array([name in self.held_names for name, _ in self.stops])
        self.part, path = part_program(self.machine.zero_mm)
        zero = self.machine.zero_mm
        self.path = path + zero + self.machine.error_mm(zero[None, :])[0]

    def some(self, held):
        return [stop for stop, one in zip(self.stops, self.held) if one == held]

    def run(self, **texts):
        """What was recorded of programs, the measuring one among them, with all of its stops."""
        control = rig.Control({"G54": self.machine.zero_mm}, limits=rig.QUICK)
        if self.interpreter:
            return {name: unrecorded(text, control) for name, text in texts.items()}
        for attempt in range(ATTEMPTS):
            recorded = rig.run(texts, control)
            try:
                stands(recorded["a_measure"], texts["a_measure"], len(self.stops))
                return recorded
            except Late:
                if attempt == ATTEMPTS - 1:
                    raise

    def measure(self, folder):
        """The first recording: what is to be diagnosed; RMS of held-out rows and of the part before, um."""
        self.machine.write(folder)
        recorded = self.run(a_measure=self.text, b_part=self.part)
        off, sides = deviations(recorded["a_measure"], self.text, self.stops, self.machine)
        for name, held in (("rows.csv", False), ("held.csv", True)):
            which = self.held == held
            instrument(folder / name, self.some(held), off[which], sides[which], self.chance)
        before = left_um(self.some(True), self.read(off[self.held]))
        return before, part_um(recorded["b_part"], self.part, self.machine, self.path)

    def read(self, off_um):
        """Deviations as one reading of each stop has them."""
        noise = [[self.chance.gauss(0, NOISE_UM) for _ in AXES] for _ in off_um]
        return off_um + np.array(noise)

    def again(self, folder, profile):
        """The second recording, both programs corrected."""
        texts = {}
        for name, text in (("a_measure", self.text), ("b_part", self.part)):
            texts[name], why = judge.correct(self.vpost, profile, text, folder)
            if texts[name] is None:
                raise RuntimeError(f"{name} is refused: {why}")
            (folder / f"{name}.ngc").write_bytes(text)
            (folder / f"{name}_corrected.ngc").write_bytes(texts[name])
        recorded = self.run(**texts)
        off, _ = deviations(recorded["a_measure"], texts["a_measure"], self.stops, self.machine)
        after = left_um(self.some(True), self.read(off[self.held]))
        return after, part_um(recorded["b_part"], texts["b_part"], self.machine, self.path)


def judged(case, folder):
    """A row of the table, and what is wrong with it."""
    held_before, part_before = case.measure(folder)
    found = Found(case.vpost, folder)
    (folder / "said.txt").write_text(found.said)
    truth = ", ".join(f"{name} {words}" for name, words in case.machine.causes.items())
    (folder / "truth.txt").write_text(truth + "\n")
    wrong = [f"{name} is neither named nor in the set" for name in case.machine.causes
             if name not in found.named and name not in found.rivals]
    if not found.profile.exists():
        return f"{case.name} {found.verdict} wrote no profile ({truth})", [*wrong, "no profile was written"]
    held_after, part_after = case.again(folder, found.profile)
    achieved, down = 1 - held_after / held_before, 1 - part_after[1] / part_before[1]
    if found.forecast is None or abs(found.forecast - achieved) > POINTS:
        wrong.append(f"forecast {found.forecast}, achieved {achieved:.3f}")
    if down < DOWN:
        wrong.append(f"the part's error goes down by {down:.3f}")
    row = f"{case.name} {found.verdict:9} {len(case.machine.causes)} causes, {len(found.named)} named; held out "
    row += f"{held_before:.2f} -> {held_after:.2f} um, said {found.forecast or 0:.3f} came {achieved:.3f}; part "
    row += f"{part_before[1]:.2f} -> {part_after[1]:.2f} um ({part_before[0]:.2f} -> {part_after[0]:.2f} with its "
    row += f"frame), {down:.3f}"
    return row, wrong


def main():
    arguments = campaign.parser(__doc__, machines=1, first=0)
    arguments.add_argument("--interpreter", action="store_true", help="its way in the place of a recording: minutes")
    given = arguments.parse_args()
    failed = 0
    for number in range(given.first, given.first + given.machines):
        case = Case(number, given)
        with campaign.folder(given.keep, f"seed{given.seed}_{case.name}") as folder:
            try:
                row, wrong = judged(case, folder)
            except RuntimeError as why:
                row, wrong = f"{case.name} did not come round", [str(why)]
        print("\n   ".join([row, *wrong]), flush=True)
        failed += bool(wrong)
    print(f"{given.machines} machines, {failed} outside")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
