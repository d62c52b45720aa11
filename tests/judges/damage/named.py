"""Single cases of known faults: one small program each, and what must become of it."""

import os
import resource
import subprocess
import time

from common import folders

import referee
from machine import Machine
from reader import Reader, Unreadable

LINE = 'axis.{0} = {{ travel_mm = [-100, 600], resolution_mm = {2}{1} }}\n'
# Work without end is work beyond this.
SECONDS, BYTES = 20, 2 << 30


def write_profile(folder, control, play=(0, 0, 0), tilt=0.0, resolution=0.001, rotary="", chain="[w X Y b Z t]", negative=0.0):
    """A machine that is straight but for play, a tilt of Z against X (urad), and positioning of X that differs downwards (um)."""
    text = f'format = 1\nname = "named"\ncontrol = "{control}"\nchain = "{chain}"\n'
    for axis, size in zip("XYZ", play):
        more = f", backlash_um = {size}" if size else ""
        if negative and axis == "X":
            more = ', errors = "X.csv", errors_negative = "X_negative.csv"'
            for name, value in (("X.csv", 0.0), ("X_negative.csv", negative)):
                folders.put(folder, name, f"position_mm,EXX_um\n-100,{value}\n600,{value}\n")
        text += LINE.format(axis, more, resolution)
    if tilt:
        text += f"squareness = {{ EB0Z_urad = {tilt} }}\n"
    text += rotary + "work_offsets_mm = { G54 = [100, 100, 100] }\ntool = { default_mm = [0, 0, -90] }\n"
    path = os.path.join(folder, "machine.toml")
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    return path


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))


class Named:
    """One case: a folder with program and profile."""

    def __init__(self, command, keep, name):
        self.command, self.name = command, name
        self.folder = os.path.join(keep, "named-" + "".join(c if c.isalnum() else "-" for c in name))
        os.makedirs(self.folder, exist_ok=True)

    def file(self, name, lines):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
        return path

    def run(self, *arguments):
        begin = time.monotonic()
        try:
            done = subprocess.run([self.command.path, *arguments], capture_output=True, timeout=SECONDS, check=False, preexec_fn=limited)
        except subprocess.TimeoutExpired:
            return None, f"no answer within {SECONDS} s"
        self.took = time.monotonic() - begin
        return done.returncode, (done.stderr + done.stdout).decode(errors="replace")

    def correct(self, lines, start=(20.0, 20.0, 400.0), arguments=()):
        """(exit status, messages, failures in words); the output is judged and checked."""
        profile = os.path.join(self.folder, "machine.toml")
        into, out = self.file("in.nc", lines), os.path.join(self.folder, "out.nc")
        options = ["-m", profile, "--zero", "true", "--start-at=" + ",".join(map(str, start)), *arguments]
        status, text = self.run(into, *options, "-o", out)
        if status != 0:
            return status, text, []
        machine = Machine(profile)

        def read(path):
            with open(path, "rb") as file:
                return Reader(machine.dialect, machine.offsets, machine.lengths, machine.default_tool, start).read(file.read())

        try:
            found = referee.judge(read(into), read(out), machine, start).failures
        except Unreadable as error:
            found = [f"unreadable: {error}"]
        status, said = self.run("check", into, out, *options)
        if status != 0:
            found.append("check: " + " / ".join(said.splitlines()[-3:]))
        return 0, text, found


HEAD = ["G21 G17 G40 G49 G80 G90 G94 G54", "G0 X0. Y0. Z60.", "X10. Y10. Z50.", "S1000 M3"]


def small_pecks(case):
    """Q0.0000001 is a count of pecks without end: an answer, soon and in little memory, whether refused or not."""
    bad = []
    for control in ("fanuc", "linuxcnc", "perspektiva"):
        # Upright (a cycle stays a cycle) and leaning (holes are written as moves).
        for tilt in (0.0, 800.0):
            write_profile(case.folder, control, tilt=tilt)
            lines = HEAD + ["G99 G83 X20. Y20. Z-40. R2. Q0.0000001 F100.", "G80", "G0 Z50.", "M30"]
            into = case.file("in.nc", lines)
            for verb in (("-o", os.path.join(case.folder, "out.nc")), ("check",)):
                extra = ["check", into, into] if verb[0] == "check" else [into, *verb]
                status, text = case.run(*extra, "-m", os.path.join(case.folder, "machine.toml"), "--zero", "true")
                if status not in (0, 1):
                    bad.append(f"{control}, tilt {tilt:g} urad, {verb[0]}: status {status}: {text.strip()[-120:]}")
    return bad


