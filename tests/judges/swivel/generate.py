"""Random five-axis machines as profiles, and random programs with swivelled planes, by seed and number."""

import math
import random

import numpy as np

from common.profile import Profile, column

import cycle
from machine import Machine

CHAINS = {
    "tt": ("[w C A Y b X Z t]", "[w C B X b Y Z t]", "[w C A X Y b Z t]"),
    "ht": ("[w C X b Y Z B t]", "[w C Y b X Z A t]"),
    "hh": ("[w X b Y Z C A t]", "[w Y b X Z C B t]"),
}
LOCATIONS = {
    "A": ("EY0A", "EZ0A", "EB0A", "EC0A"),
    "B": ("EX0B", "EZ0B", "EA0B", "EC0B"),
    "C": ("EX0C", "EY0C", "EA0C", "EB0C"),
}
# Each kind is weighed by how sure its meaning is: the last ones are told apart in the figures.
MODES = (57, 57, 57, 27, 27, 39, 39, 45, 30, 54, 64, 64, 185)
# Three programs of four hold only what docs/reference.md says is followed: one word that is refused hides all the rest.
FOLLOWED = (57, 57, 57, 27, 27, 39, 39, 45, 30, 54)


def number(v, digits=3):
    text = ("%.*f" % (digits, v)).rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def table(rng, axis, at, size):
    """Smooth functions: a few waves each."""
    rows = np.zeros((len(at), 6))
    for k in range(6):
        for wave in (1, 2, 3):
            rows[:, k] += rng.gauss(0, size) / wave * np.sin(wave * math.pi * np.array(at) / at[-1] + rng.uniform(0, 6))
    return {"at": list(map(float, at)), "rows": np.round(rows, 2).tolist()}


def machine(rng, kind, state):
    spec = {"kind": kind, "state": state, "chain": rng.choice(CHAINS[kind]), "linear": {}, "rotary": {}, "control": {}}
    m_names = [k for k in spec["chain"].strip("[]").split() if k in "ABC" and len(k) == 1]
    crooked = state == "crooked"
    for k in "XYZ":
        one = {"resolution": rng.choice((0.001, 0.001, 0.0001))}
        if crooked and rng.random() < 0.8:
            one["table"] = table(rng, k, np.linspace(-700, 700, rng.choice((15, 29, 57))), rng.choice((3, 8, 15)))
        spec["linear"][k] = one
    spec["squareness"] = {k: round(rng.gauss(0, 40), 1) if crooked else 0.0 for k in ("EC0Y", "EB0Z", "EA0Z")}
    middle = np.array([rng.uniform(-60, 60) for _ in range(3)])
    table_axes = spec["chain"].index("X") > 0 and Machine({**spec, "rotary": {k: {} for k in m_names}}).table
    for k in m_names:
        near = middle + [rng.uniform(-30, 30) for _ in range(3)] if k in table_axes else np.array([rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(120, 250)])
        one = {"centre": [round(float(x), 3) for x in near], "travel": [-400, 400] if k == "C" else [-125, 125]}
        if rng.random() < 0.3:
            one["tilt"] = rng.choice(("axis", "body"))
        if crooked:
            one["location"] = {e: round(rng.gauss(0, 20 if e[1] in "XYZ" else 60), 1) for e in LOCATIONS[k]}
            if rng.random() < 0.3:
                one["table"] = table(rng, k, np.linspace(-400, 400, 41), 4)
        spec["rotary"][k] = one
        off = 0.0 if state == "perfect" or rng.random() < 0.6 else 0.05
        spec["control"][k] = [round(x + rng.uniform(-off, off), 3) for x in one["centre"]]
    tilting = [k for k in m_names if k != "C"]
    spec["reference"] = tilting[0]
    spec["turn"] = rng.choice(("shortest", "principal"))
    spec["tolerance"] = rng.choice((1.0, 1.0, 2.0, 5.0))
    spec["lengths"] = {"H%d" % n: round(rng.uniform(60, 180), 3) for n in (1, 2)}
    spec["offsets"] = {k: [round(float(c) + rng.uniform(-40, 40), 3) for c in middle] for k in ("G54", "G55")}
    return spec


