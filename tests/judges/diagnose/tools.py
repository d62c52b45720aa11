"""Families stations and circles: trackers whose own errors look like the machine's, and ball bars."""

import numpy

import machine as truth
from answer import INSTRUMENT, ask
from judge import Kind, Outcome
from machine import AXES, Machine, measure, setup, vector
from rows import Rows, lines


def sphere(rows, station):
    """Range (n), azimuth, elevation and the unit vectors of the three, of the tips as seen from a station (3)."""
    v = rows.q + rows.tool - station
    r = numpy.linalg.norm(v, axis=1)
    azimuth, elevation = numpy.arctan2(v[:, 1], v[:, 0]), numpy.arcsin(v[:, 2] / r)
    out = v / r[:, None]
    aside = numpy.stack([-numpy.sin(azimuth), numpy.cos(azimuth), 0 * r], axis=1)
    return r, azimuth, elevation, out, aside, numpy.cross(out, aside)


def tracker_term(rng, kind):
    """A fault of the tracker: (rows, station) -> (n, 3) um. Range in proportion, range zero, eccentric circle of the azimuth, leaning transit axis."""
    sign, phase = rng.choice([-1, 1]), rng.uniform(0, 2 * numpy.pi)

    def fault(rows, station):
        r, azimuth, elevation, out, aside, _ = sphere(rows, station)
        if kind == "range scale":
            return (sign * 45e-3 * r)[:, None] * out
        if kind == "range zero":
            return sign * 80.0 * out
        if kind == "azimuth circle":
            return (sign * 55e-3 * r * numpy.cos(elevation) * numpy.sin(azimuth - phase))[:, None] * aside
        return (sign * 60e-3 * r * numpy.sin(elevation))[:, None] * aside

    return fault


TERMS = ("range scale", "range zero", "azimuth circle", "transit axis")


def stations(count, whose):
    """The same lines from one or two stations, with the tracker's fault or one of the machine's."""

    def play(case):
        rng = case.rng
        machine = Machine(rng, 400, 800)
        turn = rng.uniform(0, 2 * numpy.pi)
        places = [machine.travel / 2 + [1400 * numpy.cos(a), 1400 * numpy.sin(a), rng.uniform(-500, 300)] for a in (turn, turn + rng.uniform(1.5, 2.6))][:count]
        rows, ends = Rows(machine), []
        design = numpy.random.default_rng(int(rng.integers(1 << 30)))
        state = design.bit_generator.state
        for k in range(count):
            design.bit_generator.state = state
            lines(design, machine, 3, 9, 1, rows=rows, name=f"s{k}r")
            ends.append(len(rows.run))
        rows.close()
        at = numpy.searchsorted(ends, numpy.arange(len(rows)), side="right")
        kind = TERMS[case.number % len(TERMS)]
        fault, effect, parameters = truth.random_fault(rng, machine, ("scale", "backlash", "squareness"), 20.0)
        term = tracker_term(rng, kind)
        measure(rng, rows, truth.white(1.5), [fault] if whose == "machine" else [])
        for k, place in enumerate(places):  # each station is tied to the machine by a frame of its own
            mine = at == k
            seen = rows.take(mine)
            rows.d[mine] += setup(rng, 10.0, 20.0)(seen) + (term(seen, place) if whose == "tracker" else 0.0)
        rows.extra["station"] = numpy.array([f"S{k + 1}" for k in at])
        for k, axis in enumerate("xyz"):
            rows.extra[f"b{axis}_mm"] = numpy.array([places[s][k] for s in at])
        right, wrong = [(effect, parameters), ("tracker." + kind.replace(" ", "-"), {})][:: 1 if whose == "machine" else -1]
        case.deserves("NAMED" if count == 2 else "AMBIGUOUS", [(*right, [] if count == 2 else [wrong[0]])])
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        everyone = [e for k in range(len(answer.causes)) for e in [answer.causes[k], *answer.rivals(k)]]
        note = f"{kind if whose == 'tracker' else effect}; found {', '.join(answer.causes)}; rivals {', '.join(sorted(set(everyone) - set(answer.causes)))}"
        if whose == "machine":
            if count == 1:
                return Outcome({"machine's fault in the set": effect in everyone}, answer.verdict, note)
            return Outcome({"told apart": effect in answer.causes[:1] and not any(INSTRUMENT.search(e) for e in answer.causes)}, answer.verdict, note)
        if count == 1:
            return Outcome({"instrument in the set": any(INSTRUMENT.search(e) for e in everyone), "written as a machine's": bool(answer.effects_written)}, answer.verdict, note)
        return Outcome({"told apart": bool(answer.causes) and all(INSTRUMENT.search(e) for e in answer.causes), "written as a machine's": bool(answer.effects_written)}, answer.verdict, note)

    return play


