#!/usr/bin/env python3
"""Judge of cutter compensation: where the tool's centre goes with the output, on a crooked mill, against the input's way.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--radius-key NAME]
    judge.py --vpost target/release/vpost --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import argparse
import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

import centre
import generate
from mill import Mill

SLACK = {"linuxcnc": 0.25e-3, "fanuc": 0.1e-3}  # rs274 prints four decimals: of ends, and of centres, mm
LEAD = 1.0


def run(vpost, *words):
    done = subprocess.run([str(vpost), *map(str, words)], capture_output=True, text=True, timeout=180)
    return done.returncode, done.stdout, done.stderr


def limit(spec):
    return spec["tolerance"] * 1e-3 + 0.5 * spec["resolution"] * 3**0.5 + SLACK[spec["dialect"]]


def along(points, polyline, allowed):
    """Runs points along a polyline, forwards only: (largest distance, where, what is left at its end, largest step back)."""
    way = np.diff(polyline, axis=0)
    size = np.linalg.norm(way, axis=1)
    start = np.concatenate([[0.0], np.cumsum(size)])
    k, worst, where, reached, back = 0, 0.0, 0, 0.0, 0.0
    for n, p in enumerate(points):
        lo, hi = max(0, k - 4), min(len(way), k + 80)
        d = p - polyline[lo:hi]
        t = np.clip((d * way[lo:hi]).sum(axis=1) / np.maximum(size[lo:hi] ** 2, 1e-30), 0.0, 1.0)
        off = np.linalg.norm(d - t[:, None] * way[lo:hi], axis=1)
        here = start[lo:hi] + t * size[lo:hi]
        good = np.flatnonzero((off <= allowed) & (here >= reached - 4 * allowed))
        best = int(good[np.argmin(off[good] + 1e-3 * (here[good] - reached))]) if len(good) else int(np.argmin(off))
        if off[best] > worst:
            worst, where = float(off[best]), n
        back, reached, k = max(back, reached - here[best]), max(reached, float(here[best])), lo + best
    return worst, where, start[-1] - reached, back


def same_way(ideal, made, allowed):
    """(what is wrong or None, largest distance)"""
    near = np.flatnonzero(np.linalg.norm(made - ideal[0], axis=1) <= allowed)
    first = int(near[0]) if len(near) else 0
    if first and np.linalg.norm(np.diff(made[: first + 1], axis=0), axis=1).sum() < LEAD:
        made = made[first:]
    largest = 0.0
    for name, a, b in (("off the way", made, ideal), ("leaves out", ideal, made)):
        worst, where, left, back = along(a, b, allowed)
        largest = max(largest, worst)
        if worst > allowed:
            return "%s: %.2f um at %s, limit %.2f" % (name, worst * 1e3, np.round(a[where], 3).tolist(), allowed * 1e3), largest
        if left > 12 * allowed or back > 12 * allowed:
            return "%s: %.3f mm at its end, %.3f mm back" % (name, left, back), largest
    return None, largest


def stretches(moves):
    out = []
    for kind, what in moves:
        if kind == "rapid":
            out.append(("rapid", what))
        elif out and out[-1][0] == "feed":
            out[-1] = ("feed", np.concatenate([out[-1][1], what]))
        else:
            out.append(("feed", what))
    # A rapid along one axis may be several: what counts is where feeds begin.
    return out


def compare(spec, text_in, text_out, allowed=None):
    """([(what, text)], largest distance in mm)"""
    m, allowed = Mill(spec), allowed or limit(spec)
    try:
        before = stretches(centre.path(spec, text_in))
    except centre.Unreadable as why:
        return [("judge", "input: %s" % why)], 0.0
    try:
        after = stretches(centre.path(spec, text_out))
    except centre.Refused as why:
        return [("alarm", "LinuxCNC refuses the output: %s" % str(why).replace("\n", " | "))], 0.0
    except centre.Unreadable as why:
        return [("unreadable", str(why))], 0.0
    feeds_in = [x for kind, x in before if kind == "feed"]
    feeds_out = [x for kind, x in after if kind == "feed"]
    if len(feeds_in) != len(feeds_out) or [k for k, _ in before] != [k for k, _ in after]:
        return [("structure", "%s became %s" % ([k for k, _ in before], [k for k, _ in after]))], 0.0
    largest = 0.0
    for a, b in zip(feeds_in, feeds_out):
        wrong, worst = same_way(a, m.real(b), allowed)
        largest = max(largest, worst)
        if wrong:
            return [("path", wrong)], largest
    return [], largest


class Judge:
    def __init__(self, options):
        self.o, self.tally, self.refused, self.first, self.found = options, collections.Counter(), collections.Counter(), {}, 0
        self.key, self.worst = options.radius_key or radius_key(options.vpost), 0.0
        print("radius of a tool in the profile: %s" % (self.key or "no key known"))

    def report(self, what, n, folder, text):
        self.found += 1
        self.tally["found " + what] += 1
        print("%-12s %4d  %s" % (what, n, text), flush=True)
        if self.o.keep:
            keep = pathlib.Path(self.o.keep) / ("%d-%d-%s" % (self.o.seed, n, what))
            keep.mkdir(parents=True, exist_ok=True)
            for f in folder.iterdir():
                (keep / f.name).write_bytes(f.read_bytes())
            (keep / "found.txt").write_text(text + "\n")

    def one(self, n, folder):
        spec, text = generate.case(self.o.seed, n)
        where = generate.profile(spec, folder, self.key)
        (folder / "in.nc").write_text(text)
        (folder / "spec.json").write_text(json.dumps(spec))
        self.tally["programs " + spec["dialect"]] += 1
        try:
            ideal = stretches(centre.path(spec, text))
        except (centre.Refused, centre.Unreadable) as why:
            self.tally["unjudged: the input is refused here: %s" % str(why).splitlines()[-1][:60]] += 1
            return
        status, output, errors = run(self.o.vpost, "correct", folder / "in.nc", "-m", where, "--zero", "true")
        if status == 2:
            self.report("profile", n, folder, errors.strip().replace("\n", " | ")[:300])
            return
        if status:
            code = (re.search(r"error\[(VP\d+)\]", errors) or [None, "none"])[1]
            self.refused[code] += 1
            self.first.setdefault(code, (n, errors.strip().splitlines()[:4]))
            return
        (folder / "out.nc").write_text(output)
        self.tally["corrected " + spec["dialect"]] += 1
        if spec["state"] == "perfect":
            self.tally["perfect"] += 1
            if output != text:
                self.report("perfect", n, folder, "not the same bytes")
            return
        self.tally["compensation left in the output"] += bool(re.search(r"^[^(]*G4[12]", output, re.M))
        if n % 5 == 0:
            self.tally["of every fifth, off the way before"] += bool(compare(spec, text, text)[0])
        found, largest = compare(spec, text, output)
        if found and found[0][0] == "path" and "VP0508" in errors:
            # The contour was corrected, and the command says so: the error may differ by what it changes over a radius.
            points = np.concatenate([x for kind, x in ideal if kind == "feed"])
            more = spec["radius"] * Mill(spec).gradient(points)
            again, largest = compare(spec, text, output, limit(spec) + more)
            if not again:
                self.tally["off by more than the tolerance, and warned of (VP0508)"] += 1
                self.worst = max(self.worst, largest)
                return
            found = again
        for what, why in found[:2]:
            self.report(what, n, folder, "%s (%s, radius %s)" % (why, spec["dialect"], spec["radius"]))
        status, _, errors = run(self.o.vpost, "check", folder / "in.nc", folder / "out.nc", "-m", where, "--zero", "true")
        if (status != 0) != bool(found):
            self.report("check-blind" if found else "check-alarm", n, folder, errors.strip().replace("\n", " | ")[:200])

    def all(self):
        for n in range(self.o.first, self.o.first + self.o.count):
            if n % 20 == 0:
                print("# %d" % n, file=sys.stderr, flush=True)
            with tempfile.TemporaryDirectory() as folder:
                try:
                    self.one(n, pathlib.Path(folder))
                except subprocess.TimeoutExpired:
                    self.report("slow", n, pathlib.Path(folder), "180 s")
        for name, count in sorted(self.tally.items()):
            print("%6d  %s" % (count, name))
        if self.worst:
            print("largest distance warned of: %.2f um" % (self.worst * 1e3))
        for code, count in self.refused.most_common():
            print("%6d  refused by %s, as number %d: %s" % (count, code, *self.first[code]))
        return 1 if self.found else 0


def radius_key(vpost):
    """What [tool] of the command's profile calls the radius of a tool, if it has one."""
    try:
        names = json.loads(run(vpost, "profile", "schema")[1]).get("$defs", {}).get("Tool", {}).get("properties", {})
    except (OSError, ValueError):
        return None
    return next((k for k in names if re.search(r"radi", k)), None)


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--vpost", default="target/release/vpost")
    words.add_argument("--count", type=int, default=100)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--radius-key", help="key of [tool] that holds the radius by D number")
    words.add_argument("--keep")
    words.add_argument("--self-test", action="store_true")
    options = words.parse_args()
    if options.self_test:
        import self_test

        return self_test.main(options.vpost)
    return Judge(options).all()


if __name__ == "__main__":
    sys.exit(main())
