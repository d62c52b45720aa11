"""A program as LinuxCNC's interpreter understands it: straight feeds, arcs and rapids with full doubles.

Codes that move nothing (M, S, T) and tool lengths (G43, G49, H) are taken out of the text first, because
the interpreter's Python module stops on some of them; they are kept here as events of their line.
Line numbers stay those of the file.
"""

import math
import os
import re
import tempfile

from curves import SAME_MM, Fault, Reader

INCH = 25.4
WORD = re.compile(r"([A-Z])\s*([-+]?\s*(?:\d[\d\s]*\.?[\d\s]*|\.\s*\d[\d\s]*))")
LENGTHS = frozenset("XYZIJKRQ")
AFTER_MOTION = frozenset(["M0", "M1", "M2", "M5", "M9", "M30", "M60"])
OFFSETS = ["", "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"]
# Planes as LinuxCNC numbers them: indices of the first, second and normal axis.
PLANES = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}


class Unreadable(Exception):
    """The interpreter refuses the program."""


class Move:
    """One canonical motion; positions in machine coordinates, the tool's length not included."""

    __slots__ = ("rapid", "line", "start", "end", "arc", "feed", "tool", "exempt", "named", "own", "known", "start_known")

    def __init__(self, rapid, line, start, end, arc, feed):
        self.rapid, self.line, self.start, self.end, self.arc, self.feed = rapid, line, start, end, arc, feed


class Arc:
    """A helix about a plane's normal whose radius goes evenly from its start's to its end's."""

    __slots__ = ("axes", "centre", "angle", "sweep", "radii", "heights", "length")

    def __init__(self, start, end, axes, centre, turns):
        u, v, w = axes
        self.axes, self.centre = axes, centre
        du, dv = start[u] - centre[0], start[v] - centre[1]
        eu, ev = end[u] - centre[0], end[v] - centre[1]
        self.angle = math.atan2(dv, du)
        sweep = math.atan2(ev, eu) - self.angle
        full = 2.0 * math.pi
        if turns > 0:
            sweep = sweep % full
            if sweep < 1e-9:
                sweep += full
            sweep += full * (turns - 1)
        else:
            sweep = -((-sweep) % full)
            if sweep > -1e-9:
                sweep -= full
            sweep -= full * (-turns - 1)
        self.sweep = sweep
        self.radii = (math.hypot(du, dv), math.hypot(eu, ev))
        self.heights = (start[w], end[w])
        self.length = math.hypot(abs(sweep) * 0.5 * sum(self.radii), end[w] - start[w])

    def at(self, t):
        """Point at a share of the way."""
        u, v, w = self.axes
        angle = self.angle + t * self.sweep
        radius = self.radii[0] + t * (self.radii[1] - self.radii[0])
        p = [0.0, 0.0, 0.0]
        p[u] = self.centre[0] + radius * math.cos(angle)
        p[v] = self.centre[1] + radius * math.sin(angle)
        p[w] = self.heights[0] + t * (self.heights[1] - self.heights[0])
        return tuple(p)


def number(text):
    return float(re.sub(r"\s", "", text))


def strip_comments(line, semicolon=True):
    """The line without comments; an unclosed bracket ends it."""
    out, at = [], 0
    while at < len(line):
        if line[at] == "(":
            close = line.find(")", at)
            at = len(line) if close < 0 else close + 1
            out.append(" ")
        elif line[at] == ";" and semicolon:
            break
        else:
            out.append(line[at])
            at += 1
    return "".join(out)


