"""Where the tool is for axis commands: a rigid-body machine with tables for each direction and play.

From the equations of docs/equations.md, (1) to (8), written anew on arrays. Lengths in mm, angles in rad.

Play. Axis i stands at a place x_i of its own; the command q_i pushes it: coming from below it stands at q + a(q), coming
from above at q + b(q), a and b the positioning functions of the two directions. Where b > a there is play, and x follows
the command like a pin in a slot: x <- min(max(x, q + a), q + b) (the play operator, rate independent). Where b <= a there
is no play, and the function of the direction of the last motion holds. w = (x - q - a)/(b - a) says where in the slot it
stands, 0 after motion upwards; straightness and angles, where they differ between the directions, are mixed by w.
A side that nobody knows is the middle, w = 1/2.
"""

import csv
import os
import tomllib

import numpy

AXES = "XYZ"


def monotone_slopes(q, f):
    """Slopes (3) of the monotone cubic."""
    h, s = numpy.diff(q), numpy.diff(f) / numpy.diff(q)
    if len(s) == 1:
        return numpy.array([s[0], s[0]])
    d = numpy.zeros(len(q))
    for k in range(1, len(q) - 1):
        if s[k - 1] * s[k] > 0:
            a, b = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
            d[k] = (a + b) / (a / s[k - 1] + b / s[k])

    def end(h0, h1, s0, s1):
        value = ((2 * h0 + h1) * s0 - h0 * s1) / (h0 + h1)
        if value * s0 <= 0:
            return 0.0
        if s0 * s1 <= 0 and abs(value) > 3 * abs(s0):
            return 3 * s0
        return value

    d[0], d[-1] = end(h[0], h[1], s[0], s[1]), end(h[-1], h[-2], s[-1], s[-2])
    return d


class Table:
    """Six functions of one axis: mm, mm, mm, rad, rad, rad."""

    def __init__(self, path, axis, monotone):
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
        self.q = numpy.array([float(row[0]) for row in rows[1:]])
        self.f = numpy.zeros((6, len(self.q)))
        for column, name in enumerate(rows[0][1:], 1):
            symbol, unit = name.strip().rsplit("_", 1)
            factor = {"um": 1e-3, "urad": 1e-6, "mm": 1.0}[unit]
            k = "XYZABC".index(symbol[1])
            assert symbol == f"E{'XYZABC'[k]}{axis}"
            self.f[k] = [float(row[column]) * factor for row in rows[1:]]
        self.slopes = numpy.array([monotone_slopes(self.q, f) for f in self.f]) if monotone else None

    def __call__(self, at):
        """Values at an array of commands, shape (6, n)."""
        at = numpy.clip(at, self.q[0], self.q[-1])
        k = numpy.clip(numpy.searchsorted(self.q, at, side="right") - 1, 0, len(self.q) - 2)
        h, t = self.q[k + 1] - self.q[k], at - self.q[k]
        s = (self.f[:, k + 1] - self.f[:, k]) / h
        if self.slopes is None:
            return self.f[:, k] + s * t
        d0, d1 = self.slopes[:, k], self.slopes[:, k + 1]
        c2, c3 = (3 * s - 2 * d0 - d1) / h, (d0 + d1 - 2 * s) / (h * h)
        return self.f[:, k] + t * (d0 + t * (c2 + t * c3))


