"""Cases with a known answer: bad input that has to be refused, each by a message of its own, and perfect machines, whose
programs come out as they went in."""

import os
import re

from common.command import first_error

import generate

START = {"fanuc": "G21 G17 G90 G94 G40 G54\nG0 X0. Y0. Z200. A0. C0.\n", "sinumerik": "G710 G17 G90 G94 G40\nG54\nG0 X0 Y0 Z200 A=0 C=0\n", "linuxcnc": "G21 G17 G90 G94 G40 G54\nG0 X0 Y0 Z200 A0 C0\n"}

# name, control, whether kinematics are declared, program behind the start
BAD = [
    ("TCP without declared kinematics, G43.4", "fanuc", False, "G43.4 H1\nG0 X10. Y0. Z50. A10. C20.\nG1 X20. A12. C25. F500.\nG49\n"),
    ("TCP without declared kinematics, TRAORI", "sinumerik", False, "TRAORI\nG0 X10 Y0 Z50 A=10 C=20\nG1 X20 A=12 C=25 F500\nTRAFOOF\n"),
    ("TCP without declared kinematics, M428", "linuxcnc", False, "M428\nG0 X10 Y0 Z50 A10 C20\nG1 X20 A12 C25 F500\nM429\n"),
    ("G43.4 inside G68.2", "fanuc", True, "A30.\nG68.2 X0. Y0. Z0. I0. J30. K0.\nG53.1\nG43.4 H1\nG0 X10. Y0. Z50.\nG1 X20. F500.\nG49\nG69\n"),
    ("cutter compensation under TCP", "fanuc", True, "G43.4 H1\nG0 X10. Y0. Z50. A10. C20.\nG41 D1 G1 X20. F500.\nX30. A12.\nG40\nG49\n"),
    ("plane and angles disagree", "fanuc", True, "G0 A10. C0.\nG68.2 X0. Y0. Z0. I0. J30. K0.\nG0 X10. Y0.\nG0 Z50.\nG1 X20. F500.\nG69\n"),
    ("a rotary axis beyond travel", "fanuc", True, "G43.4 H1\nG0 X10. Y0. Z50. A10. C20.\nG1 X20. A140. F500.\nG49\n"),
    ("C wound beyond travel", "sinumerik", True, "TRAORI\nG0 X10 Y0 Z50 A=10 C=1070\nG1 X20 C=IC(30) F500\nTRAFOOF\n"),
    ("a direction of no length", "fanuc", True, "G43.5 H1\nG0 X10. Y0. Z50.\nG1 X20. I0. J0. K0. F500.\nG49\n"),
    ("a vector of no length", "sinumerik", True, "TRAORI\nG0 X10 Y0 Z50 A=10 C=20\nG1 X20 A3=0 B3=0 C3=0 F500\nTRAFOOF\n"),
    ("a direction that is no number", "sinumerik", True, "TRAORI\nG0 X10 Y0 Z50 A=10 C=20\nG1 X20 A3=NAN B3=0 C3=1 F500\nTRAFOOF\n"),
    ("a direction out of reach", "fanuc", True, "G43.5 H1\nG0 X10. Y0. Z50. A10. C20.\nG1 X20. I0. J0.1 K-1. F500.\nG49\n"),
]


def base(control):
    """A crooked A/C table with travel A -110..110, C -1080..1080."""
    import random

    spec = generate.machine(random.Random("directed"), "table-table-ac", control, lambda key: False)
    spec["lengths"] = {"H1": 100.0}
    spec.update(branch="A+", turn="shortest")
    for one in spec["axes"].values():
        one.pop("backlash_um", None)
    return spec


def run(vpost, folder, has, correct):
    """[(name, problem or None, what was said)]."""
    out = []
    for n, (name, control, declared, text) in enumerate(BAD):
        where = os.path.join(folder, f"bad-{n}")
        os.makedirs(where, exist_ok=True)
        result = correct(vpost, base(control), START[control] + text + "M30\n", where, has if declared else lambda key: key != "kinematics" and has(key), None)
        said = first_error(result["stderr"]) or result["stderr"][:100]
        wrong = None if result["status"] == 1 and re.search(r"VP\d{4}", said) else f"exit status {result['status']}"
        out.append((name, wrong, said))
    for number in range(len(generate.CHAINS) * len(generate.KINDS)):
        chain, kind, spec, text = generate.pair("identity", number, has)
        if chain == "nutating" and not has("direction"):
            continue
        spec["squareness_urad"] = [0.0, 0.0, 0.0]
        spec.pop("control_centres", None)
        for one in spec["axes"].values():
            one.pop("backlash_um", None), one.pop("table", None)
        for one in spec["rotary"].values():
            one.pop("table", None), one.pop("table_negative", None), one.pop("backlash_urad", None)
            one["location"] = {}
        where = os.path.join(folder, f"perfect-{number}")
        os.makedirs(where, exist_ok=True)
        result = correct(vpost, spec, text, where, has, None)
        if result["status"] == 0 and result["out"] != text:
            out.append((f"perfect {chain} {kind}", "the output is not the input", ""))
        elif result["status"] not in (0, 1):
            out.append((f"perfect {chain} {kind}", f"exit status {result['status']}", ""))
        else:
            code = re.search(r"VP\d{4}", result["stderr"])
            out.append((f"perfect {kind}", None, "identical" if result["status"] == 0 else f"refused {code.group(0) if code else '?'}"))
    return out