class Text:
    """The lines for the interpreter, and per line what was taken out of them."""

    def __init__(self, raw, least_increment=None):
        lines = re.split(r"\r*\n|\r", raw.decode("latin-1").replace("\0", ""))
        self.lines, self.events, self.tool, self.exempt, self.words = [], {}, {}, set(), {}
        # Axes that may stand anywhere after a line: reference returns, tool changes.
        self.lost = {}
        percent, executable, tool = 0, False, None
        # Curves have a line in their place here; `as_posted` is the text with them.
        self.as_posted, curves = [], Reader()
        self.curves = curves.curves
        # G43 H0 is the tool in the spindle: the last T when M6 came.
        selected, loaded = None, None
        for number_, line in enumerate(lines, 1):
            bare = strip_comments(line).strip().upper().lstrip("/")
            if bare.startswith("%"):
                percent += 1
                bare = ""
                if percent > 1 and executable:
                    break
            if not executable and bare and WORD.sub("", bare).strip():
                bare = ""  # a name or a leader, not a block
            if re.match(r"[O:]\s*\d+\s*$", bare):
                bare = ""
            executable = executable or bool(bare)
            if any(mark in bare for mark in "#[<") or bare.startswith("O"):
                self.lines.append(bare)
                self.as_posted.append(bare)
                self.tool[number_] = tool
                continue
            kept = []
            letters = set()
            words = [(letter, number(value), value) for letter, value in WORD.findall(bare)]
            codes = [f"G{value:g}" for letter, value, _ in words if letter == "G"]
            selected = next((value for letter, value, _ in words if letter == "T"), selected)
            if ("M", 6.0) in ((letter, value) for letter, value, _ in words):
                loaded = selected
            if "G43" in codes:
                tool = next((f"H{value:g}" for letter, value, _ in words if letter == "H"), tool)
                if tool == "H0" and loaded:
                    tool = f"H{loaded:g}"
                if tool is None:
                    raise Unreadable(f"line {number_}: G43 without H")
            if "G49" in codes or tool == "H0":
                tool = None
            if {"G53", "G28", "G30"} & set(codes):
                self.exempt.add(number_)
                self.lost[number_] = {letter for letter, _, _ in words if letter in "XYZ"}
            if ("M", 6.0) in ((letter, value) for letter, value, _ in words):
                self.lost[number_] = set("XYZ")
            positions = not {"G4", "G10", "G92", "G52"} & set(codes)
            events = []
            for letter, value, text in words:
                name = f"{letter}{value:g}"
                if letter in "MST":
                    events.append(name)
                elif letter in "HDN" or name in ("G43", "G49", "G96", "G97"):
                    pass
                else:
                    if letter in LENGTHS and least_increment is not None and "." not in text and positions:
                        text = f"{value / 10**least_increment:.{least_increment}f}"
                    kept.append(f"{letter}{text}")
                    if positions:
                        letters.add(letter)
            if events:
                self.events[number_] = events
            self.words[number_] = letters
            self.tool[number_] = tool
            self.as_posted.append(" ".join(kept))
            try:
                instead = curves.line(number_, words)
            except (Fault, KeyError, TypeError) as fault:
                raise Unreadable(f"line {number_}: {fault!r}") from None
            if instead is not None:
                kept = [f"{letter}{text}" for letter, text in instead]
                self.words[number_] = {letter for letter, _ in instead}
            self.lines.append(" ".join(kept))


class Canon:
    """Receives canonical motion from the interpreter."""

    def __init__(self, folder):
        self.parameter_file = os.path.join(folder, "fresh.var")
        self.moves = []
        self.line = 0
        self.position = (0.0, 0.0, 0.0)
        self.offset, self.g92, self.plane, self.feed = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1, 0.0
        # (seconds, line, moves before it): of G4 and of cycles.
        self.dwells = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: None

    def check_abort(self):
        return False

    def get_external_length_units(self):
        return 1.0 / INCH

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7

    def get_block_delete(self):
        return False

    def get_tool(self, pocket):
        return (-1,) + (0.0,) * 12 + (0,)

    def next_line(self, code):
        self.line = code.sequence_number

    def set_g5x_offset(self, _, *values):
        self.offset = tuple(value * INCH for value in values[:3])

    def set_g92_offset(self, *values):
        self.g92 = tuple(value * INCH for value in values[:3])

    def set_xy_rotation(self, angle):
        if angle:
            raise Unreadable(f"line {self.line}: the program turns its frame")

    def set_plane(self, plane):
        self.plane = plane

    def set_feed_rate(self, feed):
        self.feed = feed * INCH

    def dwell(self, seconds):
        self.dwells.append((f"dwell {seconds:g}", self.line, len(self.moves)))

    def machine(self, values):
        return tuple(v * INCH + g + o for v, g, o in zip(values, self.g92, self.offset))

    def add(self, rapid, end, arc=None):
        self.moves.append(Move(rapid, self.line, self.position, end, arc, 0.0 if rapid else self.feed))
        self.position = end

    def straight_traverse(self, *values):
        self.add(True, self.machine(values))

    def straight_feed(self, *values):
        self.add(False, self.machine(values))

    def rigid_tap(self, *values):
        self.add(False, self.machine(values))

    def arc_feed(self, first, second, centre1, centre2, turns, height, *_):
        axes = PLANES[self.plane]
        raw, centre = [0.0] * 3, [0.0] * 3
        for axis, end, middle in zip(axes, (first, second, height), (centre1, centre2, 0.0)):
            raw[axis], centre[axis] = end, middle
        end, centre = self.machine(raw), self.machine(centre)
        start = self.position
        self.add(False, end, Arc(start, end, axes, (centre[axes[0]], centre[axes[1]]), turns))


