#!/usr/bin/env python3
"""Judge of Siemens' CYCLE800: where the tip really goes in the workpiece, with the output, on a crooked machine.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR]
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

import generate
import reader
from machine import Machine, put

UPRIGHT = 5e-6  # rad, VP0232
SLACK = 0.1e-3  # sampling of arcs, mm
LEAD = 1.0  # a feed to a corrected start is shorter, mm


def run(vpost, *words):
    done = subprocess.run([str(vpost), *map(str, words)], capture_output=True, text=True, timeout=180)
    return done.returncode, done.stdout, done.stderr


def limit(spec):
    return spec["tolerance"] * 1e-3 + 0.5 * np.linalg.norm([spec["linear"][k]["resolution"] for k in "XYZ"]) + SLACK


def ideal_place(m, move, u):
    return put(move.whole, u)


def real_place(m, move, u):
    """Where the real tip is in the workpiece for words u (n, 3) in the frame of a motion."""
    return m.tip(m.command(put(move.whole, u), move.theta, move.length_), move.theta, move.length_)


def dense(move):
    n = 2 + int(move.length() / 1.2)
    if move.kind == "arc":
        n = max(n, 2 + int(abs(move.sweep) / np.sqrt(8 * 0.05e-3 / max(move.radius, 0.01))))
    return move.at(np.linspace(0.0, 1.0, n))


def stretches(read, place, m):
    """[("do", text) | ("rapid", block, end, named) | ("feed", blocks, feeds, points (n, 3))] with feeds joined."""
    out = []
    for item in read:
        if item[0] == "do":
            out.append(("do", item[1], item[2]))
            continue
        move = item[2]
        if move.kind == "rapid":
            known = not np.isnan(move.u1).any() and None not in move.theta.values()
            out.append(("rapid", move.number, place(m, move, move.u1[None])[0] if known else None, move.named))
            continue
        points = place(m, move, dense(move))
        block = (move.number, move.feed, len(points))
        if out and out[-1][0] == "feed":
            out[-1][1].append(block)
            out[-1][2].append(points)
        else:
            out.append(("feed", [block], [points]))
    return out


def along(points, polyline, allowed):
    """Runs `points` along a polyline, forwards only: (largest distance, how far along it ends, largest step back)."""
    way = np.diff(polyline, axis=0)
    size = np.linalg.norm(way, axis=1)
    start = np.concatenate([[0.0], np.cumsum(size)])
    k, worst, where, reached, back = 0, 0.0, 0, 0.0, 0.0
    for n, p in enumerate(points):
        lo, hi = max(0, k - 4), min(len(way), k + 60)
        d = p - polyline[lo:hi]
        t = np.clip(np.einsum("ij,ij->i", d, way[lo:hi]) / np.maximum(size[lo:hi] ** 2, 1e-30), 0.0, 1.0)
        off = np.linalg.norm(d - t[:, None] * way[lo:hi], axis=1)
        # The first place that is near enough, not behind the last one; where none is, the nearest.
        here = start[lo:hi] + t * size[lo:hi]
        good = np.flatnonzero((off <= allowed) & (here >= reached - 4 * allowed))
        best = int(np.argmin(off)) if not len(good) else int(good[np.argmin(off[good] + 1e-3 * (here[good] - reached))])
        if off[best] > worst:
            worst, where = float(off[best]), n
        back = max(back, reached - here[best])
        reached = max(reached, float(here[best]))
        k = lo + best
    return worst, where, start[-1] - reached, back


def same_way(ideal, made, allowed, lead):
    """None, or what is wrong with a stretch of feeds. `lead`: it may begin with a short move to its start."""
    if lead:
        # A rapid may have left the tip beside the start: what leads there is no part of the way.
        near = np.flatnonzero(np.linalg.norm(made - ideal[0], axis=1) <= allowed)
        first = int(near[0]) if len(near) else 0
        if first and np.linalg.norm(np.diff(made[: first + 1], axis=0), axis=1).sum() < LEAD:
            made = made[first:]
    for name, a, b in (("off the way", made, ideal), ("leaves out", ideal, made)):
        worst, where, left, back = along(a, b, allowed)
        if worst > allowed:
            return "%s: %.2f um at %s, limit %.2f" % (name, worst * 1e3, np.round(a[where], 3).tolist(), allowed * 1e3)
        if left > 8 * allowed:
            return "%s: %.3f mm at its end" % (name, left)
        if back > 12 * allowed:
            return "%s: goes back by %.3f mm" % (name, back)
    return None


def compare(m, text_in, text_out):
    """[(what, block, text)]"""
    try:
        before = stretches(reader.read(text_in, m), ideal_place, m)
    except reader.Unreadable as why:
        return [("judge", 0, "input: %s" % why)]
    try:
        after_read = reader.read(text_out, m)
        after = stretches(after_read, real_place, m)
    except (reader.Unreadable, KeyError, TypeError) as why:
        return [("unreadable", 0, str(why))]
    found = []
    for _, number, move in (x for x in after_read if x[0] == "motion"):
        if move.kind == "rapid" or None in move.theta.values():
            continue
        lean = np.linalg.norm(np.cross(m.upright(move.theta), move.whole[:3, 2]))
        if lean > UPRIGHT or m.upright(move.theta) @ move.whole[:3, 2] < 0:
            found.append(("upright", number, "the tool leans by %.1f urad" % (lean * 1e6)))
            break
    allowed = limit(m.spec)
    a, b = [x[0] for x in before], [x[0] for x in after]
    if a != b:
        k = next((n for n, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
        return found + [("structure", before[min(k, len(before) - 1)][1], "%s became %s" % (a[k : k + 2], b[k : k + 2]))]
    lead = True
    for one, two in zip(before, after):
        if one[0] == "do":
            if not same_words(one[2], two[2]):
                found.append(("process", one[1], "%s became %s" % (one[2], two[2])))
            lead = True
        elif one[0] == "rapid":
            lead = True
            if one[3] != two[3]:
                found.append(("structure", one[1], "a rapid of %s became one of %s" % (one[3], two[3])))
            elif one[2] is not None and two[2] is not None and len(one[3]) == 3:
                off = np.linalg.norm(two[2] - one[2])
                if off > 4 * allowed:
                    found.append(("rapid", one[1], "%.2f um, limit %.2f" % (off * 1e3, 4 * allowed * 1e3)))
        else:
            wrong = same_way(np.concatenate(one[2]), np.concatenate(two[2]), allowed, lead)
            if wrong:
                found.append(("path", one[1][0][0], wrong))
            if [f for _, f, _ in one[1]][-1] != [f for _, f, _ in two[1]][-1] or {f for _, f, _ in one[1]} != {f for _, f, _ in two[1]}:
                found.append(("feed", one[1][0][0], "%s became %s" % ({f for _, f, _ in one[1]}, {f for _, f, _ in two[1]})))
            lead = False
    return found


def same_words(a, b):
    """The same but for angles that differ by half a thousandth of a degree."""
    if a == b:
        return True
    numbers = [list(map(float, re.findall(r"-?\d+\.\d+", x))) for x in (a, b)]
    if re.sub(r"-?\d+\.\d+", "#", a) != re.sub(r"-?\d+\.\d+", "#", b) or not a.startswith("turn"):
        return False
    return all(abs(x - y) <= 0.0006 for x, y in zip(*numbers))


class Judge:
    def __init__(self, options):
        self.o, self.tally, self.refused, self.first = options, collections.Counter(), collections.Counter(), {}
        self.found, self.before, self.known = 0, 0.0, kinematics_keys(options.vpost)

    def report(self, what, n, folder, text):
        self.found += 1
        self.tally["found " + what] += 1
        print("%-10s %4d  %s" % (what, n, text), flush=True)
        if self.o.keep:
            keep = pathlib.Path(self.o.keep) / ("%d-%d-%s" % (self.o.seed, n, what))
            keep.mkdir(parents=True, exist_ok=True)
            for f in folder.iterdir():
                (keep / f.name).write_bytes(f.read_bytes())
            (keep / "found.txt").write_text(text + "\n")

    def one(self, n, folder):
        spec, text, has = generate.case(self.o.seed, n)
        m = Machine(spec)
        # The way that CYCLE800 says is the profile's own, so that neither contradicts the other.
        where = generate.profile(spec, folder, self.known, "-" if ",-1" in text and "DIR 1" not in has else "+")
        (folder / "in.nc").write_text(text)
        (folder / "spec.json").write_text(json.dumps(spec))
        self.tally["programs"] += 1
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
        self.tally["corrected"] += 1
        self.tally.update("%s: %s" % (spec["kind"], x) for x in ["corrected"])
        self.tally.update(has)
        if spec["state"] == "perfect":
            self.tally["perfect"] += 1
            if output != text:
                self.report("perfect", n, folder, "not the same bytes")
        elif n % 5 == 0:
            self.tally["of every fifth, off the way before"] += any(what == "path" for what, _, _ in compare(m, text, text))
        found = compare(m, text, output)
        for what, block, why in found[:2]:
            self.report(what, n, folder, "N%s %s (%s)" % (block, why, spec["kind"]))
        status, _, errors = run(self.o.vpost, "check", folder / "in.nc", folder / "out.nc", "-m", where, "--zero", "true")
        if (status != 0) != bool(found):
            self.report("check-blind" if found else "check-alarm", n, folder, errors.strip().replace("\n", " | ")[:200])

    def all(self):
        for n in range(self.o.first, self.o.first + self.o.count):
            with tempfile.TemporaryDirectory() as folder:
                try:
                    self.one(n, pathlib.Path(folder))
                except subprocess.TimeoutExpired:
                    self.report("slow", n, pathlib.Path(folder), "180 s")
        for name, count in sorted(self.tally.items()):
            print("%6d  %s" % (count, name))
        for code, count in self.refused.most_common():
            print("%6d  refused by %s, as number %d: %s" % (count, code, *self.first[code]))
        return 1 if self.found else 0


def kinematics_keys(vpost):
    """Names of [kinematics] that the command knows."""
    try:
        schema = json.loads(run(vpost, "profile", "schema")[1])
    except (OSError, ValueError):
        return set()
    return set(schema.get("$defs", {}).get("Kinematics", schema).get("properties", {}))


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--vpost", default="target/release/vpost")
    words.add_argument("--count", type=int, default=100)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--keep")
    words.add_argument("--self-test", action="store_true")
    options = words.parse_args()
    if options.self_test:
        import self_test

        return self_test.main(options.vpost)
    return Judge(options).all()


if __name__ == "__main__":
    sys.exit(main())
