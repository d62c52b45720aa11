#!/usr/bin/python3
"""Judges the correction of turning programs by vpost, as a black box, on random lathes and programs.

    /usr/bin/python3 tests/judges/turning/judge.py --vpost target/release/vpost --count 320 --jobs 2
    /usr/bin/python3 tests/judges/turning/judge.py --vpost target/release/vpost --mill --count 160
    /usr/bin/python3 tests/judges/turning/judge.py --self-test

For each pair (generate.py) the program is corrected (`vpost IN -m PROFILE -d DIALECT`), both programs are played
(reader.py), and the tip's real way on the lathe of workpiece.py with the output is compared with the ideal way of the
input, in (r, z). README.md says what is asked. Exit status: 0 nothing found, 1 something, 2 usage.
"""

import collections
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import run  # noqa: E402
from common.folders import put  # noqa: E402

import numpy as np  # noqa: E402

import generate  # noqa: E402
import match  # noqa: E402
import reader  # noqa: E402
import workpiece  # noqa: E402

# Rounding of this model, mm: sums of angles against products; rs274 prints four decimals of both programs.
MARGIN, MARGIN_RS274 = 0.05e-3, 0.2e-3
RAPID_FACTOR = 4.0
GRID = 0.05
# Whatever an axis that nobody moves is off, mm: `check` allows as much.
LONGEST_WAY = 1.0
# Such a way, mm: as far as the lathes of this judge are off.
SHORT_WAY = 0.06
# A drill stands on the axis: what is written of it is off by what the lathe is off, tens of micrometres.
ON_AXIS = 0.1
SECONDS = 120  # for one answer
MILLS = {"fanuc-lathe": "fanuc", "sinumerik-turn": "sinumerik", "linuxcnc-lathe": "linuxcnc"}
CYCLES = {"g71", "g72", "g73", "g74", "g75", "g76", "turn", "threads", "face", "hole"}
PROBLEMS = ("profile", "status", "passed-as-mill", "unreadable", "interference", "structure", "path", "surface", "rapid", "process", "perfect", "check-blind", "check-alarm", "damage-missed")


def limit_mm(spec):
    """Tolerance and half output steps; under diameter programming a step of X is half of it on the radius."""
    x = 0.5 * spec["axes"]["X"]["resolution_mm"] * (0.5 if spec["x"] == "diameter" else 1.0)
    z = 0.5 * spec["axes"]["Z"]["resolution_mm"]
    return spec["tolerance_um"] * 1e-3 + math.hypot(x, z) + (MARGIN_RS274 if spec["control"] == "linuxcnc-lathe" else MARGIN)


def offsets(spec, tool):
    """(work offset less centre, length, nose) of an offset number, lengths as (x, z)."""
    work = spec["work_offsets_mm"].get("G54", [0, 0, 0])
    length = spec["tool"]["lengths_mm"].get(f"H{tool}", [0, 0, 0]) if tool else [0, 0, 0]
    nose = spec["tool"].get("noses", {}).get(f"H{tool}", {})
    return np.array([work[0], work[2]], float), np.array(length, float), nose


def runs(motions):
    """Motions as alternating groups: ("rapid", [m..]) and ("feed", [m..]) by tool."""
    out = []
    for m in motions:
        kind = "rapid" if m.kind == "rapid" else "feed"
        if m.length() < 1e-9 and m.cycle != "unknown":
            continue
        if kind == "rapid" and out and out[-1][0] == "rapid" and out[-1][1][-1].tool == m.tool:
            out[-1][1].append(m)
        elif kind == "feed" and out and out[-1][0] == "feed" and out[-1][1][-1].tool == m.tool:
            out[-1][1].append(m)
        else:
            out.append((kind, [m]))
    return out


def samples(motions, step=0.25):
    points = [motions[0].points(step)]
    points += [m.points(step)[1:] for m in motions[1:]]
    return np.vstack(points)


def ideal(spec, points, tool):
    work, _, _ = offsets(spec, tool)
    centre = np.array([spec["spindle"]["centre_mm"][0], 0.0])
    return points + work - centre


