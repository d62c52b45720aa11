"""A crooked machine: where its tool's tip is, seen from the workpiece, and where a perfect machine's would be.

Conventions are those of docs/equations.md (5) to (9). Places are (n, 3), angles {axis: (n,)} in degrees, mm.
"""

import numpy as np

from common.profile import Profile, column

LETTER = {"A": (1.0, 0.0, 0.0), "B": (0.0, 1.0, 0.0), "C": (0.0, 0.0, 1.0)}
LOCATION = {"A": ("EY0A", "EZ0A", "EB0A", "EC0A"), "B": ("EX0B", "EZ0B", "EA0B", "EC0B"), "C": ("EX0C", "EY0C", "EA0C", "EB0C")}
TRAVEL = 450.0


def turned(vectors, x):
    """x turned by rotation vectors, row by row."""
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    axis = vectors / np.maximum(angle, 1e-30)
    along = (axis * x).sum(axis=-1, keepdims=True)
    across = axis[..., [1, 2, 0]] * x[..., [2, 0, 1]] - axis[..., [2, 0, 1]] * x[..., [1, 2, 0]]
    return x * np.cos(angle) + across * np.sin(angle) + axis * along * (1.0 - np.cos(angle))


class Machine:
    def __init__(self, spec, perfect=False):
        self.spec, self.perfect = spec, perfect
        axes = [k for k in spec["chain"].strip("[] ").split() if k not in "wbt"]
        linear = [n for n, k in enumerate(axes) if k in "XYZ"]
        self.table, self.linear, self.head = axes[: linear[0]], [axes[n] for n in linear], axes[linear[-1] + 1 :]

    def functions(self, k, at):
        """Displacement (mm) and turn (rad) of an axis at its commands."""
        data = self.spec["tables"].get(k)
        if self.perfect or not data:
            return np.zeros((len(at), 3)), np.zeros((len(at), 3))
        rows = np.array(data["rows"])
        f = np.stack([np.interp(at, data["at"], rows[:, n]) for n in range(6)], axis=1)
        return f[:, :3] * 1e-3, f[:, 3:] * 1e-6

    def location(self, k):
        """Shift (mm) and lean (rad) of a rotary axis."""
        shift, lean = np.zeros(3), np.zeros(3)
        for name, value in ({} if self.perfect else self.spec["rotary"][k]["location"]).items():
            (shift if name[1] in "XYZ" else lean)["XYZABC".index(name[1]) % 3] = value * (1e-3 if name[1] in "XYZ" else 1e-6)
        return shift, lean

    def carried(self, k, degrees, x):
        """What rotary axis k makes of a place that it carries."""
        centre, (shift, lean), (d, e) = np.array(self.spec["rotary"][k]["centre"]), self.location(k), self.functions(k, degrees)
        x = turned(np.radians(degrees)[:, None] * np.array(LETTER[k]), x - centre)
        return centre + shift + d + turned(np.broadcast_to(lean, e.shape), turned(e, x))

    def seen_from(self, k, degrees, x):
        """The place on what rotary axis k carries that stands at x."""
        centre, (shift, lean), (d, e) = np.array(self.spec["rotary"][k]["centre"]), self.location(k), self.functions(k, degrees)
        x = turned(-e, turned(np.broadcast_to(-lean, e.shape), x - centre - shift - d))
        return centre + turned(-np.radians(degrees)[:, None] * np.array(LETTER[k]), x)

    def tip(self, q, angles, tool, play=None):
        """The tip in the workpiece for axis commands; `play`: where the carriages stand less their commands."""
        angles = {k: np.broadcast_to(angles.get(k, 0.0), len(q)).astype(float) for k in self.table + self.head}
        x = np.broadcast_to(np.array(tool, float), q.shape)
        for k in reversed(self.head):
            x = self.carried(k, angles[k], x)
        square = {} if self.perfect else self.spec["squareness"]
        yx, zx, zy = (square.get(k, 0.0) * 1e-6 for k in ("EC0Y", "EB0Z", "EA0Z"))
        direction = {"X": (1, 0, 0), "Y": (-yx, 1, 0), "Z": (zx, -zy, 1)}
        for k in reversed(self.linear):
            n = "XYZ".index(k)
            d, e = self.functions(k, q[:, n])
            x = turned(e, x) + q[:, n, None] * np.array(direction[k], float) + d
        if play is not None:
            x = x + play
        for k in reversed(self.table):
            x = self.seen_from(k, angles[k], x)
        return x

    def standing(self, angles, x, vector=False):
        """Where a place (or direction) of the workpiece stands on the perfect machine; `in_workpiece` is the way back."""
        for k in self.table:
            centre = np.zeros(3) if vector else np.array(self.spec["rotary"][k]["centre"])
            x = centre + turned(np.radians(np.broadcast_to(angles.get(k, 0.0), len(x)))[:, None] * np.array(LETTER[k]), x - centre)
        return x

    def in_workpiece(self, angles, x, vector=False):
        for k in reversed(self.table):
            centre = np.zeros(3) if vector else np.array(self.spec["rotary"][k]["centre"])
            x = centre + turned(-np.radians(np.broadcast_to(angles.get(k, 0.0), len(x)))[:, None] * np.array(LETTER[k]), x - centre)
        return x

    def reach(self, angles, tool, count):
        """The perfect tool, as its head points it."""
        x = np.broadcast_to(np.array(tool, float), (count, 3))
        for k in reversed(self.head):
            centre = np.array(self.spec["rotary"][k]["centre"])
            x = centre + turned(np.radians(np.broadcast_to(angles.get(k, 0.0), count))[:, None] * np.array(LETTER[k]), x - centre)
        return x

    def joints(self, places, angles, tool):
        """Axis commands with which a perfect machine brings the tip to places of the workpiece."""
        return self.standing(angles, places) - self.reach(angles, tool, len(places))

    def solved(self, places, angles, tool):
        """The same for the crooked machine."""
        q = self.joints(places, angles, tool)
        for _ in range(6):
            q = q + self.standing(angles, places - self.tip(q, angles, tool), vector=True)
        return q

    def error(self, q, angles, tool):
        """Tip as it is less where a perfect machine has it, along the machine's axes."""
        ideal = self.in_workpiece(angles, q + self.reach(angles, tool, len(q)))
        return self.standing(angles, self.tip(q, angles, tool) - ideal, vector=True)


