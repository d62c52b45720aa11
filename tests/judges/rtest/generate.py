"""Random machines with rotary axes, and what an R-test or a probe and a sphere read on them. A case is its seed, number, chain and kind.

Error functions of rotary axes have shapes that no short Fourier series makes: sawtooths with rounded corners, bumps at one place,
steps with soft edges; no hysteresis. Linear axes have tables and squareness, which the base profile knows.
"""

import os
import zlib

import numpy as np

from common import folders
from common.profile import Profile

from machine import LOCATIONS, SCALE, Machine, place, unit

CHAINS = {
    "ac": ["[w C A b X Y Z t]", "[w C A Y b X Z t]"],
    "bc": ["[w C B b X Y Z t]", "[w C B X b Y Z t]"],
    "head-table": ["[w C b X Y Z B t]", "[w C Y b X Z A t]"],
    "head-head": ["[w b X Y Z C B t]", "[w X b Y Z C A t]"],
    "one": ["[w C b X Y Z t]", "[w A Y b X Z t]", "[w B X b Z Y t]"],
    "nutating": ["[w C B b X Y Z t]"],
}
# what the machine has, and how it is measured
KINDS = {
    "locations": "location errors only, linear axes perfect",
    "tables": "location errors and functions of the angle",
    "based": "the same, a base profile that knows part of both, linear axes with known tables",
    "sphere": "as tables, probe and sphere",
    "star": "as tables, tool vectors of a star of styli, not in one line, for tables too; heads are always read so",
    "one-ball": "one mounting of the ball: what it cannot show is named; of a head refused",
    "perfect": "rotary axes without errors: nothing found",
}
NOISE = 1.0


def wrapped(a):
    return (a + 180) % 360 - 180


def shape(rng, full, low, high):
    """A function of degrees with values of about 1, and of no short series."""
    kind, at = rng.choice(["saw", "bump", "bumps", "step"]), rng.uniform(low, high)
    width = rng.uniform(20, 32) if full else rng.uniform(0.13, 0.2) * (high - low)
    sign = rng.choice([-1, 1])
    if kind == "saw" and full:
        n = np.arange(1, 9)
        weight = np.exp(-((n / 4.0) ** 2)) / n
        return lambda a: sign * (np.sin(np.radians(a - at)[:, None] * n) * weight).sum(-1)
    if kind == "saw":
        return lambda a: sign * ((a - low) / (high - low) - 0.5 - 0.5 * np.tanh((a - at) / width))
    if kind == "step":
        other = at + rng.uniform(80, 200)
        if full:
            return lambda a: sign * (np.tanh(np.sin(np.radians(a - at)) * 2) + np.tanh(np.sin(np.radians(a - other)) * 2)) / 2
        return lambda a: sign * np.tanh((a - at) / (1.3 * width))
    places = [at] if kind == "bump" else [at, at + rng.uniform(70, 200)]
    sizes = [sign * rng.uniform(0.5, 1) for _ in places]

    def bump(a):
        return sum(s * np.exp(-0.5 * ((wrapped(a - p) if full else a - p) / width) ** 2) for s, p in zip(sizes, places))

    return bump


def functions(rng, full, low, high, um, urad):
    shapes = [shape(rng, full, low, high) for _ in range(6)]
    sizes = [rng.uniform(0.3, 1) * (um if j < 3 else urad) for j in range(6)]
    return lambda a: np.stack([s * f(np.asarray(a, float)) for s, f in zip(sizes, shapes)], axis=1)


def linear_table(rng, low, high):
    nodes = np.round(np.linspace(low, high, 29), 3)
    out = np.zeros((29, 6))
    for j in range(6):
        for n in (1, 2, 3):
            out[:, j] += rng.uniform(-1, 1) / n * np.sin(2 * np.pi * n * nodes / 1400 + rng.uniform(0, 7)) * (10 if j < 3 else 15)
    return "linear", nodes, np.round(out, 4)


