#!/usr/bin/env python3
"""Judge of the control's part: corrected programs run by LinuxCNC's motion controller, on machines that are crooked in ways
written here; is the tip where vpost says that it will be?

    judge.py --vpost target/release/vpost --machines 20 [--seed 1] [--programs 6] [--keep DIR]

The tip is the recorded command of the axes and the machine's error there; distances are those from the programmed path. What
may be: the tolerance, half an output step of each axis, and what vpost says that the control adds (`control_um` of its
summary). Where it says that this is not known nothing is promised, and the distance is in the table alone. Exit status 1
where a tip is farther off than was said, or a program is refused. What is modelled stands in README.md.
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

import campaign
import programs
import rig
from machine import Machine

TOLERANCE_MM = 1e-3
HALF_STEP_MM = 0.5e-3 * 3**0.5
SLACK_MM = 2e-5  # the axes' commands are written with six decimals, arcs are compared as chords
MODES = ["", "G64", "G64 P0.05", "G64 P0.05 Q0.002", "G64 P0.002", "G61", "G61.1"]


def offsets(points, path):
    """Each point less the place nearest to it of a path of straight pieces, mm, and that piece's number."""
    start, way = path[:-1], path[1:] - path[:-1]
    length2 = np.maximum((way**2).sum(1), 1e-18)
    found, pieces = [], []
    for part in np.array_split(points, max(1, len(points) * len(start) // 2_000_000)):
        to = part[:, None, :] - start[None, :, :]
        share = np.clip((to * way).sum(2) / length2, 0.0, 1.0)
        off = to - share[:, :, None] * way
        nearest = (off**2).sum(2).argmin(1)
        found.append(off[np.arange(len(part)), nearest])
        pieces.append(nearest)
    return np.concatenate(found), np.concatenate(pieces)


def distances(points, path):
    """How far each point is from a path of straight pieces, mm."""
    return np.sqrt((offsets(points, path)[0] ** 2).sum(1))


def on_path(recorded, lines, machine, path):
    """Places of the tip while it feeds, mm, and how far each is from its path. A feed behind a rapid may first lead from where
    that has left the tip to the corrected start, in the air: the path counts from there."""
    feeds = np.isin(recorded[:, -1].astype(int), sorted(lines))
    tips = machine.tip_mm(recorded[:, :-1])[feeds]
    off = distances(tips, path)
    begins = np.flatnonzero(feeds & ~np.r_[False, feeds[:-1]])
    counted = np.ones(len(off), dtype=bool)
    for begin in begins:
        at = int(feeds[:begin].sum())
        while at + 1 < len(off) and off[at + 1] < off[at]:
            counted[at] = False
            at += 1
    return tips[counted], off[counted]


def farthest(recorded, lines, machine, path):
    """The largest distance of the tip from its path while it feeds, mm."""
    return float(on_path(recorded, lines, machine, path)[1].max())


def feed_lines(text):
    """Numbers of lines that feed."""
    found, feeds = set(), False
    for number, line in enumerate(text.decode().splitlines(), 1):
        words = line.split("(")[0].replace(";", " ").split()
        for word in words:
            if word in ("G0", "G1", "G2", "G3"):
                feeds = word != "G0"
        if feeds and any(word[0] in "XYZABC" for word in words):
            found.add(number)
    return found


def correct(vpost, profile, text, folder, *options):
    """The corrected program and the summary; what was said where it is refused."""
    given, made, summary = folder / "in.ngc", folder / "out.ngc", folder / "summary.json"
    given.write_bytes(text)
    ran = subprocess.run(
        [vpost, given, "-m", profile, "-o", made, "--summary", summary, *options], capture_output=True, text=True
    )
    if ran.returncode:
        return None, ran.stderr
    return made.read_bytes(), json.loads(summary.read_text())


def main():
    given = campaign.parser(__doc__, machines=1, programs=len(programs.KINDS)).parse_args()
    wrong, table = [], {}
    for number in range(given.machines):
        chance = random.Random(f"{given.seed} {number}")
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            machine = Machine(chance)
            profile = machine.write(folder)
            texts, paths, said = {}, {}, {}
            for kind in chance.sample(sorted(programs.KINDS), given.programs):
                mode = chance.choice(MODES)
                name = f"m{number}_{kind}"
                text, paths[name] = programs.make(kind, mode, chance)
                corrected, summary = correct(given.vpost, profile, text, folder)
                if corrected is None:
                    wrong.append(f"{name} {mode}: refused\n{summary}")
                    continue
                texts[f"{name}_posted"], texts[name] = text, corrected
                said[name] = (mode, summary)
            recorded = rig.run(texts, rig.Control({"G54": machine.zero_mm}))
            for name, (mode, summary) in said.items():
                off = []
                for of in (f"{name}_posted", name):
                    path = paths[name] + machine.zero_mm
                    off.append(farthest(recorded[of], feed_lines(texts[of]), machine, path))
                control_um = summary["control_um"]
                may = np.inf if control_um is None else TOLERANCE_MM + HALF_STEP_MM + SLACK_MM + control_um * 1e-3
                line = table.setdefault(mode or "as it starts", [0, 0.0, 0.0, control_um])
                line[0] += 1
                line[1:3] = [max(line[1], off[0]), max(line[2], off[1])]
                if off[1] > may:
                    wrong.append(f"{name} {mode}: {off[1] * 1e3:.2f} um, said are {may * 1e3:.2f}")
                if given.keep and off[1] > may:
                    given.keep.mkdir(parents=True, exist_ok=True)
                    (given.keep / f"{name}.ngc").write_bytes(texts[f"{name}_posted"])
                    (given.keep / f"{name}_corrected.ngc").write_bytes(texts[name])
                    machine.write(given.keep)
        print(f"machine {number}: {len(said)} programs", flush=True)
    print(f"{'mode':20} runs  before um  after um  said of the control um")
    for mode in sorted(table):
        runs, before, after, control_um = table[mode]
        print(f"{mode:20} {runs:4} {before * 1e3:10.2f} {after * 1e3:9.2f}  {'not known' if control_um is None else control_um}")
    print("\n".join(wrong) if wrong else "none is farther off than was said")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
