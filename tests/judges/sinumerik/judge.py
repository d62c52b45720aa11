"""Sinumerik mill programs: do the corrected ones go where the programs lead?

An interpreter of the language, written from Siemens' manuals and without the product's: an expression is evaluated by a
parser of its own, frames are 3x3 matrices with a shift, cycles are lists of heights. Program and output are both
interpreted by it; the output must stay within NEAR_MM of the program's path and the other way round, hole by hole in the
same order. NEAR_MM is ten times what the machine of the profile is crooked by: the judge finds another meaning, not a
micron (that is `vpost check`'s business, which is asked as well).

    python3 judge.py --vpost target/release/vpost --count 400 --seed 1 [--keep DIR] [--self-test] [--unseen DIR]
"""

import math
import os
import random
import re
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import cases, options, profile  # noqa: E402

NEAR_MM = 0.25
LENGTHS = {1: 120.0, 2: 80.5, 7: 95.25}
NAMES = {"MILL 12": 7}
OFFSETS = {54: (100, 80, 40), 55: (110, 75, 41), 505: (12, -14, 16), 599: (-30, 22, 5)}


class Unreadable(Exception):
    pass


# ---- expressions ---------------------------------------------------------------------------------------------------

TOKEN = re.compile(r"\s*(?:(\d+\.?\d*|\.\d+)|([A-Za-z_$][A-Za-z0-9_]*)|(==|<>|>=|<=|[-+*/()<>,]))")


class Expr:
    """Recursive descent, one method per rank of the manual's table (Job Planning, Operators)."""

    def __init__(self, text, variables):
        self.tokens, at = [], 0
        text = text.rstrip()
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise Unreadable(f"expression {text!r}")
            self.tokens.append(match.group(1) or match.group(2) or match.group(3))
            at = match.end()
        self.at, self.variables = 0, variables

    def peek(self):
        return self.tokens[self.at].upper() if self.at < len(self.tokens) else None

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def value(self):
        found = self.relation()
        if self.peek() is not None:
            raise Unreadable(f"{self.tokens[self.at:]} left")
        return found

    def relation(self):
        left = self.disjunction()
        while self.peek() in ("==", "<>", ">", "<", ">=", "<="):
            sign, right = self.next(), self.disjunction()
            left = float({"==": left == right, "<>": left != right, ">": left > right, "<": left < right,
                          ">=": left >= right, "<=": left <= right}[sign])
        return left

    def disjunction(self):
        left = self.conjunction()
        while self.peek() == "OR":
            self.next()
            right = self.conjunction()
            left = float(bool(left) or bool(right))
        return left

    def conjunction(self):
        left = self.sum()
        while self.peek() == "AND":
            self.next()
            right = self.sum()
            left = float(bool(left) and bool(right))
        return left

    def sum(self):
        left = self.product()
        while self.peek() in ("+", "-"):
            left = left + self.product() if self.next() == "+" else left - self.product()
        return left

    def product(self):
        left = self.unary()
        while self.peek() in ("*", "/"):
            left = left * self.unary() if self.next() == "*" else left / self.unary()
        return left

    def unary(self):
        if self.peek() == "-":
            self.next()
            return -self.unary()
        if self.peek() == "NOT":
            self.next()
            return float(not self.unary())
        token = self.next()
        if token == "(":
            inside = self.relation()
            if self.next() != ")":
                raise Unreadable(") expected")
            return inside
        if token[0].isdigit() or token[0] == ".":
            return float(token)
        name = token.upper()
        if self.peek() == "(":
            self.next()
            arguments = [self.relation()]
            while self.peek() == ",":
                self.next()
                arguments.append(self.relation())
            self.next()
            a = arguments[0]
            table = {
                "SIN": lambda: math.sin(math.radians(a)), "COS": lambda: math.cos(math.radians(a)),
                "TAN": lambda: math.tan(math.radians(a)), "SQRT": lambda: math.sqrt(a), "POT": lambda: a * a,
                "ABS": lambda: abs(a), "TRUNC": lambda: float(math.trunc(a)),
                "ROUND": lambda: float(math.floor(a + 0.5)),
                "ATAN2": lambda: math.degrees(math.atan2(a, arguments[1])),
            }
            if name not in table:
                raise Unreadable(name)
            return table[name]()
        if name in ("TRUE", "FALSE"):
            return float(name == "TRUE")
        if name not in self.variables:
            raise Unreadable(f"{name} is not set")
        return self.variables[name]


# ---- frames --------------------------------------------------------------------------------------------------------


def mul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def app(m, v):
    return [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]


EYE = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


class Frame:
    """place = shift + matrix * word"""

    def __init__(self):
        self.shift, self.matrix = [0.0] * 3, EYE

    def to(self, word):
        turned = app(self.matrix, word)
        return [self.shift[i] + turned[i] for i in range(3)]

    def back(self, place):
        # Rotations and mirrors: the transpose is the inverse.
        d = [place[i] - self.shift[i] for i in range(3)]
        return [sum(self.matrix[k][i] * d[k] for k in range(3)) for i in range(3)]


# ---- the interpreter -----------------------------------------------------------------------------------------------

ITEM = re.compile(
    r"\s*(?:(CYCLE\d+|HOLES[12]|MSG|GROUP_BEGIN|GROUP_END|SPOS|ADIS|TURN|CR|RPL|AR(?=\s*=)|RND|CHF|CHR)\s*(=|\()?"
    r"|([A-Z])(\d*)\s*=\s*|([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))|([A-Z]{2,}\w*))", re.I)


def brackets(text, at):
    """The text within brackets that open before `at`, and where they end."""
    depth, start, quoted = 1, at, False
    while depth:
        if at >= len(text):
            raise Unreadable("brackets")
        quoted ^= text[at] == '"'
        if not quoted:
            depth += (text[at] == "(") - (text[at] == ")")
        at += 1
    return text[start:at - 1], at


