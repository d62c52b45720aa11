"""Programs as posts write them, each with the path that it programs, program coordinates, mm."""

import math

import numpy as np

CHORDS = 3000


class Writer:
    """Blocks, and where they lead."""

    def __init__(self, mode):
        self.blocks = ["G21 G90 G17 G40 G49 G80 G54 G94", *([mode] if mode else [])]
        self.path = []

    def rapid(self, **to):
        self.to("G0", to)

    def feed(self, f=None, **to):
        self.to("G1", to, f)

    def to(self, code, to, f=None):
        at = dict(zip("xyz", self.path[-1])) if self.path else {"x": 0.0, "y": 0.0, "z": 0.0}
        to = {axis: round(place, 3) for axis, place in to.items()}
        words = " ".join(f"{axis.upper()}{place:.3f}" for axis, place in to.items())
        self.blocks.append(f"{code} {words}" + (f" F{f:.0f}" if f else ""))
        self.path.append([(at | to)[axis] for axis in "xyz"])

    def dwell(self, seconds):
        self.blocks.append(f"G4 P{seconds:g}")

    def arc(self, code, centre, to, z=None, f=None):
        """Clockwise G2, counter-clockwise G3 about `centre` to `to`; a helix where z is given."""
        at = self.path[-1]
        i, j = round(centre[0] - at[0], 3), round(centre[1] - at[1], 3)
        end_z = at[2] if z is None else z
        words = f"X{to[0]:.3f} Y{to[1]:.3f}" + (f" Z{end_z:.3f}" if z is not None else "") + f" I{i:.3f} J{j:.3f}"
        self.blocks.append(f"{code} {words}" + (f" F{f:.0f}" if f else ""))
        start = math.atan2(at[1] - centre[1], at[0] - centre[0])
        turn = math.atan2(to[1] - centre[1], to[0] - centre[0]) - start
        sense = -1 if code == "G2" else 1
        turn = sense * ((sense * turn) % (2 * math.pi) or 2 * math.pi)
        radius = math.dist(at[:2], centre)
        for k in range(1, CHORDS + 1):
            angle = start + turn * k / CHORDS
            place = [centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)]
            self.path.append([*place, at[2] + (end_z - at[2]) * k / CHORDS])

    def text(self):
        return ("\n".join([*self.blocks, "G0 Z20.000", "M2"]) + "\n").encode()


def begin(writer, x, y, z, f):
    writer.rapid(x=x, y=y, z=20.0)
    writer.rapid(z=2.0)
    writer.feed(z=z, f=f)


def plate(writer, chance):
    """A contour of lines with corners of many angles."""
    begin(writer, 10, 10, -2.0, 1200)
    corners = [(90, 10), (90, 40), (60, 55), (95, 80), (30, 90), (10, 60), (40, 50), (10, 10)]
    for k, (x, y) in enumerate(corners):
        writer.feed(x=x + chance.uniform(-4, 4), y=y + chance.uniform(-4, 4), f=3000 if k == 0 else None)


def arcs(writer, chance):
    """A slot of two half circles, run twice."""
    r = round(chance.uniform(8, 15), 3)
    begin(writer, 20, 20, -1.0, 1500)
    for _ in range(2):
        writer.feed(x=80, f=3000)
        writer.arc("G3", (80, 20 + r), (80, 20 + 2 * r))
        writer.feed(x=20)
        writer.arc("G3", (20, 20 + r), (20, 20))


def wave(writer, chance):
    """Short segments, as from a spline."""
    size = chance.uniform(3, 10)
    begin(writer, 5, 50, -1.0, 1500)
    for k in range(1, 181):
        writer.feed(x=5 + 0.5 * k, y=50 + size * math.sin(k / 12), z=-1 + 0.3 * math.sin(k / 20), f=2400 if k == 1 else None)


def raster(writer, chance):
    """Lines forth and back over a dome."""
    begin(writer, 10, 10, 0.0, 1500)
    for row in range(6):
        xs = np.linspace(10, 70, 25)
        for x in xs if row % 2 == 0 else xs[::-1]:
            writer.feed(x=x, y=10 + 4 * row, z=4 - ((x - 40) ** 2 + (4 * row - 10) ** 2) / 300, f=3000)


def helix(writer, chance):
    """A pocket by a helix and a spring pass."""
    r = round(chance.uniform(6, 14), 3)
    begin(writer, 50 + r, 50, 0.5, 1500)
    for turn in range(1, 4):
        writer.arc("G3", (50, 50), (50 + r, 50), z=0.5 - turn, f=2400)
    writer.arc("G3", (50, 50), (50 + r, 50))


def zigzag(writer, chance):
    """Corners of a few degrees."""
    begin(writer, 10, 20, -1.0, 1500)
    for k in range(1, 14):
        writer.feed(x=10 + 6 * k + chance.uniform(-2, 2), y=20 if k % 2 == 0 else 70, f=4000)


KINDS = {kind.__name__: kind for kind in (plate, arcs, wave, raster, helix, zigzag)}


def make(kind, mode, chance):
    """Text and path of a program."""
    writer = Writer(mode)
    KINDS[kind](writer, chance)
    return writer.text(), np.array(writer.path)
