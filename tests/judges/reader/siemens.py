"""Sinumerik 840D, 828D: blocks, frames, cycles and flow of mills.

Sources: Programming Manual Fundamentals (G codes, frames, RND, CHF, CHR, AR, TURN, AC and IC), Job Planning (R parameters,
DEF, IF, loops, jumps, subprograms), Cycles (CYCLE81 to CYCLE86, MCALL, HOLES1, HOLES2).
"""

import math
import os
import re

from core import PLANES, Control, Frame, Invalid, Motion, identity, rotation

OFFSETS = {54: (100.0, 80.0, 40.0), 55: (110.0, 75.0, 41.0), 56: (-60.0, 33.0, -12.0), 57: (15.0, -140.0, 22.0),
           505: (12.0, -14.0, 16.0), 599: (-30.0, 22.0, 5.0)}
LENGTHS = {1: 120.0, 2: 80.5, 7: 95.25}
TOKEN = re.compile(r"\s*(?:(\d+\.?\d*|\.\d+)|([A-Z_][A-Z0-9_]*)|(==|<>|>=|<=|[-+*/()<>,=]))")
FRAMES = ("TRANS", "ATRANS", "ROT", "AROT", "MIRROR", "AMIRROR")
NAMED = {"CR", "AR", "RND", "CHR", "CHF", "TURN", "RPL"}


class Return(Exception):
    pass


class Tokens:
    """A line as tokens, with the expressions of the language."""

    def __init__(self, text, variables):
        self.items, at = [], 0
        text = text.upper().rstrip()
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise Invalid(f"token {text[at:]!r}")
            self.items.append(match.group(0).strip())
            at = match.end()
        self.at, self.variables = 0, variables

    def peek(self, more=0):
        return self.items[self.at + more] if self.at + more < len(self.items) else None

    def take(self, wanted=None):
        token = self.peek()
        if token is None or (wanted and token != wanted):
            raise Invalid(f"{wanted} expected, {token} found")
        self.at += 1
        return token

    def expression(self):
        left = self.logic()
        while self.peek() in ("==", "<>", "<", ">", "<=", ">="):
            sign, right = self.take(), self.logic()
            left = float({"==": abs(left - right) < 1e-9, "<>": abs(left - right) >= 1e-9, "<": left < right,
                          ">": left > right, "<=": left <= right, ">=": left >= right}[sign])
        return left

    def logic(self):
        left = self.sum()
        while self.peek() in ("AND", "OR"):
            sign, right = self.take(), self.sum()
            left = float((bool(left) and bool(right)) if sign == "AND" else (bool(left) or bool(right)))
        return left

    def sum(self):
        left = self.product()
        while self.peek() in ("+", "-"):
            left = left + self.product() if self.take() == "+" else left - self.product()
        return left

    def product(self):
        left = self.factor()
        while self.peek() in ("*", "/"):
            left = left * self.factor() if self.take() == "*" else left / self.factor()
        return left

    def factor(self):
        token = self.take()
        if token == "-":
            return -self.factor()
        if token == "+":
            return self.factor()
        if token == "(":
            found = self.expression()
            self.take(")")
            return found
        if token[0].isdigit() or token[0] == ".":
            return float(token)
        if self.peek() == "(":
            self.take()
            a = self.expression()
            self.take(")")
            return {"SIN": lambda: math.sin(math.radians(a)), "COS": lambda: math.cos(math.radians(a)),
                    "SQRT": lambda: math.sqrt(a), "ABS": lambda: abs(a), "POT": lambda: a * a,
                    "TRUNC": lambda: float(math.trunc(a)), "ROUND": lambda: math.floor(a + 0.5)}[token]()
        if token not in self.variables:
            raise Invalid(f"{token} without a value")
        return self.variables[token]

    def arguments(self):
        """(1,,3): None where one is left out."""
        found = []
        self.take("(")
        while True:
            found.append(None if self.peek() in (",", ")") else self.expression())
            if self.take() == ")":
                return found

    def end(self):
        return self.at >= len(self.items)


