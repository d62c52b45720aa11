"""Kinds read along one axis or a few lines: interferometer, dial."""

import machine as parts
from machine import AXES, Machine, Row
from protocols import Case, one_run, passes, shared, somewhere, targets_of


def one_line(random):
    """1: one line beside the axis, one reading a place, three to five passes."""
    m = Machine(random)
    m.tool = random.choice(((0.0, 0.0, 0.0), m.tool))
    a = random.randrange(3)
    which = random.random()
    if which < .45:
        truth = [(parts.curve(random, m, a, a), shared(random)), (parts.scale(a), random.choice((0, 3)))]
    elif which < .7:
        truth = [(parts.scale(a), shared(random))]
    elif which < .85:
        truth = [(parts.curve(random, m, a, a), shared(random)), (parts.play(a), 2)]
    else:
        arm = m.lever(a, Row("", (100., 100., 100.)))
        seen = [b for b in range(3) if b != a and any(arm[k] for k in range(3) if k not in (a, b))]
        truth = [(parts.angle(random, m, a, random.choice(seen)) if seen else parts.scale(a), shared(random))]
    truth = [(p, s) for p, s in truth if s]
    even, count, one = random.random() < .5, random.choice((3, 5)), one_run(random)

    def build(machine, places, targets):
        at = somewhere(machine, places, .08, .3)
        return passes("c", a, at, targets_of(machine, targets, a, 11, not even), count, (a,), one_run=one)
    return Case("one_line", m, truth, build, random.choice((.4, .8, 1.5)), u=random.random() < .3)


def two_lines(random):
    """1, made good: the same axis along three lines, where an angle has levers."""
    m = Machine(random)
    a = m.order[0]
    seen = [k for k in range(3) if k != a]
    b = random.choice(seen)                        # the lines differ in b, so the turn about the third axis shows
    about = 3 - a - b
    options = (parts.angle(random, m, a, about), parts.curve(random, m, a, a), parts.scale(a))
    truth = [(random.choice(options), shared(random))]

    def build(machine, places, targets):
        rows = []
        for number, share in enumerate((.08, .5, .92)):
            at = somewhere(machine, places, .3, .7)
            at[b] = round(machine.at(b, share), 2)
            rows += passes(f"l{number}", a, at, targets_of(machine, targets, a, 11), 3, (a,))
        return rows
    return Case("two_lines", m, truth, build, random.choice((.4, .8, 1.5)))


def iso_230_2(random):
    """1: ISO 230-2 on three axes, each through the middle, five times both ways, the axis' own deviation only."""
    m = Machine(random)
    truth = []
    for a in range(3):
        form = random.choice((parts.curve(random, m, a, a), parts.scale(a), parts.play(a), None))
        if form:
            truth.append((form, shared(random)))
    one = random.random() < .5

    def build(machine, places, targets):
        at = [machine.at(k, .5) for k in range(3)]
        return [r for a in range(3)
                for r in passes(AXES[a], a, at, targets_of(machine, targets, a, 11), 5, (a,), one_run=one)]
    return Case("iso_230_2", m, truth, build, random.choice((.4, .8, 1.5)))


def even_drift(random):
    """2: ISO 230-2 on one axis, the instrument or the spindle walks evenly, no column of time."""
    m = Machine(random)
    a = random.randrange(3)
    count, one = random.choice((2, 3, 5)), one_run(random)
    truth = [(parts.drift(a, count * 22 * 8.0), shared(random))]
    if random.random() < .3:
        truth.append((parts.play(a), 3))

    def build(machine, places, targets):
        return passes("c", a, somewhere(machine, places), targets_of(machine, targets, a, 11), count, (a,), one_run=one)
    return Case("even_drift", m, truth, build, random.choice((.4, .8, 1.5)))


def cold_runs(random):
    """2: each run begins cold and grows with a time constant, no column of time."""
    m = Machine(random)
    a = random.randrange(3)
    count = random.choice((3, 5))
    truth = [(parts.warm(a, random.choice((40.0, 90.0, 200.0)), True), shared(random))]

    def build(machine, places, targets):
        line = targets_of(machine, targets, a, 11)
        return passes("c", a, somewhere(machine, places), line, count, (a,), one_run=False)
    return Case("cold_runs", m, truth, build, random.choice((.4, .8, 1.5)))