def real(lathe, spec, points, tool):
    """(r, z) of the tip with these program coordinates, bending and all; r keeps the side of the axis."""
    work, length, nose = offsets(spec, tool)
    q = points + work + length[[0, 2]]
    p = lathe.tip(q[:, 0], q[:, 1], -length + np.array([0, nose.get("height_um", 0) * 1e-3, 0]))
    across, side, along = lathe.seen(p)
    return np.column_stack([np.copysign(np.hypot(across, side), across), along])


def folded(points, floor):
    """Below the height of the tip nothing is reached: radii below `floor` count as that radius."""
    out = points.copy()
    out[:, 0] = np.where(out[:, 0] < floor, floor, out[:, 0])
    return out


def floor_of(spec, lathe):
    side = abs(lathe.origin[1]) + 600 * abs(lathe.along[1]) + 0.02
    return 10 * (side + max([abs(n.get("height_um", 0)) * 1e-3 for n in spec["tool"].get("noses", {}).values()] or [0]))


def from_start(got, wanted, limit, reach):
    """`got` without its way from where a rapid ended, by no more than `reach` and on the feed's own line, to the start of
    `wanted`."""
    # A short way of its own to the start, in the air: from where a rapid of one axis left the other.
    away = np.linalg.norm(got - wanted[0], axis=1)
    near = int(np.argmax(away <= limit))
    if 0 < near and away[near] <= limit and (away[: near + 1] <= reach).all():
        return got[near:]
    head = wanted[1] - wanted[0]
    head = head / max(float(np.linalg.norm(head)), 1e-12)
    k, beside = 0, None
    while k < len(got) - 1:
        along = float((got[k] - wanted[0]) @ head)
        across = got[k] - wanted[0] - along * head
        back = float((got[k + 1] - got[k]) @ head) < 0
        if abs(along) > reach or np.linalg.norm(across) > limit or not (along < 0 or back):
            break
        k, beside = k + 1, across
    return got if beside is None else np.vstack([wanted[0] + beside, got[k:]])


def reach_of(spec, lathe, wanted, got, limit):
    """How far from its start the feed behind these rapids may begin: as far as a rapid may be off, and along an axis that the last
    rapid does not name as far as that axis is off: it stays where the correction of another place put it (contract), or where
    its own words did while the other axis was not known (docs/decisions.md, "Rapids before all axes are known stay as they
    are")."""
    allowed = RAPID_FACTOR * limit
    tool = wanted[0].tool
    off = real(lathe, spec, np.array([got[-1].b]), tool)[0] - ideal(spec, np.array([wanted[-1].b]), tool)[0]
    off = np.where(moved(wanted[-1]), 0.0, off)
    return allowed + min(float(np.linalg.norm(off)), LONGEST_WAY)


def moved(m):
    """Which of r and z a rapid is asked for: the axes that it moves. A positioning block has its own axes only (contract), so the
    other one stays where the correction of an earlier place put it."""
    axes = np.array(m.named) if m.named else np.abs(np.array(m.b) - np.array(m.a)) > 1e-9
    return axes if axes.any() else np.array([True, True])


def compare(spec, motions_in, motions_out):
    """Worst distances of paths and rapids, in limits; raises ValueError where the runs do not answer each other."""
    lathe = workpiece.Lathe(spec)
    limit = limit_mm(spec)
    floor = floor_of(spec, lathe)
    a, b = runs(motions_in), runs(motions_out)
    if [k for k, _ in a] != [k for k, _ in b]:
        raise ValueError(f"{len(a)} stretches of rapids and feeds became {len(b)}")
    path, rapid, line, reach = 0.0, 0.0, None, RAPID_FACTOR * limit
    for (kind, ms), (_, ns) in zip(a, b):
        tool = ms[0].tool
        if ns[0].tool != tool:
            raise ValueError("another tool")
        if kind == "rapid":
            reach = reach_of(spec, lathe, ms, ns, limit)
            for m, n in zip(ms, ns) if len(ms) == len(ns) else [(ms[-1], ns[-1])]:
                wanted = ideal(spec, np.array([m.b]), tool)
                got = real(lathe, spec, np.array([n.b]), tool)
                if wanted[0, 0] > floor:
                    rapid = max(rapid, float(np.linalg.norm((wanted - got) * moved(m))) / limit)
            continue
        wanted = folded(ideal(spec, samples(ms), tool), floor)
        got = folded(real(lathe, spec, samples(ns), tool), floor)
        got = from_start(got, wanted, limit, reach)
        _, _, nose = offsets(spec, tool)
        h = abs(nose.get("height_um", 0)) * 1e-3 + abs(lathe.origin[1]) + 0.02
        lowest = max(min(wanted[:, 0].min(), got[:, 0].min()), floor)
        slack = h * h * nose.get("radius_mm", 0) / lowest**2
        d, _ = match.distance(got, wanted, limit)
        ratio = d / (limit + slack)
        if ratio > path:
            path, line = ratio, ms[0].line
    return path, rapid, line


