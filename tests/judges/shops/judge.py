"""Programs of Okuma, Mach and Mitsubishi mills: do the corrected ones go where the programs lead?

A random part is written twice: in the control's own words, and in LinuxCNC's, where every word of the control that
LinuxCNC has not is written as what the control's manual says of it (a cycle with M53 as moves, a subprogram as its blocks,
`X` of a length in two parts as their sum). The first is corrected; the output is put into LinuxCNC's words line by line,
and LinuxCNC's interpreter (`rs274`) reads both. The two paths must lie within NEAR_MM of each other, walked in order: the
judge finds another meaning, not a micron, which `vpost check` proves and is asked as well.

    python3 judge.py --vpost target/release/vpost --count 200 --seed 1 [--keep DIR] [--self-test]
"""

import math
import os
import random
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, interpreter, options, profile  # noqa: E402
from common.words import number as word  # noqa: E402

# Ten times what the machine of the profile is crooked by.
NEAR_MM = 0.25
# Two samples may lie half a step apart along the path.
APART_MM = NEAR_MM + 0.36
OFFSETS = {1: (100.0, 80.0, 40.0), 2: (110.0, 75.0, 41.0), 3: (-60.0, 33.0, 12.0)}
LENGTHS = {1: 120.0, 2: 80.5}
# A length that the program itself writes, in two parts.
WRITTEN = {7: (95.5, -0.25)}


class Unreadable(Exception):
    pass


# ---- LinuxCNC's interpreter ----------------------------------------------------------------------------------------

CALL = re.compile(r"\b([A-Z_0-9]+)\((.*)\)\s*$")


def rs274(text):
    """Axis commands along the path, mm: [(cuts, x, y, z)], and dwells.

    The interpreter does not always read its tables to the end: what it says twice in a row counts.
    """
    said = []
    for _ in range(8):
        try:
            said.append(once(text))
        except Unreadable as error:
            said.append(str(error))
        if len(said) > 1 and said[-1] == said[-2]:
            break
    if isinstance(said[-1], str):
        raise Unreadable(said[-1])
    return said[-1]


def once(text):
    # The interpreter alone, without a machine, takes lengths and zeros for inches.
    lengths = {**LENGTHS, **{k: sum(v) for k, v in WRITTEN.items()}}
    tools = "".join(f"T{number} P{number} Z{length / 25.4:.9f} D1\n" for number, length in lengths.items())
    systems = {1: OFFSETS[1], 2: OFFSETS[2], 7: OFFSETS[3]}
    zeros = {5221 + 20 * (n - 1) + axis: zero[axis] / 25.4 for n, zero in systems.items() for axis in range(3)}
    said = interpreter.interpret(text, tools, interpreter.parameters(zeros))
    if not said.whole:
        raise Unreadable("rs274: " + said.trouble(300))
    path, dwells, zero, length, plane, unit = [], [], OFFSETS[1], 0.0, 1, 1.0
    at = None
    for line in said.calls.splitlines():
        match = CALL.search(line)
        if not match:
            continue
        kind, body = match.groups()
        number = lambda: [float(v) for v in re.findall(r"-?\d+\.?\d*", body)]
        # What it prints is in the unit in force.
        if kind == "USE_LENGTH_UNITS":
            was, unit = unit, 25.4 if "INCH" in body else 1.0
            at = at and [v * was / unit for v in at]
        elif kind == "SET_G5X_OFFSET":
            zero = tuple(v * unit for v in number()[1:4])
        elif kind == "USE_TOOL_LENGTH_OFFSET":
            length = number()[2] * unit
        elif kind == "SELECT_PLANE":
            plane = {"XY": 1, "YZ": 2, "XZ": 3}[re.search(r"(XY|YZ|XZ)", body).group(1)]
        elif kind == "DWELL":
            dwells.append(round(number()[0], 4))
        elif kind in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            at = number()[:3]
            place = tuple(at[i] * unit + zero[i] + (length if i == 2 else 0.0) for i in range(3))
            path.append((kind == "STRAIGHT_FEED", *place))
        elif kind == "ARC_FEED":
            first, second, first_c, second_c, turns, end = number()[:6]
            u, v, n = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}[plane]
            a = math.atan2(at[v] - second_c, at[u] - first_c)
            b = math.atan2(second - second_c, first - first_c)
            sweep = (b - a) % (2 * math.pi) if turns > 0 else -((a - b) % (2 * math.pi))
            if abs(sweep) < 1e-9:
                sweep = math.copysign(2 * math.pi, turns)
            r = math.hypot(at[u] - first_c, at[v] - second_c)
            steps, start = max(4, int(abs(sweep) / 0.05)), list(at)
            for k in range(1, steps + 1):
                here = [0.0] * 3
                here[u] = first_c + r * math.cos(a + sweep * k / steps)
                here[v] = second_c + r * math.sin(a + sweep * k / steps)
                here[n] = start[n] + (end - start[n]) * k / steps
                path.append((True, *(here[i] * unit + zero[i] + (length if i == 2 else 0.0) for i in range(3))))
            at = [0.0] * 3
            at[u], at[v], at[n] = first, second, end
    return path, dwells


