#!/usr/bin/env python3
"""Judge of five axes on a real control: programs on LinuxCNC's `xyzac-trt-kins`, on tables that lie and lean
elsewhere.

    five_axis.py --vpost target/release/vpost --programs 20 [--seed 1] [--keep DIR]

A table that tilts about X and turns about Z, its axes displaced and leaning (ISO 230-7, the body goes with its axis),
under crooked X, Y and Z. Programs feed at indexed angles and while both rotary axes turn; as a post without tool
centre point control writes them (identity kinematics) and under M428, LinuxCNC's switch to it. What the joints were
told each millisecond is put through the machine here: the tip as the workpiece sees it must be no farther from the
programmed path than the summary says, the control's part and a twentieth of a micrometre added (six decimals of
commands and the order of small turns). Exit status 1 where it is, or a program is refused.
"""

import math
import random
import sys

import numpy as np

import campaign
import judge
import rig
from machine import AXES, Machine

LENGTH_MM = 100.0
TURN_MM = np.array([200.0, 180.0, 0.0])  # a point of C's line, where the tip is counted
SADDLE_MM = np.array([0.0, 15.0, 130.0])  # from there to A's line
ZERO_MM = np.array([200.0, 180.0, 160.0])
SLACK_UM = 0.05
STEP = 400  # places of a block on the programmed path
REMAP = "o<{name}remap>sub\nM68 E3 Q{kind}\nM66 E0 L0\no<{name}remap>endsub\nM2\n"


def turn(axis, degrees):
    """Right-handed about an axis (0: X, 2: Z): (n, 3, 3)."""
    angle = np.radians(np.atleast_1d(degrees))
    found = np.zeros((len(angle), 3, 3))
    u, v = (axis + 1) % 3, (axis + 2) % 3
    found[:, axis, axis] = 1.0
    found[:, u, u] = found[:, v, v] = np.cos(angle)
    found[:, u, v], found[:, v, u] = -np.sin(angle), np.sin(angle)
    return found


def lean(urad):
    """A small turn by three angles, to second order."""
    a, b, c = np.array(urad) * 1e-6
    cross = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    return np.eye(3) + cross + cross @ cross / 2


class Table(Machine):
    """Linear errors of a Machine, location errors of A and C: shifts in um, leans in urad, along and about X, Y, Z."""

    def __init__(self, chance):
        super().__init__(chance)
        shift, angle = (lambda: chance.uniform(-60, 60)), (lambda: chance.uniform(-80, 80))
        self.shift_um = {"A": [0.0, shift(), shift()], "C": [shift(), shift(), 0.0]}
        self.lean_urad = {"A": [0.0, angle(), angle()], "C": [angle(), angle(), 0.0]}
        self.centre_mm = {"A": TURN_MM + SADDLE_MM, "C": TURN_MM + [0.0, 0.0, 90.0]}

    def in_workpiece(self, tips, joints, crooked):
        """Places of the tip in machine mm as the workpiece sees them, which lies as the machine does with both at 0."""
        for name, axis, column in (("A", 0, 3), ("C", 2, 4)):
            centre = self.centre_mm[name]
            body = turn(axis, joints[:, column])
            shift = np.zeros(3)
            if crooked:
                body, shift = lean(self.lean_urad[name]) @ body, np.array(self.shift_um[name]) * 1e-3
            tips = np.einsum("nij,nj->ni", np.linalg.inv(body), tips - centre - shift) + centre
        return tips

    def ideal_mm(self, joints):
        return self.in_workpiece(joints[:, :3] - [0.0, 0.0, LENGTH_MM], joints, crooked=False)

    def tip_mm(self, joints):
        tips = joints[:, :3] + self.error_mm(joints[:, :3]) - [0.0, 0.0, LENGTH_MM]
        return self.in_workpiece(tips, joints, crooked=True)

    def write(self, folder):
        """Its profile: the control has the centres of the drawing."""
        path = super().write(folder)
        kept = [line for line in path.read_text().splitlines() if not line.startswith(("work_offsets_mm", "chain"))]
        lines = [*kept, 'chain = "[w C A b X Y Z t]"', f"tool = {{ lengths_mm = {{ H1 = {LENGTH_MM} }} }}"]
        lines.append(f'work_offsets_mm = {{ G54 = {{ at = {ZERO_MM.tolist()}, zero = "true" }} }}')
        for name in "AC":
            keys = [f"centre_mm = {self.centre_mm[name].tolist()}", 'tilt = "body"', "travel_deg = [-720, 720]"]
            keys.append("resolution_deg = 0.0001")
            for number, axis in enumerate(AXES):
                if self.shift_um[name][number]:
                    keys.append(f"E{axis}0{name}_um = {self.shift_um[name][number]:.6f}")
                if self.lean_urad[name][number]:
                    keys.append(f"E{'ABC'[number]}0{name}_urad = {self.lean_urad[name][number]:.6f}")
            lines += [f"[rotary.{name}]", *keys]
        centres = ", ".join(f"{name} = {self.centre_mm[name].tolist()}" for name in "AC")
        lines += ["[kinematics]", 'straight = "tip"', f"centres_mm = {{ {centres} }}"]
        lines += ['on = ["M428"]', 'off = ["M429"]']
        path.write_text("\n".join(lines) + "\n")
        return path


