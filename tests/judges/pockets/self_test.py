"""Shows that the judge finds what is wrong and passes what is right, with outputs of a corrector of its own."""

import re

import numpy as np

from common.trial import Trial

import generate
import judge
import reader
from lathe import Lathe


def passes(asked, below=0.0, sign=1.0):
    """Moves [(kind, (r, z))] of a roughing: levels, in each the stretches above the contour, then along the contour.

    `below`: deeper than the allowances say, `sign` -1: allowances to the wrong side.
    """
    c, out = asked["contour"], []
    u, w = sign * asked["u"] / 2, sign * asked["w"]
    away = (np.array([u, w]) if c.facing else np.array([w, u])) - [0.0, below * c.side]
    line = judge.fill(c.points() + away, 0.02)
    start = np.array(c.start if c.facing else c.start[::-1], float)
    rz = (lambda a, b: (a, b)) if c.facing else (lambda a, b: (b, a))
    # How far in the contour lets a pass in a place be: at a wall the shallowest.
    level, lowest = start[1] - c.side * asked["depth"], (c.side * line[:, 1]).min()
    clear = start[1] + c.side * 0.5
    while c.side * level > lowest:
        free = c.side * line[:, 1] < c.side * level - 1e-9
        k = 0
        while k < len(free):
            if not free[k]:
                k += 1
                continue
            j = k
            while j + 1 < len(free) and free[j + 1]:
                j += 1
            a0, a1 = line[k][0], line[j][0]
            if a0 - a1 > 0.05:
                # Down along the way at the places that are cut above already, or before the stock.
                a0 = start[0] if k == 0 else a0 - 0.001
                out.append(("G0", rz(a0, clear)))
                # Into the stock of a pocket in a feed.
                out.append(("G0" if k == 0 else "G1", rz(a0, level)))
                out.append(("G1", rz(a1 + 0.001, level)))
                out.append(("G0", rz(a1 + 0.001, clear)))
            k = j + 1
        level -= c.side * asked["depth"]
    out.append(("G0", rz(start[0], clear)))
    out.append(("G0", rz(start[0], line[0][1])))
    out += [("G1", rz(a, b)) for a, b in c.points() + away]
    out.append(("G0", c.start))
    return out


def written(spec, moves, feed):
    goals, kinds, at = [], [], None
    for kind, place in moves:
        # Short pieces, so that the machine's errors between them do not matter.
        n = 1 if at is None or kind == "G0" else 1 + int(np.linalg.norm(np.subtract(place, at)) / 4)
        for k in range(n):
            goals.append(place if n == 1 else np.array(at) + (k + 1) / n * np.subtract(place, at))
            kinds.append(kind)
        at = place
    said = " F" + generate.number(feed)
    words = Lathe(spec).solved(np.array(goals, float))
    return ["%s X%.4f Z%.4f%s" % (kind, 2 * x, z, said if kind == "G1" else "") for kind, (x, z) in zip(kinds, words)]


def output(spec, text, asked, **wrong):
    """The program with its cycles as moves."""
    c, out, skip = asked["contour"], [], False
    diameter = wrong.pop("diameter", False)
    for line in text.splitlines():
        number = re.match(r"N(\d+)", line)
        n = int(number.group(1)) if number else 0
        if n == asked["rough"]:
            rough = written(spec, passes(asked, **wrong), asked["feed"])
            out += ["N%d" % n] + rough
        elif n == asked["finishing"]:
            pts = c.points()
            ways = [("G0", c.start)] + [("G0" if k == 0 else "G1", tuple(p)) for k, p in enumerate(c.rz(judge.fill(pts, 3.0)))] + [("G0", c.start)]
            out += ["N%d" % n] + written(spec, ways, asked["finish"])
        elif 100 <= n < 800 or n == 10:
            continue
        else:
            out.append(line)
    if diameter:
        # The radius' correction written into a word that counts diameters.
        out = uncorrected_half(spec, out)
    return "\n".join(out) + "\n"