def walked(path, step=0.7):
    """Points along a path, no further apart than `step`; what is no longer than a correction is no move."""
    points, kept = [], path[:1]
    for move in path[1:]:
        if math.dist(move[1:], kept[-1][1:]) > 0.05:
            kept.append(move)
    path = kept
    for (_, *a), (cuts, *b) in zip(path, path[1:]):
        far = math.dist(a, b)
        pieces = max(1, int(far / step))
        points += [(cuts, *(a[i] + (b[i] - a[i]) * k / pieces for i in range(3))) for k in range(1, pieces + 1)]
    return points


def far(a, b):
    """How far the points of a lie from b at most, walked in order: each from the first of b that is near."""
    most, at = 0.0, 0
    for cuts, *p in a:
        best, where = math.inf, at
        for k in range(max(0, at - 3), min(len(b), at + 500)):
            if b[k][0] != cuts:
                continue
            d = math.dist(p, b[k][1:])
            if d < best - 1e-9:
                best, where = d, k
            if d <= APART_MM:
                break
        most, at = max(most, best), where
    return most


def compare(reference, output):
    a, b = rs274(reference), rs274(output)
    # Where a move begins before all axes were named is not known to either.
    first, second = walked(a[0][1:]), walked(b[0][1:])
    problems = []
    apart = max(far(first, second), far(second, first))
    if apart > APART_MM:
        problems.append(f"path {apart:.3f} mm")
    if math.dist(a[0][-1][1:], b[0][-1][1:]) > NEAR_MM:
        problems.append("end")
    if a[1] != b[1]:
        problems.append(f"dwells {a[1]} {b[1]}")
    return problems


# ---- the controls' words in LinuxCNC's ------------------------------------------------------------------------------


def okuma(line):
    line = re.sub(r"^(O[A-Z0-9]+|N[A-Z][A-Z0-9]*)\b", "", line)
    if re.match(r"\s*G71\b", line):
        return ""
    line = re.sub(r"\bG15\s*H0*([12])\b", lambda m: "G54" if m.group(1) == "1" else "G55", line)
    line = re.sub(r"\bG56\b", "G43", re.sub(r"\bG53\b", "G49", line))
    line = re.sub(r"\bM5[34]\b|\bG13[01]\b[^(]*|\bG10\b", "", line)
    line = re.sub(r"\bG30\s*P1\b", "G30", line)
    return re.sub(r"\bG4\s*F", "G4 P", line).replace("=", "")


def mach(line):
    line = re.sub(r"^O\d+", "", line)
    line = re.sub(r"\bG70\b", "G20", re.sub(r"\bG71\b", "G21", line))
    return re.sub(r"\bG54\.1\s*P1\b", "G59.1", line)


def mitsubishi(line):
    line = re.sub(r"^(%|:|O)\d*", "", line)
    if re.match(r"\s*G10\s*L1[0-3]\b", line):
        return ""
    line = re.sub(r"\bG54\.1\s*P1\b", "G59.1", line)
    line = re.sub(r"\bG120\.1[^(]*|\b(G121|G8\s*P[01])\b", "", line)
    # Thousandths of a second, of a dwell and of a cycle.
    return re.sub(r"\bP(\d+)\b", lambda m: f"P{int(m.group(1)) / 1000}", line)


CONTROLS = {"okuma": okuma, "mach": mach, "mitsubishi": mitsubishi}


