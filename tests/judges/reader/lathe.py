"""Fanuc lathes, G-code systems A and B: B-64304EN-1, "Canned cycle", "Multiple repetitive cycle", "Direct drawing
dimension programming"; X words are diameters, R, I and K radii; axis X of the machine is a radius."""

import math
import re

from core import Invalid
from fanuc import FanucFlow
from iso import OFFSETS, Block, Iso

TOOLS = {1: (0.0, 0.0, 0.0), 2: (5.0, 0.0, -7.0), 3: (12.5, 0.0, 41.25)}
CUTS = {"A": {90: "turn", 92: "thread", 94: "face"}, "B": {77: "turn", 78: "thread", 79: "face"}}
THREAD = {"A": 32, "B": 33}


class Lathe(FanucFlow, Iso):
    axis_letters = "XZUW"

    def __init__(self, system):
        super().__init__("fanuc")
        self.dialect, self.system = "fanuc-lathe", system
        self.plane, self.pos, self.work = 18, [None, 0.0, None], list(OFFSETS[54])
        self.work[1] = 0.0
        self.feed_mode, self.pass_of = 95, None
        self.pass_words, self.depth71, self.escape71 = {}, None, None
        self.groove = None
        self.mode = 0
        self.pattern = None
        self.angle = None                          # a line by its angle alone that waits for the next one

    def mm(self, block, letter, default=None):
        value = super().mm(block, letter, default)
        if letter in ("X", "U") and letter in block.words:
            value /= 2
        return value

    def places(self, block, absolute=None):
        """{axis: target in words} from X or U, Z or W."""
        absolute = self.absolute if absolute is None else absolute
        here, named = self.words(), {}
        for i, plain, more in ((0, "X", "U"), (2, "Z", "W")):
            if plain in block.words and absolute:
                named[i] = self.mm(block, plain)
            elif plain in block.words or more in block.words:
                if here[i] is None:
                    raise Invalid("increment from a place that is not known")
                named[i] = here[i] + self.mm(block, plain if plain in block.words else more)
        return named

    def goal(self, block):
        return self.target(self.places(block), True)

    # ---- one block ----
    def execute(self, block):
        g, w = block.g, block.words
        for code in g:
            if code in (20, 21):
                self.scale = 25.4 if code == 20 else 1.0
            if code in ((98, 99) if self.system == "A" else (94, 95)):
                self.feed_mode = 94 if code in (98, 94) else 95
            if self.system == "B" and code in (90, 91):
                self.absolute = code == 90
            if self.system == "B" and code in (98, 99):
                self.back = code
        if "T" in w:
            self.tool(int(w.pop("T")))
        for code in g:
            if code in (54, 55, 56):
                self.finish_corner_open()
                self.work = [OFFSETS[code][0], 0.0, OFFSETS[code][2]]
        cycle = next((c for c in g if c in (70, 71, 72, 73, 74, 75, 76, 83, 85)), None)
        if "F" in w:
            self.feed = w["F"] * self.scale
        for m in block.m:
            if m not in (0, 1, 2, 5, 9, 30, 98, 99):
                self.side("M", m)
        if "S" in w and not (50 in g or 92 in g and self.system == "B"):
            self.side("S", w["S"])
        if 4 in g:
            self.finish_corner_open()
            letter = next(c for c in "PXU" if c in w)
            self.side("dwell", round(w[letter] * (0.001 if letter == "P" or not block.points[letter] else 1.0), 6))
        elif 28 in g or 30 in g:
            self.back_home(block)
        elif 53 in g:
            self.machine_move(block)
        elif 50 in g or (92 in g and self.system == "B"):
            self.preset_or_limit(block)
        elif cycle:
            self.finish_corner_open()
            self.pass_of = None
            getattr(self, f"g{cycle}")(block)
        else:
            self.moves(block)
        for m in block.m:
            if m in (0, 1, 5, 9):
                self.side("M", m)

    def tool(self, number):
        self.finish_corner_open()
        offset = TOOLS.get(number % 100)
        if number % 100 == 0:
            offset = (0.0, 0.0, 0.0)
        if offset is None:
            raise Invalid("tool")
        self.length = list(offset)
        self.side("T", number)

    def back_home(self, block):
        named = {}
        for i, letters in ((0, "XU"), (2, "ZW")):
            for letter in letters:
                if letter in block.words:
                    named[i] = letter
        named = self.places(block) if any(block.words.get(c, 1) for c in "XUZW" if c in block.words) else {
            i: self.words()[i] for i in named}
        self.finish_corner_open()
        from core import Motion
        end = list(self.pos)
        if named and None not in named.values():
            _, end, _ = self.target(named, True)
        axes = tuple(named) or (0, 2)
        self.emit(Motion("reference", self.pos, end, line=self.line, named="".join("XYZ"[i] for i in sorted(axes))))
        self.pos = end
        self.pass_of = None
        for i in axes:
            self.pos[i] = None

    def preset_or_limit(self, block):
        if "S" in block.words and not block.has("XZUW"):
            self.side("limit", block.words["S"])
            return
        raise Invalid("a preset on a lathe is not modelled")

    def machine_move(self, block):
        self.finish_corner_open()
        end = list(self.pos)
        for i, letter in ((0, "X"), (2, "Z")):
            if letter in block.words:
                end[i] = self.mm(block, letter)
        if self.mode != 0 and 0 not in block.g:
            raise Invalid("G53 in a feed")
        self.move("machine", end, tuple(i for i, c in ((0, "X"), (2, "Z")) if c in block.words))

    def moves(self, block):
        cuts = CUTS[self.system]
        modal = [c for c in block.g if c in (0, 1, 2, 3, THREAD[self.system]) or c in cuts]
        if modal:
            if modal[0] in cuts:
                self.finish_corner_open()
                self.pass_of, self.pass_words, self.mode = cuts[modal[0]], {}, None
            else:
                self.pass_of, self.mode = None, modal[0]
        if not block.has("XZUW") and not (self.mode in (2, 3) and block.has("IK")):
            if self.angle is None and "A" not in block.comma:
                if block.comma:
                    raise Invalid("corner word without a line")
                return
        if self.pass_of:
            return self.one_pass(block)
        if self.mode is None:
            raise Invalid("words without a motion code")
        if self.mode == THREAD[self.system]:
            self.finish_corner_open()
            _, end, touched = self.goal(block)
            return self.move("thread", end, touched)
        if self.mode == 1 and (self.angle is not None or "A" in block.comma):
            return self.drawing(block)
        self.plain(block)

    def plain(self, block):
        super().motion(block)

    # ---- drawings ----
    def drawing(self, block):
        """,A: one of X and Z follows from the angle from +Z; alone it ends where the next line comes from."""
        here = self.words()
        if None in (here[0], here[2]):
            raise Invalid("angle from a place that is not known")
        if self.feed is None:
            raise Invalid("feed motion without F")
        comma = dict(block.comma)
        angle = math.radians(comma.pop("A")) if "A" in comma else None
        named = self.places(block)
        size = next(((("round" if k == "R" else "chamfer"), v * self.scale) for k, v in comma.items()), None)
        if self.angle is not None:
            first, size1, feed = self.angle
            self.angle = None
            if angle is None or len(named) < 2:
                raise Invalid("the line behind an angle needs angle, X and Z")
            d1, d2 = (math.cos(first), math.sin(first)), (math.cos(angle), math.sin(angle))      # (Z, X)
            det = d1[0] * d2[1] - d1[1] * d2[0]
            if abs(det) < 0.05:
                raise Invalid("two lines of one angle")
            dz, dx = named[2] - here[2], named[0] - here[0]
            t = (dz * d2[1] - dx * d2[0]) / det
            s = (d1[0] * dx - d1[1] * dz) / det
            if t < 0.05 or s < 0.05:
                raise Invalid("the lines of two angles meet behind their starts")
            meet = {0: here[0] + t * d1[1], 2: here[2] + t * d1[0]}
            self.line_to(meet, size1)
            return self.line_to(named, size)
        if not named:
            self.angle = (angle, size, self.feed)
            return
        if len(named) == 2:
            raise Invalid("angle beside X and Z")
        if 0 in named:
            if abs(math.sin(angle)) < 0.05:
                raise Invalid("X on a line along Z")
            t = (named[0] - here[0]) / math.sin(angle)
        else:
            if abs(math.cos(angle)) < 0.05:
                raise Invalid("Z on a line along X")
            t = (named[2] - here[2]) / math.cos(angle)
        if t < 0.05:
            raise Invalid("the line leads against its angle")
        self.line_to({0: here[0] + t * math.sin(angle), 2: here[2] + t * math.cos(angle)}, size)

    def line_to(self, named, size):
        _, end, touched = self.target(named, True)
        if size:
            self.corner_line(end, size[0], size[1], touched)
        else:
            self.finish_corner(end)
            self.move("line", end, touched)

    def motion(self, block):
        if not block.comma and self.mode == 1 or self.mode != 1:
            return super().motion(block)
        if "A" in block.comma:
            return self.drawing(block)
        named = self.places(block)
        if not named:
            raise Invalid("corner word without a line")
        if self.feed is None:
            raise Invalid("feed motion without F")
        (k, v), = block.comma.items()
        self.line_to(named, ("round" if k == "R" else "chamfer", v * self.scale))

    # ---- single cycles ----
    def go(self, kind, x, z):
        _, end, touched = self.target({0: x, 2: z}, True)
        self.move(kind, end, touched)

    def one_pass(self, block):
        if block.comma:
            raise Invalid("corner word in a cycle")
        here = self.words()
        if None in (here[0], here[2]):
            raise Invalid("cycle from a place that is not known")
        if self.feed is None:
            raise Invalid("cycle without F")
        named = self.places(block)
        for i in named:
            self.pass_words[i] = named[i] - (here[i] if i in () else 0.0)
        if "R" in block.words:
            self.pass_words["R"] = self.mm(block, "R")
        if 0 not in self.pass_words or 2 not in self.pass_words:
            raise Invalid("cycle without its place")
        x, z, r = self.pass_words[0], self.pass_words[2], self.pass_words.get("R", 0.0)
        x0, z0 = here[0], here[2]
        if abs(x - x0) < 0.01 or abs(z - z0) < 0.01:
            raise Invalid("cycle without a way")
        if self.pass_of == "turn":
            self.go("rapid", x + r, z0)
            self.go("line", x, z)
            self.go("line", x0, z)
            self.go("rapid", x0, z0)
        elif self.pass_of == "thread":
            self.go("rapid", x + r, z0)
            self.go("thread", x, z)
            self.go("rapid", x0, z)
            self.go("rapid", x0, z0)
        else:
            self.go("rapid", x0, z + r)
            self.go("line", x, z)
            self.go("line", x, z0)
            self.go("rapid", x0, z0)

    def g83(self, block):
        self.hole_on_axis(block, False)

    def g85(self, block):
        self.hole_on_axis(block, True)

    def hole_on_axis(self, block, bore):
        here = self.words()
        if "X" in block.words:
            _, end, touched = self.target({0: self.places(block)[0]}, True)
            self.move("rapid", end, touched)
        here = self.words()
        if here[0] is None or abs(here[0]) > 1e-6 or here[2] is None:
            raise Invalid("hole off the axis")
        if self.feed is None or "Z" not in block.words and "W" not in block.words:
            raise Invalid("hole without Z or F")
        start, r = here[2], self.mm(block, "R", 0.0)
        level = start + r
        if "Z" in block.words and self.absolute:
            z = self.mm(block, "Z")
        elif "Z" in block.words:
            z = level + self.mm(block, "Z")
        else:
            z = level + self.mm(block, "W")
        if not z < level <= start + 1e-9:
            raise Invalid("levels of a hole")
        self.go("rapid", 0.0, level)
        q = self.mm(block, "Q")
        if q and not bore:
            at = level
            while at - q > z + 1e-9:
                at -= q
                self.go("line", 0.0, at)
                self.go("rapid", 0.0, level)
                self.go("rapid", 0.0, at + 1.0)               # drill_return_mm of the profile
        self.go("line", 0.0, z)
        if block.words.get("P"):
            self.side("dwell", round(block.words["P"] * 0.001, 6))
        if bore:
            feed, self.feed = self.feed, self.feed * 2         # bore_return_percent of the profile
            self.go("line", 0.0, level)
            self.feed = feed
        else:
            self.go("rapid", 0.0, level)
        if self.system == "A" or self.back == 98:
            self.go("rapid", 0.0, start)
        self.mode = None

    # ---- multiple cycles ----
    def contour(self, block, behind=True):
        """The blocks from P to Q, read from where the axes stand: [(kind, end, centre, ccw, feed, line)], words."""
        p, q = int(block.words["P"]), int(block.words["Q"])
        first, last = self.find(p, self.first_line()), self.find(q, self.first_line())
        if first > last or behind and first < self.line:
            raise Invalid("contour that is not behind its cycle")
        return first, last

    def first_line(self):
        """Where the program in force begins: labels are its own."""
        return self.first

    def shape(self, block, behind=True):
        """The motions of the contour, in words, and the line behind it. The axes stay where they are."""
        first, last = self.contour(block, behind)
        other = Lathe(self.system)
        other.pos, other.work, other.length = list(self.pos), list(self.work), list(self.length)
        other.scale, other.absolute, other.feed, other.feed_mode = self.scale, self.absolute, self.feed, self.feed_mode
        other.locals, other.variables = [dict(self.locals[-1])], dict(self.variables)
        other.lines, other.programs = self.lines, self.programs
        other.mode = None
        for i in range(first, last + 1):
            other.line = i + 1
            text = re.sub(r"^/?\s*N\d+\s*", "", self.lines[i]).strip()
            if text:
                b = other.read(text)
                if any(c not in (0, 1, 2, 3) for c in b.g) or b.m or "T" in b.words or "S" in b.words:
                    raise Invalid("codes in a contour")
                other.execute(b)
        if other.corner is not None or other.angle is not None:
            raise Invalid("corner at the end of a contour")
        off = self.offset()
        moves = []
        for e in other.events:
            if isinstance(e, tuple):
                continue
            moves.append((e, [a - b for a, b in zip(e.end, off)],
                          None if e.centre is None else (e.centre[0] - off[2], e.centre[1] - off[0])))
        return moves, last

    def g70(self, block):
        here = list(self.pos)
        feed = self.feed
        moves, last = self.shape(block, False)
        for e, end, centre in moves:
            self.feed = e.feed[1] if e.feed else self.feed
            self.line = e.line
            self.move(e.kind, e.end, (0, 2), centre=e.centre, plane=e.plane, ccw=e.ccw)
        self.move("rapid", here, (0, 2))
        if any(e.feed for e, _, _ in moves):
            feed = [e.feed[1] for e, _, _ in moves if e.feed][-1]
        self.feed = feed

    def g71(self, block):
        if "P" not in block.words:
            self.depth71, self.escape71 = self.depth_of(block, "U"), self.mm(block, "R")
            return
        self.rough(block, 0)

    def g72(self, block):
        if "P" not in block.words:
            self.depth71, self.escape71 = self.depth_of(block, "W"), self.mm(block, "R")
            return
        self.rough(block, 2)

    def depth_of(self, block, letter):
        """Depth of cut: a radius, whatever X is."""
        return self.length_of(letter, block.words[letter], block.points[letter]) * self.scale

    def rough(self, block, axis):
        """G71 (axis 0: down in X, along Z) and G72 (axis 2): type I."""
        if self.depth71 is None or self.escape71 is None or self.feed is None:
            raise Invalid("roughing without depth, escape or F")
        along = 2 - axis
        feed = self.feed
        x0, _, z0 = self.words()
        if x0 is None or z0 is None:
            raise Invalid("roughing from a place that is not known")
        start = {0: x0, 2: z0}
        shift = {0: self.mm(block, "U", 0.0), 2: self.mm(block, "W", 0.0)}
        moves, last = self.shape(block)
        first = moves[0][0]
        named = {i for i in (0, 2) if abs(first.end[i] - first.start[i]) > 1e-9}
        if along in named:
            raise Invalid("type II is not modelled")
        sign = 1.0 if moves[0][1][axis] < start[axis] else -1.0         # cutting towards lower X (Z)
        points = self.sampled(moves, shift)
        way = -1.0 if points[-1][1][along] < points[0][1][along] else 1.0
        for (_, a), (_, b) in zip(points, points[1:]):
            if (b[along] - a[along]) * way < -1e-9 or (b[axis] - a[axis]) * sign < -1e-9:
                raise Invalid("contour that turns back")
        kind = "rapid" if first.kind == "rapid" else "line"
        c = {0: x0 + shift[0], 2: z0 + shift[2]}
        if (shift[axis] * sign) < 0 or shift[along] * way > 0:
            raise Invalid("allowances towards the workpiece")
        self.at(c, "rapid")
        bottom, top = points[0][1][axis], points[-1][1][axis]
        level, e = c[axis], self.escape71
        if (c[axis] - top) * sign < -1e-9:
            raise Invalid("start within the contour")
        while True:
            if (level - sign * self.depth71 - bottom) * sign <= 1e-9:
                break
            level -= sign * self.depth71
            if any(abs(v[axis] - level) < 1e-6 for _, v in points):
                raise Invalid("a pass along a flat of the contour hangs on rounding")
            self.at({axis: level, along: c[along]}, kind)
            hit = self.crossing(points, axis, along, level, sign)
            self.at({axis: level, along: hit}, "line")
            self.at({axis: level + sign * e, along: hit - way * e}, "rapid")
            self.at({axis: level + sign * e, along: c[along]}, "rapid")
        if (level - bottom) * sign > 1e-9:
            self.final = True
        self.at({axis: bottom, along: c[along]}, kind)
        for event, end, centre in moves[1:]:
            place = {0: end[0] + shift[0], 2: end[2] + shift[2]}
            if event.kind == "arc":
                _, target, touched = self.target(place, True)
                off = self.offset()
                self.move("arc", target, (0, 2), centre=(centre[0] + shift[2] + off[2], centre[1] + shift[0] + off[0]),
                          plane=(2, 0), ccw=event.ccw)
            else:
                self.at(place, event.kind)
        self.at(start, "rapid")
        self.feed = feed
        self.jump_to = last + 1

    def at(self, place, kind):
        self.go(kind, place[0], place[2])

    def sampled(self, moves, shift):
        """Points of the contour off by the allowances."""
        found = []
        off = self.offset()
        for event, end, _ in moves:
            count = 1 if event.kind != "arc" else 400
            if not found:
                found.append((event, {0: end[0] + shift[0], 2: end[2] + shift[2]}))
                continue
            for k in range(1, count + 1):
                v = event.at(k / count)
                found.append((event, {0: v[0] - off[0] + shift[0], 2: v[2] - off[2] + shift[2]}))
        return found

    @staticmethod
    def crossing(points, axis, along, level, sign):
        for (_, a), (_, b) in zip(points, points[1:]):
            if (a[axis] - level) * sign <= 1e-12 < (b[axis] - level) * sign:
                t = (level - a[axis]) / (b[axis] - a[axis])
                return a[along] + t * (b[along] - a[along])
        return points[-1][1][along]

    def g74(self, block):
        self.pecks(block, 2)

    def g75(self, block):
        self.pecks(block, 0)

    def pecks(self, block, axis):
        """G74 (pecks along Z) and G75 (along X)."""
        if not block.has("XZUW"):
            self.groove = self.length_of("R", block.words["R"], block.points["R"]) * self.scale
            return
        if self.groove is None or self.feed is None:
            raise Invalid("grooves without their return or F")
        across = 2 - axis
        here = self.words()
        start = {0: here[0], 2: here[2]}
        if None in start.values():
            raise Invalid("cycle from a place that is not known")
        named = self.places(block)
        if axis not in named:
            raise Invalid("no depth")
        end = {**start, **named}
        if "R" in block.words and block.words["R"]:
            raise Invalid("relief")
        lengths = {"P": None, "Q": None}
        for letter in "PQ":
            if letter in block.words:
                lengths[letter] = block.words[letter] * (0.001 if self.scale == 1.0 else 0.0001) * self.scale
        step, other = (lengths["Q"], lengths["P"]) if axis == 2 else (lengths["P"], lengths["Q"])
        if not step:
            raise Invalid("no peck")
        down = 1.0 if end[axis] > start[axis] else -1.0
        side = 1.0 if end[across] > start[across] else -1.0
        here = start[across]
        while True:
            at = start[axis]
            while (end[axis] - at) * down > step + 1e-9:
                at += down * step
                self.at({axis: at, across: here}, "line")
                self.at({axis: at - down * self.groove, across: here}, "rapid")
            self.at({axis: end[axis], across: here}, "line")
            self.at({axis: start[axis], across: here}, "rapid")
            if abs(end[across] - here) < 1e-9:
                break
            if not other:
                raise Invalid("no step aside")
            here = here + side * other if (end[across] - here) * side > other + 1e-9 else end[across]
            self.at({axis: start[axis], across: here}, "rapid")
        self.at(start, "rapid")

    def g73(self, block):
        if "P" not in block.words:
            self.pattern = (self.depth_of(block, "U"), self.depth_of(block, "W"), block.words["R"])
            return
        if self.pattern is None or self.feed is None:
            raise Invalid("pattern without its relief or F")
        feed, (relief_x, relief_z, count) = self.feed, self.pattern
        count = int(count)
        x0, _, z0 = self.words()
        if None in (x0, z0) or count < 2:
            raise Invalid("pattern from a place that is not known")
        u, w = self.mm(block, "U", 0.0), self.mm(block, "W", 0.0)
        moves, last = self.shape(block)
        off = self.offset()
        for k in range(count):
            share = (count - 1 - k) / (count - 1)
            shift = {0: relief_x * share + u, 2: relief_z * share + w}
            self.at({0: x0 + shift[0], 2: z0 + shift[2]}, "rapid")
            for event, end, centre in moves:
                place = {0: end[0] + shift[0], 2: end[2] + shift[2]}
                if event.kind == "arc":
                    _, target, touched = self.target(place, True)
                    self.move("arc", target, (0, 2), plane=(2, 0), ccw=event.ccw,
                              centre=(centre[0] + shift[2] + off[2], centre[1] + shift[0] + off[0]))
                else:
                    self.at(place, event.kind)
        self.at({0: x0, 2: z0}, "rapid")
        self.feed, self.jump_to = feed, last + 1

    def g76(self, block):
        raise Invalid("G76 is not modelled")

    jump_to = None

    def block(self, text, depth):
        self.jump_to = None
        return super().block(text, depth)

    def statement(self, text, pc, first, loops):
        found = super().statement(text, pc, first, loops)
        return found
