#!/usr/bin/python3
"""Judges `vpost calibrate rtest` as a black box, on random machines with rotary axes.

    /usr/bin/python3 tests/judges/rtest/judge.py --vpost target/release/vpost --count 100 --jobs 2
    /usr/bin/python3 tests/judges/rtest/judge.py --vpost target/release/vpost --chain ac --kind tables --count 200
    /usr/bin/python3 tests/judges/rtest/judge.py --vpost target/release/vpost --refusals
    /usr/bin/python3 tests/judges/rtest/judge.py --self-test

README.md says what is asked. Exit status: 0 nothing found, 1 something, 2 usage.
"""

import collections
import csv
import io
import os
import re
import shlex
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import code, run, short  # noqa: E402

import numpy as np  # noqa: E402

import answer  # noqa: E402
import generate  # noqa: E402
import machine  # noqa: E402
import reference  # noqa: E402

RATIO = 2.0  # RMS at unseen places against what the noise allows: one case
TYPICAL = 1.3  # the median of a kind
FLOOR_UM = 0.25
RARE = 1e-3
SECONDS = 300  # for one answer


def files(folder):
    out = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.relpath(os.path.join(root, name), folder)
            if path.split(os.sep)[0] in ("out", "out.toml", "found.json"):
                with open(os.path.join(root, name), "rb") as file:
                    out[path] = file.read()
    return out


def predicted(vpost, folder, profile, places):
    """(n, 3): the errors of a profile at places, um, as the command says them."""
    q, rot, tool, case = places
    head, rows = case.table(q, rot, tool, np.zeros(len(q), int))
    folders.table(f"{folder}/places.csv", head[1:], [row[1:] for row in rows])
    status, out, error = run(vpost, "predict", "places.csv", "-m", profile, folder=folder, seconds=SECONDS)
    if status:
        raise ValueError(f"predict: {error[:300]}")
    return np.array([[float(row[k]) for k in ("dx_um", "dy_um", "dz_um")] for row in csv.DictReader(io.StringIO(out))])


