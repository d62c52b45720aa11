"""The true machine and what is wrong with it, and what the instrument adds. Written from docs/equations.md and docs/diagnosis.md alone.

A machine is a box of perfect axes with what its profile says (squareness, positioning and straightness tables, play, effects); a fault is a function rows -> (n, 3) um,
the displacement of the tip. First order, as in equation (14): products of errors are nanometres here.
"""

import os

import numpy

from common import folders

from rows import approaches

AXES = "XYZ"


class Machine:
    """travel (3) mm, tool (3) mm; what the profile says is wrong is `known`, a list of faults with the TOML text that says it."""

    def __init__(self, rng, low=250, high=800):
        self.travel = numpy.round(rng.uniform(low, high, 3), -1)
        self.tool = numpy.array([0.0, 0.0, -float(rng.integers(8, 26) * 10)])
        order = "".join(rng.permutation(list(AXES)))
        bed = int(rng.integers(0, 4))
        self.chain = "[w " + " ".join([*order[:bed], "b", *order[bed:], "t"]) + "]"
        self.axis_text = {axis: "" for axis in AXES}
        self.text, self.known, self.tables = "", [], {}

    def profile(self, folder, name="machine.toml"):
        text = f'format = 1\nname = "judged"\ncontrol = "fanuc"\nchain = "{self.chain}"\n'
        text += 'calibrated = { date = "2026-01-15", temperature_c = 20.0, instrument = "simulated" }\n'
        for axis, travel in zip(AXES, self.travel):
            text += f"\n[axis.{axis}]\ntravel_mm = [0, {travel:.0f}]\nresolution_mm = 0.001\n{self.axis_text[axis]}"
        text += "\n[tool]\ndefault_mm = [" + ", ".join(f"{v:.1f}" for v in self.tool) + "]\n" + self.text
        for table, content in self.tables.items():
            folders.put(folder, table, content)
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def predicted(self, rows):
        """What the profile predicts, (n, 3) um."""
        return sum((fault(rows) for fault in self.known), numpy.zeros((len(rows), 3)))


def vector(rows, axis, values):
    out = numpy.zeros((len(rows), 3))
    out[:, axis] = values
    return out


# Faults by the library's own names. Each gives (fault, id, {parameter: value in the profile's unit}).


def scale(axis, um_per_m):
    return lambda r: vector(r, axis, um_per_m * r.q[:, axis] * 1e-3), f"scale.{AXES[axis]}", {"scale_um_per_m": um_per_m}


def backlash(axis, half_um):
    return lambda r: vector(r, axis, -half_um * r.dirs[:, axis]), f"backlash.{AXES[axis]}", {"half_width_um": half_um}


def lost_motion(seen, axis, half_um):
    return lambda r: vector(r, seen, -half_um * r.dirs[:, axis]), f"lost-motion.E{AXES[seen]}{AXES[axis]}", {"half_width_um": half_um}


def squareness(pair, urad):
    """Signs of docs/diagnosis.md: dx = -a y, dx = +a z, dy = -a z, of the tip's place."""
    seen, along, sign = {"XY": (0, 1, -1.0), "XZ": (0, 2, 1.0), "YZ": (1, 2, -1.0)}[pair]
    return lambda r: vector(r, seen, sign * urad * 1e-3 * r.q[:, along]), f"squareness.{pair}", {"angle_urad": urad}


def load(axis, um_per_kg):
    return lambda r: vector(r, axis, -um_per_kg * r.load), f"load.{AXES[axis]}", {"compliance_um_per_kg": um_per_kg}


def lag(axis, ms):
    """The axis is behind by its own speed times the lag; in straight lines of one axis the speed is the feed."""
    return lambda r: vector(r, axis, -ms * axis_speed(r, axis) / 60.0), f"servo-lag.{AXES[axis]}", {"lag_ms": ms}


def axis_speed(rows, axis):
    """Signed speed of an axis, mm/min: its share of the path's feed, by the steps that lead to the places of each run."""
    speed = numpy.zeros(len(rows))
    for _, rs in rows.runs():
        step = approaches(rows.q[rs])
        length = numpy.linalg.norm(step, axis=1)
        speed[rs] = rows.feed[rs] * step[:, axis] / numpy.where(length > 0, length, 1.0)
    return speed


def thermal_shift(axis, um_per_k):
    return lambda r: vector(r, axis, um_per_k * (r.temp - 20.0)), f"thermal.{AXES[axis]}", {"shift_um_per_k": um_per_k}


def thermal(axis, um_per_m_k, fixed_mm=0.0):
    return lambda r: vector(r, axis, um_per_m_k * (r.temp - 20.0) * (r.q[:, axis] - fixed_mm) * 1e-3), f"thermal.{AXES[axis]}", {"expansion_um_per_m_k": um_per_m_k}


def warmup(axis, um, tau_s):
    return lambda r: vector(r, axis, um * (1 - numpy.exp(-r.time / tau_s))), f"warmup.{AXES[axis]}", {"amplitude_um": um}


def curve(rng, length_mm, size_um):
    """A smooth curve with shapes unlike Legendre polynomials: a bend that saturates, a bump, and a slow chirp; range size_um over the travel."""
    a, b, c = rng.uniform(0.2, 0.8), rng.uniform(0.1, 0.9), rng.uniform(0.4, 1.3)
    weights = rng.normal(size=3) + numpy.array([1.5, 1.0, 1.0]) * rng.choice([-1, 1], 3)

    def raw(x):
        u = x / length_mm
        return weights[0] * numpy.tanh(4 * (u - a)) + weights[1] * numpy.exp(-(((u - b) / 0.18) ** 2)) + weights[2] * numpy.sin(2 * numpy.pi * c * u**1.5)

    grid = numpy.linspace(0, length_mm, 400)
    values = raw(grid)
    line = numpy.polyfit(grid, values, 1)
    factor = size_um / numpy.ptp(values - numpy.polyval(line, grid))
    return lambda x: factor * (raw(x) - numpy.polyval(line, x))


