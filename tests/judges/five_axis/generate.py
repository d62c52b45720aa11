"""Random crooked five-axis machines, and programs for them. A pair is given by seed and number alone.

`pair(seed, number)` -> (chain, kind, spec, text). `spec` is a plain dictionary in mm, degrees, um and urad as profiles have them:
chain, control, axes {X: travel, resolution, table (nodes, rows of 6), backlash_um}, squareness_urad (EC0Y, EB0Z, EA0Z),
rotary {A: centre, travel, table, table_negative, backlash_urad, location {EY0A: ...}, tilt, direction, resolution},
control_centres, tool, lengths, offset, tolerance_um, tcp (codes or None).
"""

import math
import random

import numpy as np

from common.profile import Profile

import planes
from machine import LOCATIONS, UNIT, Machine

CHAINS = {
    "table-table-ac": ["[w C A b X Y Z t]", "[w C A Y b X Z t]", "[w C A X Y b Z t]"],
    "table-table-bc": ["[w C B b X Y Z t]", "[w C B Y b X Z t]"],
    "head-table": ["[w C b X Y Z B t]", "[w A b X Y Z B t]", "[w C Y b X Z A t]"],
    "head-head": ["[w b X Y Z C B t]", "[w X b Y Z C A t]", "[w b Y X Z A B t]"],
    "nutating": ["[w b X Y Z C B t]", "[w C b X Y Z B t]"],
}
KINDS = ["indexed", "indexed-arcs", "cam", "cam-tcp", "long", "long-tcp", "rotary-only", "g93", "g93-tcp", "winding", "singular-tcp"]
# Asked for by name: tilted working planes.
PLANE_KINDS = ["plane", "plane-g53"]
# Directions as vectors: I J K under G43.5, A3 B3 C3 under TRAORI.
VECTOR_KINDS = ["cam-vector-tcp", "long-vector-tcp", "g93-vector-tcp"]


def smooth(rng, nodes, size, period):
    """A smooth function at the nodes: three harmonics."""
    out = np.zeros(len(nodes))
    for n in (1, 2, 3):
        out += rng.uniform(-1, 1) / n * np.sin(2 * math.pi * n * np.array(nodes) / period + rng.uniform(0, 7))
    return size * out / 1.5


def table(rng, low, high, count, um, urad, period):
    nodes = [round(low + (high - low) * k / (count - 1), 4) for k in range(count)]
    columns = [smooth(rng, nodes, um, period) for _ in range(3)] + [smooth(rng, nodes, urad, period) for _ in range(3)]
    return nodes, np.round(np.stack(columns, axis=1), 3).tolist()


def loosened(rng, one, direction):
    """Play for a rotary axis: a reversal value, or a second table apart by one about its line, and by a little elsewhere."""
    urad = rng.choice([10.0, 30.0, 60.0])
    if "table" not in one or rng.random() < 0.5:
        one["backlash_urad"] = urad
        return
    nodes, rows = one["table"]
    aside = [rng.uniform(-1, 1) for _ in range(3)] + [rng.uniform(-3, 3) for _ in range(3)]
    along = np.array([0, 0, 0, *(urad * direction / np.linalg.norm(direction))])
    one["table_negative"] = nodes, np.round(np.array(rows) + aside + along, 3).tolist()


