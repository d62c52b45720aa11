"""The hidden machine: three axes on a chain, crooked by parts whose shapes are not the product's.

Lengths of places are millimetres, displacements micrometres, angles microradians, times seconds. A displacement is
that of the tool's tip against its command, seen from the workpiece (ISO 230-1 signs of squareness).
"""

import math

AXES = "XYZ"
PAIRS = {"XY": (0, 1, -1.0), "XZ": (0, 2, 1.0), "YZ": (1, 2, -1.0)}  # moved component, axis that moves it, sign
CHAINS = ("w X Y b Z t", "w b X Y Z t", "w Y X b Z t", "w X b Y Z t", "w b Y X Z t")


class Row:
    """One reading: command `q`, approach `dirs`, tool vector, `time` since the start and `run_time` since the run's."""

    __slots__ = ("run", "q", "dirs", "tool", "time", "run_time", "ball", "comps", "number")

    def __init__(self, run, q, dirs=(0, 0, 0), ball=None, comps=(0, 1, 2), tool=None):
        self.run, self.q, self.dirs, self.ball, self.comps, self.tool = run, tuple(q), tuple(dirs), ball, comps, tool
        self.time = self.run_time = 0.0
        self.number = 0


class Machine:
    """Travel of each axis, order of the axes from workpiece to tool, default tool vector, and the hidden parts."""

    def __init__(self, random, travel=None, chain=None):
        self.travel = travel or [
            (0.0, float(random.randrange(300, 801, 10))),
            (0.0, float(random.randrange(240, 501, 10))),
            random.choice(((0.0, 200.0), (-300.0, 0.0), (-200.0, 50.0), (-400.0, 0.0))),
        ]
        self.chain = chain or random.choice(CHAINS)
        self.order = [AXES.index(letter) for letter in self.chain.split() if letter in AXES]
        self.tool = (0.0, 0.0, random.choice((0.0, 0.0, -80.0, -120.0)))
        self.parts = []

    def at(self, axis, share):
        """Place of an axis by its share of the travel, mm."""
        low, high = self.travel[axis]
        return low + share * (high - low)

    def lever(self, axis, row):
        """From the carriage of `axis` to the tip, mm: the axes behind it in the chain, and the tool."""
        tool = row.tool or self.tool
        behind = self.order[self.order.index(axis) + 1:]
        return [tool[k] + (row.q[k] if k in behind else 0.0) for k in range(3)]

    def displacement(self, row, parts=None):
        """Sum of the parts' displacements for a row, um."""
        total = [0.0, 0.0, 0.0]
        for part in self.parts if parts is None else parts:
            for k, value in enumerate(part.displacement(row)):
                total[k] += value
        return total

    def profile(self, name):
        """The profile that the shop has: the nominal machine, TOML."""
        lines = ["format  = 1", f'name    = "{name}"', 'control = "fanuc"', f'chain   = "[{self.chain}]"',
                 'calibrated = { date = "2026-01-01", temperature_c = 20.0, instrument = "nominal" }']
        for axis, letter in enumerate(AXES):
            low, high = self.travel[axis]
            lines += ["", f"[axis.{letter}]", f"travel_mm     = [{low:g}, {high:g}]", "resolution_mm = 0.0001"]
        lines += ["", "[tool]", "default_mm = [{:g}, {:g}, {:g}]".format(*self.tool), ""]
        return "\n".join(lines)


class Part:
    """A fault: effect id, whether it stays while the machine stands there (`static`), its size, its form of size 1."""

    def __init__(self, effect, form, limit, static=True, **facts):
        self.effect, self.form, self.limit, self.static, self.facts = effect, form, limit, static, facts
        self.size = 1.0

    def displacement(self, row):
        return [self.size * value for value in self.form(row)]


def vector(component, value):
    out = [0.0, 0.0, 0.0]
    out[component] = value
    return out


