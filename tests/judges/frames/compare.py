"""Compares a program with its corrected form on one control, block by block, and by the rule of added words.

Each block of the program is followed by a comment with its number, and comments come out as they went in: so it is known
which blocks of the output belong to which of the input, without any guess.

1. Motion, under every variant: each place that the output goes through in a block lies within the largest correction
   (model.Machine.limit, per axis) of the way that the input goes there, and both end at the same place within it. An axis
   that stands in the input therefore stands in the output but for a correction.
2. Words, whatever the variant: a positioning block carries its own axes only; a feed block (or a hole) may gain an axis
   only where the program has named that axis in the frame in force.
3. Where a feed's axes are all named (so that nothing hangs on a variant) its end has to be corrected at all: the machine
   model of model.py brings the tool to where the program says, within tolerance, rounding and 0.3 um for the model.
"""

import math
import re

import control

AXES = "XYZ"
MARK = re.compile(r"^[(;]@(\d+)\)?\s*$")


def with_marks(lines, dialect):
    """The program's text with a numbered comment behind each line."""
    out = []
    for k, line in enumerate(lines):
        out.append(line)
        out.append(f";@{k}" if dialect in ("balt-system", "sinumerik") else f"(@{k})")
    return "\n".join(out) + "\n"


def segments(text):
    """{number of the input line: lines of output that belong to it}, the numbers in order, what follows the last."""
    out, order, rest = {}, [], []
    for line in text.split("\n"):
        m = MARK.match(line.strip())
        if m:
            out[int(m.group(1))] = rest
            order.append(int(m.group(1)))
            rest = []
        else:
            rest.append(line)
    return out, order, rest


def distance(p, a, b, scale):
    """How far p is from the stretch a-b, in units of `scale` per axis."""
    d = [(y - x) / s for x, y, s in zip(a, b, scale)]
    v = [(y - x) / s for x, y, s in zip(a, p, scale)]
    n = sum(x * x for x in d)
    t = 0.0 if n == 0 else min(1.0, max(0.0, sum(x * y for x, y in zip(d, v)) / n))
    return max(abs(x - t * y) for x, y in zip(v, d))


class Named:
    """Which axes the program has itself named in the frame in force: the rule for added words."""

    UNSETTLED_Z = {"43", "44", "49"}

    def __init__(self, dialect, keeps=False):
        self.dialect, self.named, self.offset, self.last = dialect, set(), None, "start"
        self.keeps = keeps                       # the profile says where a tool change leaves the axes
        self.feed, self.cycle, self.incremental, self.length, self.to_initial = False, False, False, False, True

    def block(self, line):
        """Reads one block; gives (kind, own axes, axes that may be added)."""
        parsed = control.words_of(line, self.dialect)
        if parsed is None:
            return None
        skippable, words = parsed
        gs = [control.code(v) for letter, v, _ in words if letter == "G"]
        ms = [control.code(v) for letter, v, _ in words if letter == "M"]
        letters = {w[0] for w in words}
        own = letters & set(AXES)
        for g in gs:
            if g in ("0", "1", "2", "3"):
                self.feed, self.cycle = g != "0", False
            elif g == "80":
                self.cycle = False
            elif g in ("81", "82", "83", "73", "85"):
                self.cycle = True
            elif g in ("90", "91"):
                self.incremental = g == "91"
            elif g in ("98", "99"):
                self.to_initial = g == "98"
        gone = set()
        if ("6" in ms and not self.keeps) or (self.dialect == "sinumerik" and "T" in letters):
            gone, self.last = set(AXES), "M6"
        if "25" in ms and self.dialect == "centroid":
            gone, self.last = gone | {"Z"}, "M25"
        if self.UNSETTLED_Z & set(gs) or "H" in letters:
            gone = gone | {"Z"}
            self.last = next(("G" + g for g in gs if g in self.UNSETTLED_Z), "H")
        if self.length and "40" in gs and self.dialect == "perspektiva":
            gone, self.last = gone | {"Z"}, "G40"
        if "43" in gs or "44" in gs:
            self.length = True
        for g in gs:
            if g in ("53", "79", "153", "28", "30", "52", "92", "10"):
                if (g in ("28", "30") and self.dialect == "balt-system"):
                    continue
                gone, self.last = gone | own, "G" + g
                self.named -= gone
                return "left-alone", own, set()
            if g == "92.1":
                gone, self.last = gone | set(AXES), "G92.1"
            if g in ("54", "55", "56", "57", "505", "54.1"):
                if self.offset != g:
                    gone, self.last = gone | set(AXES), "G" + g
                self.offset = g
        if "4" in gs:
            return "left-alone", own, set()
        before = self.named - gone
        self.named = set(before)
        if own and not self.incremental:
            self.named |= own
        if skippable:
            self.named = before
        cycle_words = self.cycle and (own or letters & {"R"} or any(g in ("81", "82", "83", "73", "85") for g in gs))
        if cycle_words:
            if "Z" not in before and self.to_initial:
                self.named.discard("Z")          # it is back at a level that nothing named
            return "cycle", own, before | {"Z"}
        if own or (self.feed and letters & set("IJK")):
            return ("feed", own, before) if self.feed else ("rapid", own, set())
        return "none", own, set()