def in_linuxcnc(text, control):
    lines = [re.sub(r"\(.*?\)", "", line).strip() for line in text.splitlines()]
    lines = [CONTROLS[control](line) for line in lines if not line.startswith("%")]
    return "\n".join(lines) + "\nM2\n"


# ---- random parts --------------------------------------------------------------------------------------------------


class Part:
    """A part in the control's words and in LinuxCNC's."""

    def __init__(self, rng, control):
        self.rng, self.control = rng, control
        self.own, self.other = [], []
        self.level, self.subprograms, self.length = None, [], None

    def both(self, line):
        self.own.append(line)
        self.other.append(line)

    def num(self, low, high):
        return word(self.rng.uniform(low, high))

    def point(self, z=None):
        return f"X{self.num(5, 70)} Y{self.num(5, 70)}" + (f" Z{self.num(*z)}" if z else "")

    def write(self):
        rng = self.rng
        head = {"okuma": "OPART", "mach": "(MACH)", "mitsubishi": "%\n:0100"}[self.control]
        self.own.append(head)
        self.both("G17 G21 G90 G94 G40")
        if self.control == "mitsubishi" and rng.random() < 0.5:
            self.own += [f"G10 L10 P7 R{WRITTEN[7][0]}", f"G10 L11 P7 R{WRITTEN[7][1]}", "G10 L12 P7 R5."]
            self.length = 7
        self.offset()
        self.tool()
        for _ in range(rng.randint(4, 10)):
            rng.choice([self.lines, self.arc, self.holes, self.holes, self.increments, self.offset, self.tool, self.inch,
                        self.dwell, self.modes, self.subprogram, self.plane, self.variables])()
        self.both("G0 Z60.")
        self.own.append("M30")
        self.other.append("M2")
        for lines in self.subprograms:
            self.own += lines
        if self.control == "mitsubishi":
            self.own.append("%")
        return "\n".join(self.own) + "\n", "\n".join(self.other) + "\n"

    def home(self):
        self.both(f"G0 {self.point()} Z60.")

    def offset(self):
        number = self.rng.choice([1, 2] if self.control == "okuma" else [1, 2, 3])
        self.own.append(f"G15 H{number}" if self.control == "okuma" else {1: "G54", 2: "G55", 3: "G54.1 P1"}[number])
        self.other.append({1: "G54", 2: "G55", 3: "G59.1"}[number])
        self.home()

    def tool(self):
        number = self.length if self.length and self.rng.random() < 0.5 else self.rng.choice([1, 2])
        if self.rng.random() < 0.3:
            self.own.append("G53" if self.control == "okuma" else "G49")
            self.other.append("G49")
        else:
            self.own.append(f"G56 H{number}" if self.control == "okuma" else f"G43 H{number}")
            self.other.append(f"G43 H{number}")
        self.home()

    def lines(self):
        self.both(f"G1 {self.point((10, 20))} F{self.num(100, 400)}")
        for _ in range(self.rng.randint(1, 3)):
            self.both(self.rng.choice([self.point(), f"X{self.num(5, 70)}", self.point((8, 20))]))
        self.both("G0 Z60.")

    def arc(self):
        self.both("G1 X30. Y30. Z15. F200.")
        turn, t, r = self.rng.choice([2, 3]), self.rng.uniform(0.4, 6.0), self.rng.uniform(4, 14)
        end = (30 - r + r * math.cos(t), 30 + r * math.sin(t))
        z = f" Z{self.num(8, 14)}" if self.rng.random() < 0.4 else ""
        if self.rng.random() < 0.4:
            self.both(f"G{turn} X{self.num(33, 38)} Y{self.num(31, 36)}{z} R{self.rng.choice(['', '-'])}{self.num(10, 30)}")
        else:
            self.both(f"G{turn} X{end[0]:.4f} Y{end[1]:.4f}{z} I{-r:.4f} J0.")
        self.both("G0 Z60.")

    def plane(self):
        self.both("G1 X20. Y20. Z20. F200.")
        self.both("G18")
        self.both(f"G{self.rng.choice([2, 3])} X28. Z26. R{self.num(7, 14)}")
        self.both("G17")
        self.both("G0 Z60.")

    def increments(self):
        self.both("G1 X20. Y20. Z20. F200.")
        self.both("G91")
        self.both(f"G1 X{self.num(-5, 5)} Y{self.num(-5, 5)} Z{self.num(-2, 2)}")
        self.both("G90")
        self.both("G0 Z60.")

    def inch(self):
        self.own.append("G70" if self.control == "mach" and self.rng.random() < 0.5 else "G20")
        self.other.append("G20")
        self.both("G0 X1.2 Y0.8 Z2.4")
        self.both(f"G1 X{self.num(0.3, 2.4)} Z{self.num(1, 2)} F9.")
        self.own.append("G71" if self.control == "mach" and self.rng.random() < 0.5 else "G21")
        self.other.append("G21")
        self.both("F200.")
        self.home()

    def dwell(self):
        self.own.append({"okuma": "G4 F0.5", "mach": "G4 P0.5", "mitsubishi": "G4 P500"}[self.control])
        self.other.append("G4 P0.5")

    def modes(self):
        self.own.append(self.rng.choice({
            "okuma": ["G131 F4000. J1", "G61", "M8", "G64"],
            "mach": ["G61", "G64", "M8", "M48"],
            "mitsubishi": ["G61.1", "G8 P1", "G120.1 P1 Q1", "M8", "G64"],
        }[self.control]))

    def holes(self):
        places = [self.point() for _ in range(self.rng.randint(1, 3))]
        near, bottom = self.rng.uniform(18, 24), self.rng.uniform(2, 12)
        pecks = self.rng.random() < 0.4
        peck = f" Q{self.num(2, 6)}" if pecks else ""
        code = "G83" if pecks else self.rng.choice(["G81", "G82"])
        self.both(f"G0 Z{self.num(50, 60)}")
        words = f"Z{bottom:.3f} R{near:.3f}{peck}"
        feed = f"F{self.num(50, 150)}"
        if self.control == "okuma":
            to_level = self.rng.random() < 0.6
            back = self.rng.uniform(25, 50)
            if to_level:
                self.own.append(f"G71 Z{back:.3f}")
            dwell = " P0" if code == "G82" else ""
            self.own.append(f"{code} {places[0]} {words}{dwell} {feed} M5{3 if to_level else 4}")
            self.own += places[1:] + ["G80"]
            # What the manual says of it, in moves.
            self.other.append(feed)
            for place in places:
                self.other += [f"G0 {place}", f"G0 Z{near:.3f}"]
                reached = near
                while True:
                    reached = max(bottom, reached - float(peck[2:])) if pecks else bottom
                    self.other.append(f"G1 Z{reached:.3f}")
                    if reached <= bottom:
                        break
                    self.other += [f"G0 Z{near:.3f}", f"G0 Z{min(reached + 0.254, near):.3f}"]
                self.other.append(f"G0 Z{back if to_level else near:.3f}")
        else:
            level = self.rng.choice(["G98", "G99"])
            dwell = {"mach": (" P0.2", " P0.2"), "mitsubishi": (" P200", " P0.2")}[self.control] if code == "G82" else ("", "")
            self.own.append(f"{level} {code} {places[0]} {words}{dwell[0]} {feed}")
            self.other.append(f"{level} {code} {places[0]} {words}{dwell[1]} {feed}")
            for place in places[1:]:
                self.both(place)
            self.both("G80")
        self.both("G0 Z60.")

    def variables(self):
        """A loop by a variable, or by GOTO."""
        if self.control == "mach":
            first, by = self.rng.randint(1, 20), self.num(0.5, 3)
            self.own += [f"#101={first}", f"#102=[#101*2+{by}]", "G1 X#102 Z[#101/2] F200.", "G0 Z60."]
            self.other += [f"G1 X{first * 2 + float(by):.4f} Z{first / 2:.4f} F200.", "G0 Z60."]
            return
        times, step = self.rng.randint(1, 4), self.rng.randint(2, 9)
        name = {"okuma": "VC1", "mitsubishi": "#101"}[self.control]
        label = 7000 + len(self.own)
        self.both("G1 X20. Y20. Z20. F200.")
        word = f"X={name}*{step}+1" if self.control == "okuma" else f"X[{name}*{step}+1]"
        self.own += [f"{name}=0", f"N{label} {name}={name}+1", word, "Y30."]
        self.own.append(f"IF [{name} LT {times}] {'N' if self.control == 'okuma' else 'GOTO '}{label}")
        for k in range(1, times + 1):
            self.other += [f"X{k * step + 1}.", "Y30."]
        self.both("G0 Z60.")

    def subprogram(self):
        number = {"okuma": 500, "mach": 100, "mitsubishi": 31000}[self.control] + len(self.subprograms)
        times = self.rng.randint(1, 3)
        self.both("G1 X20. Y20. Z20. F200.")
        body = ["G91", f"G1 X{self.num(2, 6)}", f"Y{self.num(-3, 3)}", "G90"]
        okuma = self.control == "okuma"
        name = f"OP{number % 100}A" if okuma and self.rng.random() < 0.5 else f"O{number}"
        self.own.append(f"CALL {name} Q{times}" if okuma else f"M98 P{number} L{times}")
        self.other += body * times
        self.subprograms.append([name, *body, "RTS" if okuma else "M99"])
        self.both("G0 Z60.")


