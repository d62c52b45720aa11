"""Random lathes (as profiles in the form of README.md) and random turning programs for them. Decided by seed and number."""

import math
import random

from common.profile import Profile
from common.words import number

KINDS = ("shaft", "face", "groove", "canned", "multiple", "bore", "nose-od", "nose-bore", "thread", "corners", "increments", "sinumerik",
         "linuxcnc-g7", "linuxcnc-g8", "linuxcnc-cycle", "linuxcnc-nose", "face-multiple", "pattern", "hole", "linuxcnc-thread")
CODES = {"A": {"min": "G98", "rev": "G99", "limit": "G50", "turn": "G90", "threads": "G92", "face": "G94", "thread": "G32", "mm": "G21", "start": "",
               "70": "G70", "71": "G71", "72": "G72", "73": "G73", "74": "G74", "75": "G75", "76": "G76"},
         "B": {"min": "G94", "rev": "G95", "limit": "G92", "turn": "G77", "threads": "G78", "face": "G79", "thread": "G33", "mm": "G21", "start": "G90",
               "70": "G70", "71": "G71", "72": "G72", "73": "G73", "74": "G74", "75": "G75", "76": "G76"},
         "C": {"min": "G94", "rev": "G95", "limit": "G92", "turn": "G20", "threads": "G21", "face": "G24", "thread": "G33", "mm": "G71", "start": "G90",
               "70": "G72", "71": "G73", "72": "G74", "73": "G75", "74": "G76", "75": "G77", "76": "G78"}}


