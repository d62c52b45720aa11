"""Random programs of Sinumerik lathes."""

from generator_siemens import SiemensMill


class SiemensTurnProgram(SiemensMill):
    KINDS = dict(moves=5, arcs=4, variables=3, loop=3, jump=2, sub=3, offsets=1, diameter=2, tool=1, misc=1)

    def program(self):
        r = self.rng
        self.lines = ["%_N_SHAFT_MPF"] if self.p(0.4) else []
        self.how = r.choice(("DIAMON", "DIAMON", "DIAMOF", "DIAM90"))
        self.say(f"G18 G40 G71 G90 G95 G54 {self.how}")
        self.say("T1 D1")
        self.say("M3 S1000")
        self.say("G0 X60 Z5")
        self.say("G1 X58 F0.2")
        for _ in range(r.randint(3, 8)):
            self.snippet(self.KINDS)
            if self.p(0.3):
                self.here()
        self.say("M5")
        self.lines.append("M30")
        return "\n".join(self.lines) + "\n"

    def snippet(self, kinds):
        names = [k for k in kinds if not (self.depth and k in ("sub", "tool", "offsets", "jump"))]
        getattr(self, self.rng.choices(names, [self.KINDS[k] for k in names])[0])()

    def feed(self):
        return f"F{self.rng.choice((0.1, 0.15, 0.2, 0.3))}"

    def here(self):
        self.absolute or self.say("G90")
        self.absolute = True
        self.say(f"G0 X{self.rng.randint(60, 90)} {self.n(2, 8, 'Z')}")

    def n(self, low, high, letter="", digits=None):
        value = self.rng.uniform(low, high)
        digits = self.rng.choice((0, 0, 1, 2, 3)) if digits is None else digits
        text = f"{round(value, digits):g}" if digits else str(int(round(value)))
        return f"{letter}={text}" if letter and self.p(0.05) else letter + text

    def step(self, a, far=25):
        if self.absolute:
            return super().step(a, far)
        return self.n(*((2, far) if self.p(0.5) else (-far, -2)), a)

    def places(self, axes, low=30, high=80):
        if not self.absolute:
            return " ".join(self.step(a, 6) for a in axes)
        return " ".join(self.step(a, 6) if self.p(0.002) else
                        (self.n(low, high, "X") if a == "X" else self.n(-60, 5, "Z")) for a in axes)

    def some(self):
        return self.rng.choice(("X", "Z", "XZ"))

    def arcs(self):
        r = self.rng
        d, e = round(r.uniform(2, 8), 1), round(r.uniform(2, 8), 1)
        if self.how == "DIAMON":
            x = 2 * d
        else:
            x = d
        inc, was = lambda a, v: f"{a}{v:g}", self.absolute
        if was:
            self.say("G91")
        code = r.choice(("G2", "G3"))
        pick = r.random()
        if pick < 0.5:
            radius = (d * d + e * e) ** 0.5 * r.uniform(0.6, 2) * r.choice((1, 1, 1, -1))
            self.say(f"{code} {inc('X', x)} {inc('Z', -e)} CR={radius:.3f} {self.feed()}")
        elif pick < 0.8:
            self.say(f"{code} {inc('X', x)} {inc('Z', -d)} I{d:g} K0 {self.feed()}")
        else:
            self.say(f"{code} {inc('Z', -2 * d)} K{-d:g} {self.feed()}")
        if was:
            self.say("G90")

    def diameter(self):
        if self.depth:
            return
        self.how = self.rng.choice(("DIAMON", "DIAMOF", "DIAM90"))
        self.say(self.how)
        if self.p(0.6):
            self.here()
        elif self.p(0.5):
            self.say(f"G1 {self.places('Z')}")

    def offsets(self):
        self.say(self.rng.choice(("G54", "G55", "G56")))
        self.here()

    def tool(self):
        self.say(f"T{self.rng.choice((1, 2, 3))} D1")
        self.here()

    def misc(self):
        self.say(self.rng.choice(("G4 F0.5", "M8", "M9", "STOPRE", "S1500", "M1")))

    def variables(self):
        r = self.rng
        self.variable += 1
        name, a, b = f"R{self.variable}", r.randint(10, 40), r.randint(2, 9)
        self.say(f"{name}={a}+{b}/4")
        how = r.choice((f"X={name}+{b}", f"X={name} Z=-{name}*0.5", f"Z=-({b}+ABS({name}))",
                        f"X=30+{name}*COS(30) Z=-{name}*SIN(30)", f"X=40+SQRT({b})"))
        self.abs()
        self.say(f"{r.choice(('G0', 'G1'))} {how}")

    def body(self):
        return self.body_of("moves", "arcs", "variables")

    def jump(self):
        r = self.rng
        self.variable += 1
        name = f"R{self.variable}"
        self.say(f"{name}={r.randint(1, 3)}")
        self.say(f"IF {name}{r.choice(('==', '>', '<='))}2")
        self.lines += self.body()
        self.lines.append("ELSE")
        self.lines += self.body()
        self.lines.append("ENDIF")
