"""What a program of this judge's own small language says: motions in the coordinates of the frame in force.

G0 G1 G2 G3 G4 G17 G18 G19 G20 G21 G28 G40 G43 G49 G53 G53.1 G53.6 G54 to G59 G54.1 G68.2 G69 G80 G81 G83 G90 G91 G94 G98 G99.
Unknown words stop it: it is a reader of known programs, not of any.
"""

import math
import re

import numpy as np

import planes

WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


class Unreadable(Exception):
    pass


class Motion:
    """kind: rapid, line, arc; u0, u1: ends in frame coordinates, mm; frame: (zero, turn) of a plane or None; theta, tool."""

    def __init__(self, **words):
        self.__dict__.update(words)

    def length(self):
        if self.kind != "arc":
            return float(np.linalg.norm(self.u1 - self.u0))
        return math.hypot(abs(self.sweep) * max(self.r0, self.r1), self.u1[self.axes[2]] - self.u0[self.axes[2]])

    def at(self, s):
        """Places (n, 3) at shares s (n,)."""
        s = np.asarray(s, float)[:, None]
        if self.kind != "arc":
            return self.u0 + s * (self.u1 - self.u0)
        a, b, c = self.axes
        angle, radius = self.a0 + s[:, 0] * self.sweep, self.r0 + s[:, 0] * (self.r1 - self.r0)
        out = np.zeros((len(s), 3))
        out[:, a] = self.centre[a] + radius * np.cos(angle)
        out[:, b] = self.centre[b] + radius * np.sin(angle)
        out[:, c] = self.u0[c] + s[:, 0] * (self.u1[c] - self.u0[c])
        return out

    def nearest(self, u, guess):
        """Distance (n,) of places u from this motion, and the share s where; `guess`: about where, for arcs of a turn."""
        if self.kind != "arc":
            way = self.u1 - self.u0
            s = np.clip((u - self.u0) @ way / max(way @ way, 1e-18), 0.0, 1.0)
            return np.linalg.norm(u - self.at(s), axis=1), s
        a, b, _ = self.axes
        angle = np.arctan2(u[:, b] - self.centre[b], u[:, a] - self.centre[a])
        s = (angle - self.a0) / self.sweep
        turn = 2 * math.pi / abs(self.sweep)
        s = np.clip(s + turn * np.round((guess - s) / turn), 0.0, 1.0)
        # A helix rises: one step of Newton along it is exact enough where u lies within micrometres.
        for _ in range(2):
            here, beyond = self.at(s), self.at(s + 1e-6)
            way = (beyond - here) / 1e-6
            s = np.clip(s + np.sum((u - here) * way, 1) / np.sum(way * way, 1), 0.0, 1.0)
        return np.linalg.norm(u - self.at(s), axis=1), s


def words_of(line):
    text = re.sub(r"\(.*?\)", "", line).replace(" ", "").strip()
    found = WORD.findall(text)
    if "".join(a + b for a, b in found) != text:
        raise Unreadable(line)
    return [(a, float(b)) for a, b in found]


