"""Random jobs of a shop, by seed and number: machine, zeros as they were found, program, and how all that is said."""

import random

from common.words import number

import machine as machines
import touch

DIALECTS = ("linuxcnc", "fanuc", "haas", "linuxcnc", "fanuc")


def words(**places):
    return " ".join(k.upper() + number(v) for k, v in places.items())


class Case:
    """`only`: "before" asks nothing that a command without zeros of two kinds lacks, and takes every zero as true."""

    def __init__(self, seed, n, only=None):
        rng = random.Random("shop %d %d" % (seed, n))
        self.number, self.dialect = n, rng.choice(DIALECTS)
        self.rotary, self.play = n % 3 == 2, n % 6 == 1
        self.spec = machines.random_machine(rng, self.rotary, self.play)
        self.machine = machines.Machine(self.spec)
        self.ideal = machines.Machine(self.spec, perfect=True)
        self.tip_control = self.rotary and self.dialect == "fanuc" and rng.random() < 0.4
        self.flags, self.offsets, self.ini, self.lines = [], {}, None, []
        self.zero = None if only else rng.choice((None, "touched", "true"))
        self.datums = {}
        for name in ("G54", "G55", "G56")[: rng.randint(1, 3)]:
            self.found(rng, name, only)
        self.zero_by_flag = self.zero is not None and rng.random() < 0.5
        self.flags += ["--zero", self.zero] if self.zero_by_flag else []
        plain = [d for d in self.datums.values() if d.plain == "profile"]
        if self.dialect == "linuxcnc" and len(plain) == len(self.datums) and not only and rng.random() < 0.5:
            self.ini, self.offsets = {d.name: d.at for d in plain}, {}
        self.start = {k: round(rng.uniform(-0.5, 0.5) * v * 1e-3, 5) for k, v in self.spec["play"].items()}
        self.write(rng)
        self.text = "%%\n%s%s\n%%\n" % ("" if self.dialect == "linuxcnc" else "O0042\n", "\n".join(self.lines))

    def found(self, rng, name, only):
        kind = rng.choice(touch.KINDS)
        if only:
            kind = "true"
        angles = {}
        if kind in ("faces", "one-place", "bore") and self.machine.table and not self.tip_control and rng.random() < 0.5:
            angles = {
                k: float(rng.choice((0, 90, 180, 270)) if k == "C" else rng.choice((0, 0, -20, 30)))
                for k in self.machine.table + self.machine.head
            }
            angles.update({k: 0.0 for k in self.machine.head})
        wide = 60 if self.rotary else 140
        place = [round(rng.uniform(-wide, wide), 3) for _ in range(3)]
        datum = touch.offset(rng, self.machine, name, kind, place, angles)
        may_be_plain = only or (kind == "corner" and self.zero != "true") or (kind == "true" and self.zero == "true")
        datum.plain = rng.choice(("profile", "profile", "flag", "program")) if may_be_plain else None
        if datum.plain == "flag":
            self.flags += ["--work-offset", "%s=%s" % (name, ",".join(map(repr, datum.at)))]
        elif datum.plain != "program":
            self.offsets[name] = datum.said(plain=bool(datum.plain))
        self.datums[name] = datum

    # -- the program

    def write(self, rng):
        say = self.lines.append
        say("G21 G17 G90 G94 G40 G49 G80")
        for k, datum in enumerate(self.datums.values()):
            if datum.plain == "program":
                say("G10 L2 P%d %s" % (int(datum.name[1:]) - 53, words(**dict(zip("xyz", datum.at)))))
        tool = 0
        for name in [*self.datums, *([rng.choice(list(self.datums))] if rng.random() < 0.4 else [])]:
            if tool == 0 or rng.random() < 0.4:
                tool = 3 - tool if tool else rng.choice((1, 2))
                self.lines += ["T%d M6" % tool, "S4000 M3"]
                fresh = True
            say(name)
            for _ in range(rng.randint(1, 3) if self.rotary else 1):
                if self.rotary:
                    self.lines += [] if fresh else ["G0 Z80."]
                    say("G0 " + self.turn(rng))
                say("G0 " + words(x=rng.uniform(-40, 40), y=rng.uniform(-40, 40)))
                say(("G43 H%d " % tool if fresh else "G0 ") + "Z60.")
                fresh = False
                for _ in range(rng.randint(1, 3)):
                    rng.choice((self.outline, self.outline, self.holes, self.circle, self.steps))(rng)
                if self.tip_control:
                    self.tip_path(rng, tool)
                    fresh = True
        self.lines += ["G49", "M30"] if self.dialect != "linuxcnc" else ["M2"]

    def turn(self, rng):
        return words(
            **{
                k.lower(): float(rng.choice((0, 0, 45, 90, 180, -120)) if k == "C" else rng.choice((0, 0, -30, 25)))
                for k in self.machine.table + self.machine.head
            }
        )

    def to(self, rng, x, y):
        self.lines += ["G0 " + words(x=x, y=y), "G0 Z2.", "G1 Z%s F%d" % (number(-rng.choice((0.5, 3.0, 8.0))), rng.choice((100, 250)))]

    def outline(self, rng):
        """A rectangle, its corners rounded."""
        x, y, w, h = rng.uniform(-60, 0), rng.uniform(-60, 0), round(rng.uniform(15, 60), 2), round(rng.uniform(15, 60), 2)
        x, y, r = round(x, 2), round(y, 2), round(rng.uniform(2, 6), 2)
        self.to(rng, x + r, y)
        corners = (
            ((x + w - r, y), (x + w, y + r), (0, r)),
            ((x + w, y + h - r), (x + w - r, y + h), (-r, 0)),
            ((x + r, y + h), (x, y + h - r), (0, -r)),
            ((x, y + r), (x + r, y), (r, 0)),
        )
        for k, (end, behind, centre) in enumerate(corners):
            word = ("x", "y")[k % 2]
            self.lines.append("%s%s%s" % ("G1 " if k or rng.random() < 0.8 else "", words(**{word: end[k % 2]}), " F600" if k == 0 else ""))
            radius = words(r=r) if rng.random() < 0.4 else words(i=centre[0], j=centre[1])
            self.lines.append("G3 %s %s" % (words(x=behind[0], y=behind[1]), radius))
        self.lines.append("G0 Z30.")

    def circle(self, rng):
        """A helix down and a full turn at its foot."""
        x, y, r = round(rng.uniform(-30, 30), 3), round(rng.uniform(-30, 30), 3), round(rng.uniform(4, 25), 2)
        code = rng.choice(("G2", "G3"))
        self.lines += ["G0 " + words(x=x + r, y=y), "G0 Z2.", "G1 Z0.5 F200"]
        self.lines += [
            "%s %s I%s J0. F400" % (code, words(x=x + r, y=y, z=-rng.choice((1.0, 2.5))), number(-r)),
            "%s I%s J0." % (code, number(-r)),
        ]
        self.lines += ["G1 " + words(x=x), "G0 Z30."]

    def holes(self, rng):
        depth = -rng.choice((2.0, 6.0, 12.5))
        code = rng.choice(("G81", "G82"))
        self.lines.append(
            "%s %s Z%s R2.%s F120"
            % (
                rng.choice(("G98", "G99")) + " " + code,
                words(x=rng.uniform(-50, 50), y=rng.uniform(-50, 50)),
                number(depth),
                " P0.2" if code == "G82" and self.dialect == "linuxcnc" else " P200" if code == "G82" else "",
            )
        )
        for _ in range(rng.randint(1, 5)):
            self.lines.append(
                words(x=rng.uniform(-50, 50), y=rng.uniform(-50, 50)) if rng.random() < 0.7 else words(x=rng.uniform(-50, 50))
            )
        self.lines += ["G80", "G0 Z30."]

    def steps(self, rng):
        """Lines by increments, in space."""
        self.to(rng, rng.uniform(-40, 40), rng.uniform(-40, 40))
        self.lines += ["G91", "G1 %s F500" % words(x=rng.uniform(5, 30))]
        for _ in range(rng.randint(1, 4)):
            self.lines.append(
                words(**{k: rng.uniform(-25, 25) if k != "z" else rng.uniform(-2, 0) for k in rng.sample("xyz", rng.randint(1, 3))})
            )
        self.lines += ["G90", "G0 Z30."]

    def tip_path(self, rng, tool):
        """The tip led by the control while the table or the head turns."""
        axes = self.machine.table + self.machine.head
        turn = lambda: {k.lower(): rng.uniform(-40, 40) if k == "C" else rng.uniform(-25, 25) for k in axes}
        self.lines += ["G0 Z80.", "G0 " + words(**{k.lower(): 0.0 for k in axes}), "G49", "G43.4 H%d" % tool]
        self.lines += ["G0 " + words(x=rng.uniform(-30, 30), y=rng.uniform(-30, 30)), "G0 Z30.", "G1 Z2. F300"]
        for _ in range(rng.randint(2, 4)):
            self.lines.append(
                "G1 "
                + words(x=rng.uniform(-30, 30), y=rng.uniform(-30, 30), z=rng.uniform(-5, 2), **turn())
                + " F%d" % rng.choice((300, 800))
            )
        self.lines += ["G0 Z60.", "G49", "G0 " + words(**{k.lower(): 0.0 for k in axes})]