def smooth(random, low, high, keep_line=False, count=3):
    """A curve of some sines of random phase, largest value near 1; without its best line over the travel."""
    waves = [(random.gauss(0, 1) / k ** 1.3, k * random.uniform(0.8, 1.2), random.uniform(0, 6.283))
             for k in range(1, count + 1)]

    def raw(value):
        u = (value - low) / (high - low)
        return sum(a * math.sin(math.pi * k * u + p) for a, k, p in waves)

    places = [low + (high - low) * i / 60 for i in range(61)]
    middle = (low + high) / 2
    mean = sum(map(raw, places)) / 61
    slope = sum(raw(q) * (q - middle) for q in places) / sum((q - middle) ** 2 for q in places)
    slope = 0.0 if keep_line else slope
    top = max(abs(raw(q) - mean - slope * (q - middle)) for q in places)
    return lambda value: (raw(value) - mean - slope * (value - middle)) / top


def scale(axis):
    """Size in um/m."""
    return Part(f"scale.{AXES[axis]}", lambda row: vector(axis, row.q[axis] / 1000), 400)


def squareness(pair):
    """Size in urad."""
    moved, mover, sign = PAIRS[pair]
    return Part(f"squareness.{pair}", lambda row: vector(moved, sign * row.q[mover] / 1000), 900)


def curve(random, machine, axis, component, count=3):
    """Positioning (component = axis) or straightness, size its largest value, um."""
    form = smooth(random, *machine.travel[axis], count=count)
    name = "positioning" if axis == component else "straightness"
    return Part(f"{name}.E{AXES[component]}{AXES[axis]}", lambda row: vector(component, form(row.q[axis])), 60)


def angle(random, machine, axis, about, count=3):
    """Roll, pitch or yaw of a carriage, size its largest value, urad."""
    form = smooth(random, *machine.travel[axis], keep_line=True, count=count)
    a, b = (about + 1) % 3, (about + 2) % 3

    def displacement(row):
        turn, lever = form(row.q[axis]) / 1000, machine.lever(axis, row)
        out = [0.0, 0.0, 0.0]
        out[a], out[b] = -turn * lever[b], turn * lever[a]
        return out

    return Part(f"angular.E{'ABC'[about]}{AXES[axis]}", displacement, 120, axis=axis)


def pitch(random, axis, period):
    """Error within a turn of the screw: a wave and its half as small second harmonic, size um."""
    p1, p2, second = random.uniform(0, 6.283), random.uniform(0, 6.283), random.uniform(0, 0.35)

    def displacement(row):
        phase = 2 * math.pi * row.q[axis] / period
        return vector(axis, math.sin(phase + p1) + second * math.sin(2 * phase + p2))

    return Part(f"pitch.{AXES[axis]}", displacement, 15, period=period)


def play(axis, component=None):
    """Backlash, or sideways lost motion, size the half width in um: coming from below the axis stands short."""
    moved = axis if component is None else component
    name = f"backlash.{AXES[axis]}" if moved == axis else f"lost-motion.E{AXES[moved]}{AXES[axis]}"
    return Part(name, lambda row: vector(moved, -row.dirs[axis]), 40)


def drift(component, total_time):
    """An even walk over all rows, size in um over `total_time`."""
    return Part("instrument-drift", lambda row: vector(component, row.time / total_time), 80, static=False)


def warm(component, tau, per_run):
    """Growth with a time constant, from the first row on or with each run anew, size um."""
    def displacement(row):
        return vector(component, 1 - math.exp(-(row.run_time if per_run else row.time) / tau))
    return Part(f"warmup.{AXES[component]}", displacement, 60, static=False)


def step(component, number):
    """A knock: a shift from the row of that number on, size um."""
    return Part(f"step.{AXES[component]}", lambda row: vector(component, float(row.number >= number)), 60, static=False)


def field(random, machine, limit):
    """What no axis does alone: waves across the volume, longer than half an axis, size um. No name of a library."""
    waves = []
    for _ in range(4):
        way = [random.gauss(0, 1) for _ in range(3)]
        size = math.sqrt(sum(w * w for w in way))
        length = random.uniform(150, 400)
        push = [random.gauss(0, .6) for _ in range(3)]
        waves.append(([w / size / length for w in way], random.uniform(0, 6.283), push))

    def displacement(row):
        out = [0.0, 0.0, 0.0]
        for way, phase, push in waves:
            value = math.sin(6.283 * sum(w * q for w, q in zip(way, row.q)) + phase)
            for k in range(3):
                out[k] += push[k] * value
        return out
    return Part("field", displacement, limit)
