"""Plays a turning program to the motion of the tool's tip: own reader of Fanuc lathes (systems A, B, C) and Sinumerik turning,
LinuxCNC by its own interpreter (`rs274` with a tool table). Shares no code with the product.

Rules and where they stand (Fanuc: B-64304EN-1 User's Manual, T series, Oi-D; section names):
* G-code systems A, B, C: G-code list. In C the cycles G70..G76 of A are G72..G78, G70/G71 inch and mm.
* G90 G92 G94 (A), G77 G78 G79 (B), G20 G21 G24 (C): "Canned cycle": X first, then the cut, then X back, then Z back; R is the
  taper as a radius, signed from the end of the cut to its start; modal until another code of group 01.
* G70..G76: "Multiple repetitive cycle". Blocks P..Q are passed over behind the cycle. Both formats are read: two blocks, and
  one block with D, I, K (series 10/11: D and K of a thread are depths, radius).
* ,C ,R and A: "Chamfering and corner R", "Direct drawing dimension programming"; A from +Z towards +X, degrees.
* T0101: first the tool, last two digits the offset (four digits).
* X words are diameters under diameter programming; U likewise; I, K, R of arcs are radii ("Circular interpolation").
* G41, G42: left, right of the way seen with Z to the right and X up; imaginary tips 1..9 ("Overview of tool nose radius compensation").
Sinumerik (840D sl Fundamentals, "Diameter programming"): DIAMON: X a diameter in G90 and G91, DIAM90: in G90 only, DIAMOF: a
radius; I and CR= are radii; LIMS= limits G96; RND=, CHR=, CHF= between lines; AC() and IC() by word.
LinuxCNC: tip numbers are those of X pointing down: 2 is Fanuc's 3 (tool orientation, lathe user information).
"""

import math
import re
import subprocess

import numpy as np

from common.interpreter import interpret

# Way from the nose's centre to the imaginary tip, (x, z) in radii: Fanuc's and Sinumerik's numbers, and LinuxCNC's.
TIPS = {0: (0, 0), 1: (1, 1), 2: (1, -1), 3: (-1, -1), 4: (-1, 1), 5: (0, 1), 6: (1, 0), 7: (0, -1), 8: (-1, 0), 9: (0, 0)}
LINUXCNC_TIPS = {0: (0, 0), 1: (-1, 1), 2: (-1, -1), 3: (1, -1), 4: (1, 1), 5: (0, 1), 6: (-1, 0), 7: (0, -1), 8: (1, 0), 9: (0, 0)}


class Unreadable(Exception):
    """The program says what this reader does not know."""


class Interference(Unreadable):
    """A block under compensation is shorter than its corners take: controls stop with an alarm (Fanuc PS0041)."""


class Motion:
    """One move of the tip in program coordinates, (x radius, z), mm; `arc` = (cx, cz, sweep), sweep > 0 from +Z to +X. Where the
    place before it is unknown, `named` says which of x and z it leads somewhere."""

    __slots__ = ("kind", "a", "b", "arc", "line", "state", "tool", "comp", "cycle", "named")

    def __init__(self, kind, a, b, arc=None, line=0, state=(), tool=0, comp=0, cycle=None):
        self.kind, self.a, self.b, self.arc = kind, (float(a[0]), float(a[1])), (float(b[0]), float(b[1])), arc
        self.line, self.state, self.tool, self.comp, self.cycle = line, state, tool, comp, cycle
        self.named = None

    def length(self):
        if self.arc:
            return abs(self.arc[2]) * math.hypot(self.a[0] - self.arc[0], self.a[1] - self.arc[1])
        return math.hypot(self.b[0] - self.a[0], self.b[1] - self.a[1])

    def points(self, step=0.25):
        """Samples, n x 2, start and end included."""
        if not self.arc:
            n = max(1, math.ceil(self.length() / step))
            t = np.linspace(0, 1, n + 1)[:, None]
            return np.array(self.a) + t * (np.array(self.b) - np.array(self.a))
        cx, cz, sweep = self.arc
        r0, r1 = math.hypot(self.a[0] - cx, self.a[1] - cz), math.hypot(self.b[0] - cx, self.b[1] - cz)
        n = max(4, math.ceil(abs(sweep) / math.sqrt(8 * 4e-5 / max(r0, 1e-6))))
        t = np.linspace(0, 1, n + 1)
        angle = math.atan2(self.a[0] - cx, self.a[1] - cz) + t * sweep
        r = r0 + t * (r1 - r0)
        p = np.column_stack([cx + r * np.sin(angle), cz + r * np.cos(angle)])
        p[0], p[-1] = self.a, self.b
        return p

    def heading(self, end=False):
        """Unit direction (x, z) at the start or end."""
        if self.arc:
            cx, cz, sweep = self.arc
            p = self.b if end else self.a
            rx, rz = p[0] - cx, p[1] - cz
            s = math.copysign(1.0, sweep) / math.hypot(rx, rz)
            return (rz * s, -rx * s)
        d = self.length()
        return ((self.b[0] - self.a[0]) / d, (self.b[1] - self.a[1]) / d)


def arc_by_centre(a, b, centre, clockwise):
    cx, cz = centre
    start, end = math.atan2(a[0] - cx, a[1] - cz), math.atan2(b[0] - cx, b[1] - cz)
    sweep = end - start
    if clockwise:
        while sweep >= -1e-9:
            sweep -= 2 * math.pi
    else:
        while sweep <= 1e-9:
            sweep += 2 * math.pi
    return (cx, cz, sweep)


