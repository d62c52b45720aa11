#!/usr/bin/env python3
"""Judge of what a correction costs the control's planner: does it slow down or push axes harder where motions were split?

    planner.py --vpost target/release/vpost --programs 30 [--seed 1] [--keep DIR]

Programs of programs.py and posts.py, as posted and corrected for a crooked machine (those of posts.py with play), are
run by LinuxCNC's motion controller. From the first to the last motion the corrected one may take 2 % more, and no axis
may be accelerated above the control's limit by more than the posted one does. Exit status 1 where one of these does
not hold. The time is that of the recorded milliseconds, which other work on the machine does not stretch.
"""

import pathlib
import random
import sys

import numpy as np

import campaign
import judge
import posts
import programs
import restart
import rig
from machine import Machine
from modes import seconds

MORE = 0.02
ROUNDED_MM_S2 = 8.0  # places are recorded with six decimals, each millisecond
MODES = ["G61", "G64", "G64 P0.05", "G64 P0.01 Q0.01"]
KINDS = [("programs", kind) for kind in programs.KINDS] * 2 + [("posts", kind) for kind in restart.RIG_KINDS]


def peak_mm_s2(recorded):
    """The largest acceleration of X, Y or Z."""
    return float(np.abs(np.diff(recorded[:, :3], n=2, axis=0)).max() * 1e6)


class Case:
    """A program as posted, its machine and its control."""

    def __init__(self, seed, number):
        chance = random.Random(f"planner {seed} {number}")
        source, self.kind = KINDS[number % len(KINDS)]
        self.mode = chance.choice(MODES)
        self.name = f"p{number}_{self.kind}"
        if source == "posts":
            self.machine, self.control = restart.Played(chance), restart.controls()
            self.posted = posts.make(self.kind, chance, self.mode)
        else:
            self.machine = Machine(chance)
            self.control = rig.Control({"G54": self.machine.zero_mm})
            self.posted = programs.make(self.kind, self.mode, chance)[0]

    def ran(self, vpost, folder):
        """What was recorded as posted and as corrected; the message where it is refused."""
        corrected, why = judge.correct(vpost, self.machine.write(folder), self.posted, folder)
        if corrected is None:
            return None, why
        # The first run ends where both others begin.
        texts = {"a_there": self.posted, "b_posted": self.posted, "c_corrected": corrected}
        recorded = rig.run(texts, self.control)
        return (recorded["b_posted"], recorded["c_corrected"]), why


def main():
    given = campaign.parser(__doc__, programs=30, first=0).parse_args()
    wrong, refused, rows = [], [], []
    print("program              mode              before s  after s   more %  peak before  after mm/s2")
    for number in range(given.first, given.first + given.programs):
        case = Case(given.seed, number)
        with campaign.folder(given.keep, case.name) as folder:
            recorded, why = case.ran(given.vpost, pathlib.Path(folder))
        if recorded is None:
            refused.append(f"{case.name}: {why.splitlines()[0]}")
            continue
        before, after = map(seconds, recorded)
        peaks = [peak_mm_s2(one) for one in recorded]
        more = after / before - 1.0
        rows.append((before, after))
        row = f"{case.name:20} {case.mode:16} {before:9.2f} {after:8.2f} {more * 100:8.2f}"
        print(f"{row} {peaks[0]:12.0f} {peaks[1]:7.0f}", flush=True)
        if more > MORE:
            wrong.append(f"{case.name} {case.mode}: takes {more * 100:.2f} % more")
        if peaks[1] > max(peaks[0], case.control.limits["MAX_ACCELERATION"]) + ROUNDED_MM_S2:
            wrong.append(f"{case.name} {case.mode}: accelerates by {peaks[1]:.0f} mm/s2, as posted by {peaks[0]:.0f}")
    if rows:
        before, after = np.array(rows).sum(axis=0)
        print(f"{len(rows)} programs: {before:.1f} s, corrected {after:.1f} s, {100 * (after / before - 1):.2f} % more")
    print("\n".join([*refused, *wrong]) if refused or wrong else "none is slower or pushed harder")
    return 1 if wrong or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