class Case:
    """truth, base: machines; rows: a table; unseen: q, rot, tool, ball of other places with another ball; terms that are open."""

    def __init__(self, seed, number, chain, kind):
        self.name = f"{chain}-{kind}-{number}"
        self.chain, self.kind, self.number = chain, kind, number
        rng = self.rng = np.random.default_rng(zlib.crc32(f"{seed}/{self.name}".encode()))
        text = str(rng.choice(CHAINS[chain]))
        names = [w for w in text.strip("[] ").split() if w in "ABC"]
        spec = {"chain": text, "axes": {}, "rotary": {}, "squareness_urad": [0.0] * 3}
        known = kind == "based"
        for axis in "XYZ":
            spec["axes"][axis] = {"travel": [-900, 900]}
            if known:
                spec["axes"][axis]["table"] = linear_table(rng, -900, 900)
        if known:
            spec["squareness_urad"] = [float(np.round(v, 2)) for v in rng.uniform(-50, 50, 3)]
        base = {**spec, "rotary": {}}
        self.range, tables = {}, kind in ("tables", "based", "sphere", "star", "one-ball")
        for i, name in enumerate(names):
            head = text.index(name) > text.index("Z")
            full = name == "C" or chain == "one"
            low, high = (-180.0, 180.0) if full else (-90.0, 90.0)
            self.range[name] = (low, high)
            one = {"travel": [low, high], "tilt": str(rng.choice(["body", "axis"]))}
            one["centre"] = [float(np.round(v, 3)) for v in (rng.uniform(-3, 3, 3) if head else rng.uniform(-60, 60, 3) + [0, 0, -80])]
            if i and not head:  # the axes of most tables nearly meet
                one["centre"] = [float(np.round(v + rng.uniform(-5, 5), 3)) for v in spec["rotary"][names[0]]["centre"]]
            if chain == "nutating" and name == "B":
                one["direction"] = [0.0, 1.0, float(rng.choice([-1, 1]))]
            start = dict(one)
            if kind != "perfect":
                one["location"] = {k: float(np.round(rng.uniform(-50, 50) if unit(k) == "um" else rng.uniform(-80, 80), 3)) for k in LOCATIONS[name]}
            if tables:
                one["function"] = functions(rng, full, low, high, 8.0, 20.0)
            if known:  # the base knows half of the locations and an older table
                start["location"] = {k: float(np.round(v * rng.uniform(0.3, 0.9), 3)) for k, v in one["location"].items()}
                nodes = np.linspace(low, high, 73 if full else 37)
                rows = np.round(0.6 * one["function"](nodes) + rng.uniform(-2, 2, 6), 4)
                if full:
                    rows[-1] = rows[0]
                start["table"] = (nodes, rows)
                start["function"] = lambda a, nodes=nodes, rows=rows: np.stack([np.interp(a, nodes, rows[:, j]) for j in range(6)], axis=1)
            spec["rotary"][name], base["rotary"][name] = one, start
        self.truth, self.base, self.names = Machine(spec), Machine(base), names
        self.measure()

    def angles(self):
        """Pairs of angles: each axis all its way at three places of the other; an axis alone all its way."""
        out, many = [], {}
        for name in self.names:
            low, high = self.range[name]
            many[name] = np.arange(-180, 180, 15.0) if high > 100 else np.arange(low, high + 1, 10.0)
        if len(self.names) == 1:
            return many[self.names[0]][:, None]
        first, second = self.names
        fixed = {name: ([-180.0, -60.0, 60.0] if self.range[name][1] > 100 else [-60.0, 0.0, 60.0]) for name in self.names}
        for f in fixed[first]:
            out += [(f, v) for v in many[second]]
        for f in fixed[second]:
            out += [(v, f) for v in many[first]]
        return np.array(sorted(set(out)))

    def ball(self, run):
        """Ball in the workpiece, and the tool's vector; unlike from run to run."""
        rng = self.rng
        at = [120 * run + rng.uniform(0, 60), (rng.uniform(60, 110), rng.uniform(120, 190), rng.uniform(20, 200))[run % 3], (40.0, 160.0, 90.0)[run % 3] + rng.uniform(-20, 20)]
        x = np.array([at[1] * np.cos(np.radians(at[0])), at[1] * np.sin(np.radians(at[0])), at[2]])
        centre = np.array(self.truth.spec["rotary"][self.names[0]]["centre"]) if self.truth.table else np.zeros(3)
        # What a head does beside the line of its tools is shown by styli beside it.
        star = self.kind == "star" or self.truth.head
        aside = 60 * np.array([np.cos(2 * run + 1), np.sin(2 * run + 1)]).round(3) if star else np.zeros(2)
        return np.round(centre + x, 3), np.array([*aside, -float(np.round((110.0, 210.0, 160.0)[run % 3] + rng.uniform(-20, 20), 3))])

    def measure(self):
        rng, pairs = self.rng, self.angles()
        self.runs = 1 if self.kind == "one-ball" else 3
        repeat = 2 if len(self.names) == 1 else 1
        parts, balls = {"q": [], "rot": [], "tool": [], "run": []}, []
        for run in range(self.runs):
            balls.append(self.ball(run))
            p, t = balls[-1]
            rot = np.repeat(pairs, repeat, axis=0)
            tool, tip = np.tile(t, (len(rot), 1)), np.tile(p, (len(rot), 1))
            if self.kind == "sphere":  # the probe is centred on a sphere that stands a little elsewhere
                q = self.truth.command(tip + rng.uniform(-0.3, 0.3, 3), rot, tool, ideal=False)
                q = np.round(q + rng.normal(size=q.shape) * NOISE * 1e-3, 6)
            else:
                q = np.round(self.truth.command(tip, rot, tool), 6)
            for key, value in (("q", q), ("rot", rot), ("tool", tool), ("run", np.full(len(rot), run))):
                parts[key].append(value)
        self.q, self.rot, self.tool, self.run = (np.concatenate(parts[k]) for k in ("q", "rot", "tool", "run"))
        self.offset = rng.uniform(-50, 50, (self.runs, 3))
        self.read = None
        if self.kind != "sphere":
            self.read = np.round(1e3 * self.truth.error(self.q, self.rot, self.tool) + self.offset[self.run] + rng.normal(size=self.q.shape) * NOISE, 4)
        self.stated = bool(rng.random() < 0.5)  # u_um in the file
        # unseen: other angles within those read, two other balls; where one ball was read, that one
        parts = {"q": [], "rot": [], "tool": [], "run": []}
        for ball in range(2):
            p, t = balls[0] if self.kind == "one-ball" else self.ball(rng.integers(3))
            rot = np.stack([rng.uniform(-170 if self.range[n][1] > 100 else -85, 160 if self.range[n][1] > 100 else 85, 60) for n in self.names], axis=1).round(3)
            tool = np.tile(t, (60, 1))
            for key, value in (("q", np.round(self.truth.command(np.tile(p, (60, 1)), rot, tool), 6)), ("rot", rot), ("tool", tool), ("run", np.full(60, ball))):
                parts[key].append(value)
        self.unseen = tuple(np.concatenate(parts[k]) for k in ("q", "rot", "tool", "run"))

    # files

    def table(self, q, rot, tool, run, read=None, u=None):
        head = ["run", "x_mm", "y_mm", "z_mm", *(f"{n.lower()}_deg" for n in self.names), "tool_x_mm", "tool_y_mm", "tool_z_mm"]
        columns = [[f"r{r}" for r in run], *([f"{v:.6f}" for v in q[:, i]] for i in range(3)), *([f"{v:.4f}" for v in rot[:, i]] for i in range(len(self.names)))]
        columns += [[f"{v:.4f}" for v in tool[:, i]] for i in range(3)]
        if read is not None:
            head += ["dx_um", "dy_um", "dz_um"]
            columns += [[f"{v:.4f}" for v in read[:, i]] for i in range(3)]
        if u is not None:
            head.append("u_um")
            columns.append([f"{u:g}"] * len(q))
        return head, [list(row) for row in zip(*columns)]

    def rows(self):
        return self.table(self.q, self.rot, self.tool, self.run, self.read, NOISE if self.stated else None)

    def held(self):
        """Rows of the unseen places, read with the same noise."""
        q, rot, tool, run = self.unseen
        offset = self.rng.uniform(-50, 50, (2, 3))
        if self.kind != "sphere":
            return self.table(q, rot, tool, run, 1e3 * self.truth.error(q, rot, tool) + offset[run] + self.rng.normal(size=q.shape) * NOISE, NOISE if self.stated else None)
        tip = self.base.tip(q, rot, tool, ideal=True)
        real = self.truth.command(tip + offset[run] * 1e-3, rot, tool, ideal=False)
        return self.table(real + self.rng.normal(size=q.shape) * NOISE * 1e-3, rot, tool, run, None, NOISE if self.stated else None)

    def write(self, folder):
        os.makedirs(folder, exist_ok=True)
        folders.table(f"{folder}/rows.csv", *self.rows())
        folders.table(f"{folder}/held.csv", *self.held())
        write_profile(self.base, f"{folder}/base.toml")


def write_profile(machine, path, located=None, tables=None):
    """The profile of a machine whose rotary axes are described by `location` and `table` (or the `tables` given)."""
    spec = machine.spec
    p = Profile("Judge", "linuxcnc", spec["chain"])
    for name, one in spec["axes"].items():
        p.axis(name)["travel_mm"] = one["travel"]
        if one.get("table"):
            p.errors(name, *one["table"][1:], digits=".6f")
    p["squareness"].update(zip(("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"), spec["squareness_urad"]))
    for name, one in spec["rotary"].items():
        p.axis(name).update(centre_mm=one["centre"], travel_deg=one["travel"], tilt=one["tilt"], direction=one.get("direction"))
        at = dict(one.get("location", {}))
        for k in LOCATIONS[name]:
            value = at.get(k, 0.0) + (0 if located is None else located.get(name, np.zeros(6))[place(k)] / SCALE[place(k)])
            p.located(name, {k: round(float(value), 6)} if value else {})
        table = tables[name] if tables and name in tables else one.get("table")
        if table:
            p.errors(name, *table, digits=".6f")
    p["tool"]["default_mm"] = [0, 0, -150]
    return str(p.write(os.path.dirname(path), os.path.basename(path)))
