"""What a protocol can tell: the truth's own column against every rival's, after set-up, in noises.

Nothing of the product's numbers is used. A part of the truth is *determined* where no rival family of `rivals`, free
in all its coefficients and beside the other parts of the truth, brings its column within SINE of itself and within
SIGMAS noises, and where its own textbook form foretells the corners of the volume to REACH of what the part does there.
"""

import math

from machine import AXES, Row

SINE, SIGMAS, REACH = 0.3, 6.0, 0.3
MOST_READINGS = 200       # beyond which a design is thinned evenly, for time
LIMIT = {"angular": 300.0,    # urad: no carriage of a machine tool turns by more on its way
         "pitch": 15.0,       # um: nor does a turn of a screw err by more
         "instrument-drift": 50.0}   # um: nor does an instrument walk by more while a file is read


class Space:
    """An orthonormal basis that grows."""

    def __init__(self, columns=()):
        self.basis = []
        for column in columns:
            self.add(column)

    def left(self, column):
        """What of a column lies outside."""
        out = list(column)
        for _ in range(2):
            for base in self.basis:
                share = sum(a * b for a, b in zip(base, out))
                if share:
                    out = [o - share * b for o, b in zip(out, base)]
        return out

    def add(self, column):
        size = norm(column)
        rest = self.left(column)
        length = norm(rest)
        if size > 0 and length > 1e-7 * size:
            self.basis.append([v / length for v in rest])

    def copy(self):
        other = Space()
        other.basis = list(self.basis)
        return other


def norm(column):
    return math.sqrt(sum(v * v for v in column))


def legendre(order, value, low, high):
    """P_order on the interval, the end's value beyond."""
    u = max(-1.0, min(1.0, 2 * (value - low) / (high - low) - 1)) if high > low else 0.0
    before, now = 1.0, u
    if order == 0:
        return 1.0
    for n in range(1, order):
        before, now = now, ((2 * n + 1) * u * now - n * before) / (n + 1)
    return now


def setup(measure, machine):
    """Columns that belong to the set-up: three shifts a run, three angles (of each run where these are turned)."""
    forms = []
    for run in sorted({row.run for row in measure.rows}):
        for k in range(3):
            forms.append(lambda row, run=run, k=k: [float(row.run == run and j == k) for j in range(3)])
    groups = sorted({row.run for row in measure.rows}) if measure.run_turn else [None]
    for group in groups:
        for k in range(3):
            def spin(row, group=group, k=k):
                if group is not None and row.run != group:
                    return [0.0, 0.0, 0.0]
                tip = [q + t for q, t in zip(row.q, row.tool or machine.tool)]
                out = [0.0, 0.0, 0.0]
                out[(k + 1) % 3], out[(k + 2) % 3] = -tip[(k + 2) % 3], tip[(k + 1) % 3]
                return out
            forms.append(spin)
    return forms


def spans(rows):
    return [(min(r.q[k] for r in rows), max(r.q[k] for r in rows)) for k in range(3)]


def curve_forms(axis, component, span, orders):
    low, high = span[axis]
    return [lambda row, n=n: [legendre(n, row.q[axis], low, high) if k == component else 0.0 for k in range(3)]
            for n in orders]


def angle_forms(machine, axis, about, span, orders):
    low, high = span[axis]
    a, b = (about + 1) % 3, (about + 2) % 3

    def form(row, n):
        turn, lever = legendre(n, row.q[axis], low, high) / 1000, machine.lever(axis, row)
        out = [0.0, 0.0, 0.0]
        out[a], out[b] = -turn * lever[b], turn * lever[a]
        return out
    return [lambda row, n=n: form(row, n) for n in orders]


def pitch_forms(axis, period, harmonics=(1, 2)):
    out = []
    for n in harmonics:
        for wave in (math.sin, math.cos):
            out.append(lambda row, n=n, wave=wave: [wave(2 * math.pi * n * row.q[axis] / period) if k == axis else 0.0
                                                    for k in range(3)])
    return out


def side_forms(axis, component):
    return [lambda row: [-float(row.dirs[axis]) if k == component else 0.0 for k in range(3)]]


def order_forms(rows, comps):
    """Slow walks in the order of the rows, over all of them and within each run."""
    total = max(1.0, max(row.time for row in rows))
    longest = max(1.0, max(row.run_time for row in rows))
    out = []
    for k in comps:
        for n in (1, 2):
            out.append(lambda row, k=k, n=n: [(row.time / total) ** n if j == k else 0.0 for j in range(3)])
            out.append(lambda row, k=k, n=n: [(row.run_time / longest) ** n if j == k else 0.0 for j in range(3)])
    return out