def lathe(rng, kind, number):
    """A random lathe; every eighth is perfect."""
    perfect = number % 8 == 7
    table = lambda axis, low, high: {  # noqa: E731
        "position_mm": [low + (high - low) * k / 12 for k in range(13)],
        **{f"E{d}{axis}_um": [round(a * math.sin(k / 3 + p) + b * (k - 6) / 6, 3) for k in range(13)]
           for d, a, b, p in (("X", rng.uniform(-6, 6), rng.uniform(-10, 10), rng.uniform(0, 6)), ("Y", rng.uniform(-3, 3), 0, rng.uniform(0, 6)), ("Z", rng.uniform(-6, 6), rng.uniform(-10, 10), rng.uniform(0, 6)))},
        **{f"E{d}{axis}_urad": [round(a * math.sin(k / 4 + p), 3) for k in range(13)]
           for d, a, p in (("A", rng.uniform(-20, 20), rng.uniform(0, 6)), ("B", rng.uniform(-40, 40), rng.uniform(0, 6)), ("C", rng.uniform(-20, 20), rng.uniform(0, 6)))}}
    control = "linuxcnc-lathe" if kind.startswith("linuxcnc") else "sinumerik-turn" if kind == "sinumerik" else "fanuc-lathe"
    length = rng.choice((60, 120, 200, 300))
    bore = kind in ("bore", "nose-bore")
    face = float(rng.choice((0, 50, 80)))
    clamping = "chuck" if bore or kind == "face" or length < 100 else rng.choice(("chuck", "chuck-tailstock", "centres"))
    spec = {
        "name": f"lathe {kind} {number}", "control": control, "chain": "[w S b Z X t]", "x": "radius" if kind == "linuxcnc-g8" else "diameter", "decimal": "millimetres",
        "axes": {"X": {"travel_mm": [-30, 220], "resolution_mm": rng.choice((0.001, 0.001, 0.0001))}, "Z": {"travel_mm": [-60, 560], "resolution_mm": 0.001}},
        "tool": {"lengths_mm": {"H1": [rng.choice((0, 12.5, 30)), 0, rng.choice((0, 41.25, 60))]}, "noses": {}},
        "work_offsets_mm": {"G54": [0, 0, face + length + rng.choice((0, 5))]},
        "spindle": {"centre_mm": [0, 0], "face_mm": face}, "tolerance_um": rng.choice((1.0, 1.0, 2.0, 5.0)), "length": length,
    }
    if control == "fanuc-lathe":
        spec["g_code_system"] = rng.choice("ABC")
        if kind in ("thread", "multiple", "face-multiple", "pattern", "groove", "hole"):
            spec["parameters"] = {"thread_chamfer_leads": rng.choice((0.0, 0.0, 1.0)), "thread_chamfer_deg": 45.0, "roughing_escape_mm": rng.choice((0.2, 0.5)), "groove_return_mm": 0.2}
        if kind == "increments":
            spec["g_code_system"] = "A"
    if perfect:
        spec["perfect"] = True
    else:
        spec["axes"]["X"]["table"], spec["axes"]["Z"]["table"] = table("X", -30, 220), table("Z", -60, 560)
        spec["squareness"] = {"EB0Z_urad": round(rng.uniform(-150, 150), 2), "EA0Z_urad": round(rng.uniform(-60, 60), 2)}
        spec["spindle"].update({"EX0S_um": round(rng.uniform(-10, 10), 2), "EY0S_um": round(rng.uniform(-10, 10), 2),
                                "EA0S_urad": round(rng.uniform(-40, 40), 2), "EB0S_urad": round(rng.uniform(-60, 60), 2)})
        if rng.random() < 0.25:
            spec["spindle"].update({"EXS_cos_um": [0.0, round(rng.uniform(-2, 2), 3)], "EYS_sin_um": [round(rng.uniform(-2, 2), 3)]})
        spec["headstock"] = {"offset_um": [round(rng.uniform(-8, 8), 2), 0.0]}
        if clamping != "chuck":
            spec["tailstock"] = {"at_mm": float(length), "offset_um": [round(rng.uniform(-30, 30), 2), round(rng.uniform(-20, 20), 2)]}
        spec["workpiece"] = {"diameters_mm": [[0, 60], [length, 60]], "e_gpa": 210.0, "clamping": clamping}
        if rng.random() < 0.6:
            spec["workpiece"]["radial_force_n"] = float(rng.choice((100, 250, 400)))
    nose = kind.startswith("nose") or kind.endswith("-nose") or rng.random() < 0.5
    if nose:
        direction = (2 if bore else 3) if control != "linuxcnc-lathe" else (3 if bore else 2)
        spec["tool"]["noses"]["H1"] = {"radius_mm": rng.choice((0.2, 0.4, 0.8)), "direction": direction, "height_um": 0.0 if perfect else round(rng.choice((0, 0, rng.uniform(-60, 60))), 2)}
    return spec


def write(spec, folder):
    """Writes the profile and its tables; returns the path."""
    p = Profile(spec["name"], spec["control"], spec["chain"])
    for axis in "XZ":
        one = spec["axes"][axis]
        p.axis(axis).update(travel_mm=one["travel_mm"], resolution_mm=one["resolution_mm"])
        if "table" in one:
            names = [name for name in one["table"] if name != "position_mm"]
            p.errors(axis, one["table"]["position_mm"], zip(*(one["table"][name] for name in names)), digits=".6g", columns=names)
    for name in ("squareness", "spindle", "headstock", "tailstock", "workpiece"):
        p[name].update(spec.get(name) or {})
    p["tool"].update(default_mm=[0, 0, 0], lengths_mm=spec["tool"]["lengths_mm"], noses=spec["tool"].get("noses") or None)
    p["work_offsets_mm"].update(spec["work_offsets_mm"])
    p["correction"]["tolerance_um"] = spec["tolerance_um"]
    p["program"].update(x=spec["x"], decimal=spec["decimal"], g_code_system=spec.get("g_code_system"), **spec.get("parameters", {}))
    return str(p.write(folder, "lathe.toml"))


