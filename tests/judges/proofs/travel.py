"""Where the tool tip travels along a commanded path, with play as a hysteresis operator.

Along its own axis i the carriage stands at `q + m_i(q) - u`, `q` the command, `m_i` the mean positioning error of both
directions, and `u` the generalised play operator with half width `g_i(q)`, carried continuously along the whole path:
`u <- clamp(u + d(q + m_i), -g_i, g_i)`. A carriage that goes back therefore stands until its command has gone back by 2 g.

What else depends on the direction of axis i (columns across it, angles, `lost-motion.*`) changes somewhere within that
way; the documents do not say where. Three readings, the first literal to equation (25):

* `even`  in proportion to the play taken up (so that a line that takes up both together leaves the tool standing);
* `first` at once when the command turns;
* `last`  when all play is taken up.

Where an axis has no play (or, in tables of two directions, less than none: `errors_negative` below `errors`), nothing
can stand still and all readings turn it at once; in `even` and `last` a negative play is taken up over as much way as a
positive one of that size. A fourth reading, `tip`, is `even` with the reversal value of the tip in place of the
carriage's: it differs where angles differ between the directions, since then part of the tip's reversal is leverage.
"""

import math

import numpy as np

READINGS = ("even", "first", "last", "tip")
LEAST = 1e-6  # mm: half width below which an axis turns at once
CHORD = 5e-7  # mm: how far an error may leave the chord of two neighbouring samples


class Trace:
    """Samples of a list of motions: shares t, motion numbers, commands."""

    def __init__(self, motions, machine):
        self.motions, self.machine = motions, machine
        self.kinks = [kinks_of(machine, i) for i in range(3)]
        number, share = [], []
        for k, m in enumerate(motions):
            t = self.shares(m)
            number += [k] * len(t)
            share += list(t)
        self.number, self.t = np.array(number), np.array(share)

    def shares(self, m):
        if m.kind == "rapid" or m.length() == 0.0:
            return [0.0, 1.0] if m.start is not None else [1.0]
        if m.arc is None:
            t = set(np.linspace(0, 1, max(5, min(400, int(m.length() / 0.5))) if m.length() > 0.2 else 5))
            for i in range(3):
                way = m.end[i] - m.start[i]
                if abs(way) > 1e-9:
                    t |= {(n - m.start[i]) / way for n in self.kinks[i]}
        else:
            a = m.arc
            t = set(np.linspace(0, 1, max(17, int(abs(a["sweep"]) / 0.02))))
            quarter = math.pi / 2
            low, high = sorted((a["angle"], a["angle"] + a["sweep"]))
            for k in range(math.ceil(low / quarter), math.floor(high / quarter) + 1):
                t.add((k * quarter - a["angle"]) / a["sweep"])
            radius = (a["r0"] + a["r1"]) / 2
            for c in (0, 1):
                for n in self.kinks[a["axes"][c]]:
                    cosine = (n - a["centre"][c]) / radius if radius else 2.0
                    if abs(cosine) < 1:
                        for angle in (math.acos(cosine), -math.acos(cosine)):
                            angle += quarter if c else 0.0
                            for turn in range(-2, 3):
                                t.add((angle + turn * 2 * math.pi - a["angle"]) / a["sweep"])
        return sorted(x for x in t if 0.0 <= x <= 1.0)

    def commands(self):
        q = np.empty((len(self.t), 3))
        for k, first, last in self.spans():
            m = self.motions[k]
            q[first:last] = m.at(self.t[first:last]) if m.start is not None else m.end
        return q

    def spans(self):
        if not len(self.number):
            return
        edges = np.flatnonzero(np.diff(self.number)) + 1
        bounds = [0, *edges.tolist(), len(self.number)]
        for first, last in zip(bounds, bounds[1:]):
            yield int(self.number[first]), first, last

    def insert(self, where, pieces):
        """Cuts the intervals [k, k+1] (same motion) into so many pieces."""
        where = np.asarray([k for k in where if self.number[k] == self.number[k + 1]], int)
        if not len(where):
            return False
        step = np.arange(1, pieces) / pieces
        new = (self.t[where][:, None] + (self.t[where + 1] - self.t[where])[:, None] * step).ravel()
        at = np.repeat(where + 1, pieces - 1)
        self.number = np.insert(self.number, at, np.repeat(self.number[where], pieces - 1))
        self.t = np.insert(self.t, at, new)
        return True


