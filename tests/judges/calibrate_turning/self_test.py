"""The judge finds nothing in an estimator that is right and finds each slip of one that is not."""

import os
import sys

import judge
import lathe

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SLIPS = ("sign", "diameter", "span", "frame", "narrow", "entry", "nan")


def exact():
    """Figures of issue "Lathes" on this simulator, um: name -> (got, expected, allowed)."""
    bar = {"radial_force_n": 400, "diameter_mm": 40.0, "length_mm": 300.0, "e_gpa": 210.0}
    tail = {"at_mm": 300.0, "offset_um": [0.0, 0.0]}
    at = lambda numbers, z: 1e3 * float(lathe.Lathe(numbers).turned(20.0, np.array([z]))[0][0] - 20)  # noqa: E731
    yield "tailstock cone on the diameter", 2 * at({"tailstock": {"at_mm": 300.0, "offset_um": [25.0, 0.0]}}, 300.0), 49.99986, 5e-5
    yield "chuck, free end", at({"workpiece": bar | {"clamping": "chuck"}}, 300.0), 136.42, 5e-3
    yield "centres, middle", at({"workpiece": bar | {"clamping": "centres"}, "tailstock": tail}, 150.0), 8.526, 5e-4
    yield "chuck and tailstock, middle", at({"workpiece": bar | {"clamping": "chuck-tailstock"}, "tailstock": tail}, 150.0), 3.730, 5e-4
    yield "EB0S = EB0Z gives no taper", at({"EB0S_urad": 80.0, "EB0Z_urad": 80.0}, 300.0), 0.0, 1e-3
    yield "EB0S 80 at 300", at({"EB0S_urad": 80.0}, 300.0), -24.0, 1e-3
    _, along = lathe.Lathe({"EB0S_urad": 80.0}).turned(np.array([0.0, 50.0]), np.array([300.0, 300.0]))
    yield "EB0S 80 on a face of radius 50", 1e3 * float(along[1] - along[0]), 4.0, 1e-3


def main():
    bad = 0
    for name, got, expected, allowed in exact():
        good = abs(got - expected) <= allowed
        bad += not good
        print(f"{'ok' if good else '!!'} {name}: {got:.5f} um, {expected} expected")
    for slip in ("none", *SLIPS):
        found = judge.campaign([sys.executable, os.path.join(HERE, "played.py"), slip], ["plain", "quantised"], 30, 5, 2, None, quiet=True)
        good = (found > 0) == (slip != "none")
        bad += not good
        print(f"{'ok' if good else '!!'} slip {slip}: {found} found")
    return 1 if bad else 0
