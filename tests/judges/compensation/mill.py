"""A crooked mill of three linear axes, from docs/equations.md (5) to (8). mm."""

import numpy as np


class Mill:
    def __init__(self, spec):
        self.spec = spec
        self.order = [k for k in spec["chain"].strip("[] ").split() if k in ("X", "Y", "Z")]

    def tip(self, q, length):
        """Where the tip is for commands (n, 3), with a tool of that length."""
        x = np.tile([0.0, 0.0, -length], (len(q), 1))
        yx, zx, zy = (self.spec["squareness"][k] * 1e-6 for k in ("EC0Y", "EB0Z", "EA0Z"))
        lean = {"X": (1, 0, 0), "Y": (-yx, 1, 0), "Z": (zx, -zy, 1)}
        for k in reversed(self.order):
            at, data = q[:, "XYZ".index(k)], self.spec["tables"].get(k)
            d, e = np.zeros((len(q), 3)), np.zeros((len(q), 3))
            if data:
                f = np.stack([np.interp(at, data["at"], np.array(data["rows"])[:, n]) for n in range(6)], axis=1)
                d, e = f[:, :3] * 1e-3, f[:, 3:] * 1e-6
            size = np.linalg.norm(e, axis=1)[:, None]
            safe = np.maximum(size, 1e-9)
            one = np.cross(e, x)
            x = x + np.where(size < 1e-9, 1, np.sin(safe) / safe) * one + np.where(size < 1e-9, 0.5, (1 - np.cos(safe)) / safe**2) * np.cross(e, one)
            x = x + at[:, None] * np.array(lean[k], float) + d
        return x

    def real(self, words):
        """Where the tip is for words (n, 3), in the program's coordinates."""
        zero, length = np.array(self.spec["offset"]), self.spec["length"]
        return self.tip(words + zero + [0, 0, length], length) - zero

    def solved(self, places):
        x = places.copy()
        for _ in range(6):
            x = x + places - self.real(x)
        return x

    def gradient(self, places):
        """Largest change of the error with the place, mm per mm."""
        step, out = 0.5, 0.0
        for k in range(2):
            d = np.zeros(3)
            d[k] = step
            both = (self.real(places + d) - d) - (self.real(places - d) + d)
            out = max(out, float(np.linalg.norm(both, axis=1).max()) / (2 * step))
        return out
