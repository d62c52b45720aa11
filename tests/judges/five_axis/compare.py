"""The tip curve of the corrected program on the crooked machine against that of the original on an ideal one.

Both curves are sampled so densely that they leave their chords by at most 0.02 um, run stretch by stretch (the feeds between two
positioning moves) and follow each other forwards only: each place of one is compared with the nearest one of the other that
is not behind the last, within four times the limit ahead, and the other way round. Nearness counts the tip's distance and 4 mm a
radian of the rotary axes' commands, so that a turn with the tip at rest is followed too; what is judged at the foot is the
tip's distance alone, the angle between the tool directions, and the difference of the rotary commands.
"""

import math

import numpy as np

from machine import Machine
from reader import sample

WEIGHT = 4.0
TURNED = 0.05
# Where directions are corrected: a rotary axis goes no further aside, and within this sine of a singularity, which is where the
# last of what it was turned aside by has been taken back, directions need not hold.
ASIDE = 0.55
NEAR = 0.02 + math.radians(0.5) / 0.1


class Structure(Exception):
    """The corrected program has not the stretches of the original."""


class Curve:
    """Places (n, 3) of the tip, directions (n, 3), angles (n, k) and the motion's number (n,) along one stretch."""

    def __init__(self, tip, way, rot, number, share, q, directed=False):
        self.tip, self.way, self.rot, self.number, self.share, self.q = tip, way, rot, number, share, q
        # Where directions are corrected, rotary axes stand aside of their angles on purpose.
        self.place = np.concatenate([tip, WEIGHT * (way if directed else np.radians(rot))], axis=1)
        self.run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.place, axis=0), axis=1))])


def stretches(motions):
    out, kind = [], None
    # A hole that is written as moves may have one positioning move where its cycle has two.
    merged = any(m.plane for m in motions)
    for n, m in enumerate(motions):
        if m.kind == "rapid" and kind == "rapid" and merged:
            out[-1][1].append(n)
        elif m.kind == "rapid":
            out.append(("rapid", [n]))
        elif kind == "feed":
            out[-1][1].append(n)
        else:
            out.append(("feed", [n]))
        kind = m.kind
    return out


def curves(spec, motions, perfect, directed=False):
    """A curve for each stretch of feeds."""
    control = Machine(spec, perfect=True, centres=spec.get("control_centres"))
    machine = Machine(spec, perfect=perfect)
    ideal = Machine(spec, perfect=True)
    q, rot, number, share, tools = sample(motions, ideal, control)
    if not perfect:
        play, turned = machine.play(q), machine.rotary_play(rot)
        tip, way = np.empty_like(q), np.empty_like(q)
        for tool in np.unique(tools, axis=0):
            rows = np.all(tools == tool, axis=1)
            tip[rows], way[rows] = machine.place(q[rows], rot[rows], tool, play[rows], [part[rows] for part in turned])
    else:
        # The ideal tip under TCP is what the program says, whatever the centres.
        tip, way = np.empty_like(q), np.empty_like(q)
        for tool in np.unique(tools, axis=0):
            rows = np.all(tools == tool, axis=1)
            tip[rows], way[rows] = ideal.place(q[rows], rot[rows], tool)
        for n, m in enumerate(motions):
            if m.tcp:
                rows = number == n
                tip[rows] = m.at(share[rows])[0]
    out = []
    for kind, numbers in stretches(motions):
        rows = np.flatnonzero((number >= numbers[0]) & (number <= numbers[-1]))
        if kind == "feed" and numbers[0] > 0 and rows[0] > 0:
            pass  # the first feed's own start is its share 0
        out.append((kind, numbers, Curve(tip[rows], way[rows], rot[rows], number[rows], share[rows], q[rows], directed)))
    return out


