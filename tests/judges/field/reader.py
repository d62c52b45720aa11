"""Motions of a small part of LinuxCNC's and Fanuc's language, read by this judge's own rules (NIST RS274, LinuxCNC's manual).

G0 G1 G2 G3, G17 G18 G19, G90 G91, I J K as distances from the start, R, G43 H, G54, F; anything else that could move is an error.
Axis command = word + work offset + tool length. An arc's radius runs straight with its angle where the two radii differ.
"""

import math
import re

import numpy as np

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
QUIET = {4, 20, 21, 40, 49, 54, 61, 64, 80, 90, 91, 94, 17, 18, 19, 43, 61.1, 90.1, 91.1, 97, 0, 1, 2, 3, 53, 28}


class Unreadable(Exception):
    pass


class Motion:
    """`at(s)`, 0 <= s <= 1: axis commands (n, 3), mm."""

    def __init__(self, line, kind, start, end, arc=None):
        self.line, self.kind, self.start, self.end, self.arc = line, kind, start, end, arc

    def at(self, s):
        s = np.asarray(s, float)[:, None]
        if self.arc is None:
            return self.start + s * (self.end - self.start)
        (u, v, w), centre, r0, r1, a0, sweep = self.arc
        out = np.zeros((len(s), 3))
        a, r = a0 + sweep * s[:, 0], r0 + (r1 - r0) * s[:, 0]
        out[:, u], out[:, v] = centre[0] + r * np.cos(a), centre[1] + r * np.sin(a)
        out[:, w] = self.start[w] + s[:, 0] * (self.end[w] - self.start[w])
        return out

    def length(self):
        if self.arc is None:
            return float(np.linalg.norm(self.end - self.start))
        return float(math.hypot(abs(self.arc[5]) * max(self.arc[2], self.arc[3]), self.end[self.arc[0][2]] - self.start[self.arc[0][2]]))


def arc(plane, sense, start, end, words, line):
    u, v, w = PLANES[plane]
    a, b = np.array([start[u], start[v]]), np.array([end[u], end[v]])
    if "R" in words:
        chord, radius = b - a, words["R"]
        d = np.linalg.norm(chord)
        if d == 0 or d > 2 * abs(radius) + 2e-3:
            raise Unreadable(f"line {line}: R {radius} over a chord of {d}")
        h = math.sqrt(max(radius**2 - d * d / 4, 0))
        side = np.array([-chord[1], chord[0]]) / d
        centre = (a + b) / 2 + side * h * (1 if (sense == 3) == (radius > 0) else -1)
    else:
        i, j = ("XYZ"[u], "XYZ"[v])
        names = {"X": "I", "Y": "J", "Z": "K"}
        if names[i] not in words and names[j] not in words:
            raise Unreadable(f"line {line}: an arc without a centre")
        centre = a + np.array([words.get(names[i], 0.0), words.get(names[j], 0.0)])
    p, q = a - centre, b - centre
    r0, r1 = np.linalg.norm(p), np.linalg.norm(q)
    a0, a1 = math.atan2(p[1], p[0]), math.atan2(q[1], q[0])
    sweep = a1 - a0
    if np.linalg.norm(a - b) < 1e-9:
        sweep = 2 * math.pi if sense == 3 else -2 * math.pi
    elif sense == 3:
        while sweep <= 1e-12:
            sweep += 2 * math.pi
    else:
        while sweep >= -1e-12:
            sweep -= 2 * math.pi
    return (u, v, w), centre, r0, r1, a0, sweep


def read(text, offset, lengths):
    """Motions of a program; axes stand nowhere until they are named, rapids say where."""
    at, out = np.full(3, np.nan), []
    plane, mode, absolute, length = 17, None, True, 0.0
    for number, raw in enumerate(text.splitlines(), 1):
        line = re.sub(r"\([^)]*\)|;.*", "", raw).strip().upper()
        if not line or line.startswith("%") or re.fullmatch(r"O\d+", line):
            continue
        words, codes = {}, []
        rest = re.sub(r"\s+", "", line)
        for letter, value in re.findall(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))", rest):
            if letter == "G":
                codes.append(float(value))
            elif letter in words and letter != "M":
                raise Unreadable(f"line {number}: two {letter}")
            else:
                words[letter] = float(value)
        left = re.sub(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))", "", rest)
        if left or set(words) - set("XYZIJKRFSTMNHDOP"):
            raise Unreadable(f"line {number}: {raw}")
        for g in codes:
            if g not in QUIET:
                raise Unreadable(f"line {number}: G{g:g}")
            plane = int(g) if g in PLANES else plane
            mode = int(g) if g in (0, 1, 2, 3) else mode
            absolute = {90: True, 91: False}.get(g, absolute)
            length = 0.0 if g == 49 else lengths[f"H{int(words['H'])}"] if g == 43 else length
        if not set(words) & set("XYZIJKR") or 4 in codes:
            continue
        if mode is None:
            raise Unreadable(f"line {number}: no motion in force")
        end, base = at.copy(), np.array(offset, float) + [0, 0, length]
        for i, letter in enumerate("XYZ"):
            if letter in words:
                end[i] = words[letter] + base[i] if absolute else at[i] + words[letter]
        if mode == 0:
            out.append(Motion(number, "rapid", at, end))
        elif np.isnan(at).any():
            raise Unreadable(f"line {number}: feed from a place that nobody named")
        elif mode == 1:
            out.append(Motion(number, "feed", at, end))
        else:
            out.append(Motion(number, "feed", at, end, arc(plane, mode, at, end, words, number)))
        at = end
    return out
