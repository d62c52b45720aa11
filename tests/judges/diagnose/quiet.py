"""Families noise, coverage and repeats: what happens where nothing is wrong, where one known thing is, and where readings only look like repeats."""

import re

import numpy

import machine as truth
from answer import INSTRUMENT, ask
from judge import Kind, Outcome
from machine import Machine, measure, setup
from rows import Rows, along, lines, plates, scatter, there_and_back, uneven


def standing(rng, machine):
    """A machine that stands still in eight places while the instrument reads it a hundred times a second: no command changes within a run."""
    rows = Rows(machine)
    for k in range(8):
        rows.path(f"at{k}", numpy.tile(numpy.round(machine.travel * rng.uniform(0.1, 0.9, 3), 3), (60, 1)), step_s=0.001)
    return rows


def some_design(rng, machine):
    """One of four ordinary ways to measure: lines, few lines, plates, scattered points."""
    kind = int(rng.integers(4))
    if kind == 0:
        return lines(rng, machine, per_axis=3, count=9, tools=int(rng.integers(1, 3)))
    if kind == 1:
        return lines(rng, machine, per_axis=2, count=11, passes=2, diagonals=False)
    if kind == 2:
        return plates(rng, machine, count=6, grid=5, passes=2)
    return scatter(rng, machine, count=160, runs=8)


# name: (noise from a size in um, design, columns of uncertainty by component)
NOISES = {
    "isotropic": (lambda s: truth.white(s), some_design, None),
    "heavy tails": (lambda s: truth.heavy(s), some_design, None),
    "anisotropic 1:2:3": (lambda s: truth.white([s, 2 * s, 3 * s]), some_design, None),
    "anisotropic 0.4:0.8:1.5": (lambda s: truth.white([0.4 * s, 0.8 * s, 1.5 * s]), some_design, None),
    "anisotropic 1:2:3, stated": (lambda s: truth.white([s, 2 * s, 3 * s]), some_design, [1, 2, 3]),
    "AR(1) 0.5": (lambda s: truth.autoregressive(s, 0.5), some_design, None),
    "AR(1) 0.8": (lambda s: truth.autoregressive(s, 0.8), some_design, None),
    "standing, AR(1) 0.9": (lambda s: truth.autoregressive(s, 0.9), standing, None),
    "random walk": (lambda s: truth.walk(0.5 * s, 0.5 * s), some_design, None),
    "quantised": (lambda s: truth.quantised(0.4 * s, s), some_design, None),
    "runs shifted": (lambda s: truth.shifted(s, 4 * s), some_design, None),
    "runs turned": (lambda s: truth.turned(s, 400), lambda r, m: plates(r, m, 8) if r.random() < 0.6 else lines(r, m, 3, 9), None),
    "instrument warming": (lambda s: truth.warming_instrument(s, 8 * s), some_design, None),
}


def state(rows, stated, sigma):
    if stated is not None:
        for axis, factor in zip("xyz", stated):
            rows.extra[f"u_{axis}_um"] = numpy.full(len(rows), factor * sigma)


def noise_case(name):
    make, design, stated = NOISES[name]

    def play(case):
        rng = case.rng
        machine = Machine(rng)
        sigma = float(rng.uniform(0.6, 3.0))
        rows = design(rng, machine).close()
        measure(rng, rows, make(sigma), frame=setup(rng))
        state(rows, stated, sigma)
        if name == "instrument warming":
            case.deserves("NOISE MODEL SUSPECT", [("instrument-drift", {})], noise_um=sigma)
        else:
            case.deserves("NO GAP", noise_um=sigma)
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        blamed = [e for e in answer.causes if not INSTRUMENT.search(e)]
        if name == "instrument warming" and any(INSTRUMENT.search(e) for k in range(len(answer.causes)) for e in answer.rivals(k)):
            blamed = []
        alarm = answer.alarm and bool(blamed)
        return Outcome({"false alarms": alarm, "effects written": bool(answer.effects_written)}, answer.verdict, ", ".join(answer.causes))

    return play


def coverage_design(rng, machine, name):
    if name == "runs turned":
        return plates(rng, machine, 10, 5, 2)
    return lines(rng, machine, per_axis=3, count=9, passes=2) if rng.random() < 0.6 else plates(rng, machine, 9, 5, 2)


