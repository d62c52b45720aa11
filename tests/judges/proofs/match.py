"""How far a travelled path is from a programmed one when both are run through in order.

The Frechet distance: the least d for which two points can run along both paths, neither ever going back, and stay within
d of each other. Going back, leaving a corner out and cutting one all show; being early or late on a straight way does not.

The programmed path is exact: lines, and pieces of arcs short enough that the set of its points within d of a given
point is one interval. The travelled path is a row of points, dense at the corners of the programmed path. A corner is
passed at points that can be reached with what came before; along a piece the least place `lo` that still allows a way
without going back is carried from point to point: `lo <- max(lo, a_k)`, which must stay at most `b_k`, where `[a_k, b_k]`
is what lies within d of point k.
"""

import math

import numpy as np

PIECE = math.pi / 4


class Piece:
    """A line, or at most an eighth of a turn of an arc; v runs from 0 to 1."""

    def __init__(self, motion, low, high, tip):
        self.motion, self.low, self.high, self.tip = motion, low, high, tip
        self.ends = self.at(np.array([0.0, 1.0]))
        self.straight = motion.arc is None
        if self.straight:
            self.way = self.ends[1] - self.ends[0]
            self.length = float(np.linalg.norm(self.way))

    def at(self, v):
        return self.motion.at(self.low + np.asarray(v, float) * (self.high - self.low)) + self.tip

    def nearest(self, p):
        """Share of the way and distance of the nearest point, for each row of p."""
        if self.straight:
            v = np.clip((p - self.ends[0]) @ self.way / self.length**2, 0, 1) if self.length else np.zeros(len(p))
            return v, np.linalg.norm(p - self.ends[0] - v[:, None] * self.way, axis=1)
        grid = np.linspace(0, 1, 9)
        far = np.array([self.far(np.full(len(p), g), p) for g in grid])
        v = grid[np.argmin(far, axis=0)]
        low, high = np.clip(v - 0.125, 0, 1), np.clip(v + 0.125, 0, 1)
        for _ in range(6):
            gap = self.at(v) - p
            speed, bend = self.slopes(v)
            square = np.sum(speed * speed, axis=1)
            slope = np.sum(gap * speed, axis=1)
            v = np.clip(v - slope / np.maximum(square + np.sum(gap * bend, axis=1), 0.1 * square), low, high)
        d = self.far(v, p)
        best = np.argmin(far, axis=0)
        worse = far.min(axis=0) < d
        return np.where(worse, grid[best], v), np.where(worse, far.min(axis=0), d)

    def slopes(self, v):
        """First and second derivative of the place by the share of the way, on an arc."""
        m, a, part = self.motion, self.motion.arc, self.high - self.low
        angle = a["angle"] + a["sweep"] * (self.low + v * part)
        r = a["r0"] + (a["r1"] - a["r0"]) * (self.low + v * part)
        w, g = a["sweep"] * part, (a["r1"] - a["r0"]) * part
        i, j, k = a["axes"]
        c, s = np.cos(angle), np.sin(angle)
        first, second = np.zeros((len(v), 3)), np.zeros((len(v), 3))
        first[:, i], first[:, j] = g * c - r * w * s, g * s + r * w * c
        first[:, k] = (m.end[k] - m.start[k]) * part
        second[:, i], second[:, j] = -2 * g * w * s - r * w * w * c, 2 * g * w * c - r * w * w * s
        return first, second

    def far(self, v, p):
        return np.linalg.norm(self.at(v) - p, axis=1)

    def interval(self, p, near, d, limit):
        """(free, a, b): the shares of the way within `limit` of each row of p."""
        free = d <= limit
        if self.straight:
            if not self.length:
                return free, np.zeros(len(p)), np.ones(len(p))
            foot = (p - self.ends[0]) @ self.way / self.length**2
            across = np.linalg.norm(p - self.ends[0] - foot[:, None] * self.way, axis=1)
            half = np.sqrt(np.maximum(limit**2 - across**2, 0)) / self.length
            return free, np.clip(foot - half, 0, 1), np.clip(foot + half, 0, 1)
        out = []
        speed = np.linalg.norm(self.slopes(near)[0], axis=1)
        half = np.sqrt(np.maximum(limit**2 - d**2, 0)) / speed
        for end, side in ((0.0, -1.0), (1.0, 1.0)):
            reach = self.far(np.full(len(p), end), p) <= limit
            v = np.clip(near + side * half, 0, 1)
            for _ in range(5):
                gap = self.at(v) - p
                slope = 2 * np.sum(gap * self.slopes(v)[0], axis=1)
                slope = side * np.maximum(side * slope, 0.2 * speed * speed * half + 1e-300)
                v = v - (np.sum(gap * gap, axis=1) - limit**2) / slope
                v = np.clip(v, near, 1) if side > 0 else np.clip(v, 0, near)
            out.append(np.where(reach, end, v))
        return free, out[0], out[1]


