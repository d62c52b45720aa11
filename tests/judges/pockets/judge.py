#!/usr/bin/env python3
"""Judge of the cycles of Fanuc's lathes: what is left of the part by the output, in radius and Z, on a crooked lathe.

    judge.py --vpost target/release/vpost --count 300 [--seed 1] [--first 0] [--keep DIR]
    judge.py --vpost target/release/vpost --self-test

Exit status 1 where something is found. What is asked stands in README.md.
"""

import os
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import generate  # noqa: E402
import reader  # noqa: E402
from lathe import Lathe  # noqa: E402

SLACK = 0.06e-3
LEAD = 1.0  # a feed to a corrected start is shorter, mm
RAPID = 0.02  # how far a rapid may be below what was cut: twice the errors there, mm


def limit(spec):
    """Tolerance and half output steps; X is a diameter."""
    return spec["tolerance"] * 1e-3 + np.hypot(spec["resolution"]["X"] / 4, spec["resolution"]["Z"] / 2) + SLACK


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


def fill(points, step=0.4):
    """The same way with places no further apart than `step`."""
    out = [points[:1]]
    for a, b in zip(points[:-1], points[1:]):
        n = 1 + int(np.linalg.norm(b - a) / step)
        out.append(a + np.linspace(0, 1, n + 1)[1:, None] * (b - a))
    return np.concatenate(out)


def same_way(ideal, made, allowed):
    near = np.flatnonzero(np.linalg.norm(made - ideal[0], axis=1) <= allowed)
    first = int(near[0]) if len(near) else 0
    if first and np.linalg.norm(np.diff(made[: first + 1], axis=0), axis=1).sum() < LEAD:
        made = made[first:]
    for name, a, b in (("off the way", made, ideal), ("leaves out", ideal, made)):
        worst, where, left, back = along(a, b, allowed)
        if worst > allowed:
            return "%s: %.2f um at r, z %s, limit %.2f" % (name, worst * 1e3, np.round(a[where], 3).tolist(), allowed * 1e3)
        if left > 8 * allowed or back > 12 * allowed:
            return "%s: %.3f mm at its end, %.3f mm back" % (name, left, back)
    return None


class Lower:
    """How far in the tool has been, on a grid along the axis on which the contour is monotone."""

    def __init__(self, low, high, level, side):
        self.at, self.side = np.arange(low, high, 0.02), side
        self.level = np.full(len(self.at), side * level)

    def below(self, points):
        """For a way (n, 2) of (along, into): grid places it passes and side * into there."""
        a, b = points[:-1], points[1:]
        places, levels = [], []
        for (a0, b0), (a1, b1) in zip(a, b):
            k0, k1 = np.searchsorted(self.at, [min(a0, a1), max(a0, a1)])
            if k1 > k0:
                x = self.at[k0:k1]
                places.append(np.arange(k0, k1))
                levels.append(self.side * (b0 + (x - a0) / (a1 - a0) * (b1 - b0)))
        if not places:
            return np.array([], int), np.array([])
        return np.concatenate(places), np.concatenate(levels)

    def cut(self, where, levels):
        np.minimum.at(self.level, where, levels)


