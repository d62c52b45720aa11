"""The machine as a few lines of arithmetic: where the tool is for an axis command.

Written from the equations of the rigid-body model alone (exact product of transforms along the chain,
rotations by the rotation vector, tables piecewise linear); shares nothing with the product.
Lengths in mm, angles in rad, vectors and matrices as tuples.
"""

import bisect
import csv
import math
import os

ARCSEC_RAD = math.pi / 648000.0
# Factor from a column's unit to mm or rad.
UNITS = {"_um_per_mm": 1e-3, "_urad": 1e-6, "_arcsec": ARCSEC_RAD, "_um": 1e-3, "_mm": 1.0, "_rad": 1.0}
AXES = "XYZ"


class OutsideVolume(Exception):
    """A command beyond the tables by more than the slack that a correction may need."""


def read_table(path, axis):
    """Rows of an error table: positions in mm, and one list of six errors each (mm, mm, mm, rad, rad, rad)."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].lstrip().startswith("#")]
    header = [name.strip() for name in rows[0]]
    if header[0] != "position_mm":
        raise ValueError(f"{path}: first column is {header[0]}, expected position_mm")
    factors = {}
    for column, name in enumerate(header[1:], 1):
        suffix = next((suffix for suffix in UNITS if name.endswith(suffix)), None)
        if suffix is None:
            raise ValueError(f"{path}: column {name} has no known unit")
        factors[name[: -len(suffix)]] = (column, UNITS[suffix])
    wanted = [f"E{direction}{axis}" for direction in "XYZABC"]
    unknown = set(factors) - set(wanted)
    if unknown:
        raise ValueError(f"{path}: unknown columns {sorted(unknown)}")
    positions = [float(row[0]) for row in rows[1:]]
    if any(b <= a for a, b in zip(positions, positions[1:])):
        raise ValueError(f"{path}: positions do not increase")
    errors = []
    for row in rows[1:]:
        errors.append([float(row[factors[name][0]]) * factors[name][1] if name in factors else 0.0 for name in wanted])
    return positions, errors


def rotate(epsilon, v):
    """v turned by the rotation vector epsilon (Rodrigues)."""
    ex, ey, ez = epsilon
    x, y, z = v
    square = ex * ex + ey * ey + ez * ez
    cx, cy, cz = ey * z - ez * y, ez * x - ex * z, ex * y - ey * x
    if square < 1e-24:
        return (x + cx, y + cy, z + cz)
    angle = math.sqrt(square)
    a = math.sin(angle) / angle
    b = 2.0 * math.sin(angle / 2) ** 2 / square
    return (
        x + a * cx + b * (ey * cz - ez * cy),
        y + a * cy + b * (ez * cx - ex * cz),
        z + a * cz + b * (ex * cy - ey * cx),
    )


def linear(table, at, slack):
    """All six errors at a command."""
    positions, errors = table
    if not positions[0] - slack <= at <= positions[-1] + slack:
        raise OutsideVolume(f"{at:.4f} mm is outside {positions[0]} .. {positions[-1]}")
    at = min(max(at, positions[0]), positions[-1])
    k = min(max(bisect.bisect_right(positions, at) - 1, 0), len(positions) - 2)
    t = (at - positions[k]) / (positions[k + 1] - positions[k])
    low, high = errors[k], errors[k + 1]
    return [a + t * (b - a) for a, b in zip(low, high)]


class Machine:
    """Forward model of a profile (the TOML of a machine, or JSON with the same keys)."""

    def __init__(self, profile, folder, slack_mm=1.0):
        self.slack = slack_mm
        chain = profile.get("chain", "[w X Y b Z t]").strip("[] \t").split()
        if chain[0] != "w" or chain[-1] != "t":
            raise ValueError(f"chain {chain} does not run from w to t")
        self.order = [AXES.index(name) for name in chain[1:-1] if name in AXES]
        if sorted(self.order) != [0, 1, 2]:
            raise ValueError(f"chain {chain} does not name X, Y and Z once each")
        if profile.get("effect"):
            raise ValueError("the referee knows no [[effect]]")
        if profile.get("interpolation", "linear") != "linear":
            raise ValueError("the referee interpolates linearly only")
        self.tables, self.about, self.travel = [None] * 3, [(0.0, 0.0, 0.0)] * 3, [(-math.inf, math.inf)] * 3
        for index, name in enumerate(AXES):
            axis = profile.get("axis", {}).get(name, {})
            for key in ("backlash_um", "errors_negative"):
                if axis.get(key):
                    raise ValueError(f"the referee knows no {key}")
            if "errors" in axis:
                self.tables[index] = read_table(os.path.join(folder, axis["errors"]), name)
                positions = self.tables[index][0]
                self.travel[index] = (positions[0], positions[-1])
            elif "travel_mm" in axis:
                self.travel[index] = tuple(axis["travel_mm"])
            at = axis.get("measured_at_mm", {})
            about = list(at.get("tool", (0.0, 0.0, 0.0)))
            for later in self.order[self.order.index(index) + 1 :]:
                about[later] += at.get(AXES[later], 0.0)
            self.about[index] = tuple(about)
        square = profile.get("squareness", {})

        def angle(name):
            return sum(square[key] * UNITS[key[4:]] for key in square if key.startswith(name))

        known = {f"{name}{unit}" for name in ("EC0Y", "EB0Z", "EA0Z") for unit in ("_urad", "_um_per_mm", "_arcsec", "_rad")}
        if set(square) - known:
            raise ValueError(f"unknown squareness {sorted(set(square) - known)}")
        self.directions = [
            (1.0, 0.0, 0.0),
            (-angle("EC0Y"), 1.0, 0.0),
            (angle("EB0Z"), -angle("EA0Z"), 1.0),
        ]
        tool = profile.get("tool", {})
        self.default_tool = tuple(float(v) for v in tool.get("default_mm", (0.0, 0.0, 0.0)))
        self.lengths = dict(tool.get("lengths_mm", {}))
        self.offsets = {name: tuple(v) for name, v in profile.get("work_offsets_mm", {}).items()}

    def tool_vector(self, name):
        """From the gauge line to the tip, with the tool of an H word, or without one."""
        if name is None:
            return self.default_tool
        value = self.lengths[name]
        return (0.0, 0.0, -float(value)) if isinstance(value, (int, float)) else tuple(-float(v) for v in value)

    def forward(self, command, tool):
        """Tool tip for an axis command, machine coordinates."""
        p = tool
        for index in reversed(self.order):
            n, q, table = self.directions[index], command[index], self.tables[index]
            if table is not None:
                e = linear(table, q, self.slack)
                m = self.about[index]
                # The errors were read at m beyond the axis: turned about that point, moved by the table.
                r = rotate(e[3:], (p[0] - m[0], p[1] - m[1], p[2] - m[2]))
                p = (r[0] + m[0] + e[0], r[1] + m[1] + e[1], r[2] + m[2] + e[2])
            p = (p[0] + q * n[0], p[1] + q * n[1], p[2] + q * n[2])
        return p

    def clamp(self, command):
        """The nearest command inside the calibrated volume."""
        return tuple(min(max(q, low), high) for q, (low, high) in zip(command, self.travel))

    def inside(self, command):
        """True inside the calibrated volume."""
        return all(low <= q <= high for q, (low, high) in zip(command, self.travel))
