"""Where the tool's centre goes: by LinuxCNC's interpreter, and for Fanuc by the rules its manual is certain of.

Fanuc (B-64484EN, "Details of cutter or tool nose radius compensation"): inner corners at the intersection of both offset
ways; outer corners of 90 degrees and more too, sharper ones with both ways made longer by the radius; start-up and
cancel towards an inner corner square to the contour, under type A as under type B. Other corners are not written here.
"""

import math
import re

import numpy as np

from common.interpreter import interpret, parameters


class Unreadable(Exception):
    pass


class Refused(Exception):
    """By LinuxCNC's interpreter."""


def arc_points(start, end, centre, left, z0, z1):
    a, b = start - centre, end - centre
    t0 = math.atan2(a[1], a[0])
    sweep = math.atan2(b[1], b[0]) - t0
    sweep = sweep % (2 * math.pi) if left else -((-sweep) % (2 * math.pi))
    # Ends that all but meet: no turn, not a whole one.
    if abs(abs(sweep) - 2 * math.pi) < 1e-5 and np.linalg.norm(end - start) > 0:
        sweep = 0.0
    r0, r1 = np.linalg.norm(a), np.linalg.norm(b)
    n = 2 + int(abs(sweep) / math.sqrt(8 * 5e-5 / max(r0, 0.01)))
    s = np.linspace(0, 1, n)
    radius, angle = r0 + s * (r1 - r0), t0 + s * sweep
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), z0 + s * (z1 - z0)], axis=1)


def straight(a, b):
    n = 2 + int(np.linalg.norm(b - a) / 1.5)
    return a + np.linspace(0, 1, n)[:, None] * (b - a)


# -- LinuxCNC -----------------------------------------------------------------------------------------------------------


def plain(text, radius):
    """The program without what needs tables: the radius in the block, lengths and tools gone."""
    out = []
    for line in text.splitlines():
        line = re.sub(r"\(.*?\)|;.*", "", line)
        line = re.sub(r"\b(G4[12])\s*D1\b", lambda m: "%s.1 D%.6f" % (m.group(1), 2 * radius), line)
        line = re.sub(r"G43\s*H1|G49|T1|M6|S\d+|M3\b|M30?\b(?=\s*$)|G54", lambda m: "M2" if m.group(0) == "M30" else " ", line)
        out.append(line)
    return "\n".join(out) + "\n"


def linuxcnc(text, radius):
    """[("rapid", end) or ("feed", points)] of the tool's centre in the program's coordinates."""
    said = interpret(plain(text, radius), "T1 P1 Z0 D0\n", parameters({}))
    if not said.whole:
        raise Refused(said.trouble(200))
    out, at = [], np.zeros(3)
    for line in said.calls.splitlines():
        found = re.search(r"\b(STRAIGHT_TRAVERSE|STRAIGHT_FEED|ARC_FEED)\((.*)\)", line)
        if not found:
            continue
        v = [float(x) for x in found.group(2).split(",")]
        if found.group(1) == "ARC_FEED":
            end = np.array([v[0], v[1], v[5]])
            points = arc_points(at[:2], end[:2], np.array(v[2:4]), v[4] > 0, at[2], end[2])
        else:
            end = np.array(v[:3])
            points = straight(at, end)
        out.append(("rapid", end) if found.group(1) == "STRAIGHT_TRAVERSE" else ("feed", points))
        at = end
    return out


# -- Fanuc --------------------------------------------------------------------------------------------------------------


class Element:
    """A block in the plane: ends, arc, and the directions in which it begins and ends."""

    def __init__(self, start, end, centre=None, left=True):
        self.start, self.end, self.centre, self.left = start, end, centre, left
        if centre is None:
            d = (end - start)[:2]
            self.begins = self.ends = d / max(np.linalg.norm(d), 1e-12)
        else:
            turn = 1.0 if left else -1.0
            self.begins, self.ends = (turn * np.array([-(p - centre)[1], (p - centre)[0]]) / np.linalg.norm(p - centre) for p in (start[:2], end[:2]))


