"""The machine as arithmetic: where the tool tip is for a command and a state of play.

Written from docs/equations.md, (1) to (11) and (23), and from the meaning of a profile in docs/reference.md.
Millimetres and radians. All functions take arrays of N commands at once.

**State of play.** Each axis i that knows directions has two numbers between -1 and +1:

* `along[i]`: how far its play has been run through, -1 lying against the side of motion towards minus, +1 the other;
* `aside[i]`: the direction for whatever else changes when that axis turns (columns across it, angles, lost motion across).

An error is linear in each: the mean of both directions plus the state times half their difference. How the states
change along a commanded path is the business of play.py.
"""

import math

import numpy as np

AXES = "XYZ"
UNITS = ("X", "Y", "Z", "A", "B", "C")


class Table:
    """Six functions of one axis command, (1) linear or (2), (3) monotone cubic. Columns X Y Z (mm), A B C (rad)."""

    def __init__(self, nodes, values, cubic):
        self.q = np.asarray(nodes, float)
        self.f = np.asarray(values, float)
        self.cubic = cubic and len(self.q) > 2
        h = np.diff(self.q)
        self.h, self.s = h, np.diff(self.f, axis=0) / h[:, None]
        if self.cubic:
            self.d = np.column_stack([slopes(h, self.s[:, c]) for c in range(6)])

    def at(self, q):
        q = np.clip(np.asarray(q, float), self.q[0], self.q[-1])
        k = np.clip(np.searchsorted(self.q, q, side="right") - 1, 0, len(self.h) - 1)
        t = (q - self.q[k])[:, None]
        if not self.cubic:
            return self.f[k] + self.s[k] * t
        h, s, a, b = self.h[k][:, None], self.s[k], self.d[k], self.d[k + 1]
        return self.f[k] + t * (a + t * ((3 * s - 2 * a - b) / h + t * (a + b - 2 * s) / h**2))


def slopes(h, s):
    """(3): slopes at the nodes from the secants s and the widths h."""
    n = len(s)
    d = [0.0] * (n + 1)
    for k in range(1, n):
        if s[k - 1] * s[k] > 0:
            a, b = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
            d[k] = (a + b) / (a / s[k - 1] + b / s[k])
    for end, (i, j) in ((0, (0, 1)), (n, (n - 1, n - 2))):
        g = ((2 * h[i] + h[j]) * s[i] - h[i] * s[j]) / (h[i] + h[j])
        if g * s[i] <= 0:
            g = 0.0
        elif s[i] * s[j] < 0 and abs(g) > 3 * abs(s[i]):
            g = 3 * s[i]
        d[end] = g
    return d


def turned(e, v):
    """(exp([e]x) - I) v, exactly (Rodrigues), row by row."""
    e = np.broadcast_to(e, v.shape)
    th = np.linalg.norm(e, axis=1)
    small = th < 1e-9
    t = np.where(small, 1.0, th)
    a = np.where(small, 1.0, np.sin(t) / t)[:, None]
    b = np.where(small, 0.5, 2 * np.sin(t / 2) ** 2 / t**2)[:, None]
    c = np.cross(e, v)
    return a * c + b * np.cross(e, c)


def legendre(n, r):
    """Legendre's polynomial P_n on -1 <= r <= 1, the value of the end beyond it."""
    return np.polynomial.legendre.legval(np.clip(r, -1, 1), [0.0] * n + [1.0])


