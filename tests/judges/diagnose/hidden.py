"""Families runs, outside and books: effects that are constant within a run, effects that no library holds, and faults of the bookkeeping."""

import re

import numpy

import machine as truth
from answer import ask, columns_of, predict
from judge import Kind, Outcome
from machine import AXES, Machine, measure, setup, vector
from rows import Rows, lines, plates

# Conditions that belong to a run: what the run is called, how it is measured, what it does.


def condition_faults(rng, kind):
    """(fault as machine.py has them, pattern of right ids, conditions of run k, tools of run k)."""
    axis = int(rng.integers(3))
    name = AXES[axis]
    size = rng.uniform(15, 30) * rng.choice([-1.0, 1.0])
    if kind == "load":
        levels = rng.permutation(numpy.resize([0.0, 40.0, 90.0, 150.0, 220.0, 300.0], 24))
        return truth.load(axis, abs(size) / 300.0), rf"load\.{name}", lambda k: {"load_kg": float(levels[k % 24])}, None
    if kind == "temperature":
        levels = rng.permutation(numpy.linspace(17.0, 29.0, 24))
        return truth.thermal_shift(axis, size / 10.0), rf"thermal\.{name}|temperature.*{name}", lambda k: {"temp_c": float(levels[k % 24])}, None
    if kind == "time since start":
        return truth.warmup(axis, size, 3000.0), rf"warmup\.{name}|instrument-drift", lambda k: {}, None
    if kind == "feed class":
        levels = rng.permutation(numpy.resize([500.0, 1000.0, 2000.0, 4000.0], 24))
        return truth.lag(axis, abs(size) / 4000.0 * 60.0), rf"servo-lag\.{name}", lambda k: {"feed_mm_min": float(levels[k % 24])}, None
    lengths = rng.permutation(numpy.resize([80.0, 130.0, 190.0, 260.0], 24))
    seen = int(rng.integers(2))  # the tip goes aside in proportion to the tool's length: the spindle leans
    lean = (lambda r: vector(r, seen, size / 200.0 * -r.tool[:, 2])), f"spindle-tilt.{AXES[seen]}", {"tilt_urad": 1e3 * size / 200.0}
    return lean, r"tilt|lean|spindle|tool", lambda k: {}, lambda k: numpy.array([0.0, 0.0, -lengths[k % 24]])


def run_lines(rng, machine, conditions, tools, name, count=24):
    """Single lines, a run each: one axis, one way, one condition."""
    rows = Rows(machine)
    for k in range(count):
        axis = int(rng.integers(3)) if count < 20 else k % 3
        part = numpy.sort(rng.uniform(0.03, 0.97, 9))
        points = numpy.tile(machine.travel * rng.uniform(0.1, 0.9, 3), (9, 1))
        points[:, axis] = part * machine.travel[axis]
        rows.path(f"{name}{k}", points if k % 2 else points[::-1], tools(k) if tools else None, **conditions(k))
        rows.now["time_s"] += 400.0
    return rows


def constant_in_runs(kind):
    def play(case):
        rng = case.rng
        machine = Machine(rng, 300, 700)
        fault, right, conditions, tools = condition_faults(rng, kind)
        rows = run_lines(rng, machine, conditions, tools, "r").close()
        out = run_lines(rng, machine, lambda k: conditions(k + 5), (lambda k: tools(k + 5)) if tools else None, "h", 12).close()
        frame, noise = setup(rng), truth.shifted(rng.uniform(0.4, 0.8), 0.5)
        measure(rng, rows, noise, [fault[0]], frame)
        measure(rng, out, noise, [fault[0]], frame)
        case.deserves("NAMED", [fault[1:]], shrink=1 - rest_rms(out, out.d - fault[0](out)) / rest_rms(out, out.d), written=True)
        profile = machine.profile(case.folder)
        always = tuple(f"tool_{a}_mm" for a in "z") if tools else ()
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv"), always=always), profile, out.write(case.path("holdout.csv"), always=always))
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        first = answer.causes[:1]
        named = bool(first) and (re.search(right, first[0]) is not None or any(re.search(right, e) for e in answer.rivals()))
        note = f"{right}; found {', '.join(answer.causes)}; forecast {answer.forecast}"
        figures = {"cause named": named}
        held = answer.data.get("holdout") or {}
        achieved = shrink_achieved(case, answer, out)
        if achieved is None and named and held.get("shrink") is not None:  # named, and for a good reason never written (a warm-up): the tool's own figures
            achieved = held["shrink"], held["rms_before_um"], held["rms_after_um"]
        if answer.forecast is not None and achieved is not None:
            figures["forecast within 5 points"] = abs(answer.forecast - achieved[0]) <= 0.05
            note += f", achieved {achieved[0]:.3f} ({achieved[1]:.2f} -> {achieved[2]:.2f} um; said {held.get('shrink')})"
        else:
            figures["forecast within 5 points"] = False
        return Outcome(figures, answer.verdict, note)

    return play


