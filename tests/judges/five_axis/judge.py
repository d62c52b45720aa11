#!/usr/bin/python3
"""Judges five-axis correction: random crooked machines and programs, vpost as a black box.

    /usr/bin/python3 tests/judges/five_axis/judge.py --vpost target/release/vpost --count 220
    /usr/bin/python3 tests/judges/five_axis/judge.py --self-test

For each pair of generate.py (chain and kind in turn) the program is corrected, both programs are read by reader.py (those of
LinuxCNC also by its own interpreter, which has to agree), and compared in the workpiece (compare.py): the tip and the tool's
direction that an ideal machine with this control would make of the original, against what the crooked one (machine.py) makes
of the output. Asked:

* path      tip within `tolerance_um` and half an output step of every axis at its arm, both ways, forwards only
* tilt      with --orientation full: direction within `orientation_urad` away from singularities, and near them no worse by more
            than that than uncorrected (else the largest is only printed)
* winding   rotary commands those of the original everywhere: no other branch, no turn more or less; within travel
* feed      F as programmed; under G93 the pieces of a block share its time, within 2 %
* process   S, T, M and codes of tool length and kinematics in the same order at the same places
* order     rapids and stretches of feeds as in the original
* reading   rs274 reads of the output what this judge reads
* check     `vpost check` says the same; and the damages of damages.py are found by it (--damage N of the corrected programs)
* summary   `deviation_after_um` not below what is found

A refusal (status 1) is counted by its code. Exit status: 0 nothing wrong, 1 something, 2 usage.
"""

import collections
import json
import os
import re
import shutil
import sys
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, folders, options  # noqa: E402  before numpy
from common.command import code, first_error, run  # noqa: E402

import numpy as np  # noqa: E402

import compare  # noqa: E402
import damages  # noqa: E402
import directed  # noqa: E402
import generate  # noqa: E402
import reader  # noqa: E402

SAMPLING_UM = 0.04
SLACK_UM = 0.02 + SAMPLING_UM
# Directions are compared at the feet of tips: by as much as a way between two places turns them.
TILT_SLACK_URAD = 0.5


class Has:
    """Keys of profiles that the command knows, and its options."""

    def __init__(self, vpost):
        self.names = set(re.findall(r'"(\w+)"\s*:\s*\{', run(vpost, "profile", "schema").output))
        self.help = run(vpost, "correct", "--help").output

    def __call__(self, key):
        return key in self.names

    def option(self, name):
        return name in self.help


def correct(vpost, spec, text, folder, has, orientation):
    """Runs the command on one program; status, stderr, output, summary and the options it took."""
    profile = generate.write_profile(spec, folder, has, orientation)
    source, target = folders.put(folder, "in.nc", text), os.path.join(folder, "out.nc")
    folders.put(folder, "spec.json", json.dumps(spec))
    flags = ["-m", profile, "--zero", "true"] + (["--orientation", orientation] if orientation and has.option("--orientation") else [])
    words = [source, *flags, "-o", target, "--summary", os.path.join(folder, "summary.json")]
    folders.put(folder, "command.txt", " ".join([vpost, *(w.replace(folder + "/", "") for w in words)]) + "\n")
    status, _, errors = run(vpost, *words, seconds=600)
    result = {"status": status, "stderr": errors, "options": flags, "source": source, "target": target}
    if status == 0:
        with open(target, encoding="ascii") as file:
            result["out"] = file.read()
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            result["summary"] = json.load(file)
    return result


def check(vpost, one, two, flags):
    """`vpost check --json` as a dictionary; `passed` None where it gave none."""
    status, said, errors = run(vpost, "check", one, two, *flags, "--json", seconds=600)
    try:
        return json.loads(said)
    except ValueError:
        return {"passed": False if status == 1 else None, "refused": errors[:300], "findings": []}


def same_reading(text, spec, motions):
    """Where rs274 reads another sequence of ends than reader.py; None where none."""
    theirs = reader.rs274(text, spec["lengths"])
    names = "ABC"
    rotary = [x for x in spec["chain"].split() if x.strip("[]") in names]
    ours = []
    for m in motions:
        end = m.end - spec["offset"]
        if not m.tcp:
            end = end - [0, 0, -m.tool[2] if spec["lengths"] and m.tool[2] else 0.0]
        rot = dict(zip(rotary, m.rot1))
        ours.append((m.kind, m.arc is not None, end, [rot.get(n, 0.0) for n in names], m))
    # Blocks that move nothing are told by one and not by the other.
    def moving(rows, end, arc):
        out, last = [], (0.0,) * 6
        for row in rows:
            key = tuple(np.round(end(row), 4) + 0.0)
            if key != last or arc(row):
                out.append(row)
            last = key
        return out

    def their_end(t):
        if t[0] != "ARC_FEED":
            return np.array(t[1:7])
        return np.array([t[1], t[2], t[6], *t[7:10]])

    def our_end(o):
        if not o[1]:
            return np.concatenate([o[2], o[3]])
        u, v, w = o[4].arc["axes"]
        return np.concatenate([[o[2][u], o[2][v], o[2][w]], o[3]])

    theirs = moving(theirs, their_end, lambda t: t[0] == "ARC_FEED")
    ours = moving(ours, our_end, lambda o: o[1])
    if len(theirs) != len(ours):
        return f"{len(theirs)} motions for {len(ours)}"
    for n, (t, o) in enumerate(zip(theirs, ours)):
        # The first three may start from different zeros.
        if n > 2 and np.abs(their_end(t) - our_end(o)).max() > 1.01e-4:
            return f"line {o[4].line}: {t} for {our_end(o)}"
    return None