class Found:
    def __init__(self, kind, line, text, detail):
        self.kind, self.line, self.text, self.detail = kind, line, text, detail


def added_words(lines, out, dialect, keeps=False):
    """Rule 2."""
    found, named = [], Named(dialect, keeps)
    for k, line in enumerate(lines):
        try:
            read = named.block(line)
        except control.NotSimulated:
            return found
        if read is None:
            continue
        kind, own, allowed = read
        carried = set()
        for piece in out.get(k, []):
            try:
                parsed = control.words_of(piece, dialect)
            except control.NotSimulated:
                continue
            if parsed:
                carried |= {w[0] for w in parsed[1]} & set(AXES)
        extra = carried - own - allowed
        if extra:
            since = named.last if kind != "rapid" else "any code"
            found.append(Found(f"word added: {kind} block gains an axis" + (f" not named since {since}" if kind != "rapid" else ""), k, line,
                               f"{line!r} became {out.get(k)!r}: {''.join(sorted(extra))} not its own"))
    return found


def motion(lines, out, machine, dialect, variant, start_at):
    """Rule 1 on one control; the first violation, or None."""
    limit = machine.limit()
    a = control.Control(machine, dialect, variant, start_at)
    b = control.Control(machine, dialect, variant, start_at)
    named = Named(dialect, machine.keeps)
    for k, line in enumerate(lines):
        before_out = list(b.at)
        block = a.block(line)
        named.block(line)
        through = []
        for piece in out.get(k, []):
            made = b.block(piece)
            if made:
                through += made.places[1:]
        way = block.places if block else [tuple(a.at)]
        ends = [abs(x - y) for x, y in zip(b.at, a.at)]
        bad = [AXES[i] for i in range(3) if ends[i] > limit[i]]
        kind = block.kind if block else "none"
        if not bad:
            stretches = list(zip(way, way[1:])) or [(way[0], way[0])]
            near = 0
            for p in through:
                n = len(stretches)
                near = next((j % n for j in range(near, near + n) if distance(p, *stretches[j % n], limit) <= 1.05), None)
                if near is None:
                    return Found(f"path: {kind} goes elsewhere on its way, after {named.last}", k, line,
                                 f"under [{variant.label}] {line!r} became {out.get(k)!r}: goes through {fmt(p)}, programmed way {[fmt(w) for w in way]}")
            continue
        stands = [x for x in bad if max(abs(w[AXES.index(x)] - way[0][AXES.index(x)]) for w in way) < 1e-9]
        what = "an axis that stands moves" if stands else "an axis goes elsewhere"
        return Found(f"moved: {what} in a {kind} block, after {named.last}", k, line,
                     f"under [{variant.label}] {line!r} became {out.get(k)!r}: from {fmt(before_out)} to {fmt(b.at)}, program {fmt(way[0])} to {fmt(a.at)}, "
                     f"axis {''.join(stands or bad)}, allowed {fmt(limit)}")
    for piece in out.get("rest", []):
        b.block(piece)
    return None


def fmt(p):
    return "(" + ", ".join(f"{x:.3f}" for x in p) + ")"


def uncorrected(lines, out, machine, dialect, start_at):
    """Rule 3, on the control that the dialect assumes."""
    variant = control.variants(dialect)[0]
    a = control.Control(machine, dialect, variant, start_at)
    b = control.Control(machine, dialect, variant, start_at)
    named = Named(dialect, machine.keeps)
    for k, line in enumerate(lines):
        block = a.block(line)
        read = named.block(line)
        for piece in out.get(k, []):
            b.block(piece)
        if not block or not read or read[0] != "feed" or block.kind not in ("feed", "arc"):
            continue
        if named.named != set(AXES):
            continue
        tool = machine.default_tool if not a.length else [0.0, 0.0, -a.length]
        r, q = a.at, b.at
        if any(not machine.travel[x][0] + 1 <= r[i] <= machine.travel[x][1] - 1 for i, x in enumerate(AXES)):
            continue
        e = machine.error(q, tool)
        off = math.dist([x + y for x, y in zip(q, e)], r) * 1e3
        step = 2.54 if a.unit != 1.0 else 1.0
        allowed = 1.0 + step * math.sqrt(3) / 2 + 0.3
        if off > allowed:
            inch = "inch" if a.unit != 1.0 else "mm"
            return Found(f"uncorrected: {block.kind} ends off its place ({inch})", k, line,
                         f"{line!r} became {out.get(k)!r}: the tool ends {off:.2f} um off, allowed {allowed:.2f}; command {fmt(q)}, programmed {fmt(r)}")
    return None
