"""Families harm and refuted: what is written must not ruin a part between the places, and what unseen rows contradict must not be called NAMED."""

import os
import re

import numpy

import machine as truth
from answer import ask, predict
from judge import Kind, Outcome
from machine import AXES, Machine, measure, setup, vector
from rows import Rows, along, lines, plates, scatter, there_and_back, uneven

AT = {"temp_c": 22.0, "time_s": 1800.0, "load_kg": 50.0, "feed_mm_min": 1500.0}


def between(rng, rows, count=4000):
    """Points between measured places: on the way from each to the next of its run, and on straight ways between any two of all."""
    q, tool, dirs = [], [], []
    for _, rs in rows.runs():
        for a, b in zip(rs[:-1], rs[1:]):
            for t in rng.uniform(0, 1, 9):
                q.append((1 - t) * rows.q[a] + t * rows.q[b])
                tool.append(rows.tool[a])
                dirs.append(rows.dirs[b])
    pairs = rng.integers(0, len(rows), (count, 2))
    t = rng.uniform(0, 1, (count, 1))
    q = numpy.concatenate([numpy.array(q).reshape(-1, 3), (1 - t) * rows.q[pairs[:, 0]] + t * rows.q[pairs[:, 1]]])
    tool = numpy.concatenate([numpy.array(tool).reshape(-1, 3), rows.tool[pairs[:, 0]]])
    dirs = numpy.concatenate([numpy.array(dirs).reshape(-1, 3), rows.dirs[pairs[:, 0]]])
    return q, tool, dirs


def largest_correction(case, answer, rows, rng):
    """Largest displacement by the written effects between the measured places, um, and its place; (0, None) where none is written."""
    if not answer.effects_written:
        return 0.0, None
    q, tool, dirs = between(rng, rows)
    ids = re.findall(r'^id = "(.*?)"', answer.written, re.M)
    needs = {"temp_c": "thermal", "time_s": "warmup|step", "load_kg": "load", "feed_mm_min": "servo"}
    at = {k: (float(numpy.median(getattr(rows, k.split("_")[0]))) if numpy.ptp(getattr(rows, k.split("_")[0])) > 0 else v) for k, v in AT.items() if any(re.match(needs[k], i) for i in ids)}
    moved = predict(case.vpost, os.path.join(case.folder, "written.toml"), q, tool, dirs, case.folder, at)
    size = 1e3 * numpy.linalg.norm(moved, axis=1)
    worst = int(size.argmax())
    return float(size[worst]), q[worst]


def short_span(rng, machine):
    """Ten set-points 5 mm apart along each axis."""
    rows = Rows(machine)
    at = machine.travel * rng.uniform(0.2, 0.7, 3)
    for axis in range(3):
        for k in range(2):
            rows.path(f"r{axis}{k}", there_and_back(along(machine, axis, at, numpy.round(at[axis], 2) + 5.0 * numpy.arange(10))))
    return rows


def one_axis(rng, machine):
    axis = int(rng.integers(3))
    rows = Rows(machine)
    for k in range(4):
        rows.path(f"r{k}", there_and_back(along(machine, axis, machine.travel / 2, numpy.round(machine.travel[axis] * 0.3, 2) + 5.0 * numpy.arange(10))))
    return rows


def few(rng, machine):
    """Five to seven places on a line, two lines an axis."""
    return lines(rng, machine, 2, int(rng.integers(5, 8)), 2, diagonals=False)


def clusters(rng, machine):
    """Places in four clusters of 15 mm, far apart: nothing is known between them."""
    rows = Rows(machine)
    for k in range(5):
        centres = machine.travel * rng.uniform(0.1, 0.9, (4, 3))
        rows.path(f"r{k}", numpy.concatenate([c + rng.uniform(-7.5, 7.5, (8, 3)) for c in centres]))
    return rows


def edges(rng, machine):
    """Lines with all places in the outer tenths of the travel."""
    rows = Rows(machine)
    for k in range(9):
        axis = k % 3
        part = numpy.concatenate([numpy.linspace(0.02, 0.12, 6), numpy.linspace(0.88, 0.98, 6)])
        rows.path(f"r{k}", there_and_back(along(machine, axis, machine.travel * rng.uniform(0.1, 0.9, 3), part * machine.travel[axis])))
    return rows