def follow(path, places, limit):
    """For each row of `places` (n, d): index i and share t of its foot on `path` (Curve), forwards only."""
    a, run = path.place, path.run
    n, last = len(places), len(a) - 1
    index, share = np.zeros(n, int), np.zeros(n)
    if last == 0:
        return index, share
    steps = np.concatenate([[0.0], np.linalg.norm(np.diff(places, axis=0), axis=1)])
    way = np.diff(a, axis=0)
    square = np.maximum((way * way).sum(axis=1), 1e-300)
    i, t = 0, 0.0
    for k in range(n):
        at = run[i] + t * (run[i + 1] - run[i])
        j = int(np.searchsorted(run, at + 2 * steps[k] + 4 * limit, side="left"))
        j = min(max(j, i + 2), last)
        s = ((places[k] - a[i:j]) * way[i:j]).sum(axis=1) / square[i:j]
        np.minimum(np.maximum(s, 0.0, out=s), 1.0, out=s)
        s[0] = max(s[0], t)
        gap = a[i:j] + s[:, None] * way[i:j] - places[k]
        d = (gap * gap).sum(axis=1)
        # Not past a place from which the way leads off by more than a third of the limit: at a turn back the way out lies as
        # near as the way back.
        near = np.sqrt(d)
        hump = a[i + 1 : j] - places[k]
        shut = np.flatnonzero(np.sqrt((hump * hump).sum(axis=1)) > np.minimum.accumulate(near)[:-1] + 0.3 * limit)
        best = int(np.argmin(near[: shut[0] + 1])) if len(shut) else int(np.argmin(near))
        if near[best] > limit:
            best = int(np.argmin(near))
        i, t = i + best, float(s[best])
        index[k], share[k] = i, t
    return index, share


def foot(path, index, share, what):
    a = getattr(path, what)
    if len(a) == 1:
        return np.repeat(a, len(index), axis=0)
    return a[index] + share[:, None] * (a[index + 1] - a[index])


def arms(spec, curve, tool):
    """The half steps of all axes at their arms, mm: linear ones always, rotary ones where they turn in this stretch."""
    machine = Machine(spec, perfect=True)
    steps = [0.5 * spec["axes"][k]["resolution"] for k in "XYZ"]
    few = np.linspace(0, len(curve.q) - 1, 40).astype(int)
    turns = np.ptp(curve.rot, axis=0) > 1e-9
    reach = machine.reach(curve.q[few], curve.rot[few], tool).max(axis=0)
    for k, name in enumerate(machine.rotary):
        if turns[k]:
            steps.append(0.5 * math.radians(spec["rotary"][name]["resolution"]) * reach[k])
    return float(np.linalg.norm(steps))


def aside(b, first, a, limit):
    """The motion of `b` that begins at `first` turns rotary axes by less than ASIDE, with the tip at the start of `a`, and is not
    the last."""
    rows = np.flatnonzero(b.number == b.number[first])
    rows = rows[rows >= first]
    ends = np.concatenate([rows, [min(rows[-1] + 1, len(b.tip) - 1)]])
    still = np.linalg.norm(b.tip[ends] - a.tip[0], axis=1).max() <= limit and np.linalg.norm(b.tip[rows[-1]] - b.tip[rows[0]]) <= 2 * limit
    small = np.abs(b.rot[ends] - a.rot[0]).max(initial=0.0) <= ASIDE and np.ptp(b.rot[rows], axis=0).max(initial=0.0) > 0
    goes = np.ptp(a.rot, axis=0).max(initial=0.0) > ASIDE or np.ptp(a.tip, axis=0).max() > 4 * limit
    return bool(still and small and goes and rows[-1] + 1 < len(b.tip))


