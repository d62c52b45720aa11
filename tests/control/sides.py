#!/usr/bin/env python3
"""Does restart.py --rig see a wrong side of play? In each mode a restart must pass, and the same with an approach from
the other side of one axis must not.

    sides.py --vpost target/release/vpost [--seed 1]

Exit status 1 where a wrong side is not found, or a right one not passed.
"""

import argparse
import pathlib
import random
import re
import sys
import tempfile

import numpy as np

import canon
import restart
import rig
from ways import Wrong


def turned(program, one, begins, axis):
    """The restarted program with an approach from the other side of an axis: past the place and back, above it."""
    lines = one.text.decode().splitlines(keepends=True)
    last = max(k for k in range(begins - 1) if re.search(r"G[01]\b.*[XYZ]", lines[k]))
    run = canon.Run(canon.split(canon.calls(canon.marked(one.text, begins), restart.controls()))[0])
    came_up = restart.hangs(run.way(), program.machine.half_play_um)["XYZ".index(axis)] < 0
    there, back = (0.1, -0.1) if came_up else (-0.1, 0.1)
    jog = f"G91 G0 {axis}{there}\n{axis}{back}\nG90\n"
    return "".join([*lines[:last], jog, *lines[last:]]).encode(), begins + jog.count("\n")


def shows(first, then, column, play_mm):
    """Whether a feed of a millimetre and more comes before an axis has moved by a quarter of its play."""
    begins, moves = len(canon.Run(first).moves), canon.Run(first + then).moves
    place = moves[begins - 1].corners[-1, column] if begins else 0.0
    for move in moves[begins:]:
        if np.abs(move.corners[:, column] - place).max() > play_mm / 4:
            return False
        if move.name != "STRAIGHT_TRAVERSE" and np.ptp(move.corners, axis=0).max() > 1.0:
            return True
    return False


def shown(program, chance):
    """A line, restarted, and an axis whose side of play a feed behind it shows."""
    lines = list(range(2, program.count))
    chance.shuffle(lines)
    for line in lines:
        one = program.restarted(line)
        if one.refused:
            continue
        first, then = canon.split(canon.calls(canon.marked(program.text, line), restart.controls()))
        side = restart.hangs(canon.Run(first).way(), program.machine.half_play_um)
        for axis in chance.sample("XY", 2):
            column = "XY".index(axis)
            play_mm = 2e-3 * program.machine.half_play_um[column]
            if abs(side[column]) > restart.FIRM and shows(first, then, column, play_mm):
                return line, one, axis
    raise Wrong(f"no line of {program.kind} shows a side of play")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--vpost", required=True)
    arguments.add_argument("--seed", type=int, default=1)
    given = arguments.parse_args()
    blind = []
    for number, mode in enumerate(restart.RIG_MODES):
        chance = random.Random(f"self-test {given.seed} {number}")
        with tempfile.TemporaryDirectory() as temporary:
            program = restart.Given(given.vpost, "plate", chance, pathlib.Path(temporary), mode)
            line, one, axis = shown(program, chance)
            begins = one.begins(program.text)
            other, other_begins = turned(program, one, begins, axis)
            recorded = rig.run({"a": program.text, "b": one.text, "c": other}, restart.controls())
            restart.same_ways(program, line, recorded["a"], recorded["b"], one.text, begins)
            try:
                restart.same_ways(program, line, recorded["a"], recorded["c"], other, other_begins)
                blind.append(f"{mode}: {axis} on the other side in line {line} is not found")
            except Wrong as why:
                print(f"{mode}: {axis} on the other side in line {line} is found: {why}", flush=True)
    print("\n".join(blind) if blind else "each wrong side is found")
    return 1 if blind else 0


if __name__ == "__main__":
    sys.exit(main())