def warm_up(random):
    """A machine that warms up while three lines are read again and again, with time."""
    m = Machine(random)
    comp = random.randrange(3)
    truth = [(parts.warm(comp, random.choice((300.0, 700.0)), False), shared(random))]

    def build(machine, places, targets):
        rows = []
        at = somewhere(machine, places)
        lists = [targets_of(machine, targets, a, 7) for a in range(3)]
        for number in range(4):
            for a in range(3):
                rows += passes(f"{AXES[a]}{number}", a, at, lists[a], 1, (0, 1, 2))
        return rows
    return Case("warm_up", m, truth, build, random.choice((.5, 1.0)), time=True, seconds=10.0)


def exchanged(random):
    """4: directions exchanged, or commanded minus measured."""
    m = Machine(random)
    a = random.randrange(3)
    truth = [(parts.play(a), shared(random))]

    def build(machine, places, targets):
        return passes("c", a, somewhere(machine, places), targets_of(machine, targets, a, 11), 3, (a,), one_run=False)
    return Case("exchanged", m, truth, build, random.choice((.4, .8, 1.5)), flip=random.choice(("dirs", "sign")))


def aliased(random):
    """5: even steps that a whole number of turns of the screw divides, or nearly."""
    m = Machine(random)
    a = random.randrange(3)
    period = random.choice((5.0, 10.0, 4.0, 6.0, 12.0, 16.0))
    low, high = m.travel[a]
    step = max(1, int((high - low) * .092 / period)) * period + random.choice((0.0, 0.0, period / 11, period / 2))
    truth = [(parts.pitch(random, a, period), random.choice((6, 10, 16)))]
    count, one = int((high - low) * .96 / step), one_run(random)

    def build(machine, places, targets):
        first = machine.travel[a][0] + places.uniform(1, 5)
        line = [first + i * step for i in range(count)]
        return passes("c", a, somewhere(machine, places), line, 3, (a,), one_run=one)
    return Case("aliased", m, truth, build, random.choice((.4, .8)))


def odd_period(random):
    """7: a screw of any lead from 1 to 60 mm, uneven places, coarse or fine, three axes."""
    m = Machine(random)
    a = random.randrange(3)
    period = random.choice((random.uniform(1, 60), 12.7, 6.35, 7.3, 9.42, 25.4, 5.08))
    truth = [(parts.pitch(random, a, period), random.choice((3, 5, 10)))]
    count = random.choice((40, 65, 130))

    def build(machine, places, targets):
        rows = []
        for axis in range(3):
            at = somewhere(machine, places)
            for number in range(2):
                line = sorted(round(machine.at(axis, targets.uniform(.03, .97)), 4) for _ in range(count))
                rows += passes(f"{AXES[axis]}{number}", axis, at, line, 1, (0, 1, 2), both=False)
        return rows
    return Case("odd_period", m, truth, build, random.choice((.5, 1.0)), u=random.random() < .5)


def collision(random):
    """10: play, and a knock somewhere between the passes, places repeated."""
    m = Machine(random)
    a = random.randrange(3)
    one = one_run(random)
    truth = [(parts.play(a), random.choice((3, 5))),
             (parts.step(a, random.randrange(1, 4) * 22 + random.randrange(6, 17)), random.choice((5, 10, 16)))]

    def build(machine, places, targets):
        return passes("c", a, somewhere(machine, places), targets_of(machine, targets, a, 11), 5, (a,), one_run=one)
    return Case("collision", m, truth, build, random.choice((.4, .8, 1.5)), time=random.random() < .5)


def dial(random):
    """11: a dial of 0.01 mm along one line or three."""
    m = Machine(random)
    axes = random.choice(((0,), (1,), (0, 1, 2)))
    options = (parts.play(axes[0]), parts.scale(axes[0]), parts.curve(random, m, axes[0], axes[0]))
    truth = [(random.choice(options), random.choice((3, 6, 10)))]
    if random.random() < .3:
        truth = [(parts.scale(axes[0]), .15)]
    one = one_run(random)

    def build(machine, places, targets):
        at = somewhere(machine, places)
        return [r for a in axes
                for r in passes(AXES[a], a, at, targets_of(machine, targets, a, 9), 3, (a,), one_run=one)]
    return Case("dial", m, truth, build, 3.0, step=10.0, offset=.7)
