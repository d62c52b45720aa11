"""A crooked machine of three axes, and its profile."""

import math

import numpy as np

NODES = np.linspace(-100.0, 500.0, 25)
AXES = "XYZ"


def played(commanded_mm, half_mm):
    """Where axes with play stand whose screws were commanded so (n, 3), mm: each is dragged along half its play behind;
    at first it stands in the middle."""
    places = np.array(commanded_mm, dtype=float)
    for axis, half in enumerate(half_mm):
        if half == 0.0:
            continue
        column = places[:, axis].tolist()
        stands = column[0]
        for row, command in enumerate(column):
            stands = min(max(stands, command - half), command + half)
            column[row] = stands
        places[:, axis] = column
    return places


class Machine:
    """X and Y carry the workpiece's side, Z the tool's: errors of the tip against the workpiece."""

    half_play_um = (0.0, 0.0, 0.0)

    def __init__(self, chance):
        self.zero_mm = np.array([chance.uniform(100, 200) for _ in AXES])
        self.squareness_urad = {name: chance.uniform(-500, 500) for name in ("EC0Y", "EB0Z", "EA0Z")}
        self.tables_um = {axis: [self.function(chance, own=(axis == to)) for to in AXES] for axis in AXES}

    @staticmethod
    def function(chance, own):
        """A deviation over the travel, um: a slope, a wave, where the axis itself is meant a pitch error too."""
        slope = chance.uniform(-0.1, 0.1) if own else chance.uniform(-0.02, 0.02)
        size, period, phase = chance.uniform(0, 6), chance.uniform(120, 400), chance.uniform(0, 2 * math.pi)
        return [round(slope * q + size * math.sin(2 * math.pi * q / period + phase), 4) for q in NODES]

    def error_mm(self, at_mm):
        """Real tip less commanded tip at axis commands (n, 3), first order, mm."""
        error = np.zeros_like(at_mm)
        for number, axis in enumerate(AXES):
            for to in range(3):
                error[:, to] += np.interp(at_mm[:, number], NODES, self.tables_um[axis][to]) * 1e-3
        return error + self.leaning_mm(at_mm)

    def leaning_mm(self, at_mm):
        """What axes that are not square make of it, mm."""
        error = np.zeros_like(at_mm)
        x, y, z = 0, 1, 2
        # ISO 230-1: above 90 degrees between +X and +Y, below 90 between +X and +Z, above 90 between +Y and +Z.
        error[:, x] -= self.squareness_urad["EC0Y"] * 1e-6 * at_mm[:, y]
        error[:, x] += self.squareness_urad["EB0Z"] * 1e-6 * at_mm[:, z]
        error[:, y] -= self.squareness_urad["EA0Z"] * 1e-6 * at_mm[:, z]
        return error

    def tip_mm(self, commanded_mm):
        """Where the tip was, mm, while the axes were commanded so, one row after the other."""
        half_mm = np.array(self.half_play_um) * 1e-3
        return played(commanded_mm, half_mm) + self.error_mm(commanded_mm)

    def write(self, folder):
        """Its profile; the offset is a true one."""
        lines = ['format = 1', 'name = "rig"', 'control = "linuxcnc"', 'chain = "[w b X Y Z t]"']
        for axis in AXES:
            head = "position_mm," + ",".join(f"E{to}{axis}_um" for to in AXES)
            rows = zip(NODES, *self.tables_um[axis])
            table = "\n".join([head, *(",".join(f"{value:.4f}" for value in row) for row in rows)])
            (folder / f"{axis}.csv").write_text(table + "\n")
            play = 2 * self.half_play_um[AXES.index(axis)]
            backlash = f", backlash_um = {play:.4f}" if play else ""
            lines.append(f'axis.{axis} = {{ errors = "{axis}.csv", resolution_mm = 0.001{backlash} }}')
        angles = ", ".join(f"{name}_urad = {value:.6f}" for name, value in self.squareness_urad.items())
        zero = ", ".join(f"{place:.6f}" for place in self.zero_mm)
        lines += [f"squareness = {{ {angles} }}", f'work_offsets_mm = {{ G54 = {{ at = [{zero}], zero = "true" }} }}']
        path = folder / "machine.toml"
        path.write_text("\n".join(lines) + "\n")
        return path