class Pieces:
    """A programmed stretch of feed motions as pieces, and the Frechet distance of travelled points from it."""

    def __init__(self, motions, tools):
        self.pieces, self.single = [], None
        for m in motions:
            tip = tools[m.tool]
            if m.length() == 0.0:
                self.single = m.end + tip
                continue
            count = 1 if m.arc is None else max(1, math.ceil(abs(m.arc["sweep"]) / PIECE))
            for k in range(count):
                self.pieces.append(Piece(m, k / count, (k + 1) / count, tip))
        self.corners = np.array([p.ends[0] for p in self.pieces] + [self.pieces[-1].ends[1]]) if self.pieces else None
        self.cache = {}

    def window(self, j, p, first, last, limit):
        """Nearest shares and distances of points `first` on, until one after `last` is too far."""
        chunk, v, d = first // CHUNK, [], []
        while True:
            if (j, chunk) not in self.cache:
                self.cache[j, chunk] = self.pieces[j].nearest(p[chunk * CHUNK : (chunk + 1) * CHUNK])
            one, far = self.cache[j, chunk]
            skip = max(first - chunk * CHUNK, 0)
            v.append(one[skip:])
            d.append(far[skip:])
            chunk += 1
            if chunk * CHUNK >= len(p):
                break
            if chunk * CHUNK > last + 1 and (far[max(last + 1 - (chunk - 1) * CHUNK, 0) :] > limit).any():
                break
        return np.concatenate(v), np.concatenate(d)

    def within(self, p, limit):
        """(whether some order keeps p within limit, number of the piece where it first failed)."""
        if not self.pieces:
            return bool(np.all(np.linalg.norm(p - self.single, axis=1) <= limit)), 0
        start = np.linalg.norm(p - self.corners[0], axis=1) <= limit
        starts = set(range(int(np.argmin(start)) if not start.all() else len(p)))
        for j, piece in enumerate(self.pieces):
            if not starts:
                return False, max(j - 1, 0)
            starts = self.pass_piece(j, piece, p, limit, starts)
        return len(p) - 1 in starts, len(self.pieces) - 1

    def pass_piece(self, j, piece, p, limit, starts):
        """The points at which the end of the piece can be reached, from those at which its start can."""
        first, last = min(starts), max(starts)
        v, d = self.window(j, p, first, last, limit)
        points = p[first : first + len(v)]
        free = d <= limit
        # Only where the nearest place goes back, and where it later goes back behind, does it matter how far one may wait.
        ahead = np.maximum.accumulate(v)
        behind = np.minimum.accumulate(v[::-1])[::-1]
        matter = np.flatnonzero(free & ((v < ahead) | (v > behind)))
        a, b = np.zeros(len(v)), np.ones(len(v))
        if len(matter):
            _, a[matter], b[matter] = piece.interval(points[matter], v[matter], d[matter], limit)
        at_end = (np.linalg.norm(points - piece.ends[1], axis=1) <= limit).tolist()
        ends, alive, lo = set(), False, 0.0
        free, a, b = free.tolist(), a.tolist(), b.tolist()
        for n in range(len(free)):
            k = first + n
            if k in starts:
                alive, lo = True, 0.0
            elif alive:
                if free[n]:
                    lo = max(lo, a[n])
                    alive = lo <= b[n] + 1e-12
                else:
                    alive = False
            if alive and at_end[n]:
                ends.add(k)
            if not alive and k > last:
                break
        return ends


CHUNK = 256
PRECISION = 4e-3


def distance(pieces, p, hint, known=0.0):
    """The Frechet distance in mm (to PRECISION of the hint, above), the number of the piece that decides it.

    `known` is given back where the distance is no larger.
    """
    pieces.cache = {}
    if known and pieces.within(p, known)[0]:
        return known, None
    ok, where = pieces.within(p, hint)
    low, high = min(known, hint), hint
    if not ok:
        low = hint
        while True:
            high = low * 1.5
            ok, at = pieces.within(p, high)
            if ok:
                break
            low, where = high, at
            if high > 2.0:
                return high, where
    while high - low > PRECISION * hint:
        middle = (low + high) / 2
        ok, at = pieces.within(p, middle)
        if ok:
            high = middle
        else:
            low, where = middle, at
    return high, where
