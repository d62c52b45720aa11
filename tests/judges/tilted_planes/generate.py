"""Random crooked five-axis machines, as profiles, and random programs in tilted planes. All from seed and number."""

import math
import random

import numpy as np

from common.profile import Profile
from common.words import number

import machine
import planes
import reader

CHAINS = {
    "tt-ac": ("[w C A X Y b Z t]", "[w C A Y b X Z t]"),
    "tt-bc": ("[w C B X Y b Z t]", "[w C B b X Y Z t]"),
    "ht": ("[w C X Y b Z B t]", "[w C Y b X Z A t]", "[w A X b Y Z B t]", "[w B X b Y Z A t]"),
    "hh": ("[w X Y b Z C A t]", "[w X b Y Z C B t]", "[w b X Y Z C A t]"),
    "nutating": ("[w C X Y b Z B t]", "[w C B X Y b Z t]"),
}
LOCATIONS = {"A": ("EY0A", "EZ0A", "EB0A", "EC0A"), "B": ("EX0B", "EZ0B", "EA0B", "EC0B"), "C": ("EX0C", "EY0C", "EA0C", "EB0C")}
TRAVEL = (-1000, 1000)


def table(rng, axis, nodes, size):
    """A smooth random table: EXX EYX EZX in um, EAX EBX ECX in urad."""
    rows = []
    waves = [[(rng.uniform(-1, 1), rng.uniform(0.3, 2.5), rng.uniform(0, 6)) for _ in range(3)] for _ in range(6)]
    span = nodes[-1] - nodes[0]
    for at in nodes:
        rows.append([round(size * sum(a * math.sin(2 * math.pi * f * at / span * 4 + p) for a, f, p in one), 2) for one in waves])
    return list(nodes), rows


def make_machine(rng, kind, state):
    """`state`: crooked, perfect, or centres (straight, but the control's centres are others)."""
    chain = rng.choice(CHAINS[kind])
    head = machine.parts(chain)[2]
    crooked = state == "crooked"
    spec = {"chain": chain, "kind": kind, "state": state, "axes": {}, "rotary": {}, "control_centres": {}}
    fine = rng.random() < 0.25
    for k in "XYZ":
        nodes = np.linspace(*TRAVEL, rng.choice((21, 41, 81)))
        spec["axes"][k] = {"resolution": 0.0001 if fine else 0.001}
        if crooked and rng.random() < 0.8:
            spec["axes"][k]["table"] = table(rng, k, nodes.tolist(), rng.choice((3, 8, 15)))
    spec["squareness_urad"] = [round(rng.uniform(-80, 80), 1) if crooked else 0.0 for _ in range(3)]
    table_centre = [rng.uniform(-60, 60) for _ in range(3)]
    for k in machine.parts(chain)[0] + head:
        if k in head:
            centre = [rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(120, 260)]
        else:
            centre = [c + rng.uniform(-40, 40) for c in table_centre]
        centre = [round(c, 3) for c in centre]
        one = {"centre": centre, "travel": [-400, 400] if k == "C" else [-125, 125]}
        if rng.random() < 0.3:
            one["tilt"] = rng.choice(("body", "axis"))
        if kind == "nutating" and k == "B":
            one["direction"] = rng.choice(([0, 1, 1], [0, -1, 1], [1, 0, 1]))
            one["travel"] = [-185, 185]
        if crooked:
            one["location"] = {e: round(rng.uniform(-40, 40) * (1 if e[1] in "XYZ" else 3), 1) for e in LOCATIONS[k]}
            if rng.random() < 0.3:
                one["table"] = table(rng, k, np.linspace(-400, 400, 33).tolist(), 4)
        other = 0.0 if state == "perfect" else 1.0
        spec["control_centres"][k] = [round(c + other * rng.choice((0, rng.uniform(-0.08, 0.08))), 3) for c in centre]
        spec["rotary"][k] = one
    spec["tolerance"] = rng.choice((1.0, 1.0, 2.0, 5.0))
    spec["lengths"] = {"H1": round(rng.uniform(60, 180), 3), "H2": round(rng.uniform(60, 180), 3)}
    spec["offsets"] = {k: [round(c + rng.uniform(-50, 50), 3) for c in table_centre] for k in ("G54", "G55", "G59", "G54.1P3")}
    return spec


