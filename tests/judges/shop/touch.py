"""The shop: finds a zero by touching on the crooked machine with correction off, and writes down what the control holds.

A touch leads a ball (or a tool's tip) against a face square to one axis of the machine as the table stands. The commands
are on the control's grid, and the face is where they meet it: so the offset is exact, and the true place is not round.
"""

import math

import numpy as np

KINDS = ("corner", "faces", "one-place", "bore", "in-part", "true")


class Datum:
    def __init__(self, name, at, kind):
        self.name, self.at, self.kind, self.zero = name, [round(float(v), 3) for v in at], kind, "touched"
        self.touched_at, self.angles, self.unsaid = None, {}, 0.0
        self.error = np.zeros(3)  # of the touches, along the machine's axes: real less perfect
        self.sideways = np.zeros(3)  # what the play at the touches adds to it
        self.told = set()  # axes of which the profile says from which side they were touched

    def place(self, machine):
        """The zero on a perfect machine, in the workpiece."""
        return machine.in_workpiece(self.angles, np.array([self.at]))[0]

    def real(self, machine):
        """The physical zero in the workpiece, and, with play, where it lies for who does not know the touches' senses."""
        middle = [v if n in self.told else 0.0 for n, v in enumerate(self.sideways)]
        found = [self.error + self.sideways] + ([self.error + middle] if (middle != self.sideways).any() else [])
        return [self.place(machine) + machine.in_workpiece(self.angles, e[None], vector=True)[0] for e in found]

    def said(self, plain):
        """What stands in the profile."""
        if plain:
            return self.at
        return {"at": self.at, "zero": self.zero} | ({"touched_at": self.touched_at} if self.touched_at else {})


def probe(rng, spec):
    """(vector, how the profile may say it)"""
    way = rng.choice(("tool", "length", "vector"))
    if way == "tool":
        name = rng.choice(("H1", "H2"))
        return [0.0, 0.0, -spec["lengths"][name]], name
    length = round(rng.uniform(40, 160), 3)
    if way == "length":
        return [0.0, 0.0, -length], length
    vector = [round(rng.uniform(-12, 12), 3), round(rng.uniform(-12, 12), 3), -length]
    return vector, vector


def touch(machine, datum, axis, q, tool, sense):
    """One touch along an axis at commands q: its error counts for that axis of the zero."""
    datum.error[axis] = machine.error(np.array([q]), datum.angles, tool)[0][axis]
    half = machine.spec["play"].get("XYZ"[axis], 0.0) * 0.5e-3
    datum.sideways[axis] = -half * sense


def face(rng, machine, datum, axis):
    """A face touched somewhere along itself; Z with a tool on the top, or on a setter whose height is known."""
    tool, said = probe(rng, machine.spec)
    sense = -1 if axis == 2 else rng.choice((-1, 1))
    ball = round(rng.uniform(0.5, 5), 3) if axis < 2 else rng.choice((0.0, 50.0))
    wide = 220 if axis == 2 and ball else 70
    tip = [datum.at[n] + round(rng.uniform(-wide, wide), 3) for n in (0, 1)] + [datum.at[2] - round(rng.uniform(2, 20), 3)]
    tip[axis] = datum.at[axis] - sense * ball
    q = [round(v - t, 3) for v, t in zip(tip, tool)]
    touch(machine, datum, axis, q, tool, sense)
    if "XYZ"[axis] in machine.spec["play"] and rng.random() < 0.5:
        datum.told.add(axis)
        return {"at": q, "tool": said, "direction": sense}
    return {"at": q, "tool": said}


def bore(rng, machine, datum, walls):
    """The centre of a bore by four touches: X at first, then Y in the middle of these. What the profile says: its middle, or walls."""
    tool, tool_said = probe(rng, machine.spec)
    gap = rng.uniform(8, 30)
    depth = datum.at[2] - round(rng.uniform(2, 15), 3) - tool[2]
    centre = np.array([datum.at[0] - tool[0], datum.at[1] - tool[1], depth])
    ideal = centre + tool
    true = ideal[:2] + machine.error(centre[None], datum.angles, tool)[0][:2] + [rng.uniform(-4e-4, 4e-4), rng.uniform(-4e-4, 4e-4)]

    def meets(axis, sign):
        q = centre.copy()
        for _ in range(8):
            tip = (q + tool + machine.error(q[None], datum.angles, tool)[0])[:2]
            aside = tip[1 - axis] - true[1 - axis]
            q[axis] += true[axis] + sign * math.sqrt(gap**2 - aside**2) - tip[axis]
        return q[axis]

    said, found = [], np.zeros(2)
    for axis in (0, 1):
        ends = [meets(axis, sign) for sign in (-1, 1)]
        centre[axis] = sum(ends) / 2
        datum.at[axis] = round(float(centre[axis] + tool[axis]), 3)
        said.append([[round(float(e if n == axis else v), 3) for n, v in enumerate(centre)] for e in ends])
    middle = [round(float(v), 3) for v in centre]
    for axis in (0, 1):
        places = np.array(said[axis] if walls else [middle])
        found[axis] = machine.error(places, datum.angles, tool)[:, axis].mean()
    datum.error[:2] = true - datum.at[:2]
    datum.unsaid = float(np.linalg.norm(datum.error[:2] - found))
    return [{"at": said[axis] if walls else middle, "tool": tool_said} for axis in (0, 1)]


def offset(rng, machine, name, kind, place, angles):
    """Touches off one zero of that kind near a place (commands of the tip)."""
    datum = Datum(name, place, kind)
    datum.angles = angles
    turned = {"rotary_deg": dict(angles)} if angles else {}
    senses = [rng.choice((-1, 1)), rng.choice((-1, 1)), -1]
    if kind == "true":
        datum.zero, datum.angles = "true", {}
    elif kind == "corner":
        for axis in range(3):
            touch(machine, datum, axis, datum.at, [0.0, 0.0, 0.0], senses[axis])
    elif kind == "one-place":
        tool = rng.choice(("H1", "H2"))
        vector = [0.0, 0.0, -machine.spec["lengths"][tool]]
        q = [round(v - t, 3) for v, t in zip(datum.at, vector)]
        for axis in range(3):
            touch(machine, datum, axis, q, vector, senses[axis])
        datum.touched_at = {"at": q, "tool": tool, **turned}
    elif kind == "bore":
        there = bore(rng, machine, datum, rng.random() < 0.5)
        datum.touched_at = {k: {**v, **turned} for k, v in zip("XYZ", [*there, face(rng, machine, datum, 2)])}
    else:
        axes = (0, 1, 2) if kind == "faces" else rng.choice(((0, 2), (2,), (0, 1)))
        datum.touched_at = {"XYZ"[n]: {**face(rng, machine, datum, n), **turned} for n in axes}
        for axis in {0, 1, 2} - set(axes):
            touch(machine, datum, axis, datum.at, [0.0, 0.0, 0.0], senses[axis])
    return datum
