#!/usr/bin/env python3
"""Judge of cutter compensation: where the tool's centre goes with the output, on a crooked mill, against the input's way.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR] [--radius-key NAME]
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

import centre  # noqa: E402
import generate  # noqa: E402
from mill import Mill  # noqa: E402

SLACK = {"linuxcnc": 0.25e-3, "fanuc": 0.1e-3}  # rs274 prints four decimals: of ends, and of centres, mm
LEAD = 1.0


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


def one(case):
    spec, text = generate.case(case.options.seed, case.number)
    where = generate.profile(spec, case.folder, case.options.radius_key)
    case.write("in.nc", text)
    case.write("spec.json", json.dumps(spec))
    case.tally["programs " + spec["dialect"]] += 1
    try:
        ideal = stretches(centre.path(spec, text))
    except (centre.Refused, centre.Unreadable) as why:
        case.tally["unjudged: the input is refused here: %s" % str(why).splitlines()[-1][:60]] += 1
        return
    done = case.correct("-m", where, "--zero", "true")
    if not done:
        return
    output, errors = done
    case.tally["corrected " + spec["dialect"]] += 1
    if spec["state"] == "perfect":
        case.tally["perfect"] += 1
        if output != text:
            case.find("perfect", "not the same bytes")
        return
    case.tally["compensation left in the output"] += bool(re.search(r"^[^(]*G4[12]", output, re.M))
    if case.number % 5 == 0:
        case.tally["of every fifth, off the way before"] += bool(compare(spec, text, text)[0])
    found, _ = compare(spec, text, output)
    if found and found[0][0] == "path" and "VP0508" in errors:
        # The contour was corrected, and the command says so: the error may differ by what it changes over a radius.
        points = np.concatenate([x for kind, x in ideal if kind == "feed"])
        more = spec["radius"] * Mill(spec).gradient(points)
        again, largest = compare(spec, text, output, limit(spec) + more)
        if not again:
            case.tally["off by more than the tolerance, and warned of (VP0508)"] += 1
            case.figures["distance warned of, um"] = largest * 1e3
            return
        found = again
    for what, why in found[:2]:
        case.find(what, "%s (%s, radius %s)" % (why, spec["dialect"], spec["radius"]))
    case.check(bool(found), "-m", where, "--zero", "true")


def main():
    words = options.parser(__doc__, 100, "first", vpost="target/release/vpost")
    words.add_argument("--radius-key", help="key of [tool] that holds the radius by D number")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main(given.vpost)
    given.radius_key = given.radius_key or next((k for k in command.schema(given.vpost, "Tool") if "radi" in k), None)
    print("radius of a tool in the profile: %s" % (given.radius_key or "no key known"))
    return cases.campaign(given, one)


if __name__ == "__main__":
    sys.exit(main())
