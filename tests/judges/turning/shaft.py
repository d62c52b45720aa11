#!/usr/bin/python3
"""One shaft with all effects together: its diameter along Z before and after correction, by `check` and by this judge.

    /usr/bin/python3 tests/judges/turning/shaft.py --vpost target/release/vpost [--profile machine-profiles/generic_lathe.toml]

Diameter 40, 300 mm out of the chuck, turned from the tailstock to 20 mm before the chuck by one block. The lathe is that of the
profile, read here: tables, squareness, spindle with its error motion, headstock, tailstock, bending, height and radius of the
tip. The finished surface is the envelope of the nose at 720 angles x 0.05 mm. Exit status 1 where `check` refuses, or where
the radius of the corrected shaft is further off than tolerance and half an output step.
"""

import argparse
import csv
import os
import sys
import tempfile
import tomllib

import numpy as np

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import judge  # noqa: E402
import reader  # noqa: E402
import workpiece  # noqa: E402

RADIUS, END = 20.0, -280.0
SHAFT = f"%\nO4000\nG21 G18 G40 G99 G54\nG50 S2500\nT0101\nG96 S180 M3\nG0 X60. Z5.\nX{2 * RADIUS}\nG1 Z{END} F0.2\nX60.\nG0 Z5.\nM5\nM30\n%\n"
KINDS = {f"{kind}{of}": unit for of in "XYZ" for kind, unit in (("EX", "um"), ("EY", "um"), ("EZ", "um"), ("EA", "urad"), ("EB", "urad"), ("EC", "urad"))}
GRID, ANGLES = 0.05, 720


def spec_of(path):
    """A profile as the dictionary of this judge."""
    with open(path, "rb") as file:
        profile = tomllib.load(file)
    axes = {}
    for axis, own in profile["axis"].items():
        axes[axis] = {"travel_mm": own["travel_mm"], "resolution_mm": own["resolution_mm"]}
        if "errors" in own:
            with open(os.path.join(os.path.dirname(path), own["errors"]), encoding="utf-8") as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
            axes[axis]["table"] = {name: [float(row[name]) for row in rows] for name in rows[0]}
            unknown = [n for n in rows[0] if n != "position_mm" and n.rsplit("_", 1)[-1] != KINDS.get(n.rsplit("_", 1)[0])]
            if unknown:
                raise SystemExit(f"columns {unknown}: no place for them here")
    known = {"squareness", "spindle", "headstock", "tailstock", "workpiece", "tool", "work_offsets_mm"}
    unknown = set(profile) - known - {"format", "name", "control", "chain", "program", "axis", "correction"}
    if unknown:
        raise SystemExit(f"{sorted(unknown)}: no place for them here")
    own = {key: profile[key] for key in known if key in profile}
    return {**own, "name": profile["name"], "control": profile["control"], "axes": axes, "x": profile["program"]["x"], "decimal": "millimetres",
            "g_code_system": profile["program"]["g_code_system"], "tolerance_um": profile["correction"]["tolerance_um"]}


def radius_along(spec, text, z):
    """Mean radius over the angles at machine places z."""
    motions, _ = reader.read(text, spec)
    return judge.surface(spec, workpiece.Lathe(spec), motions, z, ANGLES, False)[False]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--vpost", default="vpost")
    parser.add_argument("--profile", default="machine-profiles/generic_lathe.toml")
    arguments = parser.parse_args()
    spec = spec_of(arguments.profile)
    with tempfile.TemporaryDirectory() as folder:
        judge.put(folder, "in.nc", SHAFT)
        names = [os.path.join(folder, name) for name in ("in.nc", "out.nc")]
        status, _, errors = judge.run(arguments.vpost, names[0], "-m", arguments.profile, "-o", names[1])
        if status:
            print(errors)
            return 1
        checked = judge.run(arguments.vpost, "check", *names, "-m", arguments.profile)
        with open(names[1], encoding="ascii") as file:
            out = file.read()
    print(checked.output.strip() or checked.errors.strip())
    zero, face = spec["work_offsets_mm"]["G54"][2], spec["spindle"]["face_mm"]
    z = np.arange(zero + END + 1.0, zero - 0.5, GRID)
    before, after = (1e3 * (radius_along(spec, text, z) - RADIUS) for text in (SHAFT, out))
    print("Z from the chuck | diameter before, um off | after")
    for place in range(25, 300, 25):
        k = int(np.argmin(np.abs(z - face - place)))
        print(f"{z[k] - face:16.0f} | {2 * before[k]:+23.2f} | {2 * after[k]:+5.2f}")
    limit = 1e3 * judge.limit_mm(spec)
    worst = [float(np.nanmax(np.abs(v))) for v in (before, after)]
    blocks = sum(line.startswith(("G1", "X", "Z")) for line in out.splitlines())
    print(f"largest on the radius over {len(z)} places x {ANGLES} angles: {worst[0]:.2f} -> {worst[1]:.2f} um, limit {limit:.2f} um; {blocks} blocks")
    return 1 if checked.status or not worst[1] <= limit else 0


if __name__ == "__main__":
    sys.exit(main())