def ways_left_out(motions):
    """Feeds without those that only lead to their start, in the air, from where a rapid left an axis that it did not name."""
    out = []
    for m in motions:
        behind_rapid = not out or out[-1].kind == "rapid"
        if not (m.kind == "feed" and behind_rapid and m.length() < SHORT_WAY):
            out.append(m)
    return out


def surface(spec, lathe, motions, z, angles, perfect):
    """Radius at places z of the finished surface: outside and bore."""
    out = {}
    for inside in (False, True):
        s = workpiece.Surface(z, angles, inside)
        # threads are no surface, and a drill on the axis would take all of it away
        for kind, ms in runs([m for m in motions if m.kind != "thread" and not abs(m.a[0]) < ON_AXIS > abs(m.b[0])]):
            if kind == "rapid":
                continue
            work, length, nose = offsets(spec, ms[0].tool)
            radius, to_tip = reader.nose_of(spec, ms[0].tool)
            n = workpiece.Nose(radius, to_tip, 0.0 if perfect else nose.get("height_um", 0) * 1e-3)
            if n.inside() != inside:
                continue
            q = samples(ms, 1e9 if perfect else 1.0) + work + length[[0, 2]]
            s.cut(lathe, n, q[:, 0], q[:, 1], -length)
        out[inside] = s.mean()
    return out


def surfaces(spec, motions_in, motions_out, angles):
    """Largest difference of the finished surfaces beyond the limit, as a ratio, and the largest difference, um."""
    lathe, perfect = workpiece.Lathe(spec), workpiece.Lathe(spec, True)
    if all(m.kind == "rapid" for m in motions_in):
        return 0.0, 0.0
    limit = limit_mm(spec)
    floor = floor_of(spec, lathe)
    low = min(m.b[1] for m in motions_in) + spec["work_offsets_mm"]["G54"][2]
    high = max(max(m.a[1], m.b[1]) for m in motions_in if m.kind != "rapid") + spec["work_offsets_mm"]["G54"][2]
    z = np.arange(max(low, high - 400), high, GRID) + 0.0123
    turns = angles if lathe.wobbles() else 1
    got = surface(spec, lathe, ways_left_out(motions_out), z, turns, False)
    worst, place = 0.0, None
    band = surface(spec, perfect, motions_in, np.concatenate([z - limit, z, z + limit]), 1, True)
    for inside in (False, True):
        stack = band[inside].reshape(3, -1)
        with np.errstate(invalid="ignore"):
            low_r, high_r = stack.min(axis=0) - limit, stack.max(axis=0) + limit
            beyond = np.maximum(low_r - got[inside], got[inside] - high_r)
            beyond = np.where(stack.min(axis=0) < floor, np.nan, beyond)
        if np.isfinite(beyond).any():
            k = int(np.nanargmax(beyond))
            ratio = 1 + float(beyond[k]) / limit
            if ratio > worst:
                worst, place = ratio, float(z[k])
    return worst, place


def process(player, motions):
    """What happens beside the path: events in order, and the states under which motions cut, repeats dropped."""
    states = []
    for m in motions:
        if m.kind != "rapid":
            one = (m.kind, m.state, m.comp)
            if not states or states[-1] != one:
                states.append(one)
    return player.events, states


def lathe_codes(message):
    return re.findall(r"VP\d{4}", message)


def correct(vpost, spec, folder, extra=()):
    """Status, output and messages of the command on `in.nc`, which writes `out.nc`."""
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    return run(vpost, path("in.nc"), "-m", path("lathe.toml"), "-d", spec["control"], *extra, "-o", path("out.nc"), "--summary", path("summary.json"), seconds=SECONDS)