def waves(rng, at, size):
    return sum(rng.gauss(0, size) / w**0.7 * np.sin(w * at / 140.0 + rng.uniform(0, 6)) for w in (1, 2, 5))


def table(rng, at, length_um, angle_urad):
    sizes = [length_um] * 3 + [angle_urad] * 3
    return {"at": at.tolist(), "rows": np.round(np.stack([waves(rng, at, s) for s in sizes], axis=1), 2).tolist()}


CHAINS = ("[w X Y b Z t]", "[w b X Y Z t]", "[w Y X b Z t]", "[w Y b X Z t]", "[w X b Y Z t]", "[w b Z Y X t]")
ROTARY = ("[w C A b Y X Z t]", "[w C A Y b X Z t]", "[w C B b X Y Z t]", "[w C b X Y Z B t]", "[w C X b Y Z A t]")


def random_machine(rng, rotary, play):
    """A specification; what `profile` writes down of it is all of it."""
    rough = rng.choice((1.0, 1.0, 3.0))
    spec = {"chain": rng.choice(ROTARY if rotary else CHAINS), "tables": {}, "rotary": {}, "play": {}}
    for k in "XYZ":
        if rng.random() < 0.9:
            spec["tables"][k] = table(rng, np.linspace(-TRAVEL, TRAVEL, rng.choice((19, 37, 61))), 9 * rough, 15 * rough)
        if play and rng.random() < 0.7:
            spec["play"][k] = round(rng.uniform(2, 14), 1)
    spec["squareness"] = {k: round(rng.gauss(0, 40 * rough), 1) for k in ("EC0Y", "EB0Z", "EA0Z")}
    machine = Machine(spec)
    for k in machine.table + machine.head:
        place = lambda low, high: round(rng.uniform(low, high), 3)
        centre = [place(-30, 30), place(-30, 30), place(-80, 0)] if k in machine.table else [place(-5, 5), place(-5, 5), place(-60, 0)]
        names = LOCATION[k] if k in machine.table else LOCATION[k][:2]
        location = {n: round(rng.gauss(0, 60 if n[1] in "XYZ" else 30), 1) for n in names}
        spec["rotary"][k] = {"centre": centre, "location": location, "travel": [-400, 400] if k == "C" else [-110, 110]}
        if rng.random() < 0.4:
            low, high = spec["rotary"][k]["travel"]
            spec["tables"][k] = table(rng, np.linspace(low, high, 33), 4, 8)
    spec["resolution"] = rng.choice((0.001, 0.001, 0.0001))
    spec["tolerance"] = rng.choice((1.0, 1.0, 2.0))
    spec["lengths"] = {"H1": round(rng.uniform(60, 150), 3), "H2": round(rng.uniform(60, 150), 3)}
    return spec


def profile(spec, control, folder, offsets, zero=None):
    """Writes profile and tables. `offsets`: of each name; `zero`: of [program], not said if None."""
    p = Profile("shop", control, spec["chain"])
    for k in "XYZ":
        p.axis(k).update(travel_mm=[-TRAVEL, TRAVEL], resolution_mm=spec["resolution"], backlash_um=spec["play"].get(k))
    for k, r in spec["rotary"].items():
        p.axis(k).update(centre_mm=r["centre"], travel_deg=r["travel"], tilt="body")
        p.located(k, r["location"])
    for k, data in spec["tables"].items():
        p.errors(k, data["at"], data["rows"])
    p["squareness"].update({column(k): v for k, v in spec["squareness"].items()})
    p["tool"].update(lengths_mm=spec["lengths"], radii_mm={"D1": spec["radius"]} if spec.get("radius_known") else None)
    p["work_offsets_mm"].update(offsets)
    p["correction"]["tolerance_um"] = spec["tolerance"]
    p["program"]["zero"] = zero
    if spec["rotary"]:
        p["kinematics"].update(straight="tip", centres_mm={k: r["centre"] for k, r in spec["rotary"].items()})
    return p.write(folder)