def only_shifted(case):
    """Control: runs that are shifted by 8 um each and measured under conditions that do nothing."""
    rng = case.rng
    machine = Machine(rng, 300, 700)
    loads, temps = rng.permutation(numpy.resize([0.0, 60.0, 140.0, 300.0], 24)), rng.permutation(numpy.linspace(17.0, 29.0, 24))
    rows = run_lines(rng, machine, lambda k: {"load_kg": float(loads[k]), "temp_c": float(temps[k])}, None, "r").close()
    measure(rng, rows, truth.shifted(rng.uniform(0.4, 0.8), 8.0), frame=setup(rng))
    case.deserves("NO GAP")
    answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder))
    if answer.data is None:
        return Outcome({}, answer.verdict, answer.err)
    return Outcome({"a cause named": answer.alarm}, answer.verdict, ", ".join(answer.causes))


def shrink_achieved(case, answer, out):
    """(shrinkage, RMS before, after) on the withheld rows: what the written effects take off them, run by run at its conditions. Zero and turn of the frame are fitted once
    to all of them, before and after alike: they are the instrument's. None where nothing was written."""
    if not answer.effects_written:
        return None
    after = out.d.copy()
    with open(case.path("written.toml"), encoding="utf-8") as file:
        text = file.read()
    needs = {"temp_c": "thermal", "time_s": "warmup|step", "load_kg": "load", "feed_mm_min": "servo"}
    ids = re.findall(r'^id = "(.*?)"', text, re.M)
    used = [k for k, pattern in needs.items() if any(re.match(pattern, i) for i in ids)]
    for _, rs in out.runs():
        at = {k: float(getattr(out, k.split("_")[0])[rs].mean()) for k in used}
        try:
            after[rs] -= 1e3 * predict(case.vpost, case.path("written.toml"), out.q[rs], out.tool[rs], out.dirs[rs], case.folder, at)
        except RuntimeError:
            return None
    a, b = rest_rms(out, out.d), rest_rms(out, after)
    return 1 - b / a, a, b


def rest_rms(rows, d):
    """RMS of (n, 3) readings less the one shift and turn of the frame that takes most off them."""
    tip = rows.q + rows.tool
    tip = tip - tip.mean(axis=0)
    basis = numpy.concatenate([numpy.tile(numpy.eye(3), (len(rows), 1, 1)), numpy.stack([numpy.cross(e, tip) for e in numpy.eye(3)], axis=2)], axis=2).reshape(-1, 6)
    return float(numpy.sqrt(((d.ravel() - basis @ numpy.linalg.lstsq(basis, d.ravel(), rcond=None)[0]) ** 2).sum() / len(rows)))


# Outside the library. Each: (fault, true columns, ids that would be right if the library grew that far).


def outside_fault(rng, machine, kind):
    axis = int(rng.integers(3))
    other = int((axis + rng.integers(1, 3)) % 3)
    size, travel = rng.uniform(10, 25), machine.travel
    middle = travel * rng.uniform(0.35, 0.65, 3)
    q = lambda r, k: (r.q[:, k] - middle[k]) / (0.5 * travel[k])
    low = "xyz"
    if kind == "step at a joint":
        return lambda r: vector(r, other, size * (r.q[:, axis] > middle[axis])), {low[axis]}, r"joint|rail"
    if kind == "play times place":
        return lambda r: vector(r, axis, size * r.dirs[:, axis] * q(r, other)), {f"dir_{low[axis]}", low[other]}, None
    if kind == "product of places":
        third = 3 - axis - other
        return lambda r: vector(r, axis, 2 * size * q(r, other) * q(r, third)), {low[other], low[third]}, None
    if kind == "sine of a product":
        third = 3 - axis - other
        return lambda r: vector(r, axis, size * numpy.sin(3.0 * q(r, other) * q(r, third))), {low[other], low[third]}, None
    if kind == "dead zone":
        return lambda r: vector(r, axis, 1.5 * size * r.dirs[:, axis] * numpy.maximum(0, numpy.abs(q(r, other)) - 0.35)), {f"dir_{low[axis]}", low[other]}, None
    if kind == "load times place":
        return lambda r: vector(r, axis, -size * (r.load / 200.0) * q(r, other)), {"load", low[other]}, r"bend"
    if kind == "temperature times direction":
        return lambda r: vector(r, axis, size * (r.temp - 22.0) / 4.0 * r.dirs[:, axis]), {"temp", f"dir_{low[axis]}"}, None
    return lambda r: vector(r, axis, size * numpy.sign(q(r, axis)) * q(r, other)), {low[axis], low[other]}, None  # "sides differ"