def control():
    """LinuxCNC with that table: switched by M428 and M429 as in its own example."""
    hal = [
        "net kinstype motion.analog-out-03 motion.switchkins-type",
        "net length motion.tooloffset.z xyzac-trt-kins.tool-offset",
        f"setp xyzac-trt-kins.y-offset {SADDLE_MM[1]}",
        f"setp xyzac-trt-kins.z-offset {SADDLE_MM[2]}",
        *(f"setp xyzac-trt-kins.{axis}-rot-point {place}" for axis, place in zip("xyz", TURN_MM)),
    ]
    remaps = [f"M42{digit} modalgroup=10 ngc=42{digit}remap" for digit in (8, 9)]
    called = {f"42{digit}remap.ngc": REMAP.format(name=f"42{digit}", kind=kind) for digit, kind in ((8, 1), (9, 0))}
    return rig.Control(
        {"G54": tuple(ZERO_MM)},
        axes="XYZAC",
        kinematics="xyzac-trt-kins sparm=identityfirst",
        lengths_mm={1: LENGTH_MM},
        hal=tuple(hal),
        settings={"RS274NGC": {"HAL_PIN_VARS": 1, "REMAP": remaps}},
        called=called,
    )


class Program:
    """Blocks, and the tip's path in the workpiece (machine mm), by a table without errors."""

    def __init__(self, table, tip_control):
        self.table, self.tip_control = table, tip_control
        self.blocks = ["G21 G90 G17 G40 G49 G80 G54 G94", "G61", "T1 M6", "G0 A0 C0", "G43 H1"]
        self.at = np.zeros(5)
        self.pieces = []
        self.begun = False

    def to(self, code, f=None, **to):
        """X, Y, Z in program mm, A and C in degrees."""
        words = {axis: round(float(place), 3) for axis, place in to.items()}
        before = self.at.copy()
        for axis, place in words.items():
            self.at["xyzac".index(axis)] = place
        self.blocks.append(" ".join([code, *(f"{axis.upper()}{place:.3f}" for axis, place in words.items())]) +
                           (f" F{f:.0f}" if f else ""))
        share = np.linspace(0, 1, STEP + 1)[:, None]
        way = before + share * (self.at - before)
        self.pieces.append(self.in_workpiece(way) if code == "G1" else self.in_workpiece(way[-1:]))

    def in_workpiece(self, way):
        """Program coordinates as places in the workpiece, machine mm: they are that under tip control."""
        if self.tip_control:
            return way[:, :3] + ZERO_MM
        joints = way.copy()
        joints[:, :3] += ZERO_MM + [0.0, 0.0, LENGTH_MM]
        return self.table.ideal_mm(joints)

    def begin(self, x, y, z, a, c):
        """Up, the angles, across, down; tip control from angles 0 on."""
        if not self.begun:
            self.to("G0", z=140)
            self.to("G0", x=0, y=0)
            if self.tip_control:
                self.blocks.append("M428")
                self.to("G0", x=0, y=0, z=140)
            self.begun = True
        self.to("G0", z=140)
        self.to("G0", a=a, c=c)
        self.to("G0", x=x, y=y)
        self.to("G0", z=z + 3)
        self.to("G1", f=1500, z=z)

    def text(self):
        self.to("G0", z=140)
        self.to("G0", a=0, c=0)
        self.blocks += (["M429"] if self.tip_control else []) + ["G49", "M5", "M2"]
        return ("\n".join(self.blocks) + "\n").encode()

    def path(self):
        return np.vstack(self.pieces)


