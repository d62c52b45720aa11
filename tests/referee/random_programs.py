#!/usr/bin/python3
"""Random programs through the product and the referee: what is corrected must hold, what is refused is counted.

    /usr/bin/python3 tests/referee/random_programs.py --vpost target/release/vpost --count 300

Prints one line per program that does not hold and a table at the end. Exit status: 0 none, 1 some, 2 usage.
"""

import argparse
import collections
import math
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from interpreter import INCH, Unreadable  # noqa: E402
from machine import AXES, OutsideVolume  # noqa: E402
from referee import judge, load_machine  # noqa: E402

PROFILE = """\
format = 1
name = "Random programs"
control = "linuxcnc"
chain = "[w X Y b Z t]"
axis.X = { travel_mm = [-3000, 3000], resolution_mm = 0.001, errors = "X.csv" }
axis.Y = { travel_mm = [-3000, 3000], resolution_mm = 0.001, errors = "Y.csv" }
axis.Z = { travel_mm = [-3000, 3000], resolution_mm = 0.001, errors = "Z.csv" }
squareness = { EC0Y_urad = 1100, EB0Z_urad = 440, EA0Z_urad = -500 }
work_offsets_mm = { G54 = [10, 20, 30], G55 = [-35, 12.5, 7] }
"""
PLANES = {17: (0, 1, "IJ"), 18: (2, 0, "KI"), 19: (1, 2, "JK")}
ORDER = "NGXYZIJKRQPFM"


