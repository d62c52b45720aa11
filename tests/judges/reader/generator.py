"""Random programs of the ISO mills: what stands in one program is mixed, and nothing says where the axes stand.

A program is a row of snippets; most go on from wherever the one before has left the tool. Whether it is one that the
control allows is judged by the interpreter, which refuses to read the others.
"""

from writing import Writing


class Mill(Writing):
    """Writes programs of one dialect."""

    ALL = {
        "fanuc": "flowholes stairs turns_off moves arcs cycles corners polar rotation mirror scaling shift preset offsets write sub macro loop jump "
                 "home machine units misc",
        "haas": "flowholes stairs turns_off moves arcs cycles corners polar rotation mirror scaling shift preset offsets write sub local macro loop "
                "jump home machine units misc",
        "mitsubishi": "flowholes stairs turns_off moves arcs cycles corners polar rotation mirror scaling preset offsets write sub macro loop jump "
                      "home machine units misc",
        "linuxcnc": "flowholes turns_off moves arcs cycles shift preset offsets write osub oloop oif home machine units misc centres turns",
        "grbl": "flowholes turns_off moves arcs cycles shift preset offsets write osub oloop oif home machine units misc centres turns",
        "mach": "flowholes moves arcs cycles rotation shift preset offsets oloop msub home machine units misc centres",
        "centroid": "moves arcs cycles offsets home machine units misc",
        "perspektiva": "moves arcs cycles offsets home units misc centres",
        "balt-system": "moves units machine misc",
    }
    WEIGHTS = {"moves": 4, "arcs": 3, "cycles": 6, "corners": 4, "flowholes": 3, "stairs": 2, "turns_off": 2, "polar": 2, "rotation": 3, "sub": 2, "macro": 2,
               "osub": 3, "oloop": 3, "oif": 1, "loop": 2}

    def __init__(self, rng, dialect):
        self.rng, self.dialect = rng, dialect
        self.kinds = self.ALL[dialect].split()
        self.lines, self.tail = [], []
        self.inch, self.absolute, self.plane = False, True, 17
        self.number, self.depth, self.turned, self.polars, self.variable = 100, 0, False, False, 100
        self.comma = "corners" in self.kinds
        self.repeats = {"fanuc": "K", "haas": "L", "mitsubishi": "L", "linuxcnc": "L", "grbl": "L", "mach": "L"}.get(
            dialect)
        self.ngc = dialect in ("linuxcnc", "grbl", "mach")
        self.levels_free = dialect in ("fanuc", "haas", "mitsubishi", "linuxcnc", "grbl")

    # ---- numbers ----
    def n(self, low, high, letter="", digits=None):
        """A length between low and high mm, in the unit in force."""
        digits = self.rng.choice((0, 0, 1, 2, 3)) if digits is None else digits
        value = self.rng.uniform(low, high)
        if self.inch:
            value, digits = value / 25.4, digits + 1
        return letter + self.show(round(value, digits))

    def show(self, value):
        text = f"{value:.6f}".rstrip("0")
        if text in ("-0.", "0."):
            return "0." if not self.ngc or self.rng.random() < 0.7 else "0"
        if self.dialect in ("linuxcnc", "grbl", "mach", "centroid", "perspektiva", "balt-system") and (
                text.endswith(".") and self.rng.random() < 0.5):
            text = text[:-1]
        elif text.endswith(".") and not self.inch and self.dialect in ("fanuc", "haas", "mitsubishi") and (
                self.rng.random() < 0.05):
            text = str(int(float(text) * 1000))
        return text

    def angle(self):
        value = self.rng.choice((0, 15, 30, 45, 60, 90, 120, 200, 270, -20, -45, self.rng.randint(-170, 350)))
        return f"{value}."

    def feed(self):
        value = self.rng.choice((80, 100, 150, 200, 300, 450))
        return f"F{value / 25.4:.2f}" if self.inch else f"F{value}."

    def axis_words(self, axes, low=-60, high=60):
        return " ".join(self.n(low, high, a) for a in axes)

    def step(self, a, far=25):
        return self.n(2, far, a) if self.p(0.5) else self.n(-far, -2, a)

    def steps(self, axes, far=25):
        return " ".join(self.step(a, far) for a in axes)

    def some(self, axes="XYZ"):
        return "".join(a for a in axes if self.p(0.6)) or self.rng.choice(axes)

    def say(self, text):
        if self.p(0.03):
            text = text.replace(" ", "")
        if self.p(0.05) and self.dialect != "balt-system" and not text.startswith(("O", "#", "IF", "WH", "END", "o")):
            text += " (NOTE)"
        if self.p(0.04) and not self.tail_mode and text[:1] in "GXYZ":
            self.number += 5
            text = f"N{self.number} {text}"
        self.lines.append(text)

    tail_mode = False

    # ---- the program ----
    def program(self):
        r = self.rng
        head = {"balt-system": "G71 G17 G90 G94", "okuma": ""}.get(self.dialect, "G21 G17 G90 G94 G40 G49 G80 G54")
        if self.dialect == "perspektiva":
            head = "G21 G17 G90 G94 G40 G80 G54"
        if self.dialect in ("fanuc", "haas", "mitsubishi", "mach"):
            self.lines += ["%", "O0001"] if self.dialect != "mach" else []
        if self.levels_free or self.dialect in ("mach", "centroid", "perspektiva"):
            head += r.choice((" G98", " G99"))
        self.say(head)
        self.say("M3 S1000")
        self.long = self.dialect not in ("balt-system",) and self.p(0.7)
        if self.long:
            self.say(f"G43 H{r.choice((1, 2, 7))} G0 {self.axis_words('XY')} {self.n(50, 80, 'Z')}")
        else:
            self.say(f"G0 {self.axis_words('XY')} {self.n(50, 80, 'Z')}")
        self.say(f"G1 {self.n(41, 49, 'Z')} {self.feed()}")
        for _ in range(r.randint(3, 8)):
            self.snippet()
            if self.p(0.25):
                self.here()
        self.lines.append("M5" if self.p(0.3) else "M9")
        self.lines.append("M2" if self.ngc and self.p(0.5) else "M30")
        self.lines += self.tail
        if self.lines[0] == "%":
            self.lines.append("%")
        return "\n".join(self.lines) + "\n"

    def here(self):
        """A place of all axes, in G90."""
        if not self.absolute:
            self.absolute = True
            self.say(f"G90 G0 {self.axis_words('XY')} {self.n(45, 80, 'Z')}")
        else:
            self.say(f"G0 {self.axis_words('XY')} {self.n(45, 80, 'Z')}")

    def snippet(self):
        kinds = [k for k in self.kinds if self.allowed(k)]
        kind = self.rng.choices(kinds, [self.WEIGHTS.get(k, 1) for k in kinds])[0]
        getattr(self, kind)()

    def allowed(self, kind):
        if self.turned and kind in ("rotation", "mirror", "scaling", "shift", "preset", "offsets", "write", "units",
                                    "machine", "home", "misc"):
            return False
        if self.depth and kind in ("flowholes", "stairs", "turns_off", "sub", "macro", "osub", "msub", "local", "preset",
                                   "write", "jump"):
            return False
        if kind == "preset" and self.long and (not self.ngc or self.dialect == "mach") and self.rng.random() < 0.97:
            return False
        if self.polars and kind not in ("cycles", "polar"):
            return False
        return True

    # ---- snippets ----
    def moves(self):
        r = self.rng
        for _ in range(r.randint(1, 4)):
            code = r.choice(("G0", "G1", "", "G1"))
            if self.p(0.3):
                self.absolute = not self.absolute
                code = (("G90 " if self.absolute else "G91 ") + (code or "G1")).strip()
            axes = self.some()
            words = self.axis_words(axes) if self.absolute else self.steps(axes)
            self.say(f"{code} {words} {self.feed() if self.p(0.3) else ''}".strip())

    def arcs(self):
        r = self.rng
        if self.p(0.25):
            self.plane = r.choice((17, 18, 19))
            self.say(f"G{self.plane}")
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        i, j = {17: "IJ", 18: "KI", 19: "JK"}[self.plane]
        n = ({"X", "Y", "Z"} - {p, q}).pop()
        code = r.choice(("G2", "G3"))
        how = r.random()
        if how < 0.35:                                       # a full circle from wherever it stands
            words = r.choice((f"{self.step(i)}", f"{self.step(j)}", f"{self.step(i)} {self.step(j)}"))
            self.say(f"{code} {words} {self.feed()}")
            if self.p(0.3):
                self.say(f"G1 {self.step(p, 30) if not self.absolute else self.n(-60, 60, p)}")
        elif how < 0.6:                                      # by radius, in increments
            was = self.absolute
            a, b = r.uniform(3, 20), r.uniform(3, 20)
            radius = (a * a + b * b) ** 0.5 * r.uniform(0.55, 2.0) * r.choice((1, 1, -1))
            if self.inch:
                a, b, radius = a / 25.4, b / 25.4, radius / 25.4
            helix = f" {self.step(n, 5)}" if self.p(0.3) else ""
            self.say(f"G91 {code} {p}{self.show(round(a, 3))} {q}{self.show(round(-b, 3))}{helix} "
                     f"R{self.show(round(radius, 3))} {self.feed()}")
            if was:
                if self.p(0.7):
                    self.say("G90")
                else:
                    self.absolute = False
            else:
                self.absolute = False
        else:                                                # a quarter or half, by its centre, in increments
            d = round(r.uniform(2, 20), 2)
            if self.inch:
                d = round(d / 25.4, 3)
            s = self.show(d)
            words = r.choice((f"{p}{s} {q}{s} {i}{s}", f"{p}{s} {q}-{s} {i}{s}", f"{p}{self.show(2 * d)} {i}{s}",
                              f"{p}-{s} {q}{s} {j}{s}"))
            helix = f" {self.step(n, 5)}" if self.p(0.3) else ""
            was = self.absolute
            self.say(f"G91 {code} {words}{helix} {self.feed()}")
            self.absolute = False
            if was and self.p(0.7):
                self.say("G90")
                self.absolute = True

    def cycle_words(self, code):
        r = self.rng
        if self.absolute:
            words = f"{self.n(-30, 10, 'Z')} {self.n(20, 40, 'R')}"
        else:
            words = f"{self.n(-25, -6, 'Z')} {self.n(-20, -2, 'R')}"
        if code in (73, 83):
            words += f" {self.n(2, 9, 'Q')}"
        self.dwells = self.dwells or code in (82, 89) or (code == 86 and self.ngc)
        if code in (82, 89) or (code == 86 and self.ngc):
            words += " P" + (r.choice(("0.5", "1")) if self.ngc and self.dialect != "mach" else "500")
        return words

    def cycles(self):
        r = self.rng
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        codes = {"perspektiva": (81, 82, 83, 85, 89), "centroid": (81, 82, 83, 73, 85, 89, 84), "mach": (81, 82, 83, 73, 85, 89),
                 "linuxcnc": (81, 82, 83, 73, 85, 89), "grbl": (81, 82, 83, 73, 85, 89)}.get(
            self.dialect, (81, 81, 82, 83, 73, 85, 89, 84, 86))
        if self.turned:
            codes = [c for c in codes if c not in (84, 86)]
        code, self.dwells = r.choice(codes), False
        self.say(f"G0 {self.n(45, 70, 'Z')}") if self.absolute and self.p(0.6) else None
        mode = ""
        if self.p(0.4) and not self.polars:
            self.absolute = not self.absolute
            mode = "G90 " if self.absolute else "G91 "
        axes = r.choice(("XY", "XY", "X", "Y", ""))
        if self.polars:
            axes = r.choice(("XY", "Y"))
        place = self.places(axes)
        count = ""
        if self.repeats and not self.absolute and self.p(0.6) and axes:
            count = f" {self.repeats}{r.randint(1, 5)}"
        elif self.repeats and self.p(0.05):
            count = f" {self.repeats}{r.choice((1, 2))}"
        level = r.choice(("G98 ", "G99 ", "", ""))
        self.say(f"{mode}{level}G{code} {place} {self.cycle_words(code)}{count} {self.feed()}".replace("  ", " "))
        for _ in range(r.randint(0, 4)):
            self.next_hole()
        end = r.random()
        if end < 0.6:
            self.say("G80")
            if self.ngc:                                     # no motion code is in force behind it
                self.after_cycle()
        else:
            self.after_cycle()

    def after_cycle(self):
        if self.polars:
            self.say("G80")
            return
        code = self.rng.choice(("G0", "G1"))
        if not self.ngc and self.lines and self.lines[-1].startswith("G80") and self.p(0.3):
            code = ""                                       # what was in force before the cycle
        words = self.axis_words(self.some("XY")) if self.absolute else self.steps(self.some("XY"))
        if self.p(0.5):
            words += " " + (self.n(45, 80, "Z") if self.absolute else self.n(5, 20, "Z"))
        self.say(f"{code} {words}".strip())

    def places(self, axes):
        if self.polars:
            return " ".join((self.n(15, 60, "X") if a == "X" else f"Y{self.angle()}") for a in axes)
        return self.axis_words(axes) if self.absolute else self.steps(axes)

    def next_hole(self):
        r = self.rng
        text = ""
        if self.levels_free and self.p(0.12) and not self.polars:
            self.absolute = not self.absolute
            text = "G90 " if self.absolute else "G91 "
            words = self.places(r.choice(("XY", "X", "Y")))
            if self.p(0.97) or self.ngc:
                words += f" {self.cycle_words(81)}"
            text += words
        else:
            axes = r.choice(("XY", "XY", "X", "Y")) if not self.polars else r.choice(("XY", "Y"))
            text = self.places(axes)
            fresh = self.p(0.15)
            if fresh:
                text += " " + (self.n(-30, 10, "Z") if self.absolute else self.n(-25, -6, "Z"))
            if self.p(0.15) and self.absolute or fresh and self.p(0.5) or self.p(0.002):
                text += " " + (self.n(20, 40, "R") if self.absolute else self.n(-20, -2, "R"))
        if self.repeats and not self.absolute and self.p(0.3):
            text += f" {self.repeats}{r.randint(2, 4)}"
        if self.p(0.15):
            text = r.choice(("G98 ", "G99 ")) + text
        if self.p(0.1):
            text += " " + self.feed()
        if self.p(0.1):
            code = r.choice((81, 83, 82)) if not self.dwells else r.choice((82, 89))
            text = f"G{code} {text} {self.cycle_words(code)}"
            text = self.once(text)
        if self.p(0.06):
            self.say(r.choice(("M8", "G4 P500", "M9") if not self.ngc else ("M8", "M9", "M8", "G4 P0.5")))
        self.say(text)

    @staticmethod
    def once(text):
        """The first of each letter but G."""
        seen, kept = set(), []
        for word in text.split():
            if word[0] in seen and word[0] != "G":
                continue
            seen.add(word[0])
            kept.append(word)
        return " ".join(kept)

    def corners(self):
        """Corners on lines that are long, whatever the start: one axis after the other."""
        r = self.rng
        self.abs()
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        far = {p: r.choice((-1, 1)), q: r.choice((-1, 1))}
        count = r.randint(1, 4)
        first = True
        for k in range(count + 1):
            if self.p(0.7):
                axis = p if k % 2 == r.choice((0, 0, 0, 1)) else q
                words = self.n(70, 140, axis) if far[axis] > 0 else self.n(-140, -70, axis)
                far[axis] = -far[axis]
            else:
                words = f"{self.n(70, 140, p) if far[p] > 0 else self.n(-140, -70, p)} {self.n(-140, 140, q)}"
                far[p] = -far[p]
            corner = ""
            if k < count:
                corner = "," + r.choice("RC") + self.n(1, 9, digits=r.choice((0, 1, 2)))
            self.say(f"{'G1 ' if first or self.p(0.2) else ''}{words} {corner} {self.feed() if first else ''}".strip())
            first = False

    def polar_on(self):
        self.abs()
        self.say(f"G16" if self.p(0.5) else f"G16 G90")
        self.polars = True

    def polar_off(self):
        self.polars = False
        self.say("G15")

    def polar_words(self):
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        return f"{self.n(15, 70, p)} {q}{self.angle()}", p, q

    def polar(self):
        r = self.rng
        self.polar_on()
        words, p, q = self.polar_words()
        self.say(f"{r.choice(('G0', 'G1'))} {words}")
        for _ in range(r.randint(1, 4)):
            pick = r.random()
            if pick < 0.3 and self.plane == 17:
                self.cycles()
            elif pick < 0.5:
                self.say(f"G0 {q}{self.angle()}")
            elif pick < 0.7:
                self.say(f"G1 {self.n(15, 70, p)} {self.feed()}")
            elif pick < 0.8:
                self.say(f"{r.choice(('G2', 'G3'))} {q}{self.angle()} {self.n(71, 150, 'R')} {self.feed()}")
            else:
                self.say(f"G1 {self.polar_words()[0]} {self.feed()}")
        self.polar_off()

    def rotation(self):
        r = self.rng
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        if self.dialect == "mach" and self.plane != 17:
            return
        self.abs() if self.p(0.8) else None
        if self.dialect in ("fanuc", "mitsubishi") and self.p(0.35):
            self.say(f"G68 R{self.angle()}")
        else:
            self.say(f"G68 {self.n(-40, 40, p)} {self.n(-40, 40, q)} R{self.angle()}")
        self.turned = True
        if self.absolute:
            self.say(f"{r.choice(('G0', 'G1'))} {self.n(-60, 60, p)} {self.n(-60, 60, q)}")
        for _ in range(r.randint(1, 4)):
            self.snippet_of("moves arcs cycles corners polar")
        self.turned = False
        self.say("G69")
        if self.p(0.6):
            self.here()
        else:
            self.say(f"{'' if self.absolute else 'G90 '}G0 {self.n(-60, 60, p)} {self.n(-60, 60, q)}")
            self.absolute = True

    def snippet_of(self, kinds):
        kinds = [k for k in kinds.split() if k in self.kinds and self.allowed(k)]
        kind = self.rng.choices(kinds, [self.WEIGHTS.get(k, 1) for k in kinds])[0]
        getattr(self, kind)()

    def mirror(self):
        self.abs()
        axes = self.rng.choice(("X", "Y", "XY"))
        self.say(f"G51.1 {self.axis_words(axes, -20, 20)}")
        self.turned = True
        self.here()
        for _ in range(self.rng.randint(1, 3)):
            self.snippet_of("moves arcs corners cycles")
        self.turned = False
        self.say(f"G50.1 {' '.join(a + '0.' for a in axes)}")
        self.here()

    def scaling(self):
        self.abs()
        self.say(f"G51 {self.axis_words('XYZ', -20, 20)} P{self.rng.choice(('2.', '1500', '0.5', '750'))}")
        self.turned = True
        self.here()
        for _ in range(self.rng.randint(1, 3)):
            self.snippet_of("moves arcs")
        self.turned = False
        self.say("G50")
        self.here()

    def shift(self):
        if self.dialect == "mach" or self.p(0.95):
            self.abs()
        self.say(f"G52 {self.axis_words(self.some(), -30, 30)}")
        if self.p(0.5):
            self.here()
        for _ in range(self.rng.randint(1, 2)):
            self.snippet_of("moves cycles corners arcs rotation")
        if self.p(0.7):
            self.say("G52 X0. Y0. Z0.")
            if self.p(0.5):
                self.here()

    def preset(self):
        if self.p(0.5):
            self.here()
        if self.dialect in ("linuxcnc", "mach", "grbl", "fanuc", "haas"):
            self.abs()
        self.say(f"G92 {self.axis_words(self.some(), -30, 30)}")
        for _ in range(self.rng.randint(1, 2)):
            self.snippet_of("moves cycles corners arcs rotation")
        if self.dialect in ("linuxcnc", "mach", "grbl", "fanuc") and self.p(0.6):
            self.say("G92.1" + ("" if self.dialect in ("linuxcnc", "grbl") else " X0. Y0. Z0." if self.p(0.5) else ""))

    def offsets(self):
        r = self.rng
        code = r.choice(("G54", "G55", "G56", "G57", "G58", "G59"))
        if self.dialect in ("fanuc", "mitsubishi") and self.p(0.25):
            code = f"G54.1 P{r.choice((1, 2, 7))}"
        if self.dialect == "haas" and self.p(0.3):
            code = r.choice(("G154 P1", "G154 P2", "G110", "G111", "G116"))
        how = r.random()
        if how < 0.4:
            self.say(code)
            if self.p(0.5):
                self.here()
        elif how < 0.8:
            self.absolute = True
            self.say(f"G90 {code} G0 {self.axis_words(self.some())}")
        else:
            self.say(f"{code} {r.choice(('G0', 'G1'))} "
                     f"{self.axis_words('XY') if self.absolute else self.steps('XY')}")

    def write(self):
        r = self.rng
        if self.ngc and self.p(0.4):
            self.here()
            self.say(f"G10 L20 P{r.choice((1, 2, 3))} {self.axis_words(self.some(), -40, 40)}")
        elif not self.ngc and self.p(0.3):
            n = r.choice((1, 2, 7))
            self.say(f"G90 G10 L20 P{n} {self.axis_words('XYZ', -100, 100)}")
            self.absolute = True
            self.say(f"G{'154' if self.dialect == 'haas' else '54.1'} P{n}")
        else:
            axes = "XYZ" if self.p(0.5) else self.some()
            mode = ""
            if self.p(0.6):
                mode, self.absolute = "G90 ", True
            n = r.choice((1, 2, 3))
            if self.p(0.9):
                self.say(f"G{r.choice([k for k in (54, 55, 56) if k != n + 53])}")
            self.say(f"{mode}G10 L2 P{n} {self.axis_words(axes, -100, 100)}")
            if self.p(0.9):
                self.say(f"G{n + 53}")
        if self.p(0.6):
            self.here()

    def home(self):
        r = self.rng
        how = r.random()
        if how < 0.6:
            self.say("G91 G28 Z0." if not self.ngc or self.p(0.5) else "G91 G28 Z0")
            self.absolute = False
        elif how < 0.8:
            self.abs()
            self.say(f"G28 {self.n(60, 90, 'Z')}")
        else:
            self.say("G91 G28 X0. Y0. Z0.")
            self.absolute = False
        if self.p(0.5) and self.absolute is False:
            self.say("G90")
            self.absolute = True
        self.here()

    def machine(self):
        self.abs()
        code = "G79" if self.dialect == "balt-system" else "G53"
        self.say(f"{code} G0 {self.axis_words(self.rng.choice(('Z', 'XY', 'XYZ', 'X')), 50, 300)}"
                 if self.p(0.6) or self.ngc or self.dialect == "balt-system"
                 else f"G0 {code} {self.n(100, 300, 'Z')}")
        if self.p(0.7):
            self.here()
        else:
            self.say(f"G0 {self.n(45, 80, 'Z')}")

    def units(self):
        self.inch = not self.inch
        word = "G20" if self.inch else "G21"
        if self.dialect in ("perspektiva", "mach") and self.p(0.3) or self.dialect == "balt-system":
            word = "G70" if self.inch else "G71"
        self.say(word)
        if self.p(0.3):
            self.here()
        self.say(f"G1 {self.n(41, 49, 'Z') if self.absolute else self.step('Z', 5)} {self.feed()}")

    def misc(self):
        r = self.rng
        pick = r.random()
        if pick < 0.3:
            self.say({"linuxcnc": "G4 P0.5", "grbl": "G4 P0.5", "mach": "G4 P500", "balt-system": "G9"}.get(
                self.dialect, "G4 P250"))
        elif pick < 0.5:
            self.say(r.choice(("M8", "M9", "S1500", "M1", "M0")))
        elif pick < 0.7:
            self.say(f"M8 G1 {self.n(-60, 60, 'X') if self.absolute else self.step('X')} {self.feed()}")
        elif pick < 0.85 and self.dialect not in ("balt-system",):
            self.say(f"T{r.choice((1, 2, 7))} M6")
            self.absolute = True
            self.say(f"G90 G0 G43 H{r.choice((1, 2, 7))} {self.axis_words('XYZ', 45, 80)}")
            self.long = True
        else:
            self.say(f"G0 {self.n(-60, 60, 'Y') if self.absolute else self.step('Y')} M9")

    def centres(self):
        """Absolute centres: a quarter from a place that is named."""
        r = self.rng
        self.abs()
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        x, y, d = r.randint(-40, 40), r.randint(-40, 40), r.randint(3, 20)
        if self.inch:
            x, y, d = x / 10, y / 10, d / 10
        self.say(f"G1 X{x} Y{y} {self.feed()}")
        self.say(f"G90.1 {r.choice(('G2', 'G3'))} X{x + d:g} Y{y + d:g} I{x + d:g} J{y}")
        if self.p(0.5):
            self.say(f"G3 I{x + d:g} J{y}")
        self.say("G91.1")

    def turns(self):
        r = self.rng
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        self.say(f"{r.choice(('G2', 'G3'))} {self.step('I')} {self.step('J')} "
                 f"{self.n(20, 44, 'Z') if self.absolute else self.step('Z', 8)} P{r.randint(1, 4)} {self.feed()}")

    # ---- flow ----
    def body(self, kinds="moves arcs cycles corners polar rotation"):
        """Lines of a subprogram or loop, written apart."""
        was, self.lines, inch = self.lines, [], self.inch
        self.depth += 1
        for _ in range(self.rng.randint(1, 3)):
            self.snippet_of(kinds + (" units home machine shift offsets" if self.p(0.3) else ""))
        self.depth -= 1
        if self.inch != inch:
            self.inch = inch
            self.lines.append("G20" if inch else "G21")
        body, self.lines = self.lines, was
        return body

    def name(self):
        self.number += 7
        return 1000 + self.number

    def sub(self):
        r = self.rng
        self.tail_mode = True
        start = self.absolute, self.plane
        name, count = self.name(), r.choice((1, 1, 2, 3))
        body = self.body()
        if self.absolute != start[0] and self.p(0.7):
            self.absolute = start[0]
            body.append("G90" if start[0] else "G91")
        if self.plane != start[1]:
            self.plane = start[1]
            body.append(f"G{self.plane}")
        self.tail += [f"O{name}"] + body + ["M99"]
        self.tail_mode = False
        call = f"M98 P{name}" + (f" L{count}" if count > 1 else "")
        if self.dialect == "fanuc" and count > 1 and self.p(0.3):
            call = f"M98 P{count}{name:04d}"
        self.say(call)

    def local(self):
        name, count = self.name() + 5000, self.rng.choice((1, 2))
        self.tail_mode = True
        start = self.absolute, self.plane
        body = self.body("moves arcs cycles corners")
        if self.absolute != start[0]:
            self.absolute = start[0]
            body.append("G90" if start[0] else "G91")
        if self.plane != start[1]:
            self.plane = start[1]
            body.append(f"G{self.plane}")
        self.tail_mode = False
        self.tail = [f"N{name}"] + body + ["M99"] + self.tail
        self.say(f"M97 P{name}" + (f" L{count}" if count > 1 else ""))

    def macro(self):
        r = self.rng
        name = self.name()
        self.tail_mode = True
        was = self.absolute
        body = []
        kind = r.random()
        if kind < 0.4:
            body += ["#20=0", f"WHILE[#20LT#3]DO1", f"G91 G1 X#1 Y[#2*#20] {self.feed()}", "#20=#20+1", "END1", "G90"]
            self.absolute = True
        elif kind < 0.7:
            body += [f"G90 G99 G81 X#1 Y#2 Z[#3-20.] R30. {self.feed()}", "X[#1+15.]", "G80"]
            self.absolute = True
        else:
            body += ["IF[#1GT5.]GOTO20", f"G91 G1 X[0-#1] {self.feed()}", "GOTO30", "N20 G91 G1 Y#2 X[#3*2]", "N30",
                     "G90"]
            self.absolute = True
        self.tail += [f"O{name}"] + body + ["M99"]
        self.tail_mode = False
        self.say(f"G65 P{name} A{r.randint(1, 12)}. B{r.randint(1, 12)}. C{r.randint(1, 4)}."
                 + (f" L{r.randint(2, 3)}" if self.p(0.01) else ""))

    def loop(self):
        r = self.rng
        self.variable += 1
        v, count = f"#{self.variable}", r.randint(1, 3)
        was, plane = self.absolute, self.plane
        self.say(f"{v}=0")
        self.say(r.choice((f"WHILE[{v}LT{count}]DO1", f"WHILE [{v} LE {count - 1}] DO 1", f"WH[{v}LT{count}]DO1"))
                 if self.dialect == "fanuc" else f"WHILE[{v}LT{count}]DO1")
        self.lines += self.body("moves arcs cycles corners polar")
        self.lines.append(f"G{90 if was else 91} G{plane}")
        self.absolute, self.plane = was, plane
        if self.p(0.5):
            if was:
                self.lines.append(f"G1 X[{v}*7.5+3.] Y[-{v}*4.] {self.feed()}")
            else:
                self.lines.append(f"G1 X[{v}*2.5+3.] {self.feed()}")
        self.lines += [f"{v}={v}+1", "END1"]

    def jump(self):
        r = self.rng
        self.variable += 1
        v = f"#{self.variable}"
        label = self.name() + 3000
        self.say(f"{v}={r.randint(1, 3)}")
        self.say(f"IF[{v}{r.choice(('EQ', 'GT', 'LE', 'NE'))}2]GOTO{label}")
        self.lines += self.body("moves corners")
        self.abs()
        self.plane == 17 or self.say(f"G{self.plane}")
        self.say(f"N{label} G90 G0 {self.axis_words('XYZ', 40, 60)}")
        self.absolute = True

    def open_loop(self, count):
        """The first lines of a loop and its last ones."""
        self.variable += 1
        v, name = f"#{self.variable}", self.name()
        if self.ngc:
            kind = self.rng.choice(("repeat", "while"))
            head = [f"{v}=0", f"o{name} repeat [{count}]" if kind == "repeat" else f"o{name} while [{v} lt {count}]"]
            return v, head, [f"{v}=[{v}+1]", f"o{name} end{kind}"]
        return v, [f"{v}=0", f"WHILE[{v}LT{count}]DO2"], [f"{v}={v}+1", "END2"]

    def flowholes(self):
        """A cycle that stays in force through a loop or a call whose blocks name places alone."""
        r = self.rng
        if self.turned or self.polars:
            return
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        code = r.choice((81, 82, 83, 73, 85))
        self.dwells = False
        if self.p(0.5):
            self.abs()
            self.say(f"G0 {self.n(45, 70, 'Z')}")
        level = r.choice(("G98 ", "G99 ", ""))
        self.say(f"{level}G{code} {self.places('XY')} {self.cycle_words(code)} {self.feed()}")
        k = 25.4 if self.inch else 1
        where = r.random()
        if where < 0.6 or self.depth:
            v, head, tail = self.open_loop(r.randint(1, 3))
            self.lines += head
            step, at = f"{round(r.randint(5, 15) / k, 2)}", f"{round(r.randint(-30, 30) / k, 2)}"
            self.lines.append(r.choice((f"X[{v}*{step}+{at}]", f"X[{v}*{step}+{at}] Y[0-{v}*{step}]", f"Y[{at}+{v}]"))
                              if self.absolute else r.choice((f"X{step}", f"X{step} Y-{step}", f"Y[{step}+{v}]")))
            if self.p(0.3):
                self.lines.append(self.places(r.choice(("X", "Y", "XY"))))
            self.lines += tail
        elif not self.ngc:
            name = self.name()
            body = [self.places(r.choice(("X", "Y", "XY"))) for _ in range(r.randint(1, 3))]
            if self.repeats and not self.absolute and self.p(0.4):
                body[-1] += f" {self.repeats}{r.randint(2, 3)}"
            self.tail += [f"O{name}"] + body + ["M99"]
            self.say(f"M98 P{name}" + (f" L{r.randint(2, 3)}" if self.p(0.3) else ""))
        if self.p(0.4):
            self.say(self.places("X"))
        if self.p(0.7):
            self.say("G80")
        self.after_cycle()

    def stairs(self):
        """Corners whose second line comes from the next turn of a loop, or from behind it."""
        r = self.rng
        if self.turned or self.polars or self.inch:
            return
        self.abs()
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        x, y, d = r.randint(-50, 20), r.randint(-50, 20), r.randint(15, 30)
        self.say(f"G1 X{x}. Y{y}. {self.feed()}")
        v, head, tail = self.open_loop(r.randint(1, 4))
        self.lines += head
        self.lines.append(f"X[{v}*{d}.+{x + d}.] ,{r.choice('RC')}{r.randint(1, 4)}.")
        self.lines.append(f"Y[{v}*{d}.+{y + d}.] ,{r.choice('RC')}{r.randint(1, 4)}.")
        self.lines += tail
        self.say(f"X{x + 200}.")

    def turns_off(self):
        """A code that ends something, beside a motion."""
        r = self.rng
        if self.turned or self.polars or self.depth:
            return
        pick = r.random()
        self.abs()
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        if pick < 0.35 and not self.ngc:
            self.say(f"G68 {self.n(-40, 40, 'X')} {self.n(-40, 40, 'Y')} R{self.angle()}")
            self.say(f"G1 {self.n(-40, 40, 'X')} {self.n(-40, 40, 'Y')} {self.feed()}")
            self.say(f"{self.n(-40, 40, 'X')}")
            self.say(f"G69 {r.choice(('G0', 'G1'))} {self.n(-40, 40, 'X')} {self.n(-40, 40, 'Y')}")
        elif pick < 0.65 and not self.ngc:
            self.say("G16")
            self.say(f"{r.choice(('G0', 'G1'))} {self.n(15, 60, 'X')} Y{self.angle()} {self.feed()}")
            self.say(f"Y{self.angle()}")
            self.say(f"G15 {r.choice(('G0', 'G1'))} {self.axis_words(self.some('XY'))}")
        else:
            self.dwells = False
            code = r.choice((81, 83))
            self.say(f"G{code} {self.places('XY')} {self.cycle_words(code)} {self.feed()}")
            self.say(self.places("X"))
            self.say(f"G80 {r.choice(('G0', 'G1'))} {self.axis_words(self.some('XY'))}")

    # ---- O-words ----
    def osub(self):
        r = self.rng
        name = self.name()
        self.tail_mode = True
        was, plane = self.absolute, self.plane
        body = self.body("moves arcs cycles centres turns rotation")
        self.absolute, self.plane = was, plane
        body.append(f"G{90 if was else 91} G{plane}")
        if was:
            body.append(f"G1 X[#1+#2] Y[#2*2] {self.feed()}")
        else:
            body.append(f"G1 X[#1/2+1] {self.feed()}")
        self.tail_mode = False
        where = self.lines if self.p(0.99) else self.tail
        where += [f"o{name} sub"] + body + [f"o{name} endsub"]
        self.say(f"o{name} call [{r.randint(1, 20)}] [{r.randint(1, 9)}+1]")
        if self.p(0.3):
            self.say(f"o{name} call [{r.randint(1, 20)}] [3]")

    def msub(self):
        name = self.name()
        self.tail_mode = True
        was, plane = self.absolute, self.plane
        body = self.body("moves arcs cycles")
        self.absolute, self.plane = was, plane
        body.append(f"G{90 if was else 91} G{plane}")
        self.tail_mode = False
        self.tail += [f"O{name}"] + body + ["M99"]
        self.say(f"M98 P{name}" + (f" L{self.rng.randint(2, 3)}" if self.p(0.4) else ""))

    def oloop(self):
        r = self.rng
        name = self.name()
        self.variable += 1
        v = f"#{self.variable}"
        was, plane = self.absolute, self.plane
        kind = r.choice(("while", "repeat", "do"))
        self.say(f"{v}=0")
        if kind == "while":
            self.lines.append(f"o{name} while [{v} lt {r.randint(1, 3)}]")
        elif kind == "repeat":
            self.lines.append(f"o{name} repeat [{r.randint(1, 3)}]")
        else:
            self.lines.append(f"o{name} do")
        self.lines += self.body("moves arcs cycles")
        self.absolute, self.plane = was, plane
        self.lines.append(f"G{90 if was else 91} G{plane}")
        self.lines.append(f"{v}=[{v}+1]")
        if self.p(0.5):
            self.lines.append(f"G1 X[{v}*2.5+3] {self.feed()}")
        self.lines.append({"while": f"o{name} endwhile", "repeat": f"o{name} endrepeat",
                           "do": f"o{name} while [{v} lt {r.randint(1, 3)}]"}[kind])

    def oif(self):
        r = self.rng
        name = self.name()
        self.variable += 1
        v = f"#{self.variable}"
        was, plane = self.absolute, self.plane
        self.say(f"{v}={r.randint(1, 3)}")
        self.lines.append(f"o{name} if [{v} eq 2]")
        self.lines += self.body("moves")
        self.lines.append(f"G{90 if was else 91} G{plane}")
        self.absolute, self.plane = was, plane
        self.lines.append(f"o{name} else")
        self.lines += self.body("moves arcs")
        self.lines.append(f"G{90 if was else 91} G{plane}")
        self.absolute, self.plane = was, plane
        self.lines.append(f"o{name} endif")

