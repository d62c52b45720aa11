"""Kinds read as lengths: ball bars, diagonals, gauges, callipers."""

import math

import machine as parts
from kinds_volumes import any_square
from machine import AXES, PAIRS, Machine, Row
from protocols import Case, shared


def circles(random):
    """ISO 230-4: three planes by ball bar, both senses, as lengths."""
    m = Machine(random)
    m.tool = (0.0, 0.0, 0.0)
    options = [(parts.squareness(pair), shared(random)) for pair in PAIRS]
    options += [(parts.play(a), shared(random)) for a in range(3)]
    options.append((parts.scale(random.randrange(3)), shared(random)))
    random.shuffle(options)
    truth = options[:random.choice((1, 2, 3))]

    def build(machine, places, targets):
        radius = random_radius(machine)
        centre = [round(machine.at(k, places.uniform(.45, .55)), 1) for k in range(3)]
        rows = []
        for i, j in ((0, 1), (1, 2), (2, 0)):
            for sense in (1, -1):
                start = targets.uniform(0, 5)
                for n in range(72):
                    phi = math.radians(start + 5 * n) * sense
                    q, dirs = list(centre), [0, 0, 0]
                    q[i], q[j] = centre[i] + radius * math.cos(phi), centre[j] + radius * math.sin(phi)
                    for axis, speed in ((i, -math.sin(phi) * sense), (j, math.cos(phi) * sense)):
                        dirs[axis] = 0 if abs(speed) < .02 else int(math.copysign(1, speed))
                    name = AXES[i] + AXES[j] + ("+" if sense > 0 else "-")
                    rows.append(Row(name, [round(v, 4) for v in q], dirs, ball=centre))
        return rows
    return Case("circles", m, truth, build, random.choice((.5, 1.0)), "length", offset=.2)


def random_radius(machine):
    return min(150.0, min((high - low) * .42 for low, high in machine.travel))


def diagonals(random):
    """ISO 230-6: the four body diagonals by interferometer, five times both ways."""
    m = Machine(random)
    m.tool = (0.0, 0.0, 0.0)
    truth = [(any_square(random), shared(random)), (parts.scale(random.randrange(3)), random.choice((0, 3, 6)))]
    truth = [(p, s) for p, s in truth if s]
    one = random.random() < .3                     # one diagonal only

    def build(machine, places, targets):
        rows = []
        for number, (sx, sy) in enumerate(((1, 1), (-1, 1), (1, -1), (-1, -1))):
            if one and number:
                break
            ends = [[.04, .96][:: sx], [.04, .96][:: sy], [.04, .96]]
            shares = [min(1., max(0., (i + targets.uniform(-.3, .3)) / 10)) for i in range(11)]
            ball = [machine.at(k, ends[k][0] - .03 * (ends[k][1] - ends[k][0])) for k in range(3)]
            for n in range(3):
                for side in (1, -1):
                    for s in shares[::side]:
                        q = [round(machine.at(k, ends[k][0] + s * (ends[k][1] - ends[k][0])), 4) for k in range(3)]
                        dirs = [side * (1 if ends[k][1] > ends[k][0] else -1) for k in range(3)]
                        rows.append(Row(f"d{number}", q, dirs, ball=[round(b, 4) for b in ball]))
        return rows
    return Case("diagonals", m, truth, build, random.choice((.5, 1.0)), "length", offset=.2)


def lengths_10360(random):
    """ISO 10360-2: five lengths, three times, in seven directions of the volume."""
    m = Machine(random)
    m.tool = (0.0, 0.0, 0.0)
    truth = [(random.choice((parts.scale(random.randrange(3)), any_square(random))), shared(random))]
    if random.random() < .5:
        truth.append((parts.scale(random.randrange(3)), 4))

    def build(machine, places, targets):
        rows = []
        for number, way in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, 1, 1), (1, -1, 1), (-1, -1, 1))):
            start = [machine.at(k, {1: .05, -1: .95, 0: .5}[way[k]]) for k in range(3)]
            end = [machine.at(k, {1: .93, -1: .07, 0: .5}[way[k]]) for k in range(3)]
            shares = [share * targets.uniform(.92, 1) for share in (.2, .4, .6, .8, 1)]
            for n in range(3):
                for s in shares:
                    rows.append(Row(f"w{number}", [round(a + s * (b - a), 4) for a, b in zip(start, end)],
                                    ball=[round(a, 4) for a in start]))
        return rows
    return Case("lengths_10360", m, truth, build, random.choice((.5, 1.0)), "length", dirs=False, offset=.2)


def bar(random):
    """A ball bar on a magnetic base at several places of the table, the tip all over a hemisphere."""
    m = Machine(random)
    m.tool = (0.0, 0.0, 0.0)
    truth = [(any_square(random), shared(random)), (parts.scale(random.randrange(3)), shared(random))]
    if random.random() < .3:
        truth.append((parts.angle(random, m, m.order[0], random.randrange(3)), 3))

    def build(machine, places, targets):
        rows, radius = [], min(150.0, (machine.travel[2][1] - machine.travel[2][0]) * .8,
                               (machine.travel[1][1] - machine.travel[1][0]) * .35)
        for number in range(4):
            ball = [machine.at(k, places.uniform(0, 1)) for k in range(3)]
            for k in (0, 1):
                low, high = machine.travel[k]
                ball[k] = round(min(high - radius - 2, max(low + radius + 2, ball[k])), 2)
            ball[2] = round(machine.travel[2][0] + 5, 2)
            for n in range(24):
                phi, up = targets.uniform(0, 6.283), targets.uniform(0.02, .98)
                flat = math.sqrt(1 - up * up)
                way = (flat * math.cos(phi), flat * math.sin(phi), up)
                q = [b + radius * w for b, w in zip(ball, way)]
                for _ in range(2):
                    rows.append(Row(f"b{number}", [round(v, 4) for v in q], ball=ball))
        return rows
    return Case("bar", m, truth, build, random.choice((.7, 1.5)), "length", dirs=False, offset=.2)


def printed_square(random):
    """Three lengths of a printed square (AC, BD, AD) by caliper, four prints: too little for a name."""
    m = Machine(random, [(0., 220.), (0., 220.), (0., 250.)])
    m.tool = (0.0, 0.0, 0.0)
    truth = [(parts.squareness("XY"), random.choice((2, 6))), (parts.scale(0), random.choice((0, 2)))]
    truth = [(p, s) for p, s in truth if s]
    for part, _ in truth:
        part.limit *= 10
    prints = random.choice((1, 4, 10))

    def build(machine, places, targets):
        a, b, c, d = (60., 60., 1.), (160., 60., 1.), (160., 160., 1.), (60., 160., 1.)
        return [Row(f"s{n}", tip, ball=ball) for n in range(prints) for tip, ball in ((c, a), (d, b), (d, a))]
    return Case("printed_square", m, truth, build, 20.0, "length", dirs=False, step=10.0, offset=.3)