def value_end(text, at):
    """Where an assigned value ends: at a blank outside brackets and quotes."""
    depth, quoted = 0, False
    while at < len(text):
        quoted ^= text[at] == '"'
        depth += (text[at] == "(") - (text[at] == ")")
        if text[at] in " \t" and not depth and not quoted:
            break
        at += 1
    return at


class Machine:
    def __init__(self, text):
        self.blocks, self.labels = [], {}
        for line in text.splitlines():
            line = line.split(";")[0].strip() if '"' not in line else re.sub(r';(?=[^"]*$)', "\0", line).split("\0")[0].strip()
            if not line or line.startswith("%"):
                continue
            number = re.match(r"N(\d+)\s*", line, re.I)
            if number:
                self.labels.setdefault("N" + number.group(1), []).append(len(self.blocks))
                line = line[number.end():]
            label = re.match(r"([A-Za-z_]\w+)\s*:(?!=)\s*", line)
            if label:
                self.labels.setdefault(label.group(1).upper(), []).append(len(self.blocks))
                line = line[label.end():]
            self.blocks.append(line)
        self.vars, self.path, self.at = {}, [], [None] * 3
        self.offset, self.frame = None, Frame()
        self.plane, self.absolute, self.inch = 17, True, False
        self.motion, self.tool, self.loaded, self.length = 0, None, None, 0.0
        self.modal, self.ended, self.steps = None, False, 0
        # Feeds in the order in which moves took them.
        self.said, self.feed, self.feeds = [], None, []
        # A corner that waits for the next line: kind, size, both as words.
        self.corner = None

    def run(self):
        ends = self.structure()
        at, fors = 0, {}
        while at < len(self.blocks) and not self.ended:
            self.steps += 1
            if self.steps > 200000:
                raise Unreadable("runs for ever")
            line = self.blocks[at]
            word = re.match(r"[A-Za-z]+", line)
            word = word.group(0).upper() if word else ""
            follow = at + 1
            ev = lambda text: Expr(text, self.vars).value()
            if word == "DEF":
                for part in re.sub(r"^DEF\s+\w+\s+", "", line, flags=re.I).split(","):
                    name, _, first = part.partition("=")
                    self.vars[name.strip().upper()] = ev(first) if first.strip() else 0.0
            elif word in ("GOTOF", "GOTOB", "GOTO"):
                follow = self.find(at, line.split()[1], word)
            elif word == "IF":
                jump = re.search(r"\s(GOTO[FB]?)\s+(\w+)\s*$", line, re.I)
                if jump:
                    if ev(line[2:jump.start()]):
                        follow = self.find(at, jump.group(2), jump.group(1).upper())
                elif not ev(line[2:]):
                    follow = ends[at] + 1
            elif word == "ELSE":
                follow = ends[at] + 1
            elif word in ("ENDIF", "LOOP", "REPEAT"):
                pass
            elif word == "WHILE":
                if not ev(line[5:]):
                    follow = ends[at] + 1
            elif word in ("ENDWHILE", "ENDLOOP"):
                follow = ends[at]
            elif word == "UNTIL":
                if not ev(line[5:]):
                    follow = ends[at] + 1
            elif word == "FOR":
                name, first, last = re.match(r"FOR\s+(\w+)\s*=(.*?)\sTO\s(.*)$", line, re.I).groups()
                self.vars[name.upper()] = ev(first)
                fors[at] = (name.upper(), ev(last))
                if self.vars[name.upper()] > fors[at][1]:
                    follow = ends[at] + 1
            elif word == "ENDFOR":
                name, last = fors[ends[at]]
                self.vars[name] += 1
                if self.vars[name] <= last:
                    follow = ends[at] + 1
            elif re.match(r"(R\d+|[A-Za-z_]\w+)\s*=[^=]", line) and not re.match(r"(CR|RPL|AR|SPOS|ADIS|TURN|RND|CHF|CHR|[MS]\d+)\s*=", line, re.I):
                self.assign(line)
            else:
                self.block(line)
            at = follow

    def structure(self):
        """For each head its end, for each end its head."""
        ends, open_ = {}, []
        for at, line in enumerate(self.blocks):
            word = re.match(r"[A-Za-z]+", line)
            word = word.group(0).upper() if word else ""
            if word == "IF" and re.search(r"\sGOTO[FB]?\s", line, re.I):
                continue
            if word in ("IF", "WHILE", "FOR", "LOOP", "REPEAT"):
                open_.append(at)
            elif word == "ELSE":
                ends[open_[-1]] = at
                open_[-1] = at
            elif word in ("ENDIF", "ENDWHILE", "ENDFOR", "ENDLOOP", "UNTIL"):
                head = open_.pop()
                ends[head], ends[at] = at, head
        return ends

    def find(self, at, name, direction):
        places = self.labels.get(name.upper(), [])
        behind = [p for p in places if p > at]
        before = [p for p in places if p <= at]
        pick = {"GOTOF": behind, "GOTOB": before[::-1], "GOTO": behind + before}[direction]
        if not pick:
            raise Unreadable("label " + name)
        return pick[0]

    def assign(self, line):
        at = 0
        while at < len(line):
            match = re.compile(r"\s*(\w+)\s*=").match(line, at)
            if not match:
                raise Unreadable(line)
            more = re.compile(r"\s(?=[A-Za-z_]\w*\s*=[^=])").search(line, match.end())
            stop = more.start() if more else len(line)
            self.vars[match.group(1).upper()] = Expr(line[match.end():stop], self.vars).value()
            at = stop

    def block(self, line):
        words, codes, names, at = {}, [], [], 0
        if line.startswith("/"):
            raise Unreadable("block delete")
        while at < len(line) and line[at:].strip():
            match = ITEM.match(line, at)
            if not match:
                raise Unreadable(f"{line[at:]!r} in {line!r}")
            at = match.end()
            if match.group(1):
                name = match.group(1).upper()
                if match.group(2) == "=":
                    stop = value_end(line, at)
                    names.append((name, line[at:stop]))
                    at = stop
                elif match.group(2) == "(":
                    inside, at = brackets(line, at)
                    names.append((name, inside))
                else:
                    names.append((name, ""))
            elif match.group(3):
                letter = match.group(3).upper()
                stop = value_end(line, at)
                raw = line[at:stop].strip()
                at = stop
                if letter == "T" and raw.startswith('"'):
                    words["T"] = ("A", NAMES[raw.strip('"').upper()])
                    continue
                kind = re.match(r"(AC|IC)\s*\((.*)\)$", raw, re.I)
                value = Expr(kind.group(2) if kind else raw, self.vars).value()
                if letter == "M":
                    codes.append(("M", value))
                elif letter == "S":
                    pass
                else:
                    words[letter] = (kind.group(1).upper()[0] if kind else "", value)
            elif match.group(5):
                letter, value = match.group(5).upper(), float(match.group(6))
                if letter in "GM":
                    codes.append((letter, value))
                else:
                    words[letter] = ("", value)
            else:
                names.append((match.group(7).upper(), ""))
        self.execute(words, codes, names)

    def execute(self, words, codes, names):
        machine = False
        for letter, code in codes:
            if letter == "M":
                if code == 6:
                    self.loaded, self.at = self.tool, [None] * 3
                elif code in (2, 30):
                    self.ended = True
                if code not in (6,):
                    self.said.append(f"M{code:g}")
                continue
            code = int(code)
            if code in (0, 1, 2, 3):
                self.motion = code
            elif code in PLANES:
                self.plane = code
            elif code in (70, 700):
                self.inch = True
            elif code in (71, 710):
                self.inch = False
            elif code in (90, 91):
                self.absolute = code == 90
            elif code in (53, 153):
                machine = True
            elif code == 500:
                self.offset = None
            elif 54 <= code <= 57 or 505 <= code <= 599:
                self.offset = OFFSETS[code]
            elif code == 4:
                self.said.append("dwell " + "".join(f"{k}{v[1]:g}" for k, v in sorted(words.items())))
                return
            elif code not in (40, 60, 64, 94, 9, 601, 602, 641, 642):
                raise Unreadable(f"G{code}")
        unit = 25.4 if self.inch else 1.0
        if "F" in words:
            self.feed = words["F"][1]
        if "T" in words:
            self.tool = int(words["T"][1])
        if "D" in words:
            self.length = LENGTHS[self.loaded] if words["D"][1] else 0.0
        turns, corner = 0, None
        for name, inside in names:
            if name in ("TRANS", "ATRANS", "ROT", "AROT", "MIRROR", "AMIRROR"):
                rpl = [v for k, v in names if k == "RPL"]
                self.program_frame(name, words, rpl, unit)
                return
            if name == "SUPA":
                machine = True
            elif name == "TURN":
                turns = int(float(inside))
            elif name in ("RND", "CHF", "CHR"):
                corner = (name, Expr(inside, self.vars).value() * unit)
            elif name == "AR":
                words["AR"] = ("", Expr(inside, self.vars).value())
            elif name == "SPOS":
                self.said.append(f"spos {float(inside):g}")
            elif name == "CR":
                words["CR"] = ("", Expr(inside, self.vars).value())
            elif name == "MCALL":
                rest = [(k, v) for k, v in names if k.startswith("CYCLE")]
                self.modal = rest[0] if rest else None
                return
            elif name.startswith("CYCLE"):
                self.hole(name, inside, unit)
                return
            elif name.startswith("HOLES"):
                for place in self.pattern(name, inside, unit):
                    u, v, _ = PLANES[self.plane]
                    word = self.here()
                    word[u], word[v] = place
                    self.line(self.frame_to(word), 0)
                    self.hole(self.modal[0], self.modal[1], unit)
                return
        axes = [letter for letter in "XYZ" if letter in words]
        if not axes and not (self.motion in (2, 3) and any(k in words for k in "IJK")):
            return
        if machine:
            for i, letter in enumerate("XYZ"):
                if letter in words:
                    self.at[i] = words[letter][1] * unit + (self.length if i == 2 else 0)
            self.path.append(("jump", list(self.at)))
            return
        start, word = self.here(), self.here()
        for i, letter in enumerate("XYZ"):
            if letter in words:
                kind, value = words[letter]
                by = kind == "I" or (kind == "" and not self.absolute)
                if by and start[i] is None:
                    raise Unreadable("increment from nowhere")
                word[i] = (start[i] if by else 0.0) + value * unit
        if self.motion in (0, 1):
            if self.corner:
                self.cut_corner(start, word)
            self.line(self.frame_to(word), self.motion)
            self.corner = corner and (corner, start, word)
        else:
            self.arc(start, word, words, unit, turns)
        if self.modal:
            self.hole(self.modal[0], self.modal[1], unit)

    def program_frame(self, name, words, rpl, unit):
        adds, part = name.startswith("A"), name.lstrip("A") if name.startswith("A") else name
        frame = self.frame if adds else Frame()
        new = Frame()
        new.shift, new.matrix = list(frame.shift), frame.matrix
        if part == "TRANS":
            new.shift = frame.to([words.get(k, ("", 0.0))[1] * unit for k in "XYZ"])
        elif part == "ROT":
            u, v, n = PLANES[self.plane]
            angle = float(rpl[0]) if rpl else words.get("XYZ"[n], ("", 0.0))[1]
            c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            turn = [row[:] for row in EYE]
            turn[u][u], turn[u][v], turn[v][u], turn[v][v] = c, -s, s, c
            new.matrix = mul(frame.matrix, turn)
        else:
            flip = [row[:] for row in EYE]
            for i, letter in enumerate("XYZ"):
                if letter in words:
                    flip[i][i] = -1.0
            new.matrix = mul(frame.matrix, flip)
        self.frame = new

    # Axis commands: frame, work offset, tool length along Z.
    def frame_to(self, word):
        if self.offset is None:
            raise Unreadable("no work offset")
        known = [0.0 if w is None else w for w in word]
        place = self.frame.to(known)
        out = []
        for i in range(3):
            missing = any(word[k] is None and abs(self.frame.matrix[i][k]) > 1e-12 for k in range(3))
            out.append(None if missing else place[i] + self.offset[i] + (self.length if i == 2 else 0.0))
        return out

    def here(self):
        if self.offset is None or None in self.at:
            if self.offset is None or self.frame.matrix != EYE:
                return [None] * 3
            return [None if a is None else a - self.offset[i] - self.frame.shift[i] - (self.length if i == 2 else 0)
                    for i, a in enumerate(self.at)]
        place = [self.at[i] - self.offset[i] - (self.length if i == 2 else 0.0) for i in range(3)]
        return self.frame.back(place)

    def line(self, to, motion):
        to = [self.at[i] if to[i] is None else to[i] for i in range(3)]
        self.path.append(("rapid" if motion == 0 else "feed", to))
        if motion and self.feeds[-1:] != [self.feed]:
            self.feeds.append(self.feed)
        self.at = to

    def arc(self, start, end, words, unit, turns):
        u, v, n = PLANES[self.plane]
        if None in start or None in end:
            raise Unreadable("arc from nowhere")
        a, b = (start[u], start[v]), (end[u], end[v])
        clockwise = self.motion == 2
        if "AR" in words:
            swept = math.radians(words["AR"][1]) * (-1 if clockwise else 1)
            if "X" not in words and "Y" not in words and "Z" not in words or not any("XYZ"[k] in words for k in (u, v)):
                # By the centre: the end is start turned about it.
                c = [a[k] + words.get("IJK"[axis], ("", 0.0))[1] * unit for k, axis in ((0, u), (1, v))]
                spoke = complex(a[0] - c[0], a[1] - c[1]) * complex(math.cos(swept), math.sin(swept))
                b = (c[0] + spoke.real, c[1] + spoke.imag)
                end[u], end[v] = b
            else:
                # b - c = e^{i swept} (a - c)
                turn = complex(math.cos(swept), math.sin(swept))
                centre = (complex(*b) - turn * complex(*a)) / (1 - turn)
                c = (centre.real, centre.imag)
        elif "CR" in words:
            r = words["CR"][1] * unit
            dx, dy = b[0] - a[0], b[1] - a[1]
            chord = math.hypot(dx, dy)
            h = math.sqrt(max(0.0, r * r - chord * chord / 4))
            side = 1 if (clockwise == (r < 0)) else -1
            # Left of the chord for counter-clockwise below half a turn.
            c = ((a[0] + b[0]) / 2 - side * h * dy / chord, (a[1] + b[1]) / 2 + side * h * dx / chord)
        else:
            c = []
            for k, axis in ((0, u), (1, v)):
                kind, value = words.get("IJK"[axis], ("", 0.0))
                c.append(value * unit + (0.0 if kind == "A" else a[k]))
        r = math.hypot(a[0] - c[0], a[1] - c[1])
        t0, t1 = math.atan2(a[1] - c[1], a[0] - c[0]), math.atan2(b[1] - c[1], b[0] - c[0])
        sweep = (t0 - t1 if clockwise else t1 - t0) % (2 * math.pi)
        if sweep < 1e-9 or (math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-9):
            sweep = 2 * math.pi
        sweep += 2 * math.pi * turns
        steps = max(8, int(sweep / 0.02))
        for k in range(1, steps + 1):
            share = k / steps
            t = t0 + (-sweep if clockwise else sweep) * share
            word = list(end)
            word[u], word[v] = c[0] + r * math.cos(t), c[1] + r * math.sin(t)
            word[n] = start[n] + (end[n] - start[n]) * share
            if k == steps:
                word = list(end)
            self.line(self.frame_to(word), 1)

    def cut_corner(self, corner, after):
        """The last line's end is put back, and an arc or a chamfer drawn to where the next line takes over."""
        (kind, size), before, corner = self.corner
        u, v, _ = PLANES[self.plane]
        flat = lambda w: complex(w[u], w[v])
        p, at, q = flat(before), flat(corner), flat(after)
        back, on = (p - at) / abs(p - at), (q - at) / abs(q - at)
        half = math.acos(max(-1.0, min(1.0, (back * on.conjugate()).real))) / 2
        cut = {"RND": size / math.tan(half), "CHR": size, "CHF": size / 2 / math.sin(half)}[kind]

        def go(z):
            word = list(corner)
            word[u], word[v] = z.real, z.imag
            self.line(self.frame_to(word), 1)

        self.path.pop()
        go(at + cut * back)
        if kind == "RND":
            middle = at + (back + on) / abs(back + on) * size / math.sin(half)
            first, last = at + cut * back - middle, at + cut * on - middle
            ratio = last / first
            turned = math.atan2(ratio.imag, ratio.real)
            for k in range(1, 40):
                go(middle + first * complex(math.cos(turned * k / 40), math.sin(turned * k / 40)))
        go(at + cut * on)
        self.corner = None

    def arguments(self, inside):
        return [Expr(part, self.vars).value() if part.strip() else None for part in inside.split(",")]

    def hole(self, name, inside, unit):
        a = self.arguments(inside) + [None] * 20
        n = PLANES[self.plane][2]
        z = lambda value: (value or 0.0)
        rtp, rfp, sdis = z(a[0]), z(a[1]), abs(z(a[2]))
        depth = a[3] if not a[4] else rfp - abs(a[4]) * (1 if rtp > rfp else -1)
        sign = 1 if depth < rfp else -1
        near = rfp + sign * sdis

        def go(height, motion):
            word = self.here()
            word[n] = height * unit
            self.line(self.frame_to(word), motion)

        def dwell(time):
            if time:
                self.said.append(f"dwell {'F' if time > 0 else 'S'}{abs(time):g}")

        if name == "CYCLE86":
            self.said.append(f"M{int(a[6])}")
        go(near, 0)
        if name == "CYCLE85":
            self.feed = a[6]
            go(depth, 1)
            dwell(z(a[5]))
            self.feed = a[7]
            go(near, 1)
        elif name == "CYCLE86":
            go(depth, 1)
            dwell(z(a[5]))
            self.said.append(f"spos {z(a[10]):g}")
            hole, u, v = self.here(), *PLANES[self.plane][:2]
            if any(a[7:10]):
                word = self.here()
                for axis, by in zip((u, v, n), a[7:10]):
                    word[axis] += z(by) * unit
                self.line(self.frame_to(word), 0)
            go(near, 0)
            hole[n] = rtp * unit
            self.line(self.frame_to(hole), 0)
            return
        elif name in ("CYCLE81", "CYCLE82"):
            go(depth, 1)
            dwell(z(a[5]))
        elif name == "CYCLE83":
            first = abs(a[6]) if a[6] else (abs(rfp - a[5]) if a[5] is not None else abs(rfp - depth))
            total, dam, reached = abs(depth - rfp), z(a[7]), 0.0
            strokes, left, stroke = [min(first, total)], total - min(first, total), min(first, total)
            while left > 1e-9:
                stroke = max(stroke - dam, dam) if dam else stroke
                if left <= stroke + 1e-9:
                    strokes.append(left)
                    break
                if dam and left < 2 * stroke:
                    strokes += [left / 2, left / 2]
                    break
                strokes.append(stroke)
                left -= stroke
            mm = total * unit
            ahead = (a[16] or 0.0) or (0.6 if mm <= 30 else min(mm / 50, 7.0)) / unit
            back = (a[14] or 0.0) or 1.0 / unit
            for k, stroke in enumerate(strokes):
                if k:
                    if z(a[11]) == 1:
                        go(near, 0)
                        dwell(z(a[9]))
                        go(rfp - sign * reached + sign * min(ahead, abs(near - rfp) + reached), 0)
                    else:
                        go(rfp - sign * reached + sign * back, 1)
                reached += stroke
                go(rfp - sign * reached, 1)
                dwell((a[15] or z(a[8])) if k == len(strokes) - 1 else z(a[8]))
        else:
            raise Unreadable(name)
        go(rtp, 0)

    def pattern(self, name, inside, unit):
        a = [value or 0.0 for value in self.arguments(inside)] + [0.0] * 6
        count = int(a[5])
        rad = math.radians
        if name == "HOLES2":
            step = a[4] or 360.0 / count
            return [(unit * (a[0] + a[2] * math.cos(rad(a[3] + k * step))), unit * (a[1] + a[2] * math.sin(rad(a[3] + k * step))))
                    for k in range(count)]
        c, s = math.cos(rad(a[2])), math.sin(rad(a[2]))
        places = [(unit * (a[0] + (a[3] + k * a[4]) * c), unit * (a[1] + (a[3] + k * a[4]) * s)) for k in range(count)]
        u, v, _ = PLANES[self.plane]
        here = self.here()
        far = lambda p: math.hypot(p[0] - here[u], p[1] - here[v])
        return places[::-1] if far(places[-1]) < far(places[0]) else places