def late(a, i, b, rows, limit):
    """Angle (n,), urad, between the directions at these rows of `b` and the best place of `a` around their feet whose tip is within
    the limit: where both turn fast, a tip that is late by less than it may be has the direction of where it is."""
    out = np.full(len(rows), np.inf)
    for n, row in enumerate(rows):
        # As far along the way as the tip may be late.
        low = min(int(np.searchsorted(a.run, a.run[i[row]] - 3 * limit)) - 1, i[row] - 6)
        high = max(int(np.searchsorted(a.run, a.run[i[row]] + 3 * limit)) + 1, i[row] + 7)
        for k in range(max(low, 0), min(high, len(a.tip) - 1)):
            along = a.tip[k + 1] - a.tip[k]
            square = max(float(along @ along), 1e-24)
            foot_, reach = float((b.tip[row] - a.tip[k]) @ along) / square, limit / math.sqrt(square)
            grid = np.linspace(np.clip(foot_ - reach, 0, 1), np.clip(foot_ + reach, 0, 1), 81)[:, None]
            tip = a.tip[k] + grid * along
            way = a.way[k] + grid * (a.way[k + 1] - a.way[k])
            fits = np.linalg.norm(tip - b.tip[row], axis=1) <= limit
            if fits.any():
                out[n] = min(out[n], float(np.linalg.norm(np.cross(way[fits], b.way[row]), axis=1).min()) * 1e6)
    return out


def compare(spec, wanted, taken, directed=False):
    """A dictionary: worst `ratio`, its `um`, `line`, `limit_um`; `before_um`; `tilt_urad` (direction), `far_tilt_urad` the same away
    from singularities, with its `far_line`, `worse_tilt_urad` by how much it is above the largest of the stretch uncorrected near
    one, `tilt_before_urad`; `turned` (degrees of rotary command apart), `stretches`; raises Structure."""
    ideal = curves(spec, wanted, True, directed)
    before = curves(spec, wanted, False, directed)
    real = curves(spec, taken, False, directed)
    if [k for k, _, _ in ideal] != [k for k, _, _ in real]:
        raise Structure(f"{len(real)} stretches of rapids and feeds for {len(ideal)}")
    out = {"ratio": 0.0, "um": 0.0, "line": None, "limit_um": 0.0, "before_um": 0.0, "tilt_urad": 0.0, "far_tilt_urad": 0.0, "far_line": None, "worse_tilt_urad": 0.0, "tilt_before_urad": 0.0, "near": 0, "turned": 0.0, "turned_line": None, "feeds": 0, "share": [], "samples": 0}
    for (kind, numbers, a), (_, taken_numbers, b), (_, _, c) in zip(ideal, real, before):
        if kind == "rapid":
            d = float(np.abs(a.rot[-1] - b.rot[-1]).max(initial=0.0))
            if d > out["turned"]:
                out["turned"], out["turned_line"] = d, wanted[numbers[0]].line
            continue
        out["feeds"] += 1
        limit = spec["tolerance_um"] * 1e-3 + arms(spec, a, wanted[numbers[0]].tool)
        out["before_um"] = max(out["before_um"], float(np.linalg.norm(a.tip - c.tip, axis=1).max()) * 1e3)
        # A short move to the corrected start may stand before the stretch.
        away = np.linalg.norm(b.tip - a.tip[0], axis=1)
        first = int(np.argmax(away <= limit)) if (away <= limit).any() else 0
        if first and np.linalg.norm(np.diff(b.tip[: first + 1], axis=0), axis=1).sum() > 2.0:
            first = 0
        # Where it has come near enough it is still on its way: the path begins where it ends, nearer than where it is.
        end = int(np.searchsorted(b.number, b.number[first], side="right"))
        if end < len(b.tip) and away[end] < away[first] <= limit and np.linalg.norm(b.tip[end] - b.tip[0]) <= 2.0:
            first = end
        # So may a turn that points the tool where it shall, its tip at rest.
        while directed and first < len(b.tip) and aside(b, first, a, limit):
            first = int(np.flatnonzero(b.number == b.number[first])[-1]) + 1
        b = Curve(b.tip[first:], b.way[first:], b.rot[first:], b.number[first:], b.share[first:], b.q[first:], directed)
        i, t = follow(a, b.place, limit)
        one = np.linalg.norm(foot(a, i, t, "tip") - b.tip, axis=1)
        tilt = np.linalg.norm(np.cross(foot(a, i, t, "way"), b.way), axis=1) * 1e6
        if directed:
            off = np.flatnonzero(tilt > spec.get("orientation_urad", 20.0))
            tilt[off] = np.minimum(tilt[off], late(a, i, b, off, limit + 4e-5))
        turned = np.abs(foot(a, i, t, "rot") - b.rot).max(axis=1)
        j, s = follow(b, a.place, limit)
        other = np.linalg.norm(foot(b, j, s, "tip") - a.tip, axis=1)
        ends = np.abs(a.rot[-1] - b.rot[-1]).max(initial=0.0)
        out["samples"] += len(a.tip) + len(b.tip)
        for d, row, curve in ((one, a.number[i], a), (other, a.number, a)):
            k = int(np.argmax(d))
            if d[k] / limit > out["ratio"]:
                out.update(ratio=float(d[k] / limit), um=float(d[k]) * 1e3, line=wanted[int(row[k])].line, limit_um=limit * 1e3)
        out["tilt_urad"] = max(out["tilt_urad"], float(tilt.max()))
        tilt_before = float(np.linalg.norm(np.cross(a.way, c.way), axis=1).max()) * 1e6
        out["tilt_before_urad"] = max(out["tilt_before_urad"], tilt_before)
        near = Machine(spec, perfect=True).singular(foot(a, i, t, "rot")) < NEAR
        out["near"] += int(near.sum())
        far = np.where(near, 0.0, tilt)
        if far.max() > out["far_tilt_urad"]:
            out["far_tilt_urad"], out["far_line"] = float(far.max()), wanted[int(a.number[i[int(np.argmax(far))]])].line
        out["worse_tilt_urad"] = max(out["worse_tilt_urad"], float(np.where(near, tilt, 0.0).max()) - tilt_before)
        k = int(np.argmax(turned))
        for d, line in ((float(turned[k]), wanted[int(a.number[i[k]])].line), (float(ends), wanted[numbers[-1]].line)):
            if d > out["turned"]:
                out["turned"], out["turned_line"] = d, line
        out["share"].append((numbers, taken_numbers, a.number[i], b.number, b.share))
    return out


