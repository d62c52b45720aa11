"""Machines for the judge of frames: random crooked profiles, and their error by the documented equations.

Judges nothing by itself. The error is that of equations (5) to (8) of docs/equations.md, with the first-order
rotation (the angles here are below 0.2 mrad, so the second order is some nanometres):

    e <- e + delta_i + (n_i - e_i) q_i + R_i x (v + e - l_i),    v <- v + q_i e_i,    from the tool to the workpiece

`Machine.limit` is the size a correction may have: 1.5 times the largest error per axis on a grid over the whole volume,
for every tool, plus the output's rounding. Frames are wrong by millimetres, so a generous limit costs nothing.
"""

import bisect
import os

from common.profile import Profile

AXES = "XYZ"
ROUNDING_MM = 0.006          # half a step of 0.001 mm or 0.0001 inch, split pieces, arcs' centres
FACTOR = 1.5
KEEPS = '[program]\ntool_change = { keeps = "XYZ" }\n'


class Machine:
    """A profile: travels, tables, squareness, tools, work offsets; written as TOML and CSV by `write`."""

    def __init__(self, random, index, keeps=False):
        self.keeps = keeps                    # [program] tool_change: M6 leaves every axis where it stands
        self.name = f"judge-{index}"
        self.travel = random.choice([
            {"X": (-700.0, 0.0), "Y": (-450.0, 0.0), "Z": (-520.0, 0.0)},
            {"X": (0.0, 700.0), "Y": (0.0, 450.0), "Z": (0.0, 520.0)},
        ])
        corner = {a: self.travel[a][0] for a in AXES}
        place = lambda x, y, z: [corner["X"] + x, corner["Y"] + y, corner["Z"] + z]
        self.offsets = {"G54": place(280.0, 190.0, 120.0), "G55": place(140.0, 250.0, 131.5), "G56": place(400.0, 170.0, 105.0),
                        "G57": place(310.0, 215.0, 125.0), "G54.1P1": place(222.0, 240.0, 118.0), "G505": place(250.0, 210.0, 123.0)}
        self.lengths = {1: 120.0, 2: 85.5, 3: 150.0}
        self.default_tool = [0.0, 0.0, -100.0]
        self.home = [0.0, 0.0, 0.0] if corner["X"] < 0 else [0.0, 450.0, 520.0]
        self.square = {k: random.uniform(-150, 150) for k in ("EC0Y", "EB0Z", "EA0Z")}
        self.tables = {}
        for axis in AXES:
            low, high = self.travel[axis]
            nodes = [low + (high - low) * k / 6 for k in range(7)]
            um = random.uniform(8, 35)
            self.tables[axis] = [(q, [random.uniform(-um, um) for _ in range(3)] + [random.uniform(-80, 80) for _ in range(3)])
                                 for q in nodes]
        self._nodes = {a: [row[0] for row in self.tables[a]] for a in AXES}
        self._limit = None

    def row(self, axis, q):
        """Interpolates the table of one axis linearly; outside, the end's values. In mm and rad."""
        nodes, rows = self._nodes[axis], self.tables[axis]
        if q <= nodes[0]:
            values = rows[0][1]
        elif q >= nodes[-1]:
            values = rows[-1][1]
        else:
            k = bisect.bisect_right(nodes, q) - 1
            t = (q - nodes[k]) / (nodes[k + 1] - nodes[k])
            values = [a + t * (b - a) for a, b in zip(rows[k][1], rows[k + 1][1])]
        return [v * 1e-3 for v in values[:3]], [v * 1e-6 for v in values[3:]]

    def error(self, q, tool):
        """Real minus ideal tool position, mm, at the axis command q with the tool vector `tool`."""
        ec, eb, ea = (self.square[k] * 1e-6 for k in ("EC0Y", "EB0Z", "EA0Z"))
        lean = [(0.0, 0.0, 0.0), (-ec, 0.0, 0.0), (eb, -ea, 0.0)]
        e, v = [0.0, 0.0, 0.0], list(tool)
        for i in (2, 1, 0):
            delta, r = self.row(AXES[i], q[i])
            x = [v[k] + e[k] for k in range(3)]
            turn = (r[1] * x[2] - r[2] * x[1], r[2] * x[0] - r[0] * x[2], r[0] * x[1] - r[1] * x[0])
            e = [e[k] + delta[k] + lean[i][k] * q[i] + turn[k] for k in range(3)]
            v[i] += q[i]
        return e

    def limit(self):
        """Largest admissible |corrected - programmed| per axis, mm."""
        if self._limit is None:
            largest = [0.0, 0.0, 0.0]
            tools = [self.default_tool] + [[0.0, 0.0, -v] for v in self.lengths.values()]
            grid = [[self.travel[a][0] + (self.travel[a][1] - self.travel[a][0]) * k / 6 for k in range(7)] for a in AXES]
            for tool in tools:
                for x in grid[0]:
                    for y in grid[1]:
                        for z in grid[2]:
                            e = self.error((x, y, z), tool)
                            largest = [max(m, abs(c)) for m, c in zip(largest, e)]
            self._limit = [FACTOR * m + ROUNDING_MM for m in largest]
        return self._limit

    def write(self, folder, control, extra=""):
        """Writes the profile into `folder`; gives its path. `extra` is TOML that is appended."""
        os.makedirs(folder, exist_ok=True)
        profile = Profile(str(self.name), control, "[w X Y b Z t]")
        for axis in AXES:
            profile.axis(axis)["travel_mm"] = self.travel[axis]
            profile.errors(axis, *zip(*self.tables[axis]))
        profile["squareness"].update({f"{k}_urad": v for k, v in self.square.items()})
        profile["tool"].update(default_mm=self.default_tool, lengths_mm={f"H{h}": v for h, v in self.lengths.items()})
        profile["work_offsets_mm"].update(self.offsets)
        path = str(profile.write(folder, f"{self.name}-{control}.toml"))
        if self.keeps or extra:
            with open(path, "a", encoding="utf-8") as file:
                file.write((KEEPS if self.keeps else "") + extra)
        return path