class Machine:
    """Forward model of a profile."""

    def __init__(self, path):
        with open(path, "rb") as file:
            profile = tomllib.load(file)
        folder = os.path.dirname(os.path.abspath(path))
        chain = profile["chain"].strip("[]").split()
        self.order = [AXES.index(name) for name in chain if name in AXES]
        monotone = profile.get("interpolation", "linear") == "monotone"
        self.tables = []
        self.travel = []
        for name in AXES:
            axis = profile["axis"][name]
            plus = Table(os.path.join(folder, axis["errors"]), name, monotone) if "errors" in axis else None
            minus = Table(os.path.join(folder, axis["errors_negative"]), name, monotone) if "errors_negative" in axis else None
            self.tables.append((plus, minus, axis.get("backlash_um", 0.0) * 1e-3))
            self.travel.append((plus.q[0], plus.q[-1]) if plus is not None else tuple(axis["travel_mm"]))
        square = profile.get("squareness", {})
        c, b, a = (square.get(k, 0.0) * 1e-6 for k in ("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"))
        self.directions = numpy.array([[1.0, 0.0, 0.0], [-c, 1.0, 0.0], [b, -a, 1.0]])
        tool = profile.get("tool", {})
        self.default_tool = tuple(tool.get("default_mm", (0.0, 0.0, 0.0)))
        self.lengths = {int(k[1:]): float(v) for k, v in tool.get("lengths_mm", {}).items()}
        self.offsets = {k: tuple(map(float, v)) for k, v in profile["work_offsets_mm"].items()}
        self.dialect, self.tolerance = profile["control"], profile.get("correction", {}).get("tolerance_um", 1.0) * 1e-3
        self.has_play = any(minus is not None or play for _, minus, play in self.tables)

    def sides(self, axis, q):
        """Functions of both directions at an array of commands: (6, n) each, coming from below and from above."""
        plus, minus, play = self.tables[axis]
        below = plus(q) if plus is not None else numpy.zeros((6, len(q)))
        above = minus(q) if minus is not None else below.copy()
        if play:
            below = below.copy()
            below[axis] -= play / 2
            above[axis] += play / 2
        return below, above

    def largest_play(self, axis):
        """Largest difference between the directions, as the tool may feel it, mm."""
        lo, hi = self.travel[axis]
        q = numpy.linspace(lo, hi, 200)
        below, above = self.sides(axis, q)
        d = numpy.abs(above - below).max(axis=1)
        return float(d[:3].max() * 1.8 + d[3:].max() * 400)

    def forward(self, q, w, tool):
        """Tool tips, shape (n, 3), for commands q (n, 3), sides w (n, 3) and a tool vector."""
        p = numpy.tile(numpy.asarray(tool, float), (len(q), 1))
        for axis in reversed(self.order):
            below, above = self.sides(axis, q[:, axis])
            e = below + (above - below) * w[:, axis]
            r = e[3:].T
            turn = numpy.cross(r, p)
            turn = turn + 0.5 * numpy.cross(r, turn)
            p = p + turn + e[:3].T + q[:, axis : axis + 1] * self.directions[axis]
        return p


class Sides:
    """The side of its play on which each axis stands, followed along the commands."""

    def __init__(self, machine, start=None):
        self.machine, self.x, self.q, self.w = machine, [None] * 3, [None] * 3, [0.5] * 3
        self.sure = [False] * 3
        if start:
            for axis in range(3):
                self.place(axis, start[axis])

    def place(self, axis, q):
        """The axis came to a place from nobody knows where."""
        below, above = self.machine.sides(axis, numpy.array([q]))
        self.q[axis], self.w[axis] = q, 0.5
        self.x[axis] = q + 0.5 * (below[axis][0] + above[axis][0])
        self.sure[axis] = below[axis][0] == above[axis][0]

    def lose(self, axis):
        self.q[axis], self.w[axis], self.sure[axis] = None, 0.5, False

    def follow(self, axis, q):
        """Sides w along the commands q (an array, monotone between its places), and whether each is sure."""
        start = 0
        w, sure = numpy.empty(len(q)), numpy.empty(len(q), bool)
        if self.q[axis] is None:
            self.place(axis, q[0])
            w[0], sure[0] = self.w[axis], self.sure[axis]
            start = 1
        below, above = self.machine.sides(axis, q)
        a, b = below[axis], above[axis]
        if not numpy.any(below != above):
            w[:] = 0.5
            sure[:] = True
            self.q[axis] = q[-1]
            return w, sure
        x, before, side, known = self.x[axis], self.q[axis], self.w[axis], self.sure[axis]
        for k in range(start, len(q)):
            at = q[k]
            lo, hi = at + a[k], at + b[k]
            if hi - lo <= 1e-9:
                if at != before:
                    side, known = (0.0 if at > before else 1.0), True
                x = lo + side * (hi - lo)
            else:
                if x <= lo:
                    x, known = lo, known or at > before
                elif x >= hi:
                    x, known = hi, known or at < before
                side = (x - lo) / (hi - lo)
            before = at
            w[k], sure[k] = side, known
        self.x[axis], self.q[axis], self.w[axis], self.sure[axis] = x, before, side, known
        return w, sure