def assess(spec, text, out, summary, orientation=None):
    """Problems [(name, message)] of an output, and the figures of the comparison."""
    problems, found = [], {}
    wanted, before = reader.read(text, spec)
    taken, after = reader.read(out, spec)
    if [e for _, e in before] != [e for _, e in after]:
        problems.append(("process", f"{[e for _, e in before][:9]} became {[e for _, e in after][:9]}"))
    rapids = lambda ms, events: [(sum(m.kind == "rapid" for m in ms[:n]) if not any(m.plane for m in ms) else 0, e) for n, e in events]  # noqa: E731
    if not problems and rapids(wanted, before) != rapids(taken, after):
        problems.append(("process", "a code changed its place among the rapids"))
    names = [x.strip("[]") for x in spec["chain"].split() if x.strip("[]") in ("A", "B", "C")]
    for m in taken:
        for k, name in enumerate(names):
            low, high = spec["rotary"][name]["travel"]
            if not low - 1e-6 <= m.rot1[k] <= high + 1e-6:
                problems.append(("winding", f"line {m.line} of the output: {name}{m.rot1[k]} beyond travel"))
    try:
        found = compare.compare(spec, wanted, taken, orientation == "full")
    except compare.Structure as error:
        return problems + [("order", str(error))], found
    if found["um"] > found["limit_um"] + SLACK_UM:
        problems.append(("path", f"{found['um']:.3f} um at line {found['line']}, allowed {found['limit_um']:.3f}; {found['before_um']:.1f} before"))
    if found["turned"] > (compare.ASIDE if orientation == "full" else compare.TURNED):
        problems.append(("winding", f"{found['turned']:.3f} degrees apart at line {found['turned_line']}"))
    if orientation == "full":
        allowed = spec.get("orientation_urad", 20.0) + TILT_SLACK_URAD
        if found["far_tilt_urad"] > allowed:
            problems.append(("tilt", f"{found['far_tilt_urad']:.1f} urad at line {found['far_line']}, allowed {allowed:.1f}"))
        if found["worse_tilt_urad"] > allowed:
            problems.append(("tilt", f"{found['worse_tilt_urad']:.1f} urad more than uncorrected near a singularity"))
    for line, message in compare.times(wanted, taken, found)[:1]:
        problems.append(("feed", f"line {line}: {message}"))
    if summary and found["um"] > summary["deviation_after_um"] + SLACK_UM and found["um"] > 0.2:
        problems.append(("summary", f"says {summary['deviation_after_um']}, found {found['um']:.3f} um at line {found['line']}"))
    return problems, found


def one(arguments):
    vpost, seed, number, folder, orientation, damage, chains, kinds = arguments
    has = Has(vpost)
    chain, kind, spec, text = generate.pair(seed, number, has, chains, kinds)
    if orientation == "full":
        # No direction is proven on a machine with play of linear axes, nor corrected from both sides of a rotary one.
        for one_axis in (*spec["axes"].values(), *spec["rotary"].values()):
            for key in ("backlash_um", "backlash_urad", "table_negative"):
                one_axis.pop(key, None)
    os.makedirs(folder, exist_ok=True)
    verdict = {"chain": chain, "kind": kind, "number": number, "control": spec["control"], "problems": []}
    if chain == "nutating" and not has("direction"):
        verdict["refused"] = "no direction in profiles"
        shutil.rmtree(folder)
        return verdict
    begun = time.time()
    try:
        wanted, _ = reader.read(text, spec)
        if spec["control"] == "linuxcnc":
            differs = same_reading(text, spec, wanted)
            if differs:
                verdict["problems"].append(("reading", "of the input: " + differs))
    except reader.Unreadable as error:
        verdict["problems"].append(("judge", f"its own program is unreadable: {error}"))
        return verdict
    result = correct(vpost, spec, text, folder, has, orientation)
    verdict["seconds"] = time.time() - begun
    if result["status"] == 1:
        verdict["refused"], verdict["message"] = code(result["stderr"], "?"), first_error(result["stderr"])
    elif result["status"]:
        verdict["problems"].append(("status", f"{result['status']}: {result['stderr'][:300]}"))
    else:
        try:
            problems, found = assess(spec, text, result["out"], result["summary"], orientation)
            verdict["problems"] += problems
            verdict["found"] = {k: v for k, v in found.items() if k != "share"}
            verdict["changed"] = result["summary"]["changed"]
            warned = [x["code"] for x in result["summary"]["warnings"]]
            verdict["warned"] = warned
            if spec["control"] == "linuxcnc":
                differs = same_reading(result["out"], spec, reader.read(result["out"], spec)[0])
                if differs:
                    verdict["problems"].append(("reading", differs))
        except reader.Unreadable as error:
            verdict["problems"].append(("judge", f"the output is unreadable: {error}"))
            return verdict
        verdict["check"] = check(vpost, result["source"], result["target"], result["options"])
        bad = any(p[0] in ("path", "winding", "order", "feed") for p in verdict["problems"])
        if verdict["check"].get("passed") is not True and not bad:
            verdict["problems"].append(("check-alarm", str(verdict["check"].get("findings") or verdict["check"].get("refused"))[:300]))
        elif verdict["check"].get("passed") and bad:
            verdict["problems"].append(("check-blind", "check passes it"))
        if damage:
            verdict["damages"] = damages.judge(vpost, spec, result, folder, check, f"{seed}/{number}", orientation)
            for name, state in verdict["damages"].items():
                if state == "missed":
                    verdict["problems"].append(("damage", f"{name} is not found by check"))
    if not verdict["problems"]:
        shutil.rmtree(folder)
    return verdict


