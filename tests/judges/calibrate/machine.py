"""The true machine: smooth functions, exact rigid-body product, written from docs/equations.md (5) to (9) alone.

Lengths in mm, angles in rad, everything over arrays of commands (n, 3). A machine is
  order      chain order of the linear axes, workpiece side first, for example (0, 1, 2)
  functions  per axis a list of callables f(q) -> (n, 6): EX EY EZ EA EB EC of that axis; they add up
  play       per axis the full reversal value B (the carriage coming from below stands short by B/2)
  measured   per axis {other axis: place} and a tool, as `measured_at_mm`
  square     EC0Y, EB0Z, EA0Z
  scale      per axis a relative scale error (the effect scale.X), counted from machine zero
  warm       the effect thermal.X of 11.5 um/m/K, and the machine stands at 24 instead of 20 degrees
  table/head lists of Rotary, in chain order
The same class stands for the truth, for the base profile that the judge writes, and for the judge's own reference fits.
"""

import copy

import numpy

from common.profile import Profile

AXES = "XYZ"
EXPANSION = 11.5e-6


def rotation(vectors):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3)."""
    vectors = numpy.atleast_2d(vectors)
    angle = numpy.linalg.norm(vectors, axis=1)
    x, y, z = vectors.T
    zero = numpy.zeros_like(x)
    cross = numpy.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    small = angle < 1e-7
    safe = numpy.where(small, 1.0, angle)
    a = numpy.where(small, 1.0, numpy.sin(safe) / safe)
    b = numpy.where(small, 0.5, 2.0 * numpy.sin(safe / 2) ** 2 / safe**2)
    return numpy.eye(3) + a[:, None, None] * cross + b[:, None, None] * (cross @ cross)


class Table:
    """Piecewise linear functions: nodes and values (k, 6); the end value holds beyond the ends."""

    def __init__(self, nodes, values):
        self.nodes, self.values = numpy.asarray(nodes, float), numpy.asarray(values, float)

    def __call__(self, q):
        return numpy.stack([numpy.interp(q, self.nodes, self.values[:, k]) for k in range(6)], axis=1)


class Smooth:
    """A random smooth function: polynomial of third degree and one slow wave in each of the six components."""

    def __init__(self, rng, low, high, length_um, angle_urad, constant_urad, slope_urad=0.0):
        self.middle, self.half = (low + high) / 2, (high - low) / 2
        size = numpy.array([length_um * 1e-3] * 3 + [angle_urad * 1e-6] * 3)
        self.poly = rng.normal(size=(4, 6)) * size * numpy.array([0.5, 0.5, 0.4, 0.3])[:, None]
        self.poly[0, 3:] = rng.uniform(-1, 1, 3) * constant_urad * 1e-6
        self.poly[1, :3] += rng.uniform(-1, 1, 3) * slope_urad * 1e-6 * self.half
        self.wave = rng.normal(size=6) * size * 0.2
        self.phase = rng.uniform(0, 2 * numpy.pi, 6)

    def __call__(self, q):
        u = (numpy.asarray(q, float) - self.middle) / self.half
        powers = numpy.stack([u**k for k in range(4)], axis=1)
        return powers @ self.poly + self.wave * numpy.sin(3.0 * u[:, None] + self.phase)


class Rotary:
    """A rotary axis: centre, location shift and tilt (9); `errors` a Table over degrees or None."""

    def __init__(self, name, centre, shift=(0, 0, 0), tilt=(0, 0, 0)):
        self.name, self.index = name, "ABC".index(name)
        self.centre, self.shift, self.tilt = (numpy.array(v, float) for v in (centre, shift, tilt))

    def map(self, points, angle_rad, ideal=False, inverse=False):
        axis = numpy.zeros(3)
        axis[self.index] = 1.0
        turn = rotation(numpy.asarray(angle_rad)[:, None] * axis)
        tilt = numpy.zeros(3) if ideal else self.tilt
        shift = numpy.zeros(3) if ideal else self.shift
        matrix = rotation(tilt)[0] @ turn
        if inverse:
            return numpy.einsum("nji,nj->ni", matrix, points - self.centre - shift) + self.centre
        return numpy.einsum("nij,nj->ni", matrix, points - self.centre) + self.centre + shift


class Machine:
    def __init__(self, order=(0, 1, 2), travel=((0, 400), (0, 300), (0, 200))):
        self.order, self.travel = tuple(order), [tuple(map(float, t)) for t in travel]
        self.functions = [[], [], []]
        self.play = numpy.zeros(3)
        self.measured = [{} for _ in range(3)]
        self.square = numpy.zeros(3)
        self.scale = numpy.zeros(3)
        self.tool = numpy.zeros(3)
        self.warm = False
        self.table, self.head = [], []

    def copy(self):
        return copy.deepcopy(self)

    def lever(self, axis):
        """The place from which the arms of an axis' angles count: (7)."""
        lever = numpy.array(self.measured[axis].get("tool", (0.0, 0.0, 0.0)), float)
        for later in self.order[self.order.index(axis) + 1 :]:
            lever[later] += self.measured[axis].get(AXES[later], 0.0)
        return lever

    def errors(self, axis, q):
        total = numpy.zeros((len(q), 6))
        for function in self.functions[axis]:
            total += function(q)
        return total

    def directions(self):
        c, b, a = self.square
        return [numpy.array([1.0, 0, 0]), numpy.array([-c, 1.0, 0]), numpy.array([b, -a, 1.0])]

    def linear(self, q, tool, side=None, turned=False):
        """Tool tip (n, 3) before the table; with `turned` also the orientation (n, 3, 3)."""
        q = numpy.atleast_2d(numpy.asarray(q, float))
        p = numpy.broadcast_to(numpy.asarray(tool, float), q.shape).copy()
        matrix = numpy.broadcast_to(numpy.eye(3), (len(q), 3, 3))
        normals = self.directions()
        for axis in reversed(self.order):
            e = self.errors(axis, q[:, axis])
            if side is not None:
                e[:, axis] -= self.play[axis] / 2 * numpy.asarray(side, float)[:, axis]
            lever = self.lever(axis)
            r = rotation(e[:, 3:])
            p = numpy.einsum("nij,nj->ni", r, p - lever) + lever + e[:, :3] + q[:, axis : axis + 1] * normals[axis]
            matrix = r @ matrix
        p = p + q * (self.scale + numpy.array([EXPANSION * 4 if self.warm else 0.0, 0, 0]))
        return (p, matrix) if turned else p

    def position(self, q, tool=None, side=None, angles=None):
        """Where the tool tip is as the workpiece sees it; `angles` (n, 3) are the commands of A, B, C in degrees."""
        q = numpy.atleast_2d(numpy.asarray(q, float))
        tool = self.tool if tool is None else tool
        if angles is not None:
            angles = numpy.radians(numpy.asarray(angles, float))
        if self.head and angles is not None:
            tip = numpy.broadcast_to(numpy.asarray(tool, float), q.shape).copy()
            for rotary in reversed(self.head):
                tip = rotary.map(tip, angles[:, rotary.index])
            tool = tip
        p = self.linear(q, tool, side)
        if angles is not None:
            for rotary in reversed(self.table):
                p = rotary.map(p, angles[:, rotary.index], inverse=True)
        return p

    def chain(self):
        table = "".join(r.name + " " for r in self.table)
        head = "".join(r.name + " " for r in self.head)
        linear = [AXES[a] for a in self.order]
        return f"[w {table}{linear[0]} {linear[1]} b {linear[2]} {head}t]"


