#!/usr/bin/python3
"""Judges `vpost diagnose` at rotary positions: blind five-axis machines with one fault each, read through their angles.

    /usr/bin/python3 tests/judges/rotary_diagnosis/judge.py --vpost target/release/vpost --count 200 --seed 1 --keep /tmp/rotary
    /usr/bin/python3 tests/judges/rotary_diagnosis/judge.py --vpost target/release/vpost --self-test

Exit status 1 where fewer than 95 % of the faults that can be told are named first, or a name is wrong and sure; 2 usage.
README.md says what a case is.
"""

import json
import math
import os
import random
import shutil
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import run  # noqa: E402

import numpy as np  # noqa: E402

import machine as model  # noqa: E402

NAMING = ("NAMED", "PARTIAL", "AMBIGUOUS")
# As far apart as five standard deviations of all readings together: what fifty questions at once leave to chance.
TOLD_SIGMAS = 8.0


def through(low, high, count):
    there = np.linspace(low, high, count)
    return np.concatenate([there, there[::-1]])


def design(rng, machine):
    """Rows as a dictionary of arrays: run, q, rot, tool, dirs. What ISO 10791-6 moves, and lines of the linear axes."""
    runs, tool = [], np.array([0.0, 0.0, -machine.tool_mm])
    short = tool * 0.6
    rest = np.zeros(len(machine.rotary))
    targets = [np.array([rng.uniform(-90, 90), rng.uniform(-90, 90), machine.height + rng.uniform(-30, 60)]) for _ in range(3)]
    for number, target in enumerate(targets):
        for k, name in enumerate(machine.rotary):
            # Each axis alone, the others at 0 and at another place.
            for other in (0.0, rng.uniform(20, 60)):
                low, high = machine.reach[name]
                angles = np.tile(rest + other, (24, 1))
                angles[:, k] = through(low, high, 12)
                runs.append((target, angles, short if machine.head and number == 2 else tool))
        # Both together, the tool round a cone.
        phase = np.linspace(0, 2 * math.pi, 24)
        angles = np.stack([sum(machine.reach[n]) / 2 + (machine.reach[n][1] - machine.reach[n][0]) * 0.35 * w for n, w in zip(machine.rotary, (np.sin(phase), np.cos(phase)))], axis=1)
        runs.append((target, angles, short if machine.head and number == 2 else tool))
    rows = {"run": [], "q": [], "rot": [], "tool": [], "dirs": []}

    def add(q, rot, vector):
        steps = np.diff(q, axis=0, prepend=2 * q[:1] - q[1:2])
        facing = np.zeros(3)
        for n in range(len(q)):
            facing = np.where(np.abs(steps[n]) > 1e-6, np.sign(steps[n]), facing)
            rows["dirs"].append(facing)
        rows["run"] += [f"r{len(set(rows['run']))}"] * len(q)
        rows["q"].append(q), rows["rot"].append(rot), rows["tool"].append(np.tile(vector, (len(q), 1)))

    for target, angles, vector in runs:
        q = np.round(machine.command(np.tile(target, (len(angles), 1)), angles, vector), 3)
        if np.abs(q).max() < 490:
            add(q, np.round(angles, 3), vector)
    for axis in range(3):
        for turned in (False, True):
            at = np.array([rng.uniform(-150, 150), rng.uniform(-150, 150), rng.uniform(0, 150)])
            q = np.tile(at, (22, 1))
            q[:, axis] = np.round(through(-260, 260, 11) + np.tile([0, 7.3, -4.1], 8)[:22] * 0.5, 3)
            add(q, np.round(np.tile([rng.uniform(-40, 40) if turned else 0.0 for _ in machine.rotary], (22, 1)), 3), tool)
    return {k: np.array(v) if k in ("run", "dirs") else np.concatenate(v) for k, v in rows.items()}