def examine(case, folder, vpost):
    """(findings [(name, words)], figures) of one case."""
    wrong, figures = [], {"covered": [], "named": 0, "terms": 0}
    case.write(folder)
    sphere = ["--sphere"] if case.kind == "sphere" else []
    arguments = ["calibrate", "rtest", "rows.csv", *sphere, "-m", "base.toml", "-o", "out.toml", "--json", "found.json", "--holdout", "held.csv", "--date", "2026-01-02", "--temperature", "20", "--instrument", "R-test"]
    folders.put(folder, "command.txt", shlex.join(["vpost", *arguments]) + "\n")
    status, out, error = run(vpost, *arguments, folder=folder, seconds=SECONDS)
    figures["status"] = status
    folders.put(folder, "report.txt", out + error)
    if status not in (0, 1, 2) or "panicked" in error:
        return [("crash", f"exit status {status}: {error[-300:]}")], figures
    if status:
        figures["refused"] = code(error, "?")
        if os.path.exists(f"{folder}/out.toml"):
            wrong.append(("wrote", "refused and yet written"))
        if case.kind == "one-ball" and case.truth.head and "beside one line" in error:
            return wrong, figures
        return wrong + [("refused", short(error))], figures
    if case.kind == "one-ball" and case.truth.head:
        wrong.append(("answered", "a head read with one ball"))
    first = files(folder)
    if run(vpost, *arguments, folder=folder, seconds=SECONDS) != (status, out, error) or files(folder) != first:
        wrong.append(("bytes", "the second run gives other bytes"))
    for name, content in [("report", out.encode()), *first.items()]:
        if re.search(rb"\bNaN\b|\binf(inity)?\b|Infinity", content, re.I):
            wrong.append(("nan", name))
    found = answer.read(f"{folder}/found.json", out + error)

    rows = reference.Rows(case.base, case.names, case.q, case.rot, case.tool, case.run, case.read, case.kind == "sphere")
    q, rot, tool, ball = case.unseen
    unseen = reference.Rows(case.base, case.names, q, rot, tool, ball)
    true, start = 1e3 * case.truth.error(q, rot, tool), 1e3 * case.base.error(q, rot, tool)
    try:
        written = machine.of_profile(f"{folder}/out.toml")
        said = predicted(vpost, folder, "out.toml", (q, rot, tool, case))
    except (AssertionError, KeyError, OSError, ValueError) as trouble:
        return wrong + [("profile", f"{type(trouble).__name__}: {trouble}")], figures
    mine = 1e3 * written.error(q, rot, tool)
    if np.abs(mine - said).max() > 1e-4:
        wrong.append(("profile", f"predict and this judge read it differently, {np.abs(mine - said).max():.4f} um"))
    if case.base.spec["squareness_urad"] != written.spec["squareness_urad"] or any(
        not np.allclose(case.base.spec["axes"][a]["table"][2], written.spec["axes"][a]["table"][2], atol=2e-3) for a in "XYZ" if "table" in case.base.spec["axes"][a]
    ):
        wrong.append(("linear", "a linear axis is not what it was"))

    # unseen places
    left = reference.without_means(said - true, ball)
    before = reference.rms(reference.without_means(start - true, ball))
    after = reference.rms(left)
    allowed = reference.allowed(case, rows, unseen, true - start)
    figures.update(before=before, after=after, allowed=allowed)
    # one ball: functions that it cannot tell apart are not written, whatever that costs
    if after > max(RATIO * allowed, FLOOR_UM) and case.kind != "one-ball":
        wrong.append(("unseen", f"{before:.2f} -> {after:.3f} um at unseen places, {allowed:.3f} allowed"))
    if case.kind != "perfect" and after > before:
        wrong.append(("worse", f"{before:.2f} -> {after:.3f} um"))
    held = found.holdout
    if held is not None and not (0.5 * after - 0.3 < held < np.hypot(after, generate.NOISE * 3**0.5) * 1.3 + 0.2):
        wrong.append(("holdout", f"says {held:.3f} um, {after:.3f} and noise {generate.NOISE} um a component are true"))

    # intervals
    divided = reference.as_divided(case, rows, case.truth, written)
    open_groups = reference.open_terms(rows, case.names)
    hidden = {k for group in open_groups for k in group}
    figures["off"] = {}
    for key in reference.keys(case.names):
        if key in hidden:
            continue
        value, half = found.terms.get(key, (None, None))
        was = case.base.spec["rotary"][key[3]].get("location", {}).get(key, 0.0)
        at = written.spec["rotary"][key[3]]["location"][key]
        figures["terms"] += 1
        if value is None:
            figures["off"][key] = None
            if abs(divided[key] - was) > 3.0 and case.kind != "perfect":
                wrong.append(("silent", f"{key}: {divided[key]:.2f} {machine.unit(key)} is not among the terms"))
            continue
        absolute = min((value, value + was), key=lambda v: abs(v - at))
        if abs(absolute - at) > 0.02 and found.written.get(key, True):
            wrong.append(("profile", f"{key}: the report says {value}, the profile {at} (before {was})"))
        figures["covered"].append((key, bool(abs(absolute - divided[key]) <= half + 1e-3), (absolute - divided[key]) / max(half, 1e-9)))
        if abs(absolute - divided[key]) > 4 * half + 0.05:
            wrong.append(("far", f"{key}: {absolute:.3f} ± {half:.3f}, true {divided[key]:.3f}"))
    # what cannot be told
    for group in open_groups:
        missing = [k for k in group if k not in found.open_names]
        figures["hidden"] = figures.get("hidden", 0) + 1
        if missing:
            wrong.append(("unnamed", f"{' and '.join(group)} cannot be told{' apart' if len(group) > 1 else ''}; not named: {missing}"))
        if len(group) == 1:
            key = group[0]
            was = case.base.spec["rotary"][key[3]].get("location", {}).get(key, 0.0)
            at = written.spec["rotary"][key[3]]["location"][key]
            if abs(at - was) > 0.01:
                wrong.append(("invented", f"{key} cannot be told and is written as {at}, before {was}"))
    if case.kind == "one-ball" and not any(k[2:] in case.names and k[1] in "ABC" for k in found.open_names):
        wrong.append(("unnamed", "one ball, and no function of an angle is said to be open"))
    if case.kind == "perfect":
        size = max([0.0] + [np.abs(written.functions(n, np.arange(*case.range[n], 5.0)) / machine.SCALE).max() for n in case.names])
        figures["table"] = float(size)
    return wrong, figures