class Effect:
    """One [[effect]] of (23): the displacement of the tip, with the direction state where it knows one."""

    def __init__(self, spec, order, travel):
        self.spec = spec
        self.kind, _, self.what = spec["id"].partition(".")
        self.order = order
        if self.kind in ("lost-motion", "straightness", "positioning", "angular"):
            self.axis = AXES.index(self.what[2])
        elif self.kind == "squareness":
            self.axis = AXES.index(self.what[1])
        else:
            self.axis = AXES.index(self.what[0])
        low, high = spec.get("from_mm", travel[self.axis][0]), spec.get("to_mm", travel[self.axis][1])
        self.middle, self.half = (low + high) / 2, (high - low) / 2

    def series(self, q, stem, unit, first):
        """Sum of coefficients stem<n>unit times P_n on the effect's interval."""
        r = (q - self.middle) / self.half
        out = np.zeros(len(q))
        for n in range(first, 8):
            c = self.spec.get(f"{stem}p{n}_{unit}", 0.0)
            if c:
                out = out + c * legendre(n, r)
        return out

    def half_width(self, q):
        """Half the reversal value, mm: of backlash along the axis, of lost motion across it."""
        return 1e-3 * (self.spec.get("half_width_um", 0.0) + self.series(q, "half_width_", "um", 1))

    def add(self, e, q, tool, aside, at):
        """Adds to e; `aside` is the state of all three axes; play along an axis is added elsewhere."""
        s, i = self.spec, self.axis
        x = q[:, i]
        if self.kind == "scale":
            e[:, i] += 1e-6 * s["scale_um_per_m"] * x
        elif self.kind == "thermal":
            t = at.get(f"temp_{AXES[i].lower()}_c", at.get("temp_c")) - at["reference_c"]
            e[:, i] += 1e-6 * s.get("expansion_um_per_m_k", 0.0) * t * x + 1e-3 * s.get("shift_um_per_k", 0.0) * t
            e[:, i] += 1e-6 * s.get("expansion2_um_per_m_k2", 0.0) * t * t * x
        elif self.kind == "warmup":
            for k in ("", "2"):
                if s.get(f"amplitude{k}_um"):
                    e[:, i] += 1e-3 * s[f"amplitude{k}_um"] * (1 - math.exp(-at["time_s"] / s[f"tau{k}_s"]))
        elif self.kind == "squareness":
            a = 1e-6 * s["angle_urad"]
            j = AXES.index(self.what[0])
            e[:, j] += {"XY": -a, "XZ": a, "YZ": -a}[self.what] * x
        elif self.kind in ("positioning", "straightness"):
            e[:, AXES.index(self.what[1])] += 1e-3 * self.series(x, "", "um", 2)
        elif self.kind == "pitch":
            w = 2 * math.pi / s["pitch_mm"]
            r = np.clip((x - self.middle) / self.half, -1, 1)
            for n in (1, 2, 3):
                for f, g in (("sin", np.sin), ("cos", np.cos)):
                    size = s.get(f"{f}{n}_um", 0.0) + s.get(f"{f}{n}_slope_um", 0.0) * r
                    e[:, i] += 1e-3 * size * g(n * w * x)
        elif self.kind == "angular":
            angle = np.zeros((len(x), 3))
            angle[:, "ABC".index(self.what[1])] = 1e-6 * self.series(x, "", "urad", 1)
            lever = np.array(np.broadcast_to(tool, q.shape), float)
            for j in self.order[self.order.index(i) + 1 :]:
                lever[:, j] += q[:, j]
            e += np.cross(angle, lever)
        elif self.kind == "sag":
            u = np.clip((x - (self.middle - self.half)) / (2 * self.half), 0, 1)
            drop = sum(s.get(f"droop{n}_um", 0.0) * u**n for n in (2, 3, 4))
            e[:, 2] -= 1e-3 * drop
        elif self.kind == "load":
            load = at["load_kg"]
            e[:, i] -= 1e-3 * (s.get("compliance_um_per_kg", 0.0) * load + s.get("compliance2_um_per_kg2", 0.0) * load**2)
        elif self.kind == "step":
            if at["time_s"] >= s["time_s"]:
                e[:, i] += 1e-3 * s["shift_um"]
        elif self.kind == "local":
            r = (x - s["centre_mm"]) / s["width_mm"]
            shape = np.where(np.abs(r) < 0.5, 0.5 * (1 + np.cos(2 * math.pi * r)), 0.0)
            for j in range(3):
                e[:, j] += 1e-3 * s.get(f"{AXES[j].lower()}_um", 0.0) * shape
        elif self.kind == "lost-motion":
            e[:, AXES.index(self.what[1])] -= self.half_width(x) * aside[:, i]
        elif self.kind != "backlash":
            raise ValueError(f"no model of {s['id']}")


