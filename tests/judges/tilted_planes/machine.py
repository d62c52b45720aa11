"""A crooked five-axis machine with its rotary axes at rest, and the control that commands it. mm, rad, machine frame.

Written from docs/equations.md (5) to (9) and ISO 230-1; nothing is shared with the product, nor with the other judges (the
self-test compares it with `vpost predict` and with `five_axis/machine.py`, which a third hand wrote).

A `spec` is a dictionary, see generate.py. q: axis commands (n, 3); theta: degrees by letter; tool: length in mm.
Frames: the workpiece is the machine frame as it is with all rotary axes at 0.
"""

import math

import numpy as np

LETTER = {"A": (1.0, 0.0, 0.0), "B": (0.0, 1.0, 0.0), "C": (0.0, 0.0, 1.0)}
SENSE_OF_TABLES = -1.0  # of a table the workpiece sees the negative command; the self-test turns this round


def rotation(vector):
    """Rotation matrix of one rotation vector, rad: exp of the cross product."""
    x, y, z = vector
    angle = math.sqrt(x * x + y * y + z * z)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-9:
        return np.eye(3) + cross + cross @ cross / 2
    return np.eye(3) + math.sin(angle) / angle * cross + 2 * (math.sin(angle / 2) / angle) ** 2 * (cross @ cross)


def rotated(vectors, x):
    """exp([v]x) x for many small v (n, 3) and x (n, 3): the series to the fifth power, 1e-20 at a milliradian."""
    out, term = x.copy(), x.copy()
    for k in range(1, 6):
        term = np.cross(vectors, term) / k
        out = out + term
    return out


def parts(chain):
    """(table, linear, head) of a chain, each from the workpiece to the tool."""
    names = [x for x in chain.strip("[] ").split() if x not in "wbt"]
    at = [k for k, x in enumerate(names) if x in "XYZ"]
    return names[: at[0]], names[at[0] : at[-1] + 1], names[at[-1] + 1 :]


