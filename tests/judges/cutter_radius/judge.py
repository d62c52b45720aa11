#!/usr/bin/env python3
"""Judge of cutter compensation: words that a corrected block may have, and where controls lead the tool's centre by them.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--jobs 2] [--dialect NAME]
    judge.py --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, command, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import blocks  # noqa: E402
import contour  # noqa: E402
import control  # noqa: E402

from along import farthest, lengths  # noqa: E402  of the folder shop, which contour names

RULES = {"linuxcnc": ("LinuxCNC",), "fanuc": ("A", "B"), "haas": ("A", "B"), "sinumerik": ("NORM", "KONT")}
SLACK = {"linuxcnc": 0.2e-3}  # rs274 prints four decimals, mm
APPROACH = 1.0


def centre(case, text, rule):
    if rule == "LinuxCNC":
        return control.linuxcnc(text, case.spec["radius"])
    return control.by_manual(blocks.read(text), case.spec["radius"], rule)


def stretches(moves):
    """Feeds between rapids."""
    out, before = [], False
    for feed, points in moves:
        if feed:
            out[-1:] = [np.concatenate([out[-1], points])] if before else out[-1:] + [points]
        before = feed
    return out


def real(case, points):
    """Where the tip is for words, program coordinates."""
    tool = [0.0, 0.0, 0.0 if case.dialect == "sinumerik" else -case.spec["lengths"]["H1"]]
    zero = np.array(case.offset)
    return case.machine.tip(points + zero - tool, {}, tool) - zero


def gradient(case, points):
    """Largest change of the error with the place, mm per mm."""
    error, step = lambda p: real(case, p) - p, 0.5 * np.eye(3)
    return max(float(np.linalg.norm(error(points + s) - error(points - s), axis=1).max()) for s in step)


def compare(case, text, said=0.0):
    """([what is wrong], largest distance in mm): the centre's way by each control, and the rule for words."""
    found, largest = [], 0.0
    for rule in RULES[case.dialect]:
        try:
            wrong, off = way(case, text, rule, said)
        except control.Refused as why:
            wrong, off = "alarm: %s" % why, 0.0
        except blocks.Unreadable as why:
            wrong, off = "unreadable: %s" % why, 0.0
        found, largest = found + [wrong] * bool(wrong), max(largest, off)
    try:
        wrong = blocks.broken(blocks.read(case.text), blocks.read(text))
    except blocks.Unreadable as why:
        wrong = str(why)
    return found + ["words: %s" % wrong] * bool(wrong), largest


def way(case, text, rule, said):
    allowed = case.spec["tolerance"] * 1e-3 + 0.5 * case.spec["resolution"] * 3**0.5 + SLACK.get(case.dialect, 0.06e-3) + said
    before, after = stretches(centre(case, case.text, rule)), stretches(centre(case, text, rule))
    if len(before) != len(after):
        return "structure: %d feeds became %d" % (len(before), len(after)), 0.0
    largest, where = 0.0, None
    for wanted, made in zip(before, after):
        made = real(case, made)
        near = np.flatnonzero(np.linalg.norm(made - wanted[0], axis=1) <= allowed)
        made = made[near[0] :] if len(near) and lengths(made)[near[0]] < APPROACH else made
        off = max(farthest(made, wanted), farthest(wanted, made))
        if off > largest:
            largest, where = off, np.round(wanted[0], 3).tolist()
    wrong = "path: %.2f um off, limit %.2f, by %s in the feed from %s" % (largest * 1e3, allowed * 1e3, rule, where)
    return wrong if largest > allowed else None, largest


def one(case):
    job = contour.Case(case.options.seed, case.number, case.options.dialect)
    case.write("in.nc", job.text)
    where = contour.machines.profile(job.spec, job.dialect, case.folder, {"G54": job.offset}, case.options.zero)
    try:
        feeds = np.concatenate(stretches(centre(job, job.text, RULES[job.dialect][0])))
    except (control.Refused, blocks.Unreadable):
        case.tally["unjudged: the control refuses the input"] += 1
        return
    done = case.correct("-m", where)
    if not done:
        return
    output, errors = done
    said = command.microns(errors, "VP0508")
    if said == 0.0:
        said = job.spec["radius"] * gradient(job, feeds)  # the warning says so in words
    beyond = command.microns(errors, "VP0528")  # what cannot be held within the tolerance, as it is stated
    beyond = max(0.0, (beyond or 0.0) - job.spec["tolerance"] * 1e-3)
    wrong, largest = compare(job, output, (said or 0.0) + beyond)
    if wrong:
        case.find(wrong[0].split(":")[0], "; ".join(wrong))
    if wrong or job.number % 4 == 0:
        case.check(bool(wrong), "-m", where)
    kinds = job.what | {job.dialect, "G%d" % job.plane, "good machine" if job.good else "crude machine"}
    if beyond and not case.found:
        kinds |= {"beyond the tolerance, as stated (VP0528)"}
    case.tally.update(["right"] * (not case.found) + ["%s, %s" % (w, "wrong" if case.found else "right") for w in kinds])
    if not case.found:
        case.figures.update({"corrected and right, largest of a program, um": largest * 1e3, "warned of (VP0508), um": (said or 0.0) * 1e3})


def main():
    words = options.parser(__doc__, 300, "first", "jobs", vpost="target/release/vpost")
    words.set_defaults(jobs=2)
    words.add_argument("--dialect", choices=sorted(RULES))
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main()
    given.zero = "true" if "zero" in command.schema(given.vpost, "Program") else None
    return cases.campaign(given, one)


if __name__ == "__main__":
    sys.exit(main())