def square_of(component, axis):
    """The squareness that shares the slope of a straightness, or the scale that shares a positioning's."""
    if component == axis:
        return f"scale.{AXES[axis]}"
    return "squareness." + "".join(sorted(AXES[component] + AXES[axis]))


def rivals(measure, machine):
    """Families of effects: (ids, forms)."""
    rows, out = measure.rows, []
    span = spans(rows)
    moved = [k for k in range(3) if span[k][1] > span[k][0]]
    for axis in moved:
        for component in range(3):
            name = "positioning" if axis == component else "straightness"
            ids = {f"{name}.E{AXES[component]}{AXES[axis]}", square_of(component, axis)}
            out.append((ids, curve_forms(axis, component, span, range(1, 6))))
        for about in range(3):
            out.append(({f"angular.E{'ABC'[about]}{AXES[axis]}"}, angle_forms(machine, axis, about, span, range(1, 5))))
        if any(row.dirs[axis] for row in rows) and measure.write_dirs:
            for component in range(3):
                name = f"backlash.{AXES[axis]}" if axis == component else f"lost-motion.E{AXES[component]}{AXES[axis]}"
                out.append(({name}, side_forms(axis, component)))
        for period in periods():
            out.append(({f"pitch.{AXES[axis]}"}, pitch_forms(axis, period)))
    out.append(({"instrument-drift"}, order_forms(rows, range(3))))
    return out


def periods():
    """Periods of a screw from 1 to 60 mm, 7 % apart."""
    return [1.07 ** n for n in range(61)]


