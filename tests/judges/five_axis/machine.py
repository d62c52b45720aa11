"""Forward model of a crooked five-axis machine, from the formulas of the field and by hand of another than vpost's.

Written with homogeneous transformations: ISO 230-1 (tables of six functions for each of X Y Z A B C), ISO 230-7 (location
errors of rotary axes), Zhang 2024 (table-table), LinuxCNC's xyzac-trt, xyzbc-trt and 5axiskins (ideal kinematics). mm, rad,
machine frame; rotary axes in degrees where commanded. All functions take n places at once: q (n, 3), rot (n, k), k the rotary
axes in the order of `Machine.rotary`.

    p = M_1^-1 .. M_t^-1 T_1 T_2 T_3 M_a .. M_b t        M_1.. table axes from the workpiece on, M_a.. head axes to the tool
    T(x) = q n + delta(q) + l + R(eps(q)) (x - l)         n: direction with squareness, l: lever to the line measured (here 0)
    M(x) = c + s + delta + L R(eps) Rot(theta) (x - c)              tilt = "body": what it carries leans with the axis
    M(x) = c + s + delta + L R(eps) Rot(theta) L^-1 (x - c)         tilt = "axis": it turns about the leaning line

An axis with play turns by theta + lag, lag the play operator of its commands (`rotary_play`). `table_negative` holds behind a turn
towards minus, `table` then towards plus: where they differ about the axis' own line, that is its play; the rest goes with the side.

A table's centre is in machine coordinates of the tip, a head's in those of the tool (from the gauge point, at angle 0).
"""

import math

import numpy as np

UNIT = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1), "A": (1, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1)}
LOCATIONS = {"A": ("EY0A", "EZ0A", "EB0A", "EC0A"), "B": ("EX0B", "EZ0B", "EA0B", "EC0B"), "C": ("EX0C", "EY0C", "EA0C", "EB0C")}