def self_test():
    """Right outputs pass, wrong ones fail."""
    head = "G17 G21 G90 G54\nG0 X10. Y10. Z60.\nG1 Z20. F200.\n"
    pairs = [
        ("okuma", "G15 H2\nG0 X5. Y5. Z60.", "G55\nG0 X5. Y5. Z60.", "G54\nG0 X5. Y5. Z60."),
        ("okuma", "G56 H1\nG0 Z60.", "G43 H1\nG0 Z60.", "G0 Z60."),
        ("okuma", "G1 X30.\nG53\nG0 Z60.", "G1 X30.\nG49\nG0 Z60.", "G1 X31.\nG49\nG0 Z60."),
        ("mach", "G70\nG0 X1. Y1. Z2.\nG71", "G20\nG0 X1. Y1. Z2.\nG21", "G21\nG0 X1. Y1. Z2."),
        ("mach", "G54.1 P1\nG0 X5. Y5. Z60.", "G59.1\nG0 X5. Y5. Z60.", "G55\nG0 X5. Y5. Z60."),
        ("mitsubishi", "G10 L10 P7 R95.5\nG43 H7\nG0 Z60.", "G43 H7\nG0 Z60.", "G43 H1\nG0 Z60."),
        ("mitsubishi", "G4 P500\nG1 X30.", "G4 P0.5\nG1 X30.", "G1 X30."),
        ("mitsubishi", "G2 X30. Y30. R20.", "G2 X30. Y30. R20.", "G3 X30. Y30. R20."),
        ("mitsubishi", "G1 X30.\nX10.\nX30.", "G1 X30.\nX10.\nX30.", "G1 X30."),
    ]
    bad = 0
    for control, own, right, wrong in pairs:
        output = in_linuxcnc(head + own, control)
        found = [compare(head + text + "\nM2\n", output) for text in (right, wrong)]
        if found[0] or not found[1]:
            bad += 1
            print("self-test:", control, own.replace("\n", " | "), found)
    print(f"self-test: {len(pairs)} pairs, {bad} misjudged")
    return bad


