"""Where the words of G68.2 lay a plane: its zero and its turn in the work frame.

By docs/reference.md and docs/dialects.md, which agree with the public descriptions used here: FANUC Series 30i manuals
(B-64484EN, "Tilted working plane indexing": Euler angles Z, new X, new Z; roll, pitch and yaw; three points; two vectors),
Mazak's programming of inclined planes (G68.2 P1 Q123: I about X, J about Y, K about Z, their order by Q), and the G68.2 of
LinuxCNC's tilted work plane by D. Mueller (order 313; X by points 1 and 2, Z = X x (point 3 - point 1)). The last differs
in one thing from the others: its P3 begins with Q0 and counts the first vector from the zero; FANUC's begins with Q1, and a vector is one.
"""

import math

import numpy as np

import machine

EULER = (2, 0, 2)  # I about Z, J about the new X, K about the new Z; the self-test changes it


class Incomplete(Exception):
    pass


def about(axis, degrees):
    v = np.zeros(3)
    v[axis] = math.radians(degrees)
    return machine.rotation(v)


def by_angles(i, j, k):
    """Each turn about an axis as the turns before left it: matrices in the order of the words."""
    return about(EULER[0], i) @ about(EULER[1], j) @ about(EULER[2], k)


def by_axes(x, z=None, beside=None):
    """X along x; Z along z, or where a point lies `beside` X on the side of +Y."""
    x = np.array(x, float) / np.linalg.norm(x)
    z = np.array(z, float) if z is not None else np.cross(x, beside)
    if np.linalg.norm(z) < 1e-9:
        raise Incomplete("no plane")
    z = z / np.linalg.norm(z)
    y = np.cross(z, x)
    return np.stack([x, y / np.linalg.norm(y), z], axis=1)


def frame(blocks, unit):
    """(zero, turn) of the blocks of one plane, each a dictionary of words; `unit`: mm per unit of length."""

    def place(words):
        return np.array([words[k] for k in "XYZ"]) * unit

    def vector(words):
        return np.array([words[k] for k in "IJK"])

    def angles(words):
        # One left out is 0, as in LinuxCNC's; where all are, nothing says where the plane lies.
        if not set("IJK") & set(words):
            raise Incomplete("no angle")
        return [words.get(k, 0.0) for k in "IJK"]

    kind = int(blocks[0].get("P", 0))
    try:
        if kind == 0:
            return place(blocks[0]), by_angles(*angles(blocks[0]))
        if kind == 1:
            given = [(n, v) for n, v in enumerate(angles(blocks[0])) if v != 0.0]
            if len(given) > 1:
                raise Incomplete("several angles")
            return place(blocks[0]), about(*given[0]) if given else np.eye(3)
        by_q = {int(words["Q"]): words for words in blocks}
        if kind == 2:
            one, two, three = (place(by_q[q]) for q in (1, 2, 3))
            return one, by_axes(two - one, beside=three - one)
        return place(by_q[1]), by_axes(vector(by_q[1]), z=vector(by_q[2]))
    except KeyError as missing:
        raise Incomplete(str(missing)) from None


def angles_of(turn):
    """I, J, K (degrees) of a turn by Z, new X, new Z."""
    n = turn[:, 2]
    j = math.degrees(math.atan2(math.hypot(n[0], n[1]), n[2]))
    i = math.degrees(math.atan2(n[0], -n[1])) if j > 1e-9 else 0.0
    rest = (about(2, i) @ about(0, j)).T @ turn
    return i, j, math.degrees(math.atan2(rest[1, 0], rest[0, 0]))
