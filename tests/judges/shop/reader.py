"""Reads the programs of `program.py`, and what may be written in their place: motions in axis commands.

Knows G0 to G3 (centres, radii, helices, three planes), G81 and G82 as moves, G10 L2, G20, G21, G43, G43.4, G49, G54 to
G59, G80, G90, G91, G94, G98, G99 and words without motion; anything else is `Unreadable`.
"""

import math
import re

import numpy as np

SAG = 2e-5  # of arcs between samples, mm
PASSED = {4, 17, 18, 19, 40, 61, 61.1, 64, 90.1, 91.1, 94}
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


class Unreadable(Exception):
    pass


class Move:
    """`points`: axis commands, or tip commands under tip control; `angles`: of each rotary axis at each point."""

    def __init__(self, feed, points, angles, state):
        self.feed, self.points, self.angles = feed, points, angles
        self.offset, self.tool, self.tip_control, self.hole = state.offset, list(state.tool), state.tip_control, False


class Reader:
    def __init__(self, case):
        self.case = case
        self.zeros = {name: np.array(d.at) for name, d in case.datums.items() if d.plain != "program"}
        self.at, self.angles = np.full(3, np.nan), {k: 0.0 for k in case.spec["rotary"]}
        self.offset, self.tool, self.tip_control = "G54", [0.0, 0.0, 0.0], False
        self.unit, self.relative, self.plane, self.motion, self.cycle, self.to_initial = 1.0, False, 17, 0, {}, True
        self.moves = []

    def shift(self):
        return self.zeros.get(self.offset, np.full(3, np.nan)) - self.tool

    def read(self, text):
        for line in text.splitlines():
            line = re.sub(r"\(.*?\)|;.*", "", line).strip().upper()
            if line and not re.match(r"[%/O:]", line):
                try:
                    self.block([(k, float(v)) for k, v in re.findall(r"([A-Z])\s*([-+]?\d*\.?\d+\.?)", line)])
                except (ValueError, KeyError) as why:
                    raise Unreadable("%s: %s" % (line, why)) from why
        return self.moves

    def block(self, found):
        codes = [round(v, 1) for k, v in found if k == "G"]
        word = {k: v for k, v in found if k not in "GNM"}
        if len(word) + len(codes) + sum(k in "NM" for k, _ in found) < len(found):
            raise Unreadable("a letter twice: %s" % found)
        moved = {k: word[k] for k in "XYZ" if k in word}
        for g in codes:
            if g in (0, 1, 2, 3, 81, 82):
                self.motion = int(g)
                self.cycle = {} if g < 80 else self.cycle
            elif g in (20, 21):
                self.unit = 25.4 if g == 20 else 1.0
            elif g in (90, 91):
                self.relative = g == 91
            elif g in (98, 99):
                self.to_initial = g == 98
            elif g in PLANES:
                self.plane = int(g)
            elif g in (43, 43.4, 49):
                self.tool = [0.0, 0.0, -self.case.spec["lengths"]["H%d" % word["H"]]] if g != 49 else [0.0, 0.0, 0.0]
                self.at[2] = np.nan if not self.tip_control and g != 43.4 else self.at[2]
                self.at = np.full(3, np.nan) if self.tip_control or g == 43.4 else self.at
                self.tip_control = g == 43.4
            elif 54 <= g <= 59:
                self.offset = "G%d" % g
            elif g == 80:
                self.motion, self.cycle = 0, {}
            elif g == 10:
                if word.get("L") != 2 or self.relative:
                    raise Unreadable("G10")
                self.zeros["G%d" % (53 + word["P"])] = np.array([word[k] * self.unit for k in "XYZ"])
                return
            elif g not in PASSED:
                raise Unreadable("G%s" % g)
        turned = {k: v for k, v in word.items() if k in self.case.spec["rotary"]}
        if self.motion > 80 and (moved or any(g in (81, 82) for g in codes)):
            self.hole(word)
        elif moved or turned or (self.motion in (2, 3) and set("IJK") & set(word)):
            self.go(moved, turned, word)

    def end(self, moved):
        """Axis commands at the end of a block."""
        end = self.at.copy()
        for k, v in moved.items():
            n = "XYZ".index(k)
            end[n] = self.at[n] + v * self.unit if self.relative else v * self.unit + self.shift()[n]
        return end

    def way(self, end, turn=0.0):
        """Even steps to the end; an axis that stood nobody knows where stands there at once."""
        start = np.where(np.isnan(self.at), end, self.at)
        count = 2 + int(np.linalg.norm(np.nan_to_num(end - start)) / 0.8) + int(turn / 0.06)
        return start + np.linspace(0, 1, count)[:, None] * (end - start)

    def add(self, feed, points, turned):
        s = np.linspace(0, 1, len(points))
        angles = {k: self.angles[k] + s * (turned.get(k, self.angles[k]) - self.angles[k]) for k in self.angles}
        if feed and (np.isnan(points).any() or np.isnan(self.at).any()):
            raise Unreadable("a feed from where nobody knows")
        self.moves.append(Move(feed, points, angles, self))
        self.at, self.angles = points[-1].copy(), {k: float(v[-1]) for k, v in angles.items()}

    def go(self, moved, turned, word):
        end = self.end(moved)
        if self.relative and turned:
            raise Unreadable("a turn by an increment")
        if self.motion in (2, 3):
            self.add(True, self.arc(end, word), turned)
            return
        turn = max([abs(v - self.angles[k]) for k, v in turned.items()], default=0.0)
        self.add(self.motion == 1, self.way(end, turn), turned)

    def arc(self, end, word):
        a, b, c = PLANES[self.plane]
        start, sign = self.at, 1.0 if self.motion == 3 else -1.0
        if "R" in word:
            chord, r = end[[a, b]] - start[[a, b]], word["R"] * self.unit
            half = np.linalg.norm(chord) / 2
            height = math.sqrt(max(r * r - half * half, 0.0)) * (sign if r > 0 else -sign)
            centre = start[[a, b]] + chord / 2 + height * np.array([-chord[1], chord[0]]) / (2 * half)
        else:
            centre = start[[a, b]] + self.unit * np.array([word.get("IJK"[a], 0.0), word.get("IJK"[b], 0.0)])
        u, v = start[[a, b]] - centre, end[[a, b]] - centre
        first = math.atan2(u[1], u[0])
        sweep = (sign * (math.atan2(v[1], v[0]) - first)) % (2 * math.pi)
        if sweep < 1e-9 or (sweep < 1e-3 and not {"XYZ"[a], "XYZ"[b]} & set(word)):
            sweep += 2 * math.pi
        radii = np.linalg.norm(u), np.linalg.norm(v)
        s = np.linspace(0, 1, 2 + int(sweep / math.sqrt(8 * SAG / max(radii))))
        radius, angle = radii[0] + s * (radii[1] - radii[0]), first + sign * s * sweep
        points = np.empty((len(s), 3))
        points[:, a], points[:, b] = centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)
        points[:, c] = start[c] + s * (end[c] - start[c])
        return points

    def hole(self, word):
        """A drilled hole as its moves: over it, to R, down by a feed, up again."""
        if self.relative:
            raise Unreadable("a cycle by increments")
        self.cycle.setdefault("initial", self.at[2])
        for k in ("Z", "R"):
            if k in word:
                self.cycle[k] = word[k] * self.unit + self.shift()[2]
        over = self.end({k: word[k] for k in "XY" if k in word})
        over[2] = max(self.at[2], self.cycle["R"])
        up = max(self.cycle["initial"], self.cycle["R"]) if self.to_initial else self.cycle["R"]
        for feed, z in ((False, over[2]), (False, self.cycle["R"]), (True, self.cycle["Z"]), (False, up)):
            self.add(feed, self.way(np.array([over[0], over[1], z])), {})
            self.moves[-1].hole = True


def stretches(moves):
    """Runs of feeds between rapids."""
    out, before = [], None
    for m in moves:
        if m.feed:
            out.append([m]) if before is None or not before.feed else out[-1].append(m)
        before = m
    return out
