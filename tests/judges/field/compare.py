"""How far the real tip path is from the programmed one: forwards only, every stretch of feeds between two rapids by itself.

Each place of the real path is measured to the programmed geometry itself (lines and arcs, not samples of them) not behind the place that
the one before was nearest to; each end of a programmed motion is measured to the real path.
"""

import math

import numpy as np


APPROACH_MM = 0.5


class Structure(Exception):
    pass


def stretches(motions):
    """[[feeds], …] and the ends of the rapids between them."""
    out, rapids, now = [], [], []
    for m in motions:
        if m.kind == "rapid":
            if now:
                out.append(now)
                now = []
            rapids.append(m)
        else:
            now.append(m)
    return out + ([now] if now else []), rapids


def sample(m, step):
    n = max(2, int(math.ceil(m.length() / step)))
    if m.arc is not None:
        n = max(n, int(math.ceil(abs(m.arc[5]) / 0.05)))
    return m.at(np.linspace(0, 1, n + 1))


def refine(m, p, s, width, stop):
    """Nearest place of a motion to p about s: (distance, share), by closed form for lines, by thirds for arcs."""
    if m.arc is None:
        d = m.end - m.start
        s = float(np.clip((p - m.start) @ d / max(d @ d, 1e-18), 0, 1))
        return float(np.linalg.norm(m.start + s * d - p)), s
    low, high = max(0.0, s - width), min(stop, s + width)
    for _ in range(4):
        grid = np.linspace(low, high, 33)
        d = ((m.at(grid) - p) ** 2).sum(1)
        k = int(d.argmin())
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, 32)]
    return float(math.sqrt(d[k])), float(grid[k])


def distance(m, p, start):
    """(distance, share) of the nearest place of a motion to p, not before `start`."""
    if m.length() < 1e-9:
        return float(np.linalg.norm(m.end - p)), 1.0
    n = 2 if m.arc is None else max(9, int(abs(m.arc[5]) / 0.1))
    # of a nearly full circle the far half is not yet meant
    stop = min(1.0, start + 0.5) if m.arc is not None and abs(m.arc[5]) > 3 else 1.0
    grid = np.linspace(start, stop, n)
    d, s = refine(m, p, grid[int(((m.at(grid) - p) ** 2).sum(1).argmin())], 1.5 * (stop - start) / (n - 1) + 1e-12, stop)
    if s < start:
        s = start
        d = float(np.linalg.norm(m.at(np.array([s]))[0] - p))
    return d, s


def passes(real, straight, k, end):
    """How near the path comes to an end on its way to place k: between two places of one straight feed it is straight."""
    p = real[k]
    if k and straight[k]:
        way = p - real[k - 1]
        p = p - way * np.clip((p - end) @ way / max(way @ way, 1e-18), 0, 1)
    return float(np.linalg.norm(end - p))


def one(wanted, real, straight, limit_mm):
    """(largest distance, line): of a real path (n, 3) to programmed motions, each begun when the end of the one before was reached."""
    worst, where, index, share = 0.0, wanted[0].line, 0, 0.0
    reached = np.full(len(wanted), np.inf)
    for k, p in enumerate(real):
        d, s = distance(wanted[index], p, share)
        if s > 0.5 or wanted[index].arc is None:
            reached[index] = min(reached[index], passes(real, straight, k, wanted[index].end))
        while reached[index] <= limit_mm and index + 1 < len(wanted):
            e, t = distance(wanted[index + 1], p, 0.0)
            if e > d + 1e-9 and d <= limit_mm:
                break
            index, d, s = index + 1, e, t
            if s > 0.5 or wanted[index].arc is None:
                reached[index] = passes(real, straight, k, wanted[index].end)
        share = s
        if d > worst:
            worst, where = d, wanted[index].line
    for m, d in zip(wanted, reached):
        if d > worst:
            worst, where = float(min(d, 1e6)), m.line
            break
    return worst, where


def compare(wanted, taken, tips, limit_mm, step):
    """`tips(places)` -> real places of commands. Returns dict um, line, rapid_um, before… or raises Structure."""
    first, jumps = stretches(wanted)
    second, landings = stretches(taken)
    if len(first) != len(second) or len(jumps) != len(landings):
        raise Structure(f"{len(first)} stretches and {len(jumps)} rapids became {len(second)} and {len(landings)}")
    samples = [[sample(m, step) for m in ms] for ms in second]
    places = np.concatenate([x for xs in samples for x in xs] + [m.end[None] for m in landings if not np.isnan(m.end).any()])
    real = tips(places)
    at, worst, where, approaches = 0, 0.0, 0, 0
    for ms, rs, xs in zip(first, second, samples):
        n = sum(len(x) for x in xs)
        path = real[at : at + n]
        straight = np.concatenate([np.arange(len(x)) > 0 if m.arc is None else np.zeros(len(x), bool) for m, x in zip(rs, xs)])
        at += n
        # a rapid moves its own axes only: a short feed may lead to the corrected start
        lead = len(xs[0])
        near = lambda p: np.linalg.norm(p - ms[0].start)  # noqa: E731
        short = rs[0].length()
        if len(xs) > 1 and near(path[lead - 1]) <= limit_mm and short < APPROACH_MM and (near(path[0]) > limit_mm or short < 0.1 * ms[0].length()):
            path, straight = path[lead:], straight[lead:]
            approaches += 1
        d, line = one(ms, path, straight, limit_mm)
        if d > worst:
            worst, where = d, line
    rapid = 0.0
    for a, b in zip(jumps, landings):
        if not np.isnan(b.end).any():
            if not np.isnan(a.end).any() and (np.isnan(a.start) | (a.start != a.end)).all():
                rapid = max(rapid, float(np.linalg.norm(real[at] - a.end)))
            at += 1
    return {"um": 1e3 * worst, "line": where, "rapid_um": 1e3 * rapid, "places": len(places)}