def names(machine):
    """Every fault that a case may have, with a size of 1."""
    locations = [f"rotary.{n}" for a in machine.rotary for n in model.LOCATIONS[a]]
    turning = [f"eccentricity.{a}" for a in machine.rotary]
    linear = ["squareness.XY", "squareness.XZ", "squareness.YZ"] + [f"{k}.{a}" for k in ("scale", "backlash") for a in "XYZ"]
    linear += [f"straightness.E{d}{a}" for a in "XYZ" for d in "XYZ" if d != a] + [f"positioning.E{a}{a}" for a in "XYZ"]
    return locations, turning, linear


def nuisances(machine, rows):
    """A shift of each run and a turn of the frame, (3n, m)."""
    n = len(rows["q"])
    runs = list(dict.fromkeys(rows["run"]))
    out = np.zeros((n, 3, 3 * len(runs) + 3))
    for k, run in enumerate(runs):
        for c in range(3):
            out[rows["run"] == run, c, 3 * k + c] = 1
    tip = machine.tip(rows["q"], rows["rot"], rows["tool"])
    for c in range(3):
        e = np.zeros(3)
        e[c] = 1e-3
        out[:, :, 3 * len(runs) + c] = np.cross(e, tip)
    return out.reshape(3 * n, -1)


def patterns(machine, rows, rng):
    """{name: columns (3n, m)} of all that the library may put in a fault's place, um."""
    out = {}
    for group in names(machine):
        for name in group:
            out[name] = machine.columns(name, rows)
    for axis in "XYZ":
        for about in "ABC":
            out[f"angular.E{about}{axis}"] = machine.columns(f"angular.E{about}{axis}", rows)
    return out


def left(base, columns, truth):
    """What of a truth the columns cannot mimic, beside an orthonormal base."""
    columns = columns - base @ (base.T @ columns)
    q, r = np.linalg.qr(columns)
    keep = np.abs(np.diag(r)) > 1e-9 * max(np.abs(r).max(), 1e-30)
    q = q[:, keep]
    return truth - q @ (q.T @ truth)


def case(seed, number):
    """(machine, rows, truth name, size, readings (n, 3), sigma, rivals that nothing tells apart, SNR)."""
    rng = random.Random(f"rotary diagnosis/{seed}/{number}")
    machine = model.Machine(rng)
    rows = design(rng, machine)
    locations, turning, linear = names(machine)
    sigma, snr = rng.choice([0.5, 1.0, 2.0]), rng.choice([3.0, 3.0, 6.0, 12.0])
    base = np.linalg.qr(nuisances(machine, rows))[0]
    while True:
        name = rng.choice(locations if rng.random() < 0.6 else turning if rng.random() < 0.4 else linear)
        weights = [rng.gauss(0, 1) for _ in range(machine.columns(name, rows).shape[1])]
        pure = machine.columns(name, rows) @ weights
        seen = pure - base @ (base.T @ pure)
        rms = math.sqrt(np.mean(seen**2))
        # A part that set-up cannot take away: else no reading shows it.
        if rms > 0.02 * math.sqrt(np.mean(pure**2)) and rms > 1e-6:
            break
    size = snr * sigma / rms
    exact = machine.error(name, [w * size for w in weights], rows)
    noise = np.random.default_rng(rng.getrandbits(60))
    offsets = {run: noise.normal(0, 15, 3) for run in dict.fromkeys(rows["run"])}
    readings = exact + np.array([offsets[run] for run in rows["run"]]) + noise.normal(0, sigma, exact.shape)
    rivals = []
    for rival, columns in patterns(machine, rows, rng).items():
        if rival != name and np.linalg.norm(left(base, columns, seen * size)) < TOLD_SIGMAS * sigma:
            rivals.append(rival)
    return machine, rows, name, [w * size for w in weights], readings, sigma, rivals, snr


