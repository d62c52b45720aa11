"""A crooked five-axis machine and its control, as 4x4 matrices. mm, degrees, the machine frame.

Written from docs/equations.md (5) to (9): chain, tables, location errors, squareness. The frame of the workpiece is the
machine frame with all rotary axes at 0. Rotary axes stand still while the tool moves.
"""

import math

import numpy as np

AXES = {"A": (1.0, 0.0, 0.0), "B": (0.0, 1.0, 0.0), "C": (0.0, 0.0, 1.0)}
TABLE_SIGN = -1.0  # a positive command of a table's axis turns the tool, seen from the workpiece, the other way


def turn(axis, degrees):
    """4x4 of a turn about a direction through the origin."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out = np.eye(4)
    out[:3, :3] = np.eye(3) + s * k + (1 - c) * k @ k
    return out


def shift(v):
    out = np.eye(4)
    out[:3, 3] = v
    return out


def small(v):
    """4x4 of a rotation vector in rad."""
    size = float(np.linalg.norm(v))
    return np.eye(4) if size < 1e-15 else turn(v, math.degrees(size))


def put(m, points):
    return points @ m[:3, :3].T + m[:3, 3]


class Machine:
    def __init__(self, spec):
        self.spec = spec
        names = [k for k in spec["chain"].strip("[] ").split() if k not in ("w", "b", "t")]
        first = min(k for k, x in enumerate(names) if x in "XYZ")
        last = max(k for k, x in enumerate(names) if x in "XYZ")
        self.table, self.linear, self.head = names[:first], names[first : last + 1], names[last + 1 :]
        self.rotary = self.table + self.head

    def direction_of(self, k):
        return self.spec["rotary"][k].get("direction", AXES[k])

    # -- ideal ---------------------------------------------------------------------------------------------------

    def ideal(self, k, degrees, centres):
        c = np.array(centres[k], float)
        return shift(c) @ turn(self.direction_of(k), degrees) @ shift(-c)

    def chain(self, theta, centres, names):
        out = np.eye(4)
        for k in names:
            out = out @ self.ideal(k, theta[k] * (TABLE_SIGN if k in self.table else 1.0), centres)
        return out

    def command(self, place, theta, length):
        """Axis commands by which the control brings the tip to places (n, 3) of the workpiece."""
        centres = self.spec["control"]
        tool = put(self.chain(theta, centres, self.head), np.array([[0.0, 0.0, -length]]))
        return put(np.linalg.inv(self.chain(theta, centres, self.table)), place) - tool

    def upright(self, theta):
        """Direction of the tool from the tip up, in the workpiece."""
        none = {k: (0, 0, 0) for k in self.rotary}
        return (self.chain(theta, none, self.table) @ self.chain(theta, none, self.head))[:3, 2]

    # -- real ----------------------------------------------------------------------------------------------------

    def functions(self, table, at):
        if not table:
            return np.zeros((len(at), 3)), np.zeros((len(at), 3))
        rows = np.array(table["rows"])
        f = np.stack([np.interp(at, table["at"], rows[:, k]) for k in range(6)], axis=1)
        return f[:, :3] * 1e-3, f[:, 3:] * 1e-6

    def real(self, k, degrees):
        """Equation (9): c + s + d + L R(e) Rot (x - c), or with L about the leaning line."""
        one = self.spec["rotary"][k]
        d, e = self.functions(one.get("table"), np.array([degrees]))
        s, lean = np.zeros(3), np.zeros(3)
        for name, value in one.get("location", {}).items():
            if name[1] in "XYZ":
                s["XYZ".index(name[1])] = value * 1e-3
            else:
                lean["ABC".index(name[1])] = value * 1e-6
        c, tilt = np.array(one["centre"], float), small(lean)
        body = tilt @ small(e[0]) @ turn(self.direction_of(k), degrees)
        if one.get("tilt") == "axis":
            body = body @ np.linalg.inv(tilt)
        return shift(c + s + d[0]) @ body @ shift(-c)

    def tip(self, q, theta, length):
        """Where the real tip is in the workpiece for commands (n, 3)."""
        x = np.array([[0.0, 0.0, -length]])
        for k in reversed(self.head):
            x = put(self.real(k, theta[k]), x)
        x = np.repeat(x, len(q), axis=0)
        lean = self.spec["squareness"]
        n = {"X": (1, 0, 0), "Y": (-lean["EC0Y"] * 1e-6, 1, 0), "Z": (lean["EB0Z"] * 1e-6, -lean["EA0Z"] * 1e-6, 1)}
        for k in reversed(self.linear):
            at = q[:, "XYZ".index(k)]
            d, e = self.functions(self.spec["linear"][k].get("table"), at)
            # Rodrigues, for a vector of its own in each row.
            size = np.linalg.norm(e, axis=1)[:, None]
            cross = np.cross(e, x)
            a = np.where(size < 1e-9, 1.0, np.sin(size) / np.maximum(size, 1e-9))
            b = np.where(size < 1e-9, 0.5, (1 - np.cos(size)) / np.maximum(size, 1e-9) ** 2)
            x = at[:, None] * np.array(n[k], float) + d + x + a * cross + b * np.cross(e, cross)
        for k in reversed(self.table):
            # A table's own motion carries the workpiece by its command; the workpiece sees the inverse.
            x = put(np.linalg.inv(self.real(k, -TABLE_SIGN * theta[k])), x)
        return x

    # -- angles of a plane ---------------------------------------------------------------------------------------

    def ways(self, normal):
        """Both pairs of angles with which the tool stands along a normal; none at the pole, where one of them is free."""
        one, two = self.rotary
        sign = {k: TABLE_SIGN if k in self.table else 1.0 for k in self.rotary}
        a, b = (np.array(self.direction_of(k), float) / np.linalg.norm(self.direction_of(k)) for k in self.rotary)
        z = np.array([0.0, 0.0, 1.0])
        # n . a = (Rot(b, beta) z) . a:  k + p cos beta + q sin beta
        k0, p, q = (b @ z) * (a @ b), a @ z - (b @ z) * (a @ b), a @ np.cross(b, z)
        size, rest = math.hypot(p, q), normal @ a - k0
        if size < 1e-9 or abs(rest) > size:
            return []
        out = []
        for side in (1.0, -1.0):
            beta = math.degrees(math.atan2(q, p) + side * math.acos(rest / size))
            v = turn(b, beta)[:3, :3] @ z
            flat_v, flat_n = v - a * (a @ v), normal - a * (a @ normal)
            if np.linalg.norm(flat_v) < 1e-6:
                return []
            alpha = math.degrees(math.atan2(a @ np.cross(flat_v, flat_n), flat_v @ flat_n))
            pair = {one: alpha * sign[one], two: beta * sign[two]}
            # Above -180 and up to 180 but for rounding, as the profile's `principal`.
            out.append({k: 180.0 - (180.0 - x + 1e-9) % 360.0 + 1e-9 for k, x in pair.items()})
        return out

    def swivelled(self, normal, way, stands):
        """Angles that the control turns to: the lower or the higher value of the reference axis, whole turns by `turn`."""
        pairs = self.ways(normal)
        if len(pairs) != 2:
            return None
        reference = self.spec["reference"]
        low, high = sorted(pairs, key=lambda x: x[reference])
        out = dict(low if way < 0 else high)
        for k in out:
            if self.spec["turn"] == "shortest":
                if stands.get(k) is None:
                    return None
                out[k] += 360.0 * round((stands[k] - out[k]) / 360.0)
            travel = self.spec["rotary"][k]["travel"]
            if not travel[0] <= out[k] <= travel[1]:
                return None
        return out