# Circles: faults of the two axes of a plane.


def circle_rows(rng, machine, plane, radius):
    """(rows, centre): full circles both ways at two feeds, a reading every degree; speeds (n, 3) mm/min and way since each axis last turned (n, 3) mm."""
    a, b = plane
    centre = machine.travel * rng.uniform(0.45, 0.55, 3)
    rows, speeds, ways = Rows(machine), [], []
    start = rng.uniform(0.003, 0.01)
    for feed in (600.0, 3000.0):
        for sense in (1, -1):
            for _ in range(2):
                angle = start + sense * numpy.radians(numpy.arange(360))
                points = numpy.tile(centre, (360, 1))
                points[:, a] += radius * numpy.cos(angle)
                points[:, b] += radius * numpy.sin(angle)
                rows.path(f"c{len(rows.run) // 360}", points, step_s=numpy.radians(1) * radius / feed * 60, feed_mm_min=feed)
                speed = numpy.zeros((360, 3))
                speed[:, a], speed[:, b] = -sense * feed * numpy.sin(angle), sense * feed * numpy.cos(angle)
                way = numpy.full((360, 3), 1e3)
                way[:, a] = radius * (angle * sense % numpy.pi)
                way[:, b] = radius * ((angle - numpy.pi / 2) * sense % numpy.pi)
                speeds.append(speed)
                ways.append(way)
    rows.close()
    speeds, ways = numpy.concatenate(speeds), numpy.concatenate(ways)
    rows.dirs = numpy.sign(numpy.where(numpy.abs(speeds) > 1e-6, speeds, 0.0))
    return rows, centre, speeds, ways


def bow(rng, seen, axis, size, middle, radius):
    """Straightness over the circle: a smooth curve without slope there."""
    f = truth.curve(rng, 2 * radius, size)
    return lambda r: vector(r, seen, f(r.q[:, axis] - middle[axis] + radius))


def circle_faults(rng, plane, centre, radius, speeds, ways):
    """The thirteen: name -> (displacement (rows) -> (n, 3), parameter, value)."""
    a, b = plane
    A, B = AXES[a], AXES[b]
    size = lambda: rng.uniform(4, 10) * rng.choice([-1, 1])
    found = {}
    for axis, other in ((a, b), (b, a)):
        name, half, sideways, big = AXES[axis], abs(size()) * 0.7, size() * 0.7, size()
        found[f"backlash.{name}"] = (truth.backlash(axis, half)[0], "half_width_um", half)
        found[f"lost-motion.E{AXES[other]}{name}"] = (truth.lost_motion(other, axis, sideways)[0], "half_width_um", sideways)
        k = 1.2e3 * big / radius
        found[f"scale.{name}"] = (truth.scale(axis, k)[0], "scale_um_per_m", k)
        found[f"straightness.E{AXES[other]}{name}"] = (bow(rng, other, axis, 1.5 * abs(big), centre, radius), None, None)
        period, phase, wave = rng.uniform(6, 20), rng.uniform(0, 6.28), abs(size()) * 0.6
        found[f"pitch.{name}"] = (lambda r, x=axis, p=period, f=phase, w=wave: vector(r, x, w * numpy.sin(2 * numpy.pi * r.q[:, x] / p + f)), None, None)
        spike = abs(size()) * 1.5
        found[f"spike.{name}"] = (lambda r, x=axis, s=spike: vector(r, x, -s * r.dirs[:, x] * numpy.exp(-ways[:, x] / 3.0)), None, None)
    pair = "".join(sorted((A, B)))
    urad = 1e3 * size() / radius * 1.5
    found[f"squareness.{pair}"] = (truth.squareness(pair, urad)[0], "angle_urad", urad)
    ms = 60.0 * abs(size()) / 3000.0
    lag = numpy.zeros((len(speeds), 3))
    lag[:, a], lag[:, b] = -0.5 * ms * speeds[:, a] / 60.0, 0.5 * ms * speeds[:, b] / 60.0
    found[f"servo-mismatch.{pair}"] = (lambda r: lag, "mismatch_ms", ms)
    return found