class Machine:
    def __init__(self, spec):
        self.spec = spec
        self.table, self.linear, self.head = parts(spec["chain"])
        self.rotary = self.table + self.head
        self.axis = {}
        for k in self.rotary:
            v = np.array(spec["rotary"][k].get("direction") or LETTER[k])
            self.axis[k] = v / np.linalg.norm(v)

    def nominal(self, k, degrees):
        return rotation(self.axis[k] * math.radians(degrees))

    # The control: ideal kinematics with centres of its own.

    def command(self, tip, theta, tool):
        """Axis commands (n, 3) by which the control brings the tip to places (n, 3) of the workpiece."""
        x = np.atleast_2d(tip)
        for k in self.table:
            c = np.array(self.spec["control_centres"][k])
            r = self.nominal(k, -SENSE_OF_TABLES * theta[k])
            x = c + (x - c) @ r.T
        h = np.array([0.0, 0.0, -tool])
        for k in reversed(self.head):
            c = np.array(self.spec["control_centres"][k])
            h = c + self.nominal(k, theta[k]) @ (h - c)
        return x - h

    def direction(self, theta):
        """Direction of the tool, tip to spindle, in the workpiece."""
        d = np.array([0.0, 0.0, 1.0])
        for k in reversed(self.head):
            d = self.nominal(k, theta[k]) @ d
        for k in reversed(self.table):
            d = self.nominal(k, SENSE_OF_TABLES * theta[k]) @ d
        return d

    # The real machine, and the ideal one with the true centres.

    def functions(self, table, at):
        if table is None:
            return np.zeros((len(at), 6))
        nodes, rows = np.array(table[0]), np.array(table[1])
        return np.stack([np.interp(at, nodes, rows[:, k]) for k in range(6)], 1) * np.array([1e-3] * 3 + [1e-6] * 3)

    def rotary_map(self, k, degrees, crooked):
        """R and shift of x -> R x + shift, equation (9)."""
        one = self.spec["rotary"][k]
        c, r = np.array(one["centre"]), self.nominal(k, degrees)
        if not crooked:
            return r, c - r @ c
        f = self.functions(one.get("table"), np.array([degrees]))[0]
        shift, lean = np.zeros(3), np.zeros(3)
        for key, value in one.get("location", {}).items():
            if key[1] in "XYZ":
                shift["XYZ".index(key[1])] += value * 1e-3
            else:
                lean["ABC".index(key[1])] += value * 1e-6
        tilt = rotation(lean)
        whole = tilt @ rotation(f[3:]) @ r
        if one.get("tilt") == "axis":
            whole = whole @ tilt.T
        return whole, c + shift + f[:3] - whole @ c

    def tip(self, q, theta, tool, crooked=True):
        """Where the tip is in the workpiece (n, 3) with axis commands q (n, 3)."""
        q = np.atleast_2d(np.asarray(q, float))
        x = np.array([0.0, 0.0, -tool])
        for k in reversed(self.head):
            r, shift = self.rotary_map(k, theta[k], crooked)
            x = r @ x + shift
        x = np.tile(x, (len(q), 1))
        yx, zx, zy = np.array(self.spec["squareness_urad"]) * (1e-6 if crooked else 0.0)
        lean = {"X": (1, 0, 0), "Y": (-yx, 1, 0), "Z": (zx, -zy, 1)}
        for k in reversed(self.linear):
            at = q[:, "XYZ".index(k)]
            f = self.functions(self.spec["axes"][k].get("table") if crooked else None, at)
            x = at[:, None] * np.array(lean[k], float) + f[:, :3] + rotated(f[:, 3:], x)
        # Of M_1^-1 M_2^-1 .. (T) the axis next to the linear ones comes first.
        for k in reversed(self.table):
            r, shift = self.rotary_map(k, -SENSE_OF_TABLES * theta[k], crooked)
            x = (x - shift) @ r
        return x

    # Angles for a direction.

    def angles(self, normal):
        """The pairs of angles (degrees, -180 to 180, by letter) with which the tool stands along `normal` (unit, workpiece).

        d = E1 E2 z with E1, E2 about the axes from the workpiece on. E2 z must have the share of E1's axis that the normal
        has, which is one equation `p cos + q sin = s` for the second angle; the first is then the turn about its axis from
        E2 z to the normal. An axis along which the tool stands is None: it may stand anywhere.
        """
        one, two = self.rotary
        sense = {k: SENSE_OF_TABLES if k in self.table else 1.0 for k in self.rotary}
        a, b, z = self.axis[one], self.axis[two], np.array([0.0, 0.0, 1.0])
        along = b * (b @ z)
        p, q, s = a @ (z - along), a @ np.cross(b, z), a @ normal - a @ along
        size = math.hypot(p, q)
        if size < 1e-12 or abs(s) > size * (1 + 1e-12):
            return []
        found = []
        for sign in (1, -1):
            second = math.atan2(q, p) + sign * math.acos(max(-1.0, min(1.0, s / size)))
            v = rotation(b * second) @ z
            u, w = v - a * (a @ v), normal - a * (a @ normal)
            first = None if np.linalg.norm(u) < 1e-7 else math.degrees(math.atan2(a @ np.cross(u, w), u @ w)) * sense[one]
            found.append({one: first, two: math.degrees(second) * sense[two]})
        for pair in found:
            for k in pair:
                if pair[k] is not None:
                    pair[k] = (pair[k] + 180.0) % 360.0 - 180.0
        return found

    def aligned(self, normal, stands):
        """Angles that G53.1 turns to by `branch` and `turn` of the profile from `stands`; None where they leave it open."""
        branch, turn = self.spec.get("branch"), self.spec.get("turn")
        pairs = self.angles(normal)
        free = any(v is None for pair in pairs for v in pair.values())
        if free:
            pairs = pairs[:1]
        elif branch:
            pairs = [x for x in pairs if (x[branch[0]] > 0) == (branch[1] == "+")]
        if len(pairs) != 1 or turn is None:
            return None
        out = {}
        for k, v in pairs[0].items():
            if v is None:
                v = stands[k]
            elif turn == "shortest":
                if stands[k] is None:
                    return None
                v += 360.0 * round((stands[k] - v) / 360.0)
            low, high = self.spec["rotary"][k]["travel"]
            if v is None or not low <= v <= high:
                return None
            out[k] = v
        return out
