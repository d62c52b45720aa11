"""The referee judged: programs it must pass, and spoilt ones it must not."""

import math
import re

from interpreter import AFTER_MOTION, interpret
from machine import AXES, Machine, rotate
from referee import Judge, judge, length, point

PROGRAM = """\
%
O0007 (SELF-TEST)
N10 G21 G17 G90 G54
N20 T1 M6
N30 G43 H1 S6000 M3
N40 G0 Z30. M8
N50 G0 X0. Y0.
N60 Z2.
N70 G1 Z-2. F100.
N80 X60. F600.
N90 Y30.
N100 G3 X50. Y40. R10.
N110 G1 X10.
N120 G2 I-8. J0. (a full circle)
N130 G3 X0. Y30. I0. J-10.
N140 G1 X0. Y0. M9
N150 G0 Z2.
N160 G0 X30. Y20.
N170 G1 Z0. F80.
N180 G2 X30. Y20. Z-6. I6. J0. F300.
N190 G18 G2 X50. Z-6. R12.
N200 G19 G3 Y32. Z-6. J6. K0.
N210 G17 G0 Z10.
N220 M1
N230 G99 G81 X5. Y5. Z-4. R2. F90.
N240 X15.
N250 G80
N260 G91 G1 X1. Y1. Z-9. F500.
N270 X2. Y-3.
N280 X-2. Y-2.
N290 G4 P0.5
N300 G90 G0 Z30. M5
N310 M30
%
"""


def sloping_table(axis, scale):
    """A table of 20 mm steps from -40 to 300 mm with all six errors, in mm and rad."""
    positions = [20.0 * k - 40.0 for k in range(18)]
    rows = []
    for x in positions:
        wave = [math.sin(0.011 * x * (k + 1) + axis) for k in range(6)]
        rows.append([scale * 0.03 * w for w in wave[:3]] + [scale * 60e-6 * w for w in wave[3:]])
    return positions, rows


def make_machine(scale):
    """A machine with squareness of up to 1.1 mrad and angles up to 60 urad, times `scale`."""
    profile = {
        "chain": "[w X Y b Z t]",
        "squareness": {"EC0Y_urad": 1100.0 * scale, "EB0Z_urad": 440.0 * scale, "EA0Z_urad": -500.0 * scale},
        "tool": {"lengths_mm": {"H1": 80.0}},
        "work_offsets_mm": {"G54": [60.0, 50.0, 90.0]},
    }
    machine = Machine(profile, ".")
    machine.tables = [sloping_table(axis, scale) for axis in range(3)]
    machine.travel = [(-40.0, 300.0)] * 3
    return machine


def solve(machine, move, program):
    """Program point whose command takes the tool to where `program` says."""
    bench = Judge(machine, 1.0)
    target, q = bench.nominal(move, program), program
    for _ in range(8):
        tip = bench.tip(move, q)
        q = tuple(a - (t - w) for a, t, w in zip(q, tip, target))
    return q


def correct(text, machine, piece_mm=4.0):
    """The program as corrected short lines: a plain corrector to test the referee with."""
    moves, events = interpret(text.encode(), machine.offsets)
    before, after = {}, {}
    for name, line, _ in events:
        name = name.replace("dwell ", "G4 P")
        (after if name in AFTER_MOTION else before).setdefault(line, []).append(name)
    lines = {move.line for move in moves} | set(before) | set(after)
    cycles = {move.line for move in moves if move.rapid} & {move.line for move in moves if not move.rapid}
    lines |= {number for number, line in enumerate(text.splitlines(), 1) if "G43" in line}
    offset, out, standing = machine.offsets["G54"], ["G21 G17 G90 G54"], {}
    for line in sorted(lines):
        if "G43" in text.splitlines()[line - 1]:
            out.append("G43 H1")
        out += before.get(line, [])
        for move in (one for one in moves if one.line == line):
            def say(wanted, axes):
                """Words of some axes for a place, and whether they all stand there."""
                q = solve(machine, move, wanted) if move.known else wanted
                said = {k: f"{AXES[k]}{round(q[k] - offset[k], 3) + 0.0:.3f}" for k in axes}
                stands = all(standing.get(k) == word for k, word in said.items())
                standing.update(said)
                return " ".join(said.values()), stands

            if move.rapid:
                out.append(f"G0 {say(move.end, range(3) if line in cycles else move.own)[0]}")
                continue
            # Rapids carry their own axes only: the feed brings the correction of the others.
            approach, stands = say(move.start, range(3))
            out += [] if stands else [f"G1 {approach} F{move.feed:.3f}"]
            count = max(1, math.ceil(length(move) / (0.1 if move.arc else piece_mm)))
            for k in range(1, count + 1):
                out.append(f"G1 {say(point(move, k / count), range(3))[0]} F{move.feed:.3f}")
        out += after.get(line, [])
    return "\n".join(out) + "\n"


