"""Random contours under G41 or G42, by seed and number: three planes, several depths, plunges, every way on and off."""

import math
import pathlib
import random
import sys

import numpy as np

from common.words import number

from blocks import PLANES
from control import left_of

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "shop"))
import machine as machines  # noqa: E402

DIALECTS = ("linuxcnc", "linuxcnc", "fanuc", "haas", "sinumerik")


class Case:
    def __init__(self, seed, n, dialect=None):
        rng = random.Random("cutter radius %d %d" % (seed, n))
        self.rng, self.number, self.dialect = rng, n, dialect or rng.choice(DIALECTS)
        self.good = rng.random() < 0.65
        length, angle = (2.0, 4.0) if self.good else (8.0, 20.0)
        at = np.linspace(-machines.TRAVEL, machines.TRAVEL, rng.choice((19, 37)))
        self.spec = {
            "chain": rng.choice(machines.CHAINS),
            "tables": {k: machines.table(rng, at, length, angle) for k in "XYZ"},
            "squareness": {k: round(rng.gauss(0, 2 * angle), 1) for k in ("EC0Y", "EB0Z", "EA0Z")},
            "rotary": {},
            "play": {},
            "resolution": rng.choice((0.001, 0.001, 0.0001)),
            "tolerance": rng.choice((1.0, 2.0)),
            "lengths": {"H1": round(rng.uniform(60, 140), 3)},
            "radius": rng.choice((1.5, 3.0, 4.0, 6.0)),
            "radius_known": rng.random() < 0.6 and self.dialect != "sinumerik",
        }
        self.offset = [round(rng.uniform(-120, 120), 3) for _ in range(3)]
        self.machine = machines.Machine(self.spec)
        self.plane = rng.choice((17, 17, 18) if self.dialect == "linuxcnc" else (17, 18, 19))
        self.side, self.lines, self.what = rng.choice((-1, 1)), [], set()
        self.head()
        for k in range(rng.randint(1, 2)):
            self.contour(k == 0)
        self.lines += ["M2" if self.dialect == "linuxcnc" else "M30"]
        numbered = ["N%d %s" % (10 * k + 10, x) for k, x in enumerate(self.lines)]
        top = {"linuxcnc": ["%"], "sinumerik": ["%_N_CONTOUR_MPF"]}.get(self.dialect, ["%", "O0077"])
        self.text = "\n".join(top + numbered + (["%"] if self.dialect != "sinumerik" else [])) + "\n"

    def words(self, u=None, v=None, w=None):
        """Places of the plane's first and second axis and of the one across it, in the order X Y Z."""
        found = {"XYZ"[n]: x for n, x in zip(PLANES[self.plane], (u, v, w)) if x is not None}
        return " ".join(k + number(found[k]) for k in "XYZ" if k in found)

    def head(self):
        units = {"linuxcnc": "G21 G%d G90 G94 G54 G40", "sinumerik": "G71 G%d G90 G94 G54 G40"}.get(
            self.dialect, "G21 G%d G90 G94 G54 G40 G49 G80"
        )
        self.lines += [units % self.plane] + ([] if self.dialect == "sinumerik" else ["T1 M6"]) + ["S3000 M3"]

    # -- one contour

    def outline(self):
        """Corners of a closed outline, edges long against the tool."""
        rng, r = self.rng, self.spec["radius"]
        while True:
            n, size = rng.randint(3, 6), rng.uniform(8, 14) * r
            turn = [2 * math.pi * (k + rng.uniform(-0.25, 0.25)) / n for k in range(n)]
            corners = np.round(
                [[size * rng.uniform(0.55, 1.2) * math.cos(t), size * rng.uniform(0.55, 1.2) * math.sin(t)] for t in turn], 2
            )
            corners = corners[:: rng.choice((-1, 1))] + np.round([rng.uniform(-20, 20), rng.uniform(-20, 20)], 2)
            way = np.roll(corners, -1, axis=0) - corners
            size = np.linalg.norm(way, axis=1)
            way /= size[:, None]
            turns = [math.atan2(way[k - 1][0] * way[k][1] - way[k - 1][1] * way[k][0], way[k - 1] @ way[k]) for k in range(n)]
            if size.min() > 8 * r and all(0.15 < abs(x) < 2.0 and abs(abs(x) - math.pi / 2) > 0.05 for x in turns):
                return corners, way, turns

    def round_trip(self):
        """[(end, centre or None, counterclockwise)] from the middle of the first edge back to it, and that edge's way."""
        rng, r = self.rng, self.spec["radius"]
        corners, way, turns = self.outline()
        n, out = len(corners), []
        for k in [*range(1, n), 0]:
            here, turn = corners[k], turns[k]
            choice = rng.random()
            if choice < 0.35:
                radius = round(rng.uniform(1.5, 2.0) * r, 2)
                cut = radius * math.tan(abs(turn) / 2)
                if cut < 2.4 * r:
                    start, end = np.round(here - cut * way[k - 1], 3), np.round(here + cut * way[k], 3)
                    middle = start + radius * left_of(way[k - 1]) * math.copysign(1, turn)
                    out += [(start, None, True), (end, np.round(middle, 3), turn > 0)]
                    continue
            elif choice < 0.5 and k > 1:
                # The edge as a flat arc: its corners are no tangents.
                a = out[-1][0]
                chord = here - a
                left, bow = rng.random() < 0.5, rng.uniform(0.03, 0.1)
                height = np.linalg.norm(chord) * (0.125 / bow - bow / 2)
                out.append((here, np.round(a + chord / 2 + (1 if left else -1) * height * left_of(chord) / np.linalg.norm(chord), 3), left))
                self.what.add("corners beside arcs")
                continue
            out.append((here, None, True))
        start = np.round((corners[0] + corners[1]) / 2, 3)
        return out + [(start, None, True)], start, way[0]

    def contour(self, first):
        rng, r, say = self.rng, self.spec["radius"], self.lines.append
        blocks, start, t = self.round_trip()
        n = self.side * left_of(t)
        behind = rng.random() < 0.25
        across, along = (-rng.uniform(0.3, 1.5), 3) if behind else (rng.uniform(2, 3.5), rng.uniform(-0.5, 2.5))
        on = np.round(start + across * r * n - along * r * t, 3)
        off = np.round(start + across * r * n + along * r * t, 3)
        self.what.add("led on from behind" if behind else "led on from the tool's side")
        depth = -rng.choice((1.0, 2.5, 6.0))
        clear = (on[0], on[1], 20.0)
        if first:
            x, y, z = self.words(*clear).split()
            self.lines += ["G0 %s %s" % (x, y), ("G0 " if self.dialect == "sinumerik" else "G43 H1 ") + z]
        else:
            self.lines += ["G0 " + self.words(w=20.0), "G0 " + self.words(*clear[:2])]
        say("G0 " + self.words(w=2.0))
        self.start_up(start, depth)
        self.around(blocks, start, depth)
        for _ in range(rng.choice((0, 0, 1, 2))):
            depth = round(depth - rng.choice((0.5, 1.5)), 3)
            say("G1 %s F150" % self.words(w=depth))
            self.around(blocks, start, depth)
            self.what.add("several depths")
        self.cancel(off)

    def code(self):
        return "G41" if self.side > 0 else "G42"

    def start_up(self, start, depth):
        rng, d = self.rng, "" if self.dialect == "sinumerik" else " D1"
        kind = rng.choice(("plunge first", "alone", "plunge under it", "plunge on the way"))
        if kind == "plunge under it" and self.dialect == "linuxcnc":
            kind = "plunge on the way"  # LinuxCNC does not start with a motion of the third axis alone
        self.what.add("start-up: " + kind)
        down, there = "G1 %s F150" % self.words(w=depth), "G1 %s F400" % self.words(*start)
        g = self.code() + d
        self.lines += {
            "plunge first": [down, "%s %s" % (g, there)],
            "alone": [down, g, there],
            "plunge under it": [g, down, there],
            "plunge on the way": ["%s %s" % (g, there), down],
        }[kind]

    def around(self, blocks, start, depth):
        rng, at, level = self.rng, start, depth
        for (end, centre, left), (_, ahead, _) in zip(blocks, blocks[1:] + blocks[:1]):
            words = self.words(*end)
            if centre is None:
                self.lines.append("G1 " + words)
            else:
                i, j = centre - at
                letters = ["IJK"[n] for n in PLANES[self.plane][:2]]
                self.lines.append("G%d %s %s" % (3 if left else 2, words, " ".join(k + number(x) for k, x in sorted(zip(letters, (i, j))))))
            at = end
            # Where arcs all but touch, micrometres of the contour move the centre's corner by more, along its way: no step there.
            flat = "corners beside arcs" in self.what and not (centre is None and ahead is None)
            if rng.random() < 0.12 and end is not blocks[-1][0] and not flat:
                level = round(level - 0.5, 3) if level == depth else depth
                self.lines.append("G1 %s" % self.words(w=level))
                self.what.add("a step at a corner")

    def cancel(self, off):
        kind = self.rng.choice(
            (
                "with the motion",
                "alone, then a retract",
                "alone, then the motion",
                "retract under it",
                "alone, retract by feed, next contour",
            )
        )
        self.what.add("cancel: " + kind.split(", next")[0])
        away = self.words(*off)
        self.lines += {
            "with the motion": ["G40 G1 " + away],
            "alone, then a retract": ["G40", "G1 %s F300" % self.words(w=5.0), "G0 " + self.words(w=20.0), "G0 " + away],
            "alone, then the motion": ["G40", "G1 " + away],
            "retract under it": ["G0 " + self.words(w=20.0), "G40 G0 " + away],
            "alone, retract by feed, next contour": ["G40", "G1 %s F300" % self.words(w=20.0), "G1 %s F900" % away],
        }[kind]
        self.lines.append("G0 " + self.words(w=20.0))
