"""Families dates, plans and bad: has the machine changed, does the proposed measurement settle it, and what must be refused with a message of its own."""

import csv
import re

import numpy

import machine as truth
from common import command

from answer import NAMING, ask
from hidden import OUTSIDE, outside_fault
from judge import Kind, Outcome
from machine import AXES, Machine, measure, setup
from rows import Rows, along, lines, there_and_back, uneven


def interferometer(path, rng, axis, nodes, f, play, noise, zero):
    """Five runs in both directions, EXX of the axis; play is the whole reversal value."""
    name = f"E{AXES[axis]}{AXES[axis]}"
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"run,dir,position_mm,{name}_um\n")
        for k in range(5):
            for sign in (1, -1):
                for p in nodes[::sign]:
                    file.write(f"{k + 1},{sign},{p:.3f},{f(p) - sign * play / 2 + zero + noise * rng.normal():.4f}\n")
    return path


def dates(change):
    """Positioning on two dates: by `vpost calibrate interferometer … -o OLD` and the same with --against OLD."""

    def play(case):
        rng = case.rng
        axis = int(rng.integers(3))
        name, length = f"E{AXES[axis]}{AXES[axis]}", float(numpy.round(rng.uniform(300, 800), -1))
        nodes = numpy.round(numpy.linspace(0, length, int(rng.integers(21, 32))), 3)
        base, first = truth.curve(rng, length, rng.uniform(5, 15)), float(rng.uniform(1, 6))
        noise, at, size = float(rng.uniform(0.2, 0.5)), int(rng.integers(3, len(nodes) - 3)), float(rng.uniform(3, 8) * rng.choice([-1, 1]))
        width = nodes[1] - nodes[0]
        bump = (lambda p: size * numpy.exp(-(((p - nodes[at]) / width) ** 2))) if change == "at a place" else (lambda p: 0.0)
        second = first + (abs(size) if change == "reversal value" else 0.0)
        one = interferometer(case.path("first.csv"), rng, axis, nodes, base, first, noise, 0.0)
        two = interferometer(case.path("second.csv"), rng, axis, nodes, lambda p: base(p) + bump(p), second, noise, rng.normal() * 20)
        amount = {"nothing": "no change is shown", "at a place": f"the machine has changed: {name} by {size:.2f} um at {nodes[at]:.0f} mm",
                  "reversal value": f"the machine has changed: reversal value of {name} by {abs(size):.2f} um"}[change]
        case.deserves("unchanged" if change == "nothing" else "changed", text=f"against old.toml: {amount}")
        common = ["--chain", "[w X Y b Z t]", "--name", "judged", "--u-um-per-m", "0"]
        first_command = [case.vpost, "calibrate", "interferometer", one, "-o", case.path("old.toml"), *common]
        second_command = [case.vpost, "calibrate", "interferometer", two, "--against", case.path("old.toml"), *common]
        said = [command.ask(*c, seconds=120) for c in (first_command, second_command)]
        if said[0][0] or said[1][0]:
            return Outcome({}, "refused", said[0][2] + said[1][2])
        text = said[1][1][said[1][1].index("against"):] if "against" in said[1][1] else ""
        changed = re.search(r"machine has changed", text) is not None
        note = f"{name} {change} {size:.1f} um at {nodes[at]:.0f} mm; said: {' '.join(text.split())}"
        if change == "nothing":
            return Outcome({"change said": changed}, "changed" if changed else "unchanged", note)
        figures = {"change said": changed}
        numbers = [float(v.replace("−", "-")) for v in re.findall(r"[-+−]?\d+(?:\.\d+)?", text)]
        figures["function named"] = name in text
        figures["amount within 20 %"] = any(abs(abs(v) - abs(size) * part) <= 0.2 * abs(size) * part for v in numbers for part in ((1.0, 0.5) if change == "reversal value" else (1.0,)))
        if change == "at a place":
            figures["place within a step"] = any(abs(v - nodes[at]) <= 1.01 * (nodes[1] - nodes[0]) for v in numbers)
        else:
            figures["called reversal"] = re.search(r"revers|play|backlash", text, re.I) is not None
        return Outcome(figures, "changed" if changed else "unchanged", note)

    return play


