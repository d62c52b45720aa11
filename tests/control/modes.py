#!/usr/bin/env python3
"""Judge of `--path-control`: programs whose control rounds corners, written so that it does not, or within the
tolerance.

    modes.py --vpost target/release/vpost --machines 20 [--seed 1] [--programs 3] [--keep DIR]

Programs of programs.py, some of which change their mode on the way, are corrected for a crooked machine with each of
`exact` and `tolerance` and run, with the posted ones, by LinuxCNC's motion controller. The tip must be within the
tolerance (1, 20 or 100 um) and half an output step of each axis of the programmed path; what the summary says of the
control must be 0 under `exact`, at most half the tolerance under `tolerance`. By LinuxCNC's interpreter every feed
must run in an exact mode under `exact`, and with a stated tolerance under `tolerance`. Exit status 1 where one of
these does not hold. The table has the time from the first to the last motion, before and after.
"""

import collections
import pathlib
import random
import sys
import tempfile

import campaign
import canon
import judge
import programs
import rig
from machine import Machine

HOWS = ("exact", "tolerance")
TOLERANCES_UM = (1, 20, 100)
POSTED = ["", "G64", "G64 P0.05", "G64 P0.05 Q0.01", "G61", "G61.1"]


def switched(text, chance):
    """A program with modes that change between its feeds."""
    lines = text.decode().splitlines()
    feeds = [number for number, line in enumerate(lines) if line.startswith(("G1 ", "G2 ", "G3 "))]
    for number in sorted(chance.sample(feeds[1:], min(chance.randint(1, 3), len(feeds) - 1)), reverse=True):
        lines.insert(number, chance.choice(POSTED[1:]))
    return ("\n".join(lines) + "\n").encode()


def misread(text, how, zero_mm, tolerance_um):
    """What the interpreter says of the feeds that should not be so."""
    run = canon.Run(canon.calls(text, rig.Control({"G54": zero_mm})))
    wrong = set()
    for move in run.moves:
        if move.name == "STRAIGHT_TRAVERSE":
            continue
        mode = move.state.get("SET_MOTION_CONTROL_MODE") or ["as it starts"]
        if "EXACT" in mode[0]:
            continue
        blend = mode[1] * 1e3 if len(mode) > 1 else 0.0
        if how == "exact" or not 0.0 < blend <= tolerance_um / 2:
            wrong.add(f"feeds under {mode}")
    return sorted(wrong)


def seconds(recorded):
    """From the first to the last motion."""
    moved = (abs(recorded[1:, :3] - recorded[:-1, :3]).max(1) > 1e-7).nonzero()[0]
    return (moved[-1] - moved[0]) * 1e-3


class Written:
    """A program corrected one way."""

    def __init__(self, name, how, tolerance_um, mode):
        self.name, self.how, self.tolerance_um, self.mode = name, how, tolerance_um, mode
        self.text, self.summary = None, None

    def may_um(self):
        return self.tolerance_um + (judge.HALF_STEP_MM + judge.SLACK_MM) * 1e3


def write(given, number, chance, machine, folder):
    """Posted texts with their paths, and what vpost makes of them."""
    profile = machine.write(folder)
    posted, written, wrong = {}, [], []
    for kind in chance.sample(sorted(programs.KINDS), given.programs):
        mode = chance.choice(POSTED)
        text, path = programs.make(kind, mode, chance)
        if chance.random() < 0.5:
            text, mode = switched(text, chance), f"{mode or 'none'}, switched"
        name = f"m{number}_{kind}"
        posted[name] = (text, path)
        for how in HOWS:
            one = Written(name, how, chance.choice(TOLERANCES_UM), mode or "as it starts")
            options = ["--path-control", how, "--tolerance", str(one.tolerance_um)]
            one.text, one.summary = judge.correct(given.vpost, profile, text, folder, *options)
            if one.text is None:
                wrong.append(f"{name} {how} {one.tolerance_um} um: refused\n{one.summary}")
                continue
            written.append(one)
            said = one.summary["control_um"]
            if said is None or said > (0.0 if how == "exact" else one.tolerance_um / 2):
                wrong.append(f"{name} {one.mode} {how} {one.tolerance_um} um: control_um is {said}")
            for why in misread(one.text, how, machine.zero_mm, one.tolerance_um):
                wrong.append(f"{name} {one.mode} {how} {one.tolerance_um} um: {why}")
    return posted, written, wrong


def keep(folder, one, posted, machine):
    """Leaves a failing case behind."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{one.name}.ngc").write_bytes(posted[one.name][0])
    (folder / f"{one.name}_{one.how}_{one.tolerance_um}.ngc").write_bytes(one.text)
    machine.write(folder)


def main():
    given = campaign.parser(__doc__, machines=1, programs=3).parse_args()
    wrong, table = [], collections.defaultdict(list)
    for number in range(given.machines):
        chance = random.Random(f"modes {given.seed} {number}")
        machine = Machine(chance)
        with tempfile.TemporaryDirectory() as temporary:
            posted, written, why = write(given, number, chance, machine, pathlib.Path(temporary))
        wrong += why
        texts = {f"{name}_a_posted": text for name, (text, _) in posted.items()}
        texts |= {f"{one.name}_{one.how}": one.text for one in written}
        recorded = rig.run(texts, rig.Control({"G54": machine.zero_mm}))
        for one in written:
            path = posted[one.name][1] + machine.zero_mm
            before, after = recorded[f"{one.name}_a_posted"], recorded[f"{one.name}_{one.how}"]
            off_um = judge.farthest(after, judge.feed_lines(one.text), machine, path) * 1e3
            was_um = judge.farthest(before, judge.feed_lines(posted[one.name][0]), machine, path) * 1e3
            table[one.how, one.tolerance_um].append((was_um, off_um, seconds(before), seconds(after)))
            if off_um > one.may_um():
                wrong.append(f"{one.name} {one.mode} {one.how} {one.tolerance_um} um: {off_um:.2f} um off")
                if given.keep:
                    keep(given.keep, one, posted, machine)
        print(f"machine {number}: {len(written)} programs", flush=True)
    print("written    tolerance um  runs  before um  after um  before s  after s")
    for (how, tolerance_um), rows in sorted(table.items()):
        was, off, before, after = zip(*rows)
        row = f"{how:10} {tolerance_um:12} {len(rows):5} {max(was):10.2f} {max(off):9.2f}"
        print(f"{row} {sum(before):9.1f} {sum(after):8.1f}")
    print("\n".join(wrong) if wrong else "none is farther off than was asked for")
    return 1 if wrong or not table else 0


if __name__ == "__main__":
    sys.exit(main())
