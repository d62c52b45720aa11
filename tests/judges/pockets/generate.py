"""Random lathes as profiles; programs with G70 to G76, G83, G84, G87 and what they are to leave, by seed and number.

Meanings by B-64304EN-1 ("Multiple repetitive cycle", "Canned cycle for drilling"): U of G71 is the depth on the radius in
the first block and the allowance on the diameter in the second; W likewise along Z; D of the format of Series 10/11 is the
depth without a point, in increments of the least input. Type II where the first block of the contour names both axes.
"""

import math
import random

import numpy as np

from common.profile import Profile, column
from common.words import number

# Names of systems B and C; those of A are the keys.
NAMES = {
    "A": {},
    "B": {"G98": "G94", "G99": "G95", "G50": "G92"},
    "C": {"G98": "G94", "G99": "G95", "G50": "G92", "G21": "G71", "G70": "G72", "G71": "G73", "G72": "G74", "G74": "G76", "G75": "G77", "G76": "G78"},
}
KINDS = ("turn-1", "turn-2", "turn-2", "face-1", "face-2", "bore-1", "bore-2", "groove", "peck", "thread", "hole", "tap", "side")


def lathe(rng, state):
    crooked = state == "crooked"

    def table(low, high):
        at = np.linspace(low, high, rng.choice((9, 17, 25)))
        rows = np.zeros((len(at), 6))
        for k in range(6):
            for wave in (1, 2, 3):
                rows[:, k] += rng.gauss(0, 12) / wave * np.sin(wave * 3 * (at - low) / (high - low) + rng.uniform(0, 6))
        return {"at": at.tolist(), "rows": np.round(rows, 2).tolist()}

    spec = {"state": state, "system": rng.choice("AAABC"), "face": float(rng.choice((0, 50, 80))), "tables": {}}
    if crooked:
        spec["tables"] = {"X": table(-30, 220), "Z": table(-60, 560)}
    by = lambda size: round(rng.gauss(0, size), 2) if crooked else 0.0
    spec["squareness"] = {"EB0Z": by(120), "EA0Z": by(40)}
    spec["spindle"] = {"EX0S": by(8), "EY0S": by(8), "EA0S": by(40), "EB0S": by(60)}
    spec["length"] = [float(rng.choice((0, 12.5, 30))), float(rng.choice((0, 41.25, 60)))]
    spec["offset"] = [0.0, spec["face"] + rng.choice((120, 200, 300)) + rng.choice((0, 5.5))]
    spec["resolution"] = {"X": rng.choice((0.001, 0.001, 0.0001)), "Z": 0.001}
    spec["tolerance"] = rng.choice((1.0, 1.0, 2.0, 5.0))
    spec["escape"], spec["return"] = rng.choice((0.3, 0.5)), 0.2
    return spec


def profile(spec, folder):
    p = Profile("Pockets (invented)", "fanuc-lathe", "[w S b Z X t]")
    for k, travel in (("X", [-30, 220]), ("Z", [-60, 560])):
        p.axis(k).update(travel_mm=travel, resolution_mm=spec["resolution"][k])
    for k, data in spec["tables"].items():
        p.errors(k, data["at"], data["rows"])
    p["squareness"].update({column(k): v for k, v in spec["squareness"].items()})
    p["spindle"].update({"face_mm": spec["face"], **{column(k): v for k, v in spec["spindle"].items()}})
    p["tool"]["lengths_mm"] = {"H1": [spec["length"][0], 0, spec["length"][1]]}
    p["work_offsets_mm"]["G54"] = [0, 0, spec["offset"][1]]
    p["correction"]["tolerance_um"] = spec["tolerance"]
    p["program"].update(x="diameter", decimal="increments", g_code_system=spec["system"], roughing_escape_mm=spec["escape"], groove_return_mm=spec["return"])
    p["program"].update(thread_finishing_passes=1, thread_least_mm=0.05, thread_allowance_mm=0.02, thread_chamfer_leads=0.0, thread_chamfer_deg=45.0)
    p["program"].update(drill_pecks="full", drill_return_mm=0.5)
    return p.write(folder)


