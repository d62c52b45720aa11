"""How far one polyline in (r, z) is from another when both are run through in order, forwards only."""

import numpy as np


class Way:
    """A polyline by length."""

    def __init__(self, points):
        keep = np.ones(len(points), bool)
        keep[1:] = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-12
        self.p = points[keep]
        self.d = np.diff(self.p, axis=0)
        self.n = np.linalg.norm(self.d, axis=1)
        self.s = np.concatenate([[0.0], np.cumsum(self.n)])

    def near(self, q, low, high, limit):
        """(distance, place) of the place nearest q between the lengths low and high; the first of those within the limit."""
        i = max(int(np.searchsorted(self.s, low, side="right")) - 1, 0)
        j = min(int(np.searchsorted(self.s, high, side="left")), len(self.n))
        if j <= i:
            j = min(i + 1, len(self.n))
        if i >= len(self.n):
            i = len(self.n) - 1
            j = len(self.n)
        if len(self.n) == 0:
            return float(np.linalg.norm(q - self.p[0])), 0.0
        a, d, n = self.p[i:j], self.d[i:j], self.n[i:j]
        t = np.clip(((q - a) * d).sum(axis=1) / (n * n), 0, 1)
        t = np.clip(t, np.clip((low - self.s[i:j]) / n, 0, 1), np.clip((high - self.s[i:j]) / n, 0, 1))
        off = np.linalg.norm(a + t[:, None] * d - q, axis=1)
        k = int(np.argmin(off))
        first = np.flatnonzero(off <= max(off[k] + 0.1 * limit, 0))
        k = int(first[0])
        return float(off[k]), float(self.s[i + k] + t[k] * n[k])


def one_way(walker, ground, limit):
    """Largest distance from the points of `walker` to `ground`, in order, and the index of that point."""
    way = Way(ground)
    at, worst, where = 0.0, 0.0, 0
    for k, q in enumerate(walker):
        step = float(np.linalg.norm(q - walker[k - 1])) if k else 0.0
        off, place = way.near(q, max(at - 2 * limit, 0.0), at + step + 8 * limit, limit)
        if off > worst:
            worst, where = off, k
        at = max(at, place) if off < 20 * limit else min(at + step, way.s[-1])
    missing = way.s[-1] - at
    if missing > 8 * limit:
        end = float(np.linalg.norm(walker[-1] - way.p[-1]))
        if end > worst:
            worst, where = end, len(walker) - 1
    return worst, where


def distance(a, b, limit):
    """Largest distance both ways, and the index in `a` of the worst place (of the walk over `a`)."""
    ab, i = one_way(a, b, limit)
    ba, j = one_way(b, a, limit)
    return max(ab, ba), i
