#!/usr/bin/python3
"""Judges the path promise of vpost and its proofs, on adversarial pairs of machine and program, as a black box.

    /usr/bin/python3 tests/judges/proofs/judge.py --vpost target/release/vpost --count 500
    /usr/bin/python3 tests/judges/proofs/judge.py --self-test

For each pair (generate.py) the program is corrected, both programs are read (reader.py), the tip's travel along the
corrected one is computed by a model of its own (model.py) with play as a hysteresis operator (travel.py), and compared
with the programmed path in order (match.py: the Frechet distance, stretch of feed moves by stretch). Checks:

* path     distance / (tolerance + |half output steps|) is at most 1 in the most lenient reading of what turns sideways
           (travel.py lists the readings); the ratio in the strictest one is printed beside it. Where the command warns
           of an unknown side of play (VP0509), the side is tried both ways and the amount it states is allowed on top,
           and half the play of the axes that the first feed motion moves, whose start may be missed along its way:
           `warned` counts what exceeds that, `unwarned` what is off without a warning, `stated` what exceeds only
           the amount that the warning states (the documents leave open whether the start counts).
* bound    `deviation_after_um` of the summary is not below what is found here in that most lenient reading
           (programs with VP0509 left out), nor below what `vpost check --json` finds.
* check    `vpost check` says the same of the output as the judge (a count; no failure of the judge by itself, except that
           an output above 1 which it passes, or one that it refuses at a ratio below 1, is listed).

A refusal (status 1) is allowed and counted by its number. Any other status is a failure. Exit status: 0 nothing found,
1 something, 2 usage.
"""

import collections
import json
import math
import os
import re
import sys
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import code, run  # noqa: E402

import numpy as np  # noqa: E402

import generate  # noqa: E402
import match  # noqa: E402
import files as profiles  # noqa: E402
import reader  # noqa: E402
import travel  # noqa: E402
from model import Machine  # noqa: E402

INCH_STEP = 0.0025400001
SLACK = 1.0005


class Structure(Exception):
    """The corrected program does not have the stretches of the original."""


def allowed_mm(spec, text):
    """The tolerance and the norm of half the output steps: the last decimal written, which for a resolution of 0.0005 is
    0.0001 and for one of 0.002 is 0.001; in inch programs four decimals are a coarser step."""
    steps = np.array([10.0 ** -math.ceil(-math.log10(a["resolution"]) - 1e-9) for a in spec["axes"]])
    if "G20" in text:
        steps = np.maximum(steps, INCH_STEP)
    return spec["tolerance_um"] * 1e-3 + 0.5 * float(np.linalg.norm(steps))


def vectors(spec):
    tools = {None: np.array(spec["tool"], float)}
    for name, length in spec.get("lengths", {}).items():
        tools[name] = np.array([0, 0, -length], float)
    return tools


def judge_text(spec, original, corrected, start_at, extra_mm=0.0, initials=((0, 0, 0),), readings=None):
    """Ratio, distance in um and line of the worst place, for each reading that differs."""
    machine = Machine(spec)
    tools = vectors(spec)
    wanted, taken = reader.read(original, spec, start_at), reader.read(corrected, spec, start_at)
    limit = allowed_mm(spec, original) + extra_mm
    if readings is None:
        readings = travel.READINGS[: 4 if leaning(machine) else 3] if sided(machine) else ("even",)
    if len({m.tool for m in wanted + taken}) != 1:
        raise Structure("the tool changes between motions")
    runs_in = reader.runs(wanted)
    pieces = [(kind, match.Pieces(ms, tools) if kind == "feed" else None, ms) for kind, ms in runs_in]
    found = {}
    for reading in readings:
        worst = (0.0, 0.0, None)
        for initial in initials:
            one = measure(machine, taken, tools, pieces, limit, reading, initial)
            worst = max(worst, one, key=lambda r: r[0])
        found[reading] = worst
    return found


def sided(machine):
    """Whether the readings can differ: something but the place along the axis depends on its direction."""
    for i in range(3):
        if any(e.kind == "lost-motion" and e.axis == i for e in machine.effects):
            return True
        if machine.minus[i] is not None:
            difference = machine.tables[i].f - machine.minus[i].f
            if np.abs(np.delete(difference, i, axis=1)).max() > 0 or difference[:, i].max() > 0:
                return True
    return False


def leaning(machine):
    """Whether angles differ between the directions of some axis."""
    pairs = [(a, b) for a, b in zip(machine.tables, machine.minus) if b is not None]
    return any(np.abs(a.f[:, 3:] - b.f[:, 3:]).max() > 0 for a, b in pairs)