def assess(spec, text, out, angles=5):
    """Problems of an output: list of (name, message), and figures."""
    problems, figures = [], {}
    try:
        motions_in, player_in = reader.read(text, spec)
    except reader.Unreadable as error:
        return [("unreadable", f"input: {error}")], figures
    try:
        motions_out, player_out = reader.read(out, spec)
    except reader.Interference as error:
        return [("interference", f"output: {error}")], figures
    except (reader.Unreadable, ValueError, ZeroDivisionError, TypeError) as error:
        return [("unreadable", f"output: {error}")], figures
    cycles = any(m.cycle in CYCLES for m in motions_in)
    same = True
    try:
        path, rapid, line = compare(spec, motions_in, motions_out)
        figures["path"] = path
        if path > 1:
            problems.append(("path", f"ratio {path:.3f} in the stretch from line {line}"))
        if rapid > RAPID_FACTOR:
            problems.append(("rapid", f"{rapid:.1f} limits"))
    except ValueError as error:
        same = False
        figures["surface-only"] = True
        if not cycles:
            problems.append(("structure", str(error)))
    worst, place = surfaces(spec, motions_in, motions_out, angles)
    figures["surface"] = worst
    if worst > 1 + 1e-9:
        problems.append(("surface", f"ratio {worst:.3f} at Z {place:.3f} of the machine"))
    if same:
        (events_in, states_in), (events_out, states_out) = process(player_in, motions_in), process(player_out, motions_out)
        if events_in != events_out:
            problems.append(("process", f"events {events_in} became {events_out}"[:300]))
        elif states_in != states_out:
            first = next((p for p in zip(states_in, states_out) if p[0] != p[1]), (len(states_in), len(states_out)))
            problems.append(("process", f"{first[0]} became {first[1]}"[:300]))
    return problems, figures


X_WORD = re.compile(r"(?<![A-Z])X(\s*=?\s*)([-+]?\d*\.?\d+\.?\d*)")


