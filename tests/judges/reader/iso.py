"""The blocks of ISO controls: Fanuc, Haas, Mitsubishi, LinuxCNC, Grbl, Mach, Centroid, GOST, Balt-System, Okuma.

What differs is in OPTIONS; flow is in fanuc.py, ngc.py, okuma.py. Sources: Fanuc B-63944EN and B-64304EN (operator's
manuals), Haas 96-8210, LinuxCNC's G-code reference, Using Mach3Mill, Okuma OSP-P programming manuals.
"""

import re

import expr
from core import PLANES, Control, Frame, Invalid, Motion, identity, matvec, rotation

COMMON = {
    "kind": None, "increments": False, "repeats": None, "levels": "held", "peck": 0.254, "chip": 0.5,
    "comma": False, "inch": (20,), "metric": (21,), "tolerance": 0.02, "offsets": "g54", "dwell_p": 0.001,
    "dwell": "PXU", "one_shift": False, "nested": False, "semicolon": "comment", "l20": "numbered", "return": 98,
    "machine": 53, "length": 43, "polar_words": False, "bottom": False, "arc_turns": False, "round": "comment",
}
OPTIONS = {
    "fanuc": dict(kind="fanuc", increments=True, repeats="K", comma=True, semicolon="block"),
    "haas": dict(kind="fanuc", increments=True, repeats="L", comma=True, semicolon="block"),
    "mitsubishi": dict(kind="fanuc", increments=True, repeats="L", comma=True, semicolon="block"),
    "linuxcnc": dict(kind="ngc", repeats="L", levels="reread", chip=0.254, tolerance=0.0279, dwell="P", dwell_p=1.0,
                     one_shift=True, l20="position", polar_words=True, bottom=True, arc_turns=True),
    "grbl": dict(kind="ngc", repeats="L", levels="reread", chip=0.254, tolerance=0.005, dwell="P", dwell_p=1.0,
                 one_shift=True, l20="position", polar_words=True, bottom=True, arc_turns=True),
    "mach": dict(kind="ngc", repeats="L", tolerance=0.00521, inch=(20, 70), metric=(21, 71), dwell_p=0.001),
    "centroid": dict(tolerance=0.0205),
    "perspektiva": dict(tolerance=0.01, inch=(20, 70), metric=(21, 71)),
    "balt-system": dict(inch=(70,), metric=(71,), machine=79, dwell="", round="command"),
    "okuma": dict(increments=True, tolerance=0.01, semicolon="none", offsets="okuma", length=56, machine=None,
                  dwell="F"),
}
LENGTHS = {1: 120.0, 2: 80.5, 7: 95.25}
OFFSETS = {54: (100.0, 80.0, 40.0), 55: (110.0, 75.0, 41.0), 56: (-60.0, 33.0, -12.0), 57: (15.0, -140.0, 22.0),
           58: (7.0, 9.0, 3.0), 59: (-200.0, 50.0, 70.0)}
NUMBERED = {1: (21.0, 31.0, -9.0), 2: (-44.0, 12.0, 5.0), 7: (3.0, -73.0, 18.0)}
LENGTH_LETTERS = set("XYZIJKRQUVW")
CYCLES = {73, 74, 76, 81, 82, 83, 84, 85, 86, 87, 88, 89}
SWITCHES = {40, 61, 64, 94, 95, 97, 96, 15, 69, 50, 80, 9, 49, 67, 8, 23}


class Block:
    """The words of a block: codes, M codes and values."""

    def __init__(self):
        self.g, self.m, self.words, self.comma, self.points = [], [], {}, {}, {}

    def has(self, letters):
        return any(letter in self.words for letter in letters)


