#!/usr/bin/python3
"""Judges `vpost calibrate turning` as a black box, on random lathes.

    /usr/bin/python3 tests/judges/calibrate_turning/judge.py --vpost target/release/vpost --count 100 --jobs 2
    /usr/bin/python3 tests/judges/calibrate_turning/judge.py --vpost target/release/vpost --kind faces --count 300
    /usr/bin/python3 tests/judges/calibrate_turning/judge.py --vpost target/release/vpost --refusals
    /usr/bin/python3 tests/judges/calibrate_turning/judge.py --self-test

README.md says what is asked. Exit status: 0 nothing found, 1 something, 2 usage.
"""

import collections
import json
import math
import os
import re
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, command, folders, options  # noqa: E402  before numpy

import numpy as np  # noqa: E402

import generate  # noqa: E402
import lathe  # noqa: E402

ARGUMENTS = ["parts.csv", "-m", "lathe.toml", "--holdout", "held.csv", "--json", "found.json", "-o", "out.toml",
             "--date", "2026-01-02", "--temperature", "20", "--instrument", "micrometer"]
RARE = 1e-3  # a rate that chance explains less often than this is found
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"
# kinds whose parts keep the tool's size, so that the size told can be entered for a further part
SIZED = ("plain", "stated", "quantised", "coarse", "edges", "faces", "perfect", "bending", "tailstock", "known", "lengths", "across", "correlated")
DRIFTS = ("growth_um_per_h", "wear_um_per_part", "change_um_per_part")


def tail(k, n, p):
    """Two-sided exact binomial p value: all outcomes no likelier than k."""
    logs = [math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) + i * math.log(p) + (n - i) * math.log(1 - p) for i in range(n + 1)]
    return min(1.0, sum(math.exp(v) for v in logs if v <= logs[k] + 1e-9))


def upper(k, n, p):
    """P(at least k of n)."""
    return sum(math.exp(math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) + i * math.log(p) + (n - i) * math.log(1 - p)) for i in range(k, n + 1))


def run(vpost, folder, arguments):
    done = command.run(vpost, "calibrate", "turning", *arguments, folder=folder, seconds=120)
    return done.status, done.output + done.errors


def tables(folder, name="out"):
    out = {}
    for root, _, files in os.walk(folder):
        for file in files:
            path = os.path.join(root, file)
            relative = os.path.relpath(path, folder)
            if relative.split(os.sep)[0] in (name, f"{name}.toml", "found.json"):
                with open(path, "rb") as handle:
                    out[relative] = handle.read()
    return out


def stated(report):
    """name -> (value, half width of the 95 % interval) as the report in words says it, sizes and entries by tool."""
    terms = {m[1]: (float(m[2]), float(m[3])) for m in re.finditer(rf"(\S+_\S+) {NUMBER} ± {NUMBER},", report)}
    sizes = {m[1]: (float(m[2]), float(m[3]), float(m[4])) for m in re.finditer(rf"size of (\S+): {NUMBER} ± {NUMBER} um on the radius; with this profile enter {NUMBER} mm", report)}
    return terms, sizes


def truth(case):
    """What the report's terms ought to be: straight line and even bow of the true radius over the measured stretch."""
    z = np.linspace(case.low, case.high, 401)
    r, _ = case.lathe.turned(50 + case.length[0], z + case.length[1], case.length)
    bare = 1e3 * (r - 50 - case.lathe.bending(z))
    u = (z - (case.low + case.high) / 2) / case.half
    at_zero, slope, bow = np.linalg.lstsq(np.column_stack([np.ones_like(z), z * 1e-3, 1 / 3 - u**2]), bare, rcond=None)[0]
    out = {"axis.Z.EXZ_bow_um": bow, "axis.Z.EXZ_order4_um": 0.0}
    if "tailstock" in case.base:
        out["tailstock.offset_um.X"] = slope * case.numbers["tailstock"]["at_mm"] * 1e-3
    elif case.kind == "faces":
        out["spindle.EB0S_urad"], out["squareness.EB0Z_urad"] = case.numbers["EB0S_urad"], case.numbers["EB0Z_urad"]
    else:
        out["spindle.EB0S_urad"] = -slope + case.base.get("EB0Z_urad", 0.0)
    if case.kind not in ("confounded", "warming"):
        out["growth_um_per_h"], out["wear_um_per_part"] = case.growth, case.wear
        out["change_um_per_part"] = 0.0
    return out, {name: at_zero + size for name, size in case.sizes.items()}