def damages(spec, text, out):
    """(name, damaged output, profile spec it is checked with): outputs that a check must refuse."""
    xs_in, xs_out = X_WORD.findall(text), list(X_WORD.finditer(out))
    if not xs_out:
        return
    if len(xs_in) == len(xs_out):
        index = iter(range(len(xs_in)))

        def half(m):
            a = float(xs_in[next(index)][1])
            return f"X{m.group(1)}{a + (float(m.group(2)) - a) / 2:.4f}"

        yield "diameter for radius", X_WORD.sub(half, out), spec
    cuts = [m for m in xs_out if re.search(r"G0?1\b", out[out.rfind("\n", 0, m.start()) + 1 : m.start()])]
    if cuts:
        m = cuts[len(cuts) // 2]
        yield "20 um", out[: m.start()] + f"X{m.group(1)}{float(m.group(2)) + 0.02 * (2 if spec['x'] == 'diameter' else 1):.4f}" + out[m.end() :], spec
        if spec.get("g_code_system") == "A":
            yield "U for X", out[: m.start()] + "U" + out[m.start() + 1 :], spec


def wrong_profiles(spec):
    """(name, spec) of lathes that are wrong in one sign or number: what is corrected with them must not pass."""
    if spec.get("tailstock") and abs(spec["tailstock"]["offset_um"][0]) > 10:
        other = json.loads(json.dumps(spec))
        other["tailstock"]["offset_um"][0] *= -1
        other.get("headstock", {"offset_um": [0, 0]})["offset_um"][0] *= -1
        yield "sign of alpha", other
    noses = spec["tool"].get("noses", {})
    if noses and abs(noses["H1"].get("height_um", 0)) > 30:
        other = json.loads(json.dumps(spec))
        other["tool"]["noses"]["H1"]["height_um"] = 0.0
        yield "tip height left out", other


def judge_pair(task):
    vpost, seed, number, keep, angles, mill = task
    kind, spec, text = generate.pair(seed, number)
    folder = os.path.join(keep, f"{seed}-{number}")
    os.makedirs(folder, exist_ok=True)
    verdict = {"kind": kind, "number": number, "problems": [], "figures": {}}
    try:
        (judge_mill if mill else judge_lathe)(vpost, spec, text, folder, angles, verdict, number)
    except subprocess.TimeoutExpired:
        verdict["problems"].append(("status", f"no end within {SECONDS} s"))
    folders.settle(folder, json.dumps(verdict, indent=1) if verdict["problems"] else "")
    return verdict


def judge_mill(vpost, spec, text, folder, _angles, verdict, _number):
    """A mill's dialect and profile: the program must be refused as a lathe's, naming the lathe's dialect."""
    dialect = MILLS[spec["control"]]
    put(folder, "in.nc", text, "latin-1")
    z = spec["work_offsets_mm"]["G54"][2]
    put(folder, "lathe.toml", f'format = 1\nname = "mill"\ncontrol = "{dialect}"\nchain = "[w X Y b Z t]"\n'
        + "".join(f"[axis.{a}]\ntravel_mm = [-1000, 1000]\n" for a in "XYZ")
        + f"[squareness]\nEB0Z_urad = -80.0\n[tool]\nlengths_mm = {{ H1 = 0.0 }}\n[work_offsets_mm]\nG54 = [0, 0, {z}]\n[program]\ndecimal = \"millimetres\"\n")
    extra = ["--start-at", "100,0,100"]
    status, _, errors = correct(vpost, {**spec, "control": dialect}, folder, extra)
    put(folder, "stderr.txt", errors)
    if status == 0:
        with open(os.path.join(folder, "out.nc"), encoding="latin-1", newline="") as file:
            if file.read() == text:
                verdict["refused"] = "unchanged"
                return
        verdict["problems"].append(("passed-as-mill", f"exit 0 under -d {dialect}"))
    elif status != 1:
        verdict["problems"].append(("status", f"exit {status}: {errors[:200]}"))
    else:
        verdict["refused"] = (lathe_codes(errors) or ["?"])[0] + (" names it" if spec["control"] in errors else "")


def judge_lathe(vpost, spec, text, folder, angles, verdict, number):
    put(folder, "in.nc", text)
    put(folder, "spec.json", json.dumps(spec, indent=1))
    generate.write(spec, folder)
    status, _, errors = correct(vpost, spec, folder)
    put(folder, "stderr.txt", errors)
    if status == 2:
        verdict["problems"].append(("profile", " ".join(errors.split())[:200]))
        return
    if status == 1:
        verdict["refused"] = (lathe_codes(errors) or ["?"])[0]
        verdict["message"] = errors[:300]
        if spec.get("perfect"):
            verdict["problems"].append(("perfect", f"a perfect lathe's program is refused: {verdict['refused']}"))
        return
    if status:
        verdict["problems"].append(("status", f"exit {status}: {errors[:200]}"))
        return
    with open(os.path.join(folder, "out.nc"), encoding="utf-8", newline="") as file:
        out = file.read()
    verdict["warned"] = sorted(set(lathe_codes(errors)))
    if spec.get("perfect"):
        if out != text:
            verdict["problems"].append(("perfect", "a perfect lathe's program is changed"))
        return
    problems, figures = assess(spec, text, out, angles)
    if any(name == "unreadable" and message.startswith("input") for name, message in problems):
        # LinuxCNC's interpreter refuses some lead-ins of its compensation: nothing to compare with
        verdict["unjudged"] = problems[0][1]
        return
    verdict["problems"] += problems
    verdict["figures"] = figures
    passed = check(vpost, spec, folder, "out.nc")
    wrong = any(name in ("path", "surface", "process", "structure", "interference") for name, _ in problems)
    if passed and wrong:
        verdict["problems"].append(("check-blind", str(problems[0])))
    if passed is False and not problems:
        verdict["problems"].append(("check-alarm", "check refuses what the judge passes"))
    if number % 3:
        return
    verdict["damages"] = []
    for name, damaged, _ in damages(spec, text, out):
        if not any(p in ("path", "surface", "unreadable", "interference", "structure") for p, _ in assess(spec, text, damaged, 4)[0]):
            continue
        put(folder, "damaged.nc", damaged)
        found = check(vpost, spec, folder, "damaged.nc") is not True
        verdict["damages"].append((name, found))
        if not found:
            verdict["problems"].append(("damage-missed", name))
    for name, other in wrong_profiles(spec):
        with tempfile.TemporaryDirectory() as second:
            put(second, "in.nc", text)
            generate.write(other, second)
            if correct(vpost, other, second).status:
                continue
            with open(os.path.join(second, "out.nc"), encoding="utf-8", newline="") as file:
                damaged = file.read()
        if any(p in ("path", "surface") for p, _ in assess(spec, text, damaged, 4)[0]):
            put(folder, "damaged.nc", damaged)
            found = check(vpost, spec, folder, "damaged.nc") is not True
            verdict["damages"].append((name, found))
            if not found:
                verdict["problems"].append(("damage-missed", name))


def check(vpost, spec, folder, name):
    """True, False, or None where `check` says nothing."""
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    said = run(vpost, "check", path("in.nc"), path(name), "-m", path("lathe.toml"), "-d", spec["control"], "--json", seconds=SECONDS).output
    try:
        return json.loads(said)["passed"]
    except (ValueError, KeyError):
        return None


def report(verdicts, keep, seconds):
    print(f"\n{len(verdicts)} programs, {seconds:.0f} s; reproducers in {keep}")
    print(f"{'kind':16} programs refused judged surface-only | path ratio: median largest | surface: largest | WRONG")
    wrong_names = ("path", "surface", "structure", "interference", "passed-as-mill", "process")
    for kind in (*generate.KINDS, "all"):
        mine = [v for v in verdicts if kind in ("all", v["kind"])]
        if not mine:
            continue
        path = sorted(v["figures"]["path"] for v in mine if "path" in v["figures"])
        rough = [v["figures"]["surface"] for v in mine if "surface" in v["figures"]]
        wrong = sum(any(n in wrong_names for n, _ in v["problems"]) for v in mine)
        print(f"{kind:16} {len(mine):8} {sum('refused' in v for v in mine):7} {sum(bool(v['figures']) for v in mine):6} {sum('surface-only' in v['figures'] for v in mine):12} | "
              + (f"{path[len(path) // 2]:18.3f} {path[-1]:7.3f}" if path else f"{'-':>18} {'-':>7}") + " | " + (f"{max(rough):16.3f}" if rough else f"{'-':>16}") + f" | {wrong:5}")
    print("refused:", dict(collections.Counter(v["refused"] for v in verdicts if "refused" in v)) or "none")
    print("unjudged (the control itself refuses the input):", sum("unjudged" in v for v in verdicts))
    print("warned:", dict(collections.Counter(w for v in verdicts for w in v.get("warned", ()))) or "none")
    found = collections.Counter((name, hit) for v in verdicts for name, hit in v.get("damages", ()))
    for name in sorted({n for n, _ in found}):
        print(f"damage {name}: {found[name, True]} of {found[name, True] + found[name, False]} found by check")
    counts = collections.Counter(name for v in verdicts for name in {n for n, _ in v["problems"]})
    for name in PROBLEMS:
        print(f"{name}: {counts[name]} of {len(verdicts)}")
    return 1 if counts else 0


def main():
    words = options.parser(__doc__, 320, "first", "jobs", "json", vpost="vpost", seed="1")
    words.add_argument("--kind", choices=generate.KINDS, help="only this kind of program")
    words.add_argument("--angles", type=int, default=5, help="spindle angles of a surface under spindle error motion (harmonics 1 and 2 have no mean over 5); 720 for the record")
    words.add_argument("--mill", action="store_true", help="ask the mill's dialects instead: they must refuse and name the lathe's")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.run()
    keep = folders.of_findings(given.keep, "turning-")
    numbers, begun = cases.asked(given), time.time()
    if given.kind:
        step = len(generate.KINDS)
        numbers = [(given.first + k) * step + generate.KINDS.index(given.kind) for k in range(given.count)]
    verdicts = cases.in_order(judge_pair, [(given.vpost, given.seed, n, keep, given.angles, given.mill) for n in numbers], given.jobs)
    verdicts = cases.shown(verdicts, lambda v: (f"{v['kind']} {v['number']}", v["problems"]))
    if given.json:
        folders.put(".", given.json, json.dumps(verdicts, indent=1))
    return report(verdicts, keep, time.time() - begun)


if __name__ == "__main__":
    sys.exit(main())
