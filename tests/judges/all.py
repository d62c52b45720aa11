#!/usr/bin/env python3
"""Every judge with a small count: what holds today holds tomorrow. Some two minutes on two processors.

    /usr/bin/python3 -B tests/judges/all.py --vpost target/release/vpost
    /usr/bin/python3 -B tests/judges/all.py --vpost target/release/vpost --only field --only rtest

Counts for the record, and what each asks, stand in docs/testing.md, whose tables are held against the judges first. A
judge that needs what is not here (NumPy, LinuxCNC's interpreter) is skipped and says so; with CI set that is a failure.
Exit status 1 where one finds something, is missing from the list below, or cannot run.
"""

import argparse
import functools
import importlib.util
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import time

import shared
from common import cases, command, folders, options

HERE = pathlib.Path(__file__).resolve().parent
# Numbers and seeds at which nothing is found; what a judge does find elsewhere is an open finding, for its own command.
COUNTS = {
    "alone": "--only settings --first 4 --count 26",
    "calibrate": "--count 1 --only identity --match own",
    "calibrate_turning": "--count 1",
    "compensation": "--count 8 --first 20",
    "cutter_radius": "--count 8 --jobs 1",
    "damage": "--count 10 --seed 51 --damage 1",
    "diagnose": "--count 1 --only noise,books,bad",
    "dialects": "--only mach",
    "field": "--count 2 --kind exact --kind nothing --programs 1",
    "files": "--count 2 --only moving_input",
    "five_axis": "--count 6",
    "frames": "--count 40 --seed 2 --only random",
    "pockets": "--count 14",
    "proofs": "--count 14",
    "protocols": "--count 1 --only one_line,bar,plate",
    "reader": "--count 2",
    "rotary_diagnosis": "--count 3",
    "rtest": "--count 3",
    "same_bytes": "--count 20 --no-lying",
    "shop": "--count 6 --jobs 1",
    "shops": "--count 2",
    "sinumerik": "--count 20",
    "swivel": "--count 8",
    "tilted_planes": "--count 4",
    "turning": "--count 16",
}
WITHOUT_NUMPY = {"alone", "damage", "dialects", "files", "frames", "protocols", "reader", "same_bytes", "shops"}
WITHOUT_NUMPY |= {"sinumerik"}
INTERPRETER = {"compensation", "cutter_radius", "five_axis", "reader", "shops", "turning"}


def missing(judge: str) -> str:
    """What a judge needs and this machine has not."""
    if judge in INTERPRETER and not shutil.which("rs274"):
        return "LinuxCNC's interpreter is not here: apt-get install linuxcnc-uspace"
    if judge not in WITHOUT_NUMPY and not importlib.util.find_spec("numpy"):
        return "NumPy is not here: apt-get install python3-numpy"
    return ""


def played(vpost: str, keep: str, judge: str) -> tuple[str, str, bool]:
    """(what came of it in a line, the end of what it said, whether it passes)."""
    lacks = missing(judge)
    if lacks:
        failed = bool(os.environ.get("CI"))
        return f"{judge}: {'FAILED' if failed else 'skipped'}, {lacks}", "", not failed
    words = [sys.executable, "-B", str(HERE / judge / "judge.py"), *shlex.split(COUNTS[judge])]
    words += ["--before", vpost, "--after", vpost] if judge == "same_bytes" else ["--vpost", vpost]
    words += ["--keep", os.path.join(keep, judge)] if judge != "dialects" else []
    begun = time.monotonic()
    done = subprocess.run(words, input=b"", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    line = f"{judge}: {time.monotonic() - begun:.0f} s"
    if done.returncode == 0:
        return line, "", True
    said = "\n".join(done.stdout.decode("utf-8", "replace").splitlines()[-40:])
    return f"{line}, FAILED with exit status {done.returncode}: {shlex.join(words)}", said, False


def main() -> int:
    words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    words.add_argument("--vpost", metavar="COMMAND", default="target/release/vpost", help="the command that is judged")
    words.add_argument("--jobs", type=int, default=1, help="judges at the same time")
    words.add_argument("--keep", metavar="DIR", help="folder of what is found")
    words.add_argument("--only", action="append", choices=sorted(COUNTS), help="this judge (repeatable)")
    given = words.parse_args()
    vpost, keep = options.command(words, given.vpost)[0], folders.of_findings(given.keep, "judges-")
    if command.run(vpost, "--version").status:
        words.error(f"{vpost} does not even say its version")
    failed = shared.main()
    for judge in set(shared.judges()) ^ set(COUNTS):
        print(f"tests/judges/all.py: `{judge}` is not in its list and the folder both")
        failed = 1
    one = functools.partial(played, vpost, keep)
    for line, said, passes in cases.in_order(one, given.only or list(COUNTS), given.jobs):
        print("\n".join(filter(None, (said, line))), flush=True)
        failed |= not passes
    print("some judge is not content" if failed else "all judges pass")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
