"""Random mills as profiles and random contours under G41 or G42, by seed and number."""

import math
import random

import numpy as np

from common.profile import Profile, column
from common.words import number

CHAINS = ("[w X Y b Z t]", "[w Y b X Z t]", "[w b X Y Z t]", "[w Y X b Z t]")


def mill(rng, state):
    crooked = state == "crooked"
    spec = {"state": state, "chain": rng.choice(CHAINS), "tables": {}, "dialect": rng.choice(("linuxcnc", "linuxcnc", "fanuc"))}
    for k in "XYZ" if crooked else "":
        at = np.linspace(-400, 400, rng.choice((17, 33, 65)))
        rows = np.zeros((len(at), 6))
        for n in range(6):
            for wave in (1, 3, 7):
                rows[:, n] += rng.gauss(0, rng.choice((4, 15))) / wave**0.5 * np.sin(wave * at / 130 + rng.uniform(0, 6))
        if rng.random() < 0.85:
            spec["tables"][k] = {"at": at.tolist(), "rows": np.round(rows, 2).tolist()}
    spec["squareness"] = {k: round(rng.gauss(0, 60), 1) if crooked else 0.0 for k in ("EC0Y", "EB0Z", "EA0Z")}
    spec["resolution"] = rng.choice((0.001, 0.001, 0.0001))
    spec["tolerance"] = rng.choice((1.0, 1.0, 2.0, 5.0))
    spec["radius"] = rng.choice((1.5, 3.0, 4.0, 5.0, 6.0, 8.0))
    spec["length"] = round(rng.uniform(60, 150), 3)
    spec["offset"] = [round(rng.uniform(-150, 150), 3) for _ in range(3)]
    return spec


def profile(spec, folder, radius_key=None):
    """Writes the profile. `radius_key`: what the command calls the radius of a mill's tool in [tool], if it knows one."""
    p = Profile("Compensation (invented)", spec["dialect"], spec["chain"])
    for k in "XYZ":
        p.axis(k).update(travel_mm=[-400, 400], resolution_mm=spec["resolution"])
    for k, data in spec["tables"].items():
        p.errors(k, data["at"], data["rows"])
    p["squareness"].update({column(k): v for k, v in spec["squareness"].items()})
    p["tool"]["lengths_mm"] = {"H1": spec["length"]}
    if radius_key:
        p["tool"][radius_key] = {("D1" if radius_key.startswith(("radii", "diam")) else "H1"): spec["radius"]}
    p["work_offsets_mm"]["G54"], p["correction"]["tolerance_um"] = spec["offset"], spec["tolerance"]
    return p.write(folder)


def outline(rng, r):
    """Corners of a closed outline, counterclockwise, edges long against the tool; and the corners to be rounded."""
    while True:
        n = rng.randint(3, 7)
        size = rng.uniform(7, 14) * r
        corners = []
        for k in range(n):
            angle = 2 * math.pi * (k + rng.uniform(-0.25, 0.25)) / n
            corners.append(size * rng.uniform(0.6, 1.2) * np.array([math.cos(angle), math.sin(angle)]))
        corners = np.round(np.array(corners) + [rng.uniform(-20, 20), rng.uniform(-20, 20)], 2)
        way = np.roll(corners, -1, axis=0) - corners
        size = np.linalg.norm(way, axis=1)
        way /= size[:, None]
        turns = [math.atan2(way[k - 1][0] * way[k][1] - way[k - 1][1] * way[k][0], way[k - 1] @ way[k]) for k in range(n)]
        # No corner sharper than 50 degrees, none that a control takes for straight or for acute by a hair.
        if size.min() > 7 * r and all(0.15 < abs(x) < 2.2 and abs(abs(x) - math.pi / 2) > 0.05 for x in turns):
            return corners, turns


def case(seed, n):
    rng = random.Random("compensation %d %d" % (seed, n))
    spec = mill(rng, "perfect" if n % 12 == 7 else "crooked")
    fanuc, r = spec["dialect"] == "fanuc", spec["radius"]
    lines = ["G21 G17 G90 G40 G54 G94", "T1 M6", "S3000 M3", "G43 H1 G0 X%s Y%s Z50." % (number(rng.uniform(-50, 50)), number(rng.uniform(-50, 50)))]
    for _ in range(rng.randint(1, 2)):
        contour(rng, spec, lines, r, fanuc)
    lines += ["G49", "M30"] if fanuc else ["M2"]
    text = "\n".join("N%d %s" % (10 * k + 10, x) for k, x in enumerate(lines))
    return spec, "%%\n%s%s\n%%\n" % ("O1200\n" if fanuc else "", text)


def contour(rng, spec, lines, r, fanuc):
    corners, turns = outline(rng, r)
    if rng.random() < 0.5:
        corners = corners[::-1]
        turns = [-x for x in turns[::-1]]
    m = len(corners)
    left = rng.random() < 0.5
    s = 1.0 if left else -1.0
    rounded = [rng.random() < 0.35 for _ in range(m)]
    # Where a line ends and the next begins at each corner; the arc between them is tangent to both.
    blocks = []
    way = [corners[(k + 1) % m] - corners[k] for k in range(m)]
    way = [x / np.linalg.norm(x) for x in way]
    start = (corners[0] + corners[1]) / 2
    start = np.round(start, 3)
    for k in [*range(1, m), 0]:
        corner, before, behind, turn = corners[k], way[k - 1], way[k], turns_at(way, k)
        if rounded[k]:
            radius = round(rng.uniform(1.4, 2.0) * r, 2)
            cut = radius * math.tan(abs(turn) / 2)
            if cut < 2.4 * r:
                p, q = corner - cut * before, corner + cut * behind
                normal = np.array([-before[1], before[0]]) * math.copysign(1, turn)
                centre = p + radius * normal
                blocks.append(("line", np.round(p, 3)))
                blocks.append(("arc", np.round(q, 3), turn > 0, np.round(centre - np.round(p, 3), 4), radius))
                continue
        blocks.append(("line", corner))
    blocks.append(("line", start))
    t = way[0]
    n = s * np.array([-t[1], t[0]])
    lead = np.round(start + 2.5 * r * n - 1.5 * r * t, 3)
    leave = np.round(start + 2.5 * r * n + 1.5 * r * t, 3)
    deep = -rng.choice((1.0, 2.5, 4.0))
    lines += ["G0 X%s Y%s" % (number(lead[0]), number(lead[1])), "G0 Z2.", "G1 Z%s F200" % number(deep)]
    code = "G41" if left else "G42"
    if not fanuc and rng.random() < 0.4:
        code = "%s.1 D%s" % (code, number(2 * r))
    else:
        code += " D1"
    lines.append("%s G1 X%s Y%s F%d" % (code, number(start[0]), number(start[1]), rng.randint(200, 900)))
    ramp = rng.random() < 0.2
    depth = deep
    for one in blocks:
        words = "X%s Y%s" % (number(one[1][0]), number(one[1][1]))
        if one[0] == "line":
            if ramp:
                depth = round(depth - 0.1, 2)
                words += " Z" + number(depth)
            lines.append("G1 " + words)
        elif rng.random() < 0.5:
            lines.append("G%d %s I%s J%s" % (3 if one[2] else 2, words, number(one[3][0], 4), number(one[3][1], 4)))
        else:
            lines.append("G%d %s R%s" % (3 if one[2] else 2, words, number(one[4])))
    lines += ["G40 G1 X%s Y%s" % (number(leave[0]), number(leave[1])), "G0 Z50."]


def turns_at(way, k):
    a, b = way[k - 1], way[k]
    return math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)