def one(case):
    control, number = case.number.split("-")
    own, other = Part(random.Random(f"{case.options.seed}/{control}/{number}"), control).write()
    names = {1: "G15H1", 2: "G15H2"} if control == "okuma" else {1: "G54", 2: "G55", 3: "G54.1P1"}
    mill = profile.crooked_mill(control)
    mill["tool"]["lengths_mm"] = {"H1": 120.0, "H2": 80.5}
    mill["work_offsets_mm"].update({name: OFFSETS[k] for k, name in names.items()})
    case.write("in.nc", own)
    case.write("in.ngc", other)
    flags = ["-m", mill.write(case.folder), "--zero", "true", "-d", control]
    flags += [] if control == "mach" else ["--decimal", "increments"]
    done = case.correct(*flags, about=control + " ")
    if not done:
        return
    try:
        for problem in compare(other, in_linuxcnc(done[0], control)):
            case.find("wrong", problem)
    except (Unreadable, IndexError) as error:
        case.find("unreadable", repr(error))
        return
    case.check(bool(case.found), *flags)
    case.tally[f"{control} within"] += not case.found


def main():
    given = options.parser(__doc__, 100, "first").parse_args()
    bad = self_test() if given.self_test else 0
    return int(bool(bad)) | cases.campaign(given, one, [f"{control}-{n}" for control in CONTROLS for n in cases.asked(given)])


if __name__ == "__main__":
    sys.exit(main())