def aliases(measure, part):
    """Other periods of the same screw that even steps show alike."""
    if not part.effect.startswith("pitch"):
        return []
    axis, period = AXES.index(part.effect[-1]), part.facts["period"]
    places = sorted({row.q[axis] for row in measure.rows})
    steps = sorted(b - a for a, b in zip(places, places[1:]) if b - a > 0.5)
    if not steps:
        return []
    step, out = steps[len(steps) // 2], []
    for turns in [n for k in range(1, 9) for n in (k, -k)]:
        other = 1 / period + turns / step
        if abs(other) > 1e-4 and 0.5 < 1 / abs(other) < 200:
            out.append(({"pitch of another period"}, pitch_forms(axis, 1 / abs(other))))
    return out


def textbook(part, machine, span):
    """Forms of the library for a part of the truth."""
    effect = part.effect
    kind, _, what = effect.partition(".")
    if kind in ("positioning", "straightness"):
        return curve_forms(AXES.index(what[2]), AXES.index(what[1]), span, range(1, 6))
    if kind == "angular":
        return angle_forms(machine, AXES.index(what[2]), "ABC".index(what[1]), span, range(0, 5))
    if kind == "pitch":
        return pitch_forms(AXES.index(what), part.facts["period"])
    return [lambda row: [value / max(part.size, 1e-9) for value in part.displacement(row)]]


def thinned(measure):
    """The same design with fewer rows where it has very many: each row then counts for `weight`."""
    from copy import copy
    rows = measure.rows
    each = len(measure.column(lambda row: (0.0, 0.0, 0.0))) / len(rows)
    most = int(MOST_READINGS / each)
    if len(rows) <= most:
        return measure, 1.0
    small = copy(measure)
    every = len(rows) / most
    small.rows = [rows[int(i * every)] for i in range(most)]
    return small, every


def noise_is_known(measure, machine):
    """Repeats of a command in or between runs, a stated uncertainty, or neighbours nearer than a quarter of the box."""
    if measure.write_u:
        return True
    seen = {}
    for row in measure.rows:
        key = (row.q, row.dirs, row.tool)
        seen[key] = seen.get(key, 0) + 1
    if sum(n - 1 for n in seen.values()) >= 12:
        return True
    span = spans(measure.rows)
    diagonal = math.sqrt(sum((high - low) ** 2 for low, high in span))
    ways = sorted(math.dist(a.q, b.q) for a, b in zip(measure.rows, measure.rows[1:]) if a.run == b.run)
    return bool(ways) and ways[len(ways) // 2] < diagonal / 4


def part_rms(measure, machine, part):
    """RMS of a part in the readings after set-up, um."""
    small, _ = thinned(measure)
    space = Space([small.column(form) for form in setup(small, machine)])
    left = space.left(small.column(part.displacement))
    return norm(left) / math.sqrt(max(1, len(left)))


def nearest_rival(measure, machine, part, others):
    """(sine, noises, ids) of the rival that comes nearest to a part."""
    small, weight = thinned(measure)
    truth = small.column(part.displacement)
    base = Space([small.column(form) for form in setup(small, machine)])
    span = spans(small.rows)
    for other in others:
        base.add(small.column(other.displacement))
        if part.effect not in sibling_ids(other.effect):
            for form in siblings(other, machine, span):
                base.add(small.column(form))
    for form in siblings(part, machine, span):
        base.add(small.column(form))
    alone = base.left(truth)
    full = norm(alone)
    noises = math.sqrt(weight) / max(small.noise, small.step / math.sqrt(12))
    best = (1.0, full * noises, "")
    if full * noises < 1e-6:
        return (0.0, 0.0, "set-up")
    same = {part.effect} | sibling_ids(part.effect)
    for ids, forms in rivals(small, machine) + aliases(small, part):
        if ids & same:
            continue
        near = base.copy()
        known = len(near.basis)
        for form in forms:
            near.add(small.column(form))
        if len(near.basis) == known:
            continue
        own = Space()
        own.basis = near.basis[known:]
        left = norm(own.left(alone))
        if left / full < best[0] and possible(full, small, ids, forms, base):
            best = (left / full, left * noises, "+".join(sorted(ids)))
    return best


def possible(full, measure, ids, forms, base):
    """Is an angle, or a walk, that would do the same one that carriages and instruments have? Others always are."""
    limit = min((LIMIT[name.partition(".")[0]] for name in ids if name.partition(".")[0] in LIMIT), default=None)
    if limit is None:
        return True
    strongest = max((norm(base.left(measure.column(form))) for form in forms), default=0.0)
    return strongest > 0 and full / strongest < limit


def siblings(part, machine, span):
    """Forms whose part in a curve belongs to another name: its slope, or an angle's constant."""
    kind, _, what = part.effect.partition(".")
    if kind in ("positioning", "straightness"):
        return curve_forms(AXES.index(what[2]), AXES.index(what[1]), span, (1,))
    if kind == "angular":
        return angle_forms(machine, AXES.index(what[2]), "ABC".index(what[1]), span, (0,))
    return []


def sibling_ids(effect):
    """Names that a right answer may carry beside an effect, or that are the same motion of the tool."""
    kind, _, what = effect.partition(".")
    if kind == "positioning":
        return {f"scale.{what[1]}"}
    if kind == "straightness":
        same = {square_of(AXES.index(what[1]), AXES.index(what[2]))}
        return same | {f"sag.{what[2]}"} if what[1] == "Z" else same
    if kind == "angular":
        about = "ABC".index(what[1])
        return {"squareness." + "".join(sorted(AXES[k] for k in range(3) if k != about))}
    if kind in ("instrument-drift", "warmup"):
        return {"instrument-drift"} | {f"warmup.{letter}" for letter in AXES}
    return set()


def corner_reach(measure, machine, part, others):
    """Standard uncertainty of the part at the corners of the volume over what it does there (RMS)."""
    small, weight = thinned(measure)
    span = spans(small.rows)
    base = Space([small.column(form) for form in setup(small, machine)])
    for other in others:
        for form in textbook(other, machine, span):
            base.add(small.column(form))
    noise = max(small.noise, small.step / math.sqrt(12)) / math.sqrt(weight)
    sides = [[float(s) for s in (1, 1, 1)], [-1.0, -1.0, -1.0]]
    corners = [Row("", (machine.at(0, a), machine.at(1, b), machine.at(2, c)), side)
               for a in (0.05, 0.95) for b in (0.05, 0.95) for c in (0.05, 0.95) for side in sides]
    forms, own, places = textbook(part, machine, span), Space(), []
    size = math.sqrt(sum(v * v for r in corners for v in part.displacement(r)) / len(corners))
    uncertain = 0.0
    for form in forms:
        column = base.left(small.column(form))
        there = [v for r in corners for v in form(r)]
        for base_column, base_there in zip(own.basis, places):
            share = sum(a * b for a, b in zip(base_column, column))
            column = [c - share * b for c, b in zip(column, base_column)]
            there = [c - share * b for c, b in zip(there, base_there)]
        length = norm(column)
        if length < 1e-7 * max(1e-30, norm(small.column(form))):
            continue
        own.basis.append([c / length for c in column])
        places.append([c / length for c in there])
        uncertain += noise ** 2 * sum(v * v for v in places[-1]) / len(corners)
    return math.sqrt(uncertain) / size if size else 0.0