def machine(rng, chain, control, has):
    """A spec. `has(key)`: whether the command's profiles know a key that today's may lack."""
    text = rng.choice(CHAINS[chain])
    spec = {"chain": text, "control": control, "axes": {}, "rotary": {}, "tolerance_um": rng.choice([1.0, 1.0, 2.0, 5.0]), "tool": [0, 0, 0]}
    play = rng.random() < 0.25
    for name in "XYZ":
        one = {"travel": [-700, 700], "resolution": 0.001}
        if rng.random() < 0.85:
            one["table"] = table(rng, -700, 700, rng.choice([8, 29, 71]), rng.choice([5, 15, 30]), rng.choice([5, 15, 40]), rng.choice([900, 1400, 2800]))
        if play and rng.random() < 0.7:
            one["backlash_um"] = rng.choice([1.5, 4.0, 8.0])
        spec["axes"][name] = one
    spec["squareness_urad"] = [round(rng.uniform(-60, 60), 1) for _ in range(3)]
    parsed = text.strip("[] ").split()
    heads = parsed[parsed.index("Z") :] if False else [x for x in parsed[max(parsed.index(c) for c in "XYZ") :] if x in "ABC"]
    for name in [x for x in parsed if x in "ABC"]:
        head = name in heads
        spin = name == "C" or (name == "A" and "B" in parsed and not head)
        one = {"travel": [-1080, 1080] if spin else [-110, 110], "resolution": 0.001}
        one["centre"] = [round(rng.uniform(-3, 3), 3) for _ in range(3)] if head else [round(rng.uniform(-60, 60), 3), round(rng.uniform(-60, 60), 3), round(rng.uniform(-120, -20), 3)]
        if head and chain == "head-head" and rng.random() < 0.5:
            one["centre"] = [0, 0, 0]
        if rng.random() < 0.6:
            low, high = one["travel"]
            one["table"] = table(rng, low, high, int((high - low) / 10) + 1, rng.choice([3, 10]), rng.choice([5, 20, 40]), 360)
        one["location"] = {k: round(rng.uniform(-1, 1) * (50 if k[1] in "XYZ" else 80), 2) for k in LOCATIONS[name]}
        if has("tilt"):
            one["tilt"] = rng.choice(["body", "axis"])
        if chain == "nutating" and name == "B":
            one["direction"] = rng.choice([[0, 1, 1], [0, 1, -1], [0, -1, 1]])
        elif has("direction") and head and name == "B" and rng.random() < 0.5:
            one["direction"] = [0, -1, 0]  # 5axiskins turns B this way
        if play and has("backlash_urad") and rng.random() < 0.7:
            loosened(rng, one, np.array(one.get("direction", UNIT[name]), float))
        spec["rotary"][name] = one
    if chain.startswith("table-table"):
        # Most tables' axes nearly meet.
        a, c = [x for x in parsed if x in "ABC"][1], "C"
        for i in range(3):
            spec["rotary"][c]["centre"][i] = round(spec["rotary"][a]["centre"][i] + rng.uniform(-5, 5), 3)
    length = round(rng.uniform(60, 180), 3)
    spec["lengths"] = {"H1": length}
    if control == "sinumerik":
        spec["tool"], spec["lengths"] = [0, 0, 0], {}
    spec["offset"] = [round(rng.uniform(-40, 40), 3) for _ in range(3)]
    return spec


class Writer:
    """Collects blocks; places are tips in the workpiece and angles, words what the dialect and TCP make of them."""

    def __init__(self, spec, tcp):
        self.spec, self.tcp, self.lines = spec, tcp, []
        self.ideal = Machine(spec, perfect=True)
        self.length = spec["lengths"].get("H1", 0.0)
        self.vector = np.array([0, 0, -self.length]) if spec["lengths"] else np.array(spec["tool"], float)
        self.last = {}
        self.vectors = False

    def command(self, tip, rot):
        return self.ideal.joints(np.array(tip), np.array(rot), self.vector)[0]

    def numbers(self, tip, rot):
        offset = np.array(self.spec["offset"])
        x = np.array(tip) - offset if self.tcp else self.command(tip, rot) - offset - [0, 0, self.length]
        if self.vectors:
            names = ("A3", "B3", "C3") if self.spec["control"] == "sinumerik" else "IJK"
            return {**dict(zip("XYZ", x)), **dict(zip(names, self.ideal.place(np.zeros((1, 3)), np.array([rot], float), np.zeros(3))[1][0]))}
        return {**dict(zip("XYZ", x)), **dict(zip(self.ideal.rotary, rot))}

    def block(self, code, tip, rot, only=None, more="", repeat=False):
        words = []
        numbers = self.numbers(tip, rot)
        vector = [k for k in numbers if k not in "XYZABC"]
        turned = any(self.last.get(k) != f"{numbers[k]:.9f}" for k in vector)
        for k, v in numbers.items():
            if k in vector:
                if turned and only is None:
                    words.append(f"{k}={v:.9f}" if k in ("A3", "B3", "C3") else f"{k}{v:.9f}")
                    self.last[k] = f"{v:.9f}"
                continue
            text = f"{v:.3f}".rstrip("0").rstrip(".") if self.spec["control"] != "fanuc" else f"{v:.3f}".rstrip("0")
            text = "0" + ("." if self.spec["control"] == "fanuc" else "") if text.strip("-.0") == "" else text
            if (only is None or k in only) and (repeat or self.last.get(k) != text):
                words.append(f"{k}={text}" if self.spec["control"] == "sinumerik" and k in "ABC" else k + text)
                self.last[k] = text
        if words:
            self.lines.append(" ".join([code] + words) + more)
        return bool(words)


