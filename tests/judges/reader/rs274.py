"""LinuxCNC's own interpreter as another reader: what it prints, made into motions in machine millimetres.

It prints four decimals, in the unit in force; work offsets stand in its variable file, tool lengths (inches) in its table.
"""

import math
import re

from common.interpreter import interpret, parameters

from core import Motion
from iso import LENGTHS, OFFSETS

CALL = re.compile(r"N\S*\s+([A-Z0-9_]+)\((.*)\)\s*$")


def read(text, turning=False):
    """(motions, None) or (None, what the interpreter says)."""
    zeros = {}
    for k, code in enumerate(sorted(OFFSETS)):
        for i, value in enumerate(OFFSETS[code]):
            zeros[5221 + 20 * k + i] = 0.0 if turning and (i == 1 or code > 56) else value / 25.4
    tools = "".join(f"T{number} P{number} Z{length / 25.4:.10f}\n" for number, length in LENGTHS.items())
    said = interpret(text, tools, parameters(zeros), 60)
    if not said.whole and "PROGRAM_STOP" not in said.calls:
        return None, said.trouble(200)
    return calls(said.calls), None


class State:
    def __init__(self):
        self.unit, self.g5x, self.g92, self.turn, self.length = 1.0, [0.0] * 3, [0.0] * 3, 0.0, [0.0] * 3
        self.plane, self.pos, self.feed, self.mode = "XY", [None] * 3, None, 94

    def axes(self, v):
        v = [a * self.unit for a in v]
        v = [a + b for a, b in zip(v, self.g92)]
        c, s = math.cos(math.radians(self.turn)), math.sin(math.radians(self.turn))
        v = [v[0] * c - v[1] * s, v[0] * s + v[1] * c, v[2]]
        return [a + b + d for a, b, d in zip(v, self.g5x, self.length)]


def calls(text):
    s, found = State(), []
    for line in text.split("\n"):
        match = CALL.search(line)
        if not match:
            continue
        name, rest = match.groups()
        values = [float(v) for v in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", rest)] if name != "COMMENT" else []
        if name == "USE_LENGTH_UNITS":
            s.unit = 25.4 if "INCHES" in rest else 1.0
        elif name == "SET_G5X_OFFSET":
            s.g5x = [v * s.unit for v in values[1:4]]
        elif name == "SET_G92_OFFSET":
            s.g92 = [v * s.unit for v in values[:3]]
        elif name == "SET_XY_ROTATION":
            s.turn = values[0]
        elif name == "USE_TOOL_LENGTH_OFFSET":
            s.length = [v * s.unit for v in values[:3]]
        elif name == "SELECT_PLANE":
            s.plane = rest[-2:]
        elif name == "SET_FEED_RATE":
            s.feed = values[0] * s.unit
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            end = s.axes(values[:3])
            found.append(Motion("rapid" if name == "STRAIGHT_TRAVERSE" else "line", s.pos, end,
                                feed=(s.mode, s.feed) if name == "STRAIGHT_FEED" else None,
                                named="" if name == "STRAIGHT_TRAVERSE" else "XYZ"))
            s.pos = end
        elif name == "ARC_FEED":
            p, q = {"XY": (0, 1), "XZ": (2, 0), "YZ": (1, 2)}[s.plane]
            v, c = [0.0] * 3, [0.0] * 3
            v[p], v[q], v[3 - p - q] = values[0], values[1], values[5]
            c[p], c[q] = values[2], values[3]
            end, centre = s.axes(v), s.axes(c)
            found.append(Motion("arc", s.pos, end, feed=(s.mode, s.feed), centre=(centre[p], centre[q]), plane=(p, q),
                                ccw=values[4] > 0, turns=abs(int(values[4])) - 1, named="XYZ"))
            s.pos = end
        elif name == "DWELL":
            found.append(("dwell", values[0]))
    return found


def differ(mine, theirs, near):
    """Mine against the interpreter's, motions that move nothing apart."""
    def clean(events):
        kept, at = [], None
        for m in events:
            if isinstance(m, tuple):
                continue
            if m.kind == "reference":
                raise NotImplementedError
            if m.kind != "arc" and at is not None and all(
                    a is not None and b is not None and abs(a - b) < 2 * near for a, b in zip(at, m.end)):
                continue
            kept.append(m)
            at = m.end
        return kept
    a, b = clean(mine), clean(theirs)
    for m, n in zip(a, b):
        kind = "rapid" if m.kind == "machine" else m.kind
        if kind != n.kind or any(x is not None and abs(x - y) > near for x, y in zip(m.end, n.end)):
            return f"\n    mine:  {m}\n    rs274: {n}"
        if m.kind == "arc" and None not in n.start:
            for k in range(1, 8):
                if any(abs(x - y) > 6 * near for x, y in zip(m.at(k / 8), n.at(k / 8))):
                    return f"\n    mine:  {m}\n    rs274: {n}"
    return None if len(a) == len(b) else f"{len(a)} of mine, {len(b)} of rs274"