def turn(vector):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3): Rodrigues' formula, exact."""
    v = np.atleast_2d(np.asarray(vector, float))
    angle = np.linalg.norm(v, axis=1)
    k = np.zeros((len(v), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    k[:, 1, 0], k[:, 2, 0], k[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    small = angle < 1e-12
    a = np.where(small, 1.0, np.sin(angle) / np.where(small, 1.0, angle))
    # 2 sin^2(w/2)/w^2: 1 - cos w would lose digits at small angles.
    b = np.where(small, 0.5, 2 * np.sin(angle / 2) ** 2 / np.where(small, 1.0, angle) ** 2)
    return np.eye(3) + a[:, None, None] * k + b[:, None, None] * (k @ k)


def about(axis, degrees):
    """Rotation by degrees (n,) about a fixed unit vector."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return turn(np.radians(np.asarray(degrees, float))[:, None] * axis)


def times(m, x):
    """m (n or 1, 3, 3) times x (n or 1, 3)."""
    return (m @ x[..., None])[..., 0]


class Machine:
    """`spec`: see generate.py. `perfect`: without errors; `centres`: other centres (those that a control computes with)."""

    def __init__(self, spec, perfect=False, centres=None):
        words = spec["chain"].strip("[] ").split()
        w, t = words.index("w"), words.index("t")
        names = [x for x in words[w + 1 : t] if x != "b"]
        linear = [i for i, x in enumerate(names) if x in "XYZ"]
        first, last = linear[0], linear[-1]
        self.table, self.linear, self.head = names[:first], names[first : last + 1], names[last + 1 :]
        assert sorted(self.linear) == list("XYZ"), spec["chain"]
        self.rotary = self.table + self.head
        self.spec, self.perfect = spec, perfect
        self.direction = {k: np.array(spec["rotary"][k].get("direction", UNIT[k]), float) for k in self.rotary}
        self.direction = {k: v / np.linalg.norm(v) for k, v in self.direction.items()}
        self.centre = {k: np.array((centres or {}).get(k, spec["rotary"][k]["centre"]), float) for k in self.rotary}
        ec0y, eb0z, ea0z = (0, 0, 0) if perfect else np.array(spec["squareness_urad"]) * 1e-6
        self.lean = {"X": np.array([1.0, 0, 0]), "Y": np.array([-ec0y, 1, 0]), "Z": np.array([eb0z, -ea0z, 1])}

    def functions(self, name, at, key="table"):
        """The six error functions (n, 6) of an axis, mm and rad, straight between nodes, constant beyond."""
        table = self.spec["rotary" if name in "ABC" else "axes"][name].get(key)
        if self.perfect or table is None:
            return np.zeros((len(at), 6))
        nodes, rows = np.array(table[0], float), np.array(table[1], float)
        return np.stack([np.interp(at, nodes, rows[:, k]) for k in range(6)], axis=1) * np.array([1e-3] * 3 + [1e-6] * 3)

    def play(self, travel):
        """Half reversal values with the side of each axis along a sequence of commands (n, 3), mm: the play operator."""
        out = np.zeros((len(travel), 3))
        if self.perfect:
            return out
        for i, name in enumerate("XYZ"):
            half = self.spec["axes"][name].get("backlash_um", 0.0) * 0.5e-3
            if half > 0:
                stands = travel[0, i]
                for n, q in enumerate(travel[:, i]):
                    stands = min(max(stands, q - half), q + half)
                    out[n, i] = stands - q
        return out

    def half_width(self, name, degrees):
        """Half the play of a rotary axis (n,), rad: stated, or by how much its two tables differ about its own line."""
        one = self.spec["rotary"][name]
        if self.perfect:
            return np.zeros(len(degrees))
        if "table_negative" in one:
            apart = self.functions(name, degrees, "table_negative") - self.functions(name, degrees)
            return np.maximum(0.5 * apart[:, 3:] @ self.direction[name], 0)
        return np.full(len(degrees), one.get("backlash_urad", 0.0) * 0.5e-6)

    def rotary_play(self, travel):
        """Lag (n, k), rad, and side (n, k; 0 unknown) of the rotary axes along a sequence of commands (n, k), degrees.

        An axis starts in the middle of its play. Its side is that to which it last moved with all play taken up.
        """
        travel = np.atleast_2d(np.asarray(travel, float))
        lag, side = np.zeros(travel.shape), np.zeros(travel.shape, int)
        for k, name in enumerate(self.rotary):
            if self.perfect or not {"backlash_urad", "table_negative"} & set(self.spec["rotary"][name]):
                continue
            command, half = np.radians(travel[:, k]), self.half_width(name, travel[:, k])
            stands, on = command[0], 0
            for n in range(1, len(command)):
                heading = np.sign(command[n] - command[n - 1])
                if heading > 0:
                    stands = max(stands, command[n] - half[n])
                elif heading < 0:
                    stands = min(stands, command[n] + half[n])
                if heading and abs(stands - command[n] + heading * half[n]) < 1e-15 + 1e-12 * abs(command[n]):
                    on = int(heading)
                # The play may be narrower here than where it was taken up.
                lag[n, k], side[n, k] = min(max(stands - command[n], -half[n]), half[n]), on
        return lag, side

    def sided(self, name, degrees, side):
        """The six functions behind turns to these sides (n,), without the play about the axis' own line."""
        up = self.functions(name, degrees)
        if self.perfect or "table_negative" not in self.spec["rotary"][name]:
            return up
        down = self.functions(name, degrees, "table_negative")
        side = np.asarray(side)
        out = np.where((side > 0)[:, None], up, np.where((side < 0)[:, None], down, 0.5 * (up + down)))
        out[:, 3:] += (side * self.half_width(name, degrees))[:, None] * self.direction[name]
        return out

    def rotary_map(self, name, degrees, lag=None, side=None):
        """R (n, 3, 3) and shift (n, 3) of M(x) = R x + shift; `lag`, `side` (n,) as `rotary_play` gives them."""
        nominal = about(self.direction[name], degrees)
        c = self.centre[name]
        if self.perfect:
            return nominal, c - times(nominal, np.broadcast_to(c, (len(degrees), 3)))
        one = self.spec["rotary"][name]
        f = self.sided(name, degrees, np.zeros(len(degrees), int) if side is None else side)
        if lag is not None:
            nominal = about(self.direction[name], np.asarray(degrees) + np.degrees(lag))
        s, lean = np.zeros(3), np.zeros(3)
        for key in LOCATIONS[name]:
            value = one.get("location", {}).get(key, 0.0)
            place = "XYZ".find(key[1])
            if place >= 0:
                s[place] = value * 1e-3
            else:
                lean["ABC".index(key[1])] = value * 1e-6
        tilt = turn(lean)
        r = tilt @ turn(f[:, 3:]) @ nominal
        if one.get("tilt", "body") == "axis":
            r = r @ np.transpose(tilt, (0, 2, 1))
        return r, c + s + f[:, :3] - times(r, np.broadcast_to(c, (len(degrees), 3)))

    def place(self, q, rot, tool, play=None, rotary_play=None):
        """Tip (n, 3) and tool direction (n, 3; from tip to spindle) in the workpiece, which is the machine frame at angles 0.

        `play`: of X Y Z, from `play`; `rotary_play`: lag and side, from `rotary_play`. Without them the means of both ways.
        """
        q, rot = np.atleast_2d(np.asarray(q, float)), np.atleast_2d(np.asarray(rot, float))
        n = len(q)

        def carried(name):
            k = self.rotary.index(name)
            return self.rotary_map(name, rot[:, k], *(() if rotary_play is None else (part[:, k] for part in rotary_play)))

        x = np.broadcast_to(np.asarray(tool, float), (n, 3)).copy()
        d = np.broadcast_to(np.array([0, 0, 1.0]), (n, 3)).copy()
        for name in reversed(self.head):
            r, shift = carried(name)
            x, d = times(r, x) + shift, times(r, d)
        for name in reversed(self.linear):
            at = q[:, "XYZ".index(name)]
            f = self.functions(name, at)
            r = turn(f[:, 3:])
            x = at[:, None] * self.lean[name] + f[:, :3] + times(r, x)
            if play is not None:
                x = x + play[:, "XYZ".index(name)][:, None] * np.array(UNIT[name], float)
            d = times(r, d)
        for name in reversed(self.table):
            r, shift = carried(name)
            back = np.transpose(r, (0, 2, 1))
            x, d = times(back, x - shift), times(back, d)
        return x, d

    def joints(self, tip, rot, tool):
        """What a control with these centres commands X, Y, Z so that the tip is there (n, 3): its own kinematics, perfect."""
        tip, rot = np.atleast_2d(np.asarray(tip, float)), np.atleast_2d(np.asarray(rot, float))
        x = tip.copy()
        for name in self.table:
            r = about(self.direction[name], rot[:, self.rotary.index(name)])
            x = self.centre[name] + times(r, x - self.centre[name])
        t = np.broadcast_to(np.asarray(tool, float), x.shape).copy()
        for name in reversed(self.head):
            r = about(self.direction[name], rot[:, self.rotary.index(name)])
            t = self.centre[name] + times(r, t - self.centre[name])
        return x - t

    def singular(self, rot):
        """How far no turn tips the tool to one side (n,): |n . (a x b)|, the tool's direction and the lines of the two rotary axes
        as the workpiece sees them; the sine of the tilt where these are at right angles. 1 without two rotary axes."""
        rot = np.atleast_2d(np.asarray(rot, float))
        if len(self.rotary) != 2:
            return np.ones(len(rot))

        def seen(v, carried):
            """A direction of what the rotary axes from `carried` on carry, as the workpiece sees it."""
            v = np.broadcast_to(np.asarray(v, float), (len(rot), 3)).copy()
            for name in reversed(carried):
                v = times(about(self.direction[name], (-1 if name in self.table else 1) * rot[:, self.rotary.index(name)]), v)
            return v

        a, b = (seen(self.direction[name], self.rotary[:k]) for k, name in enumerate(self.rotary))
        return np.abs((seen([0, 0, 1.0], self.rotary) * np.cross(a, b)).sum(axis=1))

    def reach(self, q, rot, tool):
        """Arm of each rotary axis (n, k), mm: distance of the tip from the axis' line; what a step of it moves the tip by."""
        q, rot = np.atleast_2d(np.asarray(q, float)), np.atleast_2d(np.asarray(rot, float))
        ideal = Machine(self.spec, perfect=True)
        base = ideal.place(q, rot, tool)[0]
        out = np.zeros(rot.shape)
        for k in range(rot.shape[1]):
            moved = rot.copy()
            moved[:, k] += 0.01
            out[:, k] = np.linalg.norm(ideal.place(q, moved, tool)[0] - base, axis=1) / math.radians(0.01)
        return out