def write(folder, machine, rows, readings, sigma):
    """Profile and measurements."""
    folders.put(folder, "machine.toml", machine.profile())
    used = [a for a in "ABC" if a in machine.rotary]
    head = ["run", "x_mm", "y_mm", "z_mm", *(f"{a.lower()}_deg" for a in used), "dx_um", "dy_um", "dz_um", "dir_x", "dir_y", "dir_z", "tool_x_mm", "tool_y_mm", "tool_z_mm", "u_um"]
    table = []
    for n in range(len(readings)):
        rot = [rows["rot"][n][machine.rotary.index(a)] for a in used]
        cells = [rows["run"][n], *(f"{v:.3f}" for v in rows["q"][n]), *(f"{v:.3f}" for v in rot), *(f"{v:.2f}" for v in readings[n])]
        table.append(cells + [str(int(v)) for v in rows["dirs"][n]] + [f"{v:.1f}" for v in rows["tool"][n]] + [f"{sigma:.2f}"])
    folders.table(os.path.join(folder, "rows.csv"), head, table)


def one(arguments):
    vpost, seed, number, keep = arguments
    folder = os.path.join(keep, f"{seed}-{number}")
    os.makedirs(folder, exist_ok=True)
    machine, rows, name, weights, readings, sigma, rivals, snr = case(seed, number)
    write(folder, machine, rows, readings, sigma)
    truth = {"effect": name, "coefficients": weights, "sigma_um": sigma, "snr": snr, "rivals": rivals, "chain": machine.chain}
    folders.put(folder, "truth.json", json.dumps(truth, indent=1))
    status, _, errors = run(vpost, "diagnose", "rows.csv", "-m", "machine.toml", "--json", "answer.json", folder=folder, seconds=600)
    verdict = {"number": number, "effect": name, "chain": machine.chain, "snr": snr, "rivals": rivals, "status": status}
    if status or not os.path.exists(os.path.join(folder, "answer.json")):
        verdict.update(verdict="refused", causes=[], told=[], message=errors[:300])
    else:
        with open(os.path.join(folder, "answer.json"), encoding="utf-8") as file:
            answer = json.load(file)
        causes = answer.get("causes", [])
        verdict["verdict"] = answer["verdict"]
        verdict["causes"] = [c["effect"] for c in causes]
        verdict["told"] = causes[0].get("cannot_be_told_from", []) if causes else []
        verdict["parts"] = parts(name, weights, causes, machine.table)
        for parameter in causes[0]["parameters"] if causes and causes[0]["effect"] == name and len(weights) == 1 else []:
            if parameter.get("u95"):
                verdict["off"] = abs(parameter["value"] - weights[0]) / parameter["u95"]
    judged(verdict)
    if verdict["outcome"] in ("right", "in the set") and not verdict["more"]:
        shutil.rmtree(folder)
    return verdict


def judged(verdict):
    """`right`: first. `in the set`: a rival first, and the fault among what it cannot be told from. `wrong`: a sure name
    that is another. `doubtful`: another name under AMBIGUOUS or PARTIAL. `silent`: no name."""
    causes, name = verdict["causes"], verdict["effect"]
    if not causes or verdict["verdict"] not in NAMING:
        verdict["outcome"] = "silent"
    elif causes[0] == name:
        verdict["outcome"] = "right"
    elif name in verdict["told"]:
        verdict["outcome"] = "in the set"
    elif name in causes:
        verdict["outcome"] = "behind another"
    else:
        verdict["outcome"] = "wrong" if verdict["verdict"] == "NAMED" else "doubtful"
    # More than the fault under a sure verdict is a wrong name too.
    more = [c for c in causes[1:] if c != name and c not in verdict.get("parts", [])]
    verdict["more"] = more if verdict["verdict"] == "NAMED" and verdict["outcome"] == "right" else []


# The slope of a curve along an axis is, after docs/diagnosis.md, a scale or a squareness; with the sign of it in dy/dx.
OWNERS = {f"positioning.E{a}{a}": (f"scale.{a}", 1.0) for a in "XYZ"}
OWNERS |= {"straightness.EXY": ("squareness.XY", -1.0), "straightness.EXZ": ("squareness.XZ", 1.0), "straightness.EYZ": ("squareness.YZ", -1.0)}
WITHIN_U95 = 2.0


