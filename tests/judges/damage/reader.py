"""Reads an NC program of a mill (fanuc, linuxcnc, perspektiva) into what happens to the part.

The result is one list, in order, of motions and events. A motion has its ends as axis commands in mm, its arc, and the
process it runs under: feed, spindle, coolant, tool, compensation, kind of cycle. An event is what happens between two
motions: a dwell, an M code, an S or T word. Drilling cycles are written out as the motions that the control makes of them.
Written from the controls' manuals and docs/dialects.md; it shares nothing with the product.
"""

import math
import re

INCH = 25.4
WORD = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
AFTER_MOTION = {0, 1, 2, 5, 9, 30, 60}
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
CYCLES = {73, 74, 76, 81, 82, 83, 84, 85, 86, 88, 89}
SPINDLE_CYCLES = {74, 76, 84, 86, 88}
PECK_CLEARANCE = 0.254
CHIP_RETREAT = {"fanuc": 0.5, "linuxcnc": 0.254, "perspektiva": 0.5}
SAME_LEVEL = 1e-9


class Unreadable(Exception):
    """The program says something that this reader does not know."""


class Arc:
    """A helix about a plane's normal whose radius runs evenly with the angle from its start's to its end's."""

    __slots__ = ("axes", "centre", "angle", "sweep", "radii", "heights", "length")

    def __init__(self, start, end, axes, centre, clockwise, turns=1):
        u, v, w = axes
        self.axes, self.centre = axes, centre
        du, dv, eu, ev = start[u] - centre[0], start[v] - centre[1], end[u] - centre[0], end[v] - centre[1]
        self.radii = (math.hypot(du, dv), math.hypot(eu, ev))
        if min(self.radii) < 1e-9:
            raise Unreadable("an arc without a radius")
        self.angle = math.atan2(dv, du)
        full = 2 * math.pi
        sweep = (math.atan2(ev, eu) - self.angle) % full
        if clockwise:
            sweep = full - sweep if sweep > 0 else 0.0
        # Ends that lie on one ray, to a hundredth of a micrometre, are a whole turn.
        if sweep * self.radii[0] < 1e-5 or (full - sweep) * self.radii[0] < 1e-5:
            sweep = full
        sweep += full * (turns - 1)
        self.sweep = -sweep if clockwise else sweep
        self.heights = (start[w], end[w])
        self.length = math.hypot(sweep * 0.5 * sum(self.radii), end[w] - start[w])

    def at(self, t):
        u, v, w = self.axes
        angle, radius = self.angle + t * self.sweep, self.radii[0] + t * (self.radii[1] - self.radii[0])
        p = [0.0] * 3
        p[u], p[v] = self.centre[0] + radius * math.cos(angle), self.centre[1] + radius * math.sin(angle)
        p[w] = self.heights[0] + t * (self.heights[1] - self.heights[0])
        return tuple(p)


class Motion:
    """One motion; start and end as axis commands, an axis that nobody knows is None."""

    __slots__ = ("rapid", "start", "end", "arc", "process", "minutes", "tool", "line", "cycle", "step", "exempt", "peck")

    def __init__(self, rapid, start, end, arc, process, tool, line, step):
        self.rapid, self.start, self.end, self.arc, self.process = rapid, start, end, arc, process
        self.tool, self.line, self.step = tool, line, step
        self.minutes, self.cycle, self.exempt, self.peck = None, False, False, False

    @property
    def known(self):
        return None not in self.start and None not in self.end

    @property
    def length(self):
        if self.arc:
            return self.arc.length
        return math.dist(self.start, self.end) if self.known else 0.0


class Event:
    """Something that happens between two motions."""

    __slots__ = ("name", "line")

    def __init__(self, name, line):
        self.name, self.line = name, line


def split_lines(raw):
    return re.split(r"\r\n|\n|\r", raw.decode("latin-1"))