def rough(m, asked, moves, allowed):
    """What is wrong with a roughing: below its contour, more than a depth at once, a rapid in the stock, stock left."""
    c = asked["contour"]
    u, w = asked["u"] / 2, asked["w"]
    off = np.array([u, w]) if c.facing else np.array([w, u])
    # Backwards, since all contours run towards smaller places: walls then keep their order.
    line = fill(c.points() + off, 0.05)[::-1]
    line[:, 0] = np.round(line[:, 0], 9)
    order = np.argsort(line[:, 0], kind="stable")
    a, b = line[order, 0], c.side * line[order, 1]
    low, high = a[0] + 0.03, a[-1] - 0.03
    away = c.start[1] if c.facing else c.start[0]
    stock = Lower(low, high, away, c.side)
    edge = a[-1] - 0.5  # the stock begins inside of where the contour starts
    found = []
    for move in moves:
        if np.isnan(move.start).any():
            continue
        rz = m.places(move.points())
        p = rz if c.facing else rz[:, ::-1]
        # Below the contour with its allowances.
        inside = (p[:, 0] > low + allowed) & (p[:, 0] < high - allowed)
        q = p[inside]
        if len(q):
            floor = np.min([np.interp(q[:, 0] + d, a, b) for d in (-allowed, 0.0, allowed)], axis=0)
            deep = floor - c.side * q[:, 1]
            if deep.max() > allowed:
                k = int(np.argmax(deep))
                found.append(("gouge", "a %s is %.2f um below the contour with its allowances at %s, limit %.2f" % (move.kind, deep[k] * 1e3, np.round(q[k], 3).tolist(), allowed * 1e3)))
                break
        where, levels = stock.below(p)
        if not len(where):
            continue
        # Where an earlier pass ended some micrometres before a wall, its neighbour says how deep it was.
        last = len(stock.level) - 1
        new = np.min([stock.level[np.clip(where + k, 0, last)] for k in (-2, -1, 0, 1, 2)], axis=0) - levels
        in_stock = stock.at[where] < edge
        if move.kind == "rapid":
            if (new[in_stock] > RAPID).any():
                k = int(np.argmax(np.where(in_stock, new, -1)))
                found.append(("rapid in stock", "%.3f mm at %.3f" % (new[k], stock.at[where[k]])))
                break
            continue
        flat = np.ptp(p[:, 1]) < 0.03
        if flat and (new[in_stock] > asked["depth"] + 0.02).any():
            found.append(("depth", "%.3f mm at once, U or D says %.3f" % (new[in_stock].max(), asked["depth"])))
            break
        if move.feed != asked["feed"]:
            found.append(("feed", "F%s in roughing, F%s is said" % (move.feed, asked["feed"])))
            break
        stock.cut(where, levels)
    ceiling = np.max([np.interp(stock.at + d, a, b) for d in (-0.03, -0.015, 0.0, 0.015, 0.03)], axis=0)
    # Between these places the highest are corners: beside a wall that ends in a slope, 8 um above the nearest of them.
    for k0, k1, top in zip(*np.searchsorted(stock.at, [a - 0.03, a + 0.03]), b):
        ceiling[k0:k1] = np.maximum(ceiling[k0:k1], top)
    left = stock.level - ceiling
    if not found and left.max() > allowed:
        k = int(np.argmax(left))
        found.append(("left", "%.2f um more than the allowances at %.3f" % (left[k] * 1e3, stock.at[k])))
    return found


def finish(m, asked, moves, allowed):
    c = asked["contour"]
    feeds = [x for x in moves if x.kind != "rapid"]
    if not feeds:
        return [("left", "no finishing")]
    made = np.concatenate([m.places(x.points()) for x in feeds])
    wrong = same_way(fill(c.rz(c.points())), made, allowed)
    if wrong:
        return [("finish", wrong)]
    if {x.feed for x in feeds} != {asked["finish"]}:
        return [("feed", "F%s in finishing, F%s is said" % ({x.feed for x in feeds}, asked["finish"]))]
    return []


def grooves(m, asked, moves, allowed):
    """Each place is pecked to the same depth; nothing is cut beside them, no peck is larger than said."""
    along, into = (1, 0) if asked["groove"] else (0, 1)
    sure = {}
    for x in moves:
        if np.isnan(x.start).any():
            continue
        p = m.places(x.points())
        if x.kind == "rapid":
            inside = p[:, into] < asked["start"][into] - 0.02
            for at, level in p[inside][:, [along, into]]:
                k = min(asked["places"], key=lambda s: abs(s - at))
                # The way out stands off what was cut; between the places it is outside.
                if level < sure.get(k, asked["start"][into]) - RAPID:
                    return [("rapid in stock", "at %.3f, %.3f" % (at, level))]
            continue
        k = min(asked["places"], key=lambda s: abs(s - p[0, along]))
        off = np.abs(p[:, along] - k).max()
        if off > allowed:
            return [("path", "%.2f um beside the groove at %.3f, limit %.2f" % (off * 1e3, k, allowed * 1e3))]
        new = sure.get(k, asked["start"][into]) - p[:, into].min()
        if new > asked["peck"] + RAPID:
            return [("depth", "a peck of %.3f, said %.3f" % (new, asked["peck"]))]
        if x.feed != asked["feed"]:
            return [("feed", "F%s" % x.feed)]
        sure[k] = min(sure.get(k, 1e9), float(p[:, into].min()))
    for k in asked["places"]:
        if k not in sure or abs(sure[k] - asked["deep"]) > allowed:
            return [("path", "the groove at %.3f ends at %s, said %.3f" % (k, sure.get(k), asked["deep"]))]
    return []