def outside(kind):
    def play(case):
        rng = case.rng
        machine = Machine(rng, 300, 700)
        loads, temps = rng.permutation(numpy.resize([0.0, 70.0, 140.0, 210.0], 40)), rng.permutation(numpy.linspace(18, 26, 40))
        change = lambda k: ({"load_kg": float(loads[k])} if "load" in kind else {}) | ({"temp_c": float(temps[k])} if "temperature" in kind else {})
        rows = lines(rng, machine, 5, 11, 1, change=change)
        plates(rng, machine, 6, 5, 1, rows=rows)
        rows.close()
        fault, columns, grown = outside_fault(rng, machine, kind)
        measure(rng, rows, truth.white(rng.uniform(0.6, 1.2)), [fault], setup(rng))
        case.deserves("UNKNOWN", formulas=["dx ~ " + " * ".join(sorted(columns))])
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder), write=False)
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        right = grown is not None and bool(answer.causes) and all(re.search(grown, e) for e in answer.causes)
        figures = {"not NAMED": not answer.named or right}
        formulas = answer.formulas()
        if formulas:
            figures["true columns in three formulas"] = any(columns_of(f) == columns for f in formulas[:3])
        if not answer.named:
            figures["a formula is proposed"] = bool(formulas)
        return Outcome(figures, answer.verdict, f"{sorted(columns)}; {', '.join(answer.causes)}; {' | '.join(formulas[:3])}")

    return play


# Bookkeeping. The profile knows a crooked machine; the machine is that one; the columns are not what they say.

BOOKS = {
    "sign flipped": r"sign|flip|negat", "columns swapped": r"swap|exchang|column", "direction inverted": r"dir.*(inver|swap|revers|flip)|(inver|revers|flip).*dir|direction",
    "mm/s for mm/min": r"feed.*unit|unit|mm.?(per.?)?s", "work offset left in": r"offset|origin|zero|work",
}
ANY_BOOK = re.compile(r"sign|flip|swap|exchang|column|inver|direction|unit|mm.s\b|work.?offset|origin|bookkeep", re.I)


def crooked(rng):
    """A machine whose profile knows squareness, positioning and straightness curves, play and lags."""
    machine = Machine(rng, 300, 700)
    urad = rng.uniform(40, 120, 3) * rng.choice([-1, 1], 3)
    machine.known += [truth.squareness(pair, u)[0] for pair, u in zip(("XY", "XZ", "YZ"), urad)]
    machine.text += f"\n[squareness]\nEC0Y_urad = {urad[0]:.6f}\nEB0Z_urad = {urad[1]:.6f}\nEA0Z_urad = {urad[2]:.6f}\n"
    for axis, name in enumerate(AXES):
        nodes = numpy.linspace(0, machine.travel[axis], 21)
        curves = [truth.curve(rng, machine.travel[axis], rng.uniform(20, 45)) for _ in range(3)]
        slope = rng.uniform(-40, 40)
        values = numpy.stack([c(nodes) for c in curves], axis=1)
        values[:, axis] += slope * nodes * 1e-3
        values = numpy.round(values, 4)
        machine.tables[f"{name.lower()}.csv"] = "position_mm," + ",".join(f"E{s}{name}_um" for s in AXES) + "\n" + "".join(f"{p:.4f}," + ",".join(f"{v:.4f}" for v in row) + "\n" for p, row in zip(nodes, values))
        nodes = numpy.round(nodes, 4)
        play = round(float(rng.uniform(8, 20)), 3)
        machine.axis_text[name] = f'errors = "{name.lower()}.csv"\nbacklash_um = {play}\n'
        machine.known.append(lambda r, a=axis, n=nodes, v=values: numpy.stack([numpy.interp(r.q[:, a], n, v[:, k]) for k in range(3)], axis=1))
        machine.known.append(truth.backlash(axis, play / 2)[0])
        lag = round(float(rng.uniform(0.2, 0.5)), 4)
        machine.known.append(truth.lag(axis, lag)[0])
        machine.text += f'\n[[effect]]\nid = "servo-lag.{name}"\nlag_ms = {lag}\n'
    return machine


