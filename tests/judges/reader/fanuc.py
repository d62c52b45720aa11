"""Flow of Fanuc's custom macro B (Fanuc, Haas, Mitsubishi, lathes): B-63944EN, "Custom macro"; M98, M99, M97 of Haas."""

import re

import expr
from core import Invalid

ARGUMENTS = dict(A=1, B=2, C=3, I=4, J=5, K=6, D=7, E=8, F=9, H=11, M=13, Q=17, R=18, S=19, T=20, U=21, V=22, W=23,
                 X=24, Y=25, Z=26)


class FanucFlow:
    """Mixed into an interpreter of blocks: which blocks come, one after the other."""

    steps = 40000

    def load(self, text):
        lines = []
        for line in text.split("\n"):
            for part in (line.split(";") if self.o["semicolon"] == "block" and "(" not in line else [line]):
                lines.append(self.strip(part))
        self.lines = lines
        self.programs = {}
        for i, line in enumerate(lines):
            match = re.match(r"[O:](\d+)", line)
            if match:
                self.programs.setdefault(int(match.group(1)), i)

    def look(self, name):
        if name == 0:
            return None
        table = self.locals[-1] if 1 <= name <= 33 else self.variables
        return table.get(name)

    def assign(self, name, value):
        (self.locals[-1] if 1 <= name <= 33 else self.variables)[name] = value

    def run(self, text):
        self.load(text)
        self.locals = [{}]
        starts = sorted(self.programs.values())
        start = starts[0] if starts else 0
        if starts and any(line for line in self.lines[:start] if line.strip("% ")):
            start = 0
        self.program(start, 0)
        self.finish_corner_open()
        return self.events

    def program(self, start, depth):
        """Runs from a line until M99 or the end; gives True where the whole run has ended."""
        if depth > 8:
            raise Invalid("calls too deep")
        pc, loops = start, {}
        first = start
        while pc < len(self.lines):
            self.steps -= 1
            if self.steps < 0:
                raise Invalid("too many steps")
            text, self.line = self.lines[pc], pc + 1
            pc += 1
            text = text.strip()
            if text.startswith("%"):
                continue
            match = re.match(r"[O:]\d+", text)
            if match:
                if pc - 1 != first:
                    return True                       # into the next program: the end of this one was missing
                text = text[match.end():].strip()
            text = re.sub(r"^/?\s*N\d+\s*", "", text).strip()
            if not text:
                continue
            jump = self.statement(text, pc, first, loops)
            if jump is not None:
                pc = jump
                continue
            if text.startswith("#") or re.match(r"(IF|WH|DO|EN|GO)", text):
                continue
            self.go_on_at, self.first = None, first
            ended = self.block(text, depth)
            if not ended and self.go_on_at is not None:      # M99 P of what was called
                pc, self.go_on_at = self.find(int(self.go_on_at), first), None
            if getattr(self, "jump_to", None):
                pc, self.jump_to = self.jump_to, None        # behind the contour of a lathe's cycle
            if ended:
                return ended == "all"
        return True

    def find(self, label, first):
        pattern = re.compile(rf"/?\s*N0*{label}(?!\d)")
        for i in range(first, len(self.lines)):
            if i > first and re.match(r"[O:]\d+", self.lines[i]):
                break
            if pattern.match(self.lines[i]):
                return i
        raise Invalid(f"no N{label}")

    def matching(self, pc, number):
        depth = 0
        for i in range(pc, len(self.lines)):
            if re.match(rf"(N\d+\s*)?(WH|DO).*DO\s*{number}\b|^DO\s*{number}\b", self.lines[i]):
                depth += 1
            if re.match(rf"(N\d+\s*)?END?\s*{number}\b", self.lines[i]):
                if depth == 0:
                    return i
                depth -= 1
        raise Invalid("DO without END")

    def evaluate(self, text):
        return expr.Expr(text, self.look, "fanuc").whole()

    def statement(self, text, pc, first, loops):
        """A line of flow. Gives the line to go on with, or None."""
        if text.startswith("#"):
            left, right = text[1:].split("=", 1)
            number = int(round(self.evaluate(left)))
            self.assign(number, self.evaluate(right))
            return None
        match = re.match(r"IF\s*(\[.*\])\s*(?:GO(?:TO)?\s*(.+)|TH(?:EN)?\s*(.+))$", text)
        if match:
            if self.evaluate(match.group(1)):
                if match.group(2):
                    return self.find(int(self.evaluate(match.group(2))), first)
                return self.statement(match.group(3), pc, first, loops)
            return None
        match = re.match(r"GO(?:TO)?\s*([\d#\[].*)$", text)
        if match:
            return self.find(int(self.evaluate(match.group(1))), first)
        match = re.match(r"WH(?:ILE)?\s*(\[.*\])\s*DO\s*(\d)$", text)
        if match:
            if self.evaluate(match.group(1)):
                loops[match.group(2)] = pc - 1
                return None
            return self.matching(pc, match.group(2)) + 1
        match = re.match(r"END?\s*(\d)$", text)
        if match:
            return loops[match.group(1)]
        return None

    def block(self, text, depth):
        block = self.read(text)
        self.o_call(block, depth)
        m = block.m
        if 65 in block.g:
            return self.macro(block, depth)
        if 98 in m or (97 in m and self.dialect == "haas"):
            return self.call(block, depth)
        if 99 in m:
            self.go_on_at = block.words.pop("P", None)
            self.execute(block)
            return "all" if depth == 0 else "sub"
        self.execute(block)
        if 2 in m or 30 in m:
            return "all"
        return None

    def o_call(self, block, depth):
        pass

    def call(self, block, depth):
        number, count = int(block.words.pop("P")), int(block.words.pop("L", 1))
        if 98 in block.m and self.dialect in ("fanuc", "fanuc-lathe") and number > 9999:
            count, number = number // 10000, number % 10000
        local = 97 in block.m
        block.m = [m for m in block.m if m not in (97, 98)]
        self.execute(block)
        for _ in range(count):
            if local:
                start = self.find(number, 0)
            elif number in self.programs:
                start = self.programs[number]
            else:
                raise Invalid(f"no O{number}")
            if self.program(start, depth + 1):
                return "all"
        return None

    def macro(self, block, depth):
        self.finish_corner_open()
        w = dict(block.words)
        number, count = int(w.pop("P")), int(w.pop("L", 1))
        if number not in self.programs:
            raise Invalid(f"no O{number}")
        arguments = {}
        for letter, value in w.items():
            arguments[ARGUMENTS[letter]] = self.length_of(letter, value, block.points[letter])
        for _ in range(count):
            self.locals.append(dict(arguments))
            ended = self.program(self.programs[number], depth + 1)
            self.locals.pop()
            if ended:
                return "all"
        return None
