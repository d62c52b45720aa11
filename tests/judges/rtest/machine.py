"""Five-axis machines with errors, exact: written from docs/equations.md (5) to (9) for this judge, by another hand than the code's.

mm, rad; rotary commands in degrees. n places at once: q (n, 3), rot (n, k), tool (n, 3), k the rotary axes in the order of the chain.

    p = M_1^-1 .. M_t^-1 T_1 T_2 T_3 M_a .. t        tables from the workpiece on, linear axes, heads
    T(x) = q n + delta + R(eps) x                    linear axis, measured with the others at 0
    M(x) = c + s + delta + L R(eps) Rot(theta) (x - c)          `body`; `axis`: L R Rot L^-1

The errors of a rotary axis are four locations (s, L) and six functions (delta, eps) of its angle. Both are arguments of `tip`, so that
the least squares of reference.py can move them.
"""

import csv
import math
import os
import tomllib

import numpy as np

LETTER = {"X": (1.0, 0, 0), "Y": (0, 1.0, 0), "Z": (0, 0, 1.0), "A": (1.0, 0, 0), "B": (0, 1.0, 0), "C": (0, 0, 1.0)}
LOCATIONS = {"A": ("EY0A", "EZ0A", "EB0A", "EC0A"), "B": ("EX0B", "EZ0B", "EA0B", "EC0B"), "C": ("EX0C", "EY0C", "EA0C", "EB0C")}
SCALE = np.array([1e-3] * 3 + [1e-6] * 3)  # um and urad to mm and rad


def place(name):
    """Which of the six (X Y Z A B C) a location error shifts or turns: EB0A is 4."""
    return "XYZABC".index(name[1])


def unit(name):
    return "um" if name[1] in "XYZ" else "urad"


def exp(v):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3)."""
    v = np.asarray(v, float)
    angle = np.sqrt((v * v).sum(1))
    safe = np.where(angle < 1e-14, 1.0, angle)
    k = np.zeros((len(v), 3, 3))
    k[:, 1, 0], k[:, 2, 0], k[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    k -= np.transpose(k, (0, 2, 1))
    return np.eye(3) + np.where(angle < 1e-14, 1.0, np.sin(safe) / safe)[:, None, None] * k + (2 * (np.sin(safe / 2) / safe) ** 2)[:, None, None] * (k @ k)


def apply(m, x):
    return np.einsum("nij,nj->ni", m, x)


def interpolate(kind, nodes, values, at):
    """Functions (n, 6) between nodes: straight, or the monotone cubic of (2) and (3); constant beyond."""
    nodes, values, at = np.asarray(nodes, float), np.asarray(values, float), np.clip(at, nodes[0], nodes[-1])
    if kind == "linear" or len(nodes) < 3:
        return np.stack([np.interp(at, nodes, values[:, j]) for j in range(6)], axis=1)
    h, s = np.diff(nodes), np.diff(values, axis=0) / np.diff(nodes)[:, None]
    d = np.zeros_like(values)
    a, b = (2 * h[1:] + h[:-1])[:, None], (h[1:] + 2 * h[:-1])[:, None]
    same = s[:-1] * s[1:] > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        d[1:-1] = np.where(same, (a + b) / (a / s[:-1] + b / s[1:]), 0)
    for end, near, far, h0, h1 in ((0, s[0], s[1], h[0], h[1]), (-1, s[-1], s[-2], h[-1], h[-2])):
        slope = ((2 * h0 + h1) * near - h0 * far) / (h0 + h1)
        slope = np.where(slope * near <= 0, 0, slope)
        d[end] = np.where((near * far <= 0) & (np.abs(slope) > 3 * np.abs(near)), 3 * near, slope)
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(h) - 1)
    t, w = (at - nodes[i])[:, None], h[i][:, None]
    return values[i] + t * (d[i] + t * ((3 * s[i] - 2 * d[i] - d[i + 1]) / w + t * (d[i] + d[i + 1] - 2 * s[i]) / w**2))


class Machine:
    """`spec`: chain, axes {X: {table}}, squareness_urad, rotary {A: {centre, tilt, direction, location, function}}.

    `function(degrees)` gives the six functions (n, 6) in um and urad; `table` is (kind, nodes, rows of six).
    """

    def __init__(self, spec):
        words = spec["chain"].strip("[] ").split()
        names = [w for w in words if w not in "wbt"]
        linear = [i for i, n in enumerate(names) if n in "XYZ"]
        self.table, self.linear, self.head = names[: linear[0]], names[linear[0] : linear[-1] + 1], names[linear[-1] + 1 :]
        self.rotary = self.table + self.head
        self.spec = spec
        self.direction = {}
        for name in self.rotary:
            v = np.array(spec["rotary"][name].get("direction", LETTER[name]), float)
            self.direction[name] = v / np.linalg.norm(v)

    def about(self, name, degrees):
        return exp(np.radians(degrees)[:, None] * self.direction[name])

    def location(self, name):
        """The four location errors as six numbers, mm and rad."""
        six = np.zeros(6)
        for key, value in self.spec["rotary"][name].get("location", {}).items():
            six[place(key)] = value * SCALE[place(key)]
        return six

    def functions(self, name, degrees):
        f = self.spec["rotary"][name].get("function")
        return np.zeros((len(degrees), 6)) if f is None else f(degrees) * SCALE

    def tip(self, q, rot, tool, ideal=False, located=None, more=None):
        """Tip in the workpiece (n, 3). `located` {axis: six}, `more` {axis: (n, 6)}: added to locations and functions, mm and rad."""
        q, rot, x = np.asarray(q, float), np.asarray(rot, float), np.array(tool, float)
        n = len(q)

        def carried(name):
            k = self.rotary.index(name)
            turn, c = self.about(name, rot[:, k]), np.array(self.spec["rotary"][name]["centre"], float)
            if ideal:
                return turn, c - apply(turn, np.tile(c, (n, 1)))
            at = self.location(name) + (0 if located is None else located.get(name, 0))
            f = self.functions(name, rot[:, k]) + (0 if more is None else more.get(name, 0))
            lean = exp(at[None, 3:])
            turn = lean @ exp(f[:, 3:]) @ turn
            if self.spec["rotary"][name].get("tilt", "body") == "axis":
                turn = turn @ np.transpose(lean, (0, 2, 1))
            return turn, c + at[:3] + f[:, :3] - apply(turn, np.tile(c, (n, 1)))

        for name in reversed(self.head):
            turn, shift = carried(name)
            x = apply(turn, x) + shift
        ec0y, eb0z, ea0z = np.array(self.spec.get("squareness_urad", (0, 0, 0))) * 1e-6
        lean = {"X": (1, 0, 0), "Y": (-ec0y, 1, 0), "Z": (eb0z, -ea0z, 1)}
        for name in reversed(self.linear):
            at = q[:, "XYZ".index(name)][:, None]
            table = self.spec["axes"][name].get("table")
            if ideal or table is None:
                x = x + at * np.array(LETTER[name] if ideal else lean[name])
            else:
                f = interpolate(*table, at[:, 0]) * SCALE
                x = apply(exp(f[:, 3:]), x) + at * np.array(lean[name]) + f[:, :3]
        for name in reversed(self.table):
            turn, shift = carried(name)
            x = apply(np.transpose(turn, (0, 2, 1)), x - shift)
        return x

    def error(self, q, rot, tool, **more):
        return self.tip(q, rot, tool, **more) - self.tip(q, rot, tool, ideal=True)

    def command(self, tip, rot, tool, ideal=True):
        """X, Y, Z (n, 3) that bring the tip there: an ideal control's, or those of the machine as it is."""
        tip, rot = np.asarray(tip, float), np.asarray(rot, float)
        x = tip.copy()
        for name in self.table:
            turn, c = self.about(name, rot[:, self.rotary.index(name)]), np.array(self.spec["rotary"][name]["centre"], float)
            x = c + apply(turn, x - c)
        t = np.array(tool, float)
        for name in reversed(self.head):
            turn, c = self.about(name, rot[:, self.rotary.index(name)]), np.array(self.spec["rotary"][name]["centre"], float)
            t = c + apply(turn, t - c)
        q = x - t
        for _ in range(0 if ideal else 8):
            off = self.tip(q, rot, tool) - tip
            for name in self.table:
                off = apply(self.about(name, rot[:, self.rotary.index(name)]), off)
            q = q - off
        return q