def measure(machine, taken, tools, pieces, limit, reading, initial):
    trace = travel.Trace(taken, machine)
    groups, kinds, last = [], [], None
    for m in taken:
        kind = "rapid" if m.kind == "rapid" else "feed"
        if kind != last:
            kinds.append(kind)
            last = kind
        groups.append(len(kinds) - 1)
    if kinds != [kind for kind, _, _ in pieces]:
        raise Structure(f"{len(kinds)} stretches of rapids and feeds for {len(pieces)}")
    groups = np.array(groups)
    for _ in range(9):
        tip = travel.tips(trace, reading, initial, tools[taken[0].tool])
        cut = []
        group = groups[trace.number]
        for g, (kind, path, _) in enumerate(pieces):
            rows = np.flatnonzero(group == g)
            if kind != "feed" or path.corners is None or len(rows) < 2:
                continue
            a, b = tip[rows[:-1]], tip[rows[1:]]
            long = np.flatnonzero(np.linalg.norm(b - a, axis=1) > limit / 20)
            a, b = a[long], b[long]
            way = b - a
            square = np.maximum(np.sum(way * way, axis=1), 1e-30)
            near = np.zeros(len(a), bool)
            for corner in path.corners:
                t = np.clip(np.sum((corner - a) * way, axis=1) / square, 0, 1)
                near |= np.linalg.norm(a + t[:, None] * way - corner, axis=1) < 1.3 * limit
            cut += rows[:-1][long[near]].tolist()
        if len(trace.t) > 300000 or not cut or not trace.insert(cut, 6):
            break
    tip = travel.tips(trace, reading, initial, tools[taken[0].tool])
    worst = (0.0, 0.0, None)
    group = groups[trace.number]
    for g, (kind, path, motions) in enumerate(pieces):
        if kind != "feed":
            continue
        d, j = match.distance(path, tip[group == g], limit, worst[1] * 1e-3)
        if d > worst[1] * 1e-3:
            line = path.pieces[j].motion.line if path.pieces else motions[0].line
            worst = (d / limit, d * 1e3, line)
    return worst


def unknown_sides(summary):
    """The amount that VP0509 states, mm; None where it does not warn."""
    for warning in summary["warnings"]:
        if warning["code"] == "VP0509":
            return max(float(x) for x in re.findall(r"([0-9.]+) um", warning["message"])) * 1e-3
    return None


def first_play(spec, text, start_at):
    """Half the reversal values of the axes that the first feed motion moves: by that much its start may be missed."""
    machine = Machine(spec)
    for m in reader.read(text, spec, start_at):
        if m.kind != "rapid" and m.length() > 0.0:
            q = m.start[None, :]
            return float(np.linalg.norm([abs(machine.fields(q)[i][2][0]) for i in range(3) if machine.directed(i) and m.start[i] != m.end[i]]))
    return 0.0


def run_pair(vpost, spec, text, start_at, folder):
    """Corrects and checks one program; a dictionary of what came of it."""
    path = profiles.write(spec, folder)
    source, target = folders.put(folder, "in.ngc", text), os.path.join(folder, "out.ngc")
    flags = ["-m", path, "--zero", "true"] + profiles.conditions(spec)
    if start_at:
        flags += ["--start-at", ",".join(f"{v:.6f}" for v in start_at)]
    words = [source, *flags, "-o", target, "--summary", os.path.join(folder, "summary.json")]
    folders.put(folder, "command.txt", " ".join([vpost, *(os.path.basename(w) if w.startswith(folder) else w for w in words)]) + "\n")
    folders.put(folder, "machine.json", json.dumps({"spec": spec, "start_at": start_at}, indent=1))
    status, _, errors = run(vpost, *words, seconds=300)
    result = {"status": status, "stderr": errors}
    if status:
        return result
    with open(target, encoding="ascii") as file:
        result["out"] = file.read()
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        result["summary"] = json.load(file)
    _, said, errors = run(vpost, "check", source, target, *flags, "--json", seconds=300)
    result["check"] = json.loads(said) if said.strip() else {"passed": None, "stderr": errors}
    return result


def judge_pair(task):
    """The verdict on one pair, whose folder stays where something is found."""
    vpost, seed, number, keep = task
    kind, spec, text, start_at = generate.pair(seed, number)
    folder = os.path.join(keep, f"{seed}-{number}")
    os.makedirs(folder, exist_ok=True)
    verdict = assess(kind, number, spec, text, start_at, run_pair(vpost, spec, text, start_at, folder))
    folders.settle(folder, json.dumps(verdict, indent=1, default=str) if verdict["problems"] else "")
    return verdict


