"""A crooked lathe: where the tip is, in radius and place along the workpiece's axis, for commands of X and Z. mm, radius.

Written from docs/equations.md (5) to (9), (71), (73): chain [w S b Z X t], a chuck, a workpiece that does not bend.
"""

import numpy as np


def rotation(v, x):
    """exp([v]x) x, row by row."""
    size = np.linalg.norm(v, axis=1)[:, None]
    one = np.cross(v, x)
    safe = np.maximum(size, 1e-9)
    return x + np.where(size < 1e-9, 1.0, np.sin(safe) / safe) * one + np.where(size < 1e-9, 0.5, (1 - np.cos(safe)) / safe**2) * np.cross(v, one)


class Lathe:
    def __init__(self, spec):
        self.spec = spec

    def table(self, axis, at):
        data = self.spec["tables"].get(axis)
        if not data:
            return np.zeros((len(at), 3)), np.zeros((len(at), 3))
        rows = np.array(data["rows"])
        f = np.stack([np.interp(at, data["at"], rows[:, k]) for k in range(6)], axis=1)
        return f[:, :3] * 1e-3, f[:, 3:] * 1e-6

    def places(self, words):
        """(r, z) for program words (n, 2): radius and Z. z counts from the program's zero."""
        s = self.spec
        length, offset = np.array(s["length"]), np.array(s["offset"])
        q = np.asarray(words, float) + offset + length
        tip = np.tile([-length[0], 0.0, -length[1]], (len(q), 1))
        n_z = np.array([s["squareness"]["EB0Z"], -s["squareness"]["EA0Z"], 1e6]) * 1e-6
        for axis, at, n in (("X", q[:, 0], np.array([1.0, 0.0, 0.0])), ("Z", q[:, 1], n_z)):
            d, e = self.table(axis, at)
            tip = at[:, None] * n + d + rotation(e, tip)
        one = s["spindle"]
        line = np.array([one["EB0S"] * 1e-6, -one["EA0S"] * 1e-6, 1.0])
        face = np.array([one["EX0S"] * 1e-3, one["EY0S"] * 1e-3, 0.0]) + line * s["face"]
        axis = line / np.linalg.norm(line)
        away = tip - face
        z = away @ axis
        # The shortest turn of Z onto the axis keeps the side of X; only the length counts for the radius.
        across = away - z[:, None] * axis
        side = np.sign(across[:, 0])
        return np.stack([side * np.linalg.norm(across, axis=1), z + s["face"] - offset[1]], axis=1)

    def solved(self, places):
        """Words at which the tip is at (r, z)."""
        x = np.array(places, float)
        for _ in range(6):
            x = x + places - self.places(x)
        return x