def write_profile(spec, folder, name="profile.toml"):
    """The profile, with its tables beside it; all keys by docs/reference.md."""
    p = Profile("Random " + spec["kind"], "fanuc", spec["chain"])
    for k in "XYZ":
        p.axis(k).update(travel_mm=TRAVEL, resolution_mm=spec["axes"][k]["resolution"])
    p["squareness"].update(zip(("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"), spec["squareness_urad"]))
    for k, one in spec["rotary"].items():
        # A tilt is not told without what leans by it (VP0314); where nothing is chosen the machine is one of `body`.
        p.axis(k).update(centre_mm=one["centre"], travel_deg=one["travel"], direction=one.get("direction"), tilt=one.get("tilt", "body"))
        p.located(k, one.get("location", {}))
    for k, one in {**spec["axes"], **spec["rotary"]}.items():
        if "table" in one:
            p.errors(k, *one["table"])
    p["tool"]["lengths_mm"] = spec["lengths"]
    p["work_offsets_mm"].update(spec["offsets"])
    p["correction"]["tolerance_um"] = spec["tolerance"]
    if spec.get("kinematics", True):
        p["kinematics"].update(straight="tip", centres_mm=spec["control_centres"], branch=spec.get("branch"), turn=spec.get("turn"))
    return p.write(folder, name)


class Writer:
    """A program under way: numbered blocks, lengths in the unit in force."""

    def __init__(self, rng, inch):
        self.rng, self.lines, self.n, self.inch = rng, [], 0, inch

    def block(self, text):
        self.n += 10
        self.lines.append("N%d %s" % (self.n, text))

    def length(self, v):
        return number(v / 25.4, 4) if self.inch else number(v)

    def place(self, axes, values):
        return " ".join("%s%s" % (k, self.length(v)) for k, v in zip(axes, values))

    def feed(self, v):
        return "F" + (number(v / 25.4, 1) if self.inch else number(v, 0))


def lines(w, rng):
    w.block("G0 " + w.place("XYZ", [rng.uniform(-70, 70), rng.uniform(-70, 70), 5]))
    style = rng.random()
    if style < 0.4:
        w.block("G0 Z" + w.length(2))
    w.block("G1 Z%s %s" % (w.length(-rng.uniform(1, 12)), w.feed(rng.randint(80, 400))))
    if rng.random() < 0.3:
        w.block("G91")
        for _ in range(rng.randint(2, 4)):
            w.block("G1 " + w.place("XYZ", [rng.uniform(-30, 30), rng.uniform(-30, 30), rng.uniform(-2, 2)]))
        w.block("G90")
    for n in range(rng.randint(1, 4)):
        axes = rng.choice(("XY", "X", "Y", "XYZ"))
        tail = " " + w.feed(rng.randint(200, 2500)) if n == 0 else rng.choice(("", " M8", ""))
        w.block(rng.choice(("G1 ", "")) + w.place(axes, [rng.uniform(-80, 80), rng.uniform(-80, 80), -rng.uniform(1, 15)][: len(axes)]) + tail)


def arcs(w, rng):
    a, b, c = reader.PLANES[17]
    code = rng.choice((17, 17, 17, 18, 19))
    a, b, c = reader.PLANES[code]
    if code != 17:
        w.block("G%d" % code)
    start = [round(rng.uniform(-40, 40), 2) for _ in range(3)]
    if w.inch:
        start = [round(x / 25.4, 3) * 25.4 for x in start]
    w.block("G0 " + w.place("XYZ", [x + rng.uniform(2, 6) for x in start]))
    radius, angle = rng.uniform(4, 45), rng.uniform(0, 2 * math.pi)
    i, j = (float(w.length(-radius * f(angle))) * (25.4 if w.inch else 1) for f in (math.cos, math.sin))
    angle = math.atan2(-j, -i)
    radius = math.hypot(i, j)
    centre = start[:]
    centre[a] += i
    centre[b] += j
    turns = rng.choice(("full", "part", "part", "helix", "radius"))
    sweep = rng.uniform(0.3, 5.8) * rng.choice((1, -1)) if turns != "full" else 2 * math.pi * rng.choice((1, -1))
    end = start[:]
    if turns != "full":
        end[a] = centre[a] + radius * math.cos(angle + sweep)
        end[b] = centre[b] + radius * math.sin(angle + sweep)
    if turns in ("helix", "full") and rng.random() < 0.6:
        end[c] += rng.uniform(-6, 6)
    names = "XYZ"[a] + "XYZ"[b] + "XYZ"[c]
    text = "G%d " % (3 if sweep > 0 else 2)
    text += w.place(names[:2], [end[a], end[b]]) + (" " + w.place(names[2], [end[c]]) if end[c] != start[c] else "")
    if turns == "radius" and 0.4 < abs(sweep) < 5.5 and abs(abs(sweep) - math.pi) > 0.2:
        text += " R" + w.length(radius if abs(sweep) < math.pi else -radius)
    else:
        text += " " + w.place("IJK"[a] + "IJK"[b], [i, j])
    w.block("G1 " + w.place("XYZ", start) + " " + w.feed(500))
    w.block(text + " " + w.feed(rng.randint(100, 1500)))
    if rng.random() < 0.4:
        w.block("G1 " + w.place("XY", [rng.uniform(-60, 60), rng.uniform(-60, 60)]))
    if code != 17:
        w.block("G17")


