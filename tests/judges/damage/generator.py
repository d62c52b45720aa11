"""Random machines and random mill programs in the style of posts.

A machine is one of the classes below, with tables of some 10 um. A program is some operations (contour, pocket by
helix, pecks as moves, drilling cycles, inverse time, cutter compensation, arcs in three planes, increments, inches,
a turned frame) with one to three tools, in the manner of fanuc, linuxcnc or perspektiva.
Everything follows from the seed.
"""

import math
import random

from common.profile import Profile

INCH = 25.4
AXES = "XYZ"
# straight: no errors; crooked: tables, one for both directions; backlash: the same with a reversal value;
# directions: a table for each direction that differs along the axis, coming from above stands further; mixed: straightness
# and angles differ too; anyhow: tables of the two directions have nothing to do with each other.
MACHINES = ("straight", "crooked", "backlash", "directions", "mixed", "anyhow")
DIALECTS = ("fanuc", "linuxcnc", "perspektiva")
OFFSETS = {"G54": (95.0, 88.0, 60.0), "G55": (60.5, 120.25, 75.125)}
LENGTHS = {1: 80.0, 2: 112.4, 3: 95.5}
START = (20.0, 20.0, 400.0)


def write_machine(folder, kind, dialect, seed):
    """Profile and tables in a folder; returns the profile's path."""
    pick = random.Random(f"{kind} {seed}")
    cubic = pick.random() < 0.4
    chain = pick.choice(["[w X Y b Z t]", "[w Y b X Z t]", "[w b X Y Z t]", "[w X b Y Z t]"])
    profile = Profile(f"{kind} {seed}", dialect, chain)
    profile[""]["interpolation"] = "monotone" if cubic else "linear"
    for axis in AXES:
        step = pick.choice([20, 25, 40, 50])
        places = list(range(-100, 601, step))
        level = 0.0 if kind == "straight" else pick.choice([3.0, 10.0])
        # Half of them wavy from node to node, half of them smooth.
        rough = pick.random() < 0.5

        def column(size):
            phase, wave = pick.uniform(0, 7), pick.uniform(150, 500)
            return [size * (pick.uniform(-1, 1) if rough else math.sin(p / wave * 6.283 + phase)) for p in places]

        columns = [column(level) for _ in range(3)] + [column(2 * level) for _ in range(3)]
        profile.axis(axis).update(travel_mm=[-100, 600], resolution_mm=0.001)
        profile.errors(axis, places, zip(*columns), digits=".3f")
        if kind == "backlash":
            profile.axis(axis)["backlash_um"] = round(pick.uniform(1, 12), 2)
        elif kind in ("directions", "mixed", "anyhow"):
            other = [list(c) for c in columns]
            own = AXES.index(axis)
            play, wave = pick.uniform(2, 12), pick.uniform(100, 300)
            if kind == "anyhow":
                other = [column(level) for _ in range(3)] + [column(2 * level) for _ in range(3)]
            else:
                other[own] = [v + play * (1 + 0.4 * math.sin(p / wave)) for v, p in zip(columns[own], places)]
            if kind == "mixed":
                for k in [k for k in range(6) if k != own]:
                    size = pick.choice([0.0, 0.5, 3.0])
                    other[k] = [v + size * math.sin(p / wave + k) for v, p in zip(columns[k], places)]
            profile.errors(axis, places, zip(*other), "errors_negative", ".3f")
    if kind != "straight":
        profile["squareness"].update({f"{n}_urad": round(pick.uniform(-60, 60), 1) for n in ("EC0Y", "EB0Z", "EA0Z")})
    profile["work_offsets_mm"].update(OFFSETS)
    profile["tool"].update(default_mm=[0, 0, -90], lengths_mm={f"H{k}": v for k, v in LENGTHS.items()})
    return str(profile.write(folder, "machine.toml"))