def times(wanted, taken, found):
    """Under G93: lines whose pieces do not take, together, the time of the programmed block; under G94, G95: lines of another F.
    A piece belongs to the block on which its middle lies; a short move before the stretch to none."""
    wrong = []
    for numbers, taken_numbers, blocks, pieces, shares in found["share"]:
        spent = {n: 0.0 for n in numbers}
        for p in taken_numbers:
            rows = np.flatnonzero(pieces == p)
            if not len(rows) or shares[rows[0]] > 0 or not taken[p].moves():
                continue  # the short move to the start, or none
            n = int(blocks[rows[len(rows) // 2]])
            m, o = taken[p], wanted[n]
            if o.mode != m.mode:
                wrong.append((o.line, f"feed mode {m.mode} for {o.mode}"))
            elif o.mode == 93:
                spent[n] += 1 / m.f if m.f else 0.0
            elif o.f != m.f:
                wrong.append((o.line, f"F{m.f} for F{o.f}"))
        # A block of a few micrometres may lie at its neighbours' foot: with them it has to fit as well.
        def off(ns):
            ns = [n for n in ns if n in spent and wanted[n].mode == 93 and wanted[n].f and wanted[n].moves()]
            due = sum(1 / wanted[n].f for n in ns)
            return bool(ns) and abs(sum(spent[n] for n in ns) / due - 1) > 0.02

        for n in numbers:
            if all(off(ns) for ns in ([n], [n - 1, n, n + 1], [n - 1, n], [n, n + 1])):
                wrong.append((wanted[n].line, f"takes {spent[n] * wanted[n].f:.3f} of its time"))
    return wrong