class Words:
    """Writes moves in the words of one dialect; keeps the place for increments."""

    def __init__(self, spec, rng, increments=0.0):
        self.spec, self.rng = spec, rng
        self.factor = 2.0 if spec["x"] == "diameter" else 1.0
        self.share = increments
        self.x = self.z = None
        self.lines = []

    def say(self, text):
        if text:
            self.lines.append(text)

    def to(self, code, x=None, z=None, more=""):
        words = code
        if x is not None:
            x = round(self.factor * x, 3) / self.factor
            if self.x is not None and self.rng.random() < self.share:
                words += " U" + number(self.factor * (x - self.x))
            else:
                words += " X" + number(self.factor * x)
            self.x = x
        if z is not None:
            z = round(z, 3)
            words += " W" + number(z - self.z) if self.z is not None and self.rng.random() < self.share else " Z" + number(z)
            self.z = z
        self.say((words + more).strip())

    def arc(self, clockwise, x, z, radius, by_radius):
        x, z = round(self.factor * x, 3) / self.factor, round(z, 3)
        if by_radius:
            more = (" CR=" if self.spec["control"] == "sinumerik-turn" else " R") + number(radius)
        else:
            import reader

            cx, cz, _ = reader.arc_by_radius((self.x, self.z), (x, z), radius, clockwise)
            more = f" I{number(cx - self.x)} K{number(cz - self.z)}"
            # the centre is rounded: the end is set on the arc's own circle along Z by nobody, and controls allow 0.01 mm
        self.to("G2" if clockwise else "G3", x, z, more)


def contour(rng, length, inside=False, drop=0.0):
    """Pieces ("L", x, z) and ("A", x, z, R, clockwise) from the right end towards the chuck, radii growing (falling in a bore)."""
    sign = -1.0 if inside else 1.0
    x, z = (rng.uniform(24, 28) if inside else rng.uniform(8, 14)), 0.0
    pieces = [("L", x, z)]
    depth = min(length * 0.8, 220.0)
    count = rng.randint(3, 6)
    for k in range(count):
        dz = depth / count
        room = (x - 14) if inside else (28 - x)
        what = rng.choice(("cylinder", "taper", "taper", "arc", "step"))
        if what == "step" and room > 2:
            x += sign * round(rng.uniform(0.5, min(2, room)), 2)
            pieces.append(("L", x, z))
        elif what == "taper" and room > 1.5:
            x += sign * rng.uniform(0.3, min(3.0, room - 0.5))
            z -= rng.uniform(0.5, 0.6) * dz
            pieces.append(("L", x, z))
        elif what == "arc" and room > 2.5:
            r = round(rng.uniform(2.0, min(6.0, room, dz * 0.6)), 2) if dz > 5 else 0
            if r >= 2:
                hollow = rng.random() < 0.5
                x, z = x + sign * r, z - r
                # outside: hollow from along -Z into +X is G2 (Z right, X up); a convex one from +X into -Z is G3
                pieces.append(("A", x, z, r, hollow != inside))
        z -= 0.35 * dz
        pieces.append(("L", x, z))
    return [p for k, p in enumerate(pieces) if k == 0 or math.hypot(p[1] - pieces[k - 1][1], p[2] - pieces[k - 1][2]) > 1e-6]


def merged(pieces):
    """Without points on a straight way: LinuxCNC's G71 refuses neighbours along one line."""
    out = [pieces[0]]
    for p in pieces[1:]:
        if len(out) > 1 and p[0] == out[-1][0] == "L":
            (a, b), (c, d) = (out[-1][k] - out[-2][k] for k in (1, 2)), (p[k] - out[-1][k] for k in (1, 2))
            if abs(a * d - b * c) < 1e-9:
                out[-1] = p
                continue
        out.append(p)
    return out