def kinks_of(machine, i):
    """Places of axis i where a slope or curvature of the machine's errors jumps."""
    out = set()
    for table in (machine.tables[i], machine.minus[i]):
        if table is not None:
            out |= set(table.q.tolist())
    for effect in machine.effects:
        if effect.axis == i:
            if effect.kind == "local":
                c, w = effect.spec["centre_mm"], effect.spec["width_mm"]
                out |= {c - w / 2, c, c + w / 2}
            else:
                out |= {effect.middle - effect.half, effect.middle + effect.half}
    return sorted(out)


def states(machine, q, reading, initial, fields, tool):
    """along[N,3] and aside[N,3] of the commands q, in order; `initial` is the state before the first."""
    along, aside = np.zeros(q.shape), np.zeros(q.shape)
    for i in range(3):
        if not machine.directed(i):
            continue
        mean, g = fields[i][0][:, i], fields[i][2]
        if reading == "tip":
            ones = np.zeros(q.shape)
            ones[:, i] = 1.0
            g = -0.5 * (machine.error(q, ones, ones, tool, fields) - machine.error(q, -ones, -ones, tool, fields))[:, i]
        size = np.maximum(np.abs(g), LEAST)
        if reading == "first":
            quick = hysteresis(q[:, i].tolist(), [LEAST] * len(q), initial[i])
            w = np.array(hysteresis((q[:, i] + mean).tolist(), size.tolist(), initial[i]))
            quick = np.array(quick)
            along[:, i] = np.where(g >= LEAST, w, quick)
            aside[:, i] = quick
            continue
        w = np.array(hysteresis((q[:, i] + mean).tolist(), size.tolist(), initial[i]))
        if reading == "last":
            flipped = latched(w.tolist(), initial[i])
            along[:, i] = np.where(g >= LEAST, w, flipped)
            aside[:, i] = flipped
        else:
            along[:, i] = aside[:, i] = w
    return along, aside


def hysteresis(y, size, initial):
    """State in -1..1 of the generalised play operator with half widths `size` along the places y."""
    out, u, last = [], initial * size[0], y[0]
    for place, g in zip(y, size):
        u += place - last
        last = place
        u = g if u > g else -g if u < -g else u
        out.append(u / g)
    return out


def latched(w, initial):
    """The direction that was last taken up whole."""
    out, d = [], float(initial)
    for one in w:
        if one >= 1 - 1e-9:
            d = 1.0
        elif one <= -1 + 1e-9:
            d = -1.0
        out.append(d)
    return out


def tips(trace, reading, initial, tool):
    """Tip of every sample; intervals are cut until the error is even within each to CHORD."""
    machine = trace.machine
    feeds = np.array([m.kind != "rapid" for m in trace.motions])
    for step in range(15):
        q = trace.commands()
        fields = machine.fields(q)
        along, aside = states(machine, q, reading, initial, fields, tool)
        e = machine.error(q, along, aside, tool, fields)
        tip = q + e + tool
        feed = feeds[trace.number]
        same = (trace.number[1:] == trace.number[:-1]) & feed[1:]
        # Uneven where the error bends between three samples, or jumps within one interval while the command hardly moves.
        t = trace.t
        left, right = t[1:-1] - t[:-2], t[2:] - t[1:-1]
        inner = same[:-1] & same[1:] & (left + right > 0)
        part = np.where(inner, left, 0.0) / np.where(inner, left + right, 1.0)
        chord = e[:-2] + (e[2:] - e[:-2]) * part[:, None]
        bend = np.linalg.norm(e[1:-1] - chord, axis=1) > CHORD
        within = inner & bend
        far = np.linalg.norm(np.diff(q, axis=0), axis=1) > 2e-6
        change = np.abs(np.diff(along, axis=0)).max(axis=1) + np.abs(np.diff(aside, axis=0)).max(axis=1) > 1e-3
        cut = np.zeros(len(t) - 1, bool)
        cut[:-1] |= within
        cut[1:] |= within
        moved = np.linalg.norm(np.diff(e, axis=0), axis=1) > CHORD
        cut |= change & moved & same & turning(along, aside)
        cut &= same & far & (np.diff(t) > 1e-12)
        if step == 14 or len(t) > 400000 or not trace.insert(np.flatnonzero(cut), 4):
            break
    return tip


def turning(along, aside):
    """Intervals in which some state starts or stops changing."""
    out = np.zeros(len(along) - 1, bool)
    for w in (along, aside):
        d = np.abs(np.diff(w, axis=0)) > 1e-9
        before = np.vstack([np.zeros((1, 3), bool), d[:-1]])
        after = np.vstack([d[1:], np.zeros((1, 3), bool)])
        out |= (d & ~(before & after)).any(axis=1)
    return out