def write_machine(folder):
    """A machine of wavy tables, 12 um and 25 urad, over a volume that no random program leaves."""
    for axis in AXES:
        header = [f"E{direction}{axis}_um" for direction in "XYZ"] + [f"E{direction}{axis}_urad" for direction in "ABC"]
        lines = ["position_mm," + ",".join(header)]
        for at in range(-3000, 3001, 25):
            shifts = [12 * math.sin(at / 90 * (k + 1) + ord(axis)) for k in range(3)]
            turns = [25 * math.sin(at / 130 * (k + 1) + ord(axis) + k) for k in range(3)]
            lines.append(f"{at}," + ",".join(f"{value:.4f}" for value in shifts + turns))
        with open(os.path.join(folder, f"{axis}.csv"), "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
    path = os.path.join(folder, "machine.toml")
    with open(path, "w", encoding="ascii") as file:
        file.write(PROFILE)
    return path


class Program:
    """One random program in some post's style."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        pick = self.random.choice
        self.style, self.separator, self.end = pick(["fixed", "point", "free", "short"]), pick([" ", ""]), pick(["\n", "\r\n"])
        self.numbered, self.inch = self.random.random() < 0.4, self.random.random() < 0.2
        self.unit, self.decimals = (INCH, 4) if self.inch else (1.0, 3)
        self.labels = 0
        self.lines, self.at, self.mode, self.plane, self.incremental = [], [0.0] * 3, 0, 17, False
        self.block("G20" if self.inch else "G21", "G17", "G90", "G54")
        self.block("S1000", "M3")
        self.straight(0, range(3), lambda _: self.random.uniform(-200, 200), ["G0"])
        self.block("F400")
        for _ in range(self.random.randint(5, 40)):
            self.step()
        self.block("M30")
        self.text = self.end.join(self.lines) + self.end

    def number(self, mm):
        text = f"{mm / self.unit:.{self.decimals}f}"
        if self.style != "fixed":
            text = text.rstrip("0")
        if self.style == "free":
            text = text.rstrip(".")
        if self.style == "short" and text.startswith("0.") and len(text) > 2:
            text = text[1:]
        return "0" if text in ("-0.000", "-0.0000", "-0.", "-0", ".", "") else text

    def grid(self, mm):
        return round(mm / self.unit, self.decimals) * self.unit

    def block(self, *words):
        number = [f"N{10 * len(self.lines) + 10}"] if self.numbered else []
        self.lines.append(self.separator.join(number + list(words)))

    def word(self, axis, to):
        return AXES[axis] + self.number(to - self.at[axis] if self.incremental else to)

    def code(self, code):
        again = code != self.mode or self.random.random() < 0.3
        self.mode = code
        return [self.random.choice([f"G{code}", f"G0{code}"])] if again else []

    def straight(self, code, axes, place, codes=None, tail=()):
        to = list(self.at)
        for axis in axes:
            to[axis] = self.grid(place(axis))
        words = codes if codes is not None else self.code(code)
        self.mode = code
        self.block(*words, *(self.word(axis, to[axis]) for axis in axes), *tail)
        self.at = to

    def near(self, axis):
        reach = self.random.choice([1, 50])
        return self.at[axis] + self.random.uniform(-reach, reach)

    def step(self):
        choice = self.random.random()
        if choice < 0.05:
            self.incremental = not self.incremental
            self.block("G91" if self.incremental else "G90")
        elif choice < 0.10:
            self.plane = self.random.choice([17, 18, 19])
            self.block(f"G{self.plane}")
        elif choice < 0.16:
            self.block(*self.random.choice([["M8"], ["M9"], ["(note)"], ["S2000"], ["G4", "P0.2"]]))
        elif choice < 0.20 and not self.incremental and self.plane == 17:
            self.cycle()
        elif choice < 0.23 and not self.incremental:
            self.block("G93")
            for _ in range(3):
                self.straight(1, range(3), self.near, ["G1"], [f"F{self.random.randint(3, 50)}"])
            self.block("G94")
            self.block("F200")
        elif choice < 0.26 and not self.incremental:
            self.frame()
        elif choice < 0.31 and not self.incremental:
            self.flow()
        elif choice < 0.65:
            axes = [axis for axis in range(3) if self.random.random() < 0.6] or [self.random.randrange(3)]
            tail = ["M9"] if self.random.random() < 0.05 else []
            self.straight(0 if choice < 0.41 else 1, axes, self.near, None, tail)
        else:
            self.arc(self.random.choice([2, 3]))

    def cycle(self):
        """A drilling cycle of one to five holes.

        G85 and G89 only under G99: under G98 LinuxCNC feeds up to the initial level, other controls to R.
        """
        kind = self.random.choice(["G81", "G82 P0.1", f"G83 Q{self.number(3)}", f"G73 Q{self.number(4)}", "G85", "G89 P0.1"])
        back = "G99" if kind[:3] in ("G85", "G89") else self.random.choice(["G98", "G99"])
        near = self.grid(self.at[2] - self.random.uniform(0, 5))
        deep = self.grid(near - self.random.uniform(2, 9))
        head, *rest = kind.split()
        hole = [self.grid(self.at[axis] + self.random.uniform(-30, 30)) for axis in (0, 1)]
        self.block(back, head, self.word(0, hole[0]), self.word(1, hole[1]), self.word(2, deep), "R" + self.number(near), *rest, "F120")
        for _ in range(self.random.randint(0, 4)):
            axis = self.random.randrange(2)
            hole[axis] = self.grid(hole[axis] + self.random.uniform(-20, 20))
            self.block(self.word(axis, hole[axis]))
        self.block("G80")
        self.at[2] = self.grid(self.at[2] + 5)
        self.at[:2] = hole
        self.straight(0, range(3), lambda axis: self.at[axis], ["G0"])

    def frame(self):
        """Another work offset, or a shift of all; then a place in all axes."""
        shift = [AXES[axis] + self.number(self.grid(self.random.uniform(-30, 30))) for axis in range(3)]
        self.block(*self.random.choice([["G54"], ["G55"], ["G52", *shift], ["G52", "X0", "Y0", "Z0"], ["G92.1"]]))
        self.straight(0, range(3), lambda _: self.random.uniform(-150, 150), ["G0"])

    def flow(self):
        """A loop, a repetition, a condition, a subroutine, an expression; then a place in all axes."""
        self.labels += 1
        name, turns = f"o{self.labels}", self.random.randint(1, 5)
        a, b = (f"{self.random.uniform(-9, 9) / self.unit:.3f}" for _ in range(2))
        bodies = [
            [f"#{self.labels}=0", f"{name} while [#{self.labels} LT {turns}]", f"G1 X[{a}+#{self.labels}*0.5] Y[{b}*SIN[#{self.labels}*30]]",
             f"#{self.labels}=[#{self.labels}+1]", f"{name} endwhile"],
            [f"{name} repeat [{turns}]", f"G91 G1 X{a} Y{b}", f"{name} endrepeat", "G90"],
            [f"#<w>=[{a}*2]", f"{name} if [#<w> GT 0]", "G1 X[#<w>/3]", f"{name} else", "G1 Y[ABS[#<w>]]", f"{name} endif"],
            [f"{name} sub", "G1 X#1 Y[#2-#1]", f"{name} endsub"] + [f"{name} call [{a}] [{b}]"] * turns,
            [f"G1 X[SQRT[{turns}]] Y[[{a}+{b}]/4] Z[{turns}**2/9]"],
        ]
        # O-words take no block number.
        self.lines += self.random.choice(bodies)
        self.mode = 1
        self.straight(0, range(3), lambda _: self.random.uniform(-150, 150), ["G0"])

    def arc(self, code):
        u, v, letters = PLANES[self.plane]
        radius, angle = self.random.uniform(*self.random.choice([(0.5, 5), (5, 60)])), self.random.uniform(0, 2 * math.pi)
        centre = [self.grid(radius * math.cos(angle)), self.grid(radius * math.sin(angle))]
        radius, start = math.hypot(*centre), math.atan2(-centre[1], -centre[0])
        to, sweep = list(self.at), None if self.random.random() < 0.2 else self.random.uniform(0.2, 6.0)
        words = self.code(code)
        if sweep is not None:
            end = start + (sweep if code == 3 else -sweep)
            to[u] = self.grid(self.at[u] + centre[0] + radius * math.cos(end))
            to[v] = self.grid(self.at[v] + centre[1] + radius * math.sin(end))
            words += [self.word(u, to[u]), self.word(v, to[v])]
        if self.random.random() < 0.3:
            to[3 - u - v] = self.grid(self.at[3 - u - v] + self.random.uniform(-10, 10))
            words.append(self.word(3 - u - v, to[3 - u - v]))
        if sweep is not None and sweep < 2.8 and self.random.random() < 0.3:
            words.append("R" + self.number(radius))
        else:
            words += [letter + self.number(value) for letter, value in zip(letters, centre)]
        self.block(*sorted(words, key=lambda word: ORDER.index(word[0])))
        self.at = to


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--vpost", required=True, metavar="COMMAND")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    table = collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        profile = write_machine(folder)
        machine = load_machine(profile, [], [])
        path = os.path.join(folder, "program.ngc")
        for seed in range(arguments.seed, arguments.seed + arguments.count):
            program = Program(seed)
            with open(path, "wb") as file:
                file.write(program.text.encode())
            try:
                done = subprocess.run([arguments.vpost, path, "-m", profile, "--zero", "true"], capture_output=True, check=False, timeout=20)
            except subprocess.TimeoutExpired:
                table["FAILED"] += 1
                print(f"seed {seed}: no answer within 20 s", flush=True)
                continue
            if done.returncode == 1:
                table["refused: " + done.stderr.decode(errors="replace").split("\n")[0]] += 1
                continue
            if done.returncode != 0:
                failures = [f"exit status {done.returncode}"]
            else:
                try:
                    resolution_um = 0.001 * INCH if program.inch else 1.0
                    failures = judge(program.text.encode(), done.stdout, machine, 1.0, resolution_um)["failures"]
                except (Unreadable, OutsideVolume) as error:
                    failures = [f"{type(error).__name__}: {error}"]
            table["FAILED" if failures else "held"] += 1
            if failures:
                print(f"seed {seed}: {failures[0]}", flush=True)
    for name, count in table.most_common():
        print(f"{count:6} {name}")
    return 1 if table["FAILED"] or not table["held"] else 0


if __name__ == "__main__":
    sys.exit(main())
