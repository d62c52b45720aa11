#!/usr/bin/env python3
"""Judge of Siemens' CYCLE800: where the tip really goes in the workpiece, with the output, on a crooked machine.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR]
    judge.py --vpost target/release/vpost --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import json
import os
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, command, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import generate  # noqa: E402
import reader  # noqa: E402
from machine import Machine, put  # noqa: E402

UPRIGHT = 5e-6  # rad, VP0232
SLACK = 0.1e-3  # sampling of arcs, mm
LEAD = 1.0  # a feed to a corrected start is shorter, mm


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


def one(case):
    spec, text, has = generate.case(case.options.seed, case.number)
    m = Machine(spec)
    # The way that CYCLE800 says is the profile's own, so that neither contradicts the other.
    where = generate.profile(spec, case.folder, case.options.known, "-" if ",-1" in text and "DIR 1" not in has else "+")
    case.write("in.nc", text)
    case.write("spec.json", json.dumps(spec))
    case.tally["programs"] += 1
    done = case.correct("-m", where, "--zero", "true")
    if not done:
        return
    output, _ = done
    case.tally.update(["corrected", "%s: corrected" % spec["kind"], *has])
    if spec["state"] == "perfect":
        case.tally["perfect"] += 1
        if output != text:
            case.find("perfect", "not the same bytes")
    elif case.number % 5 == 0:
        case.tally["of every fifth, off the way before"] += any(what == "path" for what, _, _ in compare(m, text, text))
    found = compare(m, text, output)
    for what, block, why in found[:2]:
        case.find(what, "N%s %s (%s)" % (block, why, spec["kind"]))
    case.check(bool(found), "-m", where, "--zero", "true")


def main():
    words = options.parser(__doc__, 100, "first", vpost="target/release/vpost")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main(given.vpost)
    given.known = set(command.schema(given.vpost, "Kinematics"))
    return cases.campaign(given, one)


if __name__ == "__main__":
    sys.exit(main())