def same(said, true):
    return said == true or (true.startswith("spike") and "spike" in said and said[-1] == true[-1])


def circles(count):
    def play(case):
        rng = case.rng
        machine = Machine(rng, 400, 700)
        plane = ((0, 1), (0, 2), (1, 2))[int(rng.integers(3))]
        radius = float(rng.choice([100.0, 150.0]))
        rows, centre, speeds, ways = circle_rows(rng, machine, plane, radius)
        every = circle_faults(rng, plane, centre, radius, speeds, ways)
        names = [n for n in sorted(every) if n != f"spike.{AXES[plane[1]]}"]
        chosen = [names[k] for k in rng.choice(len(names), count, replace=False)]
        measure(rng, rows, truth.white(0.25), [every[n][0] for n in chosen])
        case.deserves("NAMED", [(n, {every[n][1]: every[n][2]} if every[n][1] else {}) for n in chosen])
        ball = centre + machine.tool
        where = rows.q + rows.tool + rows.d * 1e-3
        slip = rng.normal(size=3) * 3e-3  # the ball is not quite where it is said to be
        rows.extra |= {"length_mm": [f"{v:.6f}" for v in numpy.linalg.norm(where - ball - slip, axis=1)], "bx_mm": numpy.full(len(rows), ball[0]), "by_mm": numpy.full(len(rows), ball[1]), "bz_mm": numpy.full(len(rows), ball[2])}
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv"), kind="lengths"), machine.profile(case.folder), write=False)
        if answer.data is None:
            return Outcome({"recall": (0, count)}, answer.verdict, answer.err)
        sets = [[e, *answer.rivals(k)] for k, e in enumerate(answer.causes)]
        recalled = sum(any(same(s, n) for one in sets for s in one) for n in chosen)
        precise = sum(any(same(s, n) for n in chosen for s in one) for one in sets)
        figures = {"recall": (recalled, count)}
        if sets:
            figures["precision"] = (precise, len(sets))
        right, judged, sizes = 0, 0, []
        for n in chosen:
            _, key, value = every[n]
            found = answer.parameter(n, key) if key else None
            if found:
                judged += 1
                right += abs(abs(found[0]) - abs(value)) <= 0.1 * abs(value)
                sizes.append(f"{n} {value:.2f} found {found[0]:.2f}")
        if judged:
            figures["sizes within 10 %"] = (right, judged)
        return Outcome(figures, answer.verdict, f"{', '.join(chosen)}; found {sets}; {'; '.join(sizes)}")

    return play


CIRCLES = {"recall": (0.95, 1), "precision": (0.95, 1), "sizes within 10 %": (0.95, 1)}
KINDS = [
    Kind("stations", "two, tracker's fault", 32, {"told apart": (0.9, 1), "written as a machine's": (0, 0.02)}, stations(2, "tracker")),
    Kind("stations", "two, machine's fault", 30, {"told apart": (0.9, 1)}, stations(2, "machine")),
    Kind("stations", "one, tracker's fault", 30, {"instrument in the set": (0.95, 1), "written as a machine's": (0, 0.02)}, stations(1, "tracker")),
    Kind("stations", "one, machine's fault", 20, {"machine's fault in the set": (0.95, 1)}, stations(1, "machine")),
]
KINDS += [Kind("circles", f"{n} fault{'s' * (n > 1)}", 25, CIRCLES, circles(n)) for n in (1, 2, 3, 4)]