def coverage_case(name):
    make, _, stated = NOISES[name]

    def play(case):
        rng = case.rng
        machine = Machine(rng)
        sigma = float(rng.uniform(0.6, 2.0))
        fault, effect, parameters = truth.random_fault(rng, machine, ("scale", "backlash", "lost-motion", "squareness"), 12 * sigma)
        rows = coverage_design(rng, machine, name).close()
        measure(rng, rows, make(sigma), [fault], setup(rng))
        state(rows, stated, sigma)
        case.deserves("NAMED", [(effect, parameters)], noise_um=sigma)
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder), write=False)
        if answer.data is None:
            return Outcome({"cause found": False}, answer.verdict, answer.err)
        (key, value), = parameters.items()
        found = answer.parameter(effect, key)
        note = f"{effect} {key} {value:.3f}; found {found}; causes {', '.join(answer.causes)}"
        if found is None:
            return Outcome({"cause found": False}, answer.verdict, note)
        return Outcome({"cause found": True, "interval holds the truth": abs(found[0] - value) <= found[1]}, answer.verdict, note)

    return play


def form_errors(rng, machine, places, size):
    """Deviations (n, 3) of one part at its places, `size` um RMS: a form of second degree."""
    u = 2 * places / machine.travel - 1
    shape = numpy.stack([u[:, a] * u[:, b] for a in range(3) for b in range(a, 3)], axis=1) @ rng.normal(size=(6, 3))
    return size * shape / numpy.sqrt((shape**2).mean())


def parts(column, times=2, stated=False):
    """Ten parts measured with one program: each has deviations of its own, 30 um; the instrument's noise is 2 um. Every part is read twice, or once; then either the
    uncertainty of a reading is stated, or the parts' forms are smooth, so that neighbours show them."""

    def play(case):
        rng = case.rng
        machine = Machine(rng)
        smooth = times == 1 and not stated
        places = numpy.round(machine.travel * rng.uniform(0.15, 0.85, (40 if smooth else 14, 3)), 3)
        rows, noise = Rows(machine), 2.0
        for k in range(10):
            rows.path(f"part{k}", numpy.concatenate([places] * times))
        rows.close()
        measure(rng, rows, truth.white(noise), frame=setup(rng, 5.0, 10.0))
        for _, rs in rows.runs():
            own = form_errors(rng, machine, places, 30.0) if smooth else 30.0 * rng.normal(size=(len(places), 3))
            rows.d[rs] += numpy.concatenate([own] * times)
        if stated:
            rows.extra["u_um"] = numpy.full(len(rows), noise)
        if column:
            rows.extra["artefact"] = numpy.array([f"part {run}" for run in rows.run])
        case.deserves("UNKNOWN", noise_um=noise)
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv"), leave=("dir_x", "dir_y", "dir_z")), machine.profile(case.folder))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        said = answer.data["gap"]["noise_um"]
        figures = {"all-clear over the parts": answer.verdict == "NO GAP", "a cause of the machine": answer.named}
        if times == 2:
            figures["noise within a factor of 2"] = 0.5 * noise <= said <= 2 * noise
        return Outcome(figures, answer.verdict, f"noise stated {said}, true {noise}, parts 30; {', '.join(answer.causes)}")

    return play


def other_temperature(case):
    """One line per axis, again and again at other temperatures: expansion is found, and is not in the noise."""
    rng = case.rng
    machine = Machine(rng, 400, 800)
    rows, axis, noise = Rows(machine), int(rng.integers(3)), 1.0
    tracks = [along(machine, k, machine.travel * rng.uniform(0.2, 0.8, 3), uneven(rng, 10, machine.travel[k] - 10, 9)) for k in range(3)]
    for k, temp in enumerate(rng.permutation(numpy.linspace(18, 28, 6))):
        for a, track in enumerate(tracks):
            rows.path(f"r{k}{'XYZ'[a]}", there_and_back(track), temp_c=float(temp))
    rows.close()
    fault, effect, parameters = truth.thermal(axis, 11.5)
    measure(rng, rows, truth.white(noise), [fault], setup(rng))
    case.deserves("NAMED", [(effect, parameters)], noise_um=noise)
    answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
    if answer.data is None:
        return Outcome({}, answer.verdict, answer.err)
    stated = answer.data["gap"]["noise_um"]
    return Outcome({"all-clear": answer.verdict == "NO GAP", "noise within a factor of 2": 0.5 * noise <= stated <= 2 * noise, "cause named first": answer.causes[:1] == [effect]},
                   answer.verdict, f"{effect}; noise stated {stated}, true {noise}; {', '.join(answer.causes)}")


