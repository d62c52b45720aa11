"""LinuxCNC's motion controller without a screen: programs in, what the axes were told each millisecond out."""

import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
LIMITS = {"MAX_VELOCITY": 400, "MAX_ACCELERATION": 4000, "MIN_LIMIT": -2000, "MAX_LIMIT": 2000}
NOBODY = "65534"  # LinuxCNC refuses to run as root


def ini(folder):
    """Its settings."""
    sections = {
        "EMC": {"VERSION": "1.1", "MACHINE": "rig", "DEBUG": 0},
        "DISPLAY": {"DISPLAY": folder / "drive.py"},
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "RS274NGC": {"PARAMETER_FILE": folder / "rig.var"},
        "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": 4.0, "SERVO_PERIOD": 1000000},
        "EMCIO": {"EMCIO": "io", "CYCLE_TIME": 0.1, "TOOL_TABLE": folder / "tool.tbl"},
        "HAL": {"HALFILE": folder / "rig.hal"},
        "KINS": {"KINEMATICS": "trivkins coordinates=XYZ", "JOINTS": 3},
        "TRAJ": {
            "COORDINATES": "X Y Z",
            "LINEAR_UNITS": "mm",
            "ANGULAR_UNITS": "degree",
            "MAX_LINEAR_VELOCITY": LIMITS["MAX_VELOCITY"],
            "MAX_LINEAR_ACCELERATION": LIMITS["MAX_ACCELERATION"],
        },
    }
    home = {key: 0 for key in ("HOME", "HOME_OFFSET", "HOME_SEARCH_VEL", "HOME_LATCH_VEL", "HOME_SEQUENCE")}
    for number, axis in enumerate("XYZ"):
        sections[f"AXIS_{axis}"] = LIMITS
        sections[f"JOINT_{number}"] = {"TYPE": "LINEAR", **LIMITS, "FERROR": 100, "MIN_FERROR": 100, **home}
    lines = []
    for name, keys in sections.items():
        lines += [f"[{name}]", *(f"{key} = {value}" for key, value in keys.items())]
    return "\n".join(lines) + "\n"


def run(programs, zero_mm):
    """Runs programs (name: text) with G54 at `zero_mm`; what was recorded of each: x, y, z in mm, line."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="rig"))
    try:
        for name in ("drive.py", "rig.hal"):
            shutil.copy(HERE / name, folder / name)
        (folder / "rig.ini").write_text(ini(folder))
        offsets = [f"{5221 + axis}\t{place:.6f}" for axis, place in enumerate(zero_mm)]
        (folder / "rig.var").write_text("\n".join(["5220\t1.000000", *offsets]) + "\n")
        (folder / "tool.tbl").write_text("")
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
            rows = (line.split()[1:5] for line in (folder / f"{name}.recorded").read_text().splitlines())
            recorded[name] = np.array([row for row in rows if len(row) == 4 and "overrun" not in row], dtype=float)
        return recorded
    finally:
        shutil.rmtree(folder, ignore_errors=True)