def indexed(program, chance):
    """Contours at three pairs of angles."""
    for _ in range(3):
        a, c = chance.uniform(-35, 35), chance.uniform(-170, 170)
        program.begin(chance.uniform(-25, 25), chance.uniform(-25, 25), chance.uniform(20, 30), a, c)
        for k in range(5):
            program.to("G1", x=chance.uniform(-30, 30), y=chance.uniform(-30, 30), f=3000 if k == 0 else None)
        program.to("G1", z=chance.uniform(30, 40))


def table_turns(program, chance):
    """C turns while the tip moves, A stands."""
    program.begin(25, 0, 25, chance.uniform(-25, 25), -90)
    for k in range(1, 19):
        program.to("G1", x=25 - 0.8 * k, y=6 * math.sin(k / 4), c=-90 + 10 * k, f=2000 if k == 1 else None)


def surface(program, chance):
    """Both turn, over short segments."""
    program.begin(-25, -20, 25, 10, 0)
    phase = chance.uniform(0, 6)
    for k in range(1, 61):
        program.to(
            "G1", x=-25 + 0.8 * k, y=-20 + 12 * math.sin(k / 15), z=25 + 3 * math.sin(k / 9),
            a=10 + 15 * math.sin(k / 20), c=30 * math.sin(k / 18 + phase) - 30 * math.sin(phase),
            f=2500 if k == 1 else None,
        )


def long_ways(program, chance):
    """A few long blocks in which both turn."""
    program.begin(-20, -20, 25, -10, 20)
    for k in range(5):
        program.to(
            "G1", x=chance.uniform(-30, 30), y=chance.uniform(-30, 30), z=chance.uniform(22, 35),
            a=chance.uniform(-30, 30), c=chance.uniform(-60, 60), f=2000 if k == 0 else None,
        )


KINDS = (indexed, table_turns, surface, long_ways)


def main():
    given = campaign.parser(__doc__, programs=8).parse_args()
    wrong, judged = [], 0
    print("program            before um  after um  said um  of the control um")
    for number in range(given.programs):
        chance = random.Random(f"five {given.seed} {number}")
        table = Table(chance)
        kind, tip_control = KINDS[number % len(KINDS)], number // len(KINDS) % 2 == 1
        program = Program(table, tip_control)
        kind(program, chance)
        text, name = program.text(), f"{number:02} {kind.__name__}{' M428' if tip_control else ''}"
        with campaign.folder(given.keep, f"seed{given.seed}_{number:02}") as folder:
            made, summary = judge.correct(given.vpost, table.write(folder), text, folder)
        if made is None:
            wrong.append(f"{name}: refused\n{summary}")
            continue
        recorded = rig.run({"a_posted": text, "b_corrected": made}, control())
        off = [
            judge.farthest(recorded[which], judge.feed_lines(words), table, program.path()) * 1e3
            for which, words in (("a_posted", text), ("b_corrected", made))
        ]
        said, of_control = summary["deviation_after_um"], summary["control_um"]
        judged += 1
        print(f"{name:18} {off[0]:9.2f} {off[1]:9.2f} {said:8.2f} {of_control}", flush=True)
        if of_control is None or off[1] > said + of_control + SLACK_UM:
            wrong.append(f"{name}: {off[1]:.2f} um off, said are {said:.2f} and {of_control} of the control")
    print("\n".join(wrong) if wrong else "none is farther off than was said")
    return 1 if wrong or not judged else 0


if __name__ == "__main__":
    sys.exit(main())