def holes(w, rng):
    w.block("G0 " + w.place("XYZ", [rng.uniform(-60, 60), rng.uniform(-60, 60), rng.choice((10, 30))]))
    code, hold = rng.choice((81, 83)), rng.choice((98, 99))
    text = "G%d G%d " % (hold, code) + w.place("XY", [rng.uniform(-60, 60), rng.uniform(-60, 60)])
    text += " Z%s R%s" % (w.length(-rng.uniform(5, 40)), w.length(rng.choice((2, 3, 5))))
    if code == 83:
        text += " Q" + w.length(rng.choice((3, 5, 8)))
    w.block(text + " " + w.feed(rng.randint(50, 300)))
    for _ in range(rng.randint(0, 3)):
        axes = rng.choice(("X", "Y", "XY"))
        w.block(w.place(axes, [rng.uniform(-60, 60), rng.uniform(-60, 60)][: len(axes)]))
    w.block("G80")


def angle_words(rng, angles):
    """I, J and K; now and then without those that are 0, where one is left."""
    words = [(k, number(v, 6)) for k, v in zip("IJK", angles)]
    if rng.random() < 0.3:
        words = [x for x in words if x[1] != "0."] or words
    return " ".join(k + v for k, v in words)


def plane_words(w, rng, zero, turn):
    """Blocks of G68.2 for a plane, and the plane that these rounded words say."""
    kind = rng.choice((0, 0, 0, 2, 3))
    single = [k for k in range(3) if np.allclose(planes.about(k, 1)[:, k], turn[:, k])]
    if kind == 0 and single and rng.random() < 0.7:
        k = single[0]
        a, b = [(1, 2), (2, 0), (0, 1)][k]
        angle = math.degrees(math.atan2(turn[b, a], turn[a, a]))
        words = angle_words(rng, [angle if n == k else 0.0 for n in range(3)])
        w.block("G68.2 P1 Q123 %s %s" % (w.place("XYZ", zero), words))
    elif kind == 0:
        text = "G68.2 %s%s" % (rng.choice(("", "P0 ")), w.place("XYZ", zero))
        w.block(text + " " + angle_words(rng, planes.angles_of(turn)))
    elif kind == 2:
        # Points far enough apart that their decimals turn the plane by less than a microradian.
        far = 60.0
        inner = rng.uniform(-30, 30)
        for q, at in ((1, zero), (2, np.array(zero) + far * turn[:, 0]), (3, np.array(zero) + turn @ [inner, far, 0])):
            w.block("G68.2 P2 Q%d " % q + " ".join("%s%s" % (k, number(v / (25.4 if w.inch else 1), 6)) for k, v in zip("XYZ", at)))
    else:
        size = rng.choice((1.0, 10.0, 100.0))
        x, z = ([number(v * size, 6) for v in turn[:, k]] for k in (0, 2))
        w.block("G68.2 P3 Q1 %s I%s J%s K%s" % (w.place("XYZ", zero), *x))
        w.block("G68.2 P3 Q2 I%s J%s K%s" % tuple(z))