def constant_owner(name, tables):
    """What the same displacement everywhere is, if any reading shows it: a table that lies as far the other way. Of two the one
    nearer to the bed, but for what lies along its axis."""
    direction = name[-2] if name[-3:-2] == "E" else ""
    for table in reversed(tables):
        if f"E{direction}0{table}" in model.LOCATIONS[table]:
            return f"rotary.E{direction}0{table}"
    return None


def parts(name, weights, causes, tables):
    """Effects among the causes that are the constant or the slope of the fault's own curve over the places named with it, by
    their sizes and signs.

    The fault is level over 600 mm, with a mean of zero; over the places read, which are fewer, it is not."""
    curve = next((c for c in causes if c["effect"] == name), None)
    place = {p["name"]: p["value"] for p in curve["parameters"]} if curve else {}
    if name.split(".")[0] not in ("positioning", "straightness") or not {"from_mm", "to_mm"} <= place.keys():
        return []
    half = (place["to_mm"] - place["from_mm"]) / 2
    u, share = np.polynomial.legendre.leggauss(200)
    v = np.clip((u * half + (place["to_mm"] + place["from_mm"]) / 2) / model.HALF_MM, -1, 1)
    fault = weights[0] * (1.5 * v**2 - 0.5) + weights[1] * (2.5 * v**3 - 1.5 * v)
    slope_owner, sign = OWNERS.get(name, (None, 0.0))
    truths = {slope_owner: sign * 1e3 * 1.5 * float(np.sum(share * u * fault)) / half, constant_owner(name, tables): -0.5 * float(np.sum(share * fault))}
    out = []
    for cause in causes:
        stated = [p for p in cause["parameters"] if p.get("u95")]
        if cause["effect"] in truths and stated and all(abs(p["value"] - truths[cause["effect"]]) <= WITHIN_U95 * p["u95"] for p in stated):
            out.append(cause["effect"])
    return out


def interval(k, n):
    """95 % interval of a share (Wilson)."""
    if n == 0:
        return 0.0, 1.0
    z, p = 1.96, k / n
    middle, half = (p + z * z / 2 / n) / (1 + z * z / n), z * math.sqrt(p * (1 - p) / n + z * z / 4 / n / n) / (1 + z * z / n)
    return middle - half, middle + half


def report(verdicts, keep):
    told = [v for v in verdicts if not v["rivals"]]
    right = sum(v["outcome"] == "right" for v in told)
    low, high = interval(right, len(told))
    held = sum(v["outcome"] in ("right", "in the set") for v in verdicts)
    sure = [v for v in verdicts if v["outcome"] == "wrong" or v["more"]]
    print(f"{len(verdicts)} cases, {len(verdicts) - len(told)} of a fault that another mimics; folders of what is not right in {keep}")
    print(f"named first, of what can be told: {right} of {len(told)}, {100 * right / max(1, len(told)):.1f} % ({100 * low:.1f} to {100 * high:.1f})")
    print(f"first or in the set, all: {held} of {len(verdicts)}, {100 * held / max(1, len(verdicts)):.1f} %")
    print(f"wrong and sure: {len(sure)}")
    off = [v["off"] for v in verdicts if "off" in v]
    print(f"size within its stated 95 % interval: {sum(o <= 1 for o in off)} of {len(off)}")
    for title, key in (("by kind", lambda v: v["effect"].split(".")[0]), ("by SNR", lambda v: v["snr"]), ("by chain", lambda v: v["chain"])):
        print(title + ":", "; ".join(f"{g}: {sum(v['outcome'] == 'right' for v in told if key(v) == g)} of {sum(key(v) == g for v in told)}" for g in sorted({key(v) for v in told})))
    for v in verdicts:
        if v["outcome"] != "right" or v["more"]:
            print(f"  {v['number']:4} {v['outcome']:14} {v['effect']} at SNR {v['snr']:g}, {v['chain']}: {v['verdict']} {' + '.join(v['causes'])} (or {', '.join(v['told'])}); mimicked by {', '.join(v['rivals']) or 'nothing'} {v.get('message', '')}")
    return 1 if sure or low > 1 or right < 0.95 * len(told) else 0