def profile(spec, folder, known=None, sign="+"):
    """Writes the profile with its tables. `known`: keys of [kinematics] that the command's schema has."""
    p = Profile("Swivel (invented)", "sinumerik", spec["chain"])
    for k, one in spec["linear"].items():
        p.axis(k).update(travel_mm=[-700, 700], resolution_mm=one["resolution"])
    p["squareness"].update({column(k): v for k, v in spec["squareness"].items()})
    for k, one in spec["rotary"].items():
        # A tilt is not told without what leans by it (VP0314); where nothing is chosen the machine is one of `body`.
        p.axis(k).update(centre_mm=one["centre"], travel_deg=one["travel"], tilt=one.get("tilt", "body"))
        p.located(k, one.get("location", {}))
    for k, one in {**spec["linear"], **spec["rotary"]}.items():
        if "table" in one:
            p.errors(k, one["table"]["at"], one["table"]["rows"])
    p["tool"]["lengths_mm"] = spec["lengths"]
    p["work_offsets_mm"].update(spec["offsets"])
    p["correction"]["tolerance_um"] = spec["tolerance"]
    p["kinematics"].update(straight="tip", centres_mm=spec["control"], direction_reference=spec["reference"], branch=spec["reference"] + sign, turn=spec["turn"])
    p["kinematics"].update({k: v for k, v in spec.get("extra_kinematics", {}).items() if known is None or k in known})
    return p.write(folder)


class Writer:
    def __init__(self, rng):
        self.rng, self.lines, self.n = rng, ["%_N_SWIVEL_MPF"], 0

    def __call__(self, text):
        self.n += 10
        self.lines.append("N%d %s" % (self.n, text))

    def point(self, axes, values):
        return " ".join(k + number(v) for k, v in zip(axes, values))


def lines(w, rng):
    w("G0 " + w.point("XYZ", [rng.uniform(-50, 50), rng.uniform(-50, 50), 5]))
    w("G1 Z%s F%d" % (number(-rng.uniform(1, 10)), rng.randint(80, 400)))
    if rng.random() < 0.3:
        w("G91")
        for _ in range(rng.randint(1, 3)):
            w("G1 " + w.point("XYZ", [rng.uniform(-30, 30) for _ in range(3)]))
        w("G90")
    for _ in range(rng.randint(1, 4)):
        axes = rng.choice(("XY", "X", "Y", "XYZ"))
        w(rng.choice(("G1 ", "")) + w.point(axes, [rng.uniform(-60, 60), rng.uniform(-60, 60), rng.uniform(-12, -1)]))
    if rng.random() < 0.2:
        w("G1 X=IC(%s)" % number(rng.uniform(-20, 20)))


def arcs(w, rng):
    """In one of the planes, by I J K or by CR=."""
    plane = rng.choice((17, 17, 17, 18, 19))
    a, b, c = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    start = [round(rng.uniform(-30, 30), 2) for _ in range(3)]
    w("G0 " + w.point("XYZ", [x + rng.uniform(2, 5) for x in start]))
    if plane != 17:
        w("G%d" % plane)
    w("G1 %s F%d" % (w.point("XYZ", start), rng.randint(100, 900)))
    i, j = (round(rng.uniform(3, 30) * rng.choice((1, -1)), 3) for _ in range(2))
    radius, angle = math.hypot(i, j), math.atan2(-j, -i)
    sweep = rng.uniform(0.3, 5.8) * rng.choice((1, -1))
    end = start[:]
    end[a] += i + radius * math.cos(angle + sweep)
    end[b] += j + radius * math.sin(angle + sweep)
    helix = rng.random() < 0.3
    if helix:
        end[c] += rng.uniform(-5, 5)
    letters = "XYZ"[a] + "XYZ"[b] + ("XYZ"[c] if helix else "")
    text = "G%d " % (3 if sweep > 0 else 2) + w.point(letters, [end["XYZ".index(k)] for k in letters])
    if rng.random() < 0.3 and abs(abs(sweep) - math.pi) > 0.3 and abs(sweep) < 5:
        w(text + " CR=" + number(radius if abs(sweep) < math.pi else -radius, 4))
    else:
        w("%s %s%s %s%s" % (text, "IJK"[a], number(i), "IJK"[b], number(j)))
    if plane != 17:
        w("G17")


def call(w, rng, spec, stands, additive, modes):
    """A plane that both rotary axes reach, as words of CYCLE800; None where none was found."""
    m = Machine(spec)
    for _ in range(300):
        mode = rng.choice(modes)
        words = {"FR": rng.choice((0, 1, 1)), "TC": "TC1", "ST": 1 if additive else 0, "MODE": mode, "FR_I": 100, "DMODE": 1}
        digits = rng.choice((0, 0, 1, 3))
        words.update({k: round(rng.uniform(-55, 55), digits) for k in "ABC"})
        for k in rng.sample("ABC", rng.choice((0, 0, 1, 2))):
            words[k] = 0.0
        if mode == 64:
            words["A"], words["C"] = round(rng.uniform(-170, 170), digits), 0.0
        words.update({k: round(rng.uniform(-30, 30), rng.choice((0, 2))) if rng.random() < 0.7 else 0.0 for k in ("X0", "Y0", "Z0")})
        words.update({k: round(rng.uniform(-20, 20), rng.choice((0, 2))) if rng.random() < 0.4 else 0.0 for k in ("X1", "Y1", "Z1")})
        words["DIR"] = rng.choice((1, -1))
        laid = w.standing @ cycle.frame(words) if additive else cycle.frame(words)
        theta = m.swivelled(laid[:3, 2], words["DIR"], stands)
        other = m.swivelled(laid[:3, 2], -words["DIR"], stands)
        if theta is None or other is None or abs(theta[spec["reference"]]) < 1:
            continue
        if any(stands[k] is not None and abs(abs(theta[k] - stands[k]) - 180) < 2 for k in theta):
            continue
        return words, laid, theta
    return None