def tabled(machine, nodes=11):
    """The same machine with every axis' functions as one piecewise linear table: what a profile can hold exactly."""
    result = machine.copy()
    for axis in range(3):
        at = numpy.linspace(*machine.travel[axis], nodes)
        values = numpy.round(machine.errors(axis, at), 10)
        result.functions[axis] = [Table(at, values)]
    return result


LOCATION = {
    "A": ("EY0A_um", "EZ0A_um", "EB0A_urad", "EC0A_urad"),
    "B": ("EX0B_um", "EZ0B_um", "EA0B_urad", "EC0B_urad"),
    "C": ("EX0C_um", "EY0C_um", "EA0C_urad", "EB0C_urad"),
}


def location(rotary):
    """The four location errors of a rotary axis by their keys, um and urad."""
    found = {}
    for key in LOCATION[rotary.name]:
        vector = rotary.shift * 1e3 if key.endswith("_um") else rotary.tilt * 1e6
        found[key] = float(vector["XYZ".index(key[1]) if key.endswith("_um") else "ABC".index(key[1])])
    return found


def write_profile(machine, folder, name, interpolation=None, tables=True):
    """The profile of a machine whose functions are Tables; returns its path."""
    p = Profile(name, "linuxcnc", machine.chain())
    p[""].update(interpolation=interpolation, calibrated={"date": "2026-01-01", "temperature_c": 20.0, "instrument": "generator"})
    for axis, letter in enumerate(AXES):
        p.axis(letter).update(travel_mm=[round(float(v), 6) for v in machine.travel[axis]], resolution_mm=0.0001)
        if machine.functions[axis] and tables:
            (table,) = machine.functions[axis]
            rows = [[round(float(v * 1e3), 7) for v in row[:3]] + [round(float(v * 1e6), 4) for v in row[3:]] for row in table.values]
            p.errors(letter, [round(float(at), 6) for at in table.nodes], rows)
        if machine.measured[axis]:
            p.axis(letter)["measured_at_mm"] = machine.measured[axis]
        if machine.play[axis]:
            p.axis(letter)["backlash_um"] = round(float(machine.play[axis] * 1e3), 6)
    p["squareness"].update(zip(("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"), (round(float(v) * 1e6, 5) for v in machine.square)))
    for rotary in machine.table + machine.head:
        p.axis(rotary.name).update(centre_mm=rotary.centre, tilt="body", **{key: round(size, 6) for key, size in location(rotary).items()})
    p["tool"]["default_mm"], p["work_offsets_mm"]["G54"] = machine.tool, [0, 0, 0]
    scales = [(letter, machine.scale[axis]) for axis, letter in enumerate(AXES) if machine.scale[axis]]
    p.effects += [{"id": f"scale.{letter}", "scale_um_per_m": round(float(scale * 1e6), 6)} for letter, scale in scales]
    if machine.warm:
        p.effects.append({"id": "thermal.X", "expansion_um_per_m_k": EXPANSION * 1e6})
    return str(p.write(folder, name + ".toml"))
