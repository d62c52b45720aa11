"""Reads the plain part of a mill program: G0 to G3, G17 to G19, G20 and G21, G90 and G91, G93 and G94, G43 and G49, F, R, I J K;
and of Fanuc's frames G68 and G69 in G17, and G51.1 and G50.1 of X and Y.

Anything else that could move an axis raises Unreadable: the judge would rather give no verdict than a guessed one.
Motions are in axis commands (machine coordinates, mm). An arc runs about its centre with its radius linear in the angle
where the radii of its ends differ, its third axis linear too.
"""

import math
import re

import numpy as np

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
SILENT = {4, 9, 40, 54, 61, 64, 80, 94, 97, 98, 99, 91.1, 61.1}
OTHERS = set("NSTMFPQOHD")


class Unreadable(Exception):
    """Something that this reader does not understand."""


class Motion:
    """A rapid, a line or an arc between two commands; `start` is None where nobody knows it."""

    def __init__(self, kind, start, end, line, tool, arc=None):
        self.kind, self.line, self.tool, self.arc = kind, line, tool, arc
        self.start = None if start is None else np.array(start, float)
        self.end = np.array(end, float)

    def at(self, t):
        """Commands at the shares t of the way, one row each; axes that stand are exactly constant."""
        t = np.asarray(t, float)
        if self.arc is None:
            return self.start + t[:, None] * (self.end - self.start)
        a = self.arc
        q = np.empty((len(t), 3))
        angle = a["angle"] + a["sweep"] * t
        radius = a["r0"] + (a["r1"] - a["r0"]) * t
        u, v, w = a["axes"]
        q[:, u] = a["centre"][0] + radius * np.cos(angle)
        q[:, v] = a["centre"][1] + radius * np.sin(angle)
        q[:, w] = self.start[w] + t * (self.end[w] - self.start[w])
        q[t >= 1.0] = self.end
        q[t <= 0.0] = self.start
        return q

    def length(self):
        if self.start is None:
            return 0.0
        if self.arc is None:
            return float(np.linalg.norm(self.end - self.start))
        a = self.arc
        w = a["axes"][2]
        return math.hypot(0.5 * (a["r0"] + a["r1"]) * a["sweep"], self.end[w] - self.start[w])


def arc_of(start, end, plane, clockwise, words, scale, line):
    """Centre, radii, angle and sweep as a control makes them of the words."""
    u, v, w = PLANES[plane]
    su, sv, eu, ev = start[u], start[v], end[u], end[v]
    if "R" in words:
        r = words["R"] * scale
        du, dv = eu - su, ev - sv
        chord = math.hypot(du, dv)
        if chord == 0:
            raise Unreadable(f"line {line}: a full circle by R")
        rise = math.sqrt(max(r * r - chord * chord / 4, 0.0))
        # Left of the chord for a short turn against the clock; each change of that swaps the side.
        side = -1.0 if clockwise != (r < 0) else 1.0
        cu = (su + eu) / 2 - side * rise * dv / chord
        cv = (sv + ev) / 2 + side * rise * du / chord
    else:
        names = "IJK"
        if names[u] not in words and names[v] not in words:
            raise Unreadable(f"line {line}: an arc without a centre")
        cu, cv = su + words.get(names[u], 0.0) * scale, sv + words.get(names[v], 0.0) * scale
    a0, a1 = math.atan2(sv - cv, su - cu), math.atan2(ev - cv, eu - cu)
    turn = 2 * math.pi
    if abs(eu - su) < 1e-9 and abs(ev - sv) < 1e-9:
        sweep = turn
    else:
        # Towards the same direction, be it with another radius, a control makes a whole turn (LinuxCNC: CIRCLE_FUZZ).
        sweep = ((a0 - a1) if clockwise else (a1 - a0)) % turn
        sweep = sweep if 1e-6 < sweep else turn
    if clockwise:
        sweep = -sweep
    return {"axes": (u, v, w), "centre": (cu, cv), "r0": math.hypot(su - cu, sv - cv), "r1": math.hypot(eu - cu, ev - cv),
            "angle": a0, "sweep": sweep}


