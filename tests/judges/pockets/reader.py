"""Moves of an output: words of systems A, B and C in radius and Z, with the number of the block they stand under."""

import math
import re

import numpy as np

from generate import NAMES

CYCLES = {"G70", "G71", "G72", "G73", "G74", "G75", "G76", "G83", "G84", "G87", "G90", "G92", "G94"}
PASSED = {"G21", "G40", "G99", "G98", "G97", "G96", "G4", "G18", "G80", "G54"}


class Unreadable(Exception):
    pass


class Kept(Exception):
    """A cycle that stayed a cycle."""


class Move:
    def __init__(self, kind, start, end, number, feed, centre=None, radius=None, clockwise=False):
        self.kind, self.start, self.end, self.number, self.feed = kind, start, end, number, feed
        self.centre, self.radius, self.clockwise = centre, radius, clockwise

    def points(self):
        """Words (n, 2) along the move."""
        if self.centre is not None:
            a, b = self.start - self.centre, self.end - self.centre
            t0, t1 = math.atan2(a[0], a[1]), math.atan2(b[0], b[1])
            sweep = -((t0 - t1) % (2 * math.pi)) if self.clockwise else (t1 - t0) % (2 * math.pi)
            r0, r1 = np.linalg.norm(a), np.linalg.norm(b)
            n = 2 + int(abs(sweep) / math.sqrt(8 * 2e-5 / max(r0, 0.01)))
            s = np.linspace(0, 1, n)
            radius, angle = r0 + s * (r1 - r0), t0 + s * sweep
            return self.centre + np.stack([radius * np.sin(angle), radius * np.cos(angle)], axis=1)
        n = 2 + int(np.linalg.norm(self.end - self.start) / 0.4)
        return self.start + np.linspace(0, 1, n)[:, None] * (self.end - self.start)


def read(text, system):
    """[Move] and the process words [(number, text)]."""
    # A name of the system to that of A; what has no other name stays.
    back = {v: k for k, v in NAMES[system].items()}
    at, mode, feed, number, absolute = np.array([np.nan, np.nan]), "G0", None, None, True
    moves, process = [], []
    for line in text.splitlines():
        line = re.sub(r"\(.*?\)", "", line).strip()
        if not line or line[0] in "%O":
            continue
        words = re.findall(r"([A-Z])(-?\d+\.?\d*|-?\.\d+)", line)
        if "".join(a + b for a, b in words) != line.replace(" ", ""):
            raise Unreadable(line)
        codes = [back.get(c, c) for c in ("G" + v.lstrip("0") if v.strip("0") else "G0" for k, v in words if k == "G")]
        w = {k: v for k, v in words if k not in "GN"}
        number = next((int(v) for k, v in words if k == "N"), number)
        kept = sorted(set(codes) & (CYCLES - {"G92", "G94", "G90"} if system != "A" else CYCLES))
        if kept:
            raise Kept("%s in N%s" % (kept[0], number))
        thread = "G32" in codes or (system != "A" and "G33" in codes)
        for c in codes:
            if c in ("G0", "G1", "G2", "G3"):
                mode = c
            elif c in ("G32", "G33"):
                mode = "G32"
            elif c == "G91":
                absolute = False
            elif c == "G90":
                absolute = True
            elif c not in PASSED and c not in ("G50", "G90"):
                raise Unreadable(line)
        if "F" in w:
            feed = float(w["F"])
        if "G50" in codes or "G4" in codes or "T" in w or "M" in w or "S" in w:
            process.append((number, " ".join(k + v for k, v in words if k != "N")))
            if "G50" in codes or "G4" in codes:
                continue
            if "T" in w:
                at = np.array([np.nan, np.nan])
        end = at.copy()
        # Increments: U W of system A, all words under G91 of the others.
        for letter, axis, share in (("X", 0, 0.5), ("Z", 1, 1.0)):
            if letter in w:
                end[axis] = share * length(w[letter]) + (0.0 if absolute else at[axis])
        for letter, axis, share in (("U", 0, 0.5), ("W", 1, 1.0)):
            if letter in w:
                end[axis] = at[axis] + share * length(w[letter])
        if not set(w) & set("XZUW"):
            continue
        if mode != "G0" and np.isnan(at).any():
            raise Unreadable("feed from nowhere: " + line)
        kind = {"G0": "rapid", "G32": "thread"}.get(mode, "feed")
        centre = None
        if mode in ("G2", "G3"):
            centre = at.copy()
            if "R" in w:
                radius, chord = abs(length(w["R"])), end - at
                half = np.linalg.norm(chord) / 2
                # In (Z, X) the left of the way is where a counterclockwise arc has its centre.
                left = np.array([chord[1], -chord[0]]) / (2 * half)
                side = 1.0 if mode == "G3" else -1.0
                centre = (at + end) / 2 + side * math.sqrt(max(radius**2 - half**2, 0.0)) * left
            else:
                centre += [length(w.get("I", "0.")), length(w.get("K", "0."))]
        moves.append(Move(kind, at.copy(), end, number, feed, centre, None, mode == "G2"))
        at = end
    return moves, process


def length(text):
    """A length: in increments of a micrometre where it has no point."""
    return float(text) if "." in text else float(text) / 1000