def positioning(rng, axis, size_um, machine):
    f = curve(rng, machine.travel[axis], size_um)
    return lambda r: vector(r, axis, f(r.q[:, axis])), f"positioning.E{AXES[axis]}{AXES[axis]}", {}


def straightness(rng, seen, axis, size_um, machine):
    f = curve(rng, machine.travel[axis], size_um)
    return lambda r: vector(r, seen, f(r.q[:, axis])), f"straightness.E{AXES[seen]}{AXES[axis]}", {}


def random_fault(rng, machine, names, size_um=8.0):
    """(fault, id, parameters) of one of the kinds named, of about `size_um` at its largest."""
    axis = int(rng.integers(3))
    other = int((axis + rng.integers(1, 3)) % 3)
    size = size_um * rng.uniform(0.8, 1.4) * rng.choice([-1.0, 1.0])
    kind = names[int(rng.integers(len(names)))]
    if kind == "scale":
        return scale(axis, 2e3 * size / machine.travel[axis])
    if kind == "backlash":
        return backlash(axis, abs(size) * 0.7)
    if kind == "lost-motion":
        return lost_motion(other, axis, size * 0.7)
    if kind == "squareness":
        pair = ("XY", "XZ", "YZ")[int(rng.integers(3))]
        return squareness(pair, 2e3 * size / machine.travel["XYZ".index(pair[1])])
    if kind == "positioning":
        return positioning(rng, axis, 2.5 * abs(size), machine)
    if kind == "straightness":
        return straightness(rng, other, axis, 2.5 * abs(size), machine)
    raise ValueError(kind)


# What the instrument adds. All take (rng, rows) and give (n, 3) um.


def setup(rng, shift_um=15.0, turn_urad=40.0):
    """The measuring frame against the machine: one shift and one small turn of the tip's place."""
    shift, turn = rng.normal(size=3) * shift_um, rng.normal(size=3) * turn_urad
    return lambda r: shift + numpy.cross(turn * 1e-3, r.q + r.tool)


def white(sigma):
    sigma = numpy.broadcast_to(numpy.asarray(sigma, float), 3)
    return lambda rng, r: rng.normal(size=(len(r), 3)) * sigma


def autoregressive(sigma, rho):
    """AR(1) within runs, in the order of measurement, stationary with standard deviation sigma."""

    def draw(rng, r):
        out = rng.normal(size=(len(r), 3))
        for _, rs in r.runs():
            for before, now in zip(rs[:-1], rs[1:]):
                out[now] = rho * out[before] + numpy.sqrt(1 - rho**2) * out[now]
        return sigma * out

    return draw


def walk(sigma, step):
    """White noise and a random walk within each run that starts at 0."""

    def draw(rng, r):
        out = sigma * rng.normal(size=(len(r), 3))
        for _, rs in r.runs():
            out[rs] += numpy.cumsum(step * rng.normal(size=(len(rs), 3)), axis=0)
        return out

    return draw


def quantised(sigma, step):
    """Marks that the readings are to be rounded: see `measure`."""
    draw = white(sigma)
    draw.step_um = step
    return draw


def shifted(sigma, run_sigma):
    def draw(rng, r):
        out = sigma * rng.normal(size=(len(r), 3))
        for _, rs in r.runs():
            out[rs] += run_sigma * rng.normal(size=3)
        return out

    return draw


def turned(sigma, largest_urad, run_sigma=3.0):
    """Every run with a set-up of its own: a shift, and a turn about the middle of its places."""

    def draw(rng, r):
        out = sigma * rng.normal(size=(len(r), 3))
        for _, rs in r.runs():
            turn = rng.normal(size=3)
            turn *= rng.uniform(0.3, 1.0) * largest_urad / numpy.linalg.norm(turn)
            tip = r.q[rs] + r.tool[rs]
            out[rs] += run_sigma * rng.normal(size=3) + numpy.cross(turn * 1e-3, tip - tip.mean(axis=0))
        return out

    return draw


def warming_instrument(sigma, size_um):
    """The instrument's zero drifts by size_um with a time constant of a fifth to a half of the whole measurement; machine errors there are none."""

    def draw(rng, r):
        out = sigma * rng.normal(size=(len(r), 3))
        tau = rng.uniform(0.2, 0.5) * numpy.ptp(r.time)
        direction = rng.normal(size=3)
        return out + size_um * direction / numpy.linalg.norm(direction) * (1 - numpy.exp(-(r.time - r.time.min()) / tau))[:, None]

    return draw


def heavy(sigma):
    """Student's t with three degrees of freedom, scaled to standard deviation sigma."""
    return lambda rng, r: sigma / numpy.sqrt(3.0) * rng.standard_t(3, size=(len(r), 3))


def measure(rng, rows, noise, faults=(), frame=None):
    """Fills in the readings: what is wrong with the machine (known to the profile or not), frame, noise, quantisation."""
    rows.d = rows.machine.predicted(rows) + sum((fault(rows) for fault in faults), numpy.zeros((len(rows), 3))) + noise(rng, rows)
    if frame is not None:
        rows.d = rows.d + frame(rows)
    step = getattr(noise, "step_um", 0.0)
    if step:
        rows.d = numpy.round(rows.d / step) * step
    return rows
