"""Expressions in square brackets with # variables: Fanuc's custom macro B and RS274/NGC."""

import math
import re

from core import Invalid

TOKEN = re.compile(r"\s*(?:(\d+\.?\d*|\.\d+)|([A-Z]+)|(#)|(<[^>]*>)|(\*\*|[-+*/\[\],=]))")
RANKS = {
    "fanuc": [("AND", "OR", "XOR"), ("EQ", "NE", "GT", "GE", "LT", "LE"), ("+", "-"), ("*", "/", "MOD")],
    "ngc": [("AND", "OR", "XOR"), ("EQ", "NE", "GT", "GE", "LT", "LE"), ("+", "-"), ("*", "/", "MOD"), ("**",)],
}
UNARY = {
    "SIN": lambda a: math.sin(math.radians(a)), "COS": lambda a: math.cos(math.radians(a)),
    "TAN": lambda a: math.tan(math.radians(a)), "ASIN": lambda a: math.degrees(math.asin(a)),
    "ACOS": lambda a: math.degrees(math.acos(a)), "SQRT": math.sqrt, "ABS": abs,
    "ROUND": lambda a: math.floor(a + 0.5) if a >= 0 else -math.floor(-a + 0.5), "LN": math.log, "EXP": math.exp,
}


class Expr:
    """One text; `variables` is asked by number or name, None being Fanuc's empty."""

    def __init__(self, text, variables, kind):
        self.tokens, at = [], 0
        text = text.upper().strip()
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise Invalid(f"expression {text!r}")
            self.tokens.append(match.group(0).strip())
            at = match.end()
        self.at, self.variables, self.kind = 0, variables, kind

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def take(self, wanted=None):
        token = self.peek()
        if token is None or (wanted and token != wanted):
            raise Invalid(f"{wanted} expected in {self.tokens}")
        self.at += 1
        return token

    def whole(self):
        found = self.rank(0)
        if self.peek() is not None:
            raise Invalid(f"{self.tokens[self.at:]} left over")
        return found

    def rank(self, level):
        if level == len(RANKS[self.kind]):
            return self.factor()
        left = self.rank(level + 1)
        while self.peek() in RANKS[self.kind][level]:
            sign = self.take()
            left = self.apply(sign, left, self.rank(level + 1))
        return left

    def apply(self, sign, a, b):
        if sign in ("EQ", "NE") and (a is None or b is None):
            return float((a is b) == (sign == "EQ"))
        a, b = a or 0.0, b or 0.0
        if sign in ("/", "MOD") and b == 0:
            raise Invalid("division by zero")
        return {"+": lambda: a + b, "-": lambda: a - b, "*": lambda: a * b, "/": lambda: a / b,
                "MOD": lambda: math.fmod(a, b) if self.kind == "fanuc" else a - b * math.floor(a / b),
                "**": lambda: a ** b, "EQ": lambda: float(abs(a - b) < 1e-9), "NE": lambda: float(abs(a - b) >= 1e-9),
                "GT": lambda: float(a > b), "GE": lambda: float(a >= b), "LT": lambda: float(a < b),
                "LE": lambda: float(a <= b), "AND": lambda: float(bool(a) and bool(b)),
                "OR": lambda: float(bool(a) or bool(b)), "XOR": lambda: float(bool(a) != bool(b))}[sign]()

    def factor(self):
        token = self.take()
        if token == "-":
            value = self.factor()
            return -(value or 0.0)
        if token == "+":
            return self.factor()
        if token == "[":
            found = self.rank(0)
            self.take("]")
            return found
        if token == "#":
            if self.peek() and self.peek().startswith("<"):
                return self.variables(self.take()[1:-1].strip().lower())
            return self.variables(int(round(self.factor())))
        if token[0].isdigit() or token[0] == ".":
            return float(token)
        if token == "ATAN":
            y = self.factor()
            self.take("/")
            x = self.factor()
            found = math.degrees(math.atan2(y, x))
            return found % 360.0 if self.kind == "fanuc" else found
        if token in ("FIX", "FUP"):
            a = self.factor()
            low, high = math.floor(a), math.ceil(a)
            if self.kind == "fanuc":
                return float(math.trunc(a)) if token == "FIX" else float(high if a > 0 else low)
            return float(low if token == "FIX" else high)
        if token in UNARY:
            return float(UNARY[token](self.factor() or 0.0))
        raise Invalid(f"{token} in an expression")


def value_at(text, at, variables, kind):
    """The value of a word that begins at `at`: number, variable or bracket. Gives (value, next place, had a point)."""
    sign, start = 1.0, at
    while at < len(text) and text[at] in "+- ":
        if text[at] == "-":
            sign = -sign
        at += 1
    number = re.match(r"\d+\.?\d*|\.\d+", text[at:])
    if number:
        return sign * float(number.group(0)), at + number.end(), "." in number.group(0)
    begin = at
    if text[at:at + 1] == "#":
        while text[at:at + 1] == "#":
            at += 1
        if text[at:at + 1] == "<":
            at = text.index(">", at) + 1
            return times(sign, Expr(text[begin:at], variables, kind).whole()), at, True
        if text[at:at + 1] != "[":
            at += re.match(r"\d*", text[at:]).end()
            return times(sign, Expr(text[begin:at], variables, kind).whole()), at, True
    name = re.match(r"[A-Z]+", text[at:])
    if name and text[at + name.end():at + name.end() + 1] == "[":
        at += name.end()
    if text[at:at + 1] != "[":
        raise Invalid(f"no value at {text[start:]!r}")
    depth = 0
    while True:
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        at += 1
        if depth == 0:
            break
        if at >= len(text):
            raise Invalid("bracket without its end")
    return times(sign, Expr(text[begin:at], variables, kind).whole()), at, True


def times(sign, value):
    return None if value is None else sign * value