def read(text, m, start=None):
    """Blocks [(number or None, words, [motions])] of a program on the machine m. `start`: angles at the beginning."""
    spec = m.spec
    spot = np.full(3, np.nan)  # in the frame in force, mm
    theta = dict(start or {k: None for k in m.rotary})
    unit, absolute, arc_plane, modal, feed, offset, tool, hold = 1.0, True, 17, 0, None, "G54", 0.0, 99
    plane, building, cycle, level = None, [], None, None
    blocks = []
    for line in text.splitlines():
        if line.strip() in ("", "%") or re.fullmatch(r"O\d+", line.strip()):
            continue
        words = words_of(line)
        if not words:
            continue
        number = next((int(v) for k, v in words if k == "N"), None)
        codes = [v for k, v in words if k == "G"]
        w = {k: v for k, v in words if k not in "GNM"}
        motions = []
        blocks.append((number, words, motions))
        if 68.2 in codes:
            if plane is not None and not building:
                raise Unreadable("plane in plane")
            building.append(w)
            kind = int(w.get("P", 0))
            if len(building) == {0: 1, 1: 1, 2: 3, 3: 2}[kind]:
                zero, turn = planes.frame(building, unit)
                plane, building = (zero, turn), []
            spot = np.full(3, np.nan)
            continue
        if building:
            raise Unreadable("unfinished plane")
        if 53.1 in codes or 53.6 in codes:
            theta = m.aligned(plane[1][:, 2], theta)
            if theta is None:
                raise Unreadable("G53.1 leaves it open")
            spot = np.full(3, np.nan)
            continue
        if 53 in codes or 28 in codes:
            spot = np.full(3, np.nan)
            if 90 in codes:
                absolute = True
            continue
        move = None
        for g in codes:
            if g in (0, 1, 2, 3):
                modal, move, cycle = int(g), True, None
            elif g in (17, 18, 19):
                arc_plane = int(g)
            elif g in (20, 21):
                unit = 25.4 if g == 20 else 1.0
            elif g in (90, 91):
                absolute = g == 90
            elif g == 43:
                tool = spec["lengths"]["H%d" % w["H"]]
            elif g == 49:
                tool, spot = 0.0, np.full(3, np.nan)
            elif 54 <= g <= 59:
                offset, spot = "G%g" % g + ("P%d" % w["P"] if g == 54.1 else ""), np.full(3, np.nan)
            elif g == 69:
                plane, spot = None, np.full(3, np.nan)
            elif g in (81, 83):
                modal, cycle, level = int(g), {}, None
            elif g == 80:
                modal, cycle = 0, None
            elif g in (98, 99):
                hold = int(g)
            elif g not in (4, 40, 94, 64, 61, 53):
                raise Unreadable("G%g" % g)
        if "F" in w:
            feed = w["F"] * unit
        if 4 in codes:
            continue
        turned = [k for k in m.rotary if k in w]
        if turned:
            before = dict(theta)
            theta = dict(theta)
            for k in turned:
                theta[k] = w[k] if absolute else before[k] + w[k]
            spot = np.full(3, np.nan)
        axes = [k for k in "XYZ" if k in w]
        if not axes:
            continue
        target = spot.copy()
        for k in axes:
            n = "XYZ".index(k)
            target[n] = w[k] * unit + (0.0 if absolute else spot[n])
        where = {"plane": plane, "offset": np.array(spec["offsets"][offset]), "tool": tool, "theta": theta, "feed": feed, "named": axes, "peck": None}

        def go(kind, a, b, **more):
            # A rapid may begin, and its unnamed axes stand, where nobody knows; a feed may not.
            if kind != "rapid" and (np.isnan(a).any() or np.isnan(b).any() or None in theta.values()):
                raise Unreadable("feed from nowhere: " + line)
            motions.append(Motion(**{**where, "kind": kind, "u0": a.copy(), "u1": b.copy(), **more}))

        if cycle is not None:
            if arc_plane != 17:
                raise Unreadable("cycle in G%d" % arc_plane)
            if level is None:
                level = spot[2]
            if "R" in w:
                cycle["R"] = w["R"] * unit + (0.0 if absolute else level)
            if "Z" in w:
                cycle["Z"] = w["Z"] * unit + (0.0 if absolute else cycle["R"])
            over = np.array([target[0], target[1], spot[2]])
            low, bottom = over.copy(), over.copy()
            low[2], bottom[2] = cycle["R"], cycle["Z"]
            up = low if hold == 99 else np.array([over[0], over[1], max(level, cycle["R"])])
            go("rapid", spot, over)
            go("rapid", over, low)
            if "Q" in w:
                cycle["Q"] = w["Q"] * unit
            go("line", low, bottom, peck=cycle.get("Q"), cycle=modal)
            go("rapid", bottom, up)
            spot = up
            continue
        if modal == 0:
            go("rapid", spot, target)
        elif modal == 1:
            go("line", spot, target)
        else:
            a, b, c = PLANES[arc_plane]
            clockwise = modal == 2
            centre = spot.copy()
            if "R" in w:
                radius, chord = w["R"] * unit, np.array([target[a] - spot[a], target[b] - spot[b]])
                half = np.linalg.norm(chord) / 2
                height = math.sqrt(max(abs(radius) ** 2 - half**2, 0.0))
                side = (-1 if clockwise else 1) * (1 if radius > 0 else -1)
                normal = np.array([-chord[1], chord[0]]) / (2 * half)
                centre[[a, b]] = (spot[[a, b]] + target[[a, b]]) / 2 + side * height * normal
            else:
                centre[a] += w.get("IJK"[a], 0.0) * unit
                centre[b] += w.get("IJK"[b], 0.0) * unit
            r0 = math.hypot(spot[a] - centre[a], spot[b] - centre[b])
            r1 = math.hypot(target[a] - centre[a], target[b] - centre[b])
            if not r0 > 0 or not abs(r0 - r1) < 0.02:
                raise Unreadable("no arc: " + line)
            a0 = math.atan2(spot[b] - centre[b], spot[a] - centre[a])
            sweep = math.atan2(target[b] - centre[b], target[a] - centre[a]) - a0
            same = np.array_equal(spot[[a, b]], target[[a, b]])
            sweep = sweep % (2 * math.pi) if not clockwise else -((-sweep) % (2 * math.pi))
            if same or sweep == 0.0:
                sweep = -2 * math.pi if clockwise else 2 * math.pi
            go("arc", spot, target, axes=(a, b, c), centre=centre, r0=r0, r1=r1, a0=a0, sweep=sweep)
        spot = target
    return blocks