def one(arguments):
    vpost, seed, number, chain, kind, folder = arguments
    case = generate.Case(seed, number, chain, kind)
    return case.name, chain, kind, *cases.examined(folder, lambda: examine(case, folder, vpost))


def report(results):
    """Shares over all cases; returns further findings."""
    wrong = []
    kinds = collections.OrderedDict()
    for name, chain, kind, _, figures in results:
        kinds.setdefault((chain, kind), []).append(figures)
    print(f"\n{'chain':11} {'kind':10} cases refused | unseen um: before  after allowed | ratio median largest | in their 95 % interval | hidden")
    every = []
    for (chain, kind), many in kinds.items():
        good = [f for f in many if "after" in f]
        inside = [c for f in many for c in f.get("covered", ())]
        text = f"{chain:11} {kind:10} {len(many):5} {sum('refused' in f for f in many):7} |"
        if good:
            ratio = [f["after"] / max(f["allowed"], 1e-3) for f in good]
            text += " {:17.1f} {:6.3f} {:7.3f} | {:12.2f} {:7.2f} |".format(*(np.median([f[k] for f in good]) for k in ("before", "after", "allowed")), np.median(ratio), max(ratio))
            text += f" {sum(c[1] for c in inside):10} of {len(inside):5} | {sum(f.get('hidden', 0) for f in many)}"
            if kind not in ("perfect", "one-ball") and len(good) >= 8 and np.median(ratio) > TYPICAL and np.median([f["after"] for f in good]) > FLOOR_UM:
                wrong.append(("typical", f"{chain} {kind}: median {np.median(ratio):.2f} times what the noise allows"))
        print(text)
        tables = [f["table"] > 0.5 for f in good if "table" in f]
        if tables and sum(tables) > 1 + 0.1 * len(tables):
            wrong.append(("found-nothing", f"{chain}: functions of the angle on {sum(tables)} of {len(tables)} machines that have none"))
        if kind != "one-ball":
            every += inside
    if every:
        # terms of one machine hang together: the normal limit with half their number
        share, n = np.mean([c[1] for c in every]), len(every)
        slack = 3.3 * np.sqrt(0.95 * 0.05 / (n / 2))
        z = np.array([c[2] for c in every])
        print(f"\n{n} terms, {100 * share:.1f} % in their 95 % intervals (RMS of error over half width {np.sqrt(np.mean(z * z)):.2f}; 0.51 is right)")
        if share < 0.95 - slack or (share > 0.95 + slack and np.sqrt(np.mean(z * z)) < 0.3):
            wrong.append(("interval", f"{100 * share:.1f} % of {n} terms lie in their 95 % intervals"))
        by = collections.defaultdict(list)
        for key, inside, _ in every:
            by[key].append(inside)
        print("  " + ", ".join(f"{k} {100 * np.mean(v):.0f} % of {len(v)}" for k, v in sorted(by.items())))
    return wrong


def main():
    words = options.parser(__doc__, 72, "first", "jobs", "refusals", vpost="vpost", seed="1")
    words.add_argument("--chain", choices=list(generate.CHAINS), action="append")
    words.add_argument("--kind", choices=list(generate.KINDS), action="append")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main()
    vpost, keep = options.command(words, given.vpost), folders.of_findings(given.keep, "rtest-")
    if given.refusals:
        import refusals

        return refusals.main(vpost, keep, given.seed)
    return judge(vpost, keep, given.seed, given.first, given.count, given.chain, given.kind, given.jobs)


def judge(vpost, keep, seed, first, count, chains=None, kinds=None, jobs=1):
    pairs = [(c, k) for k in (kinds or generate.KINDS) for c in (chains or generate.CHAINS)]
    work = []
    for n in range(first, first + count):
        chain, kind = pairs[n % len(pairs)]
        folder = os.path.join(keep, f"{chain}-{kind}-{n}")
        os.makedirs(folder, exist_ok=True)
        work.append((vpost, seed, n, chain, kind, folder))
    results = cases.shown(cases.in_order(one, work, jobs), lambda result: (result[0], result[3]))
    found = collections.Counter(name for result in results for name, _ in result[3])
    for name, words in report(results):
        found[name] += 1
        print(f"!! {name}: {words}")
    print(f"\n{len(results)} cases in {keep}; found: {dict(found) or 'nothing'}")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