def make_program(rng, spec):
    """A program and how its planes get their angles; sets `branch` and `turn` of the profile."""
    m = machine.Machine(spec)
    w = Writer(rng, rng.random() < 0.12)
    align = rng.choice(("written", "written", "G53.1", "G53.6", "mixed"))
    tilting = [k for k in m.rotary if k != "C"]
    letter = tilting[-1]
    if align != "written":
        spec["branch"] = letter + rng.choice("+-")
        spec["turn"] = rng.choice(("shortest", "principal"))
    stands = {k: 0.0 for k in m.rotary}
    w.block("G17 G%d G90 G94 G40 G49 G80" % (20 if w.inch else 21))
    offset = rng.choice(list(spec["offsets"]))
    w.block(offset.replace("P", " P"))
    w.block("T1 M6")
    if align != "written" and rng.random() < 0.5:
        stands = {k: float(rng.randint(-60, 60)) for k in m.rotary}
    w.block("G0 " + " ".join("%s%s" % (k, number(v)) for k, v in stands.items()))
    w.block("S%d M3" % rng.randint(500, 9000))
    if rng.random() < 0.35:
        # Words of axes first: a plane must not be taken for what stood before it.
        w.block("G43 H1 G0 " + w.place("XYZ", [rng.uniform(-30, 30), rng.uniform(-30, 30), 60]))
        lines(w, rng)
        w.block("G0 Z" + w.length(60))
        w.block("G49")
    for n in range(rng.randint(1, 3)):
        steps = rng.choice((0, 3, 3, 4))
        way = align if align != "mixed" else rng.choice(("written", "G53.1", "G53.6"))
        for _ in range(200):
            theta = {}
            for k in m.rotary:
                low, high = (-170, 170) if k == "C" else (-75, 75)
                theta[k] = round(rng.uniform(low, high), steps)
                if rng.random() < 0.12:
                    theta[k] = 0.0
            if way == "written":
                break
            got = m.aligned(m.direction(theta), stands)
            if got is not None and all(abs(stands[k] - got[k]) < 178 for k in got) and abs(got[letter]) > 0.5:
                theta = got
                break
        else:
            continue
        normal = m.direction(theta)
        across = np.cross(normal, [0.3, -0.5, 0.8])
        turn = planes.by_axes(across, z=normal) @ planes.about(2, rng.uniform(-180, 180))
        if rng.random() < 0.5:
            i, j, _ = planes.angles_of(turn)
            turn = planes.by_angles(i, j, rng.choice((0, 0, 90, 30, -17.5)))
            turn = planes.by_axes(turn[:, 0], z=normal)
        zero = [round(rng.uniform(-40, 40), rng.choice((0, 3))) for _ in range(3)]
        if way == "written":
            # As any way of writing the same place: one block, or one axis after the other.
            words = ["%s%s" % (k, number(v, 4)) for k, v in theta.items()]
            for text in [" ".join(words)] if rng.random() < 0.7 else words:
                w.block("G0 " + text)
        plane_words(w, rng, zero, turn)
        if way != "written":
            w.block(way)
        stands = theta
        tool = rng.random() < 0.92
        if tool:
            hand = rng.choice((1, 2))
            if rng.random() < 0.6:
                w.block("G43 H%d G0 %s" % (hand, w.place("XYZ", [rng.uniform(-50, 50), rng.uniform(-50, 50), 50])))
            else:
                w.block("G43 H%d G0 Z%s" % (hand, w.length(50)))
                w.block("G0 " + w.place("XY", [rng.uniform(-50, 50), rng.uniform(-50, 50)]))
        else:
            w.block("G0 " + w.place("XYZ", [rng.uniform(-50, 50), rng.uniform(-50, 50), 50]))
        for _ in range(rng.randint(1, 4)):
            rng.choice((lines, lines, arcs, arcs, holes, holes))(w, rng)
            w.block("G0 Z" + w.length(50))
        w.block("M9")
        if tool:
            w.block("G49")
        w.block("G69")
        if rng.random() < 0.4:
            w.block(rng.choice(("G53 G0 Z" + w.length(300), "G91 G28 Z0.")))
            if "G91" in w.lines[-1]:
                w.block("G90")
        if rng.random() < 0.2:
            w.block(rng.choice(list(spec["offsets"])).replace("P", " P"))
    if rng.random() < 0.3:
        back = {k: 0.0 for k in m.rotary}
        w.block("G0 " + " ".join("%s%s" % (k, number(v)) for k, v in back.items()))
        w.block("G43 H2 G0 " + w.place("XYZ", [rng.uniform(-30, 30), rng.uniform(-30, 30), 60]))
        lines(w, rng)
        w.block("G0 Z" + w.length(60))
        w.block("G49")
    w.block("M30")
    return "%\nO1000\n" + "\n".join(w.lines) + "\n%\n", align


def case(seed, n, kind=None):
    rng = random.Random("%d-%d" % (seed, n))
    kind = kind or list(CHAINS)[n % len(CHAINS)]
    state = "perfect" if n % 12 == 7 else "centres" if n % 12 == 3 else "crooked"
    spec = make_machine(rng, kind, state)
    text, align = make_program(rng, spec)
    return spec, text, align
