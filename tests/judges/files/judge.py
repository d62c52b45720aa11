#!/usr/bin/python3
"""Judge of how vpost treats files, terminals, absurd values, endless work and power cuts.

A black box test: it knows the command's documents and nothing of its code. It is for Linux; power cuts need root and loop devices and
are skipped with a message elsewhere. Standard library of Python 3.11 and, for the cuts, mke2fs and mount.

    tests/judges/files/judge.py --vpost target/release/vpost
    tests/judges/files/judge.py --vpost target/release/vpost --only power_cut --count 200 --seed 7
    tests/judges/files/judge.py --self-test

`--count` is the number of simulated power cuts (50 if not given); the other checks scale with it where they are random. Programs, moments and
orders are those of `--seed`; at which instruction a moment finds the command is the computer's choice. `--jobs` is taken for the sake of
the other judges: one command runs at a time. Every wrong answer leaves a folder under `--keep` with what was found and what was
expected. Exit status: 0 nothing wrong, 1 something is wrong, 2 the command line.

The checks, one file each: power_cut, moving_input, slips, fences, terminal, absurd, endless. The mathematics is small: time is linear where
doubling the input less than triples the processor time (2 for linear, 4 for quadratic; least of two runs each, 0.2 s ignored).
"""

import os
import shutil
import sys
import tempfile
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders, options  # noqa: E402

import runner  # noqa: E402

CHECKS = ("power_cut", "moving_input", "slips", "fences", "terminal", "absurd", "endless")


def judged(vpost, count, seed, keep, only, silent=False):
    """Runs the checks; returns the judge with what it found."""
    work = tempfile.mkdtemp(prefix="judge-files-")
    judge = runner.Judge(vpost, count, seed, keep, work)
    judge.silent = silent
    try:
        for name in only:
            begin = time.monotonic()
            __import__(name).run(judge)
            print("%s: %.0f s" % (name, time.monotonic() - begin), flush=True)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return judge


def report(judge):
    """One line for each check; True where nothing is wrong."""
    print()
    for name, asked in judge.asked.items():
        wrong = len(judge.wrong[name])
        print("%-5s %-70s %4d asked, %4d wrong" % ("ok" if not wrong else "WRONG", name, asked, wrong))
    for note in judge.notes:
        print("note  " + note)
    total = sum(len(w) for w in judge.wrong.values())
    print("%d asked, %d wrong%s" % (sum(judge.asked.values()), total, "; reproducers in %s" % judge.keep if total else ""))
    return total == 0


def main():
    words = options.parser(__doc__, 50, "jobs", vpost=os.path.join(runner.REPOSITORY, "target", "release", "vpost"))
    words.add_argument("--only", action="append", choices=CHECKS)
    given = words.parse_args()
    if not sys.platform.startswith("linux"):
        print("SKIPPED: this judge is for Linux")
        return 0
    keep = folders.of_findings(given.keep, "judge-files-found-")
    only = given.only or CHECKS
    if given.self_test:
        import self_test
        return 0 if self_test.run(keep, only, given.seed) else 1
    vpost = options.command(words, given.vpost)[0]
    if os.geteuid() != 0:
        print("SKIPPED in part: power cuts and device nodes need root")
    return 0 if report(judged(vpost, given.count, given.seed, keep, only)) else 1


if __name__ == "__main__":
    sys.exit(main())