class Report:
    """Counts what went as it should."""

    def __init__(self):
        self.good, self.bad = 0, 0

    def expect(self, name, condition, note=""):
        if condition:
            self.good += 1
        else:
            self.bad += 1
            print(f"referee self-test: FAILED: {name} {note}")


def spoil(lines, at, change):
    """The program with one line changed, or left out where `change` gives None."""
    new = change(lines[at])
    return "\n".join(lines[:at] + ([] if new is None else [new]) + lines[at + 1 :])


def value(letter, line):
    """Number of a word."""
    return float(re.search(letter + r"(-?[\d.]+)", line)[1])


def shift(letter, by):
    """Changes the number of a word by some mm."""
    return lambda line: re.sub(letter + r"(-?[\d.]+)", lambda m: f"{letter}{float(m[1]) + by:.3f}", line)


def check_model(report):
    """The forward model against formulas that need no chain."""
    profile = {"squareness": {"EC0Y_urad": 1000, "EB0Z_urad": 400, "EA0Z_urad": 200}}
    skewed = Machine(profile, ".")
    p = skewed.forward((10.0, 100.0, 50.0), (0.0, 0.0, 0.0))
    wanted = (10.0 - 1e-3 * 100.0 + 4e-4 * 50.0, 100.0 - 2e-4 * 50.0, 50.0)
    report.expect("squareness signs", max(abs(a - b) for a, b in zip(p, wanted)) < 1e-12, p)
    turned = rotate((0.0, 0.0, math.pi / 2), (1.0, 0.0, 0.0))
    report.expect("a quarter turn about Z", max(abs(a - b) for a, b in zip(turned, (0.0, 1.0, 0.0))) < 1e-12, turned)
    machine, tool = make_machine(0.01), (1.0, -2.0, -80.0)
    for chain in ("[w X Y b Z t]", "[w Z b Y X t]", "[w Y b X Z t]"):
        machine.order = [AXES.index(name) for name in chain if name in AXES]
        q = (31.0, 77.0, 140.0)
        tables = [
            [a + (x % 20.0) / 20.0 * (b - a) for a, b in zip(table[1][int((x + 40) // 20)], table[1][int((x + 40) // 20) + 1])]
            for table, x in zip(machine.tables, q)
        ]
        d = [-1.1e-5 * q[1] + 0.44e-5 * q[2], 0.5e-5 * q[2], 0.0]
        for place, axis in enumerate(machine.order):
            lever = list(tool)
            for later in machine.order[place + 1 :]:
                lever[later] += q[later]
            ex, ey, ez = tables[axis][3:]
            turn = (ey * lever[2] - ez * lever[1], ez * lever[0] - ex * lever[2], ex * lever[1] - ey * lever[0])
            for k in range(3):
                d[k] += tables[axis][k] + turn[k]
        p = machine.forward(q, tool)
        off = max(abs(p[k] - q[k] - tool[k] - d[k]) for k in range(3))
        report.expect(f"first order along {chain}", off < 1e-7, off)


def run():
    """Runs all cases; exit status for the command."""
    report = Report()
    check_model(report)
    machine = make_machine(1.0)

    def verdict(original, corrected, which=machine):
        return judge(original.encode(), corrected.encode(), which)

    good = correct(PROGRAM, machine)
    result = verdict(PROGRAM, good)
    report.expect("a corrected program passes", result["ok"], result["failures"])
    report.expect("the gap before is large", 150 < result["before"]["um"] < 400, result["before"])
    report.expect("the gap after is rounding", result["after"]["um"] < 0.9, result["after"])
    report.expect("an uncorrected program fails", not verdict(PROGRAM, PROGRAM)["ok"])
    turns = "G90 G0 X12 Y0 Z5\nG1 Z0 F300\nG3 X12 Y0 Z-2 I-12 J0\nG3 I-12 J0\nG3 I-12 J0\nG1 X0\n"
    result = verdict(turns, turns)
    report.expect("turns over each other are told apart", 50 < result["before"]["um"] < 400, result["before"])
    lines = good.splitlines()
    feeds = [k for k, line in enumerate(lines) if line.startswith("G1")]
    rapids = [k for k, line in enumerate(lines) if line.startswith("G0")]

    def must_fail(name, because, text, which=machine):
        failures = verdict(PROGRAM, text, which)["failures"]
        report.expect(f"{name} must fail", any(re.match(because, failure) or because in failure for failure in failures), failures)

    # Any word off by 20 um that is not along its own path shows; along a straight path it is no error.
    caught = 0
    tried = feeds[:: max(1, len(feeds) // 25)]
    for at in tried:
        caught += sum(not verdict(PROGRAM, spoil(lines, at, shift(letter, 0.02)))["ok"] for letter in AXES) >= 2
    report.expect("every 20 um error across the path is caught", caught == len(tried), f"{caught} of {len(tried)}")
    ends = [k for k in feeds if lines[k + 1].startswith("G0")]
    for at in ends:
        for letter, by in (("X", 0.02), ("Y", -0.02), ("Z", 0.02)):
            must_fail(f"line {at}: {letter}{by:+} at the end of a stretch", "(path|corner): ", spoil(lines, at, shift(letter, by)))
    for at in rapids[2:]:
        own = next(letter for letter in AXES if letter in lines[at])
        must_fail(f"line {at}: a rapid 50 um off", "rapid", spoil(lines, at, shift(own, 0.05)))
        # Cycles repeat rapids to where the tool is already.
        if lines[at] != lines[at - 1]:
            must_fail(f"line {at}: a rapid is missing", "rapid", spoil(lines, at, lambda line: None))
    # Block N80 ends at X60 Y0, N90 at X60 Y30: the line before the first one that goes up is the corner.
    corner = next(k for k in feeds if abs(value("X", lines[k]) - 60.0) < 1.0 and value("Y", lines[k]) > 1.0) - 1
    must_fail("a missing corner", "corner: ", spoil(lines, corner, lambda line: None))
    for word in ("M9", "M8", "S6000", "T1", "M1", "G4 P0.5"):
        at = lines.index(word)
        must_fail(f"{word} is missing", "M, S, T", spoil(lines, at, lambda line: None))
        must_fail(f"{word} is another", "M, S, T", spoil(lines, at, lambda line: "M7"))
    at = lines.index("M9")
    early = lines[: at - 3] + ["M9"] + lines[at - 3 : at] + lines[at + 1 :]
    must_fail("M9 before the last pieces", "place of an event: ", "\n".join(early))
    must_fail("another feed", "feed moves take", good.replace("F600.000", "F500.000"))
    must_fail("no tool length", "tool", good.replace("G43 H1\n", ""))
    must_fail("another work offset", "path: ", good.replace("G54", "G55"))

    # Arcs as arcs, on a perfect machine: the program itself passes, and each fault of a careless rewriter shows.
    perfect = make_machine(0.0)
    result = verdict(PROGRAM, PROGRAM, perfect)
    report.expect("a perfect machine needs no correction", result["ok"] and result["after"]["um"] < 1e-3, result)
    for name, because, old, new in (
        ("a mirrored arc", "path: ", "G3 X50. Y40. R10.", "G2 X50. Y40. R10."),
        ("a mirrored arc of another plane", "path: ", "G18 G2 X50.", "G18 G3 X50."),
        ("the long way round", "path: ", "X50. Y40. R10.", "X50. Y40. R-10."),
        ("a chord", "path: ", "G3 X50. Y40. R10.", "G1 X50. Y40."),
        ("a mirrored centre", "path: ", "G2 I-8. J0.", "G2 I8. J0."),
        ("a full circle left out", "feed moves take", "N120 G2 I-8. J0.", "N120 "),
        ("a helix with one turn more", "path: ", "Z-6. I6. J0.", "Z-6. I6. J0. P2"),
        ("a helix that stays flat", "path: ", "Z-6. I6. J0. F300.", "I6. J0. F300."),
        ("a centre 20 um off", "path: ", "G2 I-8. J0.", "G2 I-8.02 J0."),
        ("a hole less", "rapid", "N240 X15.", "N240"),
        ("a hole 20 um off", "path: ", "N240 X15.", "N240 X15.02"),
        ("a hole 20 um too deep", "path: ", "Z-4. R2.", "Z-4.02 R2."),
        ("an increment forgotten", "path: ", "N270 X2. Y-3.", "N270 X2."),
    ):
        spoilt = PROGRAM.replace(old, new)
        report.expect(f"{name}: the text is spoilt", spoilt != PROGRAM)
        must_fail(name, because, spoilt, which=perfect)
    print(f"referee self-test: {report.good} checks passed, {report.bad} failed")
    return 1 if report.bad else 0