def header(w, kind):
    spec, rng = w.spec, w.rng
    if spec["control"] == "fanuc-lathe":
        c = CODES[spec["g_code_system"]]
        w.say("%")
        w.say(f"O{rng.randint(1000, 8999)}")
        w.say(f"{c['mm']} G18 G40 {c['rev']} {c['start']} G54".replace("  ", " "))
        w.say(f"{c['limit']} S2500")
        w.say("T0101")
        w.say("G97 S800 M3" if "thread" in kind else rng.choice(("G96 S180 M3", "G97 S900 M3")))
    elif spec["control"] == "sinumerik-turn":
        w.say("G18 G90 G95 G71 G40 G54")
        w.say({"diameter": rng.choice(("DIAMON", "DIAM90"))}.get(spec["x"], "DIAMOF"))
        w.say("LIMS=2500")
        w.say("T1 D1")
        w.say("G96 S180 M3")
    else:
        w.say("G21 G18 G40 G90 G54 " + ("G7" if spec["x"] == "diameter" else "G8"))
        w.say("T1 M6 G43 H1")
        w.say("G95 G97 S800 M3" if "cycle" in kind else rng.choice(("G95 G96 D2500 S180 M3", "G95 G97 S900 M3")))
    w.say("M8" if rng.random() < 0.5 else "")


def footer(w):
    w.say("M9")
    w.say("M5")
    w.say("M30" if w.spec["control"] != "linuxcnc-lathe" else "M2")
    if w.spec["control"] == "fanuc-lathe":
        w.say("%")


def follow(w, pieces, feed=" F0.2", arcs=True):
    for k, p in enumerate(pieces):
        if p[0] == "A" and arcs:
            w.arc(p[4], p[1], p[2], p[3], w.rng.random() < 0.6)
        else:
            w.to("G1", p[1], p[2], feed if k == 0 else "")


