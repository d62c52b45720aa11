"""How far the real tip path is from the programmed one: forwards only, every stretch of feeds between two rapids by itself.

Each place of the real path is measured to the programmed geometry itself (lines and arcs, not samples of them) not behind the place that
the one before was nearest to; each end of a programmed motion is measured to the real path.
"""

import math

import numpy as np


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


def refine(m, p, s, width):
    """Nearest place of a motion to p about s: (distance, share), by closed form for lines, by thirds for arcs."""
    if m.arc is None:
        d = m.end - m.start
        s = float(np.clip((p - m.start) @ d / max(d @ d, 1e-18), 0, 1))
        return float(np.linalg.norm(m.start + s * d - p)), s
    low, high = max(0.0, s - width), min(1.0, s + width)
    for _ in range(4):
        grid = np.linspace(low, high, 33)
        d = ((m.at(grid) - p) ** 2).sum(1)
        k = int(d.argmin())
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, 32)]
    return float(math.sqrt(d[k])), float(grid[k])


def one(wanted, real, lines, limit_mm):
    """(largest distance, line) of a real path (n, 3) to programmed motions, and of their ends to it."""
    worst, where = 0.0, 0
    index, share = 0, 0.0
    reached = np.full(len(wanted), np.inf)
    for p, line in zip(real, lines):
        best = None
        # from where the last place was, until it gets far again
        for k in range(index, min(index + 12, len(wanted))):
            m = wanted[k]
            if m.length() < 1e-9:
                continue
            n = 2 if m.arc is None else max(9, int(abs(m.arc[5]) / 0.1))
            start = share if k == index else 0.0
            grid = np.linspace(start, 1, n)
            s = grid[int(((m.at(grid) - p) ** 2).sum(1).argmin())]
            d, s = refine(m, p, s, 1.5 / n)
            if s < start:
                # forwards only, but for what rounding makes of the end
                s = start
                d = float(np.linalg.norm(m.at(np.array([s]))[0] - p))
            if best is None or d < best[0] - 1e-7:
                best = (d, k, s)
            if best[0] < limit_mm and k > best[1]:
                break
        if best is None:
            raise Structure("nothing is programmed there")
        d, index, share = best
        if d > worst:
            worst, where = d, line
        for k in range(max(0, index - 1), index + 1):
            reached[k] = min(reached[k], float(np.linalg.norm(wanted[k].end - p)))
    for k, m in enumerate(wanted):
        if m.length() > 1e-9 and reached[k] > worst:
            worst, where = float(reached[k]), m.line
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
    at, worst, where = 0, 0.0, 0
    for ms, xs in zip(first, samples):
        n = sum(len(x) for x in xs)
        lines = np.concatenate([[k] * len(x) for k, x in enumerate(xs)])
        d, k = one(ms, real[at : at + n], lines, limit_mm)
        at += n
        if d > worst:
            worst, where = d, ms[0].line
    rapid = 0.0
    for a, b in zip(jumps, landings):
        if not np.isnan(b.end).any():
            if not np.isnan(a.end).any():
                rapid = max(rapid, float(np.linalg.norm(real[at] - a.end)))
            at += 1
    return {"um": 1e3 * worst, "line": where, "rapid_um": 1e3 * rapid, "places": len(places)}
