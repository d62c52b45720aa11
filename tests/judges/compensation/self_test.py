"""Shows that the judge finds what is wrong and passes what is right: outputs that lead the centre itself, and damaged ones."""

import re

import numpy as np

from common.trial import Trial

import centre
import generate
import judge
from mill import Mill


def led(spec, moves):
    """A program without compensation that leads the tip of the crooked mill along a path of the centre."""
    m, lines = Mill(spec), ["G21 G17 G90 G40 G54 G94", "G43 H1"]
    for kind, what in moves:
        if kind == "rapid":
            x = m.solved(what[None])[0] if not np.isnan(what).any() else what
            lines.append("G0 " + " ".join("%s%s" % (k, generate.number(v, 4)) for k, v in zip("XYZ", x) if not np.isnan(v)))
            continue
        keep = [k for k in range(len(what)) if k % 3 == 0 or k == len(what) - 1 or corner(what, k)]
        for p in m.solved(what[keep])[1:]:
            lines.append("G1 X%.4f Y%.4f Z%.4f F300" % tuple(p))
    return "\n".join(lines + ["M30" if spec["dialect"] == "fanuc" else "M2"]) + "\n"


def corner(points, k):
    a, b = points[k] - points[k - 1], points[(k + 1) % len(points)] - points[k]
    return np.linalg.norm(np.cross(a, b)) > 1e-3 * np.linalg.norm(a) * np.linalg.norm(b)


def cases(seed, count, dialect):
    out, n = [], 0
    while len(out) < count:
        spec, text = generate.case(seed, n)
        n += 1
        if spec["state"] != "crooked" or spec["dialect"] != dialect or text.count("G40") > 2:
            continue
        spec["resolution"] = 0.0001
        try:
            out.append((spec, text, centre.path(spec, text)))
        except (centre.Refused, centre.Unreadable):
            continue
    return out


def swapped(text):
    return re.sub(r"G4([12])", lambda m: "G4" + "21"[int(m.group(1)) - 1], text)


def without_corner(moves):
    """The first long arc of the centre (or the bend of two lines) cut off by its chord."""
    out, done = [], False
    for kind, what in moves:
        if kind == "feed" and not done and len(what) > 6 and corner(what, len(what) // 2):
            what, done = np.array([what[0], what[-1]]), True
        out.append((kind, what))
    return out if done else None


def gouged(moves):
    """In the middle of the longest feed 20 um aside and back."""
    k = max((k for k, (kind, what) in enumerate(moves) if kind == "feed"), key=lambda k: np.linalg.norm(moves[k][1][-1] - moves[k][1][0]))
    what, j = moves[k][1], len(moves[k][1]) // 2
    way = (what[j] - what[j - 1]) / np.linalg.norm(what[j] - what[j - 1])
    aside = (what[j] + what[j - 1]) / 2 + 0.02 * np.array([-way[1], way[0], 0.0])
    return moves[:k] + [("feed", what[:j]), ("feed", np.array([what[j - 1], aside])), ("feed", np.array([aside, what[j]])), ("feed", what[j:])] + moves[k + 1 :]


def main(vpost):
    t = Trial()
    figures(t)
    for dialect, count in (("linuxcnc", 8), ("fanuc", 8)):
        programs = cases(2, count, dialect)
        wrong = [judge.compare(s, text, led(s, path))[0] for s, text, path in programs]
        t.ask(not any(wrong), "%s: right outputs that pass: %d of %d %s" % (dialect, sum(not x for x in wrong), count, [x for x in wrong if x][:1]))
        rows = [("uncorrected", lambda s, text, path: text)]
        rows.append(("wrong side", lambda s, text, path: other(s, swapped(text))))
        rows.append(("a radius 20 um larger", lambda s, text, path: larger(s, text)))
        rows.append(("an arc of the centre as its chord", lambda s, text, path: led(s, without_corner(path)) if without_corner(path) else None))
        rows.append(("20 um aside, once", lambda s, text, path: led(s, gouged(path))))
        for name, make in rows:
            made = [(s, text, make(s, text, path)) for s, text, path in programs]
            made = [x for x in made if x[2] is not None]
            caught = sum(bool(judge.compare(s, text, out)[0]) for s, text, out in made)
            t.ask(caught == len(made) and (made or "chord" in name), "%s, %s: found %d of %d" % (dialect, name, caught, len(made)))
    return t.status()


def other(spec, text):
    try:
        # LinuxCNC's rules for start-up: this reader of Fanuc's knows none at an outer corner.
        return led(spec, centre.linuxcnc(text.replace("O1200\n", ""), spec["radius"]))
    except (centre.Refused, centre.Unreadable):
        return None


def larger(spec, text):
    more = {**spec, "radius": spec["radius"] + 0.02}
    text = re.sub(r"(G4[12])\.1 D[\d.]+", r"\1 D1", text)
    try:
        return led(spec, centre.path(more, text))
    except (centre.Refused, centre.Unreadable):
        return None


SQUARE = """G21 G17 G90 G40
G0 X-10. Y-12. Z5.
G1 Z-1. F100
%s D1 G1 X0. Y20. F200
G1 X0. Y40.
X50. Y40.
X50. Y0.
X0. Y0.
X0. Y20.
G40 G1 X-10. Y22.
M30
"""


def figures(t):
    """Left of a square that is run clockwise lies outside: the centre's box by hand, both readers."""
    for dialect in ("fanuc", "linuxcnc"):
        spec = {"dialect": dialect, "radius": 5.0}
        text = SQUARE % "G41"
        path = centre.path(spec, text if dialect == "fanuc" else text.replace("M30", "M2"))
        p = np.concatenate([x for kind, x in path if kind == "feed"])
        flat = p[np.abs(p[:, 0] - 55) < 1e-6]
        t.ask(abs(p[:, 0].max() - 55) < 1e-6 and abs(p[:, 1].max() - 45) < 1e-6 and abs(p[p[:, 0] > 1][:, 1].min() + 5) < 1e-6, "%s: five millimetres outside of a square" % dialect)
        sharp = np.linalg.norm(p[:, :2] - [55, 45], axis=1).min()
        t.ask(len(flat) > 2 and (sharp < 1e-6 if dialect == "fanuc" else sharp > 1.9), "%s: outer corner %s" % (dialect, "sharp" if dialect == "fanuc" else "round"))