def form(error):
    """RMS about the own mean."""
    return float(np.sqrt(np.mean((error - error.mean()) ** 2)))


def held(case, machine, part):
    """Diameter error, um, of a held-out part that is commanded so that `machine` would turn it right; None: as programmed."""
    r, z = part["diameter_mm"] / 2, part["z"]
    x, q = (r + case.length[0], z + case.length[1]) if machine is None else machine.command(np.full_like(z, r), z, case.length)
    return 2e3 * (case.lathe.turned(x, q, case.length)[0] - r)


def examine(case, folder, vpost):
    """What is wrong with the answer to a case: (list of (name, words), figures)."""
    wrong, figures = [], {"kind": case.kind, "covered": [], "strict": 0}
    status, report = run(vpost, folder, ARGUMENTS)
    figures["status"] = status
    folders.put(folder, "report.txt", report)
    if status not in (0, 1, 2) or "panicked" in report:
        return [("crash", f"exit status {status}: {report[-300:]}")], figures
    if status:
        code = re.search(r"error\[(VP\d+)\]: (.*)", report)
        figures["refused"] = code[1] if code else "?"
        if os.path.exists(f"{folder}/out.toml"):
            wrong.append(("wrote", "refused and yet written"))
        if not code:
            wrong.append(("words", f"refused without a code: {report[-200:]}"))
        if case.kind not in ("shape", "blunder", "warming") and not (case.kind == "correlated" and figures["refused"] == "VP1113"):
            # a refusal of worse hold-outs is right only where there is next to nothing to correct
            base = lathe.of_profile(f"{folder}/lathe.toml")
            raw = min(form(held(case, m, case.held[0])) for m in (None, base))
            if figures["refused"] != "VP1103" or raw > 2 * case.noise:
                wrong.append(("refused-" + figures["refused"], f"{figures['refused']}: {code[2] if code else ''} (form {raw:.2f} um before, noise {case.noise:.2f})"))
        return wrong, figures
    first = tables(folder)
    again, second = run(vpost, folder, ARGUMENTS)
    if again != status or second != report or tables(folder) != first:
        wrong.append(("bytes", "the second run gives other bytes"))
    with open(f"{folder}/found.json") as file:
        text = file.read()
    for name, content in [("found.json", text), ("report", report)] + [(k, v.decode("utf-8", "replace")) for k, v in first.items()]:
        if re.search(r"\bNaN\b|\bnan\b|\binf(inity)?\b|Infinity", content):
            wrong.append(("nan", name))
    found = json.loads(text)
    wrong += bookkeeping(case, found)
    terms, sizes = stated(report)
    # the taper is listed whether it is significant or not
    names = [t["name"] for t in found["terms"] if not re.search(re.escape(t["name"]) + r" \S+ ± \S+, not significant", report)]
    true, true_sizes = truth(case)

    # intervals
    if generate.KINDS[case.kind][0]:
        if case.kind != "known":
            for name, (value, half) in terms.items():
                if name in true:
                    figures["covered"].append((name, abs(value - true[name]) <= half + 6e-4))
            if case.kind not in ("drift", "confounded"):
                for tool, (value, half, _) in sizes.items():
                    figures["covered"].append(("size", abs(value - true_sizes[tool]) <= half + 6e-4))
        for name in DRIFTS:
            if name in names and name != "change_um_per_part" and not (case.kind in ("drift", "warming")):
                figures.setdefault("named", []).append(name)
    if case.kind == "confounded":
        if any(name in names for name in ("growth_um_per_h", "wear_um_per_part")):
            wrong.append(("confounded", f"named {names}, growth {case.growth:.2f} um/h and wear {case.wear:.2f} um a part go together"))
        elif not any({"growth", "wear"} <= set(pair) for pair in found["not_told_apart"]):
            wrong.append(("confounded", f"not said: {found['not_told_apart']}"))
        if (case.growth or case.wear) and "cannot be told apart" not in report:
            wrong.append(("confounded", "no words"))
    if case.kind == "perfect":
        figures["tests"] = [significant for _, significant in re.findall(r"(\S+_\S+) -?[\d.]+ ± [\d.]+, (not significant)?", report)]
        figures["tests"] = [not t for t in figures["tests"]]

    # what was written, on the true lathe
    try:
        machine = lathe.of_profile(f"{folder}/out.toml")
        base = lathe.of_profile(f"{folder}/lathe.toml")
    except (KeyError, ValueError) as error:
        return wrong + [("profile", f"not read here: {error}")], figures
    grid = np.linspace(case.low, case.high, 201)
    if case.kind == "known":
        # slope of what is left on the radius: all that the taper's interval may leave
        x, q = machine.command(np.full_like(grid, 40.0), grid, case.length)
        left = 1e3 * (case.lathe.turned(x, q, case.length)[0] - 40)
        slope = np.polyfit(grid * 1e-3, left, 1)[0]
        if "spindle.EB0S_urad" in terms and "spindle.EB0S_urad" in names:
            figures["covered"].append(("spindle.EB0S_urad", abs(slope) <= terms["spindle.EB0S_urad"][1]))
    for part in case.held:
        before, after, known = form(held(case, None, part)), form(held(case, machine, part)), form(held(case, base, part))
        figures.setdefault("forms", []).append((before, after, known))
        figures["strict"] += after > before + 0.05
        if after > before + case.noise:
            wrong.append(("worse", f"{part['part']}: {before:.2f} -> {after:.2f} um RMS of form, noise {case.noise:.2f}"))
        if case.kind == "known" and after > known + case.noise:
            wrong.append(("worse-than-base", f"{part['part']}: {known:.2f} -> {after:.2f} um RMS of form, noise {case.noise:.2f}"))
    if case.kind in SIZED:
        x, q = machine.command(np.full_like(grid, 40.0), grid, case.length)
        left = 2e3 * (case.lathe.turned(x, q, case.length)[0] - 40)
        for tool, size in case.sizes.items():
            rows = sum(r["tool"] == tool and r["feature"] == "diameter" for r in case.rows)
            if not rows:
                continue
            if tool not in sizes:
                wrong.append(("size", f"{tool}: not told"))
                continue
            mean = float(np.mean(left)) + 2 * size + 1e3 * sizes[tool][2]
            allowed = 6 * case.noise / math.sqrt(rows) * (3 if case.kind == "correlated" else 1) + 0.3
            if abs(mean) > allowed:
                wrong.append(("size", f"{tool}: diameters are {mean:.2f} um off with its entry, allowed {allowed:.2f}"))
            full = float(np.sqrt(np.mean((left + 2 * size + 1e3 * sizes[tool][2]) ** 2)))
            figures.setdefault("full", []).append((float(np.sqrt(np.mean((held(case, None, {"diameter_mm": 80.0, "z": grid}) + 2 * size) ** 2))), full))
    wrong += holdout(case, found, machine)
    if "spindle.EB0S_urad" in terms and "spindle.EB0S_urad" in names and case.kind in ("plain", "stated"):
        if abs(machine.numbers["EB0S_urad"] - terms["spindle.EB0S_urad"][0]) > 1e-3:
            wrong.append(("profile", f"EB0S {machine.numbers['EB0S_urad']} written, {terms['spindle.EB0S_urad'][0]} told"))
    if case.number % 5 == 0 and len(vpost) == 1 and case.kind not in ("lengths",):
        wrong += corrected(case, folder, vpost, machine)
    return wrong, figures