class Siemens(Control):
    steps = 60000

    def __init__(self, include=None):
        super().__init__()
        self.include, self.variables = include, {}
        self.mode, self.tool, self.edge, self.modal, self.chosen = None, None, 0, None, False
        self.feed_units = 1.0
        self.unsure = set()

    # ---- flow ----
    def run(self, text):
        self.top = True
        try:
            self.program(text)
        except Return:
            pass
        if self.corner is not None:
            raise Invalid("corner without its second line")
        return self.events

    def program(self, text):
        lines = [re.sub(r";.*", "", line).strip().upper() for line in text.split("\n")]
        self.span(lines, 0, len(lines))

    ENDS = {"IF": "ENDIF", "FOR": "ENDFOR", "WHILE": "ENDWHILE", "REPEAT": "UNTIL", "LOOP": "ENDLOOP"}

    @staticmethod
    def word(line):
        match = re.match(r"(?:N\d+\s*)?(?:[A-Z_][A-Z0-9_]+:\s*)?([A-Z_]+)", line)
        return match.group(1) if match else ""

    def block_if(self, line):
        return self.word(line) == "IF" and "GOTO" not in line

    def partner(self, lines, i, stop, also=()):
        """The line that ends what line i opens, or the first of `also` at its level."""
        kind, depth = self.word(lines[i]), 0
        opener = kind if kind in self.ENDS else "IF"
        for j in range(i + 1, stop):
            word = self.word(lines[j])
            if depth == 0 and (word == self.ENDS[opener] or word in also):
                return j
            if word == opener and (opener != "IF" or self.block_if(lines[j])):
                depth += 1
            elif word == self.ENDS[opener]:
                depth -= 1
        raise Invalid(f"{kind} without its end")

    def value(self, text):
        return Tokens(text, self.variables).expression()

    def span(self, lines, start, stop):
        """Runs lines; gives the label to jump to that is not within them."""
        i = start
        while i < stop:
            self.steps -= 1
            if self.steps < 0:
                raise Invalid("too many steps")
            line, self.line = lines[i], i + 1
            line = re.sub(r"^[/:]?\s*(?:N\d+\s*)?", "", line)
            line = re.sub(r"^[A-Z_][A-Z0-9_]+:\s*", "", line)
            word = self.word(line)
            if not line or line.startswith("%") or word == "PROC":
                i += 1
                continue
            label = None
            if self.block_if(line):
                other = self.partner(lines, i, stop, ("ELSE",))
                end = other if self.word(lines[other]) == "ENDIF" else self.partner(lines, other, stop)
                if self.value(line[2:]):
                    label = self.span(lines, i + 1, other)
                elif end != other:
                    label = self.span(lines, other + 1, end)
                i = end
            elif word == "FOR":
                end = self.partner(lines, i, stop)
                name, first, last = re.match(r"FOR\s+(\w+)\s*=(.+?)\bTO\b(.+)$", line).groups()
                self.variables[name] = self.value(first)
                while self.variables[name] <= self.value(last) + 1e-9:
                    label = self.span(lines, i + 1, end)
                    if label:
                        break
                    self.variables[name] += 1
                i = end
            elif word == "WHILE":
                end = self.partner(lines, i, stop)
                while self.value(line[5:]):
                    label = self.span(lines, i + 1, end)
                    if label:
                        break
                i = end
            elif word == "REPEAT":
                end = self.partner(lines, i, stop)
                while True:
                    label = self.span(lines, i + 1, end)
                    if label or self.value(self.word_rest(lines[end], "UNTIL")):
                        break
                i = end
            elif "GOTO" in line:
                match = re.match(r"(?:IF(.+?))?\bGOTO([FB]?)\s+(\w+)", line)
                if match.group(1) is None or self.value(match.group(1)):
                    label = match.group(3)
            elif self.statement(line):
                return "END"
            if label == "END":
                return label
            if label:
                found = self.label(lines, label, start, stop)
                if found is None:
                    return label
                i = found
                continue
            i += 1
        return None

    @staticmethod
    def word_rest(line, word):
        return line[line.index(word) + len(word):]

    @staticmethod
    def label(lines, label, start, stop):
        for j in range(start, stop):
            if re.match(rf"(?:N\d+\s*)?{label}:", lines[j]) or re.match(rf"{label}\b(?!=)", lines[j]) and label[0] == "N":
                return j
        return None

    # ---- one block ----
    def statement(self, line):
        """True where the program ends."""
        match = re.match(r"DEF\s+(?:REAL|INT)\s+(.+)$", line)
        if match:
            for part in match.group(1).split(","):
                name, _, value = part.partition("=")
                self.variables[name.strip()] = self.value(value) if value.strip() else 0.0
            return False
        first = self.word(line)
        if first in FRAMES:
            self.frame_block(first, line)
            return False
        if first == "MSG" or first in ("STOPRE", "WORKPIECE"):
            return False
        match = re.match(r"L(\d+)\s*(?:P(\d+))?$", line)
        if match:
            self.call(f"L{match.group(1)}", int(match.group(2) or 1))
            return False
        if re.match(r"(R\d+|[A-Z_][A-Z0-9_]{2,})\s*=", line) and not re.match(r"(CR|AR|RND|CHR|CHF|TURN|SPOS)\s*=", line):
            tokens = Tokens(line, self.variables)
            values = {}
            while not tokens.end():
                name = tokens.take()
                tokens.take("=")
                values[name] = tokens.expression()
            self.variables.update(values)
            return False
        if first in ("MCALL", "HOLES", "CYCLE"):
            self.cycle_line(line)
            return False
        if re.match(r"([A-Z][A-Z_]{2,}[A-Z0-9_]*)\s*(?:P(\d+))?$", line) and first not in ("SUPA", "RET", "DIAMON", "DIAMOF", "DIAM"):
            match = re.match(r"([A-Z0-9_]+)\s*(?:P(\d+))?$", line)
            self.call(match.group(1), int(match.group(2) or 1))
            return False
        return self.words_block(line)

    def call(self, name, count):
        self.done_corner()
        path = next((os.path.join(self.include or "", f) for f in (f"{name}.SPF", f"{name}.MPF")
                     if self.include and os.path.exists(os.path.join(self.include, f))), None)
        if path is None:
            raise Invalid(f"no file of {name}")
        with open(path) as f:
            text = f.read()
        for _ in range(count):
            line = self.line
            try:
                self.program(text)
            except Return:
                pass
            self.line = line

    def done_corner(self):
        if self.corner is not None:
            raise Invalid("corner without its second line")

    def frame_block(self, name, line):
        self.done_corner()
        t, named, angle = Tokens(line, self.variables), {}, None
        t.take()
        while not t.end():
            word = t.take()
            if word == "RPL":
                t.take("=")
                angle = t.expression()
                continue
            letter, rest = word[0], word[1:]
            if rest:
                value = float(rest)
                if t.peek() and t.peek()[0] == ".":
                    value = float(rest + t.take())
            elif t.peek() == "=":
                t.take()
                value = t.expression()
            else:
                value = t.factor()
            named["XYZ".index(letter)] = value
        self.unsure = {0, 1, 2}
        base = self.frame if name[0] == "A" else Frame()
        bare = name.lstrip("A") if name != "AROT" else "ROT"
        bare = {"TRANS": "TRANS", "ATRANS": "TRANS", "ROT": "ROT", "AROT": "ROT", "MIRROR": "MIRROR",
                "AMIRROR": "MIRROR"}[name]
        if bare == "TRANS":
            self.frame = base.more(identity(), [named.get(i, 0.0) * self.scale for i in range(3)])
        elif bare == "MIRROR":
            a = identity()
            for i in named:
                a[i][i] = -1.0
            self.frame = base.more(a, [0.0] * 3)
        else:
            a = identity()
            if angle is not None:
                p, q = PLANES[self.plane]
                a = rotation(p, q, angle)
            elif named:
                if len(named) > 1:
                    raise Invalid("rotation about several axes")
                (i, value), = named.items()
                a = rotation((i + 1) % 3, (i + 2) % 3, value)
            self.frame = base.more(a, [0.0] * 3)

    def words_block(self, line):
        b = Words(line, self.variables)
        g, m, w = b.g, b.m, b.words
        for code in g:
            if code in (17, 18, 19):
                self.plane = code
            if code in (70, 700):
                self.scale, self.feed_units = 25.4, 25.4 if code == 700 else 1.0
            if code in (71, 710):
                self.scale, self.feed_units = 1.0, 1.0
            if code in (90, 91):
                self.absolute = code == 90
            if code in (93, 94, 95):
                self.feed_mode = code
            if code in OFFSETS or code == 500:
                self.done_corner()
                old, self.work, self.chosen = self.work, list(OFFSETS.get(code, (0.0, 0.0, 0.0))), True
                self.unsure |= {i for i in range(3) if old[i] != self.work[i]}
        if 4 in g:
            self.side("dwell", round(w["F"][1], 6))
            return False
        if "F" in w:
            self.feed = w["F"][1] * self.feed_units
        if "T" in w:
            self.tool = int(w["T"][1])
        for code in m:
            if code == 6:
                self.done_corner()
                self.pos, self.edge = [None] * 3, None
            if code not in (0, 1, 2, 5, 9, 17, 30):
                self.side("M", code)
        if "S" in w:
            self.side("S", w["S"][1])
        if "SPOS" in w:
            self.side("SPOS", w["SPOS"][1])
        if "D" in w:
            number = int(w["D"][1])
            length = LENGTHS[self.tool] if number else 0.0
            axis = 3 - sum(PLANES[17])
            if [0.0, 0.0, length] != self.length and "Z" not in w:
                self.pos[axis] = None
            self.length, self.edge = [0.0, 0.0, length], number
        moved = self.motion(b)
        if moved and self.modal:
            self.drill(*self.modal)
        for code in m:
            if code in (0, 1, 5, 9):
                self.side("M", code)
        if 17 in m or b.names & {"RET"}:
            raise Return
        return 2 in m or 30 in m

    def target_of(self, b):
        w, axes, touched = self.words(), list(self.pos), set()
        named = {i: b.words[a] for i, a in enumerate("XYZ") if a in b.words}
        for i, (how, value) in named.items():
            value *= self.scale
            absolute = how == "AC" or (how is None and self.absolute)
            if absolute:
                w[i] = value
            elif w[i] is None:
                raise Invalid("increment from a place that is not known")
            elif i in self.unsure:
                raise Invalid("increment behind a change of frame: SD42440 says what it is")
            else:
                w[i] += value
        self.unsure -= {i for i, (how, _) in named.items() if how == "AC" or (how is None and self.absolute)}
        found = self.axes(w)
        touched = {i for i in range(3) for j in named if abs(self.frame.a[i][j]) > 1e-12}
        for i in range(3):
            if i in touched:
                if found[i] is None:
                    raise Invalid("an axis of a turned frame is not known")
                axes[i] = found[i]
        sure = {i for i in touched if all(j in named for j in range(3) if abs(self.frame.a[i][j]) > 1e-12)}
        return w, axes, sure

    def motion(self, b):
        """True where the block moves the axes."""
        modal = [c for c in b.g if c in (0, 1, 2, 3)]
        if modal:
            self.mode = modal[-1]
        if not any(a in b.words for a in "XYZ") and not (self.mode in (2, 3) and any(c in b.words for c in "IJK")):
            return False
        if 53 in b.g or 153 in b.g or "SUPA" in b.names:
            self.done_corner()
            end = list(self.pos)
            for i, a in enumerate("XYZ"):
                if a in b.words:
                    end[i] = b.words[a][1] * self.scale
            if self.mode != 0 or not self.absolute:
                raise Invalid("machine coordinates without G0")
            if any(self.length):
                raise Invalid("machine coordinates with an edge in force")
            self.move("machine", end, tuple(i for i, a in enumerate("XYZ") if a in b.words))
            return True
        if not self.chosen:
            raise Invalid("no work offset was chosen")
        if self.edge is None:
            raise Invalid("no edge was chosen behind the tool change")
        if self.mode is None:
            raise Invalid("no motion code")
        w0 = self.words()
        w1, end, touched = self.target_of(b)
        corner = [k for k in ("RND", "CHR", "CHF") if k in b.words]
        if self.mode == 0:
            self.done_corner()
            if corner:
                raise Invalid("corner on a rapid")
            self.move("rapid", end, touched)
            return True
        if self.feed is None:
            raise Invalid("no feed")
        if self.mode == 1:
            if corner:
                how = {"RND": "round", "CHR": "chamfer", "CHF": "length"}[corner[0]]
                self.corner_line(end, how, b.words[corner[0]][1] * self.scale, touched)
                return True
            self.finish_corner(end)
            self.move("line", end, touched)
            return True
        self.done_corner()
        if corner:
            raise Invalid("corner on an arc")
        self.arc_words(b, w0, w1, end, touched)
        return True

    def arc_words(self, b, w0, w1, end, touched):
        p, q = PLANES[self.plane]
        ccw = self.mode == 3
        if None in (w0[p], w0[q]):
            raise Invalid("arc from a place that is not known")
        turns = int(b.words["TURN"][1]) if "TURN" in b.words else 0
        letters = "IJK"[p], "IJK"[q]
        centre = any(c in b.words for c in letters)
        if "CR" in b.words:
            c = self.centre_of_radius((w0[p], w0[q]), (w1[p], w1[q]), b.words["CR"][1] * self.scale, ccw)
        elif centre:
            c = []
            for axis, letter in zip((p, q), letters):
                how, value = b.words.get(letter, (None, 0.0))
                c.append(value * self.scale if how == "AC" else w0[axis] + value * self.scale)
            if "AR" in b.words:
                angle = math.radians(b.words["AR"][1]) * (1 if ccw else -1)
                dx, dy = w0[p] - c[0], w0[q] - c[1]
                w1 = list(w1)
                w1[p] = c[0] + dx * math.cos(angle) - dy * math.sin(angle)
                w1[q] = c[1] + dx * math.sin(angle) + dy * math.cos(angle)
                end = self.axes(w1)
                end = [a if a is not None else self.pos[i] for i, a in enumerate(end)]
        elif "AR" in b.words:
            angle = b.words["AR"][1]
            chord = math.hypot(w1[p] - w0[p], w1[q] - w0[q])
            if not 1 < angle < 359 or chord < 0.01:
                raise Invalid("arc by its angle")
            r = chord / 2 / math.sin(math.radians(angle) / 2)
            c = self.centre_of_radius((w0[p], w0[q]), (w1[p], w1[q]), r if angle <= 180 else -r, ccw)
        else:
            raise Invalid("arc without its centre")
        self.arc_by_words(w0, w1, end, touched, ccw, c, turns, 0.02)

    # ---- cycles ----
    def cycle_line(self, line):
        self.done_corner()
        t = Tokens(line, self.variables)
        name = t.take()
        modal = name == "MCALL"
        if modal:
            if t.end():
                self.modal = None
                return
            name = t.take()
        arguments = t.arguments()
        if modal:
            self.modal = (name, arguments)
        elif name == "HOLES1":
            self.row(*arguments)
        elif name == "HOLES2":
            self.circle(*arguments)
        else:
            self.drill(name, arguments)

    def row(self, x, y, angle, first, step, count):
        p, q = PLANES[self.plane]
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        points = [(x + (first + k * step) * c, y + (first + k * step) * s) for k in range(int(count))]
        here = self.words()
        ends = [math.hypot(here[p] / self.scale - e[0], here[q] / self.scale - e[1]) for e in (points[0], points[-1])]
        if abs(ends[0] - ends[1]) < 0.01:
            raise Invalid("both ends of a row are equally near")
        if ends[1] < ends[0]:
            points.reverse()
        self.pattern(points)

    def circle(self, x, y, r, start, step, count):
        count = int(count)
        step = 360.0 / count if not step else step
        angles = [math.radians(start + k * step) for k in range(count)]
        self.pattern([(x + r * math.cos(a), y + r * math.sin(a)) for a in angles])

    def pattern(self, points):
        if self.modal is None:
            raise Invalid("pattern without MCALL")
        p, q = PLANES[self.plane]
        for point in points:
            w = self.words()
            w[p], w[q] = point[0] * self.scale, point[1] * self.scale
            end = self.axes(w)
            n = 3 - p - q
            end[n] = self.pos[n]
            if end[p] is None or end[q] is None:
                raise Invalid("pattern in a frame that is not known")
            self.move("rapid", end, (p, q))
            self.drill(*self.modal)

    def level(self, kind, w_level, feed=None):
        """A motion along the plane's normal to a level in words."""
        p, q = PLANES[self.plane]
        n = 3 - p - q
        end = list(self.pos)
        off = self.offset()
        if not self.frame.plain(n) or self.frame.a[n][n] < 0:
            raise Invalid("cycle along an axis that is turned or mirrored")
        end[n] = self.frame.a[n][n] * w_level * self.scale + self.frame.b[n] + off[n]
        was = self.feed
        if feed is not None:
            self.feed = feed
        self.move(kind, end, (n,))
        self.feed = was

    def drill(self, name, arguments):
        a = list(arguments) + [None] * (20 - len(arguments))
        rtp, rfp, sdis, dp, dpr = a[:5]
        if self.feed is None and name != "CYCLE85":
            raise Invalid("cycle without F")
        if None in self.pos:
            raise Invalid("cycle where the place is not known")
        if not self.chosen or self.edge is None:
            raise Invalid("cycle without offset or edge")
        if not self.absolute:
            raise Invalid("cycle under G91 is not modelled")
        start, mode = rfp + abs(sdis), self.mode
        if (dp is None) == (dpr is None):
            raise Invalid("depth twice or not at all")
        depth = dp if dp is not None else rfp - abs(dpr)
        if not depth < rfp or rtp < start:
            raise Invalid("levels of a cycle")
        if name == "CYCLE86" and a[6]:
            self.side("M", int(a[6]))
        self.level("rapid", start)
        if name in ("CYCLE81", "CYCLE82"):
            self.level("line", depth)
            if name == "CYCLE82" and a[5]:
                self.side("dwell", round(a[5], 6))
        elif name == "CYCLE83":
            self.pecks(start, rfp, depth, a)
        elif name == "CYCLE85":
            self.level("line", depth, a[6] * self.feed_units)
            if a[5]:
                self.side("dwell", round(a[5], 6))
            self.level("line", start, a[7] * self.feed_units)
            self.feed = None
        elif name == "CYCLE86":
            self.level("line", depth)
            if a[5]:
                self.side("dwell", round(a[5], 6))
            self.side("SPOS", a[10] or 0.0)
            self.shift_by(a[7:10])
            self.level("rapid", start)
            self.shift_by([-(v or 0.0) for v in a[7:9]] + [rtp - start])
        else:
            raise Invalid(name)
        if name != "CYCLE86":
            self.level("rapid", rtp)
        self.mode = mode

    def shift_by(self, values):
        p, q = PLANES[self.plane]
        w = self.words()
        for i, v in zip((p, q, 3 - p - q), values):
            w[i] += (v or 0.0) * self.scale
        self.move("rapid", self.axes(w), (0, 1, 2))

    def pecks(self, start, rfp, depth, a):
        fdep, fdpr, dam, dtb, dts, frf, vari = a[5:12]
        if dam is None or vari is None:
            raise Invalid("CYCLE83 without its words")
        first = fdep if fdep is not None else rfp - abs(fdpr)
        frf = frf or 1.0
        rest, at, step = rfp - depth, rfp, rfp - first
        if not 0 < step:
            raise Invalid("first peck")
        if dam:
            raise Invalid("degression is not modelled")
        # the way ahead of the last depth: 0.6 mm up to a depth of 30 mm, a fiftieth of it beyond, 7 mm at most
        inch = self.scale
        total = (rfp - depth) * inch
        ahead = (0.6 if total <= 30 else min(total / 50, 7.0)) / inch
        k = 0
        while at - depth > 1e-9:
            at = max(at - step, depth) if at - step - depth > 1e-9 else depth
            self.level("line", at, self.feed * frf if k == 0 else None)
            k += 1
            if dtb:
                self.side("dwell", round(dtb, 6))
            if at <= depth + 1e-9:
                break
            if vari == 1:
                self.level("rapid", start)
                if dts:
                    self.side("dwell", round(dts, 6))
                self.level("rapid", min(at + ahead, start))
            else:
                self.level("line", at + 1.0 / inch)


