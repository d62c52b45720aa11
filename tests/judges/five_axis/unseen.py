#!/usr/bin/python3
"""Real five-axis programs through the judge. None of them is kept here; the script takes a folder.

    /usr/bin/python3 tests/judges/five_axis/unseen.py FOLDER --vpost target/release/vpost

FOLDER/linuxcnc: impeller-7bl-xyzac.ngc, boat-xyzac.ngc, boat-xyzbc.ngc, from LinuxCNC/linuxcnc (GPL),
configs/sim/axis/vismach/5axis/table-rotary-tilting/demos, or a package's .../sample-configs/sim/axis/vismach/5axis/….
FOLDER/easy_gcode_plot: the files of MaestroFusion360/easy_gcode_plot (MIT), tests/fixtures/milling/fanuc and …/sinumerik:
impeller.ptp and impeller.mpf, test_5ax_ac_…, test_5ax_bc_…, smpl_sim08_5ax_…, in folders `fanuc` and `sinumerik`.

Each is corrected for three crooked machines of its chain, with declared kinematics where the command knows them. Twins (one part
for two controls) have to give one corrected tip path: the largest distance between the two is printed. Exit status 1 when
something is wrong; refusals are counted.
"""

import argparse
import os
import random
import re
import shutil
import sys
import tempfile

import numpy as np

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import compare  # noqa: E402
import generate  # noqa: E402
import judge  # noqa: E402
import reader  # noqa: E402

FILES = [
    ("linuxcnc/impeller-7bl-xyzac.ngc", "linuxcnc", "table-table-ac"),
    ("linuxcnc/boat-xyzac.ngc", "linuxcnc", "table-table-ac"),
    ("linuxcnc/boat-xyzbc.ngc", "linuxcnc", "table-table-bc"),
    ("easy_gcode_plot/fanuc/impeller.ptp", "fanuc", "table-table-bc"),
    ("easy_gcode_plot/sinumerik/impeller.mpf", "sinumerik", "table-table-bc"),
    ("easy_gcode_plot/fanuc/test_5ax_ac_fanuc.nc", "fanuc", "table-table-ac"),
    ("easy_gcode_plot/sinumerik/test_5ax_ac_sin840d.mpf", "sinumerik", "table-table-ac"),
    ("easy_gcode_plot/fanuc/test_5ax_bc_fanuc.nc", "fanuc", "table-table-bc"),
    ("easy_gcode_plot/sinumerik/test_5ax_bc_sin840d.mpf", "sinumerik", "table-table-bc"),
    ("easy_gcode_plot/fanuc/smpl_sim08_5ax_fanuc_mm.nc", "fanuc", "table-table-ac"),
    ("easy_gcode_plot/sinumerik/smpl_sim08_5ax_sinumerik_mm.mpf", "sinumerik", "table-table-ac"),
    ("easy_gcode_plot/sinumerik/sinumerik_traori_ac.mpf", "sinumerik", "table-table-ac"),
]
# Not the impellers: one is a splitter's pass on one machine, the other a blade's on another.
TWINS = [(5, 6), (7, 8), (9, 10)]


def crooked(number, chain, control, has):
    """A machine as generate.py makes them, with room for any of the programs."""
    spec = generate.machine(random.Random(f"unseen/{number}/{chain}"), chain, control, has)
    for one in spec["axes"].values():
        one.pop("backlash_um", None)
    for name, one in spec["rotary"].items():
        one["travel"] = [-1080, 1080] if name == "C" else [-120, 120]
        if one.get("table"):
            nodes, rows = one["table"]
            low, high = one["travel"]
            one["table"] = ([low + (high - low) * k / (len(nodes) - 1) for k in range(len(nodes))], rows)
    spec["lengths"] = {} if control != "fanuc" else {"H1": 100.0, "H2": 100.0, "H60": 100.0}
    spec["tool"] = [0, 0, -100.0] if control == "sinumerik" else [0, 0, 0]
    spec["lengths"] = {"H1": 100.0} if control == "linuxcnc" else spec["lengths"]
    spec["tolerance_um"] = 1.0
    return spec


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder")
    parser.add_argument("--vpost", default="vpost")
    parser.add_argument("--machines", type=int, default=3)
    parser.add_argument("--keep", metavar="DIR")
    arguments = parser.parse_args()
    vpost = shutil.which(arguments.vpost) or parser.error(f"no command {arguments.vpost}")
    has, keep = judge.Has(vpost), arguments.keep or tempfile.mkdtemp(prefix="unseen-")
    wrong, paths = 0, {}
    for n, (name, control, chain) in enumerate(FILES):
        path = os.path.join(arguments.folder, name)
        if not os.path.exists(path):
            print(f"{name}: not there")
            continue
        with open(path, encoding="latin-1") as file:
            text = file.read()
        for number in range(arguments.machines):
            spec = crooked(number, chain, control, has)
            # LinuxCNC's demos run on machines whose kinematics are those of the tip from the start.
            spec["tcp_at_start"] = control == "linuxcnc"
            folder = os.path.join(keep, f"{n}-{number}")
            os.makedirs(folder, exist_ok=True)
            result = judge.correct(vpost, spec, re.sub(r"[^\x00-\x7f]", "?", text), folder, has, None)
            if result["status"]:
                code = re.search(r"VP\d{4}", result["stderr"])
                first = next((x for x in result["stderr"].splitlines() if x.startswith("error")), "")
                where = next((x for x in result["stderr"].splitlines() if "-->" in x), "").split(":", 1)[-1]
                if number == 0:
                    print(f"{name}: refused {code.group(0) if code else result['status']} line {where}: {first[:120]}")
                continue
            try:
                problems, found = judge.assess(spec, text, result["out"], result["summary"])
                passed = judge.check(vpost, result["source"], result["target"], result["options"]).get("passed")
                if passed is not True:
                    problems.append(("check", "its own check does not pass"))
                wrong += bool(problems)
                print(f"{name}, machine {number}: {found.get('before_um', 0):.1f} um before, {found.get('um', 0):.3f} after, allowed {found.get('limit_um', 0):.3f}; "
                      f"tilt {found.get('tilt_urad', 0):.0f} urad; blocks {len(text.splitlines())} to {len(result['out'].splitlines())}; {problems or 'right'}")
                paths[n, number] = (spec, result["out"])
            except reader.Unreadable as error:
                print(f"{name}, machine {number}: corrected; not judged, this reader does not know {error}")
    for a, b in TWINS:
        for number in range(arguments.machines):
            if (a, number) in paths and (b, number) in paths:
                far = twins(paths[a, number], paths[b, number])
                wrong += far > 0.01
                print(f"twins {FILES[a][0]} and {FILES[b][0]}, machine {number}: {far * 1e3:.2f} um apart")
    return 1 if wrong else 0


def twins(one, two):
    """Largest distance between the real tips of two outputs on the same crooked machine, mm; positioning left out."""
    tips = []
    for spec, out in (one, two):
        parts = [c.tip for kind, _, c in compare.curves(spec, reader.read(out, spec)[0], False) if kind == "feed"]
        tips.append(np.concatenate(parts))
    worst = 0.0
    for a, b in (tips, tips[::-1]):
        for k in range(0, len(a), 500):
            worst = max(worst, float(np.sqrt(((a[k : k + 500, None, :] - b[None, :: max(1, len(b) // 4000), :]) ** 2).sum(axis=2)).min(axis=1).max()))
    return worst


if __name__ == "__main__":
    sys.exit(main())