def bookkeeping(case, found):
    """The JSON against the page: schema, counts, covariance."""
    wrong = []
    if found.get("schema") != "vpost.turning/1":
        wrong.append(("json", f"schema {found.get('schema')}"))
    for key in ("parts", "rows", "noise_um", "terms", "covariance", "not_told_apart", "offsets", "holdout"):
        if key not in found:
            wrong.append(("json", f"{key} is missing"))
    if wrong:
        return wrong
    if found["parts"] != case.parts or found["rows"] != len(case.rows):
        wrong.append(("json", f"{found['parts']} parts of {case.parts}, {found['rows']} rows of {len(case.rows)}"))
    c = np.array(found["covariance"], float).reshape(len(found["terms"]), -1)
    if c.shape != (len(found["terms"]),) * 2:
        wrong.append(("json", f"covariance {c.shape} of {len(found['terms'])} terms"))
    elif len(c):
        u = np.array([t["u"] for t in found["terms"]])
        if not np.allclose(c, c.T, rtol=1e-9, atol=1e-15) or np.linalg.eigvalsh((c + c.T) / 2)[0] < -1e-9 * c.max():
            wrong.append(("json", "covariance is not symmetric and positive"))
        if not np.allclose(np.sqrt(np.diag(c)), u, rtol=1e-6):
            wrong.append(("json", f"covariance says {np.sqrt(np.diag(c))}, terms {u}"))
    return wrong


