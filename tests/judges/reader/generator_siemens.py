"""Random programs of Sinumerik mills."""

from common import folders

from writing import Writing


class SiemensMill(Writing):
    KINDS = dict(moves=5, arcs=4, holes=6, modal=7, corners=4, stairs=2, frame=5, offsets=2, loop=3, jump=1, sub=3, machine=1,
                 units=1, misc=1, tool=1, variables=2, refused=0.15)

    def __init__(self, rng, folder):
        self.rng, self.folder, self.lines = rng, folder, []
        self.absolute, self.plane, self.inch = True, 17, False
        self.depth, self.number, self.variable, self.inside, self.tooled = 0, 0, 10, False, False
        self.files, self.rapid = {}, True

    def n(self, low, high, letter="", digits=None):
        value = self.rng.uniform(low, high)
        digits = self.rng.choice((0, 0, 1, 2, 3)) if digits is None else digits
        if self.inch:
            value, digits = value / 25.4, digits + 1
        text = f"{round(value, digits):g}" if digits else str(int(round(value)))
        if letter and len(letter) == 1 and self.p(0.08):
            return f"{letter}={text}"
        if letter and len(letter) == 1 and not self.absolute and self.p(0.05):
            return f"{letter}=AC({text})"
        return letter + text

    def step(self, a, far=25):
        low, high = (2, far) if self.p(0.5) else (-far, -2)
        value = self.n(low, high)
        if self.absolute:
            return f"{a}=IC({value})"
        return f"{a}{value}"

    def places(self, axes, low=-60, high=60):
        if not self.absolute:
            return " ".join(self.step(a) for a in axes)
        return " ".join(self.step(a) if self.p(0.07) else self.n(low, high, a) for a in axes)

    def some(self, axes="XYZ"):
        return "".join(a for a in axes if self.p(0.6)) or self.rng.choice(axes)

    def feed(self):
        return f"F{self.rng.choice((80, 100, 150, 200, 300, 450))}"

    def say(self, text):
        if self.p(0.05):
            text += " ; note"
        if self.p(0.05) and text[:1] in "GXYZ":
            self.number += 10
            text = f"N{self.number} {text}"
        self.lines.append(text)

    def program(self):
        r = self.rng
        self.lines = ["%_N_PART_MPF"] if self.p(0.5) else []
        self.say("G17 G40 G71 G90 G94 G54")
        self.say("M3 S1000")
        self.say(f"G0 X10 Y10 {self.n(50, 80, 'Z')}")
        self.say(f"G1 {self.n(41, 49, 'Z')} {self.feed()}")
        for _ in range(r.randint(3, 8)):
            self.snippet(self.KINDS)
            if self.p(0.25):
                self.here()
        self.say("M5")
        self.lines.append("M30")
        return "\n".join(self.lines) + "\n"

    def snippet(self, kinds):
        names = [k for k in kinds if not (self.depth and k in ("sub", "machine", "tool", "units", "offsets", "jump"))
                 and not (self.inside and k in ("frame", "offsets", "machine", "units", "tool"))]
        name = self.rng.choices(names, [self.KINDS[k] for k in names])[0]
        getattr(self, name)()

    def here(self):
        self.absolute or self.say("G90")
        self.absolute = True
        self.say(f"G0 X{self.rng.randint(-60, 60)} Y{self.rng.randint(-60, 60)} {self.n(45, 80, 'Z')}" if not self.inch
                 else f"G0 {self.n(-60, 60, 'X')} {self.n(-60, 60, 'Y')} {self.n(45, 80, 'Z')}")

    def moves(self):
        r = self.rng
        for _ in range(r.randint(1, 4)):
            code = r.choice(("G0", "G1", "G1", ""))
            if self.p(0.25):
                self.absolute = not self.absolute
                code = f"{'G90' if self.absolute else 'G91'} {code or 'G1'}"
            self.say(f"{code} {self.places(self.some())} {self.feed() if self.p(0.3) else ''}".strip())

    def arcs(self):
        r = self.rng
        if self.p(0.25) and not self.inside:
            self.plane = r.choice((17, 18, 19))
            self.say(f"G{self.plane}")
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        i, j = {17: "IJ", 18: "KI", 19: "JK"}[self.plane]
        n = ({"X", "Y", "Z"} - {p, q}).pop()
        code, how = r.choice(("G2", "G3")), r.random()
        d, e = round(r.uniform(3, 20), 1), round(r.uniform(3, 20), 1)
        if self.inch:
            d, e = d / 20, e / 20
        inc = (lambda a, v: f"{a}=IC({v:g})") if self.absolute else (lambda a, v: f"{a}{v:g}")
        helix = f" {self.step(n, 5)}" if self.p(0.3) else ""
        if how < 0.25:
            self.say(f"{code} {i}{d:g} {j}{e:g} {self.feed()}")
        elif how < 0.5:
            radius = (d * d + e * e) ** 0.5 * r.uniform(0.55, 2) * r.choice((1, 1, -1))
            self.say(f"{code} {inc(p, d)} {inc(q, -e)}{helix} CR={radius:.3f} {self.feed()}")
        elif how < 0.65:
            self.say(f"{code} {inc(p, -d)} {inc(q, e)}{helix} AR={r.choice((30, 60, 90, 145, 200, 300))} {self.feed()}")
        elif how < 0.8:
            self.say(f"{code} {i}{d:g} {j}{-e:g}{helix} AR={r.choice((30, 60, 90, 145, 200, 300))} {self.feed()}")
        elif how < 0.9:
            self.say(f"{code} {inc(p, d)} {inc(q, d)} {i}{d:g} {j}0{helix} TURN={r.randint(1, 3)} {self.feed()}")
        else:
            x, y = r.randint(-40, 40), r.randint(-40, 40)
            was = self.absolute
            self.abs()
            if self.inch:
                x, y = x / 10, y / 10
            self.say(f"G1 {p}{x:g} {q}{y:g} {self.feed()}")
            self.say(f"{code} {p}{x + d:g} {q}{y + d:g} {i}=AC({x + d:g}) {j}=AC({y:g})")

    def cycle(self):
        r = self.rng
        top = r.randint(30, 40)
        deep, gap, rtp = r.randint(5, 40), r.randint(1, 4), top + r.randint(5, 20)
        k = 20 if self.inch else 1
        v = lambda x: f"{x / k:g}"
        depth = f"{v(top - deep)}" if self.p(0.6) else f",{v(deep)}"
        head = f"{v(rtp)},{v(top)},{v(gap)},{depth}"
        if depth[0] != ",":
            tail = ","
        else:
            tail = ""
        kind = r.choice(("81", "81", "82", "83", "85", "86"))
        if kind == "81":
            return f"CYCLE81({head})", kind
        if kind == "82":
            return f"CYCLE82({head}{tail},0.5)", kind
        if kind == "83":
            fd = round(r.uniform(2, 9), 1)
            first = f"{v(top - fd)}," if self.p(0.5) else f",{v(fd)}"
            return (f"CYCLE83({head}{tail},{first},0,{r.choice(('0', '0.2'))},{r.choice(('', '0.3'))},"
                    f"{'0.5' if self.p(0.01) else '1'},{r.choice((0, 1))})"), kind
        if kind == "85":
            return f"CYCLE85({head}{tail},{r.choice(('', '0.4'))},60,250)", kind
        return f"CYCLE86({head}{tail},0.5,3,{v(-0.3)},0,{v(0.2)},45)", kind

    def behind(self, kind):
        if kind == "85":
            self.say(f"G1 {self.places('X')} F150")
        if kind == "86":
            self.say("M3")

    def holes(self):
        self.abs()
        if self.p(0.6):
            self.say(f"{self.rng.choice(('G0', 'G1'))} {self.places('XY')}")
        text, kind = self.cycle()
        if self.p(0.2):
            self.say(self.feed())
        self.say(text)
        self.behind(kind)
        if self.p(0.4):
            self.say(self.places(self.some("XY")))

    def modal(self):
        r = self.rng
        self.abs()
        text, kind = self.cycle()
        if kind == "85":
            text, kind = text.replace("CYCLE85", "CYCLE81").split(",0.4")[0].split(",,60")[0].split(",60")[0], "81"
            text = text.rstrip(",)") + ")"
        if self.p(0.3):
            self.say("G0")
        self.say(f"MCALL {text}")
        self.inside = True
        for _ in range(r.randint(1, 4)):
            pick = r.random()
            p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
            if pick < 0.55:
                self.say(f"{r.choice(('', '', 'G0 ', 'G1 '))}{self.places(self.some(p + q))}")
            elif pick < 0.7:
                k = 20 if self.inch else 1
                self.say(f"HOLES1({r.randint(-40, 40) / k:g},{r.randint(-40, 40) / k:g},{r.randint(-90, 90)},"
                         f"{r.randint(0, 20) / k:g},{r.randint(4, 20) / k:g},{r.randint(2, 5)})")
            elif pick < 0.85:
                k = 20 if self.inch else 1
                self.say(f"HOLES2({r.randint(-40, 40) / k:g},{r.randint(-40, 40) / k:g},{r.randint(10, 40) / k:g},"
                         f"{r.randint(-90, 90)},{r.choice((0, 30, 45, -20))},{r.randint(2, 6)})")
            elif pick < 0.9:
                self.say(r.choice(("M8", "S1200", "G54", "M9")))
            elif pick < 0.95 and not self.depth:
                self.positions(p, q)
            else:
                name = self.variable = self.variable + 1
                self.say(f"FOR R{name}=1 TO {r.randint(1, 3)}")
                self.lines.append(f"{p}=R{name}*7+{r.randint(1, 5)} {q}={r.randint(-30, 30)}")
                self.lines.append("ENDFOR")
        self.inside = False
        self.say("MCALL")
        self.behind(kind)

    def positions(self, p, q):
        """A called file that names places alone, drilled because MCALL holds in it."""
        name = f"L{100 + len(self.files)}"
        self.files[name] = None
        body = [self.places(self.some(p + q)) for _ in range(self.rng.randint(1, 3))]
        folders.put(self.folder, f"{name}.SPF", "\n".join(body + ["M17"]) + "\n")
        self.say(name + self.rng.choice(("", "", " P2")))

    def stairs(self):
        """Corners whose second line comes from the next turn of a loop, or from behind it."""
        r = self.rng
        if self.inch:
            return
        self.abs()
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        x, y, d = r.randint(-50, 20), r.randint(-50, 20), r.randint(15, 30)
        self.say(f"G1 {p}{x} {q}{y} {self.feed()}")
        self.variable += 1
        name, kind = f"R{self.variable}", r.choice(("RND", "CHR", "CHF"))
        self.say(f"FOR {name}=0 TO {r.randint(0, 3)}")
        self.lines += [f"{p}={name}*{d}+{x + d} {kind}={r.randint(1, 4)}", f"{q}={name}*{d}+{y + d} RND={r.randint(1, 4)}",
                       "ENDFOR"]
        self.say(f"{p}{x + 250}")

    def corners(self):
        r = self.rng
        p, q = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        was = self.absolute
        self.abs()
        k, far, first = (20, 1, True) if self.inch else (1, 1, True)
        for c in range(r.randint(2, 4)):
            axis = (p, q)[c % 2] if self.p(0.8) else (q, p)[c % 2]
            words = f"{axis}{far * r.randint(70, 140) / k:g}"
            if self.p(0.3):
                words = f"{p}{far * r.randint(70, 140) / k:g} {q}{r.randint(-140, 140) / k:g}"
            far = far if c % 2 == 0 else -far
            self.say(f"{'G1 ' if first or self.p(0.2) else ''}{words} {r.choice(('RND', 'CHR', 'CHF'))}="
                     f"{r.uniform(1, 9) / k:.2f} {self.feed() if first else ''}".strip())
            first = False
        self.say(f"{p}{far * r.randint(70, 140) / k:g} {q}{r.randint(-140, 140) / k:g}")

    def frame(self):
        r = self.rng
        turn = r.choice(("ROT", "ROT", "MIRROR"))
        for _ in range(r.randint(1, 3)):
            a = r.choice(("", "A"))
            kind = r.choice(("TRANS", "TRANS", turn))
            if kind == "TRANS":
                self.say(f"{a}TRANS {' '.join(f'{x}{r.randint(-30, 30)}' for x in self.some())}")
            elif kind == "ROT":
                axis = {17: "Z", 18: "Y", 19: "X"}[self.plane]
                self.say(f"{a}ROT " + (f"RPL={r.randint(-170, 170)}" if self.p(0.6) else f"{axis}{r.randint(-170, 170)}"))
            else:
                self.say(f"{a}MIRROR {r.choice('XY')}0")
        self.abs()
        if self.p(0.9):
            self.here()
        for _ in range(r.randint(1, 3)):
            self.snippet({k: 1 for k in ("moves", "arcs", "holes", "modal", "corners", "loop", "sub")})
        if self.p(0.8):
            self.say(r.choice(("TRANS", "ROT", "MIRROR")))
            if self.p(0.8):
                self.here()

    def offsets(self):
        code = self.rng.choice((54, 55, 56, 57, 505, 599))
        if self.p(0.5):
            self.say(f"G{code}")
            self.p(0.6) and self.here()
        else:
            self.abs()
            self.say(f"G{code} G0 {self.places('XY' if self.p(0.5) else self.some())}")

    def machine(self):
        if self.tooled:
            return
        self.abs()
        self.say(f"{self.rng.choice(('G53', 'SUPA', 'G153'))} G0 {self.n(100, 300, 'Z')}")
        self.here()

    def units(self):
        self.inch = not self.inch
        self.say("G70" if self.inch else "G71")
        self.here()
        self.say(f"G1 {self.n(41, 49, 'Z')} {self.feed()}")

    def misc(self):
        self.say(self.rng.choice(("G4 F0.5", "M8", "M9", "MSG(\"PART\")", "STOPRE", "S1500 M3", "G64", "M1")))

    def tool(self):
        t = self.rng.choice((1, 2, 7))
        self.tooled = True
        self.say(f"T{t}")
        self.say("M6")
        self.absolute = True
        self.say(f"G90 G0 X{self.rng.randint(-40, 40)} Y10 Z70 D1")
        self.say("M3")
        if self.plane != 17:
            self.plane = 17
            self.say("G17")
        if self.inch:
            self.lines[-3 - (self.lines[-1] == "G17"):] = self.lines[-3:]

    def refused(self):
        self.say(self.rng.choice(("G111 X10 Y10", "G110 X0 Y0", "POCKET1(5,0,2,-10,,40,20,5,30,30,0,100,200,2,2,0,3,1)")))

    def variables(self):
        r = self.rng
        self.variable += 1
        a, b = r.randint(-30, 30), r.randint(2, 9)
        if self.p(0.5):
            self.say(f"R{self.variable}={a} R{self.variable + 1}=R{self.variable}*2" if self.p(0)
                     else f"R{self.variable}={a}+{b}/4")
            name = f"R{self.variable}"
        else:
            name = f"VAR_{self.variable}{'_' if self.depth else ''}"
            self.say(f"{name[:0]}R{self.variable}={a}")
            name = f"R{self.variable}"
        how = self.rng.choice((f"X={name}+{b}", f"X={name} Y={name}*0.5", f"Y=IC({b}+ABS({name}))",
                               f"X={name}*COS(30) Y={name}*SIN(30)", f"Z=40+SQRT({b})"))
        if self.inch:
            how = f"X={name}/20"
        self.say(f"{r.choice(('G0', 'G1'))} {how}")

    def body(self):
        was, self.lines = self.lines, []
        start = self.absolute, self.plane
        self.depth += 1
        for _ in range(self.rng.randint(1, 2)):
            self.snippet({k: 1 for k in ("moves", "arcs", "holes", "modal", "corners", "variables")})
        self.depth -= 1
        if (self.absolute, self.plane) != start:
            self.absolute, self.plane = start
            self.lines.append(f"{'G90' if self.absolute else 'G91'} G{self.plane}")
        body, self.lines = self.lines, was
        return body

    def loop(self):
        r = self.rng
        self.variable += 1
        name, count = f"R{self.variable}", r.randint(1, 3)
        kind = r.choice(("FOR", "WHILE", "REPEAT"))
        if kind == "FOR":
            self.say(f"FOR {name}=1 TO {count}")
        else:
            self.say(f"{name}=1")
            self.lines.append(f"WHILE {name}<={count}" if kind == "WHILE" else "REPEAT")
        self.lines += self.body()
        if self.p(0.5) and not self.inch:
            self.lines.append(f"G1 X={name}*3+{r.randint(1, 9)} {self.feed()}")
        if kind != "FOR":
            self.lines.append(f"{name}={name}+1")
        self.lines.append({"FOR": "ENDFOR", "WHILE": "ENDWHILE", "REPEAT": f"UNTIL {name}>{count}"}[kind])

    def jump(self):
        r = self.rng
        self.variable += 1
        name = f"R{self.variable}"
        self.say(f"{name}={r.randint(1, 3)}")
        if self.p(0.5):
            label = f"MARK{self.variable}"
            self.say(f"IF {name}{r.choice(('==', '>', '<', '<>'))}2 GOTOF {label}")
            self.lines += self.body()
            self.lines.append(f"{label}: G90 G0 X{r.randint(-40, 40)} Y3 Z66" if not self.inch else f"{label}: G90")
            self.absolute = True
        else:
            self.say(f"IF {name}{r.choice(('==', '>', '<='))}2")
            self.lines += self.body()
            self.lines.append("ELSE")
            self.lines += self.body()
            self.lines.append("ENDIF")

    def sub(self):
        name = f"L{100 + len(self.files)}"
        self.files[name] = None
        body = self.body()
        if self.p(0.4) and not self.inch:
            self.variable += 1
            body += [f"FOR R{self.variable}=1 TO {self.rng.randint(1, 3)}", f"G1 X=R{self.variable}*4 F200", "ENDFOR"]
        folders.put(self.folder, f"{name}.SPF", "\n".join(body + [self.rng.choice(("M17", "RET"))]) + "\n")
        count = self.rng.choice((1, 1, 2, 3))
        self.say(name + (f" P{count}" if count > 1 else ""))
        if self.p(0.3):
            self.say(name)
