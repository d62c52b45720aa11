"""Random programs of Fanuc lathes, systems A and B."""

from writing import Writing


class LatheProgram(Writing):
    KINDS = dict(moves=4, arcs=2, corners=4, angles=3, passes=4, flow=3, faces=2, threads=1, holes=4, rough=4, pattern=2, face_rough=2,
                 grooves=2, sub=2, loop=2, tool=1, offset=1, misc=1, home=1, lead=1)

    def __init__(self, rng, system):
        self.rng, self.system, self.lines, self.tail = rng, system, [], []
        self.number, self.depth, self.variable, self.absolute = 10, 0, 100, True

    def n(self, low, high, letter="", digits=None):
        value = round(self.rng.uniform(low, high), self.rng.choice((0, 0, 1, 2)) if digits is None else digits)
        text = f"{value:.3f}".rstrip("0")
        return letter + ("0." if text in ("-0.", "0.") else text)

    def say(self, text):
        self.lines.append(text + (" (NOTE)" if self.p(0.04) and not text.startswith(("#", "W", "E", "I")) else ""))

    def feed(self):
        return "F" + self.rng.choice((".1", ".15", ".2", ".25", "0.3"))

    def label(self):
        self.number += 10
        return self.number

    def program(self):
        r = self.rng
        self.say("G21 G18 G40 " + ("G99" if self.system == "A" else f"G95 G90 {r.choice(('G98', 'G99'))}"))
        self.say(f"T0{r.choice('123')}0{r.choice('123')}".replace("T01", "T01") if self.p(0) else "T0101")
        self.say("G54")
        self.say("G0 X60. Z5.")
        self.say("G97 S800 M3")
        for _ in range(r.randint(2, 7)):
            self.snippet(self.KINDS)
            if self.p(0.3):
                self.here()
        self.here()
        self.lines += ["M5", "M30"] + self.tail
        return "\n".join(self.lines) + "\n"

    def snippet(self, kinds):
        kinds = [k for k in kinds if not (self.depth and k in ("sub", "rough", "pattern", "face_rough", "tool", "offset", "home"))]
        getattr(self, self.rng.choices(kinds, [self.KINDS[k] for k in kinds])[0])()

    def here(self, x=None):
        self.abs()
        self.say(f"G0 {self.n(40, 90, 'X') if x is None else x} {self.n(2, 8, 'Z')}")

    def place(self, axes, low=20, high=70):
        """X or U, Z or W."""
        words = []
        for a in axes:
            if self.absolute and (self.system == "B" or self.p(0.65)):
                words.append(self.n(low, high, "X") if a == "X" else self.n(-40, 5, "Z"))
            else:
                plain = {"X": "U", "Z": "W"}[a] if self.system == "A" else a
                words.append(self.n(2, 14, plain) if self.p(0.6) else self.n(-10, -2, plain))
        return " ".join(words)

    def moves(self):
        for _ in range(self.rng.randint(1, 3)):
            code = self.rng.choice(("G0", "G1", "G1"))
            if self.system == "B" and self.p(0.2):
                self.absolute = not self.absolute
                code = ("G90 " if self.absolute else "G91 ") + code
            self.say(f"{code} {self.place(self.rng.choice(('X', 'Z', 'XZ')))} {self.feed()}")

    def arcs(self):
        d, e = round(self.rng.uniform(2, 8), 1), round(self.rng.uniform(2, 8), 1)
        u, w = ("U", "W") if self.system == "A" else ("X", "Z")
        was = self.absolute
        if self.system == "B" and self.absolute:
            self.absolute = False
            self.say("G91")
        code = self.rng.choice(("G2", "G3"))
        pick = self.rng.random()
        if pick < 0.5:
            r = (d * d + e * e) ** 0.5 * self.rng.uniform(0.6, 2)
            self.say(f"{code} {u}{2 * d:.1f} {w}-{e:.1f} R{r:.3f} {self.feed()}")
        elif pick < 0.8:
            self.say(f"{code} {u}{2 * d:.1f} {w}-{d:.1f} I{d:.1f} K0. {self.feed()}")
        else:
            self.say(f"{code} {w}-{2 * d:.1f} K-{d:.1f} {self.feed()}")
        if self.system == "B" and was:
            self.abs()

    def corners(self):
        r = self.rng
        self.abs()
        x, z = r.randint(10, 30), 0
        if self.p(0.7):
            self.say(f"G0 X{x}. {self.n(1, 5, 'Z')}")
        first = True
        for k in range(r.randint(2, 4)):
            z -= r.randint(10, 20)
            x += r.randint(22, 34)
            words = f"Z{z}." if k % 2 == 0 else f"X{x}." if self.p(0.7) else f"X{x}. Z{z - 6}."
            if self.system == "A" and self.p(0.3):
                words = f"W-{r.randint(12, 20)}." if k % 2 == 0 else f"U{r.randint(22, 30)}."
            self.say(f"{'G1 ' if first or self.p(0.2) else ''}{words} ,{r.choice('RC')}{self.n(0.5, 4)} "
                     f"{self.feed() if first else ''}".strip())
            first = False
        self.say(f"X{x + 40}. Z{z - 40}.")

    def angles(self):
        r = self.rng
        self.abs()
        x = r.randint(10, 30)
        self.say(f"G0 X{x}. {self.n(1, 5, 'Z')}") if self.p(0.7) else None
        kind = r.random()
        corner = f" ,{r.choice('RC')}{self.n(0.5, 3)}" if self.p(0.5) else ""
        if kind < 0.35:
            self.say(f"G1 X{r.randint(62, 90)}. ,A{r.randint(100, 170)}.{corner} {self.feed()}")
        elif kind < 0.6:
            self.say(f"G1 Z-{r.randint(10, 30)}. ,A{r.randint(120, 179)}.{corner} {self.feed()}")
        else:
            self.say(f"G1 ,A{r.choice((180, r.randint(150, 179)))}.{corner} {self.feed()}")
            self.say(f"X{r.randint(64, 100)}. Z-{r.randint(30, 70)}. ,A{r.randint(95, 140)}.")
            corner = ""
        if corner:
            self.say(f"X{r.randint(120, 150)}. Z-{r.randint(80, 99)}.")

    def passes(self):
        r = self.rng
        code = "G90" if self.system == "A" else "G77"
        if self.p(0.5):
            self.here()
        x = r.randint(30, 56)
        taper = f" R{self.n(-4, 4)}" if self.p(0.25) else ""
        first = self.rng.choice(("XZ", "XZ", "UW")) if self.system == "A" else "XZ"
        self.abs()
        if first == "XZ":
            self.say(f"{code} X{x}. Z-{r.randint(5, 40)}.{taper} {self.feed()}")
        else:
            self.say(f"{code} U-{r.randint(4, 10)}. W-{r.randint(8, 40)}.{taper} {self.feed()}")
        for k in range(r.randint(0, 3)):
            x -= r.randint(1, 4)
            self.say(f"X{x}." if self.system == "B" or self.p(0.7) else f"U-{r.randint(2, 12)}.")
        self.behind()

    def flow(self):
        """A pass that stays in force through a loop, corners whose second line is the next turn's."""
        r = self.rng
        if self.depth:
            return
        self.here()
        self.variable += 1
        v, count = f"#{self.variable}", r.randint(1, 3)
        if self.p(0.5):
            self.say(f"{'G90' if self.system == 'A' else 'G77'} X{r.randint(34, 39)}. Z-{r.randint(5, 40)}. {self.feed()}")
            self.lines += [f"{v}=0", f"WHILE[{v}LT{count}]DO1", f"X[33.-{v}*2]" if self.system == "B" or self.p(0.6) else
                           f"U-[{v}+4.]", f"{v}={v}+1", "END1"]
            self.behind()
        else:
            x, d = r.randint(10, 30), r.randint(8, 15)
            self.say(f"G0 X{x}. Z2.")
            self.lines += [f"{v}=0", f"WHILE[{v}LT{count}]DO1",
                           f"G1 Z[-{d}.-{v}*{d}] ,{r.choice('RC')}{r.randint(1, 3)}. {self.feed()}",
                           f"X[{x + 16}.+{v}*16.] ,{r.choice('RC')}{r.randint(1, 3)}.", f"{v}={v}+1", "END1"]
            self.say("Z-90.")

    def faces(self):
        r = self.rng
        code = "G94" if self.system == "A" else "G79"
        self.here()
        z = -r.randint(1, 5)
        taper = f" R{self.n(-3, 3)}" if self.p(0.25) else ""
        self.say(f"{code} X{r.randint(10, 36)}. Z{z}.{taper} {self.feed()}")
        for _ in range(r.randint(0, 3)):
            z -= r.randint(1, 3)
            self.say(f"Z{z}.")
        self.behind()

    def threads(self):
        r = self.rng
        self.here()
        code = "G92" if self.system == "A" else "G78"
        x = r.randint(30, 39)
        self.say(f"{code} X{x}. Z-{r.randint(10, 30)}. F{r.choice(('1.', '1.5', '2.'))}")
        for k in range(r.randint(1, 3)):
            self.say(f"X{x - (k + 1) * 0.4:.1f}")
        self.behind()

    def lead(self):
        self.here()
        self.say(f"G0 {self.n(20, 38, 'X')}")
        self.say(f"G{32 if self.system == 'A' else 33} Z-{self.rng.randint(10, 30)}. F1.5")
        self.say("G0 X60.")

    def behind(self):
        """A motion with its code, from where the cycle has left the tool."""
        if self.p(0.6):
            if self.system == "A" and self.p(0.6):
                self.say(f"{self.rng.choice(('G0', 'G1'))} {self.rng.choice(('U4.', 'W-3.', 'U6. W-4.', 'U-2. W2.'))} {self.feed()}")
            else:
                self.say(f"{self.rng.choice(('G0', 'G1'))} {self.place(self.rng.choice(('X', 'Z', 'XZ')))} {self.feed()}")
        else:
            self.here()

    def holes(self):
        r = self.rng
        self.abs()
        if self.p(0.6):
            self.say(f"G0 X0 Z{r.randint(4, 8)}.")
            x = ""
        else:
            self.here()
            x = "X0 "
        code = r.choice(("G83", "G83", "G85"))
        dwell = " P500" if self.p(0.3) else ""
        peck = f" Q{r.choice((3000, 5000, 4500))}" if code == "G83" and self.p(0.6) else ""
        mode = ""
        if self.system == "B" and self.p(0.35):
            mode, self.absolute = "G91 ", False
        if self.system == "A" or not self.absolute:
            level = f"R-{r.randint(1, 4)}."
        else:
            level = f"R-{r.randint(1, 4)}."
        z = f"Z-{r.randint(8, 30)}."
        self.say(f"{mode}{code} {x}{z} {level}{peck}{dwell} {self.feed()}")
        if self.p(0.3):
            self.say("G80")
        if self.p(0.5):
            self.absolute or self.say("G90")
            self.absolute = True
            self.say(f"G0 X{r.randint(30, 60)}.")
        else:
            self.behind()

    def contour(self, axis):
        """Blocks of P to Q for G71 (axis X) or G72 (axis Z); and the X and Z where it starts from."""
        r = self.rng
        p, q = self.label(), self.label()
        lines = []
        if axis == "X":
            x, z = r.randint(8, 20), 0
            lines.append(f"N{p} {r.choice(('G0', 'G1'))} X{x}.")
            for k in range(r.randint(2, 4)):
                z -= r.randint(5, 12)
                corner = f" ,{r.choice('RC')}{self.n(0.4, 2)}" if self.p(0.3) else ""
                lines.append(f"{'G1 ' if k == 0 or True else ''}Z{z}.{corner} {self.feed() if self.p(0.4) else ''}".strip())
                d = r.randint(2, 5)
                if corner or self.p(0.5):
                    x += 2 * d + (4 if corner else 0)
                    lines.append(f"X{x}." if corner or self.p(0.5) else f"X{x}. W-{d}." if self.system == "A" else f"X{x}.")
                    if lines[-1].endswith(f"W-{d}."):
                        z -= d
                else:
                    x += 2 * d
                    z -= d
                    lines.append(f"{r.choice(('G2', 'G3'))} X{x}. Z{z}. R{d}.")
            z -= r.randint(5, 10)
            lines.append(f"N{q} G1 Z{z}.")
            return p, q, lines, x + r.randint(2, 10), r.randint(1, 3)
        x, z = r.randint(50, 60), -r.randint(20, 30)
        top = x
        lines.append(f"N{p} {r.choice(('G0', 'G1'))} Z{z}.")
        for k in range(r.randint(2, 3)):
            x -= 2 * r.randint(3, 6)
            lines.append(f"G1 X{x}. {self.feed() if self.p(0.4) else ''}".strip())
            d = r.randint(1, 4)
            z += d
            if self.p(0.5):
                lines.append(f"Z{z}.")
            else:
                x -= 2 * d
                lines.append(f"X{x}. Z{z}.")
        x -= 2 * r.randint(2, 5)
        lines.append(f"N{q} X{x}.")
        return p, q, lines, top + r.randint(1, 6), 2

    def multiple(self, axis, code, first):
        """A roughing cycle in two blocks; `first`: the words of the first one."""
        self.abs()
        p, q, lines, x, z = self.contour(axis)
        self.say(f"G0 X{x}. Z{z}.")
        self.say(f"{code} {first()}")
        allowance = f" U{self.n(0.2, 0.8, digits=1)} W{self.n(0.05, 0.2, digits=2)}" if self.p(0.8) else ""
        self.say(f"{code} P{p} Q{q}{allowance} {self.feed()}")
        self.lines += lines
        if self.p(0.6):
            self.say(f"G70 P{p} Q{q}")
        self.behind()

    def rough(self):
        self.multiple("X", "G71", lambda: f"U{self.n(1, 3, digits=1)} R{self.n(0.3, 1, digits=1)}")

    def pattern(self):
        self.multiple("X", "G73", lambda: f"U{self.n(2, 6, digits=1)} W{self.n(0.5, 2, digits=1)} R{self.rng.randint(2, 4)}")

    def face_rough(self):
        self.multiple("Z", "G72", lambda: f"W{self.n(1, 3, digits=1)} R{self.n(0.3, 1, digits=1)}")

    def grooves(self):
        r = self.rng
        self.abs()
        if self.p(0.5):
            self.say(f"G0 X{r.randint(10, 40)}. Z{r.randint(2, 5)}.")
            self.say(f"G74 R{self.n(0.3, 1, digits=1)}")
            aside = f"X{r.randint(4, 8)}. " if self.p(0.4) else ""
            self.say(f"G74 {aside}Z-{r.randint(10, 30)}. {'P2000 ' if aside else ''}Q{r.choice((4000, 6500))} {self.feed()}")
        else:
            self.say(f"G0 X{r.randint(40, 60)}. Z-{r.randint(5, 20)}.")
            self.say(f"G75 R{self.n(0.3, 1, digits=1)}")
            aside = f"Z-{r.randint(22, 40)}. " if self.p(0.4) else ""
            self.say(f"G75 X{r.randint(20, 36)}. {aside}P{r.choice((2000, 3500))} {'Q2500 ' if aside else ''}{self.feed()}")
        self.behind()

    def tool(self):
        t = self.rng.choice("123")
        self.say(f"T0{t}0{t}")
        self.here()

    def offset(self):
        self.say(self.rng.choice(("G54", "G55")))
        self.here()

    def home(self):
        if self.system == "A":
            self.say("G28 U0 W0")
        else:
            self.say("G91 G28 X0 Z0")
            self.say("G90")
            self.absolute = True
        self.here()

    def misc(self):
        self.say(self.rng.choice(("M8", "M9", "S1200", "G4 P500", "M1")))

    def body(self):
        return self.body_of("moves", "arcs", "corners", "passes", "holes", "faces", "angles", "grooves")

    def sub(self):
        name = 1000 + self.label()
        self.tail += [f"O{name}"] + self.body() + ["M99"]
        count = self.rng.choice((1, 1, 2))
        self.say(f"M98 P{name}" + (f" L{count}" if count > 1 else ""))

    def loop(self):
        self.variable += 1
        v = f"#{self.variable}"
        self.lines += [f"{v}=0", f"WHILE[{v}LT{self.rng.randint(1, 3)}]DO1"]
        self.lines += self.body()
        if self.p(0.4) and self.absolute:
            self.lines.append(f"G1 X[60.-{v}*4] {self.feed()}")
        self.lines += [f"{v}={v}+1", "END1"]