def interpret(text):
    machine = Machine(text)
    machine.run()
    return machine


# ---- comparison ----------------------------------------------------------------------------------------------------


def points(machine, step=2.0):
    """Samples of the feed motions, and the ends of all."""
    out, before = [], [None] * 3
    for kind, to in machine.path:
        if kind == "feed" and None not in before and None not in to:
            length = math.dist(before, to)
            for k in range(1, max(1, int(length / step)) + 1):
                share = k / max(1, int(length / step))
                out.append([before[i] + (to[i] - before[i]) * share for i in range(3)])
        elif None not in to:
            out.append(list(to))
        before = to
    return out


def distance(p, a, b):
    d = [b[i] - a[i] for i in range(3)]
    square = sum(x * x for x in d)
    t = 0.0 if square == 0 else max(0.0, min(1.0, sum((p[i] - a[i]) * d[i] for i in range(3)) / square))
    return math.dist(p, [a[i] + t * d[i] for i in range(3)])


def along(mine, theirs):
    """The farthest that `mine` comes off `theirs`, walking both in order."""
    legs = [(a[1], b[1]) for a, b in zip(theirs.path, theirs.path[1:]) if None not in a[1] and None not in b[1]]
    if not legs:
        return 0.0 if not points(mine) else math.inf
    at, worst = 0, 0.0
    for p in points(mine):
        best, where = math.inf, at
        # In order: never back by more than a leg, and to the first leg that is near, since paths cross themselves.
        for k in range(max(0, at - 1), len(legs)):
            d = distance(p, *legs[k])
            if d < best:
                best, where = d, k
            if best < NEAR_MM:
                break
        worst, at = max(worst, best), where
    return worst