class Contour:
    """Corners in (along, into): the axis that is monotone and the axis of infeed, and the words of the blocks."""

    def __init__(self, rng, kind, system):
        self.facing, self.pockets, self.bore = kind.startswith("face"), kind.endswith("2"), kind.startswith("bore")
        # `side`: the tool is where the axis of infeed is larger (1), or smaller (-1, a bore).
        self.side = -1.0 if self.bore else 1.0
        if self.facing:
            self.start = (round(rng.uniform(28, 40), 2), round(rng.uniform(1, 3), 2))  # (r, z)
            along, into = self.start[0] - rng.uniform(1.5, 3), -round(rng.uniform(8, 14), 2)
            last, top = round(rng.uniform(5, 9), 2), self.start[1] - 0.5
        elif self.bore:
            self.start = (round(rng.uniform(8, 10), 2), round(rng.uniform(1, 4), 2))
            along, into = self.start[1], round(rng.uniform(18, 26), 2)
            last, top = -round(rng.uniform(25, 60), 2), self.start[0] + 0.5
        else:
            self.start = (round(rng.uniform(26, 40), 2), round(rng.uniform(1, 4), 2))
            along, into = self.start[1], round(rng.uniform(8, 14), 2)
            last, top = -round(rng.uniform(25, 90), 2), self.start[0] - 0.5
        self.blocks = []  # (kind, along, into, radius)
        first = self.start[0] if self.facing else self.start[1]
        self.first = (first, into)
        self.place = [first, into]
        steps = rng.randint(3, 6)
        length = (last - first) / steps
        room = (top - into) * self.side
        rise = room / steps * self.side
        for k in range(steps):
            goal = round(first + (k + 1) * length, 2)
            level = self.place[1]
            down = self.pockets and 0 < k < steps - 1 and rng.random() < 0.6
            if down:
                self.to(self.place[0] + 0.35 * length * rng.uniform(0.5, 1), level - self.side * rng.uniform(0.5, 0.8) * abs(rise))
                self.to(self.place[0] + 0.25 * length, self.place[1])
                self.to(goal, level + rise * rng.uniform(0.2, 0.9))
                continue
            way = rng.choice(("wall", "taper", "arc"))
            if way == "wall":
                self.to(goal, level)
                self.to(goal, level + rise * rng.uniform(0.2, 0.9))
            elif way == "taper":
                self.to(self.place[0] + 0.5 * length, level)
                self.to(goal, level + rise * rng.uniform(0.3, 0.9))
            else:
                size = min(abs(length), abs(rise)) * 0.7
                self.to(goal + math.copysign(size, -length), level)
                # A quarter that rises: hollow from along to into, or round.
                self.arc(goal, self.place[1] + self.side * round(size, 2), rng.choice((True, False)))
        # Out of the stock along the infeed.
        self.to(self.place[0], top + self.side * 0.8)

    def to(self, along, into):
        self.place = [round(along, 2), round(into, 2)]
        self.blocks.append(("line", *self.place, None))

    def arc(self, along, into, hollow):
        radius = abs(round(along, 2) - self.place[0])
        into = self.place[1] + self.side * radius
        before = self.place[:]
        self.place = [round(along, 2), round(into, 2)]
        centre = (before[0], self.place[1]) if hollow else (self.place[0], before[1])
        self.blocks.append(("arc", *self.place, (radius, centre, before)))

    def points(self):
        """(n, 2) of (along, into), from the first place on; arcs dense."""
        out = [self.first]
        for kind, a, b, more in self.blocks:
            if kind == "arc":
                radius, (ca, cb), (sa, sb) = more
                t0, t1 = math.atan2(sb - cb, sa - ca), math.atan2(b - cb, a - ca)
                t1 = t0 + (t1 - t0 + math.pi) % (2 * math.pi) - math.pi
                n = 2 + int(abs(t1 - t0) / math.sqrt(8 * 2e-5 / radius))
                out += [(ca + radius * math.cos(t), cb + radius * math.sin(t)) for t in np.linspace(t0, t1, n)[1:-1]]
            out.append((a, b))
        return np.array(out)

    def rz(self, points):
        """(along, into) as (r, z)."""
        return points if self.facing else points[:, ::-1]

    def words(self, first_n, feed, explicit_both):
        """Blocks N.. of the contour. X as diameters."""
        x, z = (lambda a, b: a if self.facing else b), (lambda a, b: b if self.facing else a)
        out, before = [], None
        a, b = self.first
        head = "X%s" % number(2 * x(a, b)) if not self.facing else "Z%s" % number(z(a, b))
        if explicit_both:
            head = "X%s Z%s" % (number(2 * x(a, b)), number(z(a, b)))
        out.append("G0 " + head)
        before = (a, b)
        for k, (kind, a, b, more) in enumerate(self.blocks):
            words = []
            if abs(x(a, b) - x(*before)) > 1e-9 or kind == "arc":
                words.append("X" + number(2 * x(a, b)))
            if abs(z(a, b) - z(*before)) > 1e-9 or kind == "arc":
                words.append("Z" + number(z(a, b)))
            if kind == "line":
                out.append("G1 " + " ".join(words) + (" F%s" % number(feed) if k == 0 else ""))
            else:
                radius, centre, start = more
                cx, cz = x(*centre), z(*centre)
                # Counterclockwise where the angle from Z towards X grows; seen with Y towards the reader's back that is G2.
                cross = (z(*start) - cz) * (x(a, b) - cx) - (x(*start) - cx) * (z(a, b) - cz)
                out.append("G%d %s R%s" % (3 if cross > 0 else 2, " ".join(words), number(radius)))
            before = (a, b)
        out = ["N%d %s" % (first_n + 10 * k, x) for k, x in enumerate(out)]
        return out, first_n + 10 * (len(out) - 1)


