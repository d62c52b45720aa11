"""Okuma OSP: common variables, IF, GOTO, CALL and RTS; cycles that return by M53 (level of G71) or M54 (R).

Sources: OSP-P200M, P300M Programming Manual (fixed cycles, G71, M53, M54; work coordinates G15; length offsets G56; user
task: variables, branches, calls).
"""

import math
import re

from core import Invalid
from iso import Iso

TOKEN = re.compile(r"\s*(?:(\d+\.?\d*|\.\d+)|(VC\d+)|(SIN|COS|SQRT|ABS|TAN)|([-+*/\[\]])|(EQ|NE|GT|GE|LT|LE))")


class Okuma(Iso):
    steps = 40000

    def __init__(self):
        super().__init__("okuma")
        self.chosen = False
        self.locals = [{}]

    # ---- expressions ----
    def parse(self, text, at):
        """(value, place behind it, had a point)."""
        self.text, self.at = text, at
        start = at
        value = self.sum()
        plain = re.fullmatch(r"\s*[-+]?(\d+)\s*", text[start:self.at]) is not None
        return value, self.at, not plain

    def look_at(self):
        return TOKEN.match(self.text, self.at)

    def sum(self):
        left = self.product()
        while True:
            match = self.look_at()
            if not match or match.group(4) not in ("+", "-"):
                return left
            self.at = match.end()
            right = self.product()
            left = left + right if match.group(4) == "+" else left - right

    def product(self):
        left = self.factor()
        while True:
            match = self.look_at()
            if not match or match.group(4) not in ("*", "/"):
                return left
            self.at = match.end()
            right = self.factor()
            left = left * right if match.group(4) == "*" else left / right

    def factor(self):
        match = self.look_at()
        if not match:
            raise Invalid(f"expression at {self.text[self.at:]!r}")
        self.at = match.end()
        number, variable, function, sign = match.group(1, 2, 3, 4)
        if number:
            return float(number)
        if variable:
            if variable not in self.variables:
                raise Invalid(f"{variable} without a value")
            return self.variables[variable]
        if sign == "-":
            return -self.factor()
        if sign == "+":
            return self.factor()
        if function:
            match = self.look_at()
            if not match or match.group(4) != "[":
                raise Invalid("[ expected")
            self.at = match.end()
        elif sign != "[":
            raise Invalid(f"{sign} in an expression")
        inside = self.sum()
        match = self.look_at()
        if not match or match.group(4) != "]":
            raise Invalid("] expected")
        self.at = match.end()
        return inside if not function else {"SIN": lambda a: math.sin(math.radians(a)), "SQRT": math.sqrt,
                                            "COS": lambda a: math.cos(math.radians(a)), "ABS": abs,
                                            "TAN": lambda a: math.tan(math.radians(a))}[function](inside)

    def value(self, text, at):
        if text[at - 1] == "=":
            return self.parse(text, at)
        return super().value(text, at)

    # ---- flow ----
    def run(self, text):
        self.lines = [self.strip(line) for line in text.split("\n")]
        self.programs = {}
        for i, line in enumerate(self.lines):
            match = re.match(r"O(\w+)", line)
            if match:
                self.programs[match.group(1)] = i
        self.program(min(self.programs.values(), default=-1) + 1, 0)
        return self.events

    def program(self, start, depth):
        pc = start
        while pc < len(self.lines):
            self.steps -= 1
            if self.steps < 0 or depth > 8:
                raise Invalid("too many steps")
            text, self.line = self.lines[pc], pc + 1
            pc += 1
            if re.match(r"[O%$]", text):
                return True
            text = re.sub(r"^/?\s*N[A-Z0-9]+\b\s*", "", text)
            match = re.match(r"IF\s*\[(.+?)\s+(EQ|NE|GT|GE|LT|LE)\s+(.+?)\]\s*(?:GOTO\s*)?(N\w+)$", text)
            if match:
                a, b = (self.parse(match.group(k), 0)[0] for k in (1, 3))
                if {"EQ": a == b, "NE": a != b, "GT": a > b, "GE": a >= b, "LT": a < b, "LE": a <= b}[match.group(2)]:
                    pc = self.label(match.group(4), start)
                continue
            match = re.match(r"GOTO\s*(N\w+)$", text)
            if match:
                pc = self.label(match.group(1), start)
                continue
            match = re.match(r"CALL\s+O(\w+)(?:\s+Q(\d+))?$", text)
            if match:
                if match.group(1) not in self.programs:
                    raise Invalid("no such program")
                for _ in range(int(match.group(2) or 1)):
                    if self.program(self.programs[match.group(1)] + 1, depth + 1):
                        return True
                continue
            if re.match(r"RTS", text):
                return False
            match = re.match(r"(VC\d+)\s*=", text)
            if match:
                self.variables[match.group(1)] = self.parse(text, match.end())[0]
                continue
            if text:
                block = self.read(text)
                self.execute(block)
                if 2 in block.m or 30 in block.m:
                    return True
        return True

    def label(self, name, start):
        for i in range(start, len(self.lines)):
            if re.match(r"O", self.lines[i]):
                break
            if re.match(rf"/?\s*{name}\b", self.lines[i]):
                return i
        raise Invalid(f"no {name}")

    # ---- cycles ----
    def motion(self, block):
        if 15 in block.g:
            self.chosen = True
        if block.has("XYZ") and not self.chosen:
            raise Invalid("no work offset was chosen")
        super().motion(block)

    def cycle_block(self, block):
        if 15 in block.g:
            self.chosen = True
        if not self.absolute:
            raise Invalid("cycle under G91 is not modelled")
        if self.okuma_return is None:
            raise Invalid("where the cycle returns to is not said")
        if self.okuma_return == 53:
            if self.okuma_level is None:
                raise Invalid("M53 without G71")
            self.initial = self.okuma_level + self.frame.b[2] + self.offset()[2]
            self.back = 98
        else:
            self.back = 99
            self.initial = self.pos[2]
        super().cycle_block(block)