def program(rng, spec, kind):
    """Text of a program of that kind."""
    w = Words(spec, rng, 0.5 if kind == "increments" else 0.0)
    header(w, kind)
    length = spec["length"]
    c = CODES.get(spec.get("g_code_system", "A"))
    bore = kind in ("bore", "nose-bore")
    if kind in ("shaft", "increments", "linuxcnc-g7", "linuxcnc-g8", "sinumerik"):
        w.to("G0", 40, 5)
        pieces = contour(rng, length)
        for step in range(rng.randint(1, 3), 0, -1):
            off = 0.4 * (step - 1)
            w.to("G0", pieces[0][1] + off, 2)
            follow(w, [(p[0], p[1] + off, p[2], *p[3:]) for p in pieces])
            w.to("G0", 40)
            w.to("G0", None, 5)
    elif kind == "face":
        w.to("G0", 32, 1)
        for k in range(rng.randint(1, 3)):
            w.to("G0", None, 0.6 - 0.3 * k)
            w.to("G1", rng.choice((-0.8, 0, 2.5)), None, " F0.15")
            w.to("G0", None, 2)
            w.to("G0", 32)
    elif kind == "groove":
        w.to("G0", 32, 2)
        at = -rng.uniform(10, 40)
        if rng.random() < 0.5 and spec["control"] == "fanuc-lathe":
            w.to("G0", 31, at)
            w.say(f"{c['75']} R0.2")
            w.to(c["75"], 24, at - 6, " P1500 Q2000 F0.08")
        else:
            for k in range(rng.randint(1, 4)):
                w.to("G0", 31, at - 3 * k)
                w.to("G1", 25, None, " F0.08")
                w.to("G1", 31, None, " F0.5")
        w.to("G0", 40)
    elif kind == "canned":
        w.to("G0", 32, 2)
        if rng.random() < 0.6:
            taper = rng.choice((0, 0, -1.5))
            w.to(c["turn"], 28, -rng.uniform(20, 0.6 * length), (f" R{number(taper)}" if taper else "") + " F0.25")
            for x in (26.5, 25.2, 24.125):
                w.say("X" + number(w.factor * x))
        else:
            w.to(c["face"], 4, -1.0, " F0.2")
            for z in (-2.0, -3.25):
                w.say("Z" + number(z))
        w.x, w.z = 32, 2
        w.to("G0", 40, 5)
    elif kind == "multiple":
        w.to("G0", 31, 2)
        pieces = contour(rng, length)
        if rng.random() < 0.3:
            # series 10 and 11: one block
            w.say(f"{c['71']} P100 Q200 U0.4 W0.1 D2000 F0.3")
        else:
            w.say(f"{c['71']} U2. R0.5")
            w.say(f"{c['71']} P100 Q200 U0.4 W0.1 F0.3")
        w.to("N100 G0", pieces[0][1])
        follow(w, pieces, " F0.12")
        w.lines[-1] = "N200 " + w.lines[-1]
        w.say(f"{c['70']} P100 Q200")
        w.x, w.z = 31, 2
        w.to("G0", 40, 5)
    elif kind == "face-multiple":
        # a contour of faces, from the outside in
        w.to("G0", 31, 2)
        r, z, faces = 29.0, -rng.uniform(6, 12), []
        first = z
        for _ in range(rng.randint(2, 4)):
            r = max(r - rng.uniform(1, 5), 4.0)
            faces.append((round(r, 3), round(z, 3)))
            z = min(z + rng.uniform(0.5, 2), 0.0)
            if rng.random() < 0.5:
                r = max(r - rng.uniform(0.5, 2), 3.0)
            faces.append((round(r, 3), round(z, 3)))
        w.say(f"{c['72']} W1.5 R0.4")
        w.say(f"{c['72']} P100 Q200 U0.4 W0.1 F0.3")
        w.to("N100 G0", None, first)
        for k, (r, z) in enumerate(faces):
            w.to("G1", r, z, " F0.1" if k == 0 else "")
        w.lines[-1] = "N200 " + w.lines[-1]
        w.say(f"{c['70']} P100 Q200")
        w.x, w.z = 31, 2
        w.to("G0", 40, 5)
    elif kind == "pattern":
        w.to("G0", 33, 2)
        pieces = contour(rng, length)
        w.say(f"{c['73']} U{rng.choice((2, 3))}. W{rng.choice((0, 1))}. R{rng.choice((2, 3, 4))}")
        w.say(f"{c['73']} P100 Q200 U0.4 W0.1 F0.3")
        w.to("N100 G0", pieces[0][1], 2)
        follow(w, pieces, " F0.12")
        w.lines[-1] = "N200 " + w.lines[-1]
        w.say(f"{c['70']} P100 Q200")
        w.x, w.z = 33, 2
        w.to("G0", 40, 5)
    elif kind == "hole":
        w.to("G0", 0, 3)
        if rng.random() < 0.7:
            w.say(f"{c['74']} R0.3")
        w.to(c["74"], None, -rng.uniform(8, 30), f" Q{rng.choice((2500, 4000, 6000))} F0.1")
        w.x, w.z = 0, 3
        w.to("G0", None, 5)
        w.to("G0", 40, 5)
    elif kind == "linuxcnc-thread":
        w.to("G0", 32, 6)
        if rng.random() < 0.5:
            # outside, or inside a bore; spring passes, degression and angle
            inside = rng.random() < 0.3
            w.to("G0", 20 if inside else 32, 6)
            w.say(f"G76 P1.5 Z{number(-rng.uniform(15, 40))} I{'' if inside else '-'}{rng.choice((2, 3))}. J{rng.choice((0.4, 0.6))} K1.84 R{rng.choice((1, 1.5, 2))} Q{rng.choice((0, 29, 29.5))} H{rng.choice((0, 2))}")
            w.x = w.z = None
        for x in () if w.x is None else (29.6, 29.3, 29.1):
            w.to("G0", x)
            w.to("G33", x + rng.choice((0, 0, 0.5)), -rng.uniform(15, 40), " K1.5")
            w.to("G0", 32)
            w.to("G0", None, 6)
        w.to("G0", None, 6)
        w.to("G0", 40, 6)
    elif kind == "bore":
        pieces = contour(rng, length, True)
        w.to("G0", 12, 5)
        w.to("G0", pieces[0][1], 2)
        follow(w, pieces)
        w.to("G1", w.x - 0.5)
        w.to("G0", None, 5)
    elif kind in ("nose-od", "nose-bore", "linuxcnc-nose"):
        pieces = contour(rng, length, bore)
        pieces = [("L", *p[1:3]) if p[0] == "A" and not (p[4] == bore) else p for p in pieces]
        w.to("G0", 12 if bore else 40, 8)
        w.to("G0", pieces[0][1] + (-3 if bore else 3), 5)
        w.to(("G41" if bore else "G42") + " G1", pieces[0][1], 2, " F0.3")
        follow(w, pieces)
        w.to("G1", w.x + (-3 if bore else 3))
        w.to("G40 G0", w.x + (-2 if bore else 6), None if bore else w.z + 1)
        w.to("G0", None, 8)
    elif kind == "thread":
        w.to("G0", 32, 6)
        way = rng.choice(("block", "canned", "multiple"))
        end = -rng.uniform(15, 40)
        if way == "block":
            for x in (29.6, 29.3, 29.1):
                w.to("G0", x)
                w.to(c["thread"], None, end, " F1.5")
                w.to("G0", 32)
                w.to("G0", None, 6)
        elif way == "canned":
            w.to(c["threads"], 29.6, end, " F1.5")
            for x in (29.3, 29.1):
                w.say("X" + number(w.factor * x))
        else:
            w.say(f"{c['76']} P{rng.choice(('0200', '0110', '0305'))}{'00' if spec.get('perfect') else rng.choice(('00', '00', '00', '60'))} Q100 R0.05")
            w.to(c["76"], 29.08, end, " P920 Q300 F1.5")
        w.x, w.z = 32, 6
        w.to("G0", 40)
    elif kind == "corners":
        w.to("G0", 14, 2)
        w.to("G1", None, 0, " F0.2")
        w.to("G1", 18, None, rng.choice((" ,C1.", " ,R1.5")))
        w.to("G1", None, -20, rng.choice((" ,R2.", " ,C0.8")))
        w.to("G1", 24, None, rng.choice((" ,C1.", " ,R1.")))
        w.to("G1", None, -35)
        if rng.random() < 0.5:
            w.say("G1 X54. ,A160.")
            w.x = None
        w.to("G0", 40)
    elif kind == "linuxcnc-cycle":
        w.to("G0", 31, 2)
        if rng.random() < 0.6:
            pieces = contour(rng, length)
            pieces = merged([("L", pieces[0][1], 1.0), *pieces])[1:]
            w.lines.insert(0, "o100 sub")
            body = Words(spec, rng)
            body.to("G0", pieces[0][1], 1)
            body.x, body.z = round(2 * pieces[0][1], 3) / 2, 1
            follow(body, pieces, "")
            w.lines[1:1] = [*body.lines, "o100 endsub"]
            w.say("F0.3")
            w.to("G0", 31, 2)
            w.say(f"{rng.choice(('G71', 'G71.1'))} Q100 X62. Z2. D{rng.choice((0.2, 1))} I0.5 R0.4")
            w.to("G0", 31, 2)
            w.say("G70 Q100 X62. Z2." + rng.choice(("", " D0.4 E0. P2")))
        else:
            w.to("G0", 31, 4)
            w.say("G76 P1.5 Z-30. I-2. J0.6 K1.84 R1.5 Q29. H2")
        w.to("G0", 40, 5)
    footer(w)
    return "\n".join(w.lines) + "\n"


def pair(seed, number):
    """(kind, spec, program text) of one number."""
    kind = KINDS[number % len(KINDS)]
    rng = random.Random(f"{seed}/{number}")
    spec = lathe(rng, kind, number // len(KINDS))
    return kind, spec, program(rng, spec, kind)