def write_offsets(path, offsets):
    """The work offsets as the interpreter's parameters, inches.

    It must know them itself: where a program changes its offset and then leaves an axis out, that axis stays in the
    machine, and what it says of that axis afterwards depends on both offsets.
    """
    with open(path, "w", encoding="ascii") as file:
        for index, name in enumerate(OFFSETS):
            for axis, value in enumerate(offsets.get(name, ())):
                file.write(f"{5201 + 20 * index + axis}\t{value / INCH!r}\n")


def parse(lines, offsets):
    """What the interpreter makes of a text."""
    import gcode  # of the package linuxcnc-uspace

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "program.ngc")
        with open(path, "w", encoding="latin-1") as file:
            file.write("\n".join(lines) + "\nM2\n")
        canon = Canon(folder)
        write_offsets(canon.parameter_file, offsets)
        result, line = gcode.parse(path, canon, "G21 G17 G40 G49 G80 G90 G94", "")
        if result > gcode.MIN_ERROR:
            raise Unreadable(f"line {line}: {gcode.strerror(result)}")
    return canon


def evaluated_alike(text, moves, as_posted):
    """Holds the evaluation of each curve here against LinuxCNC's own."""
    for number, curve in text.curves.items():
        (start, end), *more = [(move.start, move.end) for move in moves if move.line == number]
        found = [move.end for move in as_posted if move.line == number]
        expected = curve.at_its_places(start, end)
        # It adds up its steps, and may come to the end twice.
        if len(found) == len(expected) + 1:
            del found[-2]
        if more or len(found) != len(expected):
            raise Unreadable(f"line {number}: {len(found)} places of a curve, {len(expected)} were expected")
        u, v = curve.axes
        worst = max(math.hypot(a[u] - b[0], a[v] - b[1]) for a, b in zip(found, expected))
        if worst > SAME_MM:
            raise Unreadable(f"line {number}: LinuxCNC evaluates the curve {worst} mm aside")


def interpret(raw, offsets, least_increment=None):
    """Moves and events of a program.

    Events are (name, line, index of the move before which it happens).
    """
    text = Text(raw, least_increment)
    canon = parse(text.lines, offsets)
    moves = []
    for move in canon.moves:
        curve = None if move.rapid else text.curves.get(move.line)
        if curve is None:
            moves.append(move)
            continue
        start = move.start
        for end in curve.path(move.start, move.end):
            moves.append(Move(False, move.line, start, end, None, move.feed))
            start = end
    if text.curves and all(curve.linuxcnc for curve in text.curves.values()):
        evaluated_alike(text, canon.moves, parse(text.as_posted, offsets).moves)
    if text.curves and canon.dwells:
        raise Unreadable("a dwell in a program with curves")
    canon.moves = moves
    known = set()
    last = 0
    before = False
    for move in canon.moves:
        # Positions count from where every axis has been programmed.
        for line in range(last + 1, move.line + 1):
            known |= text.words.get(line, set()) & set("XYZ")
            known -= text.lost.get(line, set())
        last = max(last, move.line)
        move.start_known, move.known = before and len(known) == 3, len(known) == 3
        before = move.known
        move.tool = text.tool.get(move.line)
        move.exempt = move.line in text.exempt
        # What such a line does not name stays where it was: where the correction has put it.
        move.named = text.lost.get(move.line) or set("XYZ")
        # Of a block without such words (a cycle's repetition, say) all axes count.
        bare = re.sub(r"\([^)]*\)|;.*", "", text.lines[move.line - 1]).upper() if move.line <= len(text.lines) else ""
        move.own = [axis for axis, letter in enumerate("XYZ") if re.search(letter + r"\s*[-+.\d#\[]", bare)] or [0, 1, 2]
    events, index = [], 0
    for line in sorted(text.events):
        while index < len(canon.moves) and canon.moves[index].line < line:
            index += 1
        after = index
        while after < len(canon.moves) and canon.moves[after].line <= line:
            after += 1
        for name in text.events[line]:
            events.append((name, line, after if name in AFTER_MOTION else index))
    # A dwell stands where the interpreter put it, the words of a line before it.
    return canon.moves, sorted(events + canon.dwells, key=lambda event: event[2])
