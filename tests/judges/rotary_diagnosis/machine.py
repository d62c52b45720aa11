"""A five-axis machine with one fault, exact: written from docs/equations.md (5) to (9) and the signs of docs/diagnosis.md.

mm, rad, readings in um; rotary commands in degrees. n places at once: q (n, 3), rot (n, k), tool (n, 3).

    p = M_1^-1 .. M_t^-1 (q + d + M_a .. t)        tables from the workpiece on, linear axes, heads
    M(x) = c + s + delta + L R Rot(theta) (x - c)

The fault is one of the library's names; `columns` are its first-order displacements for each coefficient 1.
"""

import os

import numpy as np

from common import folders
from common.command import run
from common.profile import Profile, column

LOCATIONS = {"A": ("EY0A", "EZ0A", "EB0A", "EC0A"), "B": ("EX0B", "EZ0B", "EA0B", "EC0B"), "C": ("EX0C", "EY0C", "EA0C", "EB0C")}
CHAINS = ["[w C A b X Y Z t]", "[w C A Y b X Z t]", "[w C B Y b X Z t]", "[w C b X Y Z B t]", "[w A b X Y Z B t]", "[w C Y b X Z A t]", "[w b X Y Z C B t]", "[w X b Y Z C A t]"]
AXES = "XYZABC"
HALF_MM = 300.0


