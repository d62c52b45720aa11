"""LinuxCNC's motion controller without a screen: programs in, what the axes were told each millisecond out."""

import dataclasses
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
LIMITS = {"MAX_VELOCITY": 400, "MAX_ACCELERATION": 4000, "MIN_LIMIT": -2000, "MAX_LIMIT": 2000}
QUICK = LIMITS | {"MAX_VELOCITY": 2000, "MAX_ACCELERATION": 40000}  # where only the places count at which it stops
NOBODY = "65534"  # LinuxCNC refuses to run as root
OFFSETS = ("G54", "G55", "G56", "G57", "G58", "G59")


@dataclasses.dataclass
class Control:
    """What a machine builder sets: zeros of work offsets (machine mm by name), axes, kinematics, speeds (mm/s, mm/s2),
    lengths of tools (mm by number), further lines of the HAL file, settings by section, subprograms by name."""

    zeros_mm: dict
    axes: str = "XYZ"
    kinematics: str = "trivkins coordinates=XYZ"
    limits: dict = dataclasses.field(default_factory=lambda: LIMITS)
    lengths_mm: dict = dataclasses.field(default_factory=dict)
    hal: tuple = ()
    settings: dict = dataclasses.field(default_factory=dict)
    called: dict = dataclasses.field(default_factory=dict)

    def joints_hal(self):
        """Axes that follow their commands, which the sampler records before the line."""
        lines = [f"loadrt sampler depth=60000 cfg={'f' * len(self.axes)}s", "addf sampler.0 servo-thread"]
        for number, axis in enumerate(self.axes):
            pins = f"joint.{number}.motor-pos-cmd joint.{number}.motor-pos-fb sampler.0.pin.{number}"
            lines.append(f"net {axis.lower()} {pins}")
        lines.append(f"net line motion.program-line sampler.0.pin.{len(self.axes)}")
        return "\n".join([*lines, *self.hal]) + "\n"

    def parameters(self, scale=1.0):
        """LinuxCNC's parameter file; `scale` is a millimetre in the file's unit of length."""
        rows = ["5220\t1.000000"]
        for name, zero in sorted(self.zeros_mm.items()):
            first = 5221 + 20 * OFFSETS.index(name)
            rows += [f"{first + axis}\t{place * scale:.9f}" for axis, place in enumerate(zero)]
        return "\n".join(rows) + "\n"

    def tools(self, scale=1.0):
        """LinuxCNC's tool table; diameters stand in the programs."""
        return "".join(f"T{number} P{number} Z{length * scale:.9f}\n" for number, length in self.lengths_mm.items())


def ini(folder, control):
    """Its settings."""
    sections = {
        "EMC": {"VERSION": "1.1", "MACHINE": "rig", "DEBUG": 0},
        "DISPLAY": {"DISPLAY": folder / "drive.py"},
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "RS274NGC": {"PARAMETER_FILE": folder / "rig.var", "SUBROUTINE_PATH": folder / "called"},
        "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": 4.0, "SERVO_PERIOD": 1000000},
        "EMCIO": {"EMCIO": "io", "CYCLE_TIME": 0.1, "TOOL_TABLE": folder / "tool.tbl"},
        "HAL": {"HALFILE": [folder / "rig.hal", folder / "joints.hal"]},
        "KINS": {"KINEMATICS": control.kinematics, "JOINTS": len(control.axes)},
        "TRAJ": {
            "COORDINATES": " ".join(control.axes),
            "LINEAR_UNITS": "mm",
            "ANGULAR_UNITS": "degree",
            "MAX_LINEAR_VELOCITY": control.limits["MAX_VELOCITY"],
            "MAX_LINEAR_ACCELERATION": control.limits["MAX_ACCELERATION"],
        },
    }
    for name, keys in control.settings.items():
        sections[name] = sections.get(name, {}) | keys
    home = {key: 0 for key in ("HOME", "HOME_OFFSET", "HOME_SEARCH_VEL", "HOME_LATCH_VEL", "HOME_SEQUENCE")}
    for number, axis in enumerate(control.axes):
        sections[f"AXIS_{axis}"] = control.limits
        kind = "LINEAR" if axis in "XYZ" else "ANGULAR"
        sections[f"JOINT_{number}"] = {"TYPE": kind, **control.limits, "FERROR": 100, "MIN_FERROR": 100, **home}
    lines = []
    for name, keys in sections.items():
        lines.append(f"[{name}]")
        for key, values in keys.items():
            lines += [f"{key} = {value}" for value in (values if isinstance(values, list) else [values])]
    return "\n".join(lines) + "\n"


def rows(name, text, columns):
    """What the sampler wrote, a row a millisecond: axes, line. Refused where samples were lost."""
    found = [line.split() for line in text.splitlines()]
    if found and found[0] == ["overrun"]:
        found.pop(0)  # it counts what passed before it was started
    if found and len(found[-1]) != columns + 1:
        found.pop()  # it was ended while it wrote
    lost = [row for row in found if len(row) != columns + 1]
    numbers = np.array([row[0] for row in found if len(row) == columns + 1], dtype=int)
    if lost or (np.diff(numbers) != 1).any():
        raise RuntimeError(f"{name}: the sampler was overrun")
    return np.array([row[1:] for row in found], dtype=float)


def run(programs, control):
    """Runs programs (name: text); what was recorded of each: the axes in mm and degrees, line."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="rig"))
    try:
        for name in ("drive.py", "rig.hal"):
            shutil.copy(HERE / name, folder / name)
        (folder / "rig.ini").write_text(ini(folder, control))
        (folder / "joints.hal").write_text(control.joints_hal())
        (folder / "rig.var").write_text(control.parameters())
        (folder / "tool.tbl").write_text(control.tools())
        (folder / "called").mkdir()
        for name, text in control.called.items():
            (folder / "called" / name).write_text(text)
        (folder / "home").mkdir()
        for name, text in programs.items():
            (folder / f"{name}.ngc").write_bytes(text)
        as_nobody = []
        if os.getuid() == 0:
            as_nobody = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
            subprocess.run(["chown", "-R", f"{NOBODY}:{NOBODY}", folder], check=True)
        surroundings = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
        surroundings |= {"HOME": str(folder / "home"), "VPOST_RIG": str(folder)}
        ran = subprocess.run(
            [*as_nobody, "linuxcnc", folder / "rig.ini"], cwd=folder, env=surroundings, capture_output=True, text=True
        )
        recorded = {}
        for name in programs:
            said = folder / f"{name}.ran"
            if not said.exists() or said.read_text():
                why = said.read_text() if said.exists() else ran.stdout + ran.stderr
                raise RuntimeError(f"{name} did not run: {why}")
            text = (folder / f"{name}.recorded").read_text()
            recorded[name] = rows(name, text, len(control.axes) + 1)
        return recorded
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def starts():
    """Whether the controller runs a program here; the reason is printed where it does not."""
    try:
        return len(run({"start": b"G21 G90 G54 G61\nG1 X1 F6000\nM2\n"}, Control({"G54": (0.0, 0.0, 0.0)}))["start"]) > 0
    except (OSError, RuntimeError, subprocess.CalledProcessError) as why:
        print(why)
        return False


if __name__ == "__main__":
    raise SystemExit(0 if starts() else 1)