def uncorrected_half(spec, lines):
    found = [re.fullmatch(r"(G[01]) X(-?[\d.]+) Z(-?[\d.]+)(.*)", x) for x in lines]
    at = [k for k, x in enumerate(found) if x]
    words = np.array([[float(found[k].group(2)) / 2, float(found[k].group(3))] for k in at])
    places, out = Lathe(spec).places(words), list(lines)
    for k, (x, z), (r, _) in zip(at, words, places):
        # Programmed diameter 2 r; written: half of what X was corrected by.
        out[k] = "%s X%.4f Z%.4f%s" % (found[k].group(1), 2 * r + (x - r), z, found[k].group(4))
    return out


def cases(seed, kinds, count):
    out, n = [], 0
    while len(out) < count:
        spec, text, asked = generate.case(seed, n)
        n += 1
        if spec["kind"] in kinds and spec["state"] == "crooked":
            spec["resolution"] = {"X": 0.0002, "Z": 0.0001}
            out.append((spec, text, asked))
    return out


def names(spec, asked, text, out):
    return {what for what, _ in judge.compare(spec, asked, text, out)}


def main(vpost):
    t = Trial()
    figures(t)
    for kinds in (("turn-1", "bore-1"), ("turn-2", "bore-2"), ("face-1",), ("face-2",)):
        programs = cases(4, kinds, 4)
        wrong = [judge.compare(s, a, text, output(s, text, a)) for s, text, a in programs]
        t.ask(not any(wrong), "%s: right outputs that pass: %d of %d %s" % (kinds[0], sum(not x for x in wrong), len(wrong), [x for x in wrong if x][:2]))
        got = [names(s, a, text, output(s, text, a, below=0.02)) for s, text, a in programs]
        t.ask(all("gouge" in x for x in got), "%s: 20 um below the contour: found %d of %d" % (kinds[0], sum("gouge" in x for x in got), len(got)))
        got = [names(s, a, text, output(s, text, a, below=-0.02)) for s, text, a in programs]
        t.ask(all("left" in x for x in got), "%s: 20 um left: found %d of %d" % (kinds[0], sum("left" in x for x in got), len(got)))
        signs = [(s, text, a) for s, text, a in programs if a["u"] or a["w"]]
        got = [names(s, a, text, output(s, text, a, sign=-1.0)) for s, text, a in signs]
        t.ask(all("gouge" in x for x in got), "%s: allowances with the other sign: found %d of %d" % (kinds[0], sum("gouge" in x for x in got), len(got)))
        got = [names(s, a, text, output(s, text, a, diameter=True)) for s, text, a in programs]
        t.ask(sum(bool(x) for x in got) >= len(got) - 1, "%s: radius for diameter: found %d of %d" % (kinds[0], sum(bool(x) for x in got), len(got)))
        got = []
        for s, text, a in (x for x in programs if x[0]["system"] == "A"):
            # U for X: a distance where a place is said.
            good = output(s, text, a).splitlines()
            k = [n for n, x in enumerate(good) if x.startswith("G1 X")][-3]
            good[k] = good[k].replace("X", "U")
            got.append(names(s, a, text, "\n".join(good)))
        t.ask(all(got), "%s: U for X: found %d of %d" % (kinds[0], sum(bool(x) for x in got), len(got)))
    others(t, vpost)
    return t.status()


def others(t, vpost):
    """Grooves, threads, holes: outputs of the judge's own, and damaged ones."""
    for kind, damage in (("groove", "places"), ("peck", "places"), ("thread", "root"), ("hole", "hole")):
        good = bad = count = 0
        for spec, text, asked in cases(6, (kind,), 2):
            count += 1
            out = written_other(spec, text, asked)
            found = judge.compare(spec, asked, text, out)
            good += not found
            if found:
                print("    ", kind, found[:2])
            other = dict(asked)
            other[damage] = asked["root"] + 0.02 if damage == "root" else [x + 0.02 for x in asked["places"]] if damage == "places" else (asked["hole"][0], asked["hole"][1], asked["hole"][2] + 0.02)
            bad += bool(judge.compare(spec, asked, text, written_other(spec, text, other)))
        t.ask(good == count and bad == count, "%s: right %d, 20 um off found %d of %d" % (kind, good, bad, count))