def start(w):
    c = w.spec["control"]
    w.lines += {"linuxcnc": ["G21 G17 G90 G94 G40 G54", "T1 M6", "S5000 M3"], "fanuc": ["%", "O0007", "G21 G17 G90 G94 G40 G54", "S5000 M03"], "sinumerik": ["G710 G17 G90 G94 G40", "G54", "S5000 M3"]}[c]


def on(w, tip, rot):
    """To a safe place at angles 0, then TCP on where it is used. Every axis moves far, so its play is known."""
    names = w.ideal.rotary
    tcp, w.tcp = w.tcp, False
    c = w.spec["control"]
    zero = [0.0] * len(names)
    length = "" if c == "sinumerik" else ("G43 H1 " if c == "linuxcnc" or not tcp else "")
    far = np.array(tip) + [-90, -80, 120]
    if w.vectors:
        # From where a direction says all: not along the axis that turns about the tool.
        zero = [float(v) for v in rot]
    vectors, w.vectors = w.vectors, False
    w.block(f"G0 {length}".strip(), far, zero, repeat=True) if length else w.block("G0", far, zero, repeat=True)
    if c == "fanuc" and tcp:
        # Without G43 the command is word + offset; G43.4 keeps the axes standing.
        w.lines.pop()
        short = w.length
        w.length = 0.0
        w.last = {}
        w.block("G0", far, zero, repeat=True)
        w.length = short
    w.tcp, w.vectors = tcp, vectors
    w.last = {}
    if tcp:
        w.lines.append({"linuxcnc": "M428", "fanuc": ("G43.5" if vectors else w.spec.get("tcp_code", "G43.4")) + " H1", "sinumerik": "TRAORI"}[c])
    w.lines.append("M8")
    up = np.array(tip) + [30, 25, 60]
    w.block("G0", up, rot, repeat=True)
    w.block("G0", np.array(tip) + [3, 3, 8], rot)
    w.block("G0", np.array(tip) + [0.5, 0.5, 3], rot)


def off(w):
    c = w.spec["control"]
    w.lines.append("M9")
    if w.tcp:
        w.lines.append({"linuxcnc": "M429", "fanuc": "G49", "sinumerik": "TRAFOOF"}[c])
    w.lines += ["M5", "M30"] + (["%"] if c == "fanuc" else [])


def tilts(w, rng, large=60):
    """Random angles within travel: (tilt, turn) by each axis' travel."""
    out = []
    for k in w.ideal.rotary:
        low, high = w.spec["rotary"][k]["travel"]
        out.append(round(rng.uniform(max(low, -large), min(high, large)), 3) if high < 200 else round(rng.uniform(-180, 180), 3))
    return np.array(out)


def base(w, rng):
    centres = [w.spec["rotary"][k]["centre"] for k in w.ideal.table]
    middle = np.mean(centres, axis=0) if centres else np.zeros(3)
    return middle + [rng.uniform(-60, 60), rng.uniform(-60, 60), rng.uniform(20, 90)]