def exp(v):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3), by quaternions."""
    v = np.atleast_2d(np.asarray(v, float))
    half = np.linalg.norm(v, axis=1) / 2
    w, (x, y, z) = np.cos(half), (v * np.sinc(half / np.pi)[:, None] / 2).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), 2, 0)


def times(m, x):
    return np.einsum("nij,nj->ni", np.broadcast_to(m, (len(x), 3, 3)), x)


def unit(axis):
    e = np.zeros(3)
    e["XYZ".index(axis) if axis in "XYZ" else "ABC".index(axis)] = 1
    return e


class Machine:
    def __init__(self, rng):
        self.chain = rng.choice(CHAINS)
        names = [w for w in self.chain.strip("[] ").split() if w not in "wbt"]
        linear = [i for i, n in enumerate(names) if n in "XYZ"]
        self.table, self.linear, self.head = names[: linear[0]], names[linear[0] : linear[-1] + 1], names[linear[-1] + 1 :]
        self.rotary = self.table + self.head
        self.tool_mm = float(rng.randrange(90, 180, 10))
        self.height = -120.0 if self.table else 0.0
        self.centre, self.reach = {}, {}
        about = [rng.uniform(-30, 30), rng.uniform(-30, 30), rng.uniform(-160, -100)]
        for name in self.rotary:
            if name in self.head:
                self.centre[name] = np.round([rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 60)], 3)
            else:
                self.centre[name] = np.round([v + rng.uniform(-4, 4) for v in about], 3)
            self.reach[name] = (-180.0, 170.0) if name == "C" or (name == "A" and "B" in self.head) else (-80.0, 75.0)

    def profile(self, located=()):
        """The machine as it should be; `located`: (name, value) of location errors or squareness to be in it."""
        p = Profile("judged", "fanuc", self.chain)
        for axis in "XYZ":
            p.axis(axis).update(travel_mm=[-500, 500], resolution_mm=0.001)
        for axis in self.rotary:
            p.axis(axis).update(centre_mm=[round(float(v), 3) for v in self.centre[axis]], travel_deg=[-360, 360])
        for name, value in located:
            kind, what = name.split(".")
            if kind == "squareness":
                p["squareness"][column({"XY": "EC0Y", "XZ": "EB0Z", "YZ": "EA0Z"}[what])] = round(value, 9)
            elif what[-1] in self.rotary:
                p.located(what[-1], {what: round(value, 9)})
                if what[1] in "ABC":
                    # A tilt is not told without what leans by it (VP0314); (9): what the axis carries.
                    p.axis(what[-1])["tilt"] = "body"
        p["tool"]["default_mm"] = [0.0, 0.0, round(-self.tool_mm, 1)]
        return p.text()

    def command(self, tip, rot, vector):
        """X, Y, Z of an ideal machine that bring the tip there."""
        t = np.tile(np.asarray(vector, float), (len(rot), 1))
        for name in reversed(self.head):
            t = self.centre[name] + times(self.turn(name, rot), t - self.centre[name])
        x = np.array(tip, float)
        for name in self.table:
            x = self.centre[name] + times(self.turn(name, rot), x - self.centre[name])
        return x - t

    def turn(self, name, rot):
        return exp(np.radians(rot[:, self.rotary.index(name)])[:, None] * unit(name))

    def tip(self, q, rot, tool, fault=None, weights=(), dirs=None):
        """Tip in the workpiece (n, 3), mm, with a fault of these coefficients."""
        kind, _, what = (fault or "").partition(".")
        x = np.array(tool, float)

        def carried(name, x, back):
            turn, c = self.turn(name, rot), self.centre[name]
            shift, lean = np.zeros(3), np.zeros((1, 3))
            if kind == "rotary" and what.endswith("0" + name):
                k = AXES.index(what[1])
                (shift if k < 3 else lean[0])[k % 3] = weights[0] * (1e-3 if k < 3 else 1e-6)
            moved = np.tile(shift, (len(q), 1))
            extra = np.zeros((len(q), 3))
            if kind == "eccentricity" and what == name:
                angle = np.radians(rot[:, self.rotary.index(name)])
                sin, cos, i = np.sin(angle), np.cos(angle), "ABC".index(name)
                extra[:, i] = 1e-6 * (weights[0] * sin + weights[1] * cos)
                moved[:, (i + 1) % 3] += 1e-3 * (weights[2] * sin + weights[3] * cos)
                moved[:, (i + 2) % 3] += 1e-3 * (weights[4] * sin + weights[5] * cos)
            m = exp(lean) @ exp(extra) @ turn
            if back:
                return c + times(np.transpose(m, (0, 2, 1)), x - c - moved)
            return c + moved + times(m, x - c)

        for name in reversed(self.head):
            x = carried(name, x, False)
        x = x + q
        if kind not in ("", "rotary", "eccentricity"):
            x = x + self.linear_fault(kind, what, weights, q, rot, tool, dirs)
        for name in reversed(self.table):
            x = carried(name, x, True)
        return x

    def linear_fault(self, kind, what, weights, q, rot, tool, dirs):
        """Displacement along the linear axes, mm."""
        out = np.zeros((len(q), 3))
        if kind == "squareness":
            seen, along, sign = {"XY": (0, 1, -1.0), "XZ": (0, 2, 1.0), "YZ": (1, 2, -1.0)}[what]
            out[:, seen] = sign * weights[0] * 1e-6 * q[:, along]
        elif kind == "scale":
            a = "XYZ".index(what)
            out[:, a] = 1e-6 * weights[0] * q[:, a]
        elif kind == "backlash":
            a = "XYZ".index(what)
            out[:, a] = -1e-3 * weights[0] * dirs[:, a]
        elif kind in ("straightness", "positioning"):
            v = np.clip(q[:, "XYZ".index(what[2])] / HALF_MM, -1, 1)
            out[:, "XYZ".index(what[1])] = 1e-3 * (weights[0] * (1.5 * v**2 - 0.5) + weights[1] * (2.5 * v**3 - 1.5 * v))
        elif kind == "angular":
            axis, about = "XYZ".index(what[2]), "ABC".index(what[1])
            inner = self.linear[self.linear.index("XYZ"[axis]) + 1 :]
            lever = np.array(tool, float)
            for name in reversed(self.head):
                lever = self.centre[name] + times(self.turn(name, rot), lever - self.centre[name])
            for name in inner:
                lever[:, "XYZ".index(name)] += q[:, "XYZ".index(name)]
            e = np.zeros(3)
            e[about] = 1
            v = np.clip(q[:, axis] / HALF_MM, -1, 1)
            for weight, wave in zip(weights, (v, 1.5 * v**2 - 0.5, 2.5 * v**3 - 1.5 * v)):
                out += 1e-6 * weight * wave[:, None] * np.cross(e, lever)
        return out

    def count(self, name):
        return {"eccentricity": 6, "straightness": 2, "positioning": 2, "angular": 3}.get(name.split(".")[0], 1)

    def error(self, name, weights, rows):
        """Readings (n, 3), um."""
        place = rows["q"], rows["rot"], rows["tool"]
        return 1e3 * (self.tip(*place, name, weights, rows["dirs"]) - self.tip(*place))

    def columns(self, name, rows):
        """(3n, m): displacement for each coefficient 1, um."""
        return np.stack([self.error(name, np.eye(self.count(name))[k], rows).ravel() for k in range(self.count(name))], axis=1)

    def against_predict(self, vpost, folder, name, value, rows):
        """Largest difference, um, of this machine from `vpost predict` of a profile with the same error."""
        profile, points = folders.put(folder, "m.toml", self.profile([(name, value)])), os.path.join(folder, "p.csv")
        used = [a for a in "ABC" if a in self.rotary]
        with open(points, "w", encoding="ascii") as out:
            out.write("x_mm,y_mm,z_mm," + ",".join(f"{a.lower()}_deg" for a in used) + ",tool_x_mm,tool_y_mm,tool_z_mm\n")
            for q, rot, tool in zip(rows["q"], rows["rot"], rows["tool"]):
                out.write(",".join(f"{v:.4f}" for v in (*q, *(rot[self.rotary.index(a)] for a in used), *tool)) + "\n")
        status, said, errors = run(vpost, "predict", points, "-m", profile, "-q")
        if status:
            raise SystemExit(errors)
        lines = said.split("\n")
        at = [lines[0].split(",").index(n) for n in ("dx_um", "dy_um", "dz_um")]
        found = np.array([[float(line.split(",")[k]) for k in at] for line in lines[1:] if line])
        return float(np.abs(found - self.error(name, [value], rows)).max())
