"""A lathe that turns test pieces: first principles, nothing shared with the product or with the other judges.

Frames: machine millimetres, X a radius, Z along the spindle. The command (x, z) puts the tip of a tool with the vector
t = -length at `p = (x, 0, 0) + t + (EXZ(z), 0, 0) + z n_Z`, n_Z = (EB0Z, -EA0Z, 1). The workpiece turns about the line
through (EX0S, EY0S, 0) along (EB0S, -EA0S, 1); with a tailstock, from that line's point at the chuck's face to the
tailstock's point at (-dX3, -dY3). r is the distance of p from it plus what the bar gives way; the place along it is its
foot (docs/equations.md (71), (73), (75)). Bars are even, their deflections closed formulas (Roark, beams, 1a, 1c, 1e).
"""

import csv
import math
import os
import tomllib

import numpy as np


def deflection(clamping, z, length, diameter, e_gpa):
    """mm/N at the place z of a unit force on an even round bar."""
    ei = e_gpa * 1e3 * math.pi * diameter**4 / 64
    if clamping == "chuck":
        return z**3 / (3 * ei)
    if clamping == "centres":
        return z**2 * (length - z) ** 2 / (3 * ei * length)
    return z**3 * (length - z) ** 2 * (4 * length - z) / (12 * ei * length**3)


class Lathe:
    """Numbers of one machine; `straightness` (machine Z of the carriage, mm, array) -> EXZ, mm."""

    def __init__(self, numbers, straightness=None):
        self.numbers = numbers
        self.straightness = straightness or (lambda z: 0.0 * z)

        def get(key):
            return float(numbers.get(key, 0.0))

        self.n_z = np.array([get("EB0Z_urad") * 1e-6, -get("EA0Z_urad") * 1e-6, 1.0])
        lean = np.array([get("EB0S_urad") * 1e-6, -get("EA0S_urad") * 1e-6, 1.0])
        self.face = get("face_mm")
        self.origin = np.array([get("EX0S_um") * 1e-3, get("EY0S_um") * 1e-3, 0.0]) + lean * self.face
        self.piece = numbers.get("workpiece")
        tail = numbers.get("tailstock")
        self.clamping = self.piece["clamping"] if self.piece else ("centres" if tail else "chuck")
        if tail and self.clamping != "chuck":
            off = np.array(tail.get("offset_um", [0, 0]), float) * 1e-3
            lean = np.array([-off[0], -off[1], self.face + tail["at_mm"]]) - self.origin
        self.along = lean / np.linalg.norm(lean)
        self.end = tail["at_mm"] if tail else None

    def bending(self, z):
        """mm of radius at machine Z."""
        if not self.piece or not self.piece.get("radial_force_n"):
            return 0.0 * z
        length = self.end if self.end and self.clamping != "chuck" else self.piece["length_mm"]
        s = np.clip(z - self.face, 0.0, length)
        return self.piece["radial_force_n"] * deflection(self.clamping, s, length, self.piece["diameter_mm"], self.piece["e_gpa"])

    def tip(self, x, z, length=(0.0, 0.0)):
        """Machine point n x 3 of the tip, for commands x, z (mm, radius) of a tool of that length (x, z)."""
        x, z = np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))
        p = z[..., None] * self.n_z
        p[..., 0] += x - length[0] + self.straightness(z)
        p[..., 2] -= length[1]
        return p

    def turned(self, x, z, length=(0.0, 0.0)):
        """(r, place along the axis in machine Z), mm, of what the tip leaves there."""
        rel = self.tip(x, z, length) - self.origin
        along = rel @ self.along
        foot = rel - along[..., None] * self.along
        ex = np.array([1.0, 0.0, 0.0]) - self.along[0] * self.along
        ex /= np.linalg.norm(ex)
        ey = np.cross(self.along, ex)
        across = foot @ ex + self.bending(along + self.face)
        return np.sign(across) * np.hypot(across, foot @ ey), along + self.face

    def command(self, r, z, length=(0.0, 0.0)):
        """(x, z) to command so that this machine leaves radius r at place z."""
        x, q = np.asarray(r, float) + length[0], np.asarray(z, float) + length[1]
        for _ in range(30):
            got = self.turned(x, q, length)
            x, q = x + (r - got[0]), q + (z - got[1])
        return x, q


def of_profile(path):
    """The machine that a profile tells of. Raises KeyError, ValueError where it holds what this reader has no place for."""
    with open(path, "rb") as file:
        profile = tomllib.load(file)
    spindle = profile.get("spindle", {})
    numbers = {key: spindle.get(key, 0.0) for key in ("EX0S_um", "EY0S_um", "EA0S_urad", "EB0S_urad", "face_mm")}
    numbers |= profile.get("squareness", {})
    if any(spindle.get("centre_mm", [0, 0])) or any(profile.get("headstock", {}).get("offset_um", [0, 0])):
        raise ValueError("centre or headstock: no place for them here")
    if "tailstock" in profile:
        numbers["tailstock"] = profile["tailstock"]
    if "workpiece" in profile:
        piece = profile["workpiece"]
        (_, first), (length, last) = piece["diameters_mm"]
        if first != last:
            raise ValueError("only even bars")
        numbers["workpiece"] = {"clamping": piece["clamping"], "radial_force_n": piece.get("radial_force_n", 0), "diameter_mm": first, "length_mm": length, "e_gpa": piece["e_gpa"]}
    if profile.get("effect"):
        raise ValueError("[[effect]]: no place for it here")
    if "errors" in profile["axis"]["X"]:
        raise ValueError("tables of X: no place for them here")
    straightness = None
    table = profile["axis"]["Z"].get("errors")
    if table:
        with open(os.path.join(os.path.dirname(path), table), newline="") as file:
            rows = list(csv.DictReader(file))
        other = [k for k in rows[0] if k not in ("position_mm", "EXZ_um") and any(float(r[k] or 0) for r in rows)]
        if other:
            raise ValueError(f"columns {other} of the table of Z: no place for them here")
        at = np.array([float(r["position_mm"]) for r in rows])
        value = np.array([float(r["EXZ_um"]) for r in rows]) * 1e-3
        straightness = lambda z: np.interp(z, at, value)  # noqa: E731
    return Lathe(numbers, straightness)
