"""Kinds read in a volume: lines, scattered points, tracker, cube, plates; and heights over a plane."""

import machine as parts
from machine import AXES, PAIRS, Machine, Row
from protocols import Case, one_run, passes, shared, somewhere, targets_of


def any_square(random):
    return parts.squareness(random.choice(list(PAIRS)))


def any_part(random, m):
    """A fault that a mill has."""
    a = random.randrange(3)
    kind = random.choice("sqqpcctal")
    if kind == "s":
        return parts.scale(a)
    if kind == "q":
        return any_square(random)
    if kind == "p":
        return parts.play(a)
    if kind == "l":
        return parts.play(a, random.choice([k for k in range(3) if k != a]))
    if kind == "a":
        return parts.angle(random, m, m.order[0], random.randrange(3))
    return parts.curve(random, m, a, a if kind == "c" else random.choice([k for k in range(3) if k != a]))


def play_three(random):
    """6: play of three axes, guide's own lines, three components."""
    m = Machine(random)
    truth = [(parts.play(a), random.choice((2, 3, 6, 10))) for a in range(3)]

    def build(machine, places, targets):
        rows = []
        for number in range(3):
            at = somewhere(machine, places)
            for a in range(3):
                rows += passes(f"{AXES[a]}{number}", a, at, targets_of(machine, targets, a, 11), 1, (0, 1, 2))
        return rows
    return Case("play_three", m, truth, build, random.choice((.5, 1.0, 2.0)))


def volume(random):
    """A good design: three lines an axis, both ways, twice, three components, one diagonal a plane."""
    m = Machine(random)
    truth = [(any_part(random, m), shared(random)) for _ in range(random.choice((1, 1, 2, 3)))]

    def build(machine, places, targets):
        rows = []
        for number, share in enumerate((.1, .5, .9)):
            for a in range(3):
                at = [round(machine.at(k, places.uniform(-.05, .05) + share), 2) for k in range(3)]
                if number == 1:
                    for k, low in (((a + 1) % 3, .1), ((a + 2) % 3, .9)):
                        at[k] = round(machine.at(k, low), 2)
                rows += passes(f"{AXES[a]}{number}", a, at, targets_of(machine, targets, a, 9), 2, (0, 1, 2))
        return rows
    return Case("volume", m, truth, build, random.choice((.5, 1.0, 2.0)), turn=random.choice((0, 300)))


