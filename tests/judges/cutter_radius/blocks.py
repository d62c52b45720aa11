"""Blocks of a mill's program: numbers, words, places, planes, and what compensation is in force."""

import math
import re

import numpy as np

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}  # first axis, second axis, and the one square to both
PASSED = {4, 43, 49, 53, 54, 64, 61, 61.1, 80, 94, 71, 60, 601, 642, 450, 451}
NOTHING = 1e-7


class Unreadable(Exception):
    pass


class Block:
    """`words`: letters of X Y Z as written; `start`, `end`: program coordinates, mm, NaN where nobody knows."""

    def __init__(self, line, number, words):
        self.line, self.number, self.words = line, number, words
        self.start = self.end = self.centre = None
        self.motion, self.plane, self.side = None, 17, 0

    @property
    def across(self):
        return [np.array(x)[list(PLANES[self.plane][:2])] for x in (self.start, self.end)]

    @property
    def in_plane(self):
        """It moves in the plane of compensation."""
        if self.motion is None:
            return False
        a, b = self.across
        return self.centre is not None or not np.abs(b - a).max() <= NOTHING


def read(text):
    out, at, motion, plane, side, unit, relative = [], np.full(3, np.nan), 0, 17, 0, 1.0, False
    for line in text.splitlines():
        code = re.sub(r"\(.*?\)|;.*", "", line).strip().upper()
        if not code or re.match(r"[%O:]", code):
            continue
        code = re.sub(r"\bCR=", "R", code)
        found = [(k, float(v)) for k, v in re.findall(r"([A-Z])\s*([-+]?\d*\.?\d+\.?)", code)]
        if re.sub(r"[A-Z]\s*[-+]?\d*\.?\d+\.?|\s|/", "", code):
            raise Unreadable(line)
        word = dict(x for x in found if x[0] not in "GM")
        block = Block(line, word.get("N"), {k for k in "XYZ" if k in word})
        for g in (round(v, 1) for k, v in found if k == "G"):
            if g in (0, 1, 2, 3):
                motion = int(g)
            elif g in PLANES:
                plane = int(g)
            elif g in (40, 41, 42, 41.1, 42.1):
                side = {40: 0, 41: 1, 42: -1}[int(g)]
            elif g in (20, 21, 70):
                unit = 1.0 if g == 21 else 25.4
            elif g in (90, 91):
                relative = g == 91
            elif g not in PASSED:
                raise Unreadable(line)
        block.plane, block.side = plane, side
        if block.words or (motion in (2, 3) and set("IJK") & set(word)):
            end = at.copy()
            for k in block.words:
                n = "XYZ".index(k)
                end[n] = word[k] * unit + (at[n] if relative else 0.0)
            block.start, block.end, block.motion = np.where(np.isnan(at), end, at), end, motion
            if motion in (2, 3):
                block.centre = centre(block, word, unit)
            at = end
        out.append(block)
    return out


def centre(block, word, unit):
    """Of an arc, in its plane."""
    first, second, _ = PLANES[block.plane]
    a, b = block.across
    if "R" not in word:
        return a + unit * np.array([word.get("IJK"[first], 0.0), word.get("IJK"[second], 0.0)])
    chord, r = b - a, word["R"] * unit
    half = np.linalg.norm(chord) / 2
    height = math.sqrt(max(r * r - half * half, 0.0)) * math.copysign(1, r) * (1 if block.motion == 3 else -1)
    return a + chord / 2 + height * np.array([-chord[1], chord[0]]) / (2 * half)


def bound(blocks):
    """Those of which the rule speaks: from G41 or G42 on until G40, and behind a bare G40 until the plane's next motion."""
    out, cancelling = [], False
    for b in blocks:
        if b.side:
            cancelling = True
            out.append(b)
        elif cancelling:
            out.append(b)
            cancelling = not b.in_plane
    return out


def broken(before, after):
    """Where the output breaks the rule: a block without motion in the plane gains one, or a block with it loses it."""
    groups, numbers, now = {}, {b.number for b in before}, None
    for b in after:
        now = b.number if b.number in numbers else now
        groups.setdefault(now, []).append(b)
    for b in bound(before):
        made = groups.get(b.number, [])
        plane = {"XYZ"[n] for n in PLANES[b.plane][:2]}
        moves = any(x.in_plane for x in made)
        gained = [x.line for x in made if x.in_plane or (x.words & plane and not b.words & plane)]
        if not made:
            return "N%d is gone: %s" % (b.number, b.line)
        if not b.in_plane and gained:
            return "gains the plane's words: %s became %s" % (b.line, gained[0])
        if b.in_plane and not moves:
            return "loses the plane's motion: %s became %s" % (b.line, made[0].line)
    return None