def books(kind):
    def play(case):
        rng = case.rng
        machine = crooked(rng)
        feeds = rng.permutation(numpy.resize([600.0, 1500.0, 3000.0, 6000.0], 40))
        rows = lines(rng, machine, 4, 11, 1, diagonals=False, change=lambda k: {"feed_mm_min": float(feeds[k])}).close()
        faults = [truth.random_fault(rng, machine, ("scale", "backlash", "squareness"), 8.0)] if kind == "control, a real fault" else []
        measure(rng, rows, truth.white(rng.uniform(0.5, 1.2)), [f[0] for f in faults], setup(rng))
        profile = machine.profile(case.folder)
        if kind == "sign flipped":
            which = [0, 1, 2] if rng.random() < 0.5 else [int(rng.integers(3))]
            rows.d[:, which] *= -1
        elif kind == "columns swapped":
            a, b = rng.permutation(3)[:2]
            rows.d[:, [a, b]] = rows.d[:, [b, a]]
        elif kind == "direction inverted":
            rows.dirs = -rows.dirs if rng.random() < 0.5 else rows.dirs * numpy.where(numpy.arange(3) == rng.integers(3), -1, 1)
        elif kind == "mm/s for mm/min":
            rows.conditions["feed_mm_min"] = rows.feed / 60.0
        elif kind == "work offset left in":  # places in the frame of the program: machine = program + offset, within the travel
            rows.q = rows.q * 1.0
            shift = machine.travel * rng.uniform(0.1, 0.25, 3)
            inside = (rows.q - shift >= 0).all(axis=1)
            rows = rows.take(inside)
            rows.q = numpy.round(rows.q - shift, 4)
        if kind in BOOKS:
            case.deserves("NAMED", [("bookkeeping." + kind.replace(" ", "-"), {})])
        else:
            case.deserves("NAMED" if faults else "NO GAP", [f[1:] for f in faults])
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), profile, write=False)
        if answer.data is None:
            said = kind in BOOKS and re.search(BOOKS[kind], answer.err, re.I) and not re.search("VP0911", answer.err)
            return Outcome({"named first": bool(said)} if kind in BOOKS else {"bookkeeping blamed": True}, answer.verdict, answer.err)
        first = answer.causes[0] if answer.causes else ""
        note = f"{faults[0][1] if faults else ''} found {', '.join(answer.causes)}"
        if kind in BOOKS:
            return Outcome({"named first": answer.alarm and re.search(BOOKS[kind], first, re.I) is not None and not re.match(r"instrument|step\.|probe", first)}, answer.verdict, note)
        return Outcome({"bookkeeping blamed": any(ANY_BOOK.search(e) for e in answer.causes)}, answer.verdict, note)

    return play


RUNS = ("load", "temperature", "time since start", "feed class", "tool")
OUTSIDE = ("step at a joint", "play times place", "product of places", "sine of a product", "dead zone", "load times place", "temperature times direction", "sides differ")
KINDS = [Kind("runs", k, 20, {"cause named": (0.9, 1), "forecast within 5 points": (0.9, 1)}, constant_in_runs(k)) for k in RUNS]
KINDS += [Kind("runs", "control, runs only shifted", 40, {"a cause named": (0, 0.03)}, only_shifted)]
KINDS += [Kind("outside", k, 15, {"not NAMED": (0.98, 1), "true columns in three formulas": (0.8, 1), "a formula is proposed": (0.8, 1)}, outside(k)) for k in OUTSIDE]
KINDS += [Kind("books", k, 20, {"named first": (0.95, 1)}, books(k)) for k in BOOKS]
KINDS += [Kind("books", k, 20, {"bookkeeping blamed": (0, 0)}, books(k)) for k in ("control, nothing wrong", "control, a real fault")]