def holdout(case, found, machine):
    """The hold-out's figures by own arithmetic: rows less the written machine, each part at its own size."""
    part, length = case.held[0], case.length
    r = part["diameter_mm"] / 2
    read = np.array([row["d_um"] for row in case.held_rows])
    model = 2e3 * (machine.turned(r + length[0], part["z"] + length[1], length)[0] - r)
    left = read - model
    left = left - left.mean()
    wrong = []
    told = found["holdout"]
    if told["rows"] != len(read):
        wrong.append(("holdout", f"{told['rows']} rows of {len(read)}"))
    if "u_um" not in case.held_rows[0] and abs(told["rms_after_um"] - math.sqrt(np.mean(left**2))) > 0.02:
        wrong.append(("holdout", f"rms after {told['rms_after_um']:.3f} told, {math.sqrt(np.mean(left**2)):.3f} here"))
    if told["rms_after_um"] > told["rms_before_um"] + 1e-9:
        wrong.append(("holdout", f"worse and written: {told['rms_before_um']:.3f} -> {told['rms_after_um']:.3f}"))
    return wrong


def corrected(case, folder, vpost, machine):
    """A cylinder corrected with the written profile, played on the machine that this reader takes the profile for."""
    z1, z2, d = round(case.low, 1), round(case.high, 1), 60.0
    folders.put(folder, "shaft.nc", f"%\nO1\nG21 G18 G40 G99 G54\nG0 X100. Z{z2}\nX{d}\nG1 Z{z1} F0.2\nG0 X100.\nM30\n%\n")
    status, _, errors = command.run(vpost, "shaft.nc", "-m", "out.toml", "-o", "shaft_out.nc", folder=folder, seconds=120)
    if status:
        return [("correct", f"refuses the written profile: {errors[:300]}")]
    x = z = None
    feeds = []
    mode = None
    with open(f"{folder}/shaft_out.nc") as file:
        for line in file:
            line = re.sub(r"\(.*?\)", "", line)
            mode = {"0": "rapid", "00": "rapid", "1": "feed", "01": "feed"}.get((re.findall(r"\bG0?([01])(?!\d)", line) or [None])[-1], mode)
            before = (x, z)
            words = dict(re.findall(r"([XZ])(-?[\d.]+)", line))
            x, z = float(words.get("X", x if x is not None else "nan")), float(words.get("Z", z if z is not None else "nan"))
            if words and mode == "feed":
                feeds.append((before, (x, z)))
    worst = 0.0
    for (xa, za), (xb, zb) in feeds:
        t = np.linspace(0, 1, 50)
        r, _ = machine.turned((xa + (xb - xa) * t) / 2, za + (zb - za) * t)
        worst = max(worst, float(np.abs(r - d / 2).max()) * 1e3)
    return [("correct", f"the corrected cylinder is {worst:.2f} um off on the radius")] if not worst <= 1.7 else []


def one(job):
    kind, seed, number, vpost, keep = job
    case = generate.make(kind, seed, number)
    with tempfile.TemporaryDirectory(prefix=f"{kind}-{number}-") as folder:
        generate.write_base(folder, case)
        generate.write_rows(f"{folder}/parts.csv", case.rows, case.style)
        generate.write_rows(f"{folder}/held.csv", case.held_rows)
        try:
            wrong, figures = examine(case, folder, vpost)
        except Exception as error:  # noqa: BLE001  an answer that cannot be read is a finding, not an end
            wrong, figures = [("unreadable", repr(error))], {"kind": kind, "covered": [], "strict": 0, "status": None}
        if wrong and keep:
            words = [f"{n}: {w}" for n, w in wrong] + ["", f"numbers {case.numbers}", f"shape um {case.shape} about {case.middle} +- {case.half}"]
            folders.keep(folder, os.path.join(keep, f"{kind}-{seed}-{number}"), "\n".join(words))
        return number, wrong, figures


