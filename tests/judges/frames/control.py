"""A control that executes a mill program into machine-axis positions, under a set of variants.

Judges nothing by itself. It is a machine of its own: words in, positions of X, Y, Z in machine coordinates out. Wherever
controls differ it does what its `Variant` says:

    axis = word + work offset + G52 + G92 + tool length          (absolute)       axis = axis + word      (incremental)

* length    what a bare G43/G44/G49/H does: `shift` (nothing moves, the frame does: LinuxCNC), `move` (Z moves at once:
            Fanuc), `next` (with the next Z word, an increment included), `any` (with the next motion of any axis).
* g53, g28  whether G53 / a G28 or G30 of Z cancels the tool length vector (Fanuc B-63844EN; parameter).
* change    where M6 leaves the axes: `none` where they stood, `z` Z at the change position, `xyz` all of them.
* the modal work offset at the start, the true values of offsets and lengths, where the axes stand at the start, the
  reference points, block delete, G52 across a change of offset, `G43 H0` (none, or the tool in the spindle), G40 that
  cancels lengths (GOST 20999-83), T that changes at once (Sinumerik), the unit at the start, lengths without a point.
"""

import functools
import math
import re

AXES = "XYZ"
WORD = re.compile(r"([A-Z])\s*=?\s*([+-]?(?:\d+\.?\d*|\.\d+))")


class NotSimulated(Exception):
    """The program holds something this control does not know."""


class Variant(dict):
    """What one particular control does; `label` names how it differs from the first."""

    def __getattr__(self, name):
        return self[name]


BASE = dict(length="shift", g53=False, g28=False, change="none", start="A", offset_at_start="G54", shifted=False,
            longer=0.0, g52_held=True, delete=False, h0="none", g40=False, t_changes=False, inch_at_start=False,
            least=None, length_at_start=0.0, home="profile", change_cancels=False)

COMMON = [dict(start="B"), dict(start="C"), dict(shifted=True), dict(shifted=True, start="B"), dict(delete=True),
          dict(home="other")]
LENGTHS = [dict(length="move"), dict(length="next"), dict(length="any"), dict(longer=7.25), dict(length="move", longer=-3.5)]
CHANGES = [dict(change="z"), dict(change="xyz"), dict(change="xyz", change_cancels=True)]
RETURNS = [dict(g53=True), dict(g28=True), dict(g53=True, g28=True, length="move"), dict(g53=True, shifted=True, length="next")]

# What each dialect leaves open. A control whose manual is public has fewer variants than a family.
OPEN = {
    "fanuc": COMMON + LENGTHS + CHANGES + RETURNS + [dict(offset_at_start="G55"), dict(offset_at_start="zero"), dict(g52_held=False),
             dict(g53=True, length="move", change="z", shifted=True, start="C")],
    "linuxcnc": COMMON + CHANGES[:2] + [dict(longer=7.25), dict(offset_at_start="G55"), dict(h0="spindle")],
    "centroid": COMMON + LENGTHS + CHANGES + RETURNS + [dict(offset_at_start="G55")],
    "perspektiva": COMMON + LENGTHS + CHANGES + RETURNS[1:2] + [dict(offset_at_start="zero"), dict(g40=True)],
    "balt-system": COMMON + [dict(length_at_start=77.0)],
    "sinumerik": COMMON + [dict(length_at_start=77.0), dict(offset_at_start="zero"), dict(t_changes=True), dict(g53=True, shifted=True)],
}


def variants(dialect, keeps=False):
    """All variants admissible for a dialect; the first is what docs/dialects.md assumes.

    `keeps`: the profile says that a tool change leaves every axis where it stands.
    """
    out = []
    for change in [{}] + OPEN[dialect]:
        if keeps:
            change = {k: x for k, x in change.items() if k != "change"}
        v = Variant(BASE, **change)
        if dialect == "linuxcnc":
            v["h0"] = "spindle"              # documented behaviour of G43 H0
        v["label"] = " ".join(f"{k}={x}" for k, x in change.items()) or "as the dialect assumes"
        out.append(v)
    return out


@functools.lru_cache(maxsize=20000)
def words_of(line, dialect):
    """(skippable, [(letter, value, text)]) of a block; None for lines that are no block."""
    text = re.sub(r"\([^)]*\)", " ", line) if dialect not in ("balt-system", "sinumerik") else line
    if dialect != "fanuc":
        text = text.split(";")[0]
    if dialect == "centroid" and text.lstrip().startswith(":"):
        return None
    text = text.upper().strip()
    if not text or text.startswith("%") or re.match(r"^[O:]\d+$", text):
        return None
    skippable = text.startswith("/")
    text = re.sub(r"^/\d*", "", text)
    words = [(m.group(1), float(m.group(2)), m.group(2)) for m in WORD.finditer(text)]
    if re.sub(r"\s", "", WORD.sub("", text)):
        raise NotSimulated(line)
    return skippable, [w for w in words if w[0] != "N"]


