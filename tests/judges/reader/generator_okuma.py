"""Random programs of Okuma machining centres."""

from generator import Mill


class OkumaMill(Mill):
    KINDS = "moves arcs holes holes holes vloop vjump call offsets length misc units home xeq".split()

    def __init__(self, rng, include=None):
        Mill.ALL = {**Mill.ALL, "okuma": ""}
        super().__init__(rng, "okuma")
        self.kinds, self.comma, self.repeats, self.vc = self.KINDS, False, None, 0
        self.levels_free = False

    def show(self, value):
        text = super().show(value)
        return text if "." in text else text

    def say(self, text):
        if self.p(0.05) and text[:1] in "GXYZ":
            text += " (NOTE)"
        self.lines.append(text)

    def program(self):
        r = self.rng
        self.lines = ["O1 (PART)"]
        self.say("G15 H1")
        self.say("G0 G17 G21 G40 G53 G80 G90 X10. Y10. Z60.")
        self.say("S900 M3")
        self.long = False
        if self.p(0.5):
            self.say(f"G56 H{r.choice((1, 2, 7))} {self.n(50, 80, 'Z')}")
        self.say(f"G1 {self.n(41, 49, 'Z')} {self.feed()}")
        for _ in range(r.randint(3, 8)):
            self.snippet()
            if self.p(0.25):
                self.here()
        self.lines += ["M5", r.choice(("M2", "M30"))] + self.tail
        return "\n".join(self.lines) + "\n"

    def allowed(self, kind):
        return not (self.depth and kind in ("vjump", "call", "offsets", "length", "units", "home"))

    def holes(self):
        r = self.rng
        self.abs()
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        how = r.choice(("M53", "M54"))
        if how == "M53":
            self.say(f"G71 {self.n(45, 70, 'Z')}")
        self.say(f"G0 {self.n(50, 75, 'Z')}") if self.p(0.6) else None
        code = r.choice((81, 81, 82, 83))
        axes = r.choice(("XY", "XY", "X", "Y", ""))
        peck = f" {self.n(2, 9, 'Q')}" if code == 83 else ""
        dwell = " P0" if code == 82 and self.p(0.5) else ""
        self.say(f"G{code} {self.axis_words(axes)} {self.n(-30, 10, 'Z')} {self.n(20, 40, 'R')}{peck}{dwell} "
                 f"{self.feed()} {how}".replace("  ", " "))
        for _ in range(r.randint(0, 4)):
            text = self.axis_words(r.choice(("XY", "X", "Y")))
            if self.p(0.005):
                text += f" {self.n(-30, 10, 'Z')}"
            if self.p(0.005):
                text += f" {self.n(20, 40, 'R')}"
            if self.p(0.1):
                code2 = r.choice((81, 83))
                text = (f"G{code2} {self.axis_words('XY')} {self.n(-30, 10, 'Z')} {self.n(20, 40, 'R')}"
                        + (f" {self.n(2, 9, 'Q')}" if code2 == 83 else "") + f" {self.feed()}"
                        + (f" {how}" if self.p(0.97) else ""))
            self.say(text)
        if self.p(0.7):
            self.say("G80")
        code = r.choice(("G0", "G1"))
        self.say(f"{code} {self.axis_words(self.some('XY'))}" + (f" {self.n(45, 80, 'Z')}" if self.p(0.5) else ""))

    def offsets(self):
        h = self.rng.choice((1, 2, 3))
        self.abs()
        self.say(f"G15 H{h}")
        if self.p(0.7):
            self.here()

    def length(self):
        self.abs()
        self.say(self.rng.choice((f"G56 H{self.rng.choice((1, 2, 7))} {self.n(50, 80, 'Z')}", f"G53 {self.n(50, 80, 'Z')}")))

    def units(self):
        pass

    def misc(self):
        self.say(self.rng.choice(("M8", "M9", "S1500", "G4 F0.5", "M1", "G9")))

    def home(self):
        self.say("G30 P1")
        self.absolute = True
        self.say(f"G90 G0 {self.axis_words('XYZ', 45, 80)}")

    def body(self):
        was, self.lines = self.lines, []
        start = self.absolute, self.plane
        self.depth += 1
        for _ in range(self.rng.randint(1, 2)):
            self.rng.choice((self.moves, self.arcs, self.holes, self.xeq))()
        self.depth -= 1
        if (self.absolute, self.plane) != start:
            self.absolute, self.plane = start
            self.lines.append(f"G{90 if self.absolute else 91} G{self.plane}")
        body, self.lines = self.lines, was
        return body

    def xeq(self):
        self.vc += 1
        v = f"VC{self.vc}"
        self.say(f"{v}={self.rng.randint(2, 20)}.")
        how = self.rng.choice((f"X={v}*2", f"X={v}+3 Y=-{v}", f"Y=[{v}+2]*1.5", f"X={v}*COS[30] Y={v}*SIN[30]",
                               f"X=10+{v}", f"Z=40+SQRT[{v}]"))
        if not self.absolute and how.startswith("Z"):
            how = f"X={v}"
        self.say(f"{self.rng.choice(('G0', 'G1'))} {how}")

    def vloop(self):
        r = self.rng
        self.vc += 1
        v, label, count = f"VC{self.vc}", f"N{self.name()}", r.randint(1, 3)
        self.say(f"{v}=0")
        body = self.body()
        body[0] = f"{label} {body[0]}" if not body[0].startswith(("VC", "N")) else body[0]
        if not body[0].startswith(label):
            body.insert(0, f"{label} M8")
        self.lines += body
        if self.p(0.5):
            self.say(f"G1 X={v}*5+3")
        self.lines += [f"{v}={v}+1", f"IF [{v} LT {count}] {label}"]

    def vjump(self):
        r = self.rng
        self.vc += 1
        v, label = f"VC{self.vc}", f"N{self.name()}"
        self.say(f"{v}={r.randint(1, 3)}")
        self.say(f"IF [{v} {r.choice(('EQ', 'GT', 'LE', 'NE'))} 2] {r.choice(('', 'GOTO '))}{label}")
        self.lines += self.body()
        self.absolute = True
        self.lines.append(f"{label} G90 G0 {self.axis_words('XYZ', 45, 70)}")

    def call(self):
        name = self.rng.choice((str(self.name()), f"SUB{self.name()}"))
        body = self.body()
        self.tail += [f"O{name}"] + body + ["RTS"]
        count = self.rng.choice((1, 1, 2, 3))
        self.say(f"CALL O{name}" + (f" Q{count}" if count > 1 else ""))