class Words:
    """The words of a block: name -> (None, AC or IC, value)."""

    def __init__(self, line, variables):
        self.g, self.m, self.words, self.names = [], [], {}, set()
        at = 0
        while at < len(line):
            c = line[at]
            if c in " \t":
                at += 1
                continue
            name = re.match(r"(CR|AR|RND|CHR|CHF|TURN|SPOS|SUPA|RET|DIAMON|DIAMOF|DIAM90)\b", line[at:])
            if name:
                at += name.end()
                if line[at:at + 1] != "=":
                    self.names.add(name.group(1))
                    continue
                how, value, at = self.assigned(line, at + 1, variables)
                self.words[name.group(1)] = (how, value)
                continue
            letter = re.match(r"([A-Z])(=)?", line[at:])
            if not letter:
                raise Invalid(f"word {line[at:]!r}")
            at += letter.end()
            if letter.group(2):
                how, value, at = self.assigned(line, at, variables)
            else:
                number = re.match(r"\s*([+-]?(?:\d+\.?\d*|\.\d+))", line[at:])
                if not number:
                    raise Invalid(f"number {line[at:]!r}")
                how, value, at = None, float(number.group(1)), at + number.end()
            letter = letter.group(1)
            if letter == "G":
                self.g.append(int(value))
            elif letter == "M":
                self.m.append(int(value))
            elif letter != "N":
                self.words[letter] = (how, value)

    @staticmethod
    def assigned(line, at, variables):
        match = re.match(r"\s*(AC|IC)\s*\(", line[at:])
        begin = at
        if match:
            at += match.end() - 1
            begin = at
        depth = 0
        while at < len(line):
            c = line[at]
            depth += {"(": 1, ")": -1}.get(c, 0)
            if depth == 0 and c in " \t" and re.match(r"\s+[A-Z]", line[at:]):
                break
            at += 1
            if match and depth == 0:
                break
        return (match.group(1) if match else None), Tokens(line[begin:at], variables).expression(), at