def from_plan(path_or_text, machine, run_prefix=""):
    """Rows of a CSV as `--plan points` prints it."""
    rows = Rows(machine)
    number = lambda row, key, otherwise: float(row[key]) if row.get(key) not in (None, "") else otherwise
    for row in csv.DictReader(path_or_text.strip().split("\n")):
        rows.run.append(run_prefix + row["run"])
        rows.q.append([float(row[f"{a}_mm"]) for a in "xyz"])
        rows.tool.append([number(row, f"tool_{a}_mm", machine.tool[k]) for k, a in enumerate("xyz")])
        rows.dirs.append([number(row, f"dir_{a}", 0.0) for a in "xyz"])
        for key, otherwise in (("feed_mm_min", 0.0), ("load_kg", 0.0), ("time_s", rows.now["time_s"] + 4.0), ("temp_c", 20.0)):
            rows.conditions[key].append(number(row, key, otherwise))
        rows.now["time_s"] = rows.conditions["time_s"][-1]
    return rows.close()


def whole_plan(curves):
    """The plan that the tool prints for this machine, filled in, with one fault of the library or a smooth curve that is no screw's."""

    def play(case):
        rng = case.rng
        machine = Machine(rng)
        profile = machine.profile(case.folder)
        status, out, err = command.ask(case.vpost, "diagnose", "--plan", "points", "-m", profile, "-q", seconds=120)
        if status:
            return Outcome({}, "refused", err)
        rows = from_plan(out, machine)
        fault, effect, parameters = truth.random_fault(rng, machine, ("positioning", "straightness") if curves else ("scale", "backlash", "lost-motion", "squareness"), rng.uniform(6, 15))
        measure(rng, rows, truth.white(rng.uniform(0.5, 1.2)), [fault], setup(rng))
        case.deserves("NAMED", [(effect, parameters)])
        blank = numpy.array(["" if f == 0 else f"{f:.0f}" for f in rows.feed])
        rows.extra["feed_mm_min"] = blank
        rows.conditions["load_kg"][:] = 0
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), profile, write=False)
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        alone = answer.named and answer.causes == [effect]
        figures = {"a screw is named": any(e.startswith("pitch") for e in answer.causes) and answer.named, "named first": answer.causes[:1] == [effect]} if curves else {"named alone": alone}
        return Outcome(figures, answer.verdict, f"{effect}; found {', '.join(answer.causes)}")

    return play


def proposal_rows(answer, machine, rows):
    """The proposed measurement as rows: `rows` of `next_measurement` (CSV text or a list of objects), else a line read from its sentence; None where there is neither."""
    proposal = answer.data.get("next_measurement") or {}
    listed = proposal.get("rows") or proposal.get("csv")
    if isinstance(listed, list) and listed and isinstance(listed[0], dict):
        names = list(dict.fromkeys(k for row in listed for k in row))
        listed = ",".join(names) + "\n" + "\n".join(",".join("" if row.get(n) is None else str(row[n]) for n in names) for row in listed)
    elif isinstance(listed, list):
        listed = "\n".join(listed)
    if listed:
        return from_plan(listed, machine, "next "), True
    text, more = proposal.get("text", ""), Rows(machine)
    feed = re.search(r"at ([\d.]+) mm/min", text)
    longer = re.search(r"tool ([\d.]+) mm longer", text)
    line = re.search(r"line along ([XYZ]) at ([XYZ]) ([-\d.]+), ([XYZ]) ([-\d.]+)", text)
    more.now = dict(rows.now)
    part = uneven(numpy.random.default_rng(5), 0.03, 0.97, 15)
    if line:
        axis, at = AXES.index(line[1]), numpy.zeros(3)
        at[AXES.index(line[2])], at[AXES.index(line[4])] = float(line[3]), float(line[5])
        places = along(machine, axis, at, part * machine.travel[axis])
    elif "body diagonal" in text:
        places = part[:, None] * machine.travel
    else:
        return None, False
    more.path("next", there_and_back(places, 2), machine.tool - [0, 0, float(longer[1])] if longer else None, feed_mm_min=float(feed[1]) if feed else float(rows.feed[0]))
    return more.close(), False