def read(text, spec, start=None):
    """Motions of a program for a machine (its work offset and tool lengths); `start`: where the axes stand before it."""
    offset = np.array(spec["offset"], float)
    here = None if start is None else [float(v) for v in start]
    named = [start is not None] * 3
    mode, plane, absolute, scale, tool = None, 17, True, 1.0, None
    frame = Frame()
    motions = []
    for number, raw in enumerate(text.splitlines(), 1):
        code = re.sub(r"\([^)]*\)", " ", raw).split(";")[0].upper().replace(" ", "").replace("\t", "")
        if not code or code == "%" or code[0] == "O":
            continue
        pairs = WORD.findall(code)
        if "".join(a + b for a, b in pairs) != code:
            raise Unreadable(f"line {number}: {raw.strip()}")
        words, length_changes, framing = {}, None, None
        for letter, value in pairs:
            value = float(value)
            if letter == "G":
                if value in (0, 1, 2, 3):
                    mode = int(value)
                elif value in PLANES:
                    plane = int(value)
                elif value in (20, 21):
                    scale = 25.4 if value == 20 else 1.0
                elif value in (90, 91):
                    absolute = value == 90
                elif value in (43, 49):
                    length_changes = int(value)
                elif value in (68, 69, 51.1, 50.1):
                    framing = value
                elif value not in SILENT and value != 93:
                    raise Unreadable(f"line {number}: G{value:g}")
            elif letter in "XYZIJKR" or letter in OTHERS:
                words[letter] = value
            else:
                raise Unreadable(f"line {number}: {letter}")
        if length_changes == 43:
            tool = f"H{int(words['H'])}"
        elif length_changes == 49:
            tool = None
        if framing is not None:
            about = {i: words[c] * scale for i, c in enumerate("XY") if c in words}
            if plane != 17 or not absolute or "Z" in words or framing == 68 and (len(about) < 2 or "R" not in words):
                raise Unreadable(f"line {number}: a frame that this reader does not know")
            if framing in (68, 51.1) and not frame.plain():
                raise Unreadable(f"line {number}: two frames at once")
            frame = Frame()
            if framing == 68:
                frame.turn((about[0], about[1]), words["R"])
            elif framing == 51.1:
                frame.mirror(about)
            continue
        if not frame.plain() and (plane != 17 or not absolute):
            raise Unreadable(f"line {number}: a motion in a frame that this reader does not know")
        if not any(c in words for c in "XYZ") and not (mode in (2, 3) and any(c in words for c in "IJK")):
            continue
        shift = np.array(offset)
        if tool is not None:
            shift[2] += spec["lengths"][tool]
        before = None if here is None or not all(named) else list(here)
        here = here if here is not None else [0.0] * 3
        end = list(here)
        if not frame.plain():
            if not all(named):
                raise Unreadable(f"line {number}: a frame around an unknown place")
            inner = frame.inwards(np.array(here) - shift)
            inside = [words[c] * scale if c in words else inner[i] for i, c in enumerate("XYZ")]
            end = [float(v) for v in frame.outwards(inside) + shift]
        for i, c in enumerate("XYZ"):
            if c in words and frame.plain():
                if not absolute and not named[i]:
                    raise Unreadable(f"line {number}: an increment from nowhere")
                end[i] = words[c] * scale + (shift[i] if absolute else here[i])
                named[i] = True
        here = end
        if mode == 0:
            motions.append(Motion("rapid", before, end, number, tool))
        elif before is None:
            raise Unreadable(f"line {number}: a feed from an unknown place")
        elif mode == 1:
            motions.append(Motion("line", before, end, number, tool))
        elif mode in (2, 3) and not frame.plain():
            arc = frame.arc(arc_of(inner, inside, plane, mode == 2, words, scale, number), shift)
            motions.append(Motion("arc", before, end, number, tool, arc))
        elif mode in (2, 3):
            arc = arc_of(before, end, plane, mode == 2, words, scale, number)
            motions.append(Motion("arc", before, end, number, tool, arc))
        else:
            raise Unreadable(f"line {number}: a motion without a code")
    return motions


class Frame:
    """What stands between the words and the work offset: a turn or a mirror in X and Y, in mm of the work frame."""

    def __init__(self):
        self.matrix, self.shift = np.eye(3), np.zeros(3)

    def turn(self, about, degrees):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        self.matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        self.shift = np.array([*about, 0.0]) - self.matrix @ np.array([*about, 0.0])

    def mirror(self, about):
        """About the values given by axis, X and Y."""
        for i, value in about.items():
            self.matrix[i, i], self.shift[i] = -1.0, 2.0 * value

    def plain(self):
        return np.array_equal(self.matrix, np.eye(3))

    def inwards(self, place):
        """The place in the program's frame, of one in the work frame."""
        return self.matrix.T @ (np.asarray(place, float) - self.shift)

    def outwards(self, place):
        return self.matrix @ np.asarray(place, float) + self.shift

    def arc(self, arc, offset):
        """An arc of the program's frame as axes run it."""
        angle = np.array([math.cos(arc["angle"]), math.sin(arc["angle"]), 0.0])
        turned = self.matrix @ angle
        centre = self.outwards([*arc["centre"], 0.0])[:2] + np.asarray(offset, float)[:2]
        return {**arc, "centre": (float(centre[0]), float(centre[1])), "angle": math.atan2(turned[1], turned[0]),
                "sweep": arc["sweep"] * float(np.sign(np.linalg.det(self.matrix)))}


def runs(motions):
    """Stretches of rapids and of feed motions in turn, as ('rapid' | 'feed', motions)."""
    out = []
    for m in motions:
        kind = "rapid" if m.kind == "rapid" else "feed"
        if not out or out[-1][0] != kind:
            out.append((kind, []))
        out[-1][1].append(m)
    return out