def read_table(path, letter):
    """(nodes, rows of six in um and urad) of an error table."""
    factor = {"um": 1, "mm": 1e3, "urad": 1, "um_per_mm": 1e3, "arcsec": math.pi / 648000 * 1e6}
    with open(path, encoding="utf-8-sig") as file:
        rows = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    head = [c.strip() for c in rows[0]]
    data = np.array([[float(v) for v in row] for row in rows[1:]])
    out = np.zeros((len(data), 6))
    for j, column in enumerate(head[1:], 1):
        name, suffix = column.split("_", 1)
        assert name[0] == "E" and name[2:] == letter, column
        out[:, "XYZABC".index(name[1])] = data[:, j] * factor[suffix]
    return data[:, 0], out


def of_profile(path):
    """The machine that a profile says, as far as the rotary axes, the linear tables and squareness go; anything else that would matter is an error."""
    with open(path, "rb") as file:
        profile = tomllib.load(file)
    unknown = set(profile) - {"format", "name", "control", "chain", "interpolation", "calibrated", "axis", "rotary", "squareness", "tool", "work_offsets_mm", "correction", "kinematics", "program"}
    assert not unknown, f"the profile says {sorted(unknown)}"
    folder, kind = os.path.dirname(path), profile.get("interpolation", "linear")
    spec = {"chain": profile["chain"], "axes": {}, "rotary": {}}
    spec["squareness_urad"] = [profile.get("squareness", {}).get(k, 0.0) for k in ("EC0Y_urad", "EB0Z_urad", "EA0Z_urad")]
    for name, one in profile.get("axis", {}).items():
        spec["axes"][name] = {"travel": one.get("travel_mm")}
        if "errors" in one:
            spec["axes"][name]["table"] = (kind, *read_table(os.path.join(folder, one["errors"]), name))
    for name, one in profile.get("rotary", {}).items():
        out = {"centre": one.get("centre_mm", [0, 0, 0]), "tilt": one.get("tilt", "body"), "travel": one.get("travel_deg")}
        if "direction" in one:
            out["direction"] = one["direction"]
        out["location"] = {k: one.get(f"{k}_{unit(k)}", 0.0) for k in LOCATIONS[name]}
        if "errors" in one:
            nodes, rows = read_table(os.path.join(folder, one["errors"]), name)
            out["nodes"] = nodes
            out["function"] = lambda at, nodes=nodes, rows=rows: interpolate(kind, nodes, rows, at)
        spec["rotary"][name] = out
    for axis in "XYZ":
        spec["axes"].setdefault(axis, {})
    return Machine(spec)
