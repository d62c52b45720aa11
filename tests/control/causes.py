"""Machines of a few causes, each with the name that a diagnosis has for it."""

import math

import numpy as np

from machine import AXES, Machine

TRAVEL_MM = {"X": (0.0, 400.0), "Y": (0.0, 300.0), "Z": (0.0, 200.0)}
TOLERANCE_UM = 0.5  # a twentieth of what is to be corrected is not to be the tolerance
SQUARENESS = {"XY": "EC0Y", "XZ": "EB0Z", "YZ": "EA0Z"}


def legendre(order, share):
    """P2 or P3 at a share of the travel from -1 to 1."""
    return (3 * share**2 - 1) / 2 if order == 2 else (5 * share**3 - 3 * share) / 2


class Caused(Machine):
    """X and Y carry the workpiece, Z the tool; lengths in machine mm, deviations in um, real less nominal."""

    def __init__(self, chance, count):
        self.zero_mm = np.array([round(chance.uniform(*ends), 3) for ends in ((120, 280), (120, 280), (60, 140))])
        self.squareness_urad = dict.fromkeys(SQUARENESS.values(), 0.0)
        self.half_play_um = [0.0, 0.0, 0.0]
        self.functions = []
        self.causes = {}
        kinds = [self.lean, self.scale, self.screw, self.play, self.bend]
        while len(self.causes) < count:
            chance.choice(kinds)(chance)

    @staticmethod
    def size(chance, low, high):
        return chance.choice((-1, 1)) * chance.uniform(low, high)

    def add(self, name, words, axis=None, to=None, function=None):
        """A cause of that name, once; `function` of the axis' place moves the tip along `to`, um."""
        self.causes[name] = words
        if function:
            self.functions = [one for one in self.functions if one[0] != name] + [(name, axis, to, function)]

    def lean(self, chance):
        pair = chance.choice(sorted(SQUARENESS))
        angle = self.size(chance, 150, 500)
        self.squareness_urad[SQUARENESS[pair]] = angle
        self.add(f"squareness.{pair}", f"{angle:.1f} urad")

    def scale(self, chance):
        axis = chance.randrange(3)
        slope = self.size(chance, 80, 250)
        self.add(f"scale.{AXES[axis]}", f"{slope:.1f} um/m", axis, axis, lambda q: slope * 1e-3 * q)

    def screw(self, chance):
        axis = chance.randrange(3)
        lead, size, phase = chance.choice((5.0, 8.0, 10.0, 16.0)), chance.uniform(4, 10), chance.uniform(0, 2 * math.pi)
        self.add(
            f"pitch.{AXES[axis]}",
            f"{size:.2f} um every {lead} mm",
            axis,
            axis,
            lambda q: size * np.sin(2 * math.pi * q / lead + phase),
        )

    def play(self, chance):
        axis = chance.randrange(3)
        half = chance.uniform(5, 15)
        self.half_play_um[axis] = half
        self.add(f"backlash.{AXES[axis]}", f"half {half:.2f} um")

    def bend(self, chance):
        axis, to = chance.sample(range(3), 2)
        order, size = chance.choice((2, 3)), self.size(chance, 8, 25)
        low, high = TRAVEL_MM[AXES[axis]]
        self.add(
            f"straightness.E{AXES[to]}{AXES[axis]}",
            f"{size:.2f} um of P{order}",
            axis,
            to,
            lambda q: size * legendre(order, (2 * q - low - high) / (high - low)),
        )

    def error_mm(self, at_mm):
        """Real tip less commanded tip at axis commands (n, 3), first order, play apart, mm."""
        error = self.leaning_mm(at_mm)
        for _, axis, to, function in self.functions:
            error[:, to] += function(at_mm[:, axis]) * 1e-3
        return error

    def write(self, folder):
        """A profile that knows none of this; its zero was touched."""
        lines = ['format = 1', 'name = "rig"', 'control = "linuxcnc"', 'chain = "[w b X Y Z t]"']
        for axis in AXES:
            low, high = TRAVEL_MM[axis]
            lines.append(f"axis.{axis} = {{ travel_mm = [{low}, {high}], resolution_mm = 0.0001 }}")
        zero = ", ".join(f"{place:.6f}" for place in self.zero_mm)
        lines.append(f"correction = {{ tolerance_um = {TOLERANCE_UM} }}")
        lines.append(f'work_offsets_mm = {{ G54 = {{ at = [{zero}], zero = "touched" }} }}')
        path = folder / "machine.toml"
        path.write_text("\n".join(lines) + "\n")
        return path