class SiemensTurn(Siemens):
    """Turning: X a diameter behind DIAMON, in G90 alone behind DIAM90, a radius behind DIAMOF."""

    tools = {1: (0.0, 0.0, 0.0), 2: (5.0, 0.0, -7.0), 3: (12.5, 0.0, 41.25)}

    def __init__(self, include=None):
        super().__init__(include)
        self.plane, self.pos, self.feed_mode, self.diameter = 18, [None, 0.0, None], 95, "DIAMON"

    def words_block(self, line):
        b = Words(line, self.variables)
        for name in ("DIAMON", "DIAMOF", "DIAM90"):
            if name in b.names:
                self.diameter = name
        if "D" in b.words or "T" in b.words:
            if "T" in b.words:
                self.tool = int(b.words["T"][1])
                self.side("T", self.tool)
            number = int(b.words["D"][1]) if "D" in b.words else 1
            self.length = list(self.tools[self.tool]) if number else [0.0] * 3
            self.edge = number
            line = re.sub(r"\b[TD]\d+", "", line)
        if "LIMS" in line:
            line = re.sub(r"LIMS=\d+", "", line)
        return super().words_block(line)

    def target_of(self, b):
        if "X" in b.words:
            how, value = b.words["X"]
            absolute = how == "AC" or how is None and self.absolute
            if self.diameter == "DIAMON" or self.diameter == "DIAM90" and absolute:
                b.words["X"] = (how, value / 2)
        return super().target_of(b)
