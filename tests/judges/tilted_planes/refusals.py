"""Bad input: what may not come out as a corrected program, and under which numbers the documents say it is refused.

A row by its name: numbers that docs/diagnostics.md allows ("VP" any, the reason is not a plane's), changes of the machine, lines.
`{at}` are words that stand upright on the plane `{plane}`.
"""

import random

from common import command

import generate

P = ("VP0231",)
A = ("VP0232",)
ANY = ("VP",)
HEAD = ["G17 G21 G90 G94 G40 G49 G80", "G54", "G0 A-30. C0."]
PLANE = ["G68.2 X1. Y2. Z3. I0. J30. K0."]
BEGIN = ["G43 H1 G0 X0. Y0. Z50.", "G1 Z-5. F200.", "X10."]
END = ["G0 Z50.", "G49", "G69", "M30"]
FREE = ["G17 G21 G90 G94 G40 G49 G80", "G54", "G0 A0. C0."]
RULE = {"branch": "A-", "turn": "shortest"}

ROWS = {
    "good: written angles": (None, {}, HEAD + PLANE + BEGIN + END),
    "good: G53.1": (None, RULE, FREE + PLANE + ["G53.1"] + BEGIN + END),
    "good: G53.1 on a level plane": (None, RULE, FREE + ["G68.2 X1. Y2. Z3. I0. J0. K0.", "G53.1"] + BEGIN + END),
    "no [kinematics]": (P, {"kinematics": False}, HEAD + PLANE + BEGIN + END),
    "a tenth of a degree off": (A, {}, ["G17 G21 G90 G94 G54", "G0 A-30.1 C0."] + PLANE + BEGIN + END),
    "10 urad off": (A, {}, ["G17 G21 G90 G94 G54", "G0 A-30.0006 C0."] + PLANE + BEGIN + END),
    "the other sense of the table": (A, {}, ["G17 G21 G90 G94 G54", "G0 A30. C0."] + PLANE + BEGIN + END),
    "C off by a degree": (A, {}, ["G17 G21 G90 G94 G54", "G0 A-30. C1."] + PLANE + BEGIN + END),
    "angles never named": (A + ("VP0213",), {}, ["G17 G21 G90 G94 G54"] + PLANE + BEGIN + END),
    "C never named": (A + ("VP0213",), {}, ["G17 G21 G90 G94 G54", "G0 A-30."] + PLANE + BEGIN + END),
    "order I about X": (A, {}, ["G17 G21 G90 G94 G54", "G0 A-30. C0.", "G68.2 X0. Y0. Z0. I30. J0. K0."] + BEGIN + END),
    "G53.1 without a rule": (A, {}, FREE + PLANE + ["G53.1"] + BEGIN + END),
    "G53.6 without a rule": (A, {}, FREE + PLANE + ["G53.6"] + BEGIN + END),
    "G53.1 with turn alone": (A, {"turn": "shortest"}, FREE + PLANE + ["G53.1"] + BEGIN + END),
    "G53.1 beyond travel": (A, {**RULE, "travel": {"A": [-20, 20]}}, FREE + PLANE + ["G53.1"] + BEGIN + END),
    "G53.1 of a plane from below": (A, {**RULE, "travel": {"A": [-100, 30]}}, FREE + ["G68.2 X0. Y0. Z0. I0. J150. K0.", "G53.1"] + BEGIN + END),
    "G53.1, C nobody knows where, shortest": (A, RULE, ["G17 G21 G90 G94 G54"] + PLANE + ["G53.1"] + BEGIN + END),
    "G53.1 singular, C nobody knows where": (A, RULE, ["G17 G21 G90 G94 G54", "G68.2 X0. Y0. Z0. I0. J0. K0.", "G53.1"] + BEGIN + END),
    "G53.1 without a plane": (ANY, RULE, FREE + ["G53.1"] + BEGIN + END),
    "feed behind G53.1 without a rapid": (ANY, RULE, FREE + PLANE + ["G53.1", "G43 H1", "G1 X0. Y0. Z-5. F200."] + END),
    "feed behind G68.2 without a rapid": (ANY, {}, HEAD + PLANE + ["G43 H1", "G1 X10. F200."] + END),
    "feed behind G69 without a rapid": (ANY, {}, HEAD + PLANE + BEGIN + ["G0 Z50.", "G49", "G69", "G1 X10.", "M30"]),
    "G43.4 in a plane": (P + ("VP0230",), {}, HEAD + PLANE + ["G43.4 H1 G0 X0. Y0. Z50.", "G1 Z-5. F200."] + END),
    "plane under G43.4": (P + ("VP0230",), {}, HEAD + ["G43.4 H1 G0 X0. Y0. Z50."] + PLANE + BEGIN + END),
    "G43.5 in a plane": (ANY, {}, HEAD + PLANE + ["G43.5 H1 G0 X0. Y0. Z50. I0. J0. K1."] + END),
    "G43 before the plane": (P, {}, HEAD + ["G43 H1 G0 X0. Y0. Z80."] + PLANE + ["G0 X0. Y0. Z50.", "G1 Z-5. F200."] + END),
    "rotary axis turns in the plane": (A, {}, HEAD + PLANE + BEGIN + ["G1 A-31. X20."] + END),
    "rotary rapid in the plane": (A, {}, HEAD + PLANE + BEGIN + ["G0 C90."] + ["G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "plane in a plane": (P, {}, HEAD + PLANE + BEGIN + PLANE + BEGIN + END),
    "P4": (P, {}, HEAD + ["G68.2 P4 X0. Y0. Z0. I0. J30. K0."] + BEGIN + END),
    "P7": (P, {}, HEAD + ["G68.2 P7 X0. Y0. Z0. I0. J30. K0."] + BEGIN + END),
    "R of a plane": (P, {}, HEAD + ["G68.2 X0. Y0. Z0. I0. J30. K0. R10."] + BEGIN + END),
    "X left out": (P, {}, HEAD + ["G68.2 Y0. Z0. I0. J30. K0."] + BEGIN + END),
    "no zero at all": (P, {}, HEAD + ["G68.2 I0. J30. K0."] + BEGIN + END),
    "no angle at all": (P, {}, HEAD + ["G68.2 X0. Y0. Z0."] + BEGIN + END),
    "P1 without an angle": (P, {}, HEAD + ["G68.2 P1 Q123 X0. Y0. Z0."] + BEGIN + END),
    "P1 without Q": (P, {}, HEAD + ["G68.2 P1 X0. Y0. Z0. I30. J0. K0."] + BEGIN + END),
    "P1 Q321": (P, {}, HEAD + ["G68.2 P1 Q321 X0. Y0. Z0. I30. J0. K0."] + BEGIN + END),
    "P1 of two angles": (P, {}, HEAD + ["G68.2 P1 Q123 X0. Y0. Z0. I30. J0. K10."] + BEGIN + END),
    "P2 without its third point": (P, {}, HEAD + ["G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q2 X10. Y0. Z0."] + BEGIN + END),
    "P2 points of one line": (P, {}, HEAD + ["G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q2 X10. Y0. Z0.", "G68.2 P2 Q3 X20. Y0. Z0."] + BEGIN + END),
    "P2 points that are one": (P, {}, HEAD + ["G68.2 P2 Q1 X1. Y0. Z0.", "G68.2 P2 Q2 X1. Y0. Z0.", "G68.2 P2 Q3 X20. Y0. Z0."] + BEGIN + END),
    "P2 with a shift": (P, {}, HEAD + ["G68.2 P2 Q0 X5. Y0. Z0. R0.", "G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q2 X10. Y0. Z0.", "G68.2 P2 Q3 X0. Y0.866025 Z0.5"] + BEGIN + END),
    "P2 without Z": (P, {}, HEAD + ["G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q2 X10. Y0. Z0.", "G68.2 P2 Q3 X0. Y8.66025"] + BEGIN + END),
    "P2 cut in two by a motion": (P, {}, HEAD + ["G68.2 P2 Q1 X0. Y0. Z0.", "G0 X5.", "G68.2 P2 Q2 X10. Y0. Z0.", "G68.2 P2 Q3 X0. Y0.866025 Z0.5"] + BEGIN + END),
    "P3 of a zero vector": (P, {}, HEAD + ["G68.2 P3 Q1 X0. Y0. Z0. I0. J0. K0.", "G68.2 P3 Q2 I0. J-0.5 K0.866025"] + BEGIN + END),
    "P3 of vectors not at right angles": (P, {}, HEAD + ["G68.2 P3 Q1 X0. Y0. Z0. I1. J0.2 K0.", "G68.2 P3 Q2 I0. J-0.5 K0.866025"] + BEGIN + END),
    "P3 of one vector": (P, {}, HEAD + ["G68.2 P3 Q1 X0. Y0. Z0. I1. J0. K0."] + BEGIN + END),
    "P3 of parallel vectors": (P, {}, HEAD + ["G68.2 P3 Q1 X0. Y0. Z0. I1. J0. K0.", "G68.2 P3 Q2 I2. J0. K0."] + BEGIN + END),
    "G55 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G55", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G52 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G52 X5. Y0. Z0.", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G92 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G92 X0. Y0. Z0.", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G68 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G68 X0. Y0. R30.", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "plane under G68": (P + ("VP0227",), {}, HEAD + ["G68 X0. Y0. R30."] + PLANE + BEGIN + END),
    "plane under G51": (ANY, {}, HEAD + ["G51 X0. Y0. Z0. P2."] + PLANE + BEGIN + END),
    "plane under G51.1": (ANY, {}, HEAD + ["G51.1 X0."] + PLANE + BEGIN + END),
    "plane under G41": (ANY, {}, HEAD + ["G0 X0. Y0. Z80.", "G41 D1 G1 X5. F100."] + PLANE + BEGIN + END),
    "G53 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G53 G0 Z0.", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G28 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G91 G28 Z0.", "G90 G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G10 in a plane": (P, {}, HEAD + PLANE + BEGIN + ["G10 L2 P1 X5. Y5. Z5.", "G0 X0. Y0. Z50.", "G1 Z-5."] + END),
    "G68.3": (ANY, {}, HEAD + ["G68.3 X0. Y0. Z0."] + BEGIN + END),
    "G68.4": (ANY, {}, HEAD + PLANE + BEGIN + ["G68.4 X0. Y0. Z0. I0. J10. K0."] + BEGIN + END),
    "angle that is no number": (ANY, {}, HEAD + ["G68.2 X0. Y0. Z0. I0. Jnan K0."] + BEGIN + END),
    "angle 1e300": (ANY, {}, HEAD + ["G68.2 X0. Y0. Z0. I0. J" + "9" * 300 + ". K0."] + BEGIN + END),
    "control cycle800": (ANY, {"control": "sinumerik"}, ["G17 G71 G90 G94 G54", 'CYCLE800(1,"TABLE",100000,57,0,0,0,30,0,0,0,0,0,1)', "G1 X10 F100", "M30"]),
}


def machine():
    rng = random.Random("refusals")
    while True:
        base = generate.make_machine(rng, "tt-ac", "crooked")
        if base["chain"] == "[w C A X Y b Z t]":
            return base


def asked(case):
    """A row: what passes that may not, or is refused under a number that its page does not name, is found."""
    allowed, changes, lines = ROWS[case.number]
    spec = machine()
    for k, v in changes.items():
        if k == "travel":
            for axis, reach in v.items():
                spec["rotary"][axis]["travel"] = reach
        else:
            spec[k] = v
    profile = generate.write_profile(spec, case.folder)
    if "control" in changes:
        profile.write_text(profile.read_text().replace('"fanuc"', '"%s"' % changes["control"]))
    source = case.write("in.nc", "%\nO1\n" + "\n".join("N%d %s" % (10 * k + 10, x) for k, x in enumerate(lines)) + "\n%\n")
    status, output, errors = case.run("correct", source, "-m", profile, "--zero", "true")
    code, message = command.code(errors), command.first_error(errors).partition(": ")[2]
    case.tally["bad input tried"] += allowed is not None
    if allowed is None:
        if status:
            case.find("good-refused", code + " " + message)
    elif status == 0 or output:
        case.find("bad-passed", "exit status %d" % status)
    elif status != 1 or (allowed[-1] != "VP" and code not in allowed):
        case.find("bad-code", "exit status %d, %s %s" % (status, code, message))
    else:
        case.tally["bad input refused " + code] += 1
    if case.options.say:
        print("%-45s %s %s" % (case.number, code, message))