def arc_by_radius(a, b, radius, clockwise):
    dx, dz = b[0] - a[0], b[1] - a[1]
    chord = math.hypot(dx, dz)
    if chord < 1e-9 or chord > 2 * abs(radius) + 0.02:
        raise Unreadable("an arc by R that cannot be")
    h = math.sqrt(max(radius * radius - chord * chord / 4, 0))
    # left of the way, seen with Z right and X up, is (x, z) = (-dz... ) turned from +Z to +X
    left = (dz / chord, -dx / chord)
    side = -1.0 if clockwise else 1.0
    if radius < 0:
        side = -side
    centre = (a[0] + dx / 2 + side * h * left[0], a[1] + dz / 2 + side * h * left[1])
    return arc_by_centre(a, b, centre, clockwise)


class Player:
    """State and motions of one program."""

    def __init__(self, spec):
        self.spec = spec
        self.motions, self.events = [], []
        self.x, self.z = None, None
        self.mode = 0
        self.diameter = spec.get("x", "diameter") == "diameter"
        self.absolute = True
        self.feed, self.feed_mode, self.spindle, self.speed_mode, self.limit = None, "rev", None, 97, None
        self.tool, self.offset, self.comp = 0, 0, 0
        self.m = ()
        self.pending = self.open = None
        self.line = 0
        self.scale = 1.0

    def state(self):
        return (self.feed, self.feed_mode, self.spindle, self.speed_mode, self.limit, self.tool, self.offset, self.m)

    def add(self, kind, b, arc=None, cycle=None):
        if self.x is None or self.z is None:
            if kind != "rapid":
                raise Unreadable(f"line {self.line}: feed from an unknown place")
            self.motions.append(Motion(kind, b if None not in b else (0, 0), b if None not in b else (0, 0), None, self.line, self.state(), self.offset, self.comp, "unknown"))
            self.motions[-1].named = (b[0] != self.x, b[1] != self.z)
        else:
            self.motions.append(Motion(kind, (self.x, self.z), b, arc, self.line, self.state(), self.offset, self.comp, cycle))
        self.x, self.z = b

    def go(self, kind, x, z, arc=None, cycle=None):
        self.add(kind, (x, z), arc, cycle)


WORD = re.compile(r"(,?[A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")


def blocks_of(text):
    """(line number, N, words [(letter, value, had a point)]) of a Fanuc program; comments and block skips dropped."""
    out = []
    for number, line in enumerate(text.replace("\r", "").split("\n"), 1):
        line = re.sub(r"\([^)]*\)?", "", line).split(";")[0].strip().upper()
        if not line or line.startswith(("%", ":", "/")):
            continue
        if "#" in line or re.search(r"\b(IF|WHILE|GOTO|END)\b", line):
            raise Unreadable(f"line {number}: a macro")
        words = [(m.group(1), float(m.group(2)), "." in m.group(2)) for m in WORD.finditer(line)]
        rest = WORD.sub("", line).replace(" ", "")
        if rest:
            raise Unreadable(f"line {number}: {rest[:20]}")
        n = next((int(v) for letter, v, _ in words if letter == "N"), None)
        out.append((number, n, [w for w in words if w[0] != "N"]))
    return out


# Meaning of G codes by system; what is not here is the same in all.
SYSTEMS = {
    "A": {90: "turn", 92: "threads", 94: "face", 98: "per-min", 99: "per-rev", 50: "limit", 32: "thread", 20: "inch", 21: "mm",
          70: "g70", 71: "g71", 72: "g72", 73: "g73", 74: "g74", 75: "g75", 76: "g76"},
    "B": {77: "turn", 78: "threads", 79: "face", 94: "per-min", 95: "per-rev", 92: "limit", 33: "thread", 20: "inch", 21: "mm", 90: "absolute", 91: "incremental",
          98: "nothing", 99: "nothing", 70: "g70", 71: "g71", 72: "g72", 73: "g73", 74: "g74", 75: "g75", 76: "g76"},
    "C": {20: "turn", 21: "threads", 24: "face", 94: "per-min", 95: "per-rev", 92: "limit", 33: "thread", 70: "inch", 71: "mm", 90: "absolute", 91: "incremental",
          98: "nothing", 99: "nothing", 72: "g70", 73: "g71", 74: "g72", 75: "g73", 76: "g74", 77: "g75", 78: "g76"},
}
PASSED = {4, 10, 17, 18, 19, 22, 23, 25, 26, 40, 41, 42, 43, 49, 53, 54, 55, 56, 57, 58, 59, 61, 64, 80, 96, 97, 0, 1, 2, 3, 28, 30, 83, 84, 85, 87}