def bare(line, dialect):
    """The line without its comments, and the part behind a semicolon where that ends a block."""
    out, at, rest = [], 0, None
    while at < len(line):
        if line[at] == "(":
            close = line.find(")", at)
            at = len(line) if close < 0 else close + 1
            out.append(" ")
        elif line[at] == ";":
            rest = line[at + 1 :] if dialect == "fanuc" else None
            break
        else:
            out.append(line[at])
            at += 1
    return "".join(out), rest


class Reader:
    """State of the control while a program is read."""

    def __init__(self, dialect, offsets, lengths, default_tool, start=None):
        self.dialect, self.offsets, self.lengths, self.default_tool = dialect, offsets, lengths, default_tool
        self.items, self.line = [], 0
        self.at = list(start) if start else [None] * 3
        self.motion, self.plane, self.unit, self.absolute, self.feed_mode = 0 if dialect == "fanuc" else None, 17, 1.0, True, 94
        self.offset, self.h, self.length_on = "G54", None, False
        self.turn = None
        self.comp, self.d, self.f, self.s, self.spindle, self.coolant = 40, None, None, None, 5, frozenset()
        self.t, self.in_spindle, self.return_to = None, None, 98
        self.path_mode = 64
        self.hole = {}
        self.ended = False

    # lengths and frames

    def mm(self, letter, text):
        if self.dialect == "fanuc" and "." not in text:
            return float(text) * (0.001 if self.unit == 1.0 else 0.0001 * INCH)
        return float(text) * self.unit

    def length_vector(self):
        if not self.length_on:
            return (0.0, 0.0, 0.0)
        value = self.lengths.get(self.h)
        if value is None:
            raise Unreadable(f"line {self.line}: no length {self.h}")
        return (0.0, 0.0, value)

    def shift(self):
        if self.offset not in self.offsets:
            raise Unreadable(f"line {self.line}: no offset {self.offset}")
        return tuple(a + b for a, b in zip(self.offsets[self.offset], self.length_vector()))

    def tool_vector(self):
        return tuple(-v for v in self.length_vector()) if self.length_on else tuple(self.default_tool)

    def turned(self, p, back=False):
        if self.turn is None:
            return list(p)
        centre, angle, (u, v, _) = self.turn
        angle = -angle if back else angle
        out = list(p)
        if p[u] is None or p[v] is None:
            return out
        du, dv = p[u] - centre[0], p[v] - centre[1]
        out[u] = centre[0] + du * math.cos(angle) - dv * math.sin(angle)
        out[v] = centre[1] + du * math.sin(angle) + dv * math.cos(angle)
        return out

    def program_at(self):
        return self.turned([None if a is None else a - s for a, s in zip(self.at, self.shift())], back=True)

    def command(self, p):
        return [None if a is None else a + s for a, s in zip(self.turned(p), self.shift())]

    # what is made of a block

    def process(self, feed=True, cycle=None):
        """What a motion runs under, as a tuple that can be compared; F in mm per minute or revolution."""
        f = None
        if feed and self.feed_mode != 93 and self.f is not None:
            f = round(self.f * self.unit_of_f, 3)
        comp = (self.comp, self.d if self.comp != 40 else None)
        return (self.feed_mode, f, self.spindle, self.s, tuple(sorted(self.coolant)), self.in_spindle, self.h if self.length_on else None, comp, cycle, self.path_mode)

    def add(self, rapid, end, arc=None, cycle=None, in_cycle=False):
        end = tuple(end)
        step = 0.001 if self.unit == 1.0 else 0.0001 * INCH
        motion = Motion(rapid, tuple(self.at), end, arc, self.process(not rapid, cycle), self.tool_vector(), self.line, step)
        if not rapid and self.feed_mode == 93:
            if not self.f:
                raise Unreadable(f"line {self.line}: inverse time without F")
            motion.minutes = 1.0 / self.f
        motion.cycle = in_cycle
        if not rapid and None in motion.end:
            raise Unreadable(f"line {self.line}: feed to an unknown place")
        self.items.append(motion)
        self.at = list(end)
        return motion

    def event(self, name):
        self.items.append(Event(name, self.line))

    def block(self, text):
        words = []
        rest = WORD.sub(lambda m: words.append((m.group(1).upper(), m.group(2))) or "", text)
        rest = rest.strip()
        if rest.startswith("/"):
            rest = rest[1:].strip()
        if rest:
            raise Unreadable(f"line {self.line}: {rest!r}")
        if not words:
            return
        if self.ended:
            raise Unreadable(f"line {self.line}: behind the end")
        codes = [float(t) for letter, t in words if letter == "G"]
        ms = [float(t) for letter, t in words if letter == "M"]
        names = [letter for letter, _ in words if letter not in "GM"]
        if len(set(names)) != len(names):
            raise Unreadable(f"line {self.line}: a letter twice")
        word = {letter: t for letter, t in words if letter not in "GMN"}
        if "O" in word and len(word) == 1 and not codes:
            return
        self.units(codes)
        self.modes(codes, word)
        if 4 in codes:
            self.event("dwell " + ",".join(f"{k}{float(word[k]):g}" for k in "XPU" if k in word))
            word = {k: v for k, v in word.items() if k not in "XPU"}
        if 28 in codes or 30 in codes:
            self.reference(word)
            word = {}
        if "T" in word:
            self.t = float(word["T"])
            self.event(f"T{self.t:g}")
        if "S" in word:
            self.s = float(word["S"])
            self.event(f"S{self.s:g}")
        for m in ms:
            if m not in AFTER_MOTION:
                self.m_code(m)
        if 53 in codes:
            end = list(self.at)
            for axis, letter in enumerate("XYZ"):
                if letter in word:
                    end[axis] = float(word[letter]) * self.unit
            self.add(True, end).exempt = True
        else:
            self.motions(codes, word)
        for m in ms:
            if m in AFTER_MOTION:
                self.m_code(m)

    def units(self, codes):
        for code in codes:
            if code in (20, 21, 70, 71):
                self.unit = INCH if code in (20, 70) else 1.0

    @property
    def unit_of_f(self):
        return self._f_unit if hasattr(self, "_f_unit") else 1.0

    def modes(self, codes, word):
        for code in codes:
            if code in PLANES:
                self.plane = int(code)
            elif code in (90, 91):
                self.absolute = code == 90
            elif code in (93, 94, 95):
                self.feed_mode = int(code)
            elif code in (40, 41, 42):
                self.comp = int(code)
            elif code in (98, 99):
                self.return_to = int(code)
            elif code in (61, 64):
                self.path_mode = int(code)
            elif 54 <= code <= 59:
                self.offset = f"G{code:g}"
            elif code == 43:
                # An unnamed axis stays where it stands; only the frame changes.
                self.length_on = True
                if "H" in word:
                    self.h = int(float(word["H"]))
            elif code == 49:
                self.length_on = False
            elif code == 68:
                u, v, w = PLANES[self.plane]
                if "R" not in word or "XYZ"[u] not in word or "XYZ"[v] not in word:
                    raise Unreadable(f"line {self.line}: G68 without its words")
                centre = tuple(float(word["XYZ"[k]]) * self.unit for k in (u, v))
                self.turn = (centre, math.radians(float(word["R"])), (u, v, w))
                for letter in "XYZR":
                    word.pop(letter, None)
            elif code == 69:
                self.turn = None
        if "D" in word:
            self.d = int(float(word["D"]))
        if "F" in word:
            self.f = float(word["F"])
            self._f_unit = self.unit if self.feed_mode != 93 else 1.0

    def reference(self, word):
        end = list(self.at)
        for axis, letter in enumerate("XYZ"):
            if letter in word:
                end[axis] = None
        self.event("reference " + "".join(k for k in "XYZ" if k in word))
        self.at = end

    def m_code(self, m):
        m = int(m) if m == int(m) else m
        if m in (3, 4, 5):
            self.spindle = m
        elif m in (7, 8):
            self.coolant = self.coolant | {m}
        elif m == 9:
            self.coolant = frozenset()
        elif m == 6:
            self.in_spindle = self.t
            self.at = [None] * 3
        elif m in (2, 30):
            self.ended = True
        self.event(f"M{m:g}")

    def motions(self, codes, word):
        for code in codes:
            if code in (0, 1, 2, 3) or code in CYCLES:
                if code in CYCLES and self.motion not in CYCLES:
                    self.hole = {"initial": self.program_at()[PLANES[self.plane][2]]}
                self.motion = int(code)
            elif code == 80:
                self.motion = 0 if self.dialect == "fanuc" else None
        axes = [k for k in "XYZ" if k in word]
        if self.motion in CYCLES:
            self.cycle(word)
        elif axes or (self.motion in (2, 3) and any(k in word for k in "IJK")):
            if self.motion is None:
                raise Unreadable(f"line {self.line}: no motion code")
            self.move(word)
        elif 80 not in codes and any(k in word for k in "IJKR"):
            raise Unreadable(f"line {self.line}: arc words without an arc")

    def target(self, word, at):
        to = list(at)
        for axis, letter in enumerate("XYZ"):
            if letter in word:
                value = self.mm(letter, word[letter])
                if not self.absolute and at[axis] is None:
                    raise Unreadable(f"line {self.line}: an increment from an unknown place")
                to[axis] = value if self.absolute else at[axis] + value
        return to

    def move(self, word):
        at = self.program_at()
        to = self.target(word, at)
        if self.motion in (0, 1):
            if any(k in word for k in "IJKR"):
                raise Unreadable(f"line {self.line}: arc words on a line")
            self.add(self.motion == 0, self.command(to))
            return
        u, v, w = PLANES[self.plane]
        if None in to or None in at:
            raise Unreadable(f"line {self.line}: an arc from an unknown place")
        if "R" in word:
            if any(k in word for k in "IJK"):
                raise Unreadable(f"line {self.line}: R and a centre")
            centre = self.centre_of_radius(at, to, self.mm("R", word["R"]), u, v)
        else:
            letters = "IJK"[u] + "IJK"[v]
            if not any(k in word for k in letters) or "IJK"[w] in word:
                raise Unreadable(f"line {self.line}: an arc without its centre")
            centre = [at[k] + (self.mm(letter, word[letter]) if letter in word else 0.0) for k, letter in zip((u, v), letters)]
        middle = list(at)
        middle[u], middle[v] = centre
        middle = self.command(middle)
        end = self.command(to)
        turns = int(float(word["P"])) if "P" in word and self.dialect == "linuxcnc" else 1
        self.add(False, end, Arc(self.at, end, (u, v, w), (middle[u], middle[v]), self.motion == 2, turns))

    def centre_of_radius(self, at, to, radius, u, v):
        du, dv = to[u] - at[u], to[v] - at[v]
        chord = math.hypot(du, dv)
        if chord < 1e-9:
            raise Unreadable(f"line {self.line}: a full circle by R")
        square = radius * radius - chord * chord / 4
        if square < -1e-2 * abs(radius):
            raise Unreadable(f"line {self.line}: R below half the chord")
        height = math.sqrt(max(square, 0.0))
        side = (1 if self.motion == 3 else -1) * (1 if radius > 0 else -1)
        return [at[u] + du / 2 - side * height * dv / chord, at[v] + dv / 2 + side * height * du / chord]

    # drilling cycles

    def cycle(self, word):
        u, v, w = PLANES[self.plane]
        deep, hole = "XYZ"[w], self.hole
        for letter in "PQ":
            if letter in word:
                hole[letter] = word[letter]
        if "R" in word:
            value = self.mm("R", word["R"])
            hole["R"] = value if self.absolute else hole["initial"] + value
        if deep in word:
            value = self.mm(deep, word[deep])
            hole["Z"] = value if self.absolute else hole["R"] + value
        if not any("XYZ"[k] in word for k in (u, v)):
            if any(k in word for k in deep + "R") and not (self.dialect == "fanuc" and ("K" in word or "L" in word)):
                raise Unreadable(f"line {self.line}: a cycle's levels without a hole")
            return
        repeat = "K" if self.dialect == "fanuc" and "K" in word else "L"
        count = int(float(word[repeat])) if repeat in word else 1
        if "R" not in hole or "Z" not in hole:
            raise Unreadable(f"line {self.line}: a cycle without its levels")
        for _ in range(count):
            at = self.program_at()
            to = self.target({k: t for k, t in word.items() if k != deep}, at)
            self.drill(to, u, v, w)

    def drill(self, to, u, v, w):
        hole, kind = self.hole, self.motion
        q = self.mm("Q", hole["Q"]) if "Q" in hole else None
        start, top, bottom = self.program_at(), hole["R"], hole["Z"]

        def go(level, rapid, name=None):
            at = list(to)
            at[w] = level
            motion = self.add(rapid, self.command(at), None, name, True)
            # How far a control goes at a time down a hole is its own; the hole is the same.
            motion.peck = kind in (73, 83) and level > bottom + 1e-9

        level = start[w]
        if level is None:
            raise Unreadable(f"line {self.line}: a cycle from an unknown level")
        if level < top - SAME_LEVEL:
            start[w] = level = top
            self.add(True, self.command(start), None, None, True)
        if self.dialect == "linuxcnc" and self.return_to == 98 and hole["initial"] > level + SAME_LEVEL:
            # Behind a hole under G99 LinuxCNC goes across and up to the initial level; other controls go across at R.
            level = hole["initial"]
        go(level, True)
        if level > top + SAME_LEVEL:
            go(top, True)
        name = None
        if kind in SPINDLE_CYCLES:
            name = (kind, hole.get("P"), hole.get("Q"))
        pause = kind in (82, 89)
        if kind in (73, 83):
            if not q or q <= 0 or (top - bottom) / q > 100000:
                raise Unreadable(f"line {self.line}: pecks without number")
            depth = top
            while depth > bottom + 1e-9:
                depth = max(depth - q, bottom)
                go(depth, False)
                if depth > bottom + 1e-9:
                    if kind == 83:
                        go(top, True)
                        go(depth + PECK_CLEARANCE, True)
                    else:
                        go(depth + CHIP_RETREAT[self.dialect], True)
        else:
            go(bottom, False, name)
        if pause and "P" in hole:
            self.event(f"dwell P{float(hole['P']):g}")
        if kind in (84, 74):
            self.event("spindle turns back")
        if kind in (84, 74, 85, 89):
            go(top, False, name)
        elif name:
            self.event(f"end of G{kind}")
        back = top if self.return_to == 99 else max(hole["initial"] if hole["initial"] is not None else level, top)
        if abs(back - (self.program_at()[w])) > SAME_LEVEL:
            go(back, True)

    def read(self, raw):
        opened = False
        for number, line in enumerate(split_lines(raw), 1):
            self.line = number
            text, rest = bare(line, self.dialect)
            text = text.strip()
            if text.startswith("%"):
                if opened:
                    break
                opened = True
                continue
            if re.fullmatch(r"[O:]\s*\d+", text.upper()) or not text:
                text = ""
            while text is not None:
                self.block(text)
                text, rest = (bare(rest, self.dialect) if rest else (None, None))
        return self.items


def trace(items):
    """A program as plain values, for asking whether two programs are the same to the part."""
    out = []
    for item in items:
        if isinstance(item, Event):
            out.append(("event", item.name))
            continue
        end = tuple(None if v is None else round(v, 6) for v in item.end)
        arc = None if item.arc is None else (item.arc.axes, tuple(round(v, 6) for v in item.arc.centre), round(item.arc.sweep, 7))
        # A motion to where the axes stand moves nothing.
        if item.start == item.end and arc is None and item.known:
            continue
        process = item.process if not item.rapid else None
        out.append(("rapid" if item.rapid else "feed", end, arc, process, item.minutes, item.tool))
    return out