def compare(program, output):
    a, b = interpret(program), interpret(output)
    far = max(along(a, b), along(b, a))
    ends = math.inf
    if None not in a.at and None not in b.at:
        ends = math.dist(a.at, b.at)
    elif [x is None for x in a.at] == [x is None for x in b.at]:
        ends = 0.0
    problems = []
    if far > NEAR_MM:
        problems.append(f"path {far:.3f} mm")
    if ends > NEAR_MM:
        problems.append(f"end {ends:.3f} mm")
    if a.feeds != b.feeds:
        problems.append(f"feeds {a.feeds} {b.feeds}")
    if a.said != b.said:
        problems.append(f"said {[x for x in zip(a.said, b.said) if x[0] != x[1]][:3]} {len(a.said)} {len(b.said)}")
    return problems


# ---- programs ------------------------------------------------------------------------------------------------------


def generate(rng):
    lines = ["%_N_JUDGE_MPF", "G17 G40 G71 G90 G94"]
    add = lines.append
    num = lambda low, high: f"{rng.uniform(low, high):.3f}".rstrip("0").rstrip(".")
    tool = rng.choice(["1", "2", '="MILL 12"'])
    add(f"T{tool}")
    add("M6")
    add("D1")
    add(rng.choice(["G54", "G55", "G505", "G599"]))
    add("S3000 M3")
    x, y = rng.uniform(10, 60), rng.uniform(10, 60)
    add(f"G0 X{x:.3f} Y{y:.3f} Z30")
    add("F500")
    variables = rng.random() < 0.5
    if variables:
        add("DEF REAL _DEEP=-5, WIDE=12.5")
        add("DEF INT COUNT, PASS")
        add("R1=10 R2=2.5")
        add("R3=R1*2+SIN(30)*R2-ATAN2(3,3)/9")

    def value(low, high):
        if variables and rng.random() < 0.3:
            text = rng.choice(["R1", "R1+R2", "WIDE*2", "R3-R2", "SQRT(POT(R1)+44)", "-(_DEEP)*3", "ABS(_DEEP)+R1*2"])
            return "=" + text
        text = num(low, high)
        return rng.choice(["", "", "="]) + text

    def by():
        text = num(-8, 8)
        return f"=IC({text})"

    frame = False
    inner = 0

    def move(depth=0):
        nonlocal frame
        kind = rng.choice(["line", "line", "rapid", "ic", "ac", "cr", "ij", "ijac", "turn", "cycle", "mcall", "holes", "frame", "angle", "corner", "bore",
                           "g91", "flow", "dwell", "words", "plane", "tool", "inch", "across", "preset"])
        if kind == "line":
            add(f"G1 X{value(5, 70)} Y{value(5, 70)} Z{num(-6, 6)}")
        elif kind == "rapid":
            add(f"G0 X{num(5, 70)} Y{num(5, 70)} Z{num(5, 30)}")
        elif kind == "ic":
            add(f"G1 X{by()} Y{rng.choice([by(), value(5, 70)])}")
        elif kind == "ac":
            add(f"G1 X=AC({num(5, 70)}) Z=AC({num(-5, 5)})")
        elif kind == "cr":
            add("G1 X20 Y20 Z0")
            turn = rng.choice([2, 3])
            add(f"G{turn} X{num(24, 30)} Y{num(21, 28)} CR={rng.choice(['', '-'])}{num(10, 30)}")
        elif kind in ("ij", "ijac"):
            add("G1 X40 Y20 Z1")
            t = rng.uniform(0.3, 6.0)
            r = rng.uniform(5, 15)
            end = (40 - r + r * math.cos(t), 20 + r * math.sin(t))
            centre = f"I{-r:.4f} J0" if kind == "ij" else f"I=AC({40 - r:.4f}) J=AC(20)"
            z = f" Z{num(-4, 4)}" if rng.random() < 0.4 else ""
            add(f"G{rng.choice([2, 3])} X{end[0]:.4f} Y{end[1]:.4f}{z} {centre}")
        elif kind == "turn":
            add("G1 X30 Y30 Z5")
            t = rng.uniform(0.5, 5.5)
            add(f"G{rng.choice([2, 3])} X{20 + 10 * math.cos(t):.4f} Y{30 + 10 * math.sin(t):.4f} Z{num(-9, 0)} I-10 J0 TURN={rng.randint(1, 3)}")
        elif kind == "cycle":
            add(f"G0 X{num(5, 70)} Y{num(5, 70)} Z20")
            add(cycle())
        elif kind == "angle":
            add("G1 X40 Y20 Z1")
            z = f" Z{num(-4, 4)}" if rng.random() < 0.4 else ""
            where = rng.choice([f"X{num(45, 60)} Y{num(5, 18)}", f"I{num(-12, -6)} J{num(-3, 3)}", f"J{num(5, 9)}"])
            add(f"G{rng.choice([2, 3])} {where}{z} AR={num(15, 340)}")
        elif kind == "corner":
            add(f"G1 X20 Y20 Z{num(-3, 3)}")
            corner = lambda: f"{rng.choice(['RND', 'CHF', 'CHR'])}={num(0.5, 3)}"
            add(f"G1 X{num(40, 60)} Y{num(15, 25)} {corner()}")
            if rng.random() < 0.5:
                add(f"X=IC({num(-6, 6)}) Y{num(45, 55)} {corner()}")
                add(f"X{num(5, 25)} Y{num(35, 60)}")
            else:
                add(f"X{num(5, 60)} Y{num(45, 55)}")
        elif kind == "bore":
            add(f"G0 X{num(5, 70)} Y{num(5, 70)} Z20")
            if rng.random() < 0.5:
                add(f"CYCLE85(15,{num(-1, 2)},1.5,,{num(4, 14)},{rng.choice(['', '0.4'])},{num(40, 90)},{num(100, 300)})")
                add(f"G1 X{num(5, 70)} Y{num(5, 70)} F500")
            else:
                aside = ",".join(rng.choice(["", num(-1, 1)]) for _ in range(3))
                add(f"CYCLE86(15,{num(-1, 2)},1.5,,{num(4, 14)},{rng.choice(['', '0.4'])},{rng.choice('34')},{aside},{num(0, 180)})")
                add("M3")
        elif kind == "mcall":
            add("G0 Z20")
            add("MCALL " + cycle())
            for _ in range(rng.randint(1, 3)):
                add(rng.choice([f"X{num(5, 70)} Y{num(5, 70)}", f"G0 X{num(5, 70)}", f"Y{by()}"]))
            add("MCALL")
        elif kind == "holes":
            add(f"G0 X{num(5, 70)} Y{num(5, 70)} Z20")
            add("MCALL " + cycle())
            if rng.random() < 0.5:
                add(f"HOLES1({num(10, 60)},{num(10, 60)},{num(-180, 180)},{num(1, 5)},{num(4, 8)},{rng.randint(1, 5)})")
            else:
                add(f"HOLES2({num(30, 50)},{num(30, 50)},{num(5, 20)},{num(-90, 90)},{rng.choice(['0', '', '25', '-40'])},{rng.randint(1, 6)})")
            add("MCALL")
        elif kind == "frame" and depth == 0:
            shift = f"X{num(-8, 8)} Y{num(-8, 8)}"
            style = rng.choice(["trans", "atrans", "rot", "transrot", "rottrans", "mirror", "off"])
            if style == "trans":
                add("TRANS " + shift)
            elif style == "atrans":
                add("TRANS " + shift)
                add(f"ATRANS X{num(-4, 4)} Z{num(-3, 3)}")
            elif style == "rot":
                add(rng.choice([f"ROT RPL={num(-120, 120)}", f"ROT Z{num(-120, 120)}"]))
            elif style == "transrot":
                add("TRANS " + shift)
                add(f"AROT RPL={num(-120, 120)}")
            elif style == "rottrans":
                add(f"ROT RPL={num(-120, 120)}")
                add(f"ATRANS X{num(-9, 9)} Y{num(-9, 9)}")
            elif style == "mirror":
                add(rng.choice(["MIRROR X0", "MIRROR Y0", "MIRROR X0 Y0"]))
            else:
                add("TRANS")
            add(f"G0 X{num(5, 60)} Y{num(5, 60)} Z30")
        elif kind == "g91":
            add("G91")
            add(f"G1 X{num(-5, 5)} Y{num(-5, 5)}")
            add(f"X=AC({num(5, 70)}) Y=IC({num(-3, 3)})")
            add("G90")
        elif kind == "flow" and variables and depth == 0:
            style = rng.choice(["for", "while", "repeat", "if", "goto"])
            if style == "for":
                add(f"FOR COUNT={rng.randint(0, 2)} TO {rng.randint(1, 4)}")
                add("G1 X=10+COUNT*3 Y=R1+COUNT Z=_DEEP")
                move(1)
                add("ENDFOR")
            elif style == "while":
                add("R10=0")
                add(f"WHILE (R10<{rng.randint(1, 4)}) AND (R1>0)")
                add("R10=R10+1")
                add("G1 X=R10*7 Y30")
                add("ENDWHILE")
            elif style == "repeat":
                add("R11=3")
                add("REPEAT")
                add("R11=R11-1")
                move(1)
                add("G1 X=R11+20 Y=R11*2")
                add(f"UNTIL R11<={rng.randint(0, 1)}")
            elif style == "if":
                add(f"IF R1{rng.choice(['>', '<', '==', '<>', '>=', '<='])}{rng.choice(['10', '5', 'R2*4'])}")
                add("G1 X11 Y12")
                add("ELSE")
                add("G1 X41 Y42")
                add("ENDIF")
            else:
                label = f"MARK{len(lines)}"
                add(f"IF NOT (R1>{rng.choice(['5', '15'])}) GOTOF {label}")
                add("G1 X33 Y34")
                add(f"{label}:")
        elif kind == "dwell":
            add(rng.choice(["G4 F0.5", "G4 S3"]))
        elif kind == "words":
            add(rng.choice(["COMPCAD", "M8", "MSG(\"PASS 1; NEXT\")", "ADIS=0.02", "G641", "G64", "SPOS=90", "S2=500 M2=3", "M1=8"]))
        elif kind == "tool" and depth == 0:
            add("TRANS")
            add("G0 SUPA Z200 D0")
            add(f"N{10 * len(lines)} T{rng.choice(['1', '2', '7'])}")
            add("M6")
            add(rng.choice(["D1", "D0", "S900 M3 D1"]))
            add(rng.choice(["G54", "G55", "G500"]))
            add(rng.choice(["G54", "G505", "G599"]))
            add(f"G0 X{num(5, 60)} Y{num(5, 60)} Z30")
            add(f"T{rng.choice(['1', '2'])}")
        elif kind == "inch" and depth == 0:
            add(rng.choice(["G70", "G700"]))
            add("G0 X1.5 Y1 Z1.2")
            add(f"G1 X=IC({num(-0.3, 0.3)}) Y{num(0.5, 2)}")
            add(f"CYCLE83(1,0.1,0.05,,{num(0.3, 1.4)},,0.25,{rng.choice(['', '0.02'])},,,1,{rng.choice('01')})")
            add(rng.choice(["G71", "G710"]))
            add("G0 X30 Y20 Z30")
        elif kind == "across" and depth == 0:
            add("TRANS")
            add("G0 X40 Y20 Z20")
            add(rng.choice(["G19", "G18"]))
            add(f"CYCLE82({num(60, 70)},{num(45, 50)},{num(0.5, 3)},{num(20, 40)},,{rng.choice(['', '0.3'])})")
            add("G17")
            add("G0 X30 Y20 Z30")
        elif kind == "preset" and variables and depth == 0:
            add(f"R{rng.randint(20, 40)}=R1*{num(1, 3)} WIDE={num(5, 20)}")
        elif kind == "plane" and not frame and depth == 0:
            add("G0 X20 Y20 Z20")
            add("TRANS")
            add("G0 X20 Y20 Z20")
            add("G18")
            add(f"G{rng.choice([2, 3])} X28 Z12 CR={num(7, 14)}")
            add("G17")

    def cycle():
        name = rng.choice(["CYCLE81", "CYCLE82", "CYCLE83"])
        rfp = rng.uniform(-2, 4)
        deep = rng.uniform(6, 45 if name == "CYCLE83" else 12)
        depth = f"{rfp - deep:.3f}," if rng.random() < 0.6 else f",{deep:.3f}"
        head = f"{rng.uniform(12, 25):.3f},{rfp:.3f},{num(0.5, 3)},{depth}"
        if name == "CYCLE81":
            return f"{name}({head})"
        if name == "CYCLE82":
            return f"{name}({head},{rng.choice(['0.5', '-3', '', '0'])})"
        first = rng.uniform(3, deep)
        peck = f"{rfp - first:.3f}," if rng.random() < 0.5 else f",{first:.3f}"
        dam = rng.choice(["", "0", num(0.5, 3)])
        tail = rng.choice(["", ",0.2,0.3,1", ",0.2,,,"])
        vari = rng.choice(["0", "1"])
        full = f"{name}({head},{peck},{dam},{rng.choice(['', '0.2'])},{rng.choice(['', '0.4'])},{rng.choice(['1', ''])},{vari}"
        more = rng.choice(["", ",,,2.5", ",3,,0,0.7", ",,,,,1.5"])
        return full + more + ")"

    for _ in range(rng.randint(4, 12)):
        move()
    add("G0 Z40")
    add("G0 SUPA Z200 D0")
    add("M30")
    return "\n".join(lines) + "\n"


