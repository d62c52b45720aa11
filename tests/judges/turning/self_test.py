"""Feeds the judge what is known to be right or wrong, worked out by hand or by oracles.json, and tells whether it sees it."""

import json
import math
import re
import os

import numpy as np

import generate
import judge
import played
import reader
import workpiece

HERE = os.path.dirname(os.path.abspath(__file__))
UM = 1e3


def lathe(inputs):
    """A lathe without errors but those that an oracle's inputs name."""
    spec = {"axes": {"X": {}, "Z": {}}, "spindle": {}, "workpiece": {"clamping": inputs.get("clamping", "chuck")}}
    for name in ("EB0S_urad", "EXS_cos_um", "EXS_sin_um", "EYS_cos_um", "EYS_sin_um"):
        if name in inputs:
            spec["spindle"][name] = inputs[name]
    if "EB0Z_urad" in inputs:
        spec["squareness"] = {"EB0Z_urad": inputs["EB0Z_urad"]}
    if "headstock_offset_um" in inputs:
        spec["headstock"] = {"offset_um": inputs["headstock_offset_um"]}
    if "tailstock_mm" in inputs:
        spec["tailstock"] = {"at_mm": inputs["tailstock_mm"], "offset_um": inputs["tailstock_offset_um"]}
    return workpiece.Lathe(spec)


def radius_error(machine, radius, z, height=0.0):
    across, side, _ = machine.seen(machine.tip([radius], [z], [0, height, 0]))
    return UM * (float(np.hypot(across, side)[0]) - radius)


def oracles():
    """(name, found, expected, tolerance) of every figure of oracles.json that the simulator can play."""
    with open(os.path.join(HERE, "oracles.json"), encoding="ascii") as file:
        cases = json.load(file)["cases"]
    for case in cases:
        i, name = case["inputs"], case["id"]
        for key, expected in case["expected"].items():
            found = None
            z = float(key.rsplit("_", 1)[1]) if "_at_" in key else i.get("z_mm") if isinstance(i.get("z_mm"), float) else 0.0
            if name.startswith("bending"):
                rows = i.get("diameters_mm") or [[0, i["diameter_mm"]], [i["length_mm"], i["diameter_mm"]]]
                support = rows[-1][0] if i["clamping"] != "chuck" else None
                beam = workpiece.Beam(rows, i["e_gpa"], i["clamping"], support, i.get("steady_mm"))
                at = case["largest_at_mm"] if key.startswith("largest") else z
                found = UM * i["radial_force_n"] * beam.deflection(at)
            elif name.startswith("roughness"):
                f, r = i["feed_mm_rev"], i["nose_radius_mm"]
                found = UM * (workpiece.turned(f, r, 10.0, np.arange(4, 5, f / 2)).max()) if key == "rz_exact_um" else UM * f * f / 8 / r
            elif name.startswith("spindle-e") or name.startswith("spindle-two"):
                square, zone, centre, mean = workpiece.roundness(workpiece.section(lathe(i), i["radius_mm"], -50.0, i["angles"]))
                found = UM * {"roundness_least_squares_um": square, "roundness_minimum_zone_um": zone, "radius_error_um": mean - i["radius_mm"],
                              "displacement_um": float(np.linalg.norm(centre))}[key]
            elif name == "tip-height":
                found = radius_error(lathe({}), i["radius_mm"], 0.0, i["height_mm"])
            elif name == "tip-height-face":
                found = 2 * (radius_error(lathe({}), 0.0, 0.0, i["height_mm"]))
            else:
                found = (2 if key.startswith("diameter") else 1) * radius_error(lathe(i), i["radius_mm"], z)
            yield f"{name} {key}", found, expected, case["tolerance_um"]


def turned_shaft(text, **more):
    spec = {"control": "fanuc-lathe", "g_code_system": "A", "x": "diameter", "decimal": "millimetres", "tool": {"lengths_mm": {"H1": [0, 0, 0]}, "noses": {}}, **more}
    return spec, reader.read(text, spec)[0]