def case(seed, n):
    rng = random.Random("pockets %d %d" % (seed, n))
    spec = lathe(rng, "perfect" if n % 13 == 5 else "crooked")
    kind = KINDS[n % len(KINDS)] if n % 13 != 5 else rng.choice(KINDS[:7])
    spec["kind"] = kind
    g = lambda name: NAMES[spec["system"]].get(name, name)
    w = ["N1 %s G40 %s" % (g("G21"), g("G99")), "N2 %s S2500" % g("G50")]
    if spec["system"] != "A":
        w[0] += " G90"
    w += ["N3 T0101", "N4 G97 S800 M3"]
    make = {"groove": groove, "peck": groove, "thread": thread, "hole": hole, "tap": hole, "side": side}.get(kind, roughing)
    asked = make(rng, spec, kind, g, w)
    w += ["N900 G0 X%s Z%s" % (number(90.0), number(60.0)), "N910 M30"]
    return spec, "%\nO77\n" + "\n".join(w) + "\n%\n", asked


def roughing(rng, spec, kind, g, w):
    contour = Contour(rng, kind, spec["system"])
    depth = rng.choice((0.8, 1.0, 1.5, 2.0))
    u = rng.choice((0.0, 0.3, 0.4, 0.6)) * contour.side
    side_w = rng.choice((0.0, 0.05, 0.1)) if not contour.pockets or rng.random() < 0.15 else 0.0
    if contour.facing:
        u, side_w = (0.0 if contour.pockets else u), rng.choice((0.1, 0.2))
    feed, finish = rng.choice((0.2, 0.25, 0.3)), rng.choice((0.08, 0.1, 0.12))
    r, z = contour.start
    name, one_block = g("G72" if contour.facing else "G71"), rng.random() < 0.4
    w.append("N5 G0 X%s Z%s" % (number(2 * r), number(z)))
    lines, last = contour.words(100, finish, contour.pockets)
    more = "U%s W%s F%s" % (number(u), number(side_w), number(feed))
    if one_block:
        w.append("N20 %s P100 Q%d %s D%d" % (name, last, more, round(depth * 1000)))
        escape = spec["escape"]
    else:
        escape = rng.choice((0.3, 0.5, 1.0))
        w.append("N10 %s %s%s R%s" % (name, "W" if contour.facing else "U", number(depth), number(escape)))
        w.append("N20 %s P100 Q%d %s" % (name, last, more))
    w += lines
    w += ["N800 %s P100 Q%d" % (g("G70"), last), "N805 G4 U0.5" if spec["system"] == "A" else "N805 G4 P500"]
    return {"contour": contour, "depth": depth, "u": u, "w": side_w, "feed": feed, "finish": finish, "rough": 20, "finishing": 800, "one block": one_block, "escape": escape}