def joint(a, b, r, side):
    """Places of the centre between two blocks: where the first ends, what lies between, where the second begins."""
    corner = a.end[:2]
    n1, n2 = (side * np.array([-t[1], t[0]]) for t in (a.ends, b.begins))
    turn = math.atan2(a.ends[0] * b.begins[1] - a.ends[1] * b.begins[0], a.ends @ b.begins)
    outer = side * turn < 0
    if outer and abs(turn) > math.pi / 2:
        return [corner + r * n1 + r * a.ends, corner + r * n2 - r * b.begins]
    if (a.centre is not None or b.centre is not None) and abs(turn) > 3e-3:
        raise Unreadable("a corner beside an arc")
    # Intersection of the offset lines; beside an arc the angle is that of rounded words.
    return [corner + r * (n1 + n2) / (1 + n1 @ n2)]


def offset(elements, r, side, depth):
    """Points of the centre along blocks from start-up to cancel, both included."""
    first, last = elements[1], elements[-2]
    normal = lambda t: side * np.array([-t[1], t[0]])
    at = [elements[0].start[:2], first.start[:2] + r * normal(first.begins)]
    for t, end in ((elements[0].begins, first.begins), (last.ends, elements[-1].begins)):
        if side * (t[0] * end[1] - t[1] * end[0]) < -1e-3:
            raise Unreadable("start-up or cancel at an outer corner")
    out = [straight(np.append(at[0], elements[0].start[2]), np.append(at[1], elements[0].end[2]))]
    here = at[1]
    for a, b in zip(elements[1:-1], elements[2:]):
        leaving = b is elements[-1]
        places = [a.end[:2] + r * normal(a.ends)] if leaving else joint(a, b, r, side)
        out.append(piece(a, here, places[0]))
        for p, q in zip(places, places[1:]):
            out.append(straight(np.append(p, a.end[2]), np.append(q, a.end[2])))
        here = places[-1]
    out.append(straight(np.append(here, elements[-1].start[2]), elements[-1].end))
    return out


def piece(a, start, end):
    if a.centre is None:
        if (end - start) @ a.begins < -1e-9:
            raise Unreadable("interference")
        return straight(np.append(start, a.start[2]), np.append(end, a.end[2]))
    return arc_points(start, end, a.centre, a.left, a.start[2], a.end[2])


def fanuc(text, radius):
    at, mode, side, known = np.full(3, np.nan), 0, 0, []
    out, pending = [], []
    for line in text.splitlines():
        line = re.sub(r"\(.*?\)", "", line).strip()
        if not line or line[0] in "%O":
            continue
        words = re.findall(r"([A-Z])\s*(-?(?:\d+\.?\d*|\.\d+))", line)
        if "".join(a + b for a, b in words) != line.replace(" ", ""):
            raise Unreadable(line)
        w = {k: float(v) for k, v in words if k not in "GNM"}
        codes = [float(v) for k, v in words if k == "G"]
        was = side
        for g in codes:
            if g in (0, 1, 2, 3):
                mode = int(g)
            elif g in (40, 41, 42):
                side = {40: 0, 41: 1, 42: -1}[int(g)]
            elif g not in (17, 21, 43, 49, 54, 90, 94, 80, 4):
                raise Unreadable("G%g" % g)
        if not set(w) & set("XYZ"):
            continue
        end = np.array([w.get(k, at[n]) for n, k in enumerate("XYZ")])
        if mode == 0:
            if pending:
                raise Unreadable("a rapid under compensation")
            out.append(("rapid", end))
        else:
            centre, left = None, mode == 3
            if mode in (2, 3):
                if "R" in w:
                    chord = (end - at)[:2]
                    half = np.linalg.norm(chord) / 2
                    height = math.sqrt(max(w["R"] ** 2 - half**2, 0.0)) * (1 if left else -1) * (1 if w["R"] > 0 else -1)
                    centre = (at + end)[:2] / 2 + height * np.array([-chord[1], chord[0]]) / (2 * half)
                else:
                    centre = at[:2] + [w.get("I", 0.0), w.get("J", 0.0)]
            one = Element(at, end, centre, left)
            if side or was:
                if side and was and side != was:
                    raise Unreadable("the side changes")
                pending.append(one)
                if was and not side:
                    out += [("feed", p) for p in offset(pending, radius, was, None)]
                    pending = []
            elif centre is None:
                out.append(("feed", straight(at, end)))
            else:
                out.append(("feed", arc_points(at[:2], end[:2], centre, left, at[2], end[2])))
        at = end
    if pending:
        raise Unreadable("compensation to the end")
    return out


def path(spec, text):
    return (linuxcnc if spec["dialect"] == "linuxcnc" else fanuc)(text, spec["radius"])