class Machine:
    """A three-axis machine of the generator's plain dictionary (see generate.py); rotary axes are not modelled."""

    def __init__(self, spec):
        self.spec = spec
        self.order = [AXES.index(c) for c in spec["chain"].split() if c in AXES]
        self.travel = [spec["axes"][i]["travel"] for i in range(3)]
        self.tables, self.minus, self.backlash, self.line = [], [], [], []
        for i in range(3):
            a = spec["axes"][i]
            make = lambda key: Table(a[key][0], a[key][1], spec["cubic"]) if a.get(key) else None  # noqa: E731
            self.tables.append(make("errors"))
            self.minus.append(make("errors_negative"))
            self.backlash.append(a.get("backlash_um", 0.0) * 1e-3)
            about = np.array(a.get("measured_tool", (0, 0, 0)), float)
            for j in self.order[self.order.index(i) + 1 :]:
                about[j] += a.get("measured_at", {}).get(j, 0.0)
            self.line.append(about)
        c, b, a = (1e-6 * v for v in spec.get("squareness_urad", (0, 0, 0)))  # EC0Y, EB0Z, EA0Z
        self.normal = np.array([[1, 0, 0], [-c, 1, 0], [b, -a, 1]], float)
        self.effects = [Effect(s, self.order, self.travel) for s in spec.get("effects", [])]
        self.at = spec.get("at", {})
        self.steps = np.array([a["resolution"] for a in spec["axes"]])

    def columns(self, i, q):
        """Mean of both directions and half their difference (plus less minus), six columns each, tables only."""
        if self.tables[i] is None:
            return np.zeros((len(q), 6)), np.zeros((len(q), 6))
        plus = self.tables[i].at(q)
        if self.minus[i] is None:
            return plus, np.zeros((len(q), 6))
        minus = self.minus[i].at(q)
        return (plus + minus) / 2, (plus - minus) / 2

    def half_play(self, i, q, half):
        """Half the reversal value along axis i, mm, `half` from columns(); positive: it stands short of where it comes from."""
        g = -half[:, i] + self.backlash[i] / 2
        for effect in self.effects:
            if effect.kind == "backlash" and effect.axis == i:
                g = g + effect.half_width(q)
        return g

    def directed(self, i):
        """Whether anything depends on the direction of axis i."""
        lateral = any(e.kind in ("backlash", "lost-motion") and e.axis == i for e in self.effects)
        return lateral or self.minus[i] is not None or self.backlash[i] != 0.0

    def fields(self, q):
        """What error() and the play need of each axis: mean and half difference of the columns, half the reversal value."""
        out = []
        for i in range(3):
            mean, half = self.columns(i, q[:, i])
            out.append((mean, half, self.half_play(i, q[:, i], half) if self.directed(i) else None))
        return out

    def error(self, q, along, aside, tool, fields=None):
        """Tip less nominal tip, (8) and (23), for commands q[N,3], states along[N,3], aside[N,3], a tool vector."""
        q = np.asarray(q, float)
        fields = self.fields(q) if fields is None else fields
        n = len(q)
        e, v = np.zeros((n, 3)), np.array(np.broadcast_to(tool, (n, 3)), float)
        for i in reversed(self.order):
            mean, half, g = fields[i]
            table = mean + half * aside[:, i : i + 1]
            table[:, i] = mean[:, i]
            lean = self.normal[i] - np.eye(3)[i]
            turn = turned(table[:, 3:], v + e - self.line[i])
            e = e + table[:, :3] + lean * q[:, i : i + 1] + turn
            v[:, i] += q[:, i]
            if g is not None:
                e[:, i] -= g * along[:, i]
        for effect in self.effects:
            effect.add(e, q, tool, aside, self.at)
        return e