def assess(kind, number, spec, text, start_at, result):
    """The verdict on what the command made of a program."""
    verdict = {"kind": kind, "number": number, "problems": [], "tolerance_um": spec["tolerance_um"]}
    if result["status"] == 1:
        verdict["refused"] = code(result["stderr"], "?")
        verdict["message"] = result["stderr"].strip().splitlines()[0] if result["stderr"].strip() else ""
        return verdict
    if result["status"]:
        verdict["problems"].append(("status", f"exit status {result['status']}: {result['stderr'][:300]}"))
        return verdict
    unknown = unknown_sides(result["summary"])
    initials = ((0, 0, 0),)
    if unknown is not None or start_at is None:
        initials = ((1, 1, 1), (-1, -1, -1))
        verdict["warned_um"] = (unknown or 0.0) * 1e3
    extra = unknown or 0.0
    try:
        if "warned_um" in verdict:
            extra += first_play(spec, text, start_at)
        found = judge_text(spec, text, result["out"], start_at, extra, initials)
    except Structure as error:
        verdict["problems"].append(("structure", str(error)))
        return verdict
    verdict["found"] = found
    lenient = min(found.values(), key=lambda r: r[0])
    strict = max(found.values(), key=lambda r: r[0])
    verdict["lenient"], verdict["strict"] = lenient, strict
    if lenient[0] > SLACK:
        verdict["problems"].append(("path" if "warned_um" not in verdict else "warned" if unknown else "unwarned", f"ratio {lenient[0]:.3f}: {lenient[1]:.3f} um at line {lenient[2]}"))
    if extra and "warned_um" in verdict:
        limit = allowed_mm(spec, text) * 1e3 + verdict["warned_um"]
        if lenient[0] <= SLACK and lenient[1] * (1 - match.PRECISION) > limit * SLACK:
            verdict["problems"].append(("stated" if unknown else "unwarned", f"{lenient[1]:.3f} um at line {lenient[2]}; {limit:.3f} with what the warning states"))
    bound, checked = result["summary"]["deviation_after_um"], result["check"].get("deviation_after_um")
    verdict["bound"], verdict["checked"] = bound, checked
    if "warned_um" not in verdict and lenient[1] * (1 - match.PRECISION) - 0.02 > bound + 1e-3 and lenient[1] > 0.08 * spec["tolerance_um"]:
        verdict["problems"].append(("bound", f"summary says {bound}, found {lenient[1]:.3f} um at line {lenient[2]}"))
    if checked is not None and checked > bound + 1.1e-3 and "warned_um" not in verdict:
        verdict["problems"].append(("bound-check", f"summary says {bound}, check finds {checked} um at line {result['check']['deviation_after_line']}"))
    verdict["check"] = result["check"].get("passed")
    if verdict["check"] and lenient[0] > SLACK:
        verdict["problems"].append(("check-blind", f"check passes; ratio {lenient[0]:.3f}"))
    if verdict["check"] is False and strict[0] <= 1.0 and unknown is None:
        verdict["problems"].append(("check-alarm", f"strict ratio {strict[0]:.3f}; {result['check']['findings'][:1]}"))
    return verdict


def main():
    words = options.parser(__doc__, 500, "first", "jobs", "json", vpost="vpost", seed="1")
    words.add_argument("--kind", choices=generate.KINDS, help="only this kind of pair; --first is then a multiple of 14")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.run()
    keep = folders.of_findings(given.keep, "proofs-")
    numbers, begun = cases.asked(given), time.time()
    if given.kind:
        step = len(generate.KINDS)
        numbers = [given.first + k * step + generate.KINDS.index(given.kind) for k in range(given.count)]
    verdicts = cases.in_order(judge_pair, [(given.vpost, given.seed, n, keep) for n in numbers], given.jobs)
    verdicts = cases.shown(verdicts, lambda v: (f"{v['kind']} {v['number']}", v["problems"]))
    if given.json:
        folders.put(".", given.json, json.dumps(verdicts, indent=1, default=str))
    return report(verdicts, keep, time.time() - begun)


def report(verdicts, keep, seconds):
    print(f"\n{len(verdicts)} pairs, {seconds:.0f} s; reproducers in {keep}")
    print(f"{'kind':18} pairs refused warned | lenient ratio: median  9 of 10  largest above 1 | strict: largest above 1")
    for kind in (*generate.KINDS, "all"):
        mine = [v for v in verdicts if kind in ("all", v["kind"])]
        low = sorted(v["lenient"][0] for v in mine if "lenient" in v)
        high = sorted(v["strict"][0] for v in mine if "lenient" in v)
        if not mine:
            continue
        line = f"{kind:18} {len(mine):5} {sum('refused' in v for v in mine):7} {sum('warned_um' in v for v in mine):6} |"
        if low:
            line += f" {low[len(low) // 2]:21.3f} {low[int(0.9 * (len(low) - 1))]:8.3f} {low[-1]:8.4f} {sum(r > SLACK for r in low):7}"
            line += f" | {high[-1]:15.4f} {sum(r > SLACK for r in high):7}"
        print(line)
    refused = collections.Counter(v["refused"] for v in verdicts if "refused" in v)
    print("refused:", dict(refused) or "none")
    counts = collections.Counter(name for v in verdicts for name, _ in v["problems"])
    for name in ("status", "structure", "path", "warned", "unwarned", "stated", "bound", "bound-check", "check-blind", "check-alarm"):
        print(f"{name}: {counts[name]} of {len(verdicts)}")
    return 1 if counts else 0


if __name__ == "__main__":
    sys.exit(main())
