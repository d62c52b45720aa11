"""How far one polyline in (r, z) is from another when both are run through in order, forwards only."""

import bisect
import math

import numpy as np


class Way:
    """A polyline by length."""

    def __init__(self, points):
        keep = np.ones(len(points), bool)
        keep[1:] = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-12
        self.p = points[keep].tolist()
        self.n = [math.dist(a, b) for a, b in zip(self.p, self.p[1:])]
        self.s = [0.0]
        for n in self.n:
            self.s.append(self.s[-1] + n)

    def near(self, q, low, high, limit):
        """(distance, place) of the place nearest q between the lengths low and high; the first of those about as near."""
        if not self.n:
            return math.dist(q, self.p[0]), 0.0
        i = min(max(bisect.bisect_right(self.s, low) - 1, 0), len(self.n) - 1)
        j = max(min(bisect.bisect_left(self.s, high), len(self.n)), i + 1)
        found = []
        for k in range(i, j):
            (ax, az), (bx, bz), n, s = self.p[k], self.p[k + 1], self.n[k], self.s[k]
            t = ((q[0] - ax) * (bx - ax) + (q[1] - az) * (bz - az)) / (n * n)
            t = min(max(t, 0.0, (low - s) / n), 1.0, max((high - s) / n, 0.0))
            found.append((math.hypot(ax + t * (bx - ax) - q[0], az + t * (bz - az) - q[1]), s + t * n))
        least = min(found)[0]
        return next(f for f in found if f[0] <= least + 0.1 * limit)


def one_way(walker, ground, limit):
    """Largest distance from the points of `walker` to `ground`, in order, and the index of that point."""
    way = Way(ground)
    at, worst, where = 0.0, 0.0, 0
    points = walker.tolist()
    for k, q in enumerate(points):
        step = math.dist(q, points[k - 1]) if k else 0.0
        off, place = way.near(q, max(at - 2 * limit, 0.0), at + step + 8 * limit, limit)
        if off > worst:
            worst, where = off, k
        at = max(at, place) if off < 20 * limit else min(at + step, way.s[-1])
    if way.s[-1] - at > 8 * limit:
        end = math.dist(points[-1], way.p[-1])
        if end > worst:
            worst, where = end, len(points) - 1
    return worst, where


def distance(a, b, limit):
    """Largest distance both ways, and the index in `a` of the worst place (of the walk over `a`)."""
    ab, i = one_way(a, b, limit)
    ba, _ = one_way(b, a, limit)
    return max(ab, ba), i