def waves(rng, machine, axis, seen, size):
    """A smooth curve of high order: sines of up to eleven half periods over the travel."""
    orders, phases, weights = numpy.arange(3, 12), rng.uniform(0, 2 * numpy.pi, 9), rng.normal(size=9)
    f = lambda x: sum(w * numpy.sin(numpy.pi * k * x / machine.travel[axis] + p) for w, k, p in zip(weights, orders, phases))
    factor = size / numpy.abs(f(numpy.linspace(0, machine.travel[axis], 500))).max()
    return lambda r: vector(r, seen, factor * f(r.q[:, axis]))


def shapes(rng, machine, kind):
    axis = int(rng.integers(3))
    seen = axis if rng.random() < 0.6 else int(rng.integers(3))
    size = rng.uniform(8, 40)
    if kind == "high order":
        return [waves(rng, machine, axis, seen, size)]
    if kind == "none":
        return []
    return [waves(rng, machine, axis, seen, size) if rng.random() < 0.5 else truth.random_fault(rng, machine, ("scale", "backlash", "positioning", "straightness", "squareness"), size)[0]]


def gross(rng, rows, count, size_um=(60.0, 95.0)):
    """Gross errors in single rows; gives their mask."""
    bad = numpy.zeros(len(rows), bool)
    bad[rng.choice(len(rows), count, replace=False)] = True
    rows.d[bad] += rng.uniform(*size_um, (count, 3)) * rng.choice([-1, 1], (count, 3))
    return bad


def harm(design, shape, outliers=0):
    def play(case):
        rng = case.rng
        machine = Machine(rng)
        rows = design(rng, machine).close()
        noise = truth.white(rng.uniform(0.3, 2.0)) if rng.random() < 0.6 else truth.autoregressive(rng.uniform(0.5, 3.0), 0.7)
        measure(rng, rows, noise, shapes(rng, machine, shape), setup(rng, 4.0, 5.0))
        case.deserves("UNKNOWN")
        good = ~gross(rng, rows, outliers) if outliers else numpy.ones(len(rows), bool)
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        moved, where = largest_correction(case, answer, rows, rng)
        reading = float(numpy.linalg.norm(rows.d[good], axis=1).max())
        note = f"moves {moved:.1f} um at {None if where is None else numpy.round(where, 3).tolist()}; largest reading {reading:.1f}; {', '.join(answer.causes)}"
        return Outcome({"beyond twice the largest reading": moved > 2 * reading}, answer.verdict, note)

    return play


def negative_play(case):
    """The far side of over-compensation: a half width below 0 is no play, and is neither called so nor written so."""
    rng = case.rng
    machine = Machine(rng)
    rows = lines(rng, machine, 3, 9, 2).close()
    axis = int(rng.integers(3))
    measure(rng, rows, truth.white(1.0), [truth.backlash(axis, -rng.uniform(4, 12))[0]], setup(rng))
    case.deserves("PARTIAL", notes=["the reversal is over-compensated, or the sensor sits on the motor's side"])
    answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
    if answer.data is None:
        return Outcome({}, answer.verdict, answer.err)
    effect = f"backlash.{AXES[axis]}"
    found = answer.parameter(effect, "half_width_um")
    written = re.search(r'id = "backlash\.[^"]*"\s*\nhalf_width_um = -', answer.written or "")
    said = any(re.search(r"over-?compensat|motor", t, re.I) for t in answer.texts())
    return Outcome({"called or written as play": bool(written) or bool(found and found[0] < 0 and not said), "said what it is": said}, answer.verdict, f"{effect} {found}; {', '.join(answer.causes)}")


# What the hold-out shows: (faults on training rows, faults on the hold-out, alters the hold-out).


def same_size_other(rng, machine, first):
    """A fault of another kind than the first."""
    while True:
        fault = truth.random_fault(rng, machine, ("scale", "backlash", "lost-motion", "squareness", "straightness", "positioning"), 10.0)
        if fault[1] != first[1]:
            return fault


def training(rng, machine):
    return lines(rng, machine, 3, 9, 1, tools=2)


def unseen(rng, machine):
    return lines(rng, machine, 2, 8, 1, tools=2, name="h")