def tilted(w, rng, kind):
    """Cuts in tilted planes, in the planes' own coordinates: lines, arcs, holes; the angles programmed before, or by G53.1."""
    names, spec = w.ideal.rotary, w.spec
    zero, offset = [0.0] * len(names), np.array(spec["offset"])
    length, w.length, vector, w.vector = w.length, 0.0, w.vector, np.zeros(3)
    now = np.zeros(len(names))
    dot = lambda v: f"{v:.3f}" if abs(v) > 5e-4 else "0."  # noqa: E731
    fine = lambda v: f"{v:.9f}"  # noqa: E731
    for _ in range(rng.choice([1, 2, 3])):
        origin = np.round(base(w, rng) - offset, 3)
        while True:
            form = rng.choice([0, 0, 1, 2, 3])
            blocks = define(form, origin, rng, dot, fine)
            parts = {}
            for words in blocks:
                parts[int(words.get("Q", 0)) if form in (2, 3) else 0] = {"P": form, **{k: float(v) for k, v in words.items()}}
            turn, _ = planes.plane(parts, 1.0)
            if kind == "plane-g53":
                try:
                    rot = planes.by_rule(w.ideal, turn[:, 2], now, spec)
                except ValueError:
                    continue
                break
            fits = [s for s in planes.solutions(w.ideal, turn[:, 2]) if all(planes.turns(v, spec["rotary"][k]["travel"]) for v, k in zip(s, names))]
            if fits and np.linalg.norm(np.cross(turn[:, 2], [0, 0, 1])) > 0.02:
                rot = np.array([rng.choice(planes.turns(v, spec["rotary"][k]["travel"])) if kind == "plane" and rng.random() < 0.2 else planes.turns((v + 180) % 360 - 180, spec["rotary"][k]["travel"])[0]
                                for v, k in zip(rng.choice(fits), names)])
                break
        w.last = {}
        w.block("G0", origin + offset + [-60, -50, 220], zero if kind == "plane" else now, repeat=True)
        if kind == "plane":
            now = np.round(rot, 6)
            w.lines.append("G0 " + " ".join(f"{k}{v:.6f}" for k, v in zip(names, now)))
        w.lines += ["G68.2" + (f" P{form}" if form or rng.random() < 0.3 else "") + "".join(f" {k}{v}" for k, v in words.items()) for words in blocks]
        if kind == "plane-g53":
            w.lines.append("G53.1")
            now = rot
        cut(w, rng, dot)
        w.lines += rng.choice([["G49", "G69"], ["G69", "G49"]])
    w.lines += ["M5", "M30", "%"]
    w.length, w.vector = length, vector


def define(form, origin, rng, dot, fine):
    """Words of the blocks that define a plane."""
    x, y, z = ({"X": dot(origin[0]), "Y": dot(origin[1]), "Z": dot(origin[2])}[k] for k in "XYZ")
    place = {"X": x, "Y": y, "Z": z}
    some = lambda low, high: rng.choice([f"{rng.uniform(low, high):.6f}", f"{rng.randrange(int(low), int(high) + 1)}."])  # noqa: E731
    if form == 0:
        return [{**place, "I": some(-180, 180), "J": rng.choice([some(5, 60), some(-60, -5)]), "K": some(-180, 180)}]
    if form == 1:
        return [{"Q": rng.choice(["123", "132", "213", "231", "312", "321"]), **place, "I": some(-45, 45), "J": some(-45, 45), "K": some(-170, 170)}]
    turn = planes.about("Z", rng.uniform(-180, 180)) @ planes.about("X", rng.uniform(5, 60)) @ planes.about("Z", rng.uniform(-180, 180))
    if form == 2:
        points = [origin, origin + rng.uniform(30, 90) * turn[:, 0], origin + rng.uniform(-30, 30) * turn[:, 0] + rng.uniform(30, 90) * turn[:, 1]]
        blocks = [{"Q": str(q), **{k: dot(v) for k, v in zip("XYZ", p)}} for q, p in enumerate(points, 1)]
        return ([{"Q": "0", "X": "0.", "Y": "0.", "Z": "0.", "R": "0."}] if rng.random() < 0.5 else []) + blocks
    return [{"Q": "1", **place, **{k: fine(v) for k, v in zip("IJK", turn[:, 0])}}, {"Q": "2", **{k: fine(v) for k, v in zip("IJK", turn[:, 2])}}]