def scattered(random):
    """3: scattered points, each read once, a real gap of any shape; a robot's size in a third of them."""
    m = Machine(random)
    large = random.choice((1, 1, 20))
    field = parts.field(random, m, 300 * large)
    truth = [(field, random.choice((4, 6, 10)))]
    count = random.choice((30, 60))

    def build(machine, places, targets):
        return [Row("r" + str(i * 2 // count), somewhere(machine, targets, .03, .97)) for i in range(count)]
    return Case("scattered", m, truth, build, 2.0 * large, dirs=False, positions=large > 1)


def tracker(random):
    """A tracker from one station, points of a grid in random order, frame turned."""
    m = Machine(random)
    truth = [(any_square(random), shared(random)), (parts.scale(random.randrange(3)), shared(random))]
    if random.random() < .4:
        truth.append((any_part(random, m), 3))
    told = random.random() < .5
    station = (m.at(0, .5) + 100, m.travel[1][0] - 1800, m.at(2, .5) + 300)

    def build(machine, places, targets):
        rows = []
        for number in range(2):
            nodes = [(a, b, c) for a in range(5) for b in range(4) for c in range(3)]
            targets.shuffle(nodes)
            shift = targets.uniform(-.04, .04)
            for node in nodes:
                shares = [.06 + (shift if 0 < n < count - 1 else 0) + .88 * n / (count - 1)
                          for n, count in zip(node, (5, 4, 3))]
                rows.append(Row(f"t{number}", [round(machine.at(k, share), 2) for k, share in enumerate(shares)]))
        return rows
    return Case("tracker", m, truth, build, random.choice((4.0, 8.0)), dirs=False, turn=400,
                positions=random.random() < .7, station=station if told else None)


def cube(random):
    """Three traverses along the edges of a cube (Pimushkin 2023), no direction, read once."""
    m = Machine(random, [(0., 400.), (0., 300.), (0., 300.)])
    truth = [(parts.squareness(pair), random.choice((3, 6, 10))) for pair in PAIRS]
    truth += [(parts.scale(a), random.choice((3, 6))) for a in range(3)]
    if random.random() < .5:
        truth.append((parts.curve(random, m, 0, random.randrange(3)), 2))
    side, step = random.choice(((240, 15), (315, 15), (240, 10)))
    side = min(side, 285)

    def build(machine, places, targets):
        corner = [5.0 + places.uniform(0, 8) for _ in range(3)]
        shift = targets.uniform(0, 5)
        rows = []
        for a in range(3):
            line = [corner[a] + shift + i * step for i in range(int(side / step))]
            rows += passes("XYZ"[a], a, corner, line, 1, (0, 1, 2), both=False)
        return rows
    return Case("cube", m, truth, build, random.choice((2.0, 4.0)), dirs=False, turn=200, positions=True)


def drilled(random):
    """Twelve plates drilled alike and measured by CMM, each laid down with an angle of its own."""
    m = Machine(random)
    options = (parts.curve(random, m, 0, 0), parts.curve(random, m, 1, 0), parts.squareness("XY"))
    truth = [(parts.scale(0), random.choice((4, 8))), (parts.scale(1), random.choice((0, 4))),
             (random.choice(options), random.choice((3, 6)))]
    truth = [(p, s) for p, s in truth if s]
    plates, holes = 12, 40
    told = random.random() < .5

    def build(machine, places, targets):
        where = [[round(machine.at(k, targets.uniform(.05, .95)), 2) for k in (0, 1)] for _ in range(holes)]
        return [Row(f"p{n:02d}", (x, y, machine.at(2, .3)), comps=(0, 1)) for n in range(plates) for x, y in where]
    return Case("drilled", m, truth, build, random.choice((3.0, 5.0)), dirs=False, run_turn=80, offset=3.0,
                artefact=told)


def surface(random, m, strong=1.0):
    """What bends a bed or a table as a probe in Z sees it: two waves, since few nodes show no more."""
    options = [parts.curve(random, m, a, 2, 2) for a in (0, 1)]
    first = 0 if m.order.index(0) < m.order.index(1) else 1
    options.append(parts.angle(random, m, first, first, 2))
    random.shuffle(options)
    truth = [(p, shared(random)) for p in options[:random.choice((1, 2))]]
    for part, _ in truth:
        part.limit *= strong
    return truth


def grid(machine, random, nx, ny, low=.05, high=.95, jitter=.0):
    def place(axis, i, count):
        shift = jitter * random.uniform(-1, 1) if 0 < i < count - 1 else 0
        return round(machine.at(axis, low + (high - low) * i / (count - 1) + shift), 2)
    return [(place(0, i, nx), place(1, j, ny)) for j in range(ny) for i in range(nx)]


def plate(random):
    """A probe on a surface plate: heights of a grid, twice."""
    m = Machine(random)
    m.tool = (0.0, 0.0, 0.0)

    def build(machine, places, targets):
        z = round(machine.at(2, places.uniform(.1, .3)), 2)
        nodes = grid(machine, targets, 8, 6, jitter=.02)
        return [Row(f"g{n}", (x, y, z), comps=(2,)) for n in range(2) for x, y in nodes]
    return Case("plate", m, surface(random, m), build, random.choice((.5, 1.0)), dirs=False)


def bed_mesh(random):
    """A printer's bed mesh: Z only, once or three times, display of 2.5 um."""
    m = Machine(random, [(0., 220.), (0., 220.), (0., 250.)])
    m.tool = (0.0, 0.0, 0.0)
    count, side = random.choice((1, 3)), random.choice((5, 7))

    def build(machine, places, targets):
        nodes = grid(machine, targets, side, side, .05, .95, .03)
        return [Row(f"m{n}", (x, y, 5.0), comps=(2,)) for n in range(count) for x, y in nodes]
    return Case("bed_mesh", m, surface(random, m, 4.0), build, 4.0, dirs=False, step=2.5)


def bed_maps(random):
    """A tool changer's bed, mapped five times over months: offsets and tilts of their own."""
    m = Machine(random, [(0., 300.), (0., 300.), (0., 300.)])
    m.tool = (0.0, 0.0, 0.0)

    def build(machine, places, targets):
        nodes = grid(machine, targets, 9, 9, .05, .95, .02)
        return [Row(f"map{n}", (x, y, 2.0), comps=(2,)) for n in range(5) for x, y in nodes]
    return Case("bed_maps", m, surface(random, m, 4.0), build, 6.0, dirs=False, run_turn=100, offset=3.0,
                step=random.choice((0, 2.5)))


def height_gauge(random):
    """A step gauge or a height gauge along Z at one place, three times both ways."""
    m = Machine(random)
    truth = [(random.choice((parts.scale(2), parts.curve(random, m, 2, 2), parts.play(2))), shared(random))]
    one = one_run(random)

    def build(machine, places, targets):
        return passes("h", 2, somewhere(machine, places), targets_of(machine, targets, 2, 13), 3, (2,), one_run=one)
    return Case("height_gauge", m, truth, build, random.choice((.8, 1.5)), step=random.choice((0, 1.0)))


def granite_square(random):
    """A granite square: straightness of X read along one side, of Y along the other, laid down at one place or two."""
    m = Machine(random)
    i, j = random.choice(((0, 1), (0, 2), (1, 2)))
    truth = [(parts.squareness(AXES[i] + AXES[j]), shared(random))]
    if random.random() < .4:
        truth.append((parts.curve(random, m, i, j), 3))

    def build(machine, places, targets):
        at, rows = somewhere(machine, places, .1, .3), []
        for n in range(2):
            rows += passes(f"{AXES[i]}{n}", i, at, targets_of(machine, targets, i, 9, high=.7), 1, (j,))
            rows += passes(f"{AXES[j]}{n}", j, at, targets_of(machine, targets, j, 9, high=.7), 1, (i,))
        return rows
    return Case("granite_square", m, truth, build, random.choice((.5, 1.0)), turn=150)