EMPTY_INI = "[EMC]\nMACHINE = shop\n[TRAJ]\nLINEAR_UNITS = mm\nCOORDINATES = X Y Z\n[RS274NGC]\nPARAMETER_FILE = shop.var\n[EMCIO]\nTOOL_TABLE = shop.tbl\n"


def control_files(folder, case):
    """What LinuxCNC keeps of its zeros and lengths."""
    values = dict.fromkeys([*range(5161, 5170), *range(5181, 5190), *range(5210, 5390)], 0.0)
    values[5220] = 1
    for name, at in case.ini.items():
        for k, v in enumerate(at):
            values[5221 + 20 * (int(name[1:]) - 54) + k] = v
    (folder / "shop.var").write_text("".join("%d\t%.6f\n" % x for x in sorted(values.items())))
    (folder / "shop.tbl").write_text("".join("T%s P%s Z+%.3f D6 ;\n" % (h[1:], h[1:], v) for h, v in case.spec["lengths"].items()))
    (folder / "shop.ini").write_text(EMPTY_INI)
    return ["--linuxcnc-ini", folder / "shop.ini"]


def write(case, folder):
    """Profile, program and the command's words."""
    zero = None if case.zero_by_flag else case.zero
    where = machines.profile(case.spec, case.dialect, folder, case.offsets, zero)
    (folder / "in.nc").write_text(case.text)
    return ["-m", where, *case.flags, *(control_files(folder, case) if case.ini else [])]
