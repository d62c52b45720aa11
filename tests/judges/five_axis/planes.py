"""Tilted working planes of Fanuc and its like, from what manuals say of their words, and the angles that bring a tool to them.

G68.2 X Y Z I J K      P0: Euler angles: I about Z, J about the new X, K about the new Z; R = Rz(I) Rx(J) Rz(K)
G68.2 P1 Q123 … I J K  roll, pitch, yaw about the workpiece's X (I), Y (J), Z (K), which stand; Q: in which order
G68.2 P2 Q1 .. Q3      three points: the zero, one on +X, one on the side of +Y; Q0: a shift from the first, here zero
G68.2 P3 Q1, Q2        two vectors: zero and direction of X, direction of Z

X Y Z of a plane's zero count from the work offset. Sources: the words of P1 in Mazak's Vortex i manual, 4-25 (easymanua.ls); the
turn of P1 and the words of P2 and P3 as LinuxCNC's pull request 4374 and public posts write them.
"""

import math

import numpy as np

from machine import UNIT, turn


def about(axis, degrees):
    return turn([np.radians(degrees) * np.array(UNIT[axis], float)])[0]


def unit(v):
    size = np.linalg.norm(v)
    if not size > 0:
        raise ValueError("a vector of no length")
    return v / size


def plane(parts, scale, wrong=None):
    """Rotation (columns: the plane's axes in the workpiece) and zero of the blocks {Q: words} so far; None where some are missing."""
    last = list(parts.values())[-1]
    p = int(last.get("P", 0))
    vector = lambda words, names, size=1.0: np.array([words.get(n, 0.0) for n in names]) * size  # noqa: E731
    if p in (0, 1):
        i, j, k = vector(last, "IJK")
        zero = vector(last, "XYZ", scale)
        if p == 0 and wrong == "euler":
            return about("X", i) @ about("Z", j) @ about("X", k), zero
        if p == 0:
            return about("Z", i) @ about("X", j) @ about("Z", k), zero
        out = np.eye(3)
        for digit in str(int(last["Q"])):
            out = about("XYZ"[int(digit) - 1], (i, j, k)[int(digit) - 1]) @ out
        return (out.T if wrong == "euler" else out), zero
    if p == 2:
        if not {1, 2, 3} <= set(parts):
            return None
        one, two, three = (vector(parts[q], "XYZ", scale) for q in (1, 2, 3))
        x = unit(two - one)
        z = unit(np.cross(x, three - one))
        out = np.stack([x, np.cross(z, x), z], axis=1)
        return (out.T if wrong == "euler" else out), one
    if p == 3:
        if not {1, 2} <= set(parts):
            return None
        x, z = unit(vector(parts[1], "IJK")), unit(vector(parts[2], "IJK"))
        out = np.stack([x, np.cross(z, x), z], axis=1)
        return (out.T if wrong == "euler" else out), vector(parts[1], "XYZ", scale)
    raise ValueError(f"P{p}")


def solutions(machine, normal):
    """All pairs of angles (-180, 180], degrees, at which an ideal machine's tool stands along `normal` in the workpiece."""
    rot = np.array([[a, b] for a in range(-180, 180, 24) for b in range(-180, 180, 24)], float)
    zero = np.zeros((len(rot), 3))
    way = lambda r: machine.place(zero, r, zero[0])[1]  # noqa: E731
    for _ in range(40):
        off = way(rot) - normal
        jac = np.stack([(way(rot + e) - way(rot - e)) / 2e-3 for e in np.eye(2) * 1e-3], axis=2)
        rot = rot - np.clip((np.linalg.pinv(jac, rcond=1e-9) @ off[..., None])[..., 0], -30, 30)
    good = np.linalg.norm(way(rot) - normal, axis=1) < 1e-11
    rot = (rot[good] + 180) % 360 - 180
    out = []
    for r in rot:
        if all(np.abs((r - o + 180) % 360 - 180).max() > 1e-6 for o in out):
            out.append(r)
    return out


def turns(angle, travel):
    """The angle by whole turns in travel."""
    low, high = travel
    first = math.ceil((low - angle) / 360 - 1e-12)
    return [angle + 360 * k for k in range(first, first + 20) if low - 1e-9 <= angle + 360 * k <= high + 1e-9]


def by_rule(machine, normal, now, spec, opposite=False):
    """The angles that G53.1 turns to on a machine whose rule is spec["branch"] ("A+") and spec["turn"]."""
    letter, sign = spec["branch"]
    at = machine.rotary.index(letter)
    out = []
    for angles in solutions(machine, normal):
        if (angles[at] > 0) != ((sign == "+") != opposite):
            continue
        choice = []
        for k, name in enumerate(machine.rotary):
            fit = turns(angles[k], spec["rotary"][name]["travel"])
            if spec["turn"] == "principal":
                fit = [v for v in fit if -180 < v <= 180]
            choice.append(min(fit, key=lambda v: abs(v - now[k])) if fit else None)
        if None not in choice:
            out.append(np.array(choice))
    if len(out) != 1:
        raise ValueError(f"{len(out)} ways to the plane")
    return out[0]