def readings():
    """(what, found, expected) of the readers, by hand."""
    go = "G0 X60. Z2. T0101\n"
    ends = lambda text, **more: [(m.kind, round(m.b[0], 4), round(m.b[1], 4)) for m in turned_shaft(go + text, **more)[1][1:]]  # noqa: E731
    yield "X is a diameter, U too", ends("G1 X40. F.2\nU-2. W-3.\n"), [("feed", 20, 2), ("feed", 19, -1)]
    yield "X as a radius", ends("G1 X40. F.2\n", x="radius"), [("feed", 40, 2)]
    yield "G90 of system A is a pass", ends("G90 X50. Z-20. F.2\n"), [("rapid", 25, 2), ("feed", 25, -20), ("feed", 30, -20), ("rapid", 30, 2)]
    yield "G90 of system B is a mode", ends("G90 G1 X50. Z-20. F.2\n", g_code_system="B"), [("feed", 25, -20)]
    yield "G77 of system B with taper", ends("G77 X50. Z-20. R-2. F.2\n", g_code_system="B"), [("rapid", 23, 2), ("feed", 25, -20), ("feed", 30, -20), ("rapid", 30, 2)]
    yield "G21 of system C is a thread", [k for k, _, _ in ends("G21 X50. Z-20. F1.5\n", g_code_system="C")], ["rapid", "thread", "rapid", "rapid"]
    yield "G94 faces", ends("G94 X10. Z-1. F.2\n"), [("rapid", 30, -1), ("feed", 5, -1), ("feed", 5, 2), ("rapid", 30, 2)]
    yield "I of an arc is a radius", ends("G1 X20. Z0. F.2\nG3 X30. Z-5. I0. K-5.\n")[1:], [("feed", 15, -5)]
    yield "chamfer and rounding", ends("G1 X20. Z0. F.2\nX30. ,C1.\nZ-20. ,R2.\nX40.\n")[1:], \
        [("feed", 14, 0), ("feed", 15, -1), ("feed", 15, -18), ("feed", 17, -20), ("feed", 20, -20)]
    yield "a line by A", ends("G1 X20. Z0. F.2\nX40. ,A135.\n")[1:], [("feed", 20, -10)]
    yield "least increments", ends("G1 X40000 F.2\n", decimal="increments"), [("feed", 20, 2)]
    passes = [m for m in turned_shaft(go + "G71 U2. R.5\nG71 P10 Q20 U.4 W.1 F.3\nN10 G0 X40.\nG1 Z-10. F.1\nN20 X60.\nG70 P10 Q20\n")[1] if m.kind == "feed"]
    yield "G71 and G70 end on the contour", [(round(m.b[0], 4), round(m.b[1], 4)) for m in passes[-2:]], [(20, -10), (30, -10)]
    yield "G71 leaves its allowances", [(round(m.b[0], 4), round(m.b[1], 4)) for m in passes[-4:-2]], [(20.2, -9.9), (30.2, -9.9)]
    lead = [m.state[0] for m in turned_shaft(go + "G32 X50. Z-20. F1.5\n")[1] if m.kind == "thread"]
    yield "a thread has its lead", lead, [1.5]
    nose = {"lengths_mm": {"H1": [0, 0, 0]}, "noses": {"H1": {"radius_mm": 0.8, "direction": 3, "height_um": 0}}}
    comp = turned_shaft(go + "G42 G1 X40. Z1. F.2\nZ-20.\nX60. Z-30.\nG40 X70.\n", tool=nose)[1]
    yield "G42 keeps the imaginary tip on a cylinder", [round(comp[2].b[0], 6), round(comp[2].b[1], 6)], [20.0, round(-20 - 0.8 * (1 - math.tan(math.radians(22.5))) + 0.0, 6)]
    lin = {"control": "linuxcnc-lathe", "x": "diameter", "tool": {**nose, "noses": {"H1": {"radius_mm": 0.8, "direction": 2, "height_um": 0}}}}
    other = reader.read("G21 G18 G90 G7 G40\nT1 M6 G43 H1\nG95 F0.2 S500 M3\nG0 X60 Z2\nG42 G1 X40 Z1\nZ-20\nX60 Z-30\nG40 X70\nM2\n", lin)[0]
    yield "and so does LinuxCNC's interpreter", [round(other[2].b[0], 3), round(other[2].b[1], 3)], [round(comp[2].b[0], 3), round(comp[2].b[1], 3)]
    sin = {"control": "sinumerik-turn", "x": "diameter", "tool": nose}
    both = [(m.b[0], m.b[1]) for m in reader.read("DIAM90\nG0 X60 Z2\nG1 X40 F0.2\nG91 X-2\nG90\nDIAMOF\nX15 Z-5\n", sin)[0]]
    yield "DIAM90 and DIAMOF", both[1:], [(20, 2), (18, 2), (15, -5)]