def joined(first, second):
    both = Rows(first.machine)
    both.run, both.q, both.tool, both.dirs, both.d = (numpy.concatenate([getattr(first, k), getattr(second, k)]) for k in ("run", "q", "tool", "dirs", "d"))
    both.conditions = {k: numpy.concatenate([first.conditions[k], second.conditions[k]]) for k in first.conditions}
    both.extra = {}
    return both


def follow(pair):
    """A design on which two causes are one; the proposal is measured (up to twice), and the cause must stand alone."""

    def play(case):
        rng = case.rng
        machine = Machine(rng)
        profile, axis = machine.profile(case.folder), int(rng.integers(3))
        if pair == "lag or play":
            rows = lines(rng, machine, 3, 9, 1, diagonals=False).close()
            fault, effect, parameters = truth.backlash(axis, rng.uniform(4, 9)) if rng.random() < 0.5 else truth.lag(axis, rng.uniform(4, 9) * 60 / 2000)
        else:  # one line per axis through one corner: a squareness is an angle of a carriage
            rows = Rows(machine)
            corner = machine.travel * 0.1
            for a in range(3):
                for k in range(2):
                    rows.path(f"r{a}{k}", there_and_back(along(machine, a, corner, uneven(rng, 0.1 * machine.travel[a], 0.95 * machine.travel[a], 13))))
            rows.close()
            fault, effect, parameters = truth.squareness(("XY", "XZ", "YZ")[axis], rng.uniform(60, 120) * rng.choice([-1, 1]))
        case.deserves("NAMED", [(effect, parameters)], ambiguous=True)
        frame, noise = setup(rng), truth.white(rng.uniform(0.5, 1.0))
        measure(rng, rows, noise, [fault], frame)
        always, figures, note = ("feed_mm_min",), {}, effect
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv"), always=always), profile, write=False)
        for step in range(2):
            if answer.data is None:
                return Outcome({}, answer.verdict, answer.err)
            note += f"; {answer.verdict} {', '.join(answer.causes)} ({', '.join(answer.rivals())})"
            if answer.verdict not in ("AMBIGUOUS", "UNKNOWN", "PARTIAL", "UNDERPOWERED"):
                break
            note += f", proposal: {(answer.data.get('next_measurement') or {}).get('text')}"
            more, listed = proposal_rows(answer, machine, rows)
            figures["proposed as rows"] = figures.get("proposed as rows", True) and listed
            if more is None:
                return Outcome(figures | {"named alone after it": False}, answer.verdict, note)
            rows = joined(rows, measure(rng, more, noise, [fault], frame))
            answer = ask(case.vpost, case.folder, rows.write(case.path(f"rows_{step + 2}.csv"), always=always), profile, write=False)
        if answer.data is None:
            return Outcome({}, answer.verdict, answer.err)
        note += f"; at last {answer.verdict} {', '.join(answer.causes)} ({', '.join(answer.rivals())})"
        figures["named alone after it"] = answer.named and answer.causes == [effect]
        return Outcome(figures, answer.verdict, note)

    return play


def proposes_anyway(case):
    """An answer without a name says what to measure next."""
    rng = case.rng
    machine = Machine(rng, 300, 700)
    rows = lines(rng, machine, 4, 11, 1).close()
    fault, _, _ = outside_fault(rng, machine, OUTSIDE[1 + case.number % 4])
    measure(rng, rows, truth.white(1.0), [fault], setup(rng))
    case.deserves("UNKNOWN", ambiguous=True)
    answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder), write=False)
    if answer.data is None:
        return Outcome({}, answer.verdict, answer.err)
    if answer.verdict not in ("UNKNOWN", "PARTIAL"):
        return Outcome({}, answer.verdict, ", ".join(answer.causes))
    return Outcome({"proposes": bool(answer.data.get("next_measurement"))}, answer.verdict, ", ".join(answer.causes))


# What must be refused: (what is done to the rows and the hold-out, pattern of a message of its own).

BAD = {
    "covariance: below zero": r"u_[xyz]_um|uncertaint|covariance", "covariance: zero": r"u_[xyz]_um|uncertaint|covariance", "covariance: one component missing": r"u_[xyz]_um|uncertaint|covariance",
    "temperature in some rows": r"temp_c", "load in some rows": r"load_kg", "hold-out outside the travel": r"hold-?out|holdout\.csv", "hold-out with other axes": r"hold-?out|holdout\.csv",
    "two stations without places": r"station",
}