def program(rng, spec, followed):
    """A program and what it has of all that there is, for the figures. `followed`: nothing that the reference refuses."""
    m, w, has = Machine(spec), Writer(rng), []
    w("G17 G90 G71 G94 G40")
    w(rng.choice(("G54", "G55")))
    stands = {k: None for k in m.rotary}
    for plane in range(rng.randint(1, 3)):
        additive = plane > 0 and rng.random() < 0.3
        fresh, turned_before = plane == 0 or rng.random() < 0.4, rng.random() < 0.3
        if followed and plane and not additive and (fresh or turned_before):
            w("CYCLE800()")
        if fresh and not (followed and additive):
            tool = rng.choice((1, 2))
            if rng.random() < 0.4:
                w("SUPA G0 Z600 D0")
            w("T%d" % tool)
            w("M6")
            w("D1")
            w("S%d M3" % rng.randint(800, 9000))
            if plane == 0:
                stands = {k: 0.0 for k in m.rotary}
                w("G0 " + " ".join("%s0" % k for k in m.rotary))
        found = call(w, rng, spec, stands, additive, FOLLOWED if followed else MODES)
        if found is None:
            continue
        words, w.standing, theta = found
        # Posts write the way into the hundreds of thousands too.
        if rng.random() < 0.5:
            words["ST"] += 100000 if words["DIR"] < 0 else 200000
        if turned_before and not (followed and additive):
            has.append("angles before")
            w("G0 " + " ".join("%s%s" % (k, number(v, 6)) for k, v in theta.items()))
            if rng.random() < 0.5 and not followed:
                words["DIR"] = 0
                words["ST"] %= 100000
        has += ["mode %d" % words["MODE"], "additive" if additive else "new", "DIR %d" % words["DIR"]]
        keys = cycle.NAMES if rng.random() < 0.7 else cycle.NAMES[:14]
        w("CYCLE800(" + ",".join('"%s"' % words[k] if k == "TC" else number(words[k], 6) for k in keys) + ")")
        stands = theta
        if rng.random() < 0.5:
            w("G0 " + w.point("XYZ", [rng.uniform(-40, 40), rng.uniform(-40, 40), 40]))
        else:
            w("G0 " + w.point("XY", [rng.uniform(-40, 40), rng.uniform(-40, 40)]))
            w("Z40")
        for _ in range(rng.randint(1, 3)):
            rng.choice((lines, arcs))(w, rng)
            w("G0 Z40")
        if rng.random() < 0.5 and not followed:
            shift = rng.choice(("TRANS", "ATRANS"))
            has.append("frame in plane")
            w("%s %s" % (shift, w.point("XYZ", [rng.uniform(-20, 20), rng.uniform(-20, 20), 0])))
            if rng.random() < 0.6:
                w("AROT %s%s" % (rng.choice(("Z", "RPL=")), number(rng.uniform(-90, 90), 2)))
            w("G0 " + w.point("XYZ", [rng.uniform(-20, 20), rng.uniform(-20, 20), 40]))
            rng.choice((lines, arcs))(w, rng)
            w("G0 Z40")
            w(rng.choice(("TRANS", "ROT")))
            w("G0 " + w.point("XYZ", [rng.uniform(-20, 20), rng.uniform(-20, 20), 45]))
    w("CYCLE800()")
    w("G0 " + " ".join("%s0" % k for k in m.rotary))
    if rng.random() < 0.5:
        w("G0 " + w.point("XYZ", [rng.uniform(-30, 30), rng.uniform(-30, 30), 60]))
        lines(w, rng)
        w("G0 Z60")
    w("M30")
    return "\n".join(w.lines) + "\n", has


def case(seed, n):
    rng = random.Random("swivel %d %d" % (seed, n))
    kind = ("tt", "ht", "hh")[n % 3]
    spec = machine(rng, kind, "perfect" if n % 12 == 5 else "crooked")
    text, has = program(rng, spec, n % 4 != 3)
    return spec, text, has
