#!/usr/bin/python3
"""Judges the engine `field` as a black box: what `vpost predict` makes of measured vectors, and whether programs are corrected by it.

    /usr/bin/python3 tests/judges/field/judge.py --vpost target/release/vpost --count 70 --jobs 2
    /usr/bin/python3 tests/judges/field/judge.py --vpost target/release/vpost --kind exact --count 20 --programs 3
    /usr/bin/python3 tests/judges/field/judge.py --vpost target/release/vpost --refusals
    /usr/bin/python3 tests/judges/field/judge.py --self-test

README.md says what is asked. Exit status: 0 nothing found, 1 something, 2 usage.
"""

import collections
import csv
import io
import json
import os
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import code, run  # noqa: E402

import numpy as np  # noqa: E402

import compare  # noqa: E402
import fields  # noqa: E402
import generate  # noqa: E402
import reader  # noqa: E402

RATIO = 1.6  # RMS at unseen places against the oracle smoother: one case
TYPICAL = 1.2  # the median of a kind
NOTHING_UM = 0.7  # what may be predicted of a machine without errors: the oracle, which knows, leaves some 0.3
SECOND_ORDER_UM = 2e-3  # half the square of 40 urad on 400 mm is 0.3 nm, and figures are printed to 0.01 nm
SECONDS = 300  # for one answer
SLACK_UM = 0.05  # sampling, and the order of small rotations
STEP_MM = 3.0


def predict(vpost, folder, places, profile="machine.toml", more=()):
    """(n, 3): error of the field at commands, um."""
    folders.table(f"{folder}/places.csv", ["x_mm", "y_mm", "z_mm"], [[f"{v:.9f}" for v in p] for p in places])
    status, out, error = run(vpost, "predict", "places.csv", "-m", profile, *more, folder=folder, seconds=SECONDS)
    if status:
        raise ValueError(f"predict: {' '.join(error.split())[:300]}")
    if re.search("nan|inf", out, re.I):
        raise ValueError("predict: NaN or infinity")
    return np.array([[float(row[k]) for k in ("dx_um", "dy_um", "dz_um")] for row in csv.DictReader(io.StringIO(out))])


def smooth(case, folder, vpost):
    """What is predicted of the unseen."""
    wrong, figures = [], {}
    said = predict(vpost, folder, case.inside)
    truth = case.field(case.inside)
    after, before = fields.rms(said - truth), fields.rms(truth)
    oracle, how, family = fields.best(case.places, case.read, case.box, case.inside, truth, case.kind.startswith("rigid"))
    figures.update(before=before, after=after, oracle=oracle, how=how, family=family)
    if case.kind == "exact":
        nodes = predict(vpost, folder, case.places)
        off = np.abs(nodes - case.read).max()
        figures["nodes"] = float(off)
        if off > 1e-3:
            wrong.append(("nodes", f"a node is missed by {off:.4f} um without noise"))
        cubic, linear = (fields.lattice(case.places, case.read, case.inside, w) for w in (fields.spline, fields.straight))
        figures.update(cubic=fields.rms(cubic - truth), linear=fields.rms(linear - truth))
        off = np.abs(said - linear).max()
        figures["between"] = float(off)
        if off > 1e-3:
            wrong.append(("between", f"{off:.4f} um from what is linear along each axis between the nodes, {np.abs(said - cubic).max():.4f} um from natural cubic splines"))
    elif after > (NOTHING_UM if case.kind == "nothing" else RATIO * oracle):
        wrong.append(("unseen", f"{before:.2f} -> {after:.3f} um at unseen places, {oracle:.3f} by {how}"))
    # outside nothing is predicted
    low, high = np.array(case.box).T
    for point in ([high[0] + 5, *(low + high)[1:] / 2], [*(low + high)[:2] / 2, low[2] - 3]):
        try:
            predict(vpost, folder, np.array([point]), more=["--outside", "refuse"])
            wrong.append(("outside", f"predicts at {np.round(point, 1)}, outside {case.box}"))
        except ValueError as refusal:
            if not re.search(r"VP\d{4}.*outside", str(refusal)):
                wrong.append(("outside", str(refusal)))
    # solve is the inverse of predict
    folders.table(f"{folder}/targets.csv", ["x_mm", "y_mm", "z_mm"], [[f"{v:.6f}" for v in p] for p in targets(case)])
    status, out, error = run(vpost, "solve", "targets.csv", "-m", "machine.toml", folder=folder, seconds=SECONDS)
    if status:
        wrong.append(("solve", " ".join(error.split())[:200]))
    else:
        q = np.array([[float(row[k]) for k in ("qx_mm", "qy_mm", "qz_mm")] for row in csv.DictReader(io.StringIO(out))])
        off = np.abs(q + 1e-3 * predict(vpost, folder, q) - targets(case)).max()
        if off > 1e-8:
            wrong.append(("solve", f"predict at what solve says misses the target by {off:.2e} mm"))
    return wrong, figures