class Fanuc(Player):
    def __init__(self, spec):
        super().__init__(spec)
        self.system = SYSTEMS[spec.get("g_code_system", "A")]
        self.absolute = True
        self.increments = spec.get("decimal", "increments") == "increments"
        self.cycle = None
        self.memory = {}
        self.first = {}

    def value(self, letter, v, point):
        if not point and self.increments and letter in ("X", "Z", "U", "W", "I", "K", "R", ",R", ",C", "C"):
            v = v * (0.001 if self.scale == 1 else 0.0001)
        return v * self.scale

    def play(self, text):
        self.blocks = blocks_of(text)
        index = 0
        while index < len(self.blocks):
            jump = self.block(index)
            if jump == "end":
                break
            index = jump if isinstance(jump, int) else index + 1
        if self.pending:
            raise Unreadable("a line by A without an end")
        return self

    def between(self, p, q, start):
        """Block indices of P..Q, searched from the whole program as the control does: the next ones first."""
        order = list(range(start, len(self.blocks))) + list(range(start))
        first = next((i for i in order if self.blocks[i][1] == p), None)
        if first is None:
            raise Unreadable(f"no N{p}")
        last = next((i for i in range(first, len(self.blocks)) if self.blocks[i][1] == q), None)
        if last is None:
            raise Unreadable(f"no N{q}")
        return first, last

    def ends(self, words):
        """End of a move, (x radius, z); None where an axis is unknown and not named."""
        x, z = self.x, self.z
        half = 0.5 if self.diameter else 1.0
        for letter, v, point in words:
            v = self.value(letter, v, point)
            if letter == "X":
                x = half * v if self.absolute else x + half * v
            elif letter == "Z":
                z = v if self.absolute else z + v
            elif letter == "U":
                if x is None:
                    raise Unreadable("U from an unknown place")
                x += half * v
            elif letter == "W":
                if z is None:
                    raise Unreadable("W from an unknown place")
                z += v
        return x, z

    def block(self, index):
        self.line, _, words = self.blocks[index]
        codes = [round(v * 10) / 10 for letter, v, _ in words if letter == "G"]
        codes = [int(c) if c == int(c) else c for c in codes]
        given = {letter: self.value(letter, v, point) for letter, v, point in words if letter not in "GM"}
        raw = {letter: (v, point) for letter, v, point in words if letter not in "GM"}
        motion = any(letter in "XZUW" for letter, _, _ in words)
        names = [self.system.get(c) for c in codes]
        for c in codes:
            if self.system.get(c) is None and c not in PASSED:
                raise Unreadable(f"line {self.line}: G{c}")
        if any(letter in ("Y", "V", "B", "H") or (letter == "C" and not motion) for letter, _, _ in words):
            raise Unreadable(f"line {self.line}: another axis")
        ms = [int(v) for letter, v, _ in words if letter == "M"]
        for m in ms:
            if m in (98, 99):
                raise Unreadable(f"line {self.line}: M{m}")
            self.m = (*[k for k in self.m if not ({k, m} <= {3, 4, 5} or {k, m} <= {7, 8, 9})], m)
            self.events.append(("M", m))
        if "F" in given and "g76" not in names and 4 not in codes:
            self.feed = raw["F"][0]
        if "S" in raw and "limit" not in names:
            self.spindle = raw["S"][0]
        if "T" in raw:
            t = int(raw["T"][0])
            self.tool, self.offset = (t // 100, t % 100) if t >= 100 else (t, t)
            self.events.append(("T", t))
        for c, name in zip(codes, names):
            if c in (40, 41, 42):
                self.comp = 0 if c == 40 else c
            elif c in (96, 97):
                self.speed_mode = c
            elif name == "per-min":
                self.feed_mode = "min"
            elif name == "per-rev":
                self.feed_mode = "rev"
            elif name in ("absolute", "incremental"):
                self.absolute = name == "absolute"
            elif name in ("inch", "mm"):
                self.scale = 25.4 if name == "inch" else 1.0
            elif c in (0, 1, 2, 3) or name in ("turn", "threads", "face", "thread"):
                self.mode = name or c
                self.cycle = {} if name in ("turn", "threads", "face") else None
                if self.cycle is not None:
                    self.first = (self.x, self.z)
        if "limit" in names:
            if motion:
                raise Unreadable(f"line {self.line}: a preset of coordinates")
            self.limit = raw.get("S", (None,))[0]
            return None
        if 4 in codes or 10 in codes:
            return None
        if 28 in codes or 30 in codes:
            self.events.append(("reference", "".join(sorted({letter for letter, _, _ in words if letter in "XUZW"}))))
            for letter, _, _ in words:
                if letter in "XU":
                    self.x = None
                elif letter in "ZW":
                    self.z = None
            return None
        if 53 in codes:
            for letter, _, _ in words:
                if letter in "XU":
                    self.x = None
                elif letter in "ZW":
                    self.z = None
            return None
        if any(c in (83, 84, 85, 87) for c in codes):
            return self.hole(codes, words, given)
        multiple = next((n for n in names if n in ("g70", "g71", "g72", "g73", "g74", "g75", "g76")), None)
        if multiple:
            return self.repetitive(multiple, index, words, given, raw)
        if motion or (self.mode in (1,) and ",A" in raw or "A" in raw):
            if self.cycle is not None:
                self.canned(words, given)
            else:
                self.move(words, given, raw)
        if 30 in ms or 2 in ms:
            return "end"
        return None

    def hole(self, codes, words, given):
        x, z = self.ends([w for w in words if w[0] in "XZUW"])
        face = any(c in (83, 84, 85) for c in codes)
        self.add("rapid", (x, self.z) if face else (self.x, z))
        start = (self.x, self.z)
        self.add("feed", (x, z), cycle="hole")
        self.add("rapid", start)

    def move(self, words, given, raw):
        kind = {0: "rapid", 1: "feed", 2: "feed", 3: "feed", "thread": "thread"}[self.mode]
        x, z = self.ends(words)
        angle = given.get("A", given.get(",A"))
        if angle is not None:
            angle = math.radians(angle / self.scale)
            has_x, has_z = any(letter in "XU" for letter, _, _ in words), any(letter in "ZW" for letter, _, _ in words)
            if self.pending and has_x and has_z:
                sx, sz, first, corner = self.pending
                # meets the line that ends in (x, z) under `angle`
                d = np.array([[math.sin(first), -math.sin(angle)], [math.cos(first), -math.cos(angle)]])
                t = np.linalg.solve(d, np.array([x - sx, z - sz]))
                self.pending = None
                self.corner(kind, sx + t[0] * math.sin(first), sz + t[0] * math.cos(first), corner)
            elif not has_x and not has_z:
                self.pending = (self.x, self.z, angle, self.corner_of(given, raw))
                return
            elif has_x and not has_z:
                z = self.z + (x - self.x) / math.tan(angle) if abs(math.sin(angle)) > 1e-9 else z
            elif has_z and not has_x:
                x = self.x + (z - self.z) * math.tan(angle)
        if self.mode in (2, 3):
            a, b = (self.x, self.z), (x, z)
            if "R" in given:
                arc = arc_by_radius(a, b, given["R"], self.mode == 2)
            else:
                arc = arc_by_centre(a, b, (self.x + given.get("I", 0), self.z + given.get("K", 0)), self.mode == 2)
            self.add(kind, b, arc)
            return
        self.corner(kind, x, z, self.corner_of(given, raw) if self.mode == 1 else None)

    def corner_of(self, given, raw):
        for letter in (",C", ",R", "C", "R"):
            if letter in given:
                return (letter[-1], abs(given[letter]), given[letter])
        if "I" in given or "K" in given:
            return ("C", abs(given.get("I", given.get("K", 0))), None)
        return None

    def corner(self, kind, x, z, corner):
        """A line, and the chamfer or rounding left open by the one before."""
        self.add(kind, (x, z))
        line = self.motions[-1]
        wanted, self.open = self.open, (corner, line) if corner else None
        if not wanted:
            return
        (what, size, _), before = wanted
        if before.length() < size or line.length() < 1e-9:
            raise Unreadable(f"line {self.line}: a corner longer than its line")
        u, v = before.heading(), line.heading()
        turn = math.atan2(u[1] * v[0] - u[0] * v[1], u[0] * v[0] + u[1] * v[1])
        back = size if what == "C" else size * math.tan(abs(turn) / 2)
        p = (before.b[0] - back * u[0], before.b[1] - back * u[1])
        q = (before.b[0] + back * v[0], before.b[1] + back * v[1])
        before.b = p
        line.a = q
        arc = arc_by_radius(p, q, size, turn < 0) if what == "R" and abs(turn) > 1e-9 else None
        self.motions.insert(len(self.motions) - 1, Motion("feed", p, q, arc, before.line, before.state, before.tool, before.comp))

    def canned(self, words, given):
        half = 0.5 if self.diameter else 1.0
        x0, z0 = self.first if self.first[0] is not None else (self.x, self.z)
        c = self.cycle
        for letter in "XZUW":
            if letter in given:
                c.pop({"X": "U", "U": "X", "Z": "W", "W": "Z"}[letter], None)
                c[letter] = given[letter]
        if "R" in given or "I" in given or "K" in given:
            c["R"] = given.get("R", given.get("I", given.get("K")))
        x = half * c["X"] if "X" in c and self.absolute else x0 + half * c.get("U", c.get("X", 0)) if ("U" in c or "X" in c) else x0
        z = c["Z"] if "Z" in c and self.absolute else z0 + c.get("W", c.get("Z", 0)) if ("W" in c or "Z" in c) else z0
        taper = c.get("R", 0.0)
        if self.mode == "face":
            self.add("rapid", (x0, z + taper))
            self.add("feed", (x, z), cycle="face")
            self.add("feed", (x, z0), cycle="face")
            self.add("rapid", (x0, z0))
            return
        self.add("rapid", (x + taper, z0))
        if self.mode == "threads":
            self.chamfered((x, z), x0, self.spec.get("parameters", {}).get("thread_chamfer_leads", 0.0), self.mode)
        else:
            self.add("feed", (x, z), cycle=self.mode)
        self.add("rapid" if self.mode == "threads" else "feed", (x0, z), cycle=self.mode)
        self.add("rapid", (x0, z0))

    def contour(self, first, last):
        """Motions of blocks first..last played from here, without moving."""
        child = Fanuc(self.spec)
        child.__dict__.update({k: v for k, v in self.__dict__.items()})
        child.motions, child.events, child.open, child.pending = [], [], None, None
        if self.mode not in (0, 1, 2, 3):
            child.mode = 0
        for i in range(first, last + 1):
            child.block(i)
        return child.motions

    def repetitive(self, name, index, words, given, raw):
        half = 0.5 if self.diameter else 1.0
        number = lambda letter: raw[letter][0] if letter in raw else None  # noqa: E731
        # a depth without a point counts least increments on any machine
        micro = lambda letter: None if letter not in raw else (raw[letter][0] if raw[letter][1] else raw[letter][0] * 1e-3)  # noqa: E731
        start = (self.x, self.z)
        if name == "g70":
            first, last = self.between(number("P"), number("Q"), 0)
            for m in self.contour(first, last):
                self.motions.append(m)
                self.x, self.z = m.b
                self.feed = m.state[0]
            self.add("rapid", start)
            return None
        if name in ("g71", "g72", "g73"):
            if "P" not in raw:
                self.memory[name] = {k: given[k] for k in given}
                return None
            first, last = self.between(number("P"), number("Q"), index)
            setting = self.memory.get(name, {})
            path = self.contour(first, last)
            u, w = half * given.get("U", 0), given.get("W", 0)
            if name == "g73":
                di, dk = (given["I"], given["K"]) if "D" in raw else (setting.get("U", 0), setting.get("W", 0))
                count = max(int(micro("D") and raw["D"][0] or self.memory_r(name)), 1)
                for k in range(count):
                    share = 1 - k / (count - 1) if count > 1 else 0
                    self.shifted(path, u + share * di, w + share * dk, name)
                self.add("rapid", start)
            else:
                depth = micro("D") if "D" in raw else setting.get("U" if name == "g71" else "W")
                if not depth:
                    raise Unreadable("no depth of cut")
                parameter = self.spec.get("parameters", {}).get("roughing_escape_mm")
                back = setting.get("R", parameter) if "D" not in raw else parameter
                if back is None:
                    raise Unreadable("no escape")
                self.rough(name, path, start, depth, u, w, back)
            return last + 1
        if name in ("g74", "g75"):
            if not any(k in given for k in "XZUW"):
                self.memory[name] = {k: given[k] for k in given}
                return None
            back = self.memory.get(name, {}).get("R", self.spec.get("parameters", {}).get("groove_return_mm", 0.0))
            x, z = self.ends([w for w in words if w[0] in "XZUW"])
            along, across = (micro("Q"), micro("P")) if name == "g74" else (micro("P"), micro("Q"))
            deep = abs(z - start[1]) if name == "g74" else abs(x - start[0])
            wide = abs(x - start[0]) if name == "g74" else abs(z - start[1])
            along, across = along or deep, across or wide
            if deep and not along or wide and not across:
                raise Unreadable("no step")
            places = [min(k * across, wide) for k in range(1 + math.ceil(wide / across - 1e-9))] if wide else [0.0]
            for s in places:
                sx = start[0] + math.copysign(s, x - start[0]) if name == "g74" else start[0]
                sz = start[1] if name == "g74" else start[1] + math.copysign(s, z - start[1])
                self.add("rapid", (sx, sz))
                reached = 0.0
                while reached < deep - 1e-9:
                    reached = min(reached + along, deep)
                    for sign, kind in ((0.0, "feed"), (-back, "rapid")):
                        if sign and reached >= deep - 1e-9:
                            continue
                        d = reached + sign
                        self.add(kind, (sx, start[1] + math.copysign(d, z - start[1])) if name == "g74" else (start[0] + math.copysign(d, x - start[0]), sz), cycle=name)
                self.add("rapid", (sx, sz))
            self.add("rapid", start)
            return None
        # g76
        if "X" not in given and "U" not in given and "Z" not in given and "W" not in given:
            p = int(number("P") or 0)
            self.memory["g76"] = {"m": max(p // 10000, 1), "r": p // 100 % 100 * 0.1, "a": p % 100, "least": micro("Q") or 0.0, "finish": given.get("R", 0.0)}
            return None
        s = self.memory.get("g76", {"m": 1, "r": 0.0, "a": 0, "least": 0.0, "finish": 0.0})
        x, z = self.ends([w for w in words if w[0] in "XZUW"])
        if "K" in raw:
            height, cut, taper, s = given["K"], micro("D"), given.get("I", 0.0), {"m": 1, "r": 0.0, "a": number("A") or 0, "least": 0.0, "finish": 0.0}
        else:
            height, cut, taper = micro("P"), micro("Q"), given.get("R", 0.0)
        self.feed = raw.get("F", (self.feed,))[0]
        outward = -1.0 if x + taper > start[0] else 1.0
        depth, k = 0.0, 0
        depths = []
        while depth < height - s["finish"] - 1e-9:
            k += 1
            depth = min(max(cut * math.sqrt(k), depth + s["least"]), height - s["finish"])
            depths.append(depth)
        depths += [height] * s["m"]
        for d in depths:
            dx = outward * (height - d)
            lag = (d * math.tan(math.radians(s["a"] / 2))) * (1 if z < start[1] else -1)
            self.add("rapid", (self.x, start[1] - lag))
            self.add("rapid", (x + taper + dx, start[1] - lag))
            self.chamfered((x + dx, z), start[0], s["r"], "g76")
            self.add("rapid", (start[0], z))
            self.add("rapid", start)
        return None

    def memory_r(self, name):
        r = self.memory.get(name, {}).get("R", 1)
        return round(r * 1000) if 0 < r < 0.5 else r

    def shifted(self, path, du, dw, cycle):
        for m in path:
            a, b = (m.a[0] + du, m.a[1] + dw), (m.b[0] + du, m.b[1] + dw)
            arc = (m.arc[0] + du, m.arc[1] + dw, m.arc[2]) if m.arc else None
            if (self.x, self.z) != a:
                self.add("rapid", a)
            self.motions.append(Motion(m.kind, a, b, arc, m.line, self.state(), self.offset, 0, cycle))
            self.x, self.z = b

    def rough(self, name, path, start, depth, u, w, back):
        """G71, G72 of type I: from C, which lies off the start by the allowances, down in depths of cut to the contour that lies
        off by them, out at 45 degrees, back in a rapid; then along that contour, and back to the start."""
        main, other = (0, 1) if name == "g71" else (1, 0)
        off = (u, w)
        corner = (start[0] + u, start[1] + w)
        make = lambda m, o: (m, o) if main == 0 else (o, m)  # noqa: E731
        entry, pieces = path[0], path[1:]
        deepest = entry.b[main] + off[main]
        sign = math.copysign(1.0, deepest - corner[main])
        toward = math.copysign(1.0, pieces[-1].b[other] - entry.b[other])
        self.add("rapid", corner)
        k = 1
        while (deepest - corner[main]) * sign - k * depth > 1e-7:
            level = corner[main] + sign * k * depth
            stop = pieces[-1].b[other] + off[other]
            for m in pieces:
                hit = met(m, main, level - off[main])
                if hit is not None:
                    stop = hit[other] + off[other]
                    break
            k += 1
            if (stop - corner[other]) * toward <= 0:
                continue
            short = min(back, abs(stop - corner[other]))
            self.add(entry.kind, make(level, corner[other]))
            self.add("feed", make(level, stop), cycle=name)
            self.add("rapid", make(level - sign * back, stop - toward * short))
            self.add("rapid", make(level - sign * back, corner[other]))
        # the move of block P leads to its end from wherever the tool stands
        self.add(entry.kind, (entry.b[0] + u, entry.b[1] + w))
        self.shifted(pieces, u, w, name)
        self.add("rapid", start)

    def chamfered(self, end, clear, leads, cycle):
        """A thread to `end`, its last `leads` leads going outwards under the angle of the parameter, no further than `clear`: there
        the cycle comes back in a rapid, nothing stands there, and whether the control goes further out in the air cuts nothing."""
        size = leads * (self.feed or 0.0) * self.scale
        if size <= 0:
            self.add("thread", end, cycle=cycle)
            return
        (x0, z0), (x1, z1) = (self.x, self.z), end
        t = 1 - size / abs(z1 - z0)
        begin = (x0 + t * (x1 - x0), z0 + t * (z1 - z0))
        rise = size * math.tan(math.radians(self.spec.get("parameters", {}).get("thread_chamfer_deg", 45.0)))
        made = min(1.0, abs(clear - begin[0]) / rise)
        self.add("thread", begin, cycle=cycle)
        self.add("thread", (begin[0] + math.copysign(made * rise, clear - begin[0]), begin[1] + made * (z1 - begin[1])), cycle=cycle)
        if made < 1:
            self.add("rapid", (clear, z1))


def met(m, axis, level):
    """The first place of a motion where one axis is at `level`, by halving between samples; None where it is not."""
    p = m.points(0.05)
    d = p[:, axis] - level
    for a, b, da, db in zip(p, p[1:], d, d[1:]):
        if da == 0:
            return a
        if da * db > 0:
            continue
        if not m.arc:
            return a + (b - a) * (da / (da - db))
        cx, cz, _ = m.arc
        low, high = math.atan2(a[0] - cx, a[1] - cz), math.atan2(b[0] - cx, b[1] - cz)
        if high - low > math.pi:
            high -= 2 * math.pi
        if low - high > math.pi:
            high += 2 * math.pi
        r = math.hypot(a[0] - cx, a[1] - cz)
        place = lambda angle: (cx + r * math.sin(angle), cz + r * math.cos(angle))  # noqa: E731
        for _ in range(60):
            middle = (low + high) / 2
            if (place(middle)[axis] - level) * da > 0:
                low = middle
            else:
                high = middle
        return place((low + high) / 2)
    return p[-1] if d[-1] == 0 else None


class Sinumerik(Player):
    WORD = re.compile(r"([A-Z]+\d*)\s*=\s*((?:AC|IC)\s*\(\s*[-+.\d]+\s*\)|[-+.\d]+)|([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))|(DIAMON|DIAMOF|DIAM90|DIAMCYCOF|LIMS)")

    def __init__(self, spec):
        super().__init__(spec)
        self.diam = "on" if self.diameter else "off"

    def play(self, text):
        for self.line, line in enumerate(text.replace("\r", "").split("\n"), 1):
            line = line.split(";")[0].strip().upper()
            line = re.sub(r"^/|^N\d+\s*", "", line)
            if not line or line.startswith("%"):
                continue
            for word in re.findall(r"\bDIAM(?:ON|OF|90)\b", line):
                self.diam = {"DIAMON": "on", "DIAMOF": "off", "DIAM90": "90"}[word]
            line = re.sub(r"\bDIAM(?:ON|OF|90)\b", "", line)
            words = []
            for m in self.WORD.finditer(line):
                if m.group(1):
                    words.append((m.group(1), m.group(2)))
                elif m.group(3):
                    words.append((m.group(3), m.group(4)))
            rest = self.WORD.sub("", line).replace(" ", "")
            if rest:
                raise Unreadable(f"line {self.line}: {rest[:20]}")
            if self.block(words):
                break
        return self

    def block(self, words):
        given, inc = {}, {}
        codes, ms = [], []
        for letter, value in words:
            if letter == "G":
                codes.append(int(float(value)))
            elif letter == "M":
                ms.append(int(float(value)))
            else:
                kind = value[:2] if value[:2] in ("AC", "IC") else None
                given[letter] = float(re.sub(r"[ACI()\s]", "", value))
                inc[letter] = kind
        for c in codes:
            if c in (0, 1, 2, 3, 33):
                self.mode = c
            elif c in (90, 91):
                self.absolute = c == 90
            elif c in (94, 95, 96, 97):
                self.feed_mode = {94: "min", 95: "rev"}.get(c, self.feed_mode)
                self.speed_mode = c if c > 95 else self.speed_mode
            elif c in (40, 41, 42):
                self.comp = 0 if c == 40 else c
            elif c not in (17, 18, 19, 53, 54, 55, 56, 57, 500, 60, 64, 70, 71, 450, 451, 4, 9, 500):
                raise Unreadable(f"line {self.line}: G{c}")
        if "F" in given and 4 not in codes:
            self.feed = given["F"]
        if 4 in codes:
            return False
        if "S" in given:
            self.spindle = given["S"]
        if "LIMS" in given:
            self.limit = given["LIMS"]
        if "T" in given:
            self.tool = self.offset = int(given["T"])
            self.events.append(("T", self.tool))
        for m in ms:
            self.m = (*[k for k in self.m if not ({k, m} <= {3, 4, 5} or {k, m} <= {7, 8, 9})], m)
            self.events.append(("M", m))
        if "X" in given or "Z" in given:
            x, z = self.x, self.z
            if "X" in given:
                absolute = inc["X"] == "AC" or (self.absolute and inc["X"] is None)
                half = 0.5 if self.diam == "on" or (self.diam == "90" and absolute) else 1.0
                x = half * given["X"] if absolute else x + half * given["X"]
            if "Z" in given:
                z = given["Z"] if inc["Z"] == "AC" or (self.absolute and inc["Z"] is None) else z + given["Z"]
            kind = {0: "rapid", 33: "thread"}.get(self.mode, "feed")
            if self.mode in (2, 3):
                a, b = (self.x, self.z), (x, z)
                if "CR" in given:
                    arc = arc_by_radius(a, b, given["CR"], self.mode == 2)
                else:
                    if "AC" in (inc.get("I"), inc.get("K")):
                        raise Unreadable(f"line {self.line}: an absolute centre")
                    arc = arc_by_centre(a, b, (self.x + given.get("I", 0), self.z + given.get("K", 0)), self.mode == 2)
                self.add(kind, b, arc)
            else:
                corner = next(((("C" if k == "CHR" else "R"), given[k], None) for k in ("RND", "CHR") if k in given), None)
                if "CHF" in given:
                    raise Unreadable(f"line {self.line}: CHF")
                Fanuc.corner(self, kind, x, z, corner)
        return 30 in ms or 2 in ms


def play_linuxcnc(text, spec):
    """LinuxCNC's interpreter plays it: motions of the tip in program coordinates (four decimals)."""
    tools = ""
    for name, length in (spec.get("tool", {}).get("lengths_mm") or {"H1": [0, 0, 0]}).items():
        nose = spec.get("tool", {}).get("noses", {}).get(name, {})
        # the stand-alone interpreter reads its table in inches
        tools += f"T{name[1:]} P{name[1:]} X{length[0] / 25.4:.9f} Z{length[2] / 25.4:.9f} D{2 * nose.get('radius_mm', 0) / 25.4:.9f} Q{nose.get('direction', 0)}\n"
    if not re.search(r"(?i)\bG0*[78]\b", re.sub(r"\([^)]*\)|;.*", "", text)) and spec.get("x", "radius") == "diameter":
        text = "G7\n" + text
    try:
        said = interpret(text, tools, "", 20)
    except subprocess.TimeoutExpired:
        raise Unreadable("rs274 does not end") from None
    if not said.whole and "PROGRAM_STOP" not in said.calls:
        raise Unreadable("rs274: " + said.trouble(200))
    player = Player(spec)
    sync, pos, scale = None, [0.0, 0.0], 1.0
    known = False
    for line in said.calls.splitlines():
        m = re.match(r"\s*(\d+)\s+N\S*\s+(\w+)\((.*)\)", line)
        if not m:
            continue
        name, arguments = m.group(2), m.group(3)
        numbers = [float(v) for v in re.findall(r"[-+]?\d+\.?\d*", arguments)] if not name.startswith(("COMMENT", "MESSAGE")) else []
        player.line = int(m.group(1))
        if name == "USE_LENGTH_UNITS":
            scale = 25.4 if "INCH" in arguments else 1.0
            if scale != 1.0:
                # 2.5 um a step: coarser than the tolerance
                raise Unreadable("rs274 prints four decimals of an inch")
        elif name == "SET_FEED_RATE":
            player.feed = numbers[0]
        elif name == "SET_FEED_MODE":
            player.feed_mode = "rev" if numbers[-1] else "min"
        elif name == "SET_SPINDLE_SPEED":
            player.spindle = numbers[-1]
        elif name == "SET_SPINDLE_MODE":
            player.speed_mode = 96 if numbers[-1] else 97
        elif name in ("START_SPINDLE_CLOCKWISE", "START_SPINDLE_COUNTERCLOCKWISE", "STOP_SPINDLE_TURNING", "MIST_ON", "MIST_OFF", "FLOOD_ON", "FLOOD_OFF"):
            player.m = (*[k for k in player.m if k[:4] != name[:4]], name)
            player.events.append(("M", name))
        elif name == "CHANGE_TOOL":
            player.tool = int(numbers[0])
            player.events.append(("T", player.tool))
        elif name == "USE_TOOL_LENGTH_OFFSET":
            player.offset = player.tool
        elif name.startswith("START_SPEED_FEED_SYNC"):
            sync = numbers[0]
        elif name.startswith("STOP_SPEED_FEED_SYNC"):
            sync = None
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            b = (numbers[0] * scale, numbers[2] * scale)
            kind = "rapid" if name == "STRAIGHT_TRAVERSE" else "thread" if sync else "feed"
            keep, player.feed = player.feed, (sync if sync else player.feed)
            if not known and kind == "feed":
                player.x, player.z = pos
            player.add(kind, b)
            player.feed = keep
            known = True
        elif name == "ARC_FEED":
            z, x, cz, cx, turn = (v * scale for v in numbers[:5])
            player.add("feed", (x, z), arc_by_centre((player.x, player.z), (x, z), (cx, cz), turn < 0))
    return player


def offset_path(motions, nose):
    """Tip motions of motions under G41/G42: the nose's centre keeps its radius from the contour, neighbours meet where their
    offsets cross (else joined by a line); lead-in and lead-out end square to the contour (Fanuc, type B)."""
    radius, (tx, tz) = nose
    out = []
    i = 0
    tip = lambda c: (c[0] + tx * radius, c[1] + tz * radius)  # noqa: E731
    while i < len(motions):
        m = motions[i]
        if not m.comp:
            out.append(m)
            i += 1
            continue
        j = i
        while j < len(motions) and motions[j].comp:
            j += 1
        # the first motion under compensation leads in, the first behind it leads out
        group = [k for k in motions[i + 1 : j] if k.length() > 1e-9]
        if not group:
            out += motions[i:j]
            i = j
            continue
        pieces = []
        for k in group:
            side = 1.0 if k.comp == 41 else -1.0
            normals = []
            for end in (False, True):
                hx, hz = k.heading(end)
                normals.append((side * hz, side * -hx))
            a = [k.a[0] + radius * normals[0][0], k.a[1] + radius * normals[0][1]]
            b = [k.b[0] + radius * normals[1][0], k.b[1] + radius * normals[1][1]]
            pieces.append([a, b, k])
        for p, q in zip(pieces, pieces[1:]):
            if math.hypot(p[1][0] - q[0][0], p[1][1] - q[0][1]) < 1e-7:
                continue
            hit = crossing(p, q)
            if hit is not None:
                p[1], q[0] = list(hit), list(hit)
        for a, b, k in pieces:
            hx, hz = k.heading()
            if not k.arc and (b[0] - a[0]) * hx + (b[1] - a[1]) * hz < -1e-6:
                raise Interference(f"line {k.line}: interference under compensation")
        lead = motions[i]
        out.append(Motion(lead.kind, lead.a, tip(pieces[0][0]), None, lead.line, lead.state, lead.tool, 0, "lead"))
        last = None
        for a, b, k in pieces:
            if last is not None and math.hypot(last[0] - a[0], last[1] - a[1]) > 1e-7:
                out.append(Motion("feed", tip(last), tip(a), None, k.line, k.state, k.tool, 0))
            arc = None
            if k.arc:
                arc = arc_by_centre(tip(a), tip(b), tip(k.arc[:2]), k.arc[2] < 0)
                if abs(arc[2]) > 1.9 * math.pi > 2 * abs(k.arc[2]):
                    arc = None
            out.append(Motion(k.kind, tip(a), tip(b), arc, k.line, k.state, k.tool, 0))
            last = b
        if j < len(motions):
            after = motions[j]
            out.append(Motion(after.kind, tip(last), after.b, None, after.line, after.state, after.tool, 0, "lead"))
            j += 1
        i = j
    return out


def crossing(p, q):
    """Where the offsets of two neighbours cross near their corner: lines and circles."""
    corner = np.array([(p[1][0] + q[0][0]) / 2, (p[1][1] + q[0][1]) / 2])

    def line(piece, end):
        hx, hz = piece[2].heading(end)
        at = piece[1] if end else piece[0]
        return np.array(at), np.array([hx, hz])

    def circle(piece):
        c = np.array(piece[2].arc[:2])
        return c, float(np.linalg.norm(np.array(piece[0]) - c))

    found = []
    if not p[2].arc and not q[2].arc:
        (a, u), (b, v) = line(p, True), line(q, False)
        det = u[0] * -v[1] + v[0] * u[1]
        if abs(det) < 1e-12:
            return None
        t = ((b - a)[0] * -v[1] + v[0] * (b - a)[1]) / det
        found = [a + t * u]
    elif p[2].arc and q[2].arc:
        (c, r), (d, s) = circle(p), circle(q)
        way = float(np.linalg.norm(d - c))
        if way < 1e-9:
            return None
        t = (way * way + r * r - s * s) / (2 * way)
        h = r * r - t * t
        if h < 0:
            return None
        e = (d - c) / way
        n = np.array([-e[1], e[0]])
        found = [c + t * e + sign * math.sqrt(h) * n for sign in (1, -1)]
    else:
        (a, u) = line(p, True) if not p[2].arc else line(q, False)
        c, r = circle(p) if p[2].arc else circle(q)
        b = float((a - c) @ u)
        h = b * b - float((a - c) @ (a - c)) + r * r
        if h < 0:
            return None
        found = [a + (-b + sign * math.sqrt(h)) * u for sign in (1, -1)]
    best = min(found, key=lambda f: float(np.linalg.norm(f - corner)))
    return best if np.linalg.norm(best - corner) < 20 else None


def nose_of(spec, offset):
    """(radius mm, to_tip) of an offset number; a sharp tip where the profile has none."""
    nose = spec.get("tool", {}).get("noses", {}).get(f"H{offset}")
    tips = LINUXCNC_TIPS if spec["control"] == "linuxcnc-lathe" else TIPS
    return (nose["radius_mm"], tips[nose["direction"]]) if nose else (0.0, (0, 0))


def read(text, spec):
    """(motions of the tip, player) of a program."""
    if spec["control"] == "linuxcnc-lathe":
        player = play_linuxcnc(text, spec)
        return player.motions, player
    player = (Sinumerik if spec["control"] == "sinumerik-turn" else Fanuc)(spec).play(text)
    out = player.motions
    if any(m.comp for m in out):
        runs, k = [], 0
        while k < len(out):
            j = k
            while j < len(out) and out[j].tool == out[k].tool:
                j += 1
            runs += offset_path(out[k:j], nose_of(spec, out[k].tool))
            k = j
        out = runs
    return out, player