def written_other(spec, text, asked):
    ways = [("G0", asked["start"])]
    if "groove" in asked:
        put = (lambda p, d: (d, p)) if asked["groove"] else (lambda p, d: (p, d))
        top = asked["start"][0] if asked["groove"] else asked["start"][1]
        for p in asked["places"]:
            ways.append(("G0", put(p, top)))
            d = top
            while d > asked["deep"]:
                d = max(d - asked["peck"], asked["deep"])
                ways.append(("G1", put(p, d)))
            ways.append(("G0", put(p, top)))
    elif "thread" in asked:
        n, deep = 0, 0.0
        z0, z1 = asked["thread"]
        levels = []
        while deep < asked["height"] - asked["allow"] - 1e-9:
            n += 1
            deep = min(max(asked["first"] * n**0.5, deep + asked["least"]), asked["height"] - asked["allow"])
            levels.append(deep)
        for deep in levels + [asked["height"]]:
            r = asked["root"] + asked["height"] - deep
            ways += [("G0", (r, z0)), ("G32", (r, z1)), ("G0", (asked["start"][0], z1)), ("G0", asked["start"])]
    else:
        place, level, end = asked["hole"]
        ways += [("G0", (place, level)), ("G1", (place, end))]
    ways.append(("G0", asked["start"]))
    m, moves = Lathe(spec), []
    for kind, place in ways:
        x = m.solved(np.array([place], float))[0] if "hole" not in asked or place[0] > 1 else on_axis(m, place)
        name = "G33" if kind == "G32" and spec["system"] != "A" else kind
        feed = asked.get("feed", asked.get("lead"))
        moves.append("%s X%.4f Z%.4f" % (name, 2 * x[0], x[1]) + (" F%s" % generate.number(feed) if kind != "G0" else ""))
    out = []
    for line in text.splitlines():
        if line.startswith("N20 "):
            out += ["N20"] + moves
        elif not line.startswith(("N5 ", "N10 ", "N30 ")):
            out.append(line)
    return "\n".join(out) + "\n"


def on_axis(m, place):
    """X as programmed, Z corrected."""
    x = np.array([0.0, place[1]])
    for _ in range(5):
        x[1] += place[1] - m.places(x[None])[0][1]
    return x


def figures(t):
    """Figures by hand."""
    spec = {"tables": {}, "squareness": {"EB0Z": 100.0, "EA0Z": 0.0}, "spindle": {"EX0S": 0.0, "EY0S": 0.0, "EA0S": 0.0, "EB0S": 0.0},
            "face": 0.0, "length": [0.0, 0.0], "offset": [0.0, 0.0]}
    r = Lathe(spec).places(np.array([[20.0, 300.0]]))[0]
    t.ask(abs(r[0] - 20.03) < 1e-9, "100 urad of Z to the spindle over 300 mm: 30 um on the radius")
    spec["spindle"]["EB0S"] = 100.0
    r = Lathe(spec).places(np.array([[20.0, 300.0]]))[0]
    t.ask(abs(r[0] - 20.0) < 1e-6, "the spindle's axis leaning as Z does: no taper")
    spec["spindle"] = {"EX0S": 5.0, "EY0S": 0.0, "EA0S": 0.0, "EB0S": 100.0}
    r = Lathe(spec).places(np.array([[20.0, 0.0]]))[0]
    t.ask(abs(r[0] - 19.995) < 1e-6, "the axis 5 um towards +X: the radius shrinks")
    moves, _ = reader.read("G0 X20. Z0.\nG2 X30. Z-5. R5.\nG1 U2. F0.1", "A")
    p = moves[1].points()
    t.ask(np.allclose(moves[1].centre, [15.0, 0.0]) and np.allclose(p[-1], [15.0, -5.0]), "G2 to larger X and smaller Z is hollow, its centre outside")
    t.ask(abs(moves[2].end[0] - 16.0) < 1e-12, "U2 is one millimetre of radius")