def self_test(vpost):
    """Formulas against `vpost predict`, and outcomes of answers that are known."""
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(12):
            machine, rows, name, weights, _, _, _, _ = case("self", number)
            if name.split(".")[0] not in ("rotary", "squareness"):
                continue
            far = machine.against_predict(vpost, folder, name, weights[0], rows)
            bad = far > 2e-3
            wrong += bad
            print(f"{'WRONG' if bad else 'ok   '} {machine.chain} {name}: {far:.1e} um from predict")
    for outcome, causes, told, kind in (("right", ["rotary.EX0C"], [], "NAMED"), ("in the set", ["scale.X"], ["rotary.EX0C"], "AMBIGUOUS"), ("wrong", ["scale.X"], [], "NAMED"),
                                        ("doubtful", ["scale.X"], [], "PARTIAL"), ("silent", [], [], "NO GAP"), ("behind another", ["scale.X", "rotary.EX0C"], [], "NAMED")):
        verdict = {"effect": "rotary.EX0C", "causes": causes, "told": told, "verdict": kind}
        judged(verdict)
        wrong += verdict["outcome"] != outcome
        print(f"{'ok   ' if verdict['outcome'] == outcome else 'WRONG'} {outcome}")
    # The slope of a fault that is level over 600 mm, over fewer; and one that it does not have.
    for stated, more in ((-50.0, []), (50.0, ["scale.X"]), (0.0, ["scale.X"])):
        place = [{"name": "from_mm", "value": -200.0}, {"name": "to_mm", "value": 200.0}, {"name": "p2_um", "value": 0.0, "u95": 1.0}]
        causes = [{"effect": "positioning.EXX", "parameters": place}, {"effect": "scale.X", "parameters": [{"name": "scale_um_per_m", "value": stated, "u95": 2.0}]}]
        # 18 (2.5 v^3 - 1.5 v), v = 2 u / 3: (0.7407 * 3/5 - 1) * 18 = -10 um of u, which is 200 mm long.
        names = [c["effect"] for c in causes]
        verdict = {"effect": "positioning.EXX", "causes": names, "told": [], "verdict": "NAMED", "parts": parts("positioning.EXX", [0.0, 18.0], causes, ["C"])}
        judged(verdict)
        wrong += verdict["more"] != more
        print(f"{'ok   ' if verdict['more'] == more else 'WRONG'} slope {stated:g}")
    # Its constant: 12 (1.5 v^2 - 0.5) over two thirds of its travel, 12 (0.5 * 4/9 - 0.5) = -3.33 um; on heads nothing shows it.
    for name, tables, owner, stated, more in (("straightness.EYX", ["A"], "rotary.EY0A", 3.3, False), ("straightness.EYX", ["A"], "rotary.EY0A", -3.3, True), ("straightness.EYX", ["C", "B"], "rotary.EY0C", 3.4, False), ("positioning.EXX", ["C", "B"], "rotary.EX0C", 3.3, True), ("straightness.EYX", [], "rotary.EY0A", 3.3, True)):
        place = [{"name": "from_mm", "value": -200.0}, {"name": "to_mm", "value": 200.0}, {"name": "p2_um", "value": 0.0, "u95": 1.0}]
        causes = [{"effect": name, "parameters": place}, {"effect": owner, "parameters": [{"name": "offset_um", "value": stated, "u95": 0.1}]}]
        right = (parts(name, [12.0, 0.0], causes, tables) == []) == more
        wrong += not right
        print(f"{'ok   ' if right else 'WRONG'} constant {stated:g} of {owner}")
    return 1 if wrong else 0


def main():
    words = options.parser(__doc__, 200, "first", "jobs", vpost="vpost", seed="1")
    given = words.parse_args()
    vpost = options.command(words, given.vpost)
    if given.self_test:
        return self_test(vpost)
    keep = folders.of_findings(given.keep, "rotary-diagnosis-")
    work = [(vpost, given.seed, n, keep) for n in cases.asked(given)]
    return report(list(cases.in_order(one, work, given.jobs)), keep)


if __name__ == "__main__":
    sys.exit(main())