def campaign(vpost, kinds, count, seed, jobs, keep, quiet=False):
    """Runs all; prints a table; returns the number of findings."""
    say = (lambda *a, **k: None) if quiet else print
    found = 0
    say(f"{'kind':12s} {'cases':>5s} {'done':>5s} {'held out, um form':>18s} {'worse by >0.05':>14s}  intervals (95 %)", flush=True)
    answered = cases.in_order(one, [(kind, seed, n, vpost, keep) for kind in kinds for n in range(count)], jobs)
    for kind in kinds:
        answers = [next(answered) for _ in range(count)]
        problems, covered, named, forms, refused = [], collections.defaultdict(list), collections.Counter(), [], collections.Counter()
        tests, full = [], []
        for number, wrong, figures in answers:
            problems += [(number, *w) for w in wrong]
            for name, good in figures["covered"]:
                covered[name].append(good)
            named.update(figures.get("named", []))
            forms += figures.get("forms", [])
            tests += figures.get("tests", [])
            full += figures.get("full", [])
            if figures["status"]:
                refused[figures.get("refused", "crash")] += 1
        done = sum(f["status"] == 0 for _, _, f in answers)
        rms = lambda k: math.sqrt(np.mean([f[k] ** 2 for f in forms])) if forms else math.nan  # noqa: E731
        rates = []
        for name, hits in sorted(covered.items()):
            k, n = sum(hits), len(hits)
            p = tail(k, n, 0.95)
            mark = ""
            if n >= 20 and p < RARE:
                found += 1
                mark = f" !! p={p:.0e}"
            rates.append(f"{name.split('.')[-1] if 'offset' not in name else name} {k}/{n}{mark}")
        strict = sum(f["strict"] for _, _, f in answers)
        say(f"{kind:12s} {count:5d} {done:5d} {rms(0):8.2f} -> {rms(1):5.2f} {strict:8d}/{len(forms):<5d}  {'; '.join(rates)}")
        if full:
            say(f"{'':12s} with the size entered {math.sqrt(np.mean([a * a for a, _ in full])):.2f} -> {math.sqrt(np.mean([b * b for _, b in full])):.2f} um RMS of the diameter")
        if refused:
            say(f"{'':12s} refused: {dict(refused)}")
        if tests:
            k, p = sum(tests), upper(sum(tests), len(tests), 0.01)
            say(f"{'':12s} named on perfect lathes: {k} of {len(tests)} tests at 1 %{' !! p=%.0e' % p if p < RARE else ''}")
            found += p < RARE
        for name, k in named.items():
            p = upper(k, done, 0.01)
            say(f"{'':12s} {name} named without a cause: {k} of {done}{' !! p=%.0e' % p if p < RARE else ''}")
            found += p < RARE
        # hold-outs that get worse: the level of the tests allows a few of those that got nearly nothing
        chance = [q for q in problems if q[1] == "worse"]
        if chance and upper(len({q[0] for q in chance}), max(done, 1), 0.01) >= RARE:
            say(f"{'':12s} held-out parts worse by more than the noise in {len({q[0] for q in chance})} cases: what the level of the tests allows")
            problems = [q for q in problems if q[1] != "worse"]
        # refusals of parts that differ and of blunders have a level of their own, 0.1 % a test
        for name in ("refused-VP1113", "refused-VP1107"):
            chance = [q for q in problems if q[1] == name]
            if chance and upper(len(chance), count, 0.003) >= RARE:
                say(f"{'':12s} {name} {len(chance)} of {count}, by chance: #{chance[0][0]} {chance[0][2][:140]}")
                problems = [q for q in problems if q[1] != name]
        for name, k in collections.Counter(q[1] for q in problems).items():
            examples = [q for q in problems if q[1] == name][:3]
            say(f"{'':12s} !! {name}: {k}; " + " | ".join(f"#{n} {w[:220]}" for n, _, w in examples))
        found += len(problems)
    return found


def main():
    words = options.parser(__doc__, 100, "jobs", "refusals", vpost="")
    words.set_defaults(jobs=2)
    words.add_argument("--kind", action="append", choices=list(generate.KINDS))
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.main()
    vpost = options.command(words, given.vpost)
    import refusals
    found = 0
    if not given.refusals:
        found += campaign(vpost, given.kind or list(generate.KINDS), given.count, given.seed, given.jobs, given.keep)
    if given.refusals or not given.kind:
        found += refusals.main(vpost, given.keep)
    print(f"{found} found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