def cut(w, rng, dot):
    """Feeds in a plane's own coordinates."""
    at = np.round([rng.uniform(-40, 40), rng.uniform(-40, 40), rng.uniform(-4, 1)], 3)
    first = rng.choice([["G0 X{} Y{}", "G43 H1 Z{}"], ["G43 H1 G0 X{} Y{} Z{}"]])
    text = "\n".join(first).format(dot(at[0]), dot(at[1]), "60.")
    w.lines += text.split("\n") + ["G0 Z5.", f"G1 Z{dot(at[2])} F{rng.choice([200, 900])}."]
    for _ in range(rng.choice([3, 6])):
        if rng.random() < 0.45:
            radius, a = round(rng.uniform(3, 40), 3), rng.uniform(0, 6.3)
            centre = np.round(at[:2] + radius * np.array([math.cos(a), math.sin(a)]), 3)
            begin, real = math.atan2(at[1] - centre[1], at[0] - centre[0]), math.hypot(at[0] - centre[0], at[1] - centre[1])
            way, sweep = rng.choice([2, 3]), rng.uniform(0.3, 5)
            turn = begin + (sweep if way == 3 else -sweep)
            end = np.round(centre + real * np.array([math.cos(turn), math.sin(turn)]), 3)
            w.lines.append(f"G{way} X{dot(end[0])} Y{dot(end[1])} I{dot(centre[0] - at[0])} J{dot(centre[1] - at[1])}")
            at = np.array([end[0], end[1], at[2]])
        else:
            at = np.round(at + [rng.uniform(-60, 60), rng.uniform(-60, 60), rng.choice([0, 0, rng.uniform(-3, 3)])], 3)
            w.lines.append(f"G1 X{dot(at[0])} Y{dot(at[1])} Z{dot(at[2])}")
    w.lines.append("G0 Z40.")
    if rng.random() < 0.6:
        for n in range(rng.choice([1, 3])):
            x, y = round(rng.uniform(-50, 50), 3), round(rng.uniform(-50, 50), 3)
            w.lines.append((f"{rng.choice(['G98', 'G99'])} G81 " if n == 0 else "") + f"X{dot(x)} Y{dot(y)}" + (f" Z{dot(-rng.uniform(3, 25))} R2. F150." if n == 0 else ""))
        w.lines += ["G80", "G0 Z60."]


def program(rng, spec, kind):
    tcp = kind.endswith("tcp")
    w = Writer(spec, tcp)
    w.vectors = kind in VECTOR_KINDS
    start(w)
    if kind in PLANE_KINDS:
        tilted(w, rng, kind)
        return "\n".join(w.lines) + "\n"
    here, rot = base(w, rng), tilts(w, rng)
    if kind in ("indexed", "indexed-arcs"):
        first = True
        for _ in range(rng.choice([2, 3])):
            rot = tilts(w, rng)
            here = base(w, rng)
            q = w.command(here, rot)
            if first:
                on(w, here, rot)
                first = False
            indexed(w, rng, q, rot, kind.endswith("arcs"))
        off(w)
        return "\n".join(w.lines) + "\n"
    feed = f" F{rng.choice([300, 800, 2500])}"
    if kind == "singular-tcp":
        rot = np.array([rng.uniform(-0.5, 0.5) if spec["rotary"][k]["travel"][1] < 200 else rng.uniform(-90, 90) for k in w.ideal.rotary])
    on(w, here, rot)
    if kind.startswith("cam") or kind.startswith("g93") or kind in ("winding", "singular-tcp"):
        inverse = kind.startswith("g93")
        if inverse:
            w.lines.append("G93")
        step, swing = rng.uniform(0.3, 2.5), rng.uniform(0.1, 2.0)
        heading = rng.uniform(0, 6.3)
        rate = {k: rng.uniform(-1, 1) * swing for k in w.ideal.rotary}
        if kind == "winding":
            spinner = [k for k in w.ideal.rotary if spec["rotary"][k]["travel"][1] > 200] or w.ideal.rotary[:1]
            rate[spinner[0]] = rng.choice([-1, 1]) * (rng.uniform(9, 14) if spec["rotary"][spinner[0]]["travel"][1] > 200 else 1.0)
            rot = np.array([rot[i] if k != spinner[0] else math.copysign(170, rate[k]) for i, k in enumerate(w.ideal.rotary)]) if spec["rotary"][spinner[0]]["travel"][1] > 200 else rot
        count = rng.choice([30, 50])
        ahead = True
        for n in range(count):
            heading += rng.uniform(-0.25, 0.3)
            if n:
                here = here + step * np.array([math.cos(heading), math.sin(heading), rng.uniform(-0.3, 0.3)])
            for i, k in enumerate(w.ideal.rotary):
                low, high = spec["rotary"][k]["travel"]
                if n:
                    rot[i] += rate[k] * rng.uniform(0.6, 1.0)
                if kind == "singular-tcp" and high < 200:
                    rot[i] = 1.5 * math.sin(0.2 * n + 1) * rng.uniform(0.7, 1)
                elif abs(rot[i]) > min(high - 5, 900):
                    rot[i] -= 2 * rate[k]
                    rate[k] = -rate[k]
            more = f" F{60 * rng.uniform(8, 30) / 10:.3f}" if inverse else (feed if ahead else "")
            if w.block("G1" if ahead or inverse else "", here, np.round(rot, 3), more=more):
                ahead = False
        w.lines = [x.strip() for x in w.lines]
        if inverse:
            w.lines.append("G94")
    elif kind.startswith("long"):
        for n in range(rng.choice([3, 5])):
            if n:
                here = here + np.array([rng.uniform(-40, 40), rng.uniform(-40, 40), rng.uniform(-8, 8)])
                new = tilts(w, rng, 50)
                rot = np.where(np.abs(new - rot) > 120, rot + np.clip(new - rot, -120, 120), new)
            w.block("G1", here, np.round(rot, 3), more=feed if not n else "")
    elif kind == "rotary-only":
        w.block("G1", here, np.round(rot, 3), more=feed)
        tip = here
        q = w.command(tip, np.round(rot, 3))
        for _ in range(4):
            i = rng.randrange(len(rot))
            low, high = spec["rotary"][w.ideal.rotary[i]]["travel"]
            rot[i] += rng.choice([-1, 1]) * rng.uniform(2, 40)
            rot[i] = min(max(rot[i], low + 1), high - 1)
            name = w.ideal.rotary[i]
            w.lines.append(f"G1 {name}{'=' if spec['control'] == 'sinumerik' else ''}{rot[i]:.3f}")
            if rng.random() < 0.5:
                q = q + [rng.uniform(-6, 6), rng.uniform(-6, 6), 0]
                o = np.array(spec["offset"]) + [0, 0, w.length]
                w.lines.append("G1 X{:.3f} Y{:.3f}".format(*(q - o)[:2]))
    off(w)
    return "\n".join(w.lines) + "\n"