def main():
    words = options.parser(__doc__, 220, "first", "jobs", "json", vpost="vpost", seed="1")
    words.add_argument("--chain", choices=list(generate.CHAINS), action="append")
    words.add_argument("--kind", choices=generate.KINDS + generate.PLANE_KINDS + generate.VECTOR_KINDS, action="append")
    words.add_argument("--orientation", choices=["xyz", "full"])
    words.add_argument("--damage", type=int, default=3, metavar="N", help="damage every Nth pair; 0 for none")
    words.add_argument("--directed", action="store_true", help="bad input and perfect machines as well")
    given = words.parse_args()
    if given.self_test:
        import self_test

        return self_test.run(given.vpost)
    vpost, keep = options.command(words, given.vpost)[0], folders.of_findings(given.keep, "five-axis-")
    chains, kinds = tuple(given.chain or generate.CHAINS), tuple(given.kind or generate.KINDS)
    work = [(vpost, given.seed, n, os.path.join(keep, f"{given.seed}-{n}"), given.orientation, bool(given.damage) and n % given.damage == 0, chains, kinds)
            for n in cases.asked(given)]
    begun = time.time()
    verdicts = cases.shown(cases.in_order(one, work, given.jobs), lambda v: (f"{v['chain']} {v['kind']} {v['number']}", v["problems"]))
    if given.json:
        folders.put(".", given.json, json.dumps(verdicts, indent=1, default=str))
    status = report(verdicts, keep, time.time() - begun)
    if given.directed:
        answers = directed.run(vpost, keep, Has(vpost), correct)
        for (name, wrong, said), n in collections.Counter(answers).items():
            print(f"directed {'WRONG' if wrong else 'ok   '} {n:3} {name}: {wrong or ''} {said[:110]}")
            status |= bool(wrong)
    return status


def report(verdicts, keep, seconds):
    print(f"\n{len(verdicts)} pairs, {seconds:.0f} s; reproducers in {keep}")
    print(f"{'chain':15} {'kind':13} pairs refused judged wrong | before um: median largest | of what is allowed: median largest | tilt urad")
    groups = collections.OrderedDict()
    for v in verdicts:
        groups.setdefault((v["chain"], v["kind"]), []).append(v)
    for (chain, kind), vs in groups.items():
        good = [v["found"] for v in vs if v.get("found")]
        wrong = sum(any(p[0] not in ("check-alarm", "damage") for p in v["problems"]) for v in vs)
        text = f"{chain:15} {kind:13} {len(vs):5} {sum('refused' in v for v in vs):7} {len(good):6} {wrong:5} |"
        if good:
            before, ratio = [g["before_um"] for g in good], [g["ratio"] for g in good]
            text += f" {np.median(before):10.1f} {max(before):10.1f}    | {np.median(ratio):14.3f} {max(ratio):14.3f}      | {max(g['tilt_urad'] for g in good):8.1f}"
        print(text)
    for title, key in (("refused", "refused"),):
        counted = collections.Counter((v[key], v["kind"]) for v in verdicts if key in v)
        for (code, kind), n in sorted(counted.items()):
            message = next(v.get("message", "") for v in verdicts if v.get(key) == code and v["kind"] == kind)
            print(f"{title} {code:10} {kind:13} {n:4}  {message[:110]}")
    print("problems:", dict(collections.Counter(p[0] for v in verdicts for p in v["problems"])) or "none")
    found = collections.Counter((name, state) for v in verdicts for name, state in v.get("damages", {}).items())
    for (name, state), n in sorted(found.items()):
        print(f"damage {name:22} {state:8} {n}")
    print(f"sampling error of both curves together: at most {SAMPLING_UM} um")
    return 1 if any(v["problems"] for v in verdicts) else 0


if __name__ == "__main__":
    sys.exit(main())
