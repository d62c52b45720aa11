"""Random programs of LinuxCNC lathes; read by rs274 alone."""

from writing import Writing


class NgcLatheProgram(Writing):
    KINDS = dict(moves=4, arcs=3, rough=4, face=2, thread=1, sync=1, loop=2, sub=2, diameter=1, shift=1, misc=1)

    def __init__(self, rng, include=None):
        self.rng, self.lines, self.number, self.depth = rng, [], 100, 0
        self.absolute, self.how, self.variable = True, "G7", 100

    def n(self, low, high, letter="", digits=None):
        value = round(self.rng.uniform(low, high), self.rng.choice((0, 1, 2)) if digits is None else digits)
        return f"{letter}{value:g}"

    def x(self, low, high):
        return self.n(low, high, "X") if self.how == "G7" else self.n(low / 2, high / 2, "X")

    def dx(self, value):
        return f"{value if self.how == 'G8' else 2 * value:g}"

    def say(self, text):
        self.lines.append(text)

    def program(self):
        r = self.rng
        self.how = r.choice(("G7", "G7", "G8"))
        self.say(f"G18 G21 G90 G94 G40 G49 G80 G54 {self.how}")
        self.say("M3 S800")
        self.here()
        self.say(f"G1 {self.n(1, 4, 'Z')} F{r.choice((100, 200))}")
        for _ in range(r.randint(2, 6)):
            self.snippet(self.KINDS)
            if self.p(0.3):
                self.here()
        self.abs()
        self.here()
        self.lines.append("M2")
        return "\n".join(self.lines) + "\n"

    def snippet(self, kinds):
        kinds = [k for k in kinds if not (self.depth and k in ("rough", "face", "sub", "thread", "diameter", "shift"))]
        getattr(self, self.rng.choices(kinds, [self.KINDS[k] for k in kinds])[0])()

    def here(self):
        self.abs()
        self.say(f"G0 {self.x(70, 110)} {self.n(3, 8, 'Z')}")

    def places(self, axes):
        if self.absolute:
            return " ".join(self.x(40, 90) if a == "X" else self.n(-50, 5, "Z") for a in axes)
        return " ".join(f"{a}{self.rng.choice((-1, 1)) * round(self.rng.uniform(1, 6), 1):g}" for a in axes)

    def moves(self):
        r = self.rng
        for _ in range(r.randint(1, 4)):
            code = r.choice(("G0", "G1", "G1", ""))
            if self.p(0.25):
                self.absolute = not self.absolute
                code = f"{'G90' if self.absolute else 'G91'} {code or 'G1'}"
            if not code and not (self.lines or [""])[-1].startswith(("G0", "G1")):
                code = "G1"
            self.say(f"{code} {self.places(r.choice(('X', 'Z', 'XZ')))} F{r.choice((80, 100, 150))}".strip())

    def arcs(self):
        r = self.rng
        d, e = round(r.uniform(2, 8), 1), round(r.uniform(2, 8), 1)
        was = self.absolute
        if was:
            self.say("G91")
        code, pick = r.choice(("G2", "G3")), r.random()
        if pick < 0.5:
            self.say(f"{code} X{self.dx(d)} Z{-e:g} R{(d * d + e * e) ** 0.5 * r.uniform(0.6, 2):.3f} F100")
        elif pick < 0.8:
            self.say(f"{code} X{self.dx(d)} Z{-d:g} I{d:g} K0 F100")
        else:
            self.say(f"{code} Z{-2 * d:g} K{-d:g} F100")
        if was:
            self.say("G90")

    def contour(self, axis, pockets=False):
        r = self.rng
        self.number += 1
        name = self.number
        lines = [f"o{name} sub"]
        k = 1 if self.how == "G7" else 0.5
        if axis == "X":
            x, z = r.randint(8, 20), 0
            lines.append(f"G0 X{x * k:g} Z0")
            for _ in range(r.randint(2, 4)):
                z -= r.randint(5, 12)
                lines.append(f"G1 Z{z}")
                d = r.randint(2, 5)
                if pockets and x > 14 and self.p(0.4):         # a groove: in by a slope, along, and out again
                    deep = r.randint(1, 3)
                    lines.append(f"X{(x - 2 * deep) * k:g} Z{z - deep}")
                    z -= deep + r.randint(2, 6)
                    lines.append(f"Z{z}")
                    x -= 2 * deep
                x += 2 * d
                pick = r.random()
                if pick < 0.4:
                    lines.append(f"X{x * k:g}")
                elif pick < 0.7:
                    z -= d
                    lines.append(f"X{x * k:g} Z{z}")
                else:
                    z -= d
                    lines.append(f"{r.choice(('G2', 'G3'))} X{x * k:g} Z{z} R{d}")
            z -= r.randint(5, 10)
            lines.append(f"G1 Z{z}")
            lines.append(f"o{name} endsub")
            return name, lines, x + r.randint(4, 14), r.randint(1, 3)
        x, z = r.randint(50, 60), -r.randint(20, 30)
        top = x
        lines.append(f"G0 X{x * k:g} Z{z}")
        for _ in range(r.randint(2, 3)):
            x -= 2 * r.randint(3, 6)
            lines.append(f"G1 X{x * k:g}")
            d = r.randint(1, 4)
            z += d
            if self.p(0.5):
                lines.append(f"Z{z}")
            else:
                x -= 2 * d
                lines.append(f"X{x * k:g} Z{z}")
        x -= 2 * r.randint(2, 5)
        lines.append(f"X{x * k:g}")
        lines.append(f"o{name} endsub")
        return name, lines, top + r.randint(2, 8), 2

    def cycle(self, axis, codes):
        r = self.rng
        self.abs()
        name, lines, x, z = self.contour(axis, "G71.2" in codes)
        self.lines += lines
        k = 1 if self.how == "G7" else 0.5
        start = f" X{x * k:g} Z{z}" if self.p(0.6) else ""
        if not start or self.p(0.5):
            self.say(f"G0 X{x * k:g} Z{z}")
        d = f" D{self.n(0.1, 0.6, digits=1)}" if self.p(0.6) else ""
        self.say(f"{r.choice(codes)} Q{name}{start}{d} I{self.n(0.7, 2.3, digits=2)} R{self.n(0.3, 0.8, digits=1)} F{r.choice((100, 150))}")
        if self.p(0.6) and (start and axis == "X" or self.p(0.02)):
            passes = f" D{self.n(0.2, 0.5, digits=1)} E0 P{r.randint(1, 3)}" if self.p(0.4) and axis == "X" else ""
            self.say(f"G70 Q{name}{start}{passes}")
        if self.p(0.6):
            self.say(f"{r.choice(('G0', 'G1'))} {self.places(r.choice(('X', 'Z', 'XZ')))}")
        else:
            self.here()

    def rough(self):
        self.cycle("X", self.rng.choice((("G71", "G71.1", "G71"), ("G71", "G71.2"))))

    def face(self):
        self.cycle("Z", ("G72", "G72.1"))

    def thread(self):
        r = self.rng
        self.abs()
        self.say(f"G0 {self.x(40, 60)} {self.n(2, 5, 'Z')}")
        self.say(f"G76 P1.5 Z-{r.randint(10, 30)} I-{self.n(1, 3, digits=1)} J{self.n(0.2, 0.5, digits=1)} "
                 f"R{r.choice((1, 1.5, 2))} K{self.n(1, 1.6, digits=1)} Q29.5 H{r.randint(0, 2)}")
        self.say(f"G0 {self.places('X')}")

    def sync(self):
        self.abs()
        self.say(f"G0 {self.x(40, 60)} {self.n(2, 5, 'Z')}")
        self.say(f"G33 Z-{self.rng.randint(10, 30)} K1.5")
        self.say(f"G0 {self.x(70, 80)}")

    def diameter(self):
        self.how = self.rng.choice(("G7", "G8"))
        self.say(self.how)
        if self.p(0.5):
            self.here()

    def shift(self):
        self.abs()
        self.say(self.rng.choice((f"G92 Z{self.rng.randint(-5, 5)}", "G55", "G54", f"G52 Z{self.rng.randint(-5, 5)}",
                                  "G92.1")))
        self.here()

    def misc(self):
        self.say(self.rng.choice(("G4 P0.5", "M8", "M9", "S900")))

    def body(self):
        was, self.lines = self.lines, []
        start = self.absolute
        self.depth += 1
        for _ in range(self.rng.randint(1, 2)):
            self.snippet({"moves": 1, "arcs": 1})
        self.depth -= 1
        self.absolute = start
        self.lines.append("G90" if start else "G91")
        body, self.lines = self.lines, was
        return body

    def loop(self):
        self.number += 1
        self.lines += [f"o{self.number} repeat [{self.rng.randint(1, 3)}]"]
        number = self.number
        self.lines += self.body() + [f"o{number} endrepeat"]

    def sub(self):
        self.number += 1
        number = self.number
        self.lines += [f"o{number} sub"] + self.body() + [f"G1 X[#1*2+40]" if self.absolute else "G1 X[#1/4]", f"o{number} endsub"]
        self.say(f"o{number} call [{self.rng.randint(1, 9)}]")