def turned_plates(case):
    """Plates turned by up to 400 urad: the gap is the machine's own, not the plates'. The machine has a small fault, 8 um."""
    rng = case.rng
    machine = Machine(rng, 300, 600)
    rows = plates(rng, machine, 9, 5, 2).close()
    fault, effect, parameters = truth.random_fault(rng, machine, ("scale", "squareness", "backlash"), 12.0)
    measure(rng, rows, truth.turned(0.8, 400), [fault])
    own = fault(rows)
    for _, rs in rows.runs():  # what no set-up of a run can do
        tip = rows.q[rs] + rows.tool[rs] - (rows.q[rs] + rows.tool[rs]).mean(axis=0)
        basis = numpy.zeros((len(rs), 3, 6))
        basis[:, :, :3] = numpy.eye(3)
        for k in range(3):
            basis[:, :, 3 + k] = numpy.cross(numpy.eye(3)[k], tip)
        flat = basis.reshape(-1, 6)
        own[rs] -= (flat @ numpy.linalg.lstsq(flat, own[rs].ravel(), rcond=None)[0]).reshape(-1, 3)
    least, most = numpy.sqrt((own**2).sum(axis=1).mean()), numpy.sqrt((fault(rows) ** 2).sum(axis=1).mean())
    case.deserves("NAMED", [(effect, parameters)], noise_um=0.8, gap_um=(least + most) / 2)
    answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
    if answer.data is None:
        return Outcome({}, answer.verdict, answer.err)
    gap = answer.data["gap"]["rms_um"]
    good = 0.6 * least <= gap <= 1.5 * most + 3.0
    return Outcome({"gap is the machine's": good, "cause named first": answer.causes[:1] == [effect]}, answer.verdict, f"{effect}; gap stated {gap}, truth {least:.1f} to {most:.1f}; {', '.join(answer.causes)}")


def two_instruments(agree):
    """Half of the runs with an instrument whose scale and zero differ by up to 40 um over the volume; or one that does not."""

    def play(case):
        rng = case.rng
        machine = Machine(rng, 400, 800)
        rows = lines(rng, machine, 3, 9, 1)
        first = len(rows.run)
        lines(rng, machine, 3, 9, 1, rows=rows, name="q")
        rows.close()
        measure(rng, rows, truth.white(1.0), frame=setup(rng))
        late = numpy.arange(len(rows)) >= first
        if not agree:
            rows.d[late] += 40e-3 * 1e3 * rows.q[late] / machine.travel.max() * rng.choice([-1, 1]) + rng.normal(size=3) * 15
        rows.extra["instrument"] = numpy.where(late, "tracker B", "tracker A")
        if agree:
            case.deserves("NO GAP")
        else:
            case.deserves("NOISE MODEL SUSPECT", notes=["the instruments tracker A and tracker B disagree by 40 um"])
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        said = any(re.search(r"instruments?\b.*(disagree|differ|apart|not agree)|tracker [AB].*tracker [AB]", t, re.I) for t in answer.texts())
        machine_named = answer.named and not any(INSTRUMENT.search(e) for e in answer.causes)
        return Outcome({"said that they disagree": said, "the machine is blamed": machine_named}, answer.verdict, ", ".join(answer.causes))

    return play


KINDS = [Kind("noise", n, 40, {"false alarms": (0, 0.03), "effects written": (0, 0)}, noise_case(n)) for n in NOISES]
KINDS += [Kind("coverage", n, 20, {"interval holds the truth": (0.92, 0.97), "cause found": (0.9, 1)}, coverage_case(n)) for n in NOISES if not n.startswith("standing")]
KINDS += [
    Kind("repeats", "parts, by run", 15, {"all-clear over the parts": (0, 0), "noise within a factor of 2": (0.9, 1), "a cause of the machine": (0, 0.03)}, parts(False)),
    Kind("repeats", "parts, by artefact", 15, {"all-clear over the parts": (0, 0), "noise within a factor of 2": (0.9, 1), "a cause of the machine": (0, 0.03)}, parts(True)),
    Kind("repeats", "parts, once each, u_um stated", 15, {"all-clear over the parts": (0, 0), "a cause of the machine": (0, 0.03)}, parts(False, 1, True)),
    Kind("repeats", "parts, once each, smooth", 15, {"all-clear over the parts": (0, 0), "a cause of the machine": (0, 0.03)}, parts(False, 1)),
    Kind("repeats", "other temperatures", 15, {"all-clear": (0, 0), "noise within a factor of 2": (0.95, 1), "cause named first": (0.95, 1)}, other_temperature),
    Kind("repeats", "plates turned", 15, {"gap is the machine's": (0.95, 1), "cause named first": (0.95, 1)}, turned_plates),
    Kind("repeats", "two instruments disagree", 20, {"said that they disagree": (0.95, 1), "the machine is blamed": (0, 0.03)}, two_instruments(False)),
    Kind("repeats", "two instruments agree", 20, {"said that they disagree": (0, 0.03), "the machine is blamed": (0, 0.03)}, two_instruments(True)),
]
