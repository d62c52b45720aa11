#!/usr/bin/python3
"""Real turning programs from a folder (not part of the repository): each corrected within tolerance or refused by line.

    /usr/bin/python3 tests/judges/turning/unseen.py FOLDER --vpost target/release/vpost [--mill] [--keep DIR] [--say KEY=VALUE]

Programs: *.nc *.NC *.ngc, below any folder. *.ngc are LinuxCNC's, the rest Fanuc's. Each is tried on a bent lathe as
`--systems` says (A, B, C; LinuxCNC: diameters and radii); `--mill` asks the mill's dialects, which must refuse it. Counted:
within, refused (by number; `no line` where the message names none), WRONG (exit 0 and outside), unjudged (the reader does
not know it), identical on a perfect lathe. Exit status 1 where one is WRONG, crashes, or is changed on the perfect lathe.
"""

import argparse
import collections
import copy
import os
import re
import sys
import tempfile
import tomllib

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import generate  # noqa: E402
import judge  # noqa: E402

SINE = [round(5 * v, 3) for v in (0, 0.5, 0.87, 1, 0.87, 0.5, 0, -0.5, -0.87, -1, -0.87, -0.5, 0)]


def lathe(linuxcnc, x, system, perfect=False, say=()):
    spec = {
        "name": "unseen", "control": "linuxcnc-lathe" if linuxcnc else "fanuc-lathe", "chain": "[w S b Z X t]", "x": x, "decimal": "millimetres",
        "axes": {"X": {"travel_mm": [-500, 900], "resolution_mm": 0.001}, "Z": {"travel_mm": [-900, 900], "resolution_mm": 0.001}},
        "tool": {"lengths_mm": {f"H{k}": [0, 0, 0] for k in range(1, 33)}, "noses": {f"H{k}": {"radius_mm": 0.4, "direction": 3} for k in range(1, 33)}},
        "work_offsets_mm": {f"G{k}": [0, 0, 400] for k in range(54, 60)}, "spindle": {"centre_mm": [0, 0], "face_mm": 0.0}, "tolerance_um": 1.0,
    }
    if not linuxcnc:
        spec["g_code_system"] = system
        spec["parameters"] = {"thread_chamfer_leads": 1.0, "thread_chamfer_deg": 45.0, "roughing_escape_mm": 0.5, "groove_return_mm": 0.2, "thread_finishing_passes": 1, "thread_least_mm": 0.05, "thread_allowance_mm": 0, "thread_flank_from": "start", "drill_pecks": "full", "drill_return_mm": 0.5, "contour_compensation": "finishing"}
        spec["parameters"].update(tomllib.loads("\n".join(say)))
    if not perfect:
        at = [-900 + 150 * k for k in range(13)]
        spec["axes"]["Z"]["table"] = {"position_mm": at, "EZZ_um": SINE, "EXZ_um": SINE[::-1], "EBZ_urad": [4 * v for v in SINE]}
        spec["axes"]["X"]["table"] = {"position_mm": [-500 + 1400 * k / 12 for k in range(13)], "EXX_um": SINE, "EZX_um": SINE[::-1]}
        spec["squareness"] = {"EB0Z_urad": -80.0}
        spec["spindle"]["EB0S_urad"] = 25.0
    return spec


def programs(folder):
    for where, _, names in sorted(os.walk(folder)):
        for name in sorted(names):
            if re.search(r"\.(nc|ngc)$", name, re.I):
                yield os.path.join(where, name)


def one(vpost, path, spec, folder, mill):
    """What became of a program: (word, message)."""
    with open(path, "rb") as file:
        data = file.read()
    with open(os.path.join(folder, "in.nc"), "wb") as out:
        out.write(data)
    text = data.decode("latin-1")
    verdict = {"kind": "unseen", "problems": [], "figures": {}}
    if mill:
        judge.judge_mill(vpost, spec, text, folder, 0, verdict, 0)
        if verdict["problems"]:
            name, message = verdict["problems"][0]
            return ("WRONG" if name == "passed-as-mill" else name), message
        return "refused " + verdict["refused"], ""
    generate.write(spec, folder)
    done = judge.correct(vpost, spec, folder)
    if done.status == 2:
        return "profile", " ".join(done.errors.split())[:120]
    if done.status == 1:
        code = (judge.lathe_codes(done.errors) or ["?"])[0]
        return f"refused {code}" + ("" if re.search(r"in\.nc:\d+", done.errors) else " no line"), done.errors.split("\n")[0][:160]
    if done.status:
        return "crash", f"exit {done.status}"
    with open(os.path.join(folder, "out.nc"), "rb") as file:
        out = file.read()
    if spec.get("perfect"):
        return ("identical", "") if out == data else ("CHANGED", "on the perfect lathe")
    problems, figures = judge.assess(spec, text, out.decode("latin-1"))
    if any(n == "unreadable" and m.startswith("input") for n, m in problems):
        return "unjudged", problems[0][1]
    if problems:
        return "WRONG", f"{problems[0][0]}: {problems[0][1]}"
    return "within", " ".join(f"{k} {v:.3f}" for k, v in figures.items() if not isinstance(v, bool))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder")
    parser.add_argument("--vpost", default="vpost")
    parser.add_argument("--systems", default="A", help="G-code systems to try Fanuc's programs in: A, or AB, …")
    parser.add_argument("--mill", action="store_true")
    parser.add_argument("--say", action="append", default=[], metavar="KEY=VALUE", help="a further key under [program], as a message asks for it: drill_r=\"place\"")
    parser.add_argument("--keep", metavar="DIR")
    arguments = parser.parse_args()
    keep = arguments.keep or tempfile.mkdtemp(prefix="unseen-")
    words = collections.Counter()
    for number, path in enumerate(programs(arguments.folder)):
        linuxcnc = path.lower().endswith(".ngc")
        ways = [(x, "A") for x in ("diameter", "radius")] if linuxcnc and not arguments.mill else [("diameter", s) for s in (arguments.systems if not linuxcnc else "A")]
        for k, (x, system) in enumerate(ways):
            folder = os.path.join(keep, f"{number}-{k}")
            os.makedirs(folder, exist_ok=True)
            spec = lathe(linuxcnc, x, system, say=arguments.say)
            word, message = one(arguments.vpost, path, spec, folder, arguments.mill)
            words[word] += 1
            print(f"{os.path.relpath(path, arguments.folder)} [{x if linuxcnc else system}] {word} {message}", flush=True)
            if word == "within" and k == 0:
                other = copy.deepcopy(lathe(linuxcnc, x, system, True, arguments.say))
                other["perfect"] = True
                again, _ = one(arguments.vpost, path, other, folder, False)
                words["perfect " + again] += 1
    for word, count in sorted(words.items()):
        print(f"{word}: {count}")
    return 1 if any(w in ("WRONG", "crash", "status", "perfect CHANGED") for w in words) else 0


if __name__ == "__main__":
    sys.exit(main())
