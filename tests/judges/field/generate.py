"""Random fields, the vectors that somebody measured of them, and programs to correct. A case is its seed, number and kind."""

import os
import zlib

import numpy as np

from common import folders
from common.profile import Profile

import fields
import reader

KINDS = {
    "rigid-scattered": "240 vectors anywhere, of a rigid machine, 1 um",
    "loose-scattered": "the same of a field that no rigid body makes",
    "rigid-lattice": "a lattice of some 250, 1 um",
    "loose-lattice": "the same of a field that no rigid body makes",
    "exact": "a lattice without noise, noise_um = 0: nodes are met, and between them it is linear along each axis",
    "repeats": "80 places, each read three times",
    "nothing": "240 vectors of a machine without errors, 1 um",
}


class Case:
    def __init__(self, seed, number, kind):
        self.kind, self.number = kind, number
        self.name = f"{kind}-{number}"
        rng = self.rng = np.random.default_rng(zlib.crc32(f"{seed}/{self.name}".encode()))
        size = np.round(rng.uniform([300, 250, 200], [700, 450, 400]))
        low = np.round(rng.uniform(-1, 0.3, 3) * size)
        self.box = [(float(a), float(a + s)) for a, s in zip(low, size)]
        self.tool = np.array([0, 0, -float(np.round(rng.uniform(60, 150), 1))]) if rng.random() < 0.5 else np.zeros(3)
        self.noise = 0.0 if kind == "exact" else 1.0
        if kind == "nothing":
            self.field = lambda q: np.zeros(np.shape(q))
        elif kind.startswith("rigid"):
            self.field = fields.Rigid(rng, self.box, self.tool)
        else:
            self.field = fields.Loose(rng, self.box)
        self.places = self.lattice((7, 6, 6)) if kind in ("rigid-lattice", "loose-lattice", "exact") else self.scattered(80 if kind == "repeats" else 240)
        if kind == "repeats":
            self.places = np.repeat(self.places, 3, axis=0)
        self.read = np.round(self.field(self.places) + self.noise * rng.normal(size=self.places.shape), 4)
        self.tolerance = float(rng.choice([1.0, 1.0, 2.0, 5.0]))
        self.inside = rng.uniform(*np.array(self.box).T, (400, 3)).round(4)
        self.stated = str(rng.choice(["profile", "row", "component"])) if self.noise else "profile"

    def lattice(self, counts):
        axes = [np.round(np.linspace(*b, n), 3) for b, n in zip(self.box, counts)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def scattered(self, count):
        """Corners, places on edges and faces, and inside: what is measured reaches to the walls."""
        low, high = np.array(self.box).T
        u = self.rng.uniform(0, 1, (count, 3))
        u[:8] = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
        for k in range(8, 8 + count // 4):
            for i in self.rng.choice(3, size=self.rng.choice([1, 2]), replace=False):
                u[k, i] = self.rng.integers(2)
        return np.round(low + u * (high - low), 3)

    def rows(self):
        head, rows = ["x_mm", "y_mm", "z_mm", "dx_um", "dy_um", "dz_um"], []
        for p, d in zip(self.places, self.read):
            rows.append([f"{v:.3f}" for v in p] + [f"{v:.4f}" for v in d])
        if self.tool.any():
            head = head + ["tool_x_mm", "tool_y_mm", "tool_z_mm"]
            rows = [r + [f"{v:g}" for v in self.tool] for r in rows]
        if self.stated == "row":
            head, rows = head + ["u_um"], [r + ["1"] for r in rows]
        elif self.stated == "component":
            head, rows = head + ["u_x_um", "u_y_um", "u_z_um"], [r + ["1", "1", "1"] for r in rows]
        return head, rows

    def profile(self, noise=None):
        p = Profile("Judge", "linuxcnc", "[w X Y b Z t]")
        for name, b in zip("XYZ", self.box):
            p.axis(name).update(travel_mm=b, resolution_mm=0.001)
        p["field"].update(file="vectors.csv", noise_um=self.noise if noise is None else noise)
        self.offset = np.round([self.box[0][0] + 20, self.box[1][0] + 30, self.box[2][0] + 10 - (-self.tool[2])], 3)
        p["tool"].update(default_mm=self.tool, lengths_mm={"H1": -self.tool[2]} if self.tool.any() else None)
        p["work_offsets_mm"]["G54"] = self.offset
        p["correction"].update(engine="field", tolerance_um=self.tolerance)
        return p.text()

    def write(self, folder, noise=None):
        os.makedirs(folder, exist_ok=True)
        folders.table(f"{folder}/vectors.csv", *self.rows())
        folders.put(folder, "machine.toml", self.profile(noise))

    @property
    def lengths(self):
        return {"H1": -self.tool[2]}

    def program(self, blocks=30):
        """Lines, arcs in three planes, helices, full circles; every place of it inside the box."""
        rng = self.rng
        low, high = np.array(self.box).T
        base = self.offset + [0, 0, -self.tool[2]]
        margin = 0.02 * (high - low)
        word = lambda names, v: " ".join(f"{n}{x:.3f}" for n, x in zip(names, v))  # noqa: E731
        at = np.round(rng.uniform(low + margin, high - margin) - base, 3)
        lines = ["G21 G17 G90 G94 G40 G54", "S4000 M3", ("G0 G43 H1 " if self.tool.any() else "G0 ") + word("XYZ", at), "M8"]
        plane, feed, absolute = 17, False, True
        while blocks:
            kind = rng.choice(["line", "short", "arc", "arc", "arc", "rapid", "circle"], p=[0.25, 0.15, 0.15, 0.15, 0.15, 0.08, 0.07])
            f = "" if feed else f" F{rng.integers(3, 20) * 100}"
            if kind in ("line", "short", "rapid"):
                reach = 4.0 if kind == "short" else 400.0
                end = np.round(np.clip(at + rng.uniform(-reach, reach, 3) * rng.integers(0, 2, 3), low + margin - base, high - margin - base), 3)
                moved = [i for i in range(3) if end[i] != at[i]]
                if not moved:
                    continue
                lines.append(f"G{0 if kind == 'rapid' else 1} " + word(["XYZ"[i] for i in moved], end[moved]) + ("" if kind == "rapid" else f))
                feed = feed or kind != "rapid"
                at = end
            else:
                new = int(rng.choice([17, 18, 19]))
                u, v, w = reader.PLANES[new]
                radius = rng.choice([3.0, 12.0, 40.0, 90.0]) * rng.uniform(0.7, 1.3)
                a, sweep = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 5.5) * rng.choice([-1, 1])
                centre = np.round(np.array([at[u], at[v]]) - radius * np.array([np.cos(a), np.sin(a)]), 3)
                r = np.hypot(at[u] - centre[0], at[v] - centre[1])
                a = np.arctan2(at[v] - centre[1], at[u] - centre[0])
                end = at.copy()
                if kind == "arc":
                    end[u], end[v] = np.round(centre + r * np.array([np.cos(a + sweep), np.sin(a + sweep)]), 3)
                if rng.random() < 0.35:
                    end[w] = np.round(end[w] + rng.uniform(-15, 15), 3)
                way = 3 if sweep > 0 else 2
                names = ["XYZ"[i] for i in ((u, v, w) if end[w] != at[w] else (u, v))]
                if kind == "arc" and rng.random() < 0.3 and 0.4 < abs(sweep) < 5.2 and not 2.8 < abs(sweep) < 3.5:
                    more = f"R{(-1 if abs(sweep) > np.pi else 1) * r:.4f}"
                else:
                    more = word(["IJK"[u], "IJK"[v]], centre - [at[u], at[v]])
                text = f"G{way} " + " ".join([word(names, [end["XYZ".index(n)] for n in names]), more]) + f
                try:
                    words = {"R": float(more[1:])} if more[0] == "R" else {"IJK"[u]: round(centre[0] - at[u], 3), "IJK"[v]: round(centre[1] - at[v], 3)}
                    motion = reader.Motion(0, "feed", at, end, reader.arc(new, way, at, end, words, 0))
                except reader.Unreadable:
                    continue
                p = motion.at(np.linspace(0, 1, 400)) + base
                if (p < low + 0.3 * margin).any() or (p > high - 0.3 * margin).any() or abs(motion.arc[2] - motion.arc[3]) > 1e-3:
                    continue
                if new != plane:
                    lines.append(f"G{new}")
                    plane = new
                lines.append(text)
                feed, at = True, end
            blocks -= 1
        return "\n".join(lines + ["M5", "M2"]) + "\n"
