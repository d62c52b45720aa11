"""What CYCLE800 says: its parameters by position, and the frame that they lay.

Sources, public: SINUMERIK 840D sl and 828D operating manuals, "Swivel plane" (swivel modes, projection, minus and plus,
new and additive, what becomes of programmed frames), the parameter list of the programming manual (as HiNC's reference
of NcArgCycle800 repeats it: bits 7 and 6 of _MODE 00 axis by axis, 01 solid angle, 10 projection, 11 direct; two bits
for each turn, 01 X, 10 Y, 11 Z, the first lowest), and Autodesk's public post for the 840D, which writes 39 for ZXY, 27
ZYX, 57 XYZ, 45 XZY, 30 YZX, 54 YXZ, each turn about an axis as the turns before left it.
"""

import math
import re

import numpy as np

from machine import shift, turn

NAMES = "FR TC ST MODE X0 Y0 Z0 A B C X1 Y1 Z1 DIR FR_I DMODE".split()
LETTERS = {1: (1, 0, 0), 2: (0, 1, 0), 3: (0, 0, 1)}


class Unsure(Exception):
    pass


def arguments(text):
    """The words between the brackets by name; what is left out is 0."""
    given = re.findall(r'\s*("[^"]*"|[^,]*)\s*(?:,|$)', text)
    out = {}
    for name, value in zip(NAMES, given):
        value = value.strip()
        out[name] = value.strip('"') if name == "TC" else float(value or 0)
    return {name: out.get(name, "" if name == "TC" else 0.0) for name in NAMES}


def turned(mode, a, b, c):
    """4x4 of the three angles under a mode."""
    kind, first, second, third = mode >> 6, mode & 3, mode >> 2 & 3, mode >> 4 & 3
    if kind == 0:
        if not (first and second and third):
            raise Unsure("mode %d" % mode)
        return turn(LETTERS[first], a) @ turn(LETTERS[second], b) @ turn(LETTERS[third], c)
    if kind == 1:
        # Solid angle: about Z, then about the new Y.
        return turn(LETTERS[3], a) @ turn(LETTERS[2], b)
    if kind == 2 and (first, second, third) == (1, 2, 3):
        # Projection: the plane cuts YZ at `a` about X and ZX at `b` about Y; the new X lies in the old ZX.
        x = np.array([math.cos(math.radians(b)), 0.0, -math.sin(math.radians(b))])
        y = np.array([0.0, math.cos(math.radians(a)), math.sin(math.radians(a))])
        z = np.cross(x, y)
        z /= np.linalg.norm(z)
        out = np.eye(4)
        out[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
        return out @ turn(LETTERS[3], c)
    raise Unsure("mode %d" % mode)


def frame(words):
    """4x4 of a call: to the reference point, turn, to the new zero."""
    r = turned(int(words["MODE"]), words["A"], words["B"], words["C"])
    return shift([words[k] for k in ("X0", "Y0", "Z0")]) @ r @ shift([words[k] for k in ("X1", "Y1", "Z1")])


def additive(words):
    return int(words["ST"]) % 10 == 1