def indexed(w, rng, q, rot, arcs):
    """Feeds at standing rotary axes, in axis coordinates."""
    o = np.array(w.spec["offset"]) + [0, 0, w.length]
    dot = lambda v: f"{v:.3f}"  # noqa: E731
    eq = "=" if w.spec["control"] == "sinumerik" else ""
    x = q - o
    w.lines.append(f"G0 Z{dot(x[2] + 80)}")
    w.lines.append("G0 " + " ".join(f"{k}{eq}{v:.3f}" for k, v in zip(w.ideal.rotary, rot)))
    w.lines.append(f"G0 X{dot(x[0] - 20)} Y{dot(x[1] - 15)}")
    w.lines.append(f"G0 X{dot(x[0])} Y{dot(x[1])}")
    w.lines.append(f"G0 Z{dot(x[2] + 5)}")
    w.lines.append(f"G1 Z{dot(x[2])} F{rng.choice([200, 900])}")
    for _ in range(rng.choice([3, 6])):
        if arcs and rng.random() < 0.6:
            radius, a = round(rng.uniform(3, 50), 3), rng.uniform(0, 6.3)
            centre = np.round(x[:2] + radius * np.array([math.cos(a), math.sin(a)]), 3)
            sweep = rng.uniform(0.3, 5)
            begin = math.atan2(x[1] - centre[1], x[0] - centre[0])
            real = math.hypot(x[0] - centre[0], x[1] - centre[1])
            way = rng.choice([2, 3])
            turn = begin + (sweep if way == 3 else -sweep)
            end = np.round(centre + real * np.array([math.cos(turn), math.sin(turn)]), 3)
            start_ = np.round(x, 3)
            w.lines.append(f"G{way} X{dot(end[0])} Y{dot(end[1])} I{dot(centre[0] - start_[0])} J{dot(centre[1] - start_[1])}")
            x = np.array([end[0], end[1], start_[2]])
        else:
            x = np.round(x + [rng.uniform(-80, 80), rng.uniform(-80, 80), rng.choice([0, 0, rng.uniform(-4, 4)])], 3)
            w.lines.append(f"G1 X{dot(x[0])} Y{dot(x[1])} Z{dot(x[2])}")
    w.lines.append(f"G0 Z{dot(x[2] + 90)}")
    w.last = {}