def surfaces():
    """(what, found, expected, tolerance) of the envelope."""
    z = np.array([-5.0, -10.0])
    for inside, tips, wanted in ((False, (-1, -1), 20.0), (True, (1, -1), 20.0)):
        s = workpiece.Surface(z, 1, inside)
        s.cut(lathe({}), workpiece.Nose(0.8, tips), np.array([20.0, 20.0]), np.array([0.0, -20.0]), [0, 0, 0])
        yield f"envelope {'bore' if inside else 'outside'}", float(s.mean()[0]), wanted, 1e-12
    s = workpiece.Surface(z, 1)
    s.cut(lathe({}), workpiece.Nose(0.8, (-1, -1)), np.array([10.0, 20.0]), np.array([0.0, -10.0]), [0, 0, 0])
    # a taper of 45 degrees under G40: the nose stands off by r (1 - tan 22.5) along X
    yield "taper left by the nose", float(s.mean()[0]), 15 + 0.8 * (2 - math.sqrt(2)), 1e-12


def mistakes():
    """(what, whether the judge found it, whether it should) on random lathes."""
    wanted = {"right": 12, "diameter": 3, "U": 2, "alpha": 3, "20um": 3, "tip": 3, "explicit": 3, "uncorrected": 3, "rapid": 3}
    for number in range(400):
        kind, spec, text = generate.pair("self-test", number)
        if spec.get("perfect") or kind == "linuxcnc-cycle" and "G76" in text:
            continue
        spec["tolerance_um"] = 1.0
        todo = [("explicit" if kind == "linuxcnc-nose" else "right", None), ("uncorrected", None)]
        if kind in ("shaft", "increments", "sinumerik", "bore"):
            todo += [("diameter", "diameter"), ("20um", "20um"), ("rapid", None)]
        if spec.get("g_code_system") == "A" and kind in ("shaft", "bore"):
            todo.append(("U", "U"))
        if spec.get("tailstock") and abs(spec["tailstock"]["offset_um"][0]) > 15 and kind in ("shaft", "increments", "sinumerik", "nose-od"):
            todo.append(("alpha", "alpha"))
        if kind == "nose-od":
            todo = [("tip", "tip"), ("explicit", None)]
        for name, mistake in todo:
            if wanted[name] == 0:
                continue
            wanted[name] -= 1
            try:
                out = text if name == "uncorrected" else played.correct(spec, text, mistake, name in ("tip", "explicit"))
            except reader.Unreadable as error:
                yield f"{name} ({kind} {number}): {error}", True, False, []
                continue
            if name == "rapid":
                out = re.sub(r"(G0 X)([\d.]+)( Z)", lambda m: f"{m[1]}{float(m[2]) + 0.4}{m[3]}", out, count=1)
            problems, _ = judge.assess(spec, text, out)
            if name == "rapid":
                problems = [p for p in problems if p[0] == "rapid"]
            if name in ("tip", "explicit"):
                problems = [p for p in problems if p[0] in ("surface", "path")]
            yield f"{name} ({kind} {number})", bool(problems), name not in ("right", "explicit"), problems
        if not any(wanted.values()):
            return
    yield f"too few programs for {[k for k, v in wanted.items() if v]}", True, False, []


def run():
    wrong = 0
    worst = 0.0
    for name, found, expected, tolerance in oracles():
        off = abs(found - expected)
        worst = max(worst, off)
        if not off <= tolerance:
            wrong += 1
            print(f"WRONG {name}: {found} for {expected}")
    print(f"oracles: worst difference {worst:.2e} um")
    for name, found, expected in readings():
        if found != expected:
            wrong += 1
            print(f"WRONG {name}: {found} for {expected}")
    for name, found, expected, tolerance in surfaces():
        if not abs(found - expected) <= tolerance:
            wrong += 1
            print(f"WRONG {name}: {found} for {expected}")
    count = 0
    for name, found, expected, problems in mistakes():
        count += 1
        if found != expected:
            wrong += 1
            print(f"WRONG {name}: {'found' if found else 'not found'} {problems[:2]}")
    print(f"mistakes and right outputs: {count}; wrong: {wrong}")
    return 1 if wrong else 0