def refuted(kind):
    def play(case):
        rng = case.rng
        machine = Machine(rng)
        fault = truth.random_fault(rng, machine, ("scale", "backlash", "lost-motion", "squareness"), 10.0)
        frame, sigma = setup(rng), float(rng.uniform(0.6, 1.5))
        rows, out = training(rng, machine).close(), unseen(rng, machine).close()
        faults, frame_out = [fault[0]], frame
        if kind == "other date":
            faults = [same_size_other(rng, machine, fault)[0]] if rng.random() < 0.5 else [lambda r: -fault[0](r)]
        elif kind == "vanished":
            faults = []
        elif kind == "other part":  # every place of the hold-out has a deviation of its own, that of the part
            own = {tuple(p): v for p, v in zip(out.q, rng.normal(size=(len(out), 3)) * 20)}
            faults.append(lambda r: numpy.array([own[tuple(p)] for p in r.q]))
        elif kind == "own set-up":
            frame_out = setup(rng, 40.0, 120.0)
        elif kind == "gap only unseen":
            faults, fault = [fault[0]], None
        measure(rng, rows, truth.white(sigma), [fault[0]] if fault else [], frame)
        measure(rng, out, truth.white(sigma), faults, frame_out)
        if kind == "other frame":  # read in axes turned so that X is called Y, Y Z and Z X
            out.d = out.d[:, [2, 0, 1]]
        with_it = "NAMED" if kind in ("good hold-out", "own set-up") else "PARTIAL"
        case.deserves("NAMED" if fault else "UNKNOWN", [(fault[1], fault[2])] if fault else [], holdout_verdict=with_it if fault else "UNKNOWN")
        profile = machine.profile(case.folder)
        if kind != "gap only unseen":
            alone = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), profile, write=False)
            if not (alone.named and alone.causes == [fault[1]]):  # what was not NAMED without the hold-out cannot lose or keep it
                return Outcome({"NAMED without it": False}, alone.verdict, f"{fault[1]}; without the hold-out: {', '.join(alone.causes)} {alone.err}")
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), profile, out.write(case.path("holdout.csv")))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        held = answer.data.get("holdout") or {}
        note = f"{fault[1] if fault else 'none'}; found {', '.join(answer.causes)}; forecast {answer.forecast}, held out {held.get('rms_before_um')} -> {held.get('rms_after_um')}"
        if kind in ("good hold-out", "own set-up"):
            return Outcome({"NAMED without it": True, "stays NAMED, right": answer.named and answer.causes == [fault[1]]}, answer.verdict, note)
        if kind == "gap only unseen":
            return Outcome({"all-clear": answer.verdict == "NO GAP"}, answer.verdict, note)
        return Outcome({"NAMED without it": True, "refuted but NAMED": answer.named}, answer.verdict, note)

    return play


HARM = {"beyond twice the largest reading": (0, 0)}
FIRST = {"NAMED without it": (0.9, 1)}
NEVER, STAYS = FIRST | {"refuted but NAMED": (0, 0.01)}, FIRST | {"stays NAMED, right": (0.95, 1)}
KINDS = [
    Kind("harm", "ten set-points 5 mm apart", 20, HARM, harm(short_span, "any")),
    Kind("harm", "one axis, 5 mm apart", 20, HARM, harm(one_axis, "any")),
    Kind("harm", "few places", 20, HARM, harm(few, "any")),
    Kind("harm", "clusters", 20, HARM, harm(clusters, "any")),
    Kind("harm", "both ends only", 20, HARM, harm(edges, "any")),
    Kind("harm", "high order", 20, HARM, harm(lambda r, m: lines(r, m, 2, 9, 1, diagonals=bool(r.random() < 0.5)), "high order")),
    Kind("harm", "high order, few places", 20, HARM, harm(few, "high order")),
    Kind("harm", "scattered points", 20, HARM, harm(lambda r, m: scatter(r, m, 60, 4), "any")),
    Kind("harm", "outliers", 20, HARM, harm(few, "any", 4)),
    Kind("harm", "gross errors, short span", 20, HARM, harm(short_span, "none", 6)),
    Kind("harm", "play below zero", 10, {"called or written as play": (0, 0), "said what it is": (0.95, 1)}, negative_play),
    Kind("refuted", "other date", 20, NEVER, refuted("other date")),
    Kind("refuted", "vanished", 20, NEVER, refuted("vanished")),
    Kind("refuted", "other part", 20, NEVER, refuted("other part")),
    Kind("refuted", "other frame", 20, NEVER, refuted("other frame")),
    Kind("refuted", "gap only unseen", 20, {"all-clear": (0, 0)}, refuted("gap only unseen")),
    Kind("refuted", "good hold-out", 20, STAYS, refuted("good hold-out")),
    Kind("refuted", "hold-out with its own set-up", 20, STAYS, refuted("own set-up")),
]