def write_profile(spec, folder, has, orientation=None):
    """machine.toml and its tables; keys that the command does not know yet (`has`) are left out."""
    p = Profile("Judge", spec["control"], spec["chain"])
    for name, one in spec["axes"].items():
        p.axis(name).update(travel_mm=one["travel"], resolution_mm=one["resolution"], backlash_um=one.get("backlash_um") or None)
    p["squareness"].update(zip(("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"), spec["squareness_urad"]))
    for name, one in spec["rotary"].items():
        p.axis(name).update(centre_mm=one["centre"], travel_deg=one["travel"], backlash_urad=one.get("backlash_urad") or None)
        p.located(name, one["location"])
        if has("tilt"):
            p.axis(name)["tilt"] = one.get("tilt", "body")
        if "direction" in one and has("direction"):
            size = math.sqrt(sum(v * v for v in one["direction"]))
            p.axis(name)["direction"] = [v / size for v in one["direction"]]
        if has("resolution_deg"):
            p.axis(name)["resolution_deg"] = one["resolution"]
    for name, one in {**spec["axes"], **spec["rotary"]}.items():
        for key, under in (("table", "errors"), ("table_negative", "errors_negative")):
            if one.get(key):
                p.errors(name, *one[key], under, ".6f")
    p["tool"].update(default_mm=spec["tool"], lengths_mm=spec["lengths"] or None)
    p["work_offsets_mm"]["G54"] = spec["offset"]
    p["correction"]["tolerance_um"] = spec["tolerance_um"]
    if orientation == "full" and has("orientation_urad"):
        p["correction"]["orientation_urad"] = spec.get("orientation_urad", 20.0)
    if has("kinematics"):
        p["kinematics"].update(kinematics(spec))
    if spec["control"] == "linuxcnc":
        p["program"]["tool_change"] = {"keeps": "XYZ"}
    return str(p.write(folder, "machine.toml"))


def kinematics(spec):
    """The section on what the control computes."""
    own = {"straight": "tip", "centres_mm": spec.get("control_centres") or {k: one["centre"] for k, one in spec["rotary"].items()}}
    if spec["control"] == "linuxcnc":
        own |= {"on": ["M428"], "off": ["M429"]}
    own |= {"at_start": True} if spec.get("tcp_at_start") else {}
    own |= {"vectors": "axes"} if spec.get("vectors") else {}
    return own | ({"branch": spec["branch"], "turn": spec["turn"]} if "branch" in spec else {})


def pair(seed, number, has, chains=tuple(CHAINS), kinds=tuple(KINDS)):
    rng = random.Random(f"{seed}/{number}")
    chain, kind = chains[number % len(chains)], kinds[(number // len(chains)) % len(kinds)]
    control = "linuxcnc"
    if kind.endswith("tcp"):
        control = rng.choice(["linuxcnc", "fanuc"] + (["sinumerik"] if chain.startswith("table-table") else []))
    elif rng.random() < 0.3 or kind in PLANE_KINDS:
        control = "fanuc"
    if kind in VECTOR_KINDS:
        control = rng.choice(["fanuc", "sinumerik"] if chain.startswith("table-table") else ["fanuc"])
    spec = machine(rng, chain, control, has)
    if kind in VECTOR_KINDS:
        spec["vectors"] = True
        for one in spec["axes"].values():
            one.pop("backlash_um", None)
    if kind in PLANE_KINDS:
        for one in spec["axes"].values():
            one.pop("backlash_um", None)  # no path is proven with play
        for one in spec["rotary"].values():
            for key in ("backlash_urad", "table_negative"):
                one.pop(key, None)
    if kind == "plane-g53":
        tilt = [k for k in spec["rotary"] if spec["rotary"][k]["travel"][1] < 200][-1]
        spec.update(branch=tilt + rng.choice("+-"), turn=rng.choice(["shortest", "principal"]))
    if control == "fanuc":
        spec["tcp_code"] = rng.choice(["G43.4", "G43.4", "G234"])
    if (kind.endswith("tcp") or kind in PLANE_KINDS) and rng.random() < 0.3:
        spec["control_centres"] = {k: [round(v + rng.uniform(-0.05, 0.05), 4) for v in one["centre"]] for k, one in spec["rotary"].items()}
    return chain, kind, spec, program(rng, spec, kind)
