"""What LinuxCNC's stand-alone interpreter (`rs274 -g`) makes of a program: canonical calls, in order."""

import math
import os
import pathlib
import re
import subprocess
import tempfile

import numpy as np

INCH_MM = 25.4  # the stand-alone interpreter takes its parameter file and its tool table in inches
STILL_MM = 2.6e-3  # inches are printed with four decimals
MARK = "HERE THE JUDGE LOOKS"
CALL = re.compile(r"^\s*\d+ N\S+\s+(\w+)\((.*)\)\s*$")
MOTIONS = ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "ARC_FEED")
# Calls that say nothing of the state behind them.
PASSING = {"COMMENT", "MESSAGE", "DWELL", "PROGRAM_STOP", "OPTIONAL_PROGRAM_STOP", "ON_RESET", "START_CHANGE"}
PASSING |= {"PROGRAM_END"}
OF_ONE_STATE = {
    "START_SPINDLE_CLOCKWISE": "spindle", "START_SPINDLE_COUNTERCLOCKWISE": "spindle",
    "STOP_SPINDLE_TURNING": "spindle", "FLOOD_ON": "flood", "FLOOD_OFF": "flood", "MIST_ON": "mist", "MIST_OFF": "mist",
}
AT_START = {"flood": ["FLOOD_OFF", ""], "mist": ["MIST_OFF", ""], "spindle": ["STOP_SPINDLE_TURNING", "0"]}
SHIFTS = ("SET_G5X_OFFSET", "SET_G92_OFFSET", "USE_TOOL_LENGTH_OFFSET")
PLANES = {"CANON_PLANE_XY": (0, 1, 2), "CANON_PLANE_YZ": (1, 2, 0), "CANON_PLANE_XZ": (2, 0, 1)}


class Refused(Exception):
    """The interpreter does not take the program."""