SELF = "G17 G71 G90 G54\nT1\nM6\nD1\nG0 X10 Y10 Z20\nF100\n"


def self_test():
    """Right outputs pass, wrong ones fail."""
    pairs = [
        ("G1 X=IC(5) Y20", "G1 X15 Y20", "G1 X5 Y20"),
        ("TRANS X5 Y2\nG1 X20 Y20", "G1 X25 Y22", "G1 X20 Y20"),
        ("TRANS X5 Y2\nROT RPL=90\nG1 X20 Y10", "G1 X-10 Y20", "G1 X-5 Y22"),
        ("ROT RPL=90\nATRANS X10\nG1 X1 Y2 Z3", "G1 X-2 Y11 Z3", "G1 X8 Y1 Z3"),
        ("MIRROR X0\nG1 X20 Y10", "G1 X-20 Y10", "G1 X20 Y-10"),
        ("G3 X20 Y20 CR=10", "G3 X20 Y20 I0 J10", "G3 X20 Y20 I10 J0"),
        ("G3 X20 Y20 CR=-10", "G3 X20 Y20 I10 J0", "G3 X20 Y20 I0 J10"),
        ("G2 X20 Y20 I=AC(20) J=AC(10)", "G2 X20 Y20 I10 J0", "G2 X20 Y20 I20 J10"),
        ("CYCLE81(15,0,2,,8)", "G0 Z2\nG1 Z-8\nG0 Z15", "G0 Z2\nG1 Z8\nG0 Z15"),
        ("CYCLE81(15,0,2,-8)", "G0 Z2\nG1 Z-8\nG0 Z15", "G0 Z2\nG1 Z-8\nG0 Z2"),
        ("MCALL CYCLE81(15,0,2,-8)\nHOLES2(30,30,10,0,0,2)\nMCALL",
         "G0 X40 Y30\nG0 Z2\nG1 Z-8\nG0 Z15\nG0 X20 Y30\nG0 Z2\nG1 Z-8\nG0 Z15", "G0 X40 Y30\nG0 Z2\nG1 Z-8\nG0 Z15"),
        ("R1=30\nG1 X=SIN(R1)*20", "G1 X10", "G1 X-19.76"),
        ("R1=0\nREPEAT\nR1=R1+1\nG1 X=R1*10\nY=R1\nUNTIL R1>=3", "G1 X10\nY1\nX20\nY2\nX30\nY3", "G1 X10\nY1\nX20\nY2"),
        ("G3 X-10 Y10 Z0 I-10 J0 TURN=1", "G3 X10 Y10 Z6.666667 I-10 J0\nG3 X-10 Y10 Z0 I-10 J0", "G3 X-10 Y10 Z0 I-10 J0"),
        ("G3 X20 Y20 AR=90", "G3 X20 Y20 I0 J10", "G3 X20 Y20 I10 J0"),
        ("G2 I5 AR=90", "G2 X15 Y15 I5 J0", "G2 X15 Y5 I5 J0"),
        ("G1 X30 RND=4\nY30", "G1 X26\nG3 X30 Y14 I0 J4\nG1 Y30", "G1 X30\nY30"),
        ("G1 X30 CHF=4\nY30", "G1 X27.1716\nX30 Y12.8284\nY30", "G1 X26\nX30 Y14\nY30"),
        ("CYCLE85(15,0,2,-8,,,50,300)", "G0 Z2\nG1 Z-8 F50\nG1 Z2 F300\nG0 Z15", "G0 Z2\nG1 Z-8 F50\nG1 Z2\nG0 Z15"),
        ("CYCLE86(15,0,2,-8,,,3,-1,0,0,90)", "M3\nG0 Z2\nG1 Z-8\nSPOS=90\nG0 X9\nZ2\nX10 Z15", "M3\nG0 Z2\nG1 Z-8\nSPOS=90\nG0 Z2\nZ15"),
        ("CYCLE82(15,0,2,-8,,0.5)", "G0 Z2\nG1 Z-8\nG4 F0.5\nG0 Z15", "G0 Z2\nG1 Z-8\nG0 Z15"),
    ]
    bad = 0
    for program, right, wrong in pairs:
        found = compare(SELF + program + "\n", SELF + right + "\n"), compare(SELF + program + "\n", SELF + wrong + "\n")
        if found[0] or not found[1]:
            bad += 1
            print("self-test:", program.replace("\n", " | "), found)
    print(f"self-test: {len(pairs)} pairs, {bad} misjudged")
    return bad