def threads(m, asked, moves, allowed):
    """Each pass one block from where the cycle starts to its end, as deep as the cycle says, the last at the root."""
    z0, z1 = asked["thread"]
    passes = [x for x in moves if x.kind == "thread"]
    levels, n, deep = [], 0, 0.0
    while deep < asked["height"] - asked["allow"] - 1e-9:
        n += 1
        deep = min(max(asked["first"] * n**0.5, deep + asked["least"]), asked["height"] - asked["allow"])
        levels.append(deep)
    levels.append(asked["height"])
    if len(passes) != len(levels):
        return [("passes", "%d blocks in step with the spindle, %d passes are said" % (len(passes), len(levels)))]
    for x, deep in zip(passes, levels):
        p = m.places(x.points())
        r = asked["root"] + asked["height"] - deep
        ideal = np.array([[r, z0], [r, z1]])
        worst = np.abs(p[:, 0] - r).max()
        ends = np.abs(p[[0, -1], 1] - ideal[:, 1]).max()
        if max(worst, ends) > allowed:
            return [("path", "a pass at r %.4f is %.2f um off in r, %.2f in z, limit %.2f" % (r, worst * 1e3, ends * 1e3, allowed * 1e3))]
        if x.feed != asked["lead"]:
            return [("feed", "lead %s" % x.feed)]
    return []


def holes(m, asked, moves, allowed):
    place, level, end = asked["hole"]
    into, beside = (1, 0) if asked["along"] == "z" else (0, 1)
    feeds = [x for x in moves if x.kind == "feed"]
    if not feeds:
        return [("path", "no hole")]
    p = np.concatenate([m.places(x.points()) for x in feeds])
    # At the axis X cannot mend what the tip's height does.
    free = 0.15 if asked["along"] == "z" else allowed
    if abs(p[:, into].min() - end) > allowed or np.abs(np.abs(p[:, beside]) - abs(place)).max() > free:
        return [("path", "a hole to %.4f, said %.4f" % (p[:, into].min(), end))]
    if abs(p[0, into] - level) > allowed:
        return [("path", "R at %.4f, said %.4f" % (p[0, into], level))]
    return []


def compare(spec, asked, text_in, text_out):
    """[(what, text)] of an output."""
    m, allowed = Lathe(spec), limit(spec)
    try:
        moves, process = reader.read(text_out, spec["system"])
    except reader.Unreadable as why:
        return [("unreadable", str(why))]
    section = lambda lo, hi: [x for x in moves if lo <= (x.number or 0) < hi]
    if "contour" in asked:
        found = rough(m, asked, section(asked["rough"], 100), allowed)
        found += finish(m, asked, section(asked["finishing"], 805), allowed)
        last = section(asked["finishing"], 805)[-1:]
    else:
        check = grooves if "groove" in asked else threads if "thread" in asked else holes
        found = check(m, asked, section(asked["rough"], 30 if "hole" in asked else 900), allowed)
        last = section(asked["rough"], 900)[-1:]
    start = asked["contour"].start if "contour" in asked else asked["start"]
    if last and "hole" not in asked:
        goal = np.array(start)
        off = np.abs(m.places(last[0].end[None])[0] - goal).max()
        if off > 4 * allowed:
            found.append(("rapid", "ends %.2f um off the start" % (off * 1e3)))
    said = [x for x in re.findall(r"^N\d+ (G97 S800 M3|M30|T0101)", text_in, re.M)]
    if [x for _, x in process if x in said] != said:
        found.append(("process", "%s became %s" % (said, process)))
    return found


def one(case):
    spec, text, asked = generate.case(case.options.seed, case.number)
    where = generate.profile(spec, case.folder)
    case.write("in.nc", text)
    case.tally["programs"] += 1
    done = case.correct("-m", where, about=spec["kind"] + " ")
    if not done:
        return
    output, _ = done
    case.tally["corrected " + spec["kind"]] += 1
    if spec["state"] == "perfect":
        case.tally["perfect"] += 1
        if output != text:
            case.find("perfect", "not the same bytes")
        return
    try:
        found = compare(spec, asked, text, output)
    except reader.Kept as why:
        case.tally["unjudged: kept %s" % str(why).split()[0]] += 1
        return
    for what, why in found[:2]:
        case.find(what, "%s (%s %s)" % (why, spec["kind"], spec["system"]))
    case.check(bool(found), "-m", where)


def main():
    given = options.parser(__doc__, 100, "first", vpost="target/release/vpost").parse_args()
    if given.self_test:
        import self_test

        return self_test.main(given.vpost)
    return cases.campaign(given, one)


if __name__ == "__main__":
    sys.exit(main())