def coarse_arcs(case):
    """Arcs written at 0.01 mm satisfy LinuxCNC's own tolerance (its interpreter takes 28 um at R 7, 30 um at R 40): corrected."""
    bad = []
    for control in ("linuxcnc", "fanuc", "perspektiva"):
        write_profile(case.folder, control, play=(4, 4, 4), tilt=40.0)
        for name, words, code in (("14 um at R 7", ["G1 X20. Y20. F300.", "G2 X29.98 Y20. I5. J-5."], 0), ("30 um at R 40", ["G1 X20. Y60. F300.", "G3 X100.03 Y60. I40. J0."], 0)):
            lines = HEAD + ["G0 Z5.", "X20. Y20.", "G1 Z-1. F100."] + words + ["G0 Z50.", "M30"]
            status, text, found = case.correct(lines)
            if status != code and control == "linuxcnc":
                bad.append(f"{control}, {name}: refused: {text.splitlines()[0]}")
            elif status not in (0, 1):
                bad.append(f"{control}, {name}: status {status}")
            bad += [f"{control}, {name}: {f}" for f in found]
    # What no control takes stays refused.
    write_profile(case.folder, "linuxcnc")
    status, text, found = case.correct(HEAD + ["G0 Z5.", "X20. Y20.", "G1 Z-1. F100.", "G2 X30.3 Y20. I5. J-5.", "G0 Z50.", "M30"])
    if status != 1:
        bad.append("linuxcnc, ends 0.2 mm off the circle: not refused")
    return bad


def rotary_feed(case):
    """A feed of a rotary axis alone: refused, or corrected; its check must not pass what goes elsewhere."""
    bad = []
    # What stands still as the axis turns, as its location does, asks nothing of the linear axes: an error that grows does.
    rotary = '[rotary.A]\ncentre_mm = [150, 150, 100]\nerrors = "A.csv"\n'
    case.file("A.csv", ["position_deg,EYA_um", "-120,-60", "0,0", "120,60"])
    profile = write_profile(case.folder, "fanuc", chain="[w A X Y b Z t]")
    with open(profile, encoding="ascii") as file:
        text = file.read()
    with open(profile, "w", encoding="ascii") as file:
        file.write(text + rotary)
    for feed in (["G1 A60. F500."], ["G93", "G1 A60. F2.", "G94"]):
        lines = [HEAD[0], "G0 A0."] + HEAD[1:] + ["G0 Z5.", "G1 Z1. F100."] + feed + ["G0 Z50.", "M30"]
        into, out = case.file("in.nc", lines), os.path.join(case.folder, "out.nc")
        status, said = case.run(into, "-m", profile, "--zero", "true", "-o", out)
        if status == 0:
            with open(out, encoding="latin-1") as file:
                same = [line for line in file.read().splitlines() if "A60" in line and "X" not in line and "Y" not in line]
            if same:
                bad.append(f"{feed[-1] if len(feed) == 1 else 'G93'}: written unchanged, exit status 0")
        elif status != 1:
            bad.append(f"status {status}: {said[:80]}")
        # The same program with another angle is another part.
        other = case.file("other.nc", [line.replace("A60.", "A61.") for line in lines])
        status, _ = case.run("check", into, other, "-m", profile, "--zero", "true")
        if status == 0:
            bad.append(f"check passes A61 for A60 ({'G93' if len(feed) > 1 else 'G94'})")
        status, _ = case.run("check", into, into, "-m", profile, "--zero", "true")
        if status == 0:
            bad.append(f"check passes a rotary feed that no correction was made of, the centre 36 um off ({'G93' if len(feed) > 1 else 'G94'})")
    return bad


