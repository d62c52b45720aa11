#!/usr/bin/python3
"""Makes the reproducer of a failure smaller: fewer blocks, fewer tables and effects, while the same kind of failure stays.

    /usr/bin/python3 tests/judges/proofs/shrink.py --vpost target/release/vpost FOLDER NAME [NAME ...]

FOLDER is one that judge.py left; NAME the kind of failure to keep (path, bound, bound-check, ...). The small one is
written into FOLDER/small and printed.
"""

import argparse
import copy
import json
import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders  # noqa: E402

import judge  # noqa: E402
import reader  # noqa: E402


def problems(vpost, spec, lines, start_at, folder, least=0.0):
    os.makedirs(folder, exist_ok=True)
    text = "\n".join(lines) + "\n"
    try:
        verdict = judge.assess("shrunk", 0, spec, text, start_at, judge.run_pair(vpost, spec, text, start_at, folder))
    except (reader.Unreadable, KeyError, IndexError, ValueError):
        return {}
    if "lenient" in verdict and verdict["lenient"][0] < least:
        return {}
    return dict(verdict["problems"])


def simpler(spec):
    """Machines with one thing less."""
    for i in range(3):
        for key in ("errors_negative", "errors", "backlash_um", "measured_at"):
            if spec["axes"][i].get(key) and not (key == "errors" and spec["axes"][i].get("errors_negative")):
                less = copy.deepcopy(spec)
                del less["axes"][i][key]
                yield less
        if spec["axes"][i]["resolution"] != 0.001:
            less = copy.deepcopy(spec)
            less["axes"][i]["resolution"] = 0.001
            yield less
        for key in ("errors", "errors_negative"):
            if spec["axes"][i].get(key):
                for c in range(6):
                    if any(row[c] for row in spec["axes"][i][key][1]):
                        less = copy.deepcopy(spec)
                        for row in less["axes"][i][key][1]:
                            row[c] = 0.0
                        yield less
    for k in range(len(spec["effects"])):
        less = copy.deepcopy(spec)
        del less["effects"][k]
        yield less
    for key, plain in (("squareness_urad", [0, 0, 0]), ("tool", [0, 0, 0]), ("cubic", False)):
        if spec[key] != plain:
            yield {**copy.deepcopy(spec), key: plain}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--vpost", default="vpost")
    parser.add_argument("--least", type=float, default=0.0, help="keep the ratio of the path at least this large")
    parser.add_argument("folder")
    parser.add_argument("names", nargs="+")
    arguments = parser.parse_args()
    with open(os.path.join(arguments.folder, "machine.json"), encoding="ascii") as file:
        data = json.load(file)
    with open(os.path.join(arguments.folder, "in.ngc"), encoding="ascii") as file:
        lines = file.read().splitlines()
    spec, start_at = data["spec"], data["start_at"]
    for axis in spec["axes"]:
        if "measured_at" in axis:
            axis["measured_at"] = {int(k): v for k, v in axis["measured_at"].items()}
    small, trial = os.path.join(arguments.folder, "small"), os.path.join(arguments.folder, "trial")
    holds = lambda s, t: set(arguments.names) <= set(problems(arguments.vpost, s, t, start_at, trial, arguments.least))  # noqa: E731
    if not holds(spec, lines):
        print("the failure does not show")
        return 1
    changed = True
    while changed:
        changed = False
        size = max(1, len(lines) // 2)
        while size:
            k = 1 + next(n for n, line in enumerate(lines) if line.startswith("G0"))
            while k < len(lines) - 1:
                fewer = lines[:k] + lines[min(k + size, len(lines) - 1) :]
                if len(fewer) < len(lines) and holds(spec, fewer):
                    lines, changed = fewer, True
                else:
                    k += size
            size //= 2
        again = True
        while again:
            again = False
            for less in simpler(spec):
                if holds(less, lines):
                    spec, again, changed = less, True, True
                    break
    found = problems(arguments.vpost, spec, lines, start_at, small)
    folders.put(small, "found.txt", json.dumps(found, indent=1) + "\n")
    for name in ("in.ngc", "out.ngc", "machine.toml", "command.txt", "found.txt"):
        with open(os.path.join(small, name), encoding="utf-8") as file:
            print(f"--- {name}\n{file.read()}", end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
