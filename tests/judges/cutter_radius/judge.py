#!/usr/bin/env python3
"""Judge of cutter compensation: words that a corrected block may have, and where controls lead the tool's centre by them.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--jobs 2] [--dialect NAME]
    judge.py --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import json
import sys

import numpy as np

import blocks
import contour
import control

import plumbing  # of the folder shop, which contour names
from along import farthest, lengths

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


def one(task):
    options, n = task
    case = contour.Case(options.seed, n, options.dialect)
    result, text, largest, said = plumbing.in_folder(options, n, lambda folder: judged(options, case, folder))
    figures = {"corrected and right, largest of a program": largest * 1e3, "warned of (VP0508)": said * 1e3} if result == "right" else {}
    beyond = {"beyond the tolerance, as stated (VP0528)"} if text == "beyond" else set()
    return (
        n,
        result,
        text,
        figures,
        sorted(case.what | beyond | {case.dialect, "G%d" % case.plane, "good machine" if case.good else "crude machine"}),
    )


def judged(options, case, folder):
    (folder / "in.nc").write_text(case.text)
    where = contour.machines.profile(case.spec, case.dialect, folder, {"G54": repr(case.offset)}, options.zero)
    try:
        feeds = np.concatenate(stretches(centre(case, case.text, RULES[case.dialect][0])))
    except (control.Refused, blocks.Unreadable) as why:
        return "unjudged: the control refuses the input", str(why), 0.0, 0.0
    output, errors = plumbing.corrected(options, folder, ["-m", where])
    if output is None:
        return *errors, 0.0, 0.0
    said = plumbing.microns(errors, "VP0508")
    if said == 0.0:
        said = case.spec["radius"] * gradient(case, feeds)  # the warning says so in words
    beyond = plumbing.microns(errors, "VP0528")  # what cannot be held within the tolerance, as it is stated
    beyond = max(0.0, (beyond or 0.0) - case.spec["tolerance"] * 1e-3)
    wrong, largest = compare(case, output, (said or 0.0) + beyond)
    if wrong or case.number % 4 == 0:
        status, _, errors = plumbing.run(options.vpost, "check", folder / "in.nc", folder / "out.nc", "-m", where)
        if wrong and not status:
            wrong.append("check passes it")
        elif status and not wrong:
            wrong.append("check-alarm: " + plumbing.short(errors))
    return (wrong[0].split(":")[0], "; ".join(wrong), largest, 0.0) if wrong else ("right", "beyond" if beyond else "", largest, said or 0.0)


def knows_true_zeros(vpost):
    """Whether `[program] zero` is a key of the command's profiles."""
    found = json.loads(plumbing.run(vpost, "profile", "schema")[1])
    return '"zero"' in json.dumps(found.get("$defs", {}).get("Program", {}))


def main():
    words = plumbing.arguments(__doc__.splitlines()[0])
    words.add_argument("--dialect", choices=sorted(RULES))
    options = words.parse_args()
    if options.self_test:
        import self_test

        return self_test.main()
    options.zero = "true" if knows_true_zeros(options.vpost) else None
    return plumbing.everything(options, one)


if __name__ == "__main__":
    sys.exit(main())
