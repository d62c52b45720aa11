"""How far two paths are apart that are run through at once."""

import numpy as np

WINDOW = 14  # places to either side of where the other path stands


def lengths(points):
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def farthest(points, line):
    """Largest distance of points from a line that is run through at once with them."""
    along, way = lengths(points), lengths(line)
    near = np.searchsorted(way, along * way[-1] / max(along[-1], 1e-9))
    k = np.clip(near[:, None] + np.arange(-WINDOW, WINDOW), 0, len(line) - 2)
    a, d = line[k], line[k + 1] - line[k]
    t = np.clip(((points[:, None] - a) * d).sum(axis=2) / np.maximum((d * d).sum(axis=2), 1e-30), 0.0, 1.0)
    return float(np.linalg.norm(points[:, None] - a - t[..., None] * d, axis=2).min(axis=1).max())


def without_start(points, way):
    """The path behind its first `way` millimetres."""
    s = lengths(points)
    k = max(int(np.searchsorted(s, way)), 1)
    if k == len(s):
        return points[-1:]
    first = points[k - 1] + (way - s[k - 1]) / (s[k] - s[k - 1]) * (points[k] - points[k - 1])
    return np.concatenate([[first], points[k:]])
