#!/usr/bin/env python3
"""Judge of the datum: a shop touches off on a crooked machine, corrects a program, runs it; are the features where they belong?

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--jobs 2] [--only before]
    judge.py --vpost target/release/vpost --refusals
    judge.py --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import argparse
import collections
import itertools
import multiprocessing
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

import program
from reader import Reader, Unreadable, stretches

SLACK = 0.06e-3  # of sampling, and of the order of small rotations, mm
APPROACH, WINDOW = 1.0, 14


def run(vpost, *words):
    done = subprocess.run([str(vpost), *map(str, words)], capture_output=True, text=True, timeout=180)
    return done.returncode, done.stdout, done.stderr


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


def lengths(points):
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def farthest(points, line):
    """Largest distance of points from a line that is run through at once with them."""
    along, way = lengths(points), lengths(line)
    near = np.searchsorted(way, along * way[-1] / max(along[-1], 1e-9))
    k = np.clip(near[:, None] + np.arange(-WINDOW, WINDOW), 0, len(line) - 2)
    a, d = line[k], line[k + 1] - line[k]
    t = np.clip(((points[:, None] - a) * d).sum(axis=2) / np.maximum((d * d).sum(axis=2), 1e-30), 0.0, 1.0)
    return float(np.linalg.norm(points[:, None] - a - t[..., None] * d, axis=2).min(axis=1).max())


def apart(case, before, after, datum, allowed):
    """How far a stretch of the output is from the programmed one, both counted from the zero."""
    wanted = np.concatenate([m.wanted for m in before])
    made = np.concatenate([m.real for m in after]) - datum
    near = np.flatnonzero(np.linalg.norm(made - wanted[0], axis=1) <= allowed)
    if len(near) and lengths(made)[near[0]] < APPROACH:
        made = made[near[0] :]
    if before[0].hole and case.spec["play"].get("Z"):
        # The tool is late by the play on the hole's line, whichever way it came to R: docs/path-promise.md.
        made, wanted = made[lengths(made) >= 0.05], wanted[lengths(wanted) >= 0.05]
    return max(farthest(made, wanted), farthest(wanted, made))


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
            return "path: %.2f um off, limit %.2f, in %s (%s) from %s" % (off * 1e3, allowed * 1e3, a[0].offset, case.datums[a[0].offset].kind, where), off
    return None, largest


def uncorrected(case):
    """How far the program as it is leads off, counted from the zero."""
    feeds = [m for s in paths(case, Reader(case).read(case.text)) for m in s]
    return max(float(np.linalg.norm(m.real - case.datums[m.offset].real(case.machine)[0] - m.wanted, axis=1).max()) for m in feeds)


def one(task):
    """(number, result, text, figures)"""
    options, n = task
    case = program.Case(options.seed, n, options.only)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            found = judged(options, case, folder)
        except subprocess.TimeoutExpired:
            found = "slow", "180 s", 0.0
        if options.keep and not found[0].startswith(("right", "refused")):
            keep = pathlib.Path(options.keep) / ("%d-%d" % (options.seed, n))
            keep.mkdir(parents=True, exist_ok=True)
            for f in folder.iterdir():
                (keep / f.name).write_bytes(f.read_bytes())
            (keep / "found.txt").write_text("%s\n%s\n%s\n" % (found[0], found[1], " ".join(map(str, program.write(case, keep)))))
    kinds = sorted({d.kind + (" (%s)" % d.plain if d.plain else "") for d in case.datums.values()} | ({"tip control"} if case.tip_control else set()))
    return n, found[0], found[1], found[2] * 1e3, uncorrected(case) * 1e3, ["rotary"] * case.rotary + ["play"] * bool(case.spec["play"]) + kinds


def judged(options, case, folder):
    flags = program.write(case, folder)
    status, output, errors = run(options.vpost, "correct", folder / "in.nc", *flags)
    code = (re.search(r"error\[(VP\d+)\]", errors) or [None, "no code"])[1]
    if status == 2:
        return "profile", errors.strip().replace("\n", " | ")[:300], 0.0
    if status:
        return "refused %s" % code, " | ".join(errors.strip().splitlines()[:4])[:300], 0.0
    (folder / "out.nc").write_text(output)
    unknown_side = re.search(r"VP0509\].*?([\d.]+) µm", errors, re.S)
    wrong, largest = compare(case, output, float(unknown_side[1]) * 1e-3 if unknown_side and case.spec["play"] else 0.0)
    if wrong:
        return wrong.split(":")[0], wrong, largest
    if case.number % 3 == 0:
        status, _, errors = run(options.vpost, "check", folder / "in.nc", folder / "out.nc", *flags)
        if status:
            return "check-alarm", errors.strip().replace("\n", " | ")[:200], largest
    return "right", "", largest


def everything(options):
    tally, kinds, before, after, refused, found = collections.Counter(), collections.Counter(), [], [], {}, 0
    tasks = [(options, n) for n in range(options.first, options.first + options.count)]
    with multiprocessing.Pool(options.jobs) as pool:
        for n, result, text, largest, plain, what in pool.imap(one, tasks):
            tally[result] += 1
            if result.startswith("refused"):
                refused.setdefault(result, "as number %d: %s" % (n, text))
                continue
            before, after = before + [plain], after + [largest] if result == "right" else after
            kinds.update(["%s, %s" % (w, "right" if result == "right" else "wrong") for w in what])
            if result != "right":
                found += 1
                print("%-12s %4d  %s" % (result, n, text), flush=True)
    for name, count in sorted(kinds.items()) + sorted(tally.items()):
        print("%6d  %s  %s" % (count, name, refused.get(name, "")))
    for name, values in (("uncorrected", before), ("corrected and right", after)):
        if values:
            print("%s, largest of a program, um: median %.2f, max %.2f" % (name, np.median(values), max(values)))
    return 1 if found else 0


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--vpost", default="target/release/vpost")
    words.add_argument("--count", type=int, default=300)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--jobs", type=int, default=2)
    words.add_argument("--keep")
    words.add_argument("--only", choices=("before",), help="every zero true and nothing said of it, as commands took it that know no touched ones")
    words.add_argument("--refusals", action="store_true")
    words.add_argument("--self-test", action="store_true")
    options = words.parse_args()
    if options.self_test:
        import self_test

        return self_test.main()
    if options.refusals:
        import refusals

        return refusals.main(options.vpost)
    return everything(options)


if __name__ == "__main__":
    sys.exit(main())