def one(case):
    unseen = case.options.unseen
    if unseen:
        with open(os.path.join(unseen, case.number), encoding="latin-1") as file:
            program = file.read()
    else:
        program = generate(random.Random(f"{case.options.seed}/{case.number}"))
    case.write("in.nc", program)
    mill = profile.crooked_mill("sinumerik")
    mill["tool"].update(lengths_mm={f"H{n}": length for n, length in LENGTHS.items()}, names=NAMES)
    mill["work_offsets_mm"].update({f"G{n}": offset for n, offset in OFFSETS.items()})
    flags = ["-m", mill.write(case.folder), "--zero", "true", "-d", "sinumerik"]
    done = case.correct(*flags)
    if done:
        try:
            for problem in compare(program, done[0]):
                case.find("wrong", problem)
            case.check(bool(case.found), *flags)
        except (Unreadable, KeyError, IndexError, TypeError) as error:
            case.find("unreadable", repr(error))
    if unseen:
        print(case.number, "refused: " + " ".join(case.refused[1]) if case.refused else case.found or "within")
    case.tally["within"] += not (case.found or case.refused)


def main():
    words = options.parser(__doc__, 200, "first")
    words.add_argument("--unseen", metavar="DIR", help="judge the programs of this folder instead")
    given = words.parse_args()
    bad = self_test() if given.self_test else 0
    return int(bool(bad)) | cases.campaign(given, one, sorted(os.listdir(given.unseen)) if given.unseen else None)


if __name__ == "__main__":
    sys.exit(main())