def groove(rng, spec, kind, g, w):
    """G75 (groove) and G74 (pecks along Z), in one block or in two."""
    along_x = kind == "groove"
    r, z = (round(rng.uniform(20, 30), 2), -round(rng.uniform(5, 40), 2)) if along_x else (round(rng.uniform(10, 20), 2), 2.0)
    deep = round(r - rng.uniform(3, 8), 2) if along_x else -round(rng.uniform(8, 30), 2)
    peck, step, count = rng.choice((1.0, 1.5, 2.5)), rng.choice((1.5, 2.0)), rng.randint(0, 4)
    rest = rng.choice((0.0, 0.7)) if count else 0.0
    far = round((z if along_x else r) - count * step - rest, 3) if along_x else round(r - count * step - rest, 3)
    w.append("N5 G0 X%s Z%s" % (number(2 * r), number(z)))
    name, feed, back = g("G75" if along_x else "G74"), rng.choice((0.08, 0.1)), rng.choice((0.2, 0.4))
    two = rng.random() < 0.6
    end_x, end_z = (deep, far) if along_x else (far, deep)
    p, q = (peck, step) if along_x else (step, peck)
    if two:
        w.append("N10 %s R%s" % (name, number(back)))
    words = "X%s Z%s P%d Q%d" % (number(2 * end_x), number(end_z), round(p * 1000), round(q * 1000))
    w.append("N20 %s %s F%s" % (name, words, number(feed)))
    at = z if along_x else r
    places = [round(at - k * step, 3) for k in range(count + 1)] + ([far] if rest else [])
    return {"groove": along_x, "start": (r, z), "deep": deep, "places": places, "peck": peck, "feed": feed, "rough": 20, "two": two}


def thread(rng, spec, kind, g, w):
    r, z = round(rng.uniform(12, 25), 2), 4.0
    height, lead, end = rng.choice((0.9, 1.2, 1.534)), rng.choice((1.5, 2.0)), -round(rng.uniform(15, 50), 2)
    first, least, allow = rng.choice((0.25, 0.35)), 0.05, 0.02
    root = round(r - 1.0 - height, 3)
    w.append("N5 G0 X%s Z%s" % (number(2 * r), number(z)))
    w.append("N10 %s P010000 Q%d R%s" % (g("G76"), round(least * 1000), number(allow)))
    words = "X%s Z%s P%d Q%d F%s" % (number(2 * root), number(end), round(height * 1000), round(first * 1000), number(lead))
    w.append("N20 %s %s" % (g("G76"), words))
    return {"thread": (z, end), "root": root, "height": height, "first": first, "least": least, "allow": allow, "lead": lead, "rough": 20, "start": (r, z)}


def hole(rng, spec, kind, g, w):
    z, end, level = 5.0, -round(rng.uniform(8, 40), 2), round(rng.uniform(1, 3), 2)
    w.append("N5 G0 X0. Z%s" % number(z))
    to_level = number(level - z) if spec["system"] == "A" else number(level)
    feed = rng.choice((0.1, 0.15)) if kind == "hole" else rng.choice((1.0, 1.5))
    text = "G83" if kind == "hole" else "G84"
    peck = rng.choice((0, 3.0)) if kind == "hole" else 0
    w.append("N20 %s X0. Z%s R%s%s F%s" % (text, number(end), to_level, " Q%d" % round(peck * 1000) if peck else "", number(feed)))
    w.append("N30 G80")
    return {"hole": (0.0, level, end), "along": "z", "feed": feed, "rough": 20, "whole": kind == "tap", "start": (0.0, z)}


def side(rng, spec, kind, g, w):
    """G87: a hole towards the axis, at the side."""
    r, z = round(rng.uniform(25, 30), 2), -round(rng.uniform(5, 30), 2)
    level, end = round(r - rng.uniform(1, 3), 2), round(r - rng.uniform(8, 12), 2)
    w.append("N5 G0 X%s Z%s" % (number(2 * r), number(z)))
    to_level = number(level - r) if spec["system"] == "A" else number(2 * level)
    w.append("N20 G87 Z%s X%s R%s F0.1" % (number(z), number(2 * end), to_level))
    w.append("N30 G80")
    return {"hole": (z, level, end), "along": "x", "feed": 0.1, "rough": 20, "whole": False, "start": (r, z)}
