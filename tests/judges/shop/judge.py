#!/usr/bin/env python3
"""Judge of the datum: a shop touches off on a crooked machine, corrects a program, runs it; are the features where they belong?

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--jobs 2] [--only before]
    judge.py --vpost target/release/vpost --refusals
    judge.py --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import itertools
import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, command, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import program  # noqa: E402
from along import farthest, lengths, without_start  # noqa: E402
from reader import Reader, Unreadable, stretches  # noqa: E402

SLACK = 0.06e-3  # of sampling, and of the order of small rotations, mm
APPROACH, LATE = 1.0, 0.05


def limit(case, offset, said=0.0):
    """Tolerance, half an output step of each axis, what the profile has no word for at that zero, and what was warned of."""
    return case.spec["tolerance"] * 1e-3 + 0.5 * case.spec["resolution"] * 3**0.5 + case.datums[offset].unsaid + SLACK + said


def carriages(case, moves):
    """Where the carriages stand less their commands, for each move: the play operator, from a start that nobody knows."""
    if not case.spec["play"]:
        return [None] * len(moves)
    out, at = [], {}
    for m in moves:
        behind = np.zeros_like(m.points)
        for k, width in case.spec["play"].items():
            n, half = "XYZ".index(k), width * 0.5e-3
            for row, q in enumerate(m.points[:, n]):
                if q == q:
                    at[k] = min(max(at.get(k, q + case.start[k]), q - half), q + half)
                    behind[row, n] = at[k] - q
        out.append(behind)
    return out


def paths(case, moves):
    """Of each move, where the tip would be on a perfect machine, counted from its zero, and where it really is."""
    alike = itertools.groupby(zip(moves, carriages(case, moves)), lambda x: (x[0].feed, x[0].offset, x[0].tool, x[0].tip_control))
    for (feed, offset, tool, tip_control), group in alike:
        if not feed:
            continue
        here, play = zip(*group)
        points, angles = np.concatenate([m.points for m in here]), {k: np.concatenate([m.angles[k] for m in here]) for k in here[0].angles}
        q = case.ideal.joints(points + tool, angles, tool) if tip_control else points
        wanted = case.ideal.in_workpiece(angles, q + case.ideal.reach(angles, tool, len(q))) - case.datums[offset].place(case.machine)
        real = case.machine.tip(q, angles, tool, None if play[0] is None else np.concatenate(play))
        ends = np.cumsum([len(m.points) for m in here])[:-1]
        for m, m.wanted, m.real in zip(here, np.split(wanted, ends), np.split(real, ends)):
            pass
    return stretches(moves)


def apart(case, before, after, datum, allowed):
    """How far a stretch of the output is from the programmed one, both counted from the zero."""
    wanted = np.concatenate([m.wanted for m in before])
    made = np.concatenate([m.real for m in after]) - datum
    # With play the tool is late on a hole's line, whichever way it came to R: docs/path-promise.md.
    late = case.spec["play"].get("Z", 0.0) * 1e-3 if before[0].hole else 0.0
    near = np.flatnonzero(np.linalg.norm(made - wanted[0], axis=1) <= allowed + late)
    if len(near) and lengths(made)[near[0]] < APPROACH:
        made = made[near[0] :]
    if not late:
        return max(farthest(made, wanted), farthest(wanted, made))
    return max(farthest(without_start(made, LATE), wanted), farthest(without_start(wanted, LATE), made))


def compare(case, text, said=0.0):
    """(what is wrong or None, largest distance of a right path in mm)"""
    try:
        before, after = paths(case, Reader(case).read(case.text)), paths(case, Reader(case).read(text))
    except Unreadable as why:
        return "unreadable: %s" % why, 0.0
    if len(before) != len(after) or [s[0].offset for s in before] != [s[0].offset for s in after]:
        return "structure: %d feeds became %d" % (len(before), len(after)), 0.0
    largest = 0.0
    for a, b in zip(before, after):
        allowed = limit(case, a[0].offset, said)
        off = min(apart(case, a, b, d, allowed) for d in case.datums[a[0].offset].real(case.machine))
        largest = max(largest, off)
        if off > allowed:
            where = np.round(a[0].wanted[0], 3).tolist()
            return (
                "path: %.2f um off, limit %.2f, in %s (%s) from %s"
                % (off * 1e3, allowed * 1e3, a[0].offset, case.datums[a[0].offset].kind, where),
                off,
            )
    return None, largest


def uncorrected(case):
    """How far the program as it is leads off, counted from the zero."""
    feeds = [m for s in paths(case, Reader(case).read(case.text)) for m in s]
    return max(float(np.linalg.norm(m.real - case.datums[m.offset].real(case.machine)[0] - m.wanted, axis=1).max()) for m in feeds)


def one(case):
    job = program.Case(case.options.seed, case.number, case.options.only)
    kinds = {d.kind + (" (%s)" % d.plain if d.plain else "") for d in job.datums.values()} | ({"tip control"} if job.tip_control else set())
    kinds |= {name for name, has in (("rotary", job.rotary), ("play", job.spec["play"])) if has}
    flags = program.write(job, case.folder)
    case.write("words.txt", " ".join(map(str, flags)) + "\n")
    done = case.correct(*flags)
    if not done:
        return
    output, errors = done
    wrong, largest = compare(job, output, command.microns(errors, "VP0509") or 0.0)
    if wrong:
        case.find(wrong.split(":")[0], wrong)
    elif job.number % 3 == 0:
        case.check(False, *flags)
    case.figures["uncorrected, largest of a program, um"] = uncorrected(job) * 1e3
    if not case.found:
        case.figures["corrected and right, largest of a program, um"] = largest * 1e3
    case.tally.update(["right"] * (not case.found) + ["%s, %s" % (w, "wrong" if case.found else "right") for w in kinds])


def main():
    words = options.parser(__doc__, 300, "first", "jobs", "refusals", vpost="target/release/vpost")
    words.set_defaults(jobs=2)
    words.add_argument(
        "--only", choices=("before",), help="every zero true and nothing said of it, as commands took it that know no touched ones"
    )
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main()
    if given.refusals:
        import refusals

        return refusals.main(given.vpost)
    return cases.campaign(given, one)


if __name__ == "__main__":
    sys.exit(main())