def turned_with_play(case):
    """G68 where the turned words leave each axis' direction unchanged: corrected."""
    write_profile(case.folder, "fanuc", play=(6, 6, 6), tilt=40.0)
    lines = HEAD + ["G68 X0. Y0. R30.", "G0 X30. Y10.", "Z5.", "G1 Z-1. F100.", "X60. Y40.", "X70. Y60.", "G0 Z50.", "G69", "G0 X10. Y10. Z60.", "M30"]
    status, text, found = case.correct(lines)
    return [f"refused: {text.splitlines()[0]}"] if status else found


def inverse_take_up(case):
    """G93 on a machine with play: F of what is added is in proportion, not of eleven digits."""
    write_profile(case.folder, "fanuc", play=(10, 10, 10))
    lines = HEAD + ["G0 Z5.", "G1 Z-1. F100.", "G1 X40. F300.", "G93", "G1 X20. F5.", "G1 X30. F5.", "G94", "G0 Z50.", "M30"]
    status, text, found = case.correct(lines)
    if status:
        return [f"refused: {text.splitlines()[0]}"]
    with open(os.path.join(case.folder, "out.nc"), encoding="latin-1") as file:
        words = [w for line in file for w in line.split() if w.startswith("F") and len(w) > 8]
    return found + [f"F of {len(w)} characters: {w}" for w in words[:2]]


def coarse_play(case):
    """A take-up move that rounds to less than the play: counted, or refused. Output step 0.01 mm, play 14 um."""
    write_profile(case.folder, "fanuc", play=(14, 14, 14), resolution=0.01)
    lines = HEAD + ["G0 Z5.", "G1 Z-1. F100.", "G1 X40. F300.", "X20.", "Y30.", "Y10.", "X30. Y30.", "X10. Y10.", "G0 Z50.", "M30"]
    status, text, found = case.correct(lines)
    if status:
        return []
    # Half a step of 0.01 mm on three axes is 8.66 um, the tolerance 1: the referee allows for 0.001 mm, so judge by check.
    return [f for f in found if f.startswith("check")]


def negative_reversal(case):
    """Coming from above stands 10 um lower than from below: no play, a step at each turn; corrected without leaving the path, or refused."""
    write_profile(case.folder, "fanuc", negative=-10.0)
    lines = HEAD + ["G0 Z5.", "G1 Z-1. F100.", "G1 X40. F300.", "X20.", "X50. Y30.", "G0 Z50.", "M30"]
    status, text, found = case.correct(lines)
    if status == 1:
        return ["refused by inf um"] if "inf um" in text else []
    return found


def compensated_with_play(case):
    """Under G41 no block may be added, a take-up of 10 um least of all: the control would offset it by the radius."""
    write_profile(case.folder, "fanuc", play=(10, 10, 10))
    lines = HEAD + ["G0 Z5.", "G1 Z-1. F100.", "G41 D1 G1 X30. F300.", "Y40.", "X10.", "Y20.", "G40 X5. Y10.", "G0 Z50.", "M30"]
    status, text, found = case.correct(lines)
    return found if status == 0 else []


def bore_sideways(case):
    """G85 feeds out: where Z stands elsewhere in Y on its way up (EYZ differs by 6 um), the hole is two holes."""
    write_profile(case.folder, "fanuc")
    path = os.path.join(case.folder, "machine.toml")
    for name, value in (("Z.csv", 0.0), ("Z_negative.csv", 6.0)):
        case.file(name, ["position_mm,EYZ_um", f"-100,{value}", f"600,{value}"])
    with open(path, encoding="ascii") as file:
        text = file.read().replace("axis.Z = { travel_mm = [-100, 600]", 'axis.Z = { travel_mm = [-100, 600], errors = "Z.csv", errors_negative = "Z_negative.csv"')
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    lines = HEAD + ["G0 Z20.", "G99 G85 X20. Y20. Z-10. R2. F100.", "X40.", "G80", "G0 Z50.", "M30"]
    status, text, found = case.correct(lines)
    return [] if status else found


CASES = (small_pecks, coarse_arcs, rotary_feed, turned_with_play, inverse_take_up, coarse_play, negative_reversal, compensated_with_play, bore_sideways)


def run(command, keep):
    """(name, what is wrong) of each case that does not hold."""
    out = []
    for case in CASES:
        name = case.__name__.replace("_", " ")
        found = case(Named(command, keep, name))
        print(f"named case: {name:24} {'holds' if not found else 'FAILS'}", flush=True)
        out += [(name, text) for text in found]
    return out