class Program:
    """One random program."""

    def __init__(self, dialect, seed, turned=True):
        self.pick = pick = random.Random(f"{dialect} {seed}")
        self.dialect = dialect
        self.separator, self.end = pick.choice([" ", " ", ""]), pick.choice(["\n", "\n", "\r\n"])
        self.style = pick.choice(["point", "fixed", "padded"]) if dialect == "fanuc" else pick.choice(["point", "fixed", "padded", "free"])
        self.numbered, self.zeros, self.comments = pick.random() < 0.5, pick.random() < 0.3, pick.random() < 0.6
        self.repeat_codes = pick.random() < 0.4
        self.unit, self.decimals = (INCH, 4) if pick.random() < 0.15 else (1.0, 3)
        self.turned = turned
        self.at, self.motion, self.feed, self.count = [0.0] * 3, None, None, 0
        self.coolant, self.speed, self.plane, self.incremental = False, None, 17, False
        self.lines = ["%"] if pick.random() < 0.8 else []
        opened = bool(self.lines)
        if dialect == "fanuc":
            self.lines.append(f"O{pick.randint(1, 9999):04d} (PART)" if pick.random() < 0.5 else f"O{pick.randint(1, 9999):04d}")
        self.block("G20" if self.unit != 1.0 else "G21", "G17", "G40", "G49", "G80", "G90", "G94", "G54")
        for _ in range(pick.randint(1, 3)):
            self.tool()
        self.block("G0", self.word(2, 60.0))
        self.block("M5")
        self.block("M30" if pick.random() < 0.8 or dialect == "perspektiva" else "M2")
        if opened:
            self.lines.append("%")
        self.text = (self.end.join(self.lines) + self.end).encode()

    # words

    def number(self, mm):
        text = f"{mm / self.unit:.{self.decimals}f}"
        if float(text) == 0:
            text = text.lstrip("-")
        if self.style == "fixed":
            return text
        text = text.rstrip("0")
        if self.style == "padded" and text.endswith("."):
            text += "0"
        return text.rstrip(".") if self.style == "free" else text

    def grid(self, mm):
        return round(mm / self.unit, self.decimals) * self.unit

    def word(self, axis, to):
        to = self.grid(to)
        text = AXES[axis] + self.number(to - self.at[axis] if self.incremental else to)
        self.at[axis] = to
        return text

    def block(self, *words):
        words = [w for w in words if w]
        if self.zeros:
            words = [f"{w[0]}0{w[1]}" if len(w) == 2 and w[0] in "GM" and w[1].isdigit() else w for w in words]
        if self.numbered:
            self.count += 10
            words = [f"N{self.count}"] + words
        text = self.separator.join(words)
        if self.comments and self.pick.random() < 0.12:
            text += self.pick.choice([" (CUT)", " (X1. Y2.)", " (FINISH, F300 M8)"])
        self.lines.append(text)

    def code(self, code):
        again = self.repeat_codes or code != self.motion
        self.motion = code
        return f"G{code}" if again else ""

    def f(self, lo=80, hi=900):
        """F where it changes, or by chance."""
        if self.feed is None or self.pick.random() < 0.3:
            self.feed = self.pick.randint(lo, hi)
            if self.unit != 1.0:
                return f"F{self.feed / INCH:.1f}"
            return f"F{self.feed}." if self.style != "free" else f"F{self.feed}"
        return ""

    def rapid(self, x=None, y=None, z=None, *tail):
        self.block(self.code(0), *(self.word(k, v) for k, v in enumerate((x, y, z)) if v is not None), *tail)

    def cut(self, x=None, y=None, z=None, *tail):
        words = [self.code(1)] + [self.word(k, v) for k, v in enumerate((x, y, z)) if v is not None]
        self.block(*words, self.f(), *tail)

    # operations

    def tool(self):
        pick = self.pick
        h = pick.choice(list(LENGTHS))
        self.feed, self.motion = None, None
        if pick.random() < 0.85:
            self.block(f"T{h}", "M6")
        if pick.random() < 0.3:
            self.block("G55")
        else:
            self.block("G54")
        self.speed = pick.randrange(500, 9000, 100)
        self.at = [0.0, 0.0, 0.0]
        self.incremental = False
        self.rapid(pick.uniform(0, 20), pick.uniform(0, 20))
        self.block(f"S{self.speed}", pick.choice(["M3", "M3", "M3", "M4"]))
        self.block("G43", f"H{h}", self.word(2, pick.uniform(70, 90)), "M8" if pick.random() < 0.7 else "")
        # Every axis comes from a known side from here on.
        self.rapid(pick.uniform(30, 50), pick.uniform(30, 50), pick.uniform(40, 60))
        operations = [self.contour, self.contour, self.pocket, self.pecks, self.cycle, self.cycle, self.cycle, self.inverse, self.compensated,
                      self.planes, self.increments, self.inches, self.small, self.stops]
        if self.turned and self.dialect == "fanuc":
            operations.append(self.frame)
        for _ in range(pick.randint(1, 4)):
            pick.choice(operations)()
            self.between()
        self.rapid(z=60.0)
        self.block("M9")
        if pick.random() < 0.5:
            self.block("M5")

    def between(self):
        pick, choice = self.pick, self.pick.random()
        self.rapid(z=pick.uniform(30, 60))
        if choice < 0.15:
            self.dwell()
        elif choice < 0.3:
            self.speed = pick.randrange(500, 9000, 100)
            self.block(f"S{self.speed}")
        elif choice < 0.4:
            self.block("M1")
        elif choice < 0.5:
            self.block(pick.choice(["M8", "M9", "M7"]))

    def dwell(self):
        seconds = self.pick.choice([0.2, 0.5, 1.5])
        if self.dialect == "fanuc":
            self.block("G4", self.pick.choice([f"P{int(seconds * 1000)}", f"X{seconds}"]))
        else:
            self.block("G4", f"P{seconds}" if self.dialect == "linuxcnc" else f"X{seconds}")

    def somewhere(self):
        return self.pick.uniform(0, 180), self.pick.uniform(0, 150)

    def contour(self):
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=pick.uniform(2, 5))
        self.cut(z=pick.uniform(-20, -1))
        for _ in range(pick.randint(2, 9)):
            choice = pick.random()
            if choice < 0.3:
                self.arc()
            elif choice < 0.36:
                self.dwell()
            elif choice < 0.4:
                self.block(pick.choice(["M8", "M9"]))
            elif choice < 0.43:
                self.block(f"S{pick.randrange(500, 9000, 100)}")
            elif choice < 0.7:
                axis = pick.randrange(2)
                to = self.at[axis] + pick.choice([-1, 1]) * pick.choice([pick.uniform(0.05, 2), pick.uniform(5, 60), pick.uniform(5, 60)])
                self.cut(*[to if k == axis else None for k in range(2)])
            else:
                x, y = (self.at[k] + pick.uniform(-50, 50) for k in range(2))
                self.cut(x, y, self.at[2] + pick.uniform(-2, 2) if pick.random() < 0.3 else None, "M9" if pick.random() < 0.05 else "")

    def arc(self, radius=None, sweep=None, lift=0.0, code=None):
        pick = self.pick
        u, v, w, letters = {17: (0, 1, 2, "IJ"), 18: (2, 0, 1, "KI"), 19: (1, 2, 0, "JK")}[self.plane]
        code = code or pick.choice([2, 3])
        radius = radius or pick.choice([pick.uniform(0.3, 3), pick.uniform(3, 40)])
        angle = pick.uniform(0, 2 * math.pi)
        centre = [self.grid(radius * math.cos(angle)), self.grid(radius * math.sin(angle))]
        radius, start = math.hypot(*centre), math.atan2(-centre[1], -centre[0])
        if sweep is None:
            sweep = None if pick.random() < 0.2 else pick.uniform(0.2, 6.0)
        words, at = [self.code(code)], list(self.at)
        if sweep is not None:
            end = start + (sweep if code == 3 else -sweep)
            words.append(self.word(u, at[u] + centre[0] + radius * math.cos(end)))
            words.append(self.word(v, at[v] + centre[1] + radius * math.sin(end)))
        if lift:
            words.append(self.word(w, at[w] + lift))
        if sweep is not None and sweep < 2.8 and pick.random() < 0.4:
            words.append("R" + self.number(math.hypot(*centre)))
        else:
            words += [letter + self.number(c) for letter, c in zip(letters, centre)]
        words.append(self.f())
        words = [w for w in words if w]
        self.block(*sorted(words, key=lambda word: "GXYZIJKRF".index(word[0])))

    def pocket(self):
        """Down a helix, then circles."""
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=2.0)
        self.cut(z=0.5)
        radius, code = pick.choice([pick.uniform(0.2, 1.5), pick.uniform(3, 25)]), pick.choice([2, 3])
        centre = self.grid(radius)
        side = pick.choice([-1, 1])
        for _ in range(pick.randint(1, 6)):
            words = [self.code(code)]
            if pick.random() < 0.5:
                words += [self.word(0, self.at[0]), self.word(1, self.at[1])]
            self.block(*words, self.word(2, self.at[2] - pick.choice([0.05, 0.5, 1.5])), "I" + self.number(side * centre), "J" + self.number(0.0) if pick.random() < 0.5 else "", self.f())
        self.block(self.code(code), "I" + self.number(side * centre))

    def small(self):
        """A helix of a thread mill, some tenths of a millimetre."""
        self.rapid(*self.somewhere())
        self.rapid(z=1.0)
        self.cut(z=-3.0)
        radius, code = self.pick.uniform(0.02, 0.6), self.pick.choice([2, 3])
        for _ in range(self.pick.randint(2, 5)):
            self.arc(radius, self.pick.choice([1.5, 3.1, 3.1416]), self.pick.uniform(0.02, 0.3), code)

    def pecks(self):
        """A deep hole as moves, as posts without cycles write it."""
        pick = self.pick
        for _ in range(pick.randint(1, 2)):
            x, y = self.somewhere()
            self.rapid(x, y)
            self.rapid(z=2.0)
            depth, peck = 0.0, pick.uniform(1, 5)
            for _ in range(pick.randint(2, 5)):
                depth -= peck
                self.cut(z=depth)
                if pick.random() < 0.2:
                    self.dwell()
                self.rapid(z=2.0)
                self.rapid(z=depth + 0.5)
            self.cut(z=depth - 1.0)
            self.rapid(z=20.0)

    def cycle(self):
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=pick.uniform(10, 30))
        kinds = ["G81", "G82", "G83", "G84", "G85", "G86", "G89"] + (["G73", "G74"] if self.dialect != "perspektiva" else [])
        kind = pick.choice(kinds)
        back = pick.choice(["G98", "G99"])
        if self.dialect == "linuxcnc" and kind in ("G85", "G89"):
            back = "G99"  # LinuxCNC feeds up to the initial level under G98, other controls to R
        level = self.grid(pick.uniform(1, 5))
        deep = self.grid(pick.uniform(-22, -4))
        initial = self.at[2]
        words = [back, kind]
        x, y = self.somewhere()
        words += [self.word(0, x), self.word(1, y), self.axis_z(deep), "R" + self.number(level)]
        # LinuxCNC wants P with G86.
        if kind in ("G82", "G89") or (kind == "G86" and self.dialect == "linuxcnc") or (kind in ("G84", "G86", "G74") and pick.random() < 0.5):
            words.append(pick.choice(["P200", "P1000"]) if self.dialect == "fanuc" else "P0.2")
        if kind in ("G83", "G73"):
            words.append("Q" + self.number(pick.uniform(2, 8)))
        self.feed = None
        words.append(self.f())
        self.block(*words)
        self.motion = None
        for _ in range(pick.randint(0, 5)):
            choice = pick.random()
            x, y = (min(max(self.at[k] + pick.uniform(-40, 40), 0), 170) for k in range(2))
            if choice < 0.55:
                self.block(self.word(0, x), self.word(1, y))
            elif choice < 0.75:
                self.block(self.word(0, x))
            elif choice < 0.82 and kind not in ("G84", "G74"):
                self.block(self.word(1, y), pick.choice(["M8", "M9"]))
            elif choice < 0.9 and not (self.dialect == "linuxcnc" and kind in ("G85", "G89")):
                back = pick.choice(["G98", "G99"])
                self.block(back, self.word(0, x))
            elif self.dialect == "fanuc":
                # Repeated by increments, three holes on.
                self.block("G91", "X" + self.number(5.0), "K3")
                self.at[0] = self.grid(self.at[0] + 3 * self.grid(5.0))
                self.block("G90", self.word(0, self.at[0] + 7), self.word(1, y))
        self.block("G80")
        self.at[2] = initial
        self.motion = None
        self.rapid(z=initial + 5)

    def axis_z(self, deep):
        return "Z" + self.number(deep)

    def inverse(self):
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=3.0)
        self.block("G93")
        self.motion = None
        for _ in range(pick.randint(2, 6)):
            if pick.random() < 0.3:
                radius = self.grid(pick.uniform(3, 20))
                self.block(self.code(pick.choice([2, 3])), self.word(0, self.at[0] + 2 * radius), self.word(1, self.at[1]), "I" + self.number(radius), f"F{pick.randint(3, 60)}")
            else:
                x, y = (self.at[k] + pick.uniform(-30, 30) for k in range(2))
                self.block(self.code(1), self.word(0, x), self.word(1, y), f"F{pick.randint(3, 60)}.")
        self.block("G94")
        self.feed, self.motion = None, None

    def compensated(self):
        pick = self.pick
        x, y = self.somewhere()
        self.rapid(x, y)
        self.rapid(z=2.0)
        self.cut(z=-4.0)
        side = pick.choice(["G41", "G42"])
        self.motion = None
        self.block(side, f"D{pick.randint(1, 3)}", self.code(1), self.word(0, x + 8), self.f())
        turn = 1 if side == "G41" else -1
        self.cut(y=y + turn * 12)
        self.cut(x=x - 10)
        self.cut(y=y + turn * 6)
        self.block("G40", self.code(1), self.word(0, x - 3), self.word(1, y))

    def planes(self):
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=15.0)
        self.cut(z=10.0)
        self.plane = pick.choice([18, 19])
        self.block(f"G{self.plane}")
        for _ in range(pick.randint(1, 3)):
            self.arc(radius=pick.uniform(0.5, 8), lift=pick.choice([0.0, 0.0, 3.0]))
        self.plane = 17
        self.block("G17")

    def increments(self):
        pick = self.pick
        self.rapid(*self.somewhere())
        self.rapid(z=5.0)
        self.cut(z=-2.0)
        self.block("G91")
        self.incremental = True
        for _ in range(pick.randint(2, 6)):
            if pick.random() < 0.3:
                self.arc()
            else:
                axes = pick.sample(range(3), pick.randint(1, 3))
                to = [self.at[k] + pick.uniform(-6, 6) if k in axes else None for k in range(3)]
                self.cut(*to)
        self.incremental = False
        self.block("G90")
        self.rapid(*self.at[:2])

    def inches(self):
        """The same program goes on in the other unit."""
        old = (self.unit, self.decimals)
        self.rapid(z=20.0)
        self.unit, self.decimals = (1.0, 3) if self.unit != 1.0 else (INCH, 4)
        self.block("G20" if self.unit != 1.0 else "G21")
        self.feed = None
        self.contour()
        self.rapid(z=20.0)
        self.unit, self.decimals = old
        self.block("G20" if self.unit != 1.0 else "G21")
        self.feed = None
        self.rapid(*self.somewhere(), 25.0)

    def stops(self):
        self.rapid(*self.somewhere())
        self.rapid(z=2.0)
        self.cut(z=-1.0)
        self.cut(self.at[0] + 12.0, None, None, "M0" if self.pick.random() < 0.5 else "M9")
        self.cut(None, self.at[1] + 9.0)

    def frame(self):
        """A turned frame; every axis of it named first."""
        pick = self.pick
        self.rapid(60.0, 60.0)
        self.block("G68", "X" + self.number(60.0), "Y" + self.number(50.0), f"R{pick.choice([15, 30, 45, 90, -20])}.")
        self.motion = None
        self.rapid(pick.uniform(40, 90), pick.uniform(40, 80))
        self.rapid(z=3.0)
        self.cut(z=-2.0)
        for _ in range(pick.randint(1, 4)):
            if pick.random() < 0.3:
                self.arc(radius=pick.uniform(2, 12))
            else:
                self.cut(pick.uniform(40, 90), pick.uniform(40, 80))
        self.rapid(z=20.0)
        self.block("G69")
        self.motion = None
        self.rapid(*self.somewhere())