def targets(case):
    low, high = np.array(case.box).T
    return np.clip(case.inside[:50], low + 0.05 * (high - low), high - 0.05 * (high - low))


def correct(case, folder, vpost, number):
    """One random program, corrected and compared."""
    wrong, figures = [], {}
    text = case.program()
    source, target = f"in{number}.ngc", f"out{number}.ngc"
    folders.put(folder, source, text)
    status, out, error = run(vpost, source, "-m", "machine.toml", "--zero", "true", "-o", target, "--summary", "summary.json", folder=folder, seconds=SECONDS)
    if status:
        return [("refused", f"{source}: {' '.join(error.split())[:250]}")], {"refused": code(error, "?")}
    with open(f"{folder}/{target}", encoding="ascii") as file:
        result = file.read()
    with open(f"{folder}/summary.json", encoding="utf-8") as file:
        summary = json.load(file)
    if summary.get("engine") != "field":
        wrong.append(("engine", f"the summary says {summary.get('engine')}"))
    limit = case.tolerance + 0.5 * 3**0.5 * 1.0 + SLACK_UM
    try:
        wanted, taken = reader.read(text, case.offset, case.lengths), reader.read(result, case.offset, case.lengths)
        tips = lambda q: q + 1e-3 * predict(vpost, folder, q)  # noqa: E731
        found = compare.compare(wanted, taken, tips, 1e-3 * limit, STEP_MM)
        before = max(float(np.linalg.norm(tips(x) - x, axis=1).max()) for x in [np.concatenate([compare.sample(m, STEP_MM) for m in wanted if m.kind == "feed"])])
        truth = compare.compare(wanted, taken, lambda q: q + 1e-3 * case.field(q), 1e-3 * (limit + 2), STEP_MM)
    except (compare.Structure, reader.Unreadable, ValueError) as trouble:
        return wrong + [("reading", f"{source}: {trouble}")], figures
    figures.update(um=found["um"], before=1e3 * before, true=truth["um"], share=found["um"] / limit, places=found["places"], blocks=(summary["blocks_in"], summary["blocks_out"]))
    if found["um"] > limit:
        wrong.append(("path", f"{source} line {found['line']}: {found['um']:.3f} um, {limit:.3f} allowed; before {1e3 * before:.1f}"))
    if found["rapid_um"] > 4 * limit:
        wrong.append(("rapid", f"{source}: a positioning move ends {found['rapid_um']:.2f} um off"))
    if found["um"] > summary["deviation_after_um"] + SLACK_UM:
        wrong.append(("summary", f"{source}: says {summary['deviation_after_um']} um, found {found['um']:.3f}"))
    status, out, error = run(vpost, "check", source, target, "-m", "machine.toml", "--zero", "true", "--json", folder=folder, seconds=SECONDS)
    if status and found["um"] <= limit:
        wrong.append(("check", f"{source}: {(out + error)[:250]}"))
    # a damaged output is found, where the damage leaves the path
    lines = result.splitlines()
    feeds = [i for i, line in enumerate(lines) if re.match(r"(N\d+ *)?(G1 )?X-?[\d.]+ Y", line)]
    if feeds:
        k = feeds[len(feeds) // 2]
        lines[k] = re.sub(r"X(-?[\d.]+)", lambda m: f"X{float(m[1]) + 0.03:.3f}", lines[k], count=1)
        damaged = "\n".join(lines) + "\n"
        off = compare.compare(wanted, reader.read(damaged, case.offset, case.lengths), tips, 1e-3 * limit, STEP_MM)["um"]
        folders.put(folder, f"damaged{number}.ngc", damaged)
        status, out, error = run(vpost, "check", source, f"damaged{number}.ngc", "-m", "machine.toml", "--zero", "true", folder=folder, seconds=SECONDS)
        if off > limit + 3 and status != 1:
            wrong.append(("check-blind", f"{source}: X of line {k + 1} moved by 30 um, {off:.1f} um off the path, is passed, status {status}"))
    return wrong, figures


def examine(case, folder, vpost, programs):
    case.write(folder)
    folders.put(folder, "command.txt", "vpost predict places.csv -m machine.toml; vpost in0.ngc -m machine.toml -o out0.ngc\n")
    status, out, error = run(vpost, "profile", "check", "machine.toml", folder=folder, seconds=SECONDS)
    if status not in (0, 1, 2) or "panicked" in error:
        return [("crash", error[-300:])], {}
    if status:
        return [("refused", " ".join(error.split())[:300])], {"refused": code(error, "?")}
    try:
        wrong, figures = smooth(case, folder, vpost)
    except ValueError as trouble:
        return [("refused", str(trouble))], {"refused": (re.search(r"VP\d{4}", str(trouble)) or ["?"])[0]}
    figures["programs"] = []
    for number in range(programs):
        more, found = correct(case, folder, vpost, number)
        wrong += more
        figures["programs"].append(found)
    for command in (["profile", "show", "machine.toml"], ["map", "-m", "machine.toml", "--grid", "5x5x5", "--json", "map.json", "--csv", "map.csv", "--vtk", "map.vtk"]):
        status, out, error = run(vpost, *command, folder=folder, seconds=SECONDS)
        if status:
            wrong.append((command[0], " ".join(error.split())[:200]))
        elif command[0] == "profile" and not re.search(r"field|vectors", out):
            wrong.append(("profile", "`profile show` has no word of the field"))
    return wrong, figures


def one(arguments):
    vpost, seed, number, kind, folder, programs = arguments
    case = generate.Case(seed, number, kind)
    return case.name, kind, *cases.examined(folder, lambda: examine(case, folder, vpost, programs))


def report(results):
    wrong, kinds = [], collections.OrderedDict()
    for _, kind, _, figures in results:
        kinds.setdefault(kind, []).append(figures)
    print(f"\n{'kind':16} cases refused | unseen um: before  after oracle family | after/oracle median largest | programs: refused, before um  after  true, of what is allowed median largest")
    for kind, many in kinds.items():
        good = [f for f in many if "after" in f]
        text = f"{kind:16} {len(many):5} {sum('refused' in f for f in many):7} |"
        if good:
            ratio = [f["after"] / max(f["oracle"], 1e-3) for f in good]
            family = [f["family"] for f in good if f["family"] is not None]
            text += " {:17.2f} {:6.3f} {:6.3f} {:>6} |".format(*(np.median([f[k] for f in good]) for k in ("before", "after", "oracle")), f"{np.median(family):.3f}" if family else "-")
            text += f" {np.median(ratio):19.2f} {max(ratio):7.2f} |"
            if kind not in ("nothing", "exact") and len(good) >= 8 and np.median(ratio) > TYPICAL:
                wrong.append(("typical", f"{kind}: median {np.median(ratio):.2f} times the oracle"))
        if kind == "exact" and good:
            text += " cubic {:.3f} linear {:.3f} |".format(*(np.median([f[k] for f in good]) for k in ("cubic", "linear")))
        programs = [p for f in many for p in f.get("programs", [])]
        done = [p for p in programs if "um" in p]
        if programs:
            text += f" {len(programs):4} {sum('refused' in p for p in programs):4}"
        if done:
            text += " {:8.1f} {:6.2f} {:6.2f} {:10.3f} {:7.3f}".format(*(max(p[k] for p in done) for k in ("before", "um", "true")), np.median([p["share"] for p in done]), max(p["share"] for p in done))
        print(text)
    return wrong


def coincide(vpost, keep, seed):
    """Vectors that engine rigid-body predicts at a lattice, without noise: engine field says the same there. Returns findings."""
    rng = np.random.default_rng(int(seed) if str(seed).isdigit() else 1)
    case = generate.Case(seed, 0, "exact")
    case.tool = np.zeros(3)
    folder = os.path.join(keep, "coincide")
    os.makedirs(folder, exist_ok=True)
    rigid = fields.Rigid(rng, case.box)
    profile = case.profile().split("[field]")[0].splitlines()
    # tables and vectors have the same nodes
    for name, (nodes, rows) in zip("XYZ", rigid.tables([np.unique(case.places[:, i]) for i in range(3)])):
        head = ["position_mm"] + [f"E{c}{name}_{'um' if c in 'XYZ' else 'urad'}" for c in "XYZABC"]
        folders.table(f"{folder}/{name.lower()}.csv", head, [[f"{q:.4f}", *(f"{v:.5f}" for v in row)] for q, row in zip(nodes, rows)])
        profile.insert(profile.index(f"[axis.{name}]") + 1, f'errors = "{name.lower()}.csv"')
    folders.put(folder, "rigid.toml", "\n".join(profile) + "\n")
    read = predict(vpost, folder, case.places, "rigid.toml")
    case.read = read
    head, rows = ["x_mm", "y_mm", "z_mm", "dx_um", "dy_um", "dz_um"], [[f"{v:.3f}" for v in p] + [f"{v:.6f}" for v in d] for p, d in zip(case.places, read)]
    folders.table(f"{folder}/vectors.csv", head, rows)
    folders.put(folder, "machine.toml", case.profile())
    off = np.abs(predict(vpost, folder, case.places) - read).max()
    between = case.inside
    apart = np.abs(predict(vpost, folder, between) - predict(vpost, folder, between, "rigid.toml")).max()
    print(f"coincide: rigid-body and field differ by {off:.2e} um at the nodes, by {apart:.2e} um at most between them")
    wrong = [("coincide", f"{off:.5f} um apart at the nodes")] if off > 2e-5 else []
    # squares of rotations are all that is not linear along each axis
    return wrong + ([("coincide", f"{apart:.5f} um apart between the nodes")] if apart > SECOND_ORDER_UM else [])


def judge(vpost, keep, seed, first, count, kinds=None, jobs=1, programs=2):
    kinds, found = list(kinds or generate.KINDS), collections.Counter()
    work = []
    for n in range(first, first + count):
        folder = os.path.join(keep, f"{kinds[n % len(kinds)]}-{n}")
        os.makedirs(folder, exist_ok=True)
        work.append((vpost, seed, n, kinds[n % len(kinds)], folder, programs))
    results = cases.shown(cases.in_order(one, work, jobs), lambda result: (result[0], result[2]))
    found.update(name for result in results for name, _ in result[2])
    for name, words in report(results):
        found[name] += 1
        print(f"!! {name}: {words}")
    try:
        for name, words in coincide(vpost, keep, seed):
            found[name] += 1
            print(f"!! {name}: {words}")
    except ValueError as trouble:
        found["coincide"] += 1
        print(f"!! coincide: {trouble}")
    print(f"\n{len(results)} cases in {keep}; found: {dict(found) or 'nothing'}")
    return int(bool(found))


def main():
    words = options.parser(__doc__, 70, "first", "jobs", "refusals", vpost="vpost", seed="1")
    words.add_argument("--programs", type=int, default=2, help="programs corrected for each field")
    words.add_argument("--kind", choices=list(generate.KINDS), action="append")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main()
    vpost, keep = options.command(words, given.vpost), folders.of_findings(given.keep, "field-")
    if given.refusals:
        import refusals

        return refusals.main(vpost, keep, given.seed)
    return judge(vpost, keep, given.seed, given.first, given.count, given.kind, given.jobs, given.programs)


if __name__ == "__main__":
    sys.exit(main())