def bad(kind):
    def play(case):
        rng = case.rng
        machine = Machine(rng)
        temps = rng.permutation(numpy.linspace(19, 25, 40))
        loads = rng.permutation(numpy.resize([0.0, 50.0, 100.0], 40))
        rows = lines(rng, machine, 3, 9, 2, change=lambda k: {"temp_c": float(temps[k]), "load_kg": float(loads[k])}).close()
        out = lines(rng, machine, 2, 7, 1, name="h", change=lambda k: {"temp_c": float(temps[-1 - k]), "load_kg": float(loads[-1 - k])}).close()
        fault = truth.random_fault(rng, machine, ("scale", "backlash", "squareness"), 12.0)[0]
        frame = setup(rng)
        for file in (rows, out):
            measure(rng, file, truth.white(1.0), [fault], frame)
        if kind.startswith("covariance"):
            for axis in "xyz" if not kind.endswith("missing") else "xy":
                rows.extra[f"u_{axis}_um"] = numpy.full(len(rows), 1.0)
            if "missing" not in kind:
                rows.extra["u_y_um"][rng.integers(len(rows))] = -1.0 if "below" in kind else 0.0
        for name in ("temperature", "load"):
            if kind == f"{name} in some rows":
                key = {"temperature": "temp_c", "load": "load_kg"}[name]
                gone = rng.random(len(rows)) < 0.5
                rows.extra[key] = numpy.where(gone, "", [f"{v:.2f}" for v in rows.conditions[key]])
        if kind == "hold-out outside the travel":
            out.q += machine.travel * 1.2
        if kind == "hold-out with other axes":
            out.extra["c_deg"] = rng.uniform(0, 360, len(out))
        if "stations" in kind:
            rows.extra["station"] = numpy.where(rng.random(len(rows)) < 0.5, "S1", "S2")
        case.deserves("refused", err=f"error[VP0999]: {kind}: u_x_um, temp_c, load_kg, hold-out, station")
        holdout = out.write(case.path("holdout.csv")) if kind.startswith("hold-out") else None
        answer = ask(case.vpost, case.folder, rows.write(case.path("rows.csv")), machine.profile(case.folder), holdout)
        message = answer.err if answer.data is None else ""
        generic = re.search(r"column `\w+` is unknown", message, re.I) is not None
        own = answer.status in (1, 2) and re.search(BAD[kind], message) is not None and not generic
        return Outcome({"message of its own": own, "a name": answer.verdict in NAMING, "effects written": bool(answer.effects_written)}, answer.verdict, message or ", ".join(answer.causes))

    return play


CHANGED = {"change said": (0.95, 1), "function named": (0.95, 1), "amount within 20 %": (0.95, 1)}
KINDS = [
    Kind("dates", "unchanged", 60, {"change said": (0, 0.02)}, dates("nothing")),
    Kind("dates", "changed at a place", 30, CHANGED | {"place within a step": (0.95, 1)}, dates("at a place")),
    Kind("dates", "reversal value grown", 30, CHANGED | {"called reversal": (0.95, 1)}, dates("reversal value")),
    Kind("plans", "whole plan, one cause", 20, {"named alone": (0.98, 1)}, whole_plan(False)),
    Kind("plans", "whole plan, smooth curve", 30, {"a screw is named": (0, 0.02), "named first": (0.95, 1)}, whole_plan(True)),
    Kind("plans", "proposal: lag or play", 20, {"named alone after it": (0.98, 1), "proposed as rows": (0.98, 1)}, follow("lag or play")),
    Kind("plans", "proposal: squareness or angle", 20, {"named alone after it": (0.98, 1), "proposed as rows": (0.98, 1)}, follow("squareness or angle")),
    Kind("plans", "no name, yet a proposal", 15, {"proposes": (0.95, 1)}, proposes_anyway),
]
KINDS += [Kind("bad", k, 12, {"message of its own": (1, 1), "a name": (0, 0), "effects written": (0, 0)}, bad(k)) for k in BAD]