class Iso(Control):
    axis_letters = "XYZ@^"

    def __init__(self, dialect):
        super().__init__()
        self.o = {**COMMON, **OPTIONS[dialect]}
        self.dialect = dialect
        self.ngc = dialect in ("linuxcnc", "grbl", "linuxcnc-lathe")
        self.offsets = {k: list(v) for k, v in OFFSETS.items()}
        self.numbered = {k: list(v) for k, v in NUMBERED.items()}
        self.work = [0.0] * 3 if dialect == "okuma" else list(OFFSETS[54])
        self.work_of = ("g54", 54)
        self.cycle, self.initial, self.back = None, None, self.o["return"]
        self.cycle_words = {}
        self.polar, self.polar_at = False, [None, None]
        self.centres_absolute = False
        self.variables = {}
        self.okuma_level, self.okuma_return = None, None
        self.mode = None if dialect in ("linuxcnc", "mach", "perspektiva", "balt-system") else 0

    # ---- text to words ----
    def strip(self, line):
        """Without comments and block numbers."""
        if self.o["round"] == "comment":
            line = re.sub(r"\([^)]*\)", " ", line)
        if self.o["semicolon"] == "comment":
            line = line.split(";")[0]
        return line.strip().upper()

    def look(self, name):
        return self.variables.get(name)

    def read(self, text):
        block, at = Block(), 0
        while at < len(text):
            c = text[at]
            if c in " \t/%":
                at += 1
                continue
            comma = c == ","
            if comma:
                at += 1
                c = text[at]
            if not (c.isalpha() or c in "@^"):
                raise Invalid(f"word {text[at:]!r}")
            at += 1
            if text[at:at + 1] == "=":
                at += 1
            value, at, point = self.value(text, at)
            if value is None:                       # an empty variable: the word is not there
                continue
            if c == "N" and not comma:
                continue
            if comma:
                block.comma[c] = self.length_of(c, value, point)
            elif c == "G":
                block.g.append(round(value, 1) if value != int(value) else int(value))
            elif c == "M":
                block.m.append(int(value))
            else:
                block.words[c], block.points[c] = value, point
        return block

    def value(self, text, at):
        return expr.value_at(text, at, self.look, self.o["kind"] or "fanuc")

    def length_of(self, letter, value, point):
        if self.o["increments"] and not point and letter in LENGTH_LETTERS and letter != "A":
            value *= 0.001 if self.scale == 1.0 else 0.0001
        return value

    def mm(self, block, letter, default=None):
        if letter not in block.words:
            return default
        return self.length_of(letter, block.words[letter], block.points[letter]) * self.scale

    def places(self, block):
        return {i: self.mm(block, a) for i, a in enumerate("XYZ") if a in block.words}

    # ---- one block ----
    def execute(self, block):
        g, w = block.g, block.words
        for code in g:
            if code in self.o["inch"]:
                self.scale = 25.4
            elif code in self.o["metric"]:
                self.scale = 1.0
        for code in (17, 18, 19):
            if code in g:
                if code != self.plane and self.polar:
                    raise Invalid("plane changes under polar words")
                self.plane = code
        if 90 in g:
            self.absolute = True
        if 91 in g:
            self.absolute = False
        if 90.1 in g:
            self.centres_absolute = True
        if 91.1 in g:
            self.centres_absolute = False
        for code in (93, 94, 95):
            if code in g:
                self.feed_mode = code
        for code in (98, 99):
            if code in g:
                self.back = code
        if "F" in w and not (4 in g and "F" in self.o["dwell"]):
            self.feed = w["F"] * (self.scale if self.feed_mode != 93 else 1.0)
        elif self.feed_mode == 93 and not block.has("F"):
            self.feed = None
        for m in block.m:
            if m in (3, 4, 6, 7, 8) or m not in (0, 1, 2, 5, 9, 30, 98, 99, 60):
                self.m_before(m)
        if "S" in w:
            self.side("S", w["S"])
        self.motion_part(block)
        for m in block.m:
            if m in (0, 1, 5, 9):
                self.side("M", m)
            if m == 60:
                self.forget((0, 1, 2))
                self.side("M", m)

    def m_before(self, m):
        if m == 6:
            self.forget((0, 1, 2))
        if m in (53, 54) and self.dialect == "okuma":
            self.okuma_return = m
            return
        self.side("M", m)

    def forget(self, axes):
        self.finish_corner_open()
        for i in axes:
            self.pos[i] = None

    def finish_corner_open(self):
        if self.corner is not None:
            raise Invalid("a corner without its second line")

    def motion_part(self, block):
        g = block.g
        shift = self.frame_codes(block)
        if shift:
            return
        if 4 in g:
            self.finish_corner_open()
            time = next((block.words[c] for c in self.o["dwell"] if c in block.words), None)
            if time is not None:
                letter = next(c for c in self.o["dwell"] if c in block.words)
                if letter == "P":
                    time *= self.o["dwell_p"] if not (block.points["P"] and self.dialect != "linuxcnc") else 1.0
                elif not block.points[letter] and self.o["increments"]:
                    time *= 0.001
            self.side("dwell", None if time is None else round(time, 6))
            if self.o["dwell"] == "P" and block.has("XYZ"):
                self.motion(block)
            return
        if (28 in g or 30 in g) and self.dialect != "balt-system":
            return self.reference(block)
        if self.o["machine"] in g and self.o["machine"] is not None:
            return self.machine_move(block)
        modal = [c for c in g if c in (0, 1, 2, 3) or c in CYCLES or c == 80]
        if 80 in g:
            self.end_cycle()
            if self.o["kind"] == "ngc":
                self.mode = None
            modal = [c for c in modal if c != 80]
        if len(modal) > 1:
            raise Invalid("two motion codes")
        if modal:
            code = modal[0]
            if code in CYCLES:
                self.start_cycle(code)
            else:
                self.end_cycle()
                self.mode = code
        if self.cycle:
            return self.cycle_block(block)
        self.motion(block)

    # ---- offsets, shifts, frames ----
    def frame_codes(self, block):
        """Carries out what moves the frame; True where the block's words are used up by it."""
        g, w = block.g, block.words
        if self.o["offsets"] == "okuma":
            if 15 in g:
                self.choose(("g15", int(w["H"])))
                block.words.pop("H")
            if 53 in g:
                self.length_off(block)
            if 71 in g and "Z" in w:
                self.okuma_level = self.mm(block, "Z")
                return True
        else:
            for code in g:
                if code in (54, 55, 56, 57, 58, 59):
                    self.choose(("g54", code))
                if code in (54.1, 154):
                    self.choose(("p", int(w["P"])))
                if self.dialect == "haas" and 110 <= code <= 129:
                    self.choose(("p", int(code) - 109))
        if self.o["length"] in g or (44 in g and self.o["offsets"] == "g54"):
            h = int(w.get("H", -1))
            length = [0.0, 0.0, 0.0 if h == 0 else LENGTHS[h] if self.o["length"] in g else -LENGTHS[h]]
            if length != self.length and "Z" not in w and self.o["kind"] != "ngc":
                self.pos[2] = None
            self.length = length
        if 43.1 in g:
            self.length = [0.0, 0.0, self.mm(block, "Z", 0.0)]
            return True
        if 49 in g and self.o["offsets"] == "g54":
            self.length_off(block)
        if 10 in g and self.dialect != "okuma":
            self.write_offset(block)
            return True
        if 52 in g:
            self.finish_corner_open()
            to = self.preset if self.o["one_shift"] else self.local
            for i, value in self.places(block).items():
                to[i] = value if self.absolute or self.o["one_shift"] else to[i] + value
            return True
        if 92 in g:
            self.finish_corner_open()
            self.set_preset(block)
            return True
        if 92.1 in g or 92.2 in g:
            if 92.2 in g:
                self.saved_preset = list(self.preset)
            self.preset = [0.0] * 3
            if 92.1 in g:
                self.saved_preset = [0.0] * 3
            return True
        if 92.3 in g:
            self.preset = list(getattr(self, "saved_preset", [0.0] * 3))
            return True
        if 69 in g or 50 in g and not block.has("XYZ") or 50.1 in g:
            self.finish_corner_open()
            self.frame = Frame()
            if 50.1 in g:                           # its words name the axes
                return True
        if 68 in g:
            self.rotate(block)
            return True
        if 51 in g:
            self.scale_by(block)
            return True
        if 51.1 in g:
            self.finish_corner_open()
            a, b = identity(), [0.0] * 3
            for i, value in self.places(block).items():
                a[i][i], b[i] = -1.0, 2 * value
            self.frame = Frame(a, b)
            return True
        if 15 in g and self.o["offsets"] == "g54":
            self.polar = False
        if 16 in g:
            self.polar, self.polar_at = True, [None, None]
        return False

    def length_off(self, block):
        if self.length[2] and not ("Z" in block.words) and self.o["kind"] != "ngc":
            self.pos[2] = None
        self.length = [0.0] * 3

    def choose(self, which):
        self.finish_corner_open()
        self.work_of = which
        kind, number = which
        table = {"g54": self.offsets, "p": self.numbered, "g15": {1: OFFSETS[54], 2: OFFSETS[55], 3: OFFSETS[56]}}[kind]
        if number not in table:
            raise Invalid("work offset")
        self.work = list(table[number])

    def write_offset(self, block):
        self.finish_corner_open()
        w = block.words
        if int(w.get("L", 0)) not in (2, 20):
            raise Invalid("G10")
        number, what = int(w["P"]), int(w["L"])
        current = self.work_of[1] - 53 if self.work_of[0] == "g54" else -1
        if what == 20 and self.o["l20"] == "numbered":
            entry = self.numbered.setdefault(number, [0.0] * 3)
            current = self.work_of == ("p", number)
        else:
            if number == 0:
                number = current
            entry = self.offsets[53 + number]
            current = current == number
        if "R" in w:
            raise Invalid("turned work offset")
        if what == 20 and self.o["l20"] == "position":
            off = [a + b + c for a, b, c in zip(self.local, self.preset, self.length)]
            for i, value in self.places(block).items():
                if self.pos[i] is None:
                    raise Invalid("G10 L20 where the place is not known")
                entry[i] = self.pos[i] - off[i] - value
        else:
            for i, value in self.places(block).items():
                entry[i] = value if self.absolute or self.o["kind"] == "ngc" else entry[i] + value
        if current:
            self.work = list(entry)

    def set_preset(self, block):
        if self.frame.a != identity():
            raise Invalid("G92 in a turned frame")
        for i, value in self.places(block).items():
            if self.pos[i] is None:
                raise Invalid("G92 where the place is not known")
            self.preset[i] = self.pos[i] - self.work[i] - self.local[i] - self.length[i] - value
            self.saved_preset = list(self.preset)

    def rotate(self, block):
        self.finish_corner_open()
        p, q = PLANES[self.plane]
        if "R" not in block.words:
            raise Invalid("G68 without R")
        here, named = Frame(), self.places(block)
        old = self.frame
        self.frame = here
        stand = self.words()
        if old.a != identity():
            raise Invalid("G68 in a turned frame")
        if any(i not in (p, q) for i in named):
            raise Invalid("G68's centre outside the plane")
        if len(named) == 1:
            raise Invalid("G68 with half a centre")
        c = [named.get(i, stand[i]) for i in (p, q)]
        if None in c:
            raise Invalid("G68 about a place that is not known")
        self.frame = Frame(*turned_about(p, q, block.words["R"], c))

    def scale_by(self, block):
        self.finish_corner_open()
        w = block.words
        if self.frame.a != identity():
            raise Invalid("G51 in a turned frame")
        if "P" not in w:
            raise Invalid("uneven scales are not modelled")
        factor = w["P"] if block.points["P"] else w["P"] * 0.001
        centre = self.words()
        for i, value in self.places(block).items():
            centre[i] = value
        if None in centre:
            raise Invalid("scale about a place that is not known")
        a = [[factor if i == j else 0.0 for j in range(3)] for i in range(3)]
        self.frame = Frame(a, [c - factor * c for c in centre])

    # ---- motions ----
    def polar_target(self, block):
        """Fanuc's G16: the plane's words are radius and angle about the program's zero."""
        p, q = PLANES[self.plane]
        named = self.places(block)
        if not self.absolute:
            raise Invalid("increments under polar words")
        if p in named:
            self.polar_at[0] = named.pop(p)
        letter = "XYZ"[q]
        if q in named:
            named.pop(q)
            value = block.words[letter]
            self.polar_at[1] = value if block.points[letter] or not self.o["increments"] else value * 0.001
        import math
        if None in self.polar_at:
            raise Invalid("polar words, not both known")
        r, t = self.polar_at[0], math.radians(self.polar_at[1])
        named[p], named[q] = r * math.cos(t), r * math.sin(t)
        return self.target(named)

    def goal(self, block):
        if self.polar and block.has("".join("XYZ"[i] for i in PLANES[self.plane])):
            return self.polar_target(block)
        if "@" in block.words or "^" in block.words:
            return self.ngc_polar(block)
        return self.target(self.places(block))

    def ngc_polar(self, block):
        """LinuxCNC's @ radius and ^ angle, in X and Y; the missing one is that of the place where the tool stands."""
        import math
        if block.has("XY") or self.plane != 17:
            raise Invalid("polar words beside X and Y")
        named, w = self.places(block), self.words()
        radius, angle = block.words.get("@"), block.words.get("^")
        radius = None if radius is None else radius * self.scale
        if radius is None or angle is None or not self.absolute:
            if None in (w[0], w[1]) or math.hypot(w[0], w[1]) < 1e-3:
                raise Invalid("polar words from a place that is not known")
            r0, t0 = math.hypot(w[0], w[1]), math.degrees(math.atan2(w[1], w[0]))
            if self.absolute:
                radius, angle = r0 if radius is None else radius, t0 if angle is None else angle
            else:
                radius, angle = r0 + (radius or 0.0), t0 + (angle or 0.0)
        x, y = radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle))
        if self.absolute or 2 not in named:
            z = named.get(2)
            named = {0: x, 1: y}
            if z is not None:
                named[2] = z
            return self.target(named, True)
        named = {0: x - w[0], 1: y - w[1], 2: named[2]}
        return self.target(named, False)

    def motion(self, block):
        if not block.has(self.axis_letters) and not (self.mode in (2, 3) and block.has("IJK")):
            if block.comma:
                raise Invalid("corner word without a line")
            return
        if self.mode is None:
            raise Invalid("words without a motion code")
        w0 = self.words()
        w1, end, touched = self.goal(block)
        if block.comma and self.mode != 1:
            raise Invalid("corner word without a line")
        if self.mode == 0:
            self.finish_corner_open()
            return self.move("rapid", end, touched)
        if self.feed is None:
            raise Invalid("feed motion without F")
        if self.mode == 1:
            if block.comma:
                if not self.o["comma"] or not self.absolute:
                    raise Invalid("corner word")
                how = "round" if "R" in block.comma else "chamfer"
                size = block.comma.get("R", block.comma.get("C")) * self.scale
                return self.corner_line(end, how, size, touched)
            self.finish_corner(end)
            return self.move("line", end, touched)
        self.finish_corner_open()
        self.arc_block(block, w0, w1, end, touched)

    def arc_block(self, block, w0, w1, end, touched):
        p, q = PLANES[self.plane]
        ccw = self.mode == 3
        if None in (w0[p], w0[q]):
            raise Invalid("arc from a place that is not known")
        turns = 0
        if self.o["arc_turns"] and "P" in block.words:
            turns = int(block.words["P"]) - 1
        if "R" in block.words:
            c = self.centre_of_radius((w0[p], w0[q]), (w1[p], w1[q]), self.mm(block, "R"), ccw)
            if turns:
                raise Invalid("turns of an arc by its radius")
        else:
            letters = "IJK"[p], "IJK"[q]
            if not block.has(letters) or block.has([c for c in "IJK" if c not in letters]):
                raise Invalid("arc without its centre")
            if self.centres_absolute:
                if any(c not in block.words for c in letters):
                    raise Invalid("half an absolute centre")
                c = [self.mm(block, letters[0]), self.mm(block, letters[1])]
            else:
                c = [w0[p] + self.mm(block, letters[0], 0.0), w0[q] + self.mm(block, letters[1], 0.0)]
        self.arc_by_words(w0, w1, end, touched, ccw, c, turns, self.o["tolerance"])

    def reference(self, block):
        self.finish_corner_open()
        self.end_cycle(keep=True)
        named = self.places(block)
        if self.polar:
            raise Invalid("return under polar words")
        axes = tuple(sorted(named)) or (0, 1, 2)
        if named:
            try:
                _, end, touched = self.target(named)
            except Invalid:
                end, touched = list(self.pos), set(named)
                if self.absolute or any(named.values()):
                    raise
            self.emit(Motion("reference", self.pos, end, line=self.line, named="".join("XYZ"[i] for i in axes)))
            self.pos = end
        else:
            self.emit(Motion("reference", self.pos, self.pos, line=self.line, named="XYZ"))
        self.forget(axes)

    def machine_move(self, block):
        self.finish_corner_open()
        code = next((c for c in block.g if c in (0, 1)), None)
        if code is not None:
            self.mode = code
            self.end_cycle()
        named = self.places(block)
        if not self.absolute:
            raise Invalid("machine coordinates in increments")
        if not named:
            return
        if self.o["kind"] == "ngc" and self.mode not in (0, 1):
            raise Invalid("G53 without G0 or G1")
        if self.mode not in (0, None):
            raise Invalid("G53 in a feed is not modelled")
        end = list(self.pos)
        for i, value in named.items():
            end[i] = value
        self.move("machine", end, tuple(named))

    # ---- drilling cycles ----
    def end_cycle(self, keep=False):
        if self.cycle and not keep:
            self.cycle, self.initial, self.cycle_words = None, None, {}

    def start_cycle(self, code):
        self.finish_corner_open()
        n = self.normal()
        if self.cycle is None:
            self.initial = self.pos[n]
            self.cycle_words = {}
        elif self.o["kind"] == "ngc":
            self.cycle_words = {}
        self.cycle = code
        if self.o["kind"] == "ngc":
            self.mode = None

    def normal(self):
        p, q = PLANES[self.plane]
        return 3 - p - q

    def cycle_block(self, block):
        """One block of a cycle: new words are held, and holes are drilled where it names a place, Z or R."""
        w, n = block.words, self.normal()
        depth = "XYZ"[n]
        if n != 2 and self.o["kind"] != "ngc":
            raise Invalid("cycles out of G17 are not modelled")
        if self.initial is None:
            raise Invalid("cycle from a level that is not known")
        p, q = PLANES[self.plane]
        places = block.has("XYZ" if not self.polar_words_of(block) else "@^XYZ") or "R" in w
        held = self.cycle_words
        if not self.frame.plain(n) or abs(self.frame.a[n][n] - 1) > 1e-12:
            raise Invalid("cycle along an axis that is mirrored or scaled")
        for letter in "QPIJ":
            if letter in w:
                held[letter] = w[letter] if letter == "P" else self.mm(block, letter)
        if self.dialect == "okuma" and held.get("P"):
            raise Invalid("P of a cycle")
        for letter, key in (("R", "R"), (depth, "Z")):
            if letter in w:
                held[key] = (self.mm(block, letter), self.absolute)
        count = 1
        if self.o["repeats"] and self.o["repeats"] in w:
            count = int(w[self.o["repeats"]])
        if not places:
            return
        if "R" in w or depth in w or self.o["levels"] == "reread" or "level" not in held:
            self.set_levels(held)
        if count == 0:
            if block.has("XYZ"[p] + "XYZ"[q]):
                raise Invalid("what a count of zero does with a place is not modelled")
            return
        r, z = held["level"]
        if self.o["bottom"] and z > r + 1e-9:
            raise Invalid("bottom above R")
        if self.feed is None:
            raise Invalid("cycle without F")
        for _ in range(count):
            self.hole(block, r, z, n, held)

    def polar_words_of(self, block):
        return self.o["polar_words"] and block.has("@^")

    def set_levels(self, held):
        """R and Z as places of the axis."""
        n = self.normal()
        zero = self.frame.b[n] + self.offset()[n]
        if "R" not in held or "Z" not in held:
            raise Invalid("cycle without R or Z")
        (r, r_absolute), (z, z_absolute) = held["R"], held["Z"]
        if self.o["levels"] == "reread":
            r_absolute = z_absolute = self.absolute
        start = self.initial
        level = zero + r if r_absolute else start + r
        bottom = zero + z if z_absolute else level + z
        held["level"] = (level, bottom)

    def hole(self, block, r, z, n, held):
        named = {i: v for i, v in self.places(block).items() if i != n}
        if self.polar and named:
            copy = Block()
            copy.words = {c: v for c, v in block.words.items() if c != "XYZ"[n]}
            copy.points = block.points
            _, end, touched = self.polar_target(copy)
        elif self.polar_words_of(block):
            copy = Block()
            copy.words = {c: v for c, v in block.words.items() if c in "@^"}
            _, end, touched = self.ngc_polar(copy)
        else:
            _, end, touched = self.target(named)
        if any(end[i] is None for i in PLANES[self.plane]):
            raise Invalid("hole at a place that is not known")
        if self.ngc:
            # rs274 2.9: to R in place where the initial level lies below it; then over the hole at the level in force where
            # that lies above R, else at the level of return
            if self.initial < r:
                self.to(n, r, "rapid")
            if self.pos[n] <= r + 1e-9:
                end[n] = max(self.initial, r) if self.back == 98 else r
                touched = tuple(set(touched) | {n})
            else:
                end[n] = self.pos[n]
        self.move("rapid", end, touched)
        self.to(n, r, "rapid")
        self.drill(r, z, n, held)
        top = self.initial if self.back == 98 else r
        if self.o["kind"] == "ngc":
            top = max(self.initial, r) if self.back == 98 else r
        elif self.back == 98 and self.initial < r - 0.09:
            raise Invalid("G98 from a level below R: no manual says where it returns to")
        self.leave(top, r, n)

    def to(self, n, place, kind):
        end = list(self.pos)
        end[n] = place
        self.move(kind, end, (n,))

    def drill(self, r, z, n, held):
        code, q = self.cycle, held.get("Q")
        if code in (73, 83):
            if not q:
                raise Invalid("pecks without Q")
            at, more = r, abs(q)
            while at - more > z + 1e-9:
                at -= more
                if abs(at - more - z) < 1e-6 and self.o["kind"] == "ngc":
                    raise Invalid("the number of pecks hangs on rounding")
                self.to(n, at, "line")
                if code == 83:
                    self.to(n, r, "rapid")
                    self.to(n, min(at + self.o["peck"], r), "rapid")
                else:
                    self.to(n, min(at + self.o["chip"], r), "rapid")
        self.to(n, z, "line")
        if code in (82, 89, 86, 88) and held.get("P"):
            self.side("dwell", round(held["P"] * (self.o["dwell_p"]), 6))
        elif code not in (73, 81, 82, 83, 85, 89):
            self.side("cycle", (code, held.get("Q"), held.get("P")))

    def leave(self, top, r, n):
        if self.cycle in (85, 89, 84, 74):
            # rs274's G89 feeds up to G98's level; grblHAL's G85 and G89 both (motion_control.c, mc_canned_drill)
            far = self.cycle == 89 and self.ngc or self.cycle == 85 and self.dialect == "grbl"
            self.to(n, top if far else r, "line")
        end = list(self.pos)
        end[n] = top
        self.move("rapid", end)                                # to a level of before: nobody names it here


def turned_about(p, q, degrees, c):
    """A rotation of the plane about c as (a, b)."""
    a = rotation(p, q, degrees)
    v = [0.0] * 3
    v[p], v[q] = c
    turned = matvec(a, v)
    return a, [x - y for x, y in zip(v, turned)]