def code(value):
    return f"{value:g}"


class Block:
    """What one block did: `kind`, the axes it named, the places it went through (the first is where it began)."""

    def __init__(self, kind, named, places):
        self.kind, self.named, self.places = kind, named, places


class Control:
    def __init__(self, machine, dialect, variant, start_at=None):
        self.dialect, self.v = dialect, variant
        delta = [11.0, -7.5, 4.75] if variant.shifted else [0.0] * 3
        self.offsets = {k: [a + b for a, b in zip(value, delta)] for k, value in machine.offsets.items()}
        self.offsets["zero"] = [0.0] * 3
        self.lengths = {h: value + variant.longer for h, value in machine.lengths.items()}
        middle = [(machine.travel[a][0] + machine.travel[a][1]) / 2 for a in AXES]
        starts = {"A": machine.home, "B": middle, "C": [c + d for c, d in zip(middle, (33.0, -41.0, 52.0))]}
        self.at = list(start_at or starts[variant.start])
        self.home = list(machine.home) if variant.home == "profile" else [h + d for h, d in zip(machine.home, (5.0, -9.0, -13.0))]
        self.second = [h + d for h, d in zip(self.home, (0.0, 0.0, -37.0))]
        self.change = [self.home[0] + 3.0, self.home[1] - 2.0, self.home[2] - 21.0]
        self.unit = 25.4 if variant.inch_at_start else 1.0
        self.least = dialect == "fanuc" if variant.least is None else variant.least
        self.incremental, self.plane, self.offset = False, "17", variant.offset_at_start
        self.g52, self.g92 = [0.0] * 3, [0.0] * 3
        self.length, self.sign, self.pending = variant.length_at_start, 0, 0.0
        self.motion = "0" if dialect in ("fanuc", "centroid") else None
        self.cycle, self.levels, self.initial, self.back = None, {}, 0.0, "98"
        self.tool = self.next_tool = 0
        self.ended = False

    def number(self, word):
        letter, value, text = word
        if self.least and "." not in text:
            return value * (0.001 if self.unit == 1.0 else 0.00254)
        return value * self.unit

    def frame(self, i):
        return self.offsets[self.offset][i] + self.g52[i] + self.g92[i] + (self.length if i == 2 else 0.0)

    def target(self, axes):
        """Where the axis words lead; takes up a length that was waiting for a motion."""
        to = list(self.at)
        for i, a in enumerate(AXES):
            if a in axes:
                to[i] = to[i] + axes[a] if self.incremental else axes[a] + self.frame(i)
        if self.pending and (self.v.length == "any" or "Z" in axes):
            if self.incremental or "Z" not in axes:
                to[2] += self.pending
            self.pending = 0.0
        return to

    def block(self, line):
        """Executes one line of text. None where nothing is executed."""
        parsed = words_of(line, self.dialect)
        if parsed is None or self.ended:
            return None
        skippable, words = parsed
        if skippable and self.v.delete:
            return None
        gs = [code(value) for letter, value, _ in words if letter == "G"]
        ms = [code(value) for letter, value, _ in words if letter == "M"]
        other = {w[0]: w for w in words if w[0] not in "GM"}
        places, kind = [tuple(self.at)], "none"
        if "T" in other:
            self.next_tool = int(other["T"][1])
        if "6" in ms or (self.v.t_changes and "T" in other):
            kind = "change"
            self.tool = self.next_tool
            if self.v.change_cancels:
                self.length, self.sign = 0.0, 0
            for i in {"none": (), "z": (2,), "xyz": (0, 1, 2)}[self.v.change]:
                self.at[i] = self.change[i]
            places.append(tuple(self.at))
        if "25" in ms and self.dialect == "centroid":
            self.at[2] = self.home[2]
            kind = "reference"
            places.append(tuple(self.at))
        self.modes(gs, other)
        moved_by = self.tool_length(gs, other)
        axes = {a: self.number(other[a]) for a in AXES if a in other}
        done = self.once(gs, other, axes, places)
        if done:
            kind = done
        elif axes:
            if moved_by and "Z" in axes and self.incremental and self.v.length != "shift":
                axes["Z"] += moved_by
            kind = self.move(other, axes, places)
        elif self.motion in ("2", "3") and not self.cycle and {"I", "J", "K"} & set(other) and not set(gs) & {"10", "28", "30"}:
            kind = self.move(other, {}, places)          # a full circle
        elif moved_by:
            kind = "length"
            if self.v.length == "move":
                self.at[2] += moved_by
                places.append(tuple(self.at))
            elif self.v.length in ("next", "any"):
                self.pending += moved_by
        elif any(g in ("81", "82", "83", "73", "85") for g in gs):
            kind = self.move(other, axes, places)
        if "2" in ms or "30" in ms:
            self.ended = True
        return Block(kind, set(axes), places)

    def modes(self, gs, other):
        inch = {"fanuc": ("20", "21"), "linuxcnc": ("20", "21"), "centroid": ("20", "21"), "balt-system": ("70", "71")}
        for g in gs:
            if g in (inch.get(self.dialect, ("20", "70", "700")) if self.dialect != "perspektiva" else ("20", "70")) and \
                    g not in ("21", "71"):
                self.unit = 25.4
            elif g in ("21", "71", "710"):
                self.unit = 1.0
            elif g in ("90", "91"):
                self.incremental = g == "91"
            elif g in ("17", "18", "19"):
                self.plane = g
            elif g in ("0", "1", "2", "3"):
                self.motion, self.cycle = g, None
            elif g == "80":
                self.cycle = None
                if self.dialect == "linuxcnc":
                    self.motion = None
            elif g in ("81", "82", "83", "73", "85"):
                if self.cycle is None:
                    self.initial = None          # the level where this cycle begins
                self.cycle = g
            elif g in ("98", "99"):
                self.back = g
            elif g in ("54", "55", "56", "57", "505"):
                self.choose("G" + g)
            elif g == "54.1":
                self.choose(f"G54.1P{int(other['P'][1])}")
            elif g == "92.1":
                self.g92 = [0.0] * 3
            elif g not in ("4", "10", "28", "30", "43", "44", "49", "52", "53", "79", "153", "92", "40", "93", "94", "95", "61", "64",
                           "91.1", "97", "50", "69", "15", "41", "42", "27", "29", "9"):
                raise NotSimulated("G" + g)
        if "40" in gs and self.v.g40 and self.length:
            self.pending = self.length = 0.0
            self.sign = 0

    def choose(self, name):
        if name not in self.offsets:
            raise NotSimulated(name)
        if name != self.offset and not self.v.g52_held:
            self.g52 = [0.0] * 3
        self.offset = name

    def tool_length(self, gs, other):
        """Takes G43, G44, G49, H; gives by how much the tool length became larger."""
        before = self.length
        if "49" in gs:
            self.length, self.sign = 0.0, 0
        elif "43" in gs or "44" in gs or (self.sign and "H" in other):
            if "43" in gs or "44" in gs:
                self.sign = 1 if "43" in gs else -1
            h = int(other["H"][1]) if "H" in other else (self.tool if self.dialect == "linuxcnc" else None)
            if h == 0 and self.v.h0 == "spindle":
                h = self.tool
            if h is None:
                raise NotSimulated("G43 without H")
            if h and h not in self.lengths:
                raise NotSimulated(f"H{h}")
            self.length = self.sign * self.lengths[h] if h else 0.0
        return self.length - before

    def once(self, gs, other, axes, places):
        """Codes that take the axis words of their block for themselves; gives the kind, or None."""
        if "4" in gs and self.dialect != "balt-system":
            return "dwell"
        if "10" in gs:
            level, p = int(other["L"][1]), int(other["P"][1])
            name = f"G{53 + p}" if level == 2 or self.dialect == "linuxcnc" else f"G54.1P{p}"
            value = self.offsets.setdefault(name, [0.0] * 3)
            for i, a in enumerate(AXES):
                if a in axes:
                    if level == 20 and self.dialect == "linuxcnc":
                        value[i] = self.at[i] - axes[a] - self.g92[i] - (self.length if i == 2 else 0.0)
                    else:
                        value[i] = axes[a] + (value[i] if self.incremental and self.dialect == "fanuc" else 0.0)
            return "frame"
        if "52" in gs:
            shift = self.g92 if self.dialect == "linuxcnc" else self.g52
            for i, a in enumerate(AXES):
                if a in axes:
                    shift[i] = axes[a]
            return "frame"
        if "92" in gs:
            for i, a in enumerate(AXES):
                if a in axes:
                    self.g92[i] += self.at[i] - self.frame(i) - axes[a]
            return "frame"
        if "53" in gs or "79" in gs or "153" in gs:
            for i, a in enumerate(AXES):
                if a in axes:
                    self.at[i] = axes[a] + (self.v.length_at_start if i == 2 else 0.0)
            places.append(tuple(self.at))
            if axes and self.v.g53 and self.dialect != "linuxcnc":
                self.length, self.sign, self.pending = 0.0, 0, 0.0
            elif "Z" in axes:
                self.pending = 0.0
            return "machine"
        if ("28" in gs or "30" in gs) and self.dialect != "balt-system":
            if not axes:
                raise NotSimulated("a return without axes")
            self.at = self.target(axes)
            places.append(tuple(self.at))
            for i, a in enumerate(AXES):
                if a in axes:
                    self.at[i] = (self.second if "30" in gs else self.home)[i]
            places.append(tuple(self.at))
            if "Z" in axes and self.v.g28:
                self.length, self.sign = 0.0, 0
            return "reference"
        return None

    def move(self, other, axes, places):
        if self.cycle:
            return self.hole(other, axes, places)
        if self.motion is None:
            raise NotSimulated("no motion code")
        to = self.target(axes)
        if self.motion in ("2", "3"):
            places += self.arc(other, to)
        self.at = to
        places.append(tuple(to))
        return {"0": "rapid", "1": "feed"}.get(self.motion, "arc")

    def arc(self, other, to):
        """Places along an arc, its end apart; the radius runs linearly with the angle."""
        i, j = {"17": (0, 1), "18": (2, 0), "19": (1, 2)}[self.plane]
        a, b = (self.at[i], self.at[j]), (to[i], to[j])
        if "R" in other:
            r = self.number(other["R"])
            dx, dy = b[0] - a[0], b[1] - a[1]
            d = math.hypot(dx, dy)
            if d < 1e-9:
                raise NotSimulated("a full circle by R")
            h = math.sqrt(max(r * r - d * d / 4, 0.0))
            if (self.motion == "2") != (r < 0):
                h = -h
            c = ((a[0] + b[0]) / 2 - h * dy / d, (a[1] + b[1]) / 2 + h * dx / d)
        else:
            letters = ("I", "J", "K")
            c = tuple(x + (self.number(other[letters[k]]) if letters[k] in other else 0.0) for x, k in zip(a, (i, j)))
        t0, t1 = math.atan2(a[1] - c[1], a[0] - c[0]), math.atan2(b[1] - c[1], b[0] - c[0])
        r0, r1 = math.dist(a, c), math.dist(b, c)
        turn = t1 - t0
        if self.motion == "3":
            while turn <= 1e-7:
                turn += 2 * math.pi
        else:
            while turn >= -1e-7:
                turn -= 2 * math.pi
        out = []
        steps = max(4, int(abs(turn) / 0.06))
        for k in range(1, steps):
            s = k / steps
            p = [x + s * (y - x) for x, y in zip(self.at, to)]
            p[i] = c[0] + (r0 + s * (r1 - r0)) * math.cos(t0 + s * turn)
            p[j] = c[1] + (r0 + s * (r1 - r0)) * math.sin(t0 + s * turn)
            out.append(tuple(p))
        return out

    def hole(self, other, axes, places):
        if self.plane != "17":
            raise NotSimulated("a cycle outside G17")
        if self.pending and self.v.length == "any":
            self.at[2] += self.pending
        self.pending = 0.0
        if self.initial is None:
            self.initial, self.levels = self.at[2], {}
        for letter in "RZ":
            if letter in other:
                value = self.number(other[letter])
                if not self.incremental:
                    self.levels[letter] = value + self.frame(2)
                elif letter == "R":
                    self.levels["R"] = self.initial + value
                else:
                    self.levels["Z"] = self.levels["R"] + value
        if "R" not in self.levels or "Z" not in self.levels:
            raise NotSimulated("a cycle without its levels")
        times = int(other["K"][1]) if "K" in other else int(other["L"][1]) if "L" in other else 1
        flat = {a: axes[a] for a in "XY" if a in axes}
        for _ in range(times):
            to = self.target(flat)
            r, z = self.levels["R"], self.levels["Z"]
            if self.at[2] < r:
                places.append((self.at[0], self.at[1], r))
            places += [(to[0], to[1], self.at[2]), (to[0], to[1], r), (to[0], to[1], z)]
            self.at = [to[0], to[1], max(self.initial, r) if self.back == "98" else r]
            places.append(tuple(self.at))
        return "cycle"