def calls(text, control):
    """Canonical calls (name, arguments) of a program; what the interpreter says of itself is left out."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "p.var").write_text(control.parameters(1 / INCH_MM))
        (folder / "p.tbl").write_text(control.tools(1 / INCH_MM))
        (folder / "p.ngc").write_bytes(text)
        command = ["rs274", "-g", "-t", folder / "p.tbl", "-v", folder / "p.var", folder / "p.ngc"]
        surroundings = os.environ | {"HOME": str(folder)}  # where it keeps its tools
        ran = subprocess.run(command, capture_output=True, text=True, cwd=folder, errors="replace", env=surroundings)
    found = [match.groups() for match in map(CALL.match, ran.stdout.splitlines()) if match]
    if ran.returncode or not any(name == "PROGRAM_END" for name, _ in found):
        raise Refused(ran.stderr.strip().replace("\n", " | "))
    return [(name, words) for name, words in found if not words.startswith('"interpreter: ')]


def marked(text, line):
    """The program with a mark before its line (1-based)."""
    lines = text.splitlines(keepends=True)
    return b"".join([*lines[: line - 1], f"({MARK})\n".encode(), *lines[line - 1 :]])


def numbered(text):
    """The program with a mark before each line, which says its number (1-based)."""
    lines = text.splitlines(keepends=True)
    marks = [b""] + [f"({MARK} {number})\n".encode() for number in range(2, len(lines) + 1)]
    return b"".join(part for pair in zip(marks, lines) for part in pair)


def numbers(words):
    return [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?|-?nan|-?inf", words)]


class Move:
    """A motion in machine mm (axis commands): corners of its path, the rapid or feed that it is; its line in a program
    that is `numbered`."""

    def __init__(self, name, corners, program_z, state, line):
        self.name, self.corners, self.program_z, self.state, self.line = name, corners, program_z, state, line

    def changes(self, axis):
        return abs(self.corners[:, axis] - self.corners[0, axis]).max() > STILL_MM


class Run:
    """Calls put into effect one by one: the state that they leave, and the way of the axes, machine mm."""

    def __init__(self, calls, chord_deg=1.0):
        self.chord = math.radians(chord_deg)
        self.state, self.unit, self.moves = dict(AT_START), 1.0, []
        self.at, self.line = np.zeros(3), 1
        self.shifts = {name: np.zeros(3) for name in SHIFTS}
        for name, words in calls:
            self.take(name, words)

    def shift(self):
        return sum(self.shifts.values())

    def take(self, name, words):
        """A call."""
        if name in MOTIONS:
            self.move(name, numbers(words))
            return
        if name == "COMMENT" and (mark := re.search(rf"{MARK} (\d+)", words)):
            self.line = int(mark[1])
        if name in PASSING:
            return
        if name == "USE_LENGTH_UNITS":
            self.unit = INCH_MM if "INCHES" in words else 1.0
        if name in self.shifts:
            values = numbers(words)
            self.shifts[name] = np.array(values[1:4] if name == "SET_G5X_OFFSET" else values[:3]) * self.unit
        self.state[OF_ONE_STATE.get(name, name)] = self.meaning(name, words)
        exact = "EXACT" in str(self.state.get("SET_MOTION_CONTROL_MODE"))
        if exact or self.state.get("SET_NAIVECAM_TOLERANCE") == [0.0]:
            self.state.pop("SET_NAIVECAM_TOLERANCE", None)

    def meaning(self, name, words):
        """What a call sets, in mm whatever the unit: equal where the state is equal."""
        if name in self.shifts:
            return [round(value, 3) for value in self.shifts[name]] + words.split(",")[:1] * (name == "SET_G5X_OFFSET")
        if name in ("SET_FEED_RATE", "SET_NAIVECAM_TOLERANCE"):
            return [round(value * self.unit, 3) for value in numbers(words)]
        if name == "SET_MOTION_CONTROL_MODE":
            return words.split(",")[:1] + [round(value * self.unit, 4) for value in numbers(words)]
        return [name, words] if name in OF_ONE_STATE else words

    def move(self, name, values):
        """Runs to where a motion leads."""
        shift = self.shift()
        if name == "ARC_FEED":
            corners = self.arc(np.array(values[:6]) * self.unit, round(values[4]), shift)
        else:
            corners = np.array([self.at, np.array(values[:3]) * self.unit + shift])
        self.at = corners[-1]
        self.moves.append(Move(name, corners, corners[:, 2] - shift[2], dict(self.state), self.line))

    def arc(self, values, turns, shift):
        """Corners of an arc: ends, centre in the plane in force, whole turns and sense, end along the third axis."""
        u, v, w = PLANES[self.state.get("SELECT_PLANE", "CANON_PLANE_XY")]
        end, centre = np.zeros(3), (values[2] + shift[u], values[3] + shift[v])
        end[u], end[v], end[w] = values[0] + shift[u], values[1] + shift[v], values[5] + shift[w]
        first = math.atan2(self.at[v] - centre[1], self.at[u] - centre[0])
        sweep = math.atan2(end[v] - centre[1], end[u] - centre[0]) - first
        sense = 1 if turns > 0 else -1
        sweep = sense * ((sense * sweep) % (2 * math.pi) if (sense * sweep) % (2 * math.pi) > 1e-9 else 2 * math.pi)
        sweep += sense * 2 * math.pi * (abs(turns) - 1)
        share = np.linspace(0, 1, max(2, math.ceil(abs(sweep) / self.chord) + 1))
        radii = [math.hypot(place[u] - centre[0], place[v] - centre[1]) for place in (self.at, end)]
        radius = radii[0] + (radii[1] - radii[0]) * share
        corners = np.empty((len(share), 3))
        corners[:, u] = centre[0] + radius * np.cos(first + sweep * share)
        corners[:, v] = centre[1] + radius * np.sin(first + sweep * share)
        corners[:, w] = self.at[w] + (end[w] - self.at[w]) * share
        corners[0], corners[-1] = self.at, end
        return corners

    def way(self):
        """Corners of all that was run, machine mm."""
        return np.vstack([move.corners for move in self.moves]) if self.moves else self.at[None, :]


def split(found):
    """Calls before the mark and behind it."""
    at = [k for k, (name, words) in enumerate(found) if name == "COMMENT" and MARK in words]
    if len(at) != 1:
        raise Refused(f"the line is run {len(at)} times")
    return found[: at[0]], found[at[0] + 1 :]
