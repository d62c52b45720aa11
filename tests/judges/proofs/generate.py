"""Adversarial pairs of a machine and a program, by kind, from a seed.

A machine is a plain dictionary (model.py computes it, files.py writes it); a program is text. Every program starts with
one rapid in all axes from a known place (`start_at`) that is millimetres away, so that all play is settled; the kind
`unknown-side` says nothing of the start and feeds each axis to its place first; `turned` is cut in a frame of Fanuc's that
is turned (G68) or mirrored (G51.1), on axes with play.
"""

import math
import random

from files import rounded

KINDS = ("linear", "cubic", "dyadic", "effects", "backlash", "directions", "sideways", "arcs-under-play", "helices", "kinks",
         "tiny", "mixed", "unknown-side", "turned")
PLANES = {17: (0, 1, 2, "IJ"), 18: (2, 0, 1, "KI"), 19: (1, 2, 0, "JK")}
TOLERANCES = (0.5, 0.5, 1.0, 1.0, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0)
CHAINS = ("w X Y b Z t", "w X Y b Z t", "w b Z X Y t", "w Y b X Z t", "w X Y Z b t")


def table(rng, low, high, step, size, angle, wave=True):
    """A smooth or rough table: micrometres and microradians of amplitude."""
    count = max(1, round((high - low) / step))
    nodes = [low + (high - low) * k / count for k in range(count + 1)]
    if rng.random() < 0.3 and count > 2:
        nodes = [nodes[0]] + [q + rng.uniform(-0.3, 0.3) * step for q in nodes[1:-1]] + [nodes[-1]]
    columns = []
    for c in range(6):
        amplitude = size * 1e-3 if c < 3 else angle * 1e-6
        period, phase = rng.uniform(2.5, 12) * step, rng.uniform(0, 6.28)
        rough = rng.choice([0.05, 0.3])
        columns.append([amplitude * (math.sin(6.283 * (q - low) / period + phase) + rough * rng.gauss(0, 1)) for q in nodes])
    return rounded(nodes, [list(row) for row in zip(*columns)])


def minus_of(rng, plus, aside, angle):
    """A table for the other direction that differs in all columns by something smooth, and how."""
    nodes, rows = plus
    bow = [rng.uniform(-0.3, 0.3) for _ in range(6)]
    out = []
    for k, row in enumerate(rows):
        r = 2 * k / (len(rows) - 1) - 1
        shift = [(aside * 1e-3 if c < 3 else angle * 1e-6) * (bow[c] * 3 + 0.3 * bow[c] * r * r) for c in range(6)]
        out.append([v + s for v, s in zip(row, shift)])
    return nodes, out, bow


def machine(rng, kind):
    cubic = rng.random() < 0.5 if kind not in ("linear", "cubic", "dyadic") else kind != "linear"
    spec = {"control": "fanuc" if kind == "turned" else "linuxcnc", "chain": rng.choice(CHAINS), "cubic": cubic, "axes": [], "effects": [], "at": {},
            "tool": [0, 0, 0] if rng.random() < 0.4 else [rng.choice([0, 12.5]), 0, rng.choice([-120, -80, 0])],
            "tolerance_um": rng.choice(TOLERANCES), "squareness_urad": [0, 0, 0]}
    size, angle = rng.choice([3, 8, 20]), rng.choice([0, 10, 40])
    for i in range(3):
        low = rng.choice([0, -64, -150])
        high = low + rng.choice([64, 128, 150, 220])
        a = {"travel": [low, high], "resolution": 0.001}
        if rng.random() < 0.1:
            a["resolution"] = rng.choice([0.0005, 0.002, 0.0001])
        if kind != "effects" or rng.random() < 0.5:
            step = rng.choice([2, 4]) if kind == "kinks" else rng.choice([5, 10, 20, 37])
            a["errors"] = table(rng, low, high, step, size * (0.4 if step < 5 else 1), angle)
            if rng.random() < 0.3:
                a["measured_at"] = {j: rng.choice([0, 20, 50]) for j in range(3) if j != i}
                a["measured_tool"] = [0, 0, rng.choice([0, -100])]
        spec["axes"].append(a)
    spread = rng.choice([300, 300, 1200])
    if rng.random() < 0.6:
        spec["squareness_urad"] = [round(rng.uniform(-1, 1) * spread, 1) for _ in range(3)]
    if kind == "dyadic":
        dyadic(rng, spec)
    if kind in ("effects", "mixed"):
        effects(rng, spec)
    if kind in ("backlash", "arcs-under-play", "mixed", "tiny", "unknown-side", "helices", "turned"):
        play(rng, spec, 0.5 if kind in ("mixed", "tiny", "helices") else 1.0)
    if kind == "arcs-under-play":
        spec["tolerance_um"] = rng.choice([0.5, 1.0, 2.0, 2.2, 3.0, 5.0])
        for a in spec["axes"]:
            if rng.random() < 0.7:
                a["backlash_um"] = round(spec["tolerance_um"] * rng.choice([1.5, 3, 5, 10]), 2)
    if kind in ("directions", "unknown-side") or kind == "turned" and rng.random() < 0.2 or kind in ("mixed", "arcs-under-play") and rng.random() < 0.3:
        directions(rng, spec)
    if kind == "sideways" or kind in ("mixed", "turned") and rng.random() < 0.3:
        sideways(rng, spec)
    return spec


def dyadic(rng, spec):
    """Ranges that are powers of two; two axes' errors cancel where both run evenly through all of the range."""
    span = rng.choice([16, 32, 32, 64])
    spec.update(chain="w X Y b Z t", tool=[0, 0, 0], squareness_urad=[0, 0, 0], cubic=rng.random() < 0.8)
    spec["tolerance_um"] = rng.choice([1.0, 2.0, 3.0, 5.0, 10.0])
    pieces = rng.choice([2, 2, 2, 4, 8])
    nodes = [span * k / pieces for k in range(pieces + 1)]
    height = rng.choice([0.01, 0.02, 0.04, 0.06]) * spec["tolerance_um"] / 3 * span / 16
    sign = rng.choice([-1, 1])
    bow = [sign * height * (2 * q / span - 1) ** 2 for q in nodes]
    column = rng.choice([0, 1, 2])
    rows = lambda s: [[s * v if c == column else 0.0 for c in range(6)] for v in bow]  # noqa: E731
    first, second = rng.sample([0, 1, 2], 2)
    spec["axes"] = [{"travel": [0, span], "resolution": 0.001} for _ in range(3)]
    spec["axes"][first]["errors"] = rounded(nodes, rows(1))
    spec["axes"][second]["errors"] = rounded(nodes, rows(-1))


def play(rng, spec, share):
    for i in range(3):
        if rng.random() < share:
            size = rng.choice([1.0, 2.5, 4.0, 8.4, 12.0, 25.0])
            if rng.random() < 0.7:
                spec["axes"][i]["backlash_um"] = size
            else:
                low, high = spec["axes"][i]["travel"]
                one = {"id": f"backlash.{'XYZ'[i]}", "half_width_um": size / 2}
                if rng.random() < 0.5:
                    one.update(half_width_p1_um=round(rng.uniform(-0.3, 0.3) * size / 2, 3), half_width_p2_um=round(0.1 * size, 3), from_mm=low, to_mm=high)
                spec["effects"].append(one)


def directions(rng, spec):
    """`errors_negative`: reversal along the axis, smaller differences in the other columns (a tenth to all of it)."""
    aside, angle = rng.choice([0, 0, 0.2, 1, 4]), rng.choice([0, 0, 1, 5])
    for i in range(3):
        a = spec["axes"][i]
        if "errors" not in a or a.get("backlash_um") or rng.random() < 0.2:
            continue
        reversal = rng.choice([1, 3, 6, 12]) * 1e-3
        nodes, rows, bow = minus_of(rng, a["errors"], aside, angle)
        for k, row in enumerate(rows):
            row[i] = a["errors"][1][k][i] + reversal * (1 + 0.2 * bow[i] * math.sin(k))
        a["errors_negative"] = rounded(nodes, rows)


def sideways(rng, spec):
    for i in rng.sample([0, 1, 2], rng.choice([1, 1, 2])):
        j = rng.choice([k for k in range(3) if k != i])
        size = rng.choice([0.3, 0.5, 1.0, 2.0, 5.0]) * rng.choice([-1, 1])
        one = {"id": f"lost-motion.E{'XYZ'[j]}{'XYZ'[i]}", "half_width_um": size}
        if rng.random() < 0.3:
            low, high = spec["axes"][i]["travel"]
            one.update(half_width_p1_um=round(0.4 * size, 3), from_mm=low, to_mm=high)
        spec["effects"].append(one)
        if rng.random() < 0.5 and "errors_negative" not in spec["axes"][i]:
            spec["axes"][i]["backlash_um"] = rng.choice([2.0, 6.0])


def effects(rng, spec):
    spec["at"] = {"reference_c": 20.0, "temp_c": 26.0, "time_s": 1500.0, "load_kg": 80.0}
    for _ in range(rng.randint(2, 6)):
        i = rng.randrange(3)
        c, other = "XYZ"[i], "XYZ"[rng.choice([k for k in range(3) if k != i])]
        low, high = spec["axes"][i]["travel"]
        if rng.random() < 0.5:
            low, high = low + rng.uniform(0.1, 0.3) * (high - low), high - rng.uniform(0.1, 0.3) * (high - low)
        where = {"from_mm": round(low, 3), "to_mm": round(high, 3)}
        n = rng.randint(2, 7)
        size = round(rng.uniform(-8, 8), 3)
        spec["effects"].append(rng.choice([
            {"id": f"scale.{c}", "scale_um_per_m": round(rng.uniform(-200, 200), 2)},
            {"id": f"thermal.{c}", "expansion_um_per_m_k": 11.5, "shift_um_per_k": 0.4},
            {"id": f"warmup.{c}", "amplitude_um": size, "tau_s": 900.0},
            {"id": f"squareness.{rng.choice(['XY', 'XZ', 'YZ'])}", "angle_urad": round(rng.uniform(-200, 200), 2)},
            {"id": f"positioning.E{c}{c}", f"p{n}_um": size, **where},
            {"id": f"straightness.E{other}{c}", f"p{n}_um": size, "p2_um": 3.0, **where},
            {"id": f"angular.E{rng.choice('ABC')}{c}", f"p{n - 1}_urad": 5 * size, **where},
            {"id": f"pitch.{c}", "pitch_mm": rng.choice([4.0, 5.0, 10.0]), "sin1_um": round(size / 3, 3), "cos2_um": 0.4, **where},
            {"id": f"sag.{rng.choice('XY')}", "droop3_um": 12.0, **where},
            {"id": f"load.{c}", "compliance_um_per_kg": 0.05},
            {"id": f"step.{c}", "shift_um": size, "time_s": 700.0},
            {"id": f"local.{c}", "x_um": size, "y_um": 3.0, "z_um": -2.0, "centre_mm": round((low + high) / 2, 3), "width_mm": rng.choice([3.0, 12.0, 40.0])},
        ]))


class Writer:
    """Blocks of a program, in millimetres of a program frame whose zero lies in the volume."""

    def __init__(self, rng, spec, kind):
        self.rng, self.spec, self.kind = rng, spec, kind
        length = 0.0
        if rng.random() < 0.25 and kind not in ("dyadic", "turned"):
            length = rng.choice([20.0, 31.5])
            spec["lengths"] = {"H1": length}
        middle = [round((a["travel"][0] + a["travel"][1]) / 2) for a in spec["axes"]]
        spec["offset"] = [0, 0, 0] if kind == "dyadic" else [middle[0], middle[1], middle[2] - length]
        shift = [spec["offset"][0], spec["offset"][1], spec["offset"][2] + length]
        self.box = [(a["travel"][0] - s + 1.0, a["travel"][1] - s - 1.0) for a, s in zip(spec["axes"], shift)]
        self.inch = rng.random() < 0.04 and kind != "turned"
        self.unit, self.decimals = (25.4, 4) if self.inch else (1.0, 3)
        self.incremental, self.plane, self.mode = False, 17, None
        self.lines = [f"{'G20' if self.inch else 'G21'} G17 G90 G94 G54"] + (["G43 H1"] if length else [])
        corner = [self.grid(low + 0.2) if rng.random() < 0.5 else self.grid(high - 0.2) for low, high in self.box]
        self.start_at = [round(c + s, 6) for c, s in zip(corner, shift)] if kind != "unknown-side" else None
        self.at = corner
        first = [self.grid(rng.uniform(low + 8, high - 8)) for low, high in self.box]
        if self.start_at and any(abs(a - b) < 1 for a, b in zip(first, corner)):
            first = [self.grid((low + high) / 2) for low, high in self.box]
        self.move(0, first, "XYZ")
        self.lines.append("F500" if not self.inch else "F20")
        self.ends = []
        if kind == "unknown-side":
            for i in range(3):
                self.step(i, rng.choice([-1, 1]) * 0.5)
        if kind == "turned":
            self.turn()

    def turn(self):
        """Turns or mirrors the frame about the middle of the volume, and goes to a place in it."""
        rng = self.rng
        middle = [self.grid((low + high) / 2) for low, high in self.box[:2]]
        reach = 0.68 * min((high - low) / 2 for low, high in self.box[:2])
        self.box = [(m - reach, m + reach) for m in middle] + self.box[2:]
        about = [f"X{self.number(middle[0])}", f"Y{self.number(middle[1])}"]
        if rng.random() < 0.3:
            about = about if rng.random() < 0.4 else [rng.choice(about)]
            self.lines.append("G51.1 " + " ".join(about))
            self.ends = ["G50.1 " + " ".join(word[0] + "0" for word in about)]
        else:
            angle = rng.choice([90, 180, -90, 270, 30, 45, -60, rng.uniform(0, 360), rng.uniform(0, 360), rng.uniform(-3, 3), rng.uniform(-0.05, 0.05)])
            self.lines.append(f"G68 {' '.join(about)} R{angle:.3f}")
            self.ends = ["G69"]
        self.move(0, [self.grid(rng.uniform(low, high)) for low, high in self.box], "XYZ")

    def grid(self, mm):
        return round(mm / self.unit, self.decimals) * self.unit

    def number(self, mm):
        text = f"{mm / self.unit:.{self.decimals}f}"
        return "0" if float(text) == 0 else text

    def inside(self, to):
        return all(low <= v <= high for v, (low, high) in zip(to, self.box))

    def move(self, code, to, letters=None, tail=""):
        words = []
        for i, c in enumerate("XYZ"):
            if letters is None and abs(to[i] - self.at[i]) > 1e-9 or letters and c in letters:
                words.append(c + self.number(to[i] - self.at[i] if self.incremental else to[i]))
        if not words:
            return
        self.lines.append(f"G{code} " * (self.mode != code or code > 1) + " ".join(words) + tail)
        self.mode = code
        self.at = [self.grid(v) for v in to]

    def step(self, i, way):
        to = list(self.at)
        to[i] = self.grid(to[i] + way)
        if self.inside(to):
            self.move(1, to)

    def line(self, reach):
        axes = [i for i in range(3) if self.rng.random() < 0.6] or [self.rng.randrange(3)]
        to = list(self.at)
        for i in axes:
            low, high = self.box[i]
            to[i] = self.grid(min(max(to[i] + self.rng.uniform(-reach, reach), low), high))
        self.move(1, to)

    def arc(self, radius, first, sweep, rise=0.0, by_r=False, mismatch=0.0):
        """From here, about a centre in direction `first`; negative sweep: clockwise."""
        u, v, w, letters = PLANES[self.plane]
        cu, cv = self.grid(-radius * math.cos(first)), self.grid(-radius * math.sin(first))
        real, start = math.hypot(cu, cv), math.atan2(-cv, -cu)
        if real == 0:
            return
        to = list(self.at)
        whole = abs(sweep) >= 2 * math.pi
        if not whole:
            to[u] = self.grid(self.at[u] + cu + (real + mismatch) * math.cos(start + sweep))
            to[v] = self.grid(self.at[v] + cv + (real + mismatch) * math.sin(start + sweep))
        to[w] = self.grid(to[w] + rise)
        reach = list(self.at)
        for du, dv in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            reach[u], reach[v] = self.at[u] + cu + du * real, self.at[v] + cv + dv * real
            if abs(sweep) > 0.6 and not self.inside(reach):
                return
        ends_meet = abs(to[u] - self.at[u]) < 1e-9 and abs(to[v] - self.at[v]) < 1e-9
        if not self.inside(to) or ends_meet and not whole:
            return
        end = math.hypot(to[u] - self.at[u] - cu, to[v] - self.at[v] - cv)
        if abs(end - real) > 0.0095:
            return
        code = 2 if sweep < 0 else 3
        if by_r and not whole and not self.inch and 0.2 < abs(sweep) < 2.9:
            tail = f" R{real:.4f}"
        else:
            tail = "".join(f" {c}{self.number(x)}" for c, x in zip(letters, (cu, cv)))
        named = "".join("XYZ"[i] for i in ((u, v, w) if rise else (u, v))) if not whole or self.rng.random() < 0.5 or rise else "XYZ"[w] if rise else None
        if whole and not rise and named is None:
            self.lines.append(f"G{code}{tail}")
            self.mode = code
        else:
            self.move(code, to, named, tail)

    def text(self):
        return "\n".join(self.lines + self.ends + ["M2"]) + "\n"


def program(rng, spec, kind):
    w = Writer(rng, spec, kind)
    for _ in range(rng.randint(5, 16)):
        if rng.random() < 0.15 and kind != "turned":
            w.plane = rng.choice([17, 18, 19])
            w.lines.append(f"G{w.plane}")
        if rng.random() < 0.05 and kind != "turned":
            w.incremental = not w.incremental
            w.lines.append("G91" if w.incremental else "G90")
        if rng.random() < 0.06:
            to = [w.grid(rng.uniform(low + 2, high - 2)) for low, high in w.box]
            w.move(0, to, "XYZ")
            continue
        one_block(rng, w, kind)
    return w


def one_block(rng, w, kind):
    choice = rng.random()
    quarter = math.pi / 2
    if kind == "arcs-under-play" and choice < 0.6:
        # The quadrant lies at one end; the arc leaves its tangent there by about the tolerance, so that a fitted circle may turn back.
        tolerance = w.spec["tolerance_um"] * 1e-3
        radius = math.exp(rng.uniform(math.log(rng.choice([0.05, 10])), math.log(300)))
        sweep = min(math.sqrt(2 * tolerance * rng.choice([0.3, 1, 2, 4, 8, 20]) / radius), 1.5)
        at = rng.randrange(4) * quarter + rng.choice([0, 0, 0.02, -0.02, 0.3, -0.3, rng.uniform(-1, 1)]) * sweep
        turn = rng.choice([-1, 1])
        w.arc(radius, at if rng.random() < 0.5 else at - turn * sweep, turn * sweep, rng.choice([0, 0, 0, 0.3]), rng.random() < 0.15,
              rng.choice([0, 0, 0.002, -0.002, 0.005, -0.005, 0.009, -0.009]))
        if choice < 0.15:
            w.step(rng.randrange(3), rng.choice([-1, 1]) * rng.choice([0.01, 0.3, 4]))
    elif kind == "arcs-under-play" or kind in ("backlash", "directions", "sideways", "unknown-side", "turned") and choice < 0.5:
        near = rng.choice([0.0, 0.001, -0.001, 0.01, -0.01, rng.uniform(-0.05, 0.05), rng.uniform(-3, 3)])
        first = rng.randrange(4) * quarter + near
        radius = rng.choice([0.004, 0.008, 0.012, 0.03, 0.1, 0.4, 1.5, 5, rng.uniform(2, 25), rng.uniform(2, 25)])
        sweep = rng.choice([quarter, 2 * quarter, 3 * quarter, 4 * quarter, rng.uniform(0.01, 6.2), rng.uniform(0.01, 1)])
        sweep = sweep + (rng.choice([0, 0.002, -0.002, 0.02, -0.02]) if sweep < 6.2 else 0)
        rise = rng.choice([0, 0, 0, 0.3, 2]) * rng.choice([-1, 1])
        w.arc(radius, first, rng.choice([-1, 1]) * sweep, rise, rng.random() < 0.15, rng.choice([0, 0, 0, 0.004, -0.008]))
        if choice < 0.3:
            w.step(rng.randrange(3), rng.choice([-1, 1]) * rng.choice([0.002, 0.01, 0.3, 4]))
    elif kind == "helices":
        w.arc(rng.choice([0.5, 3, 9, rng.uniform(1, 25)]), rng.uniform(0, 6.28), rng.choice([-1, 1]) * rng.choice([6.2832, rng.uniform(0.5, 6.2)]), rng.uniform(-6, 6))
    elif kind == "kinks":
        w.line(rng.choice([40, 150]))
    elif kind == "dyadic":
        if choice < 0.5:
            i = rng.randrange(3)
            low, high = w.box[i]
            side = (low + high) / 2 - w.at[i]
            w.step(i, math.copysign(rng.choice([0.5, 2, 8, 16] + 4 * [abs(side) + rng.uniform(0.3, 0.5) * (high - low)]), side))
        elif choice < 0.7:
            for _ in range(6):
                w.step(rng.randrange(3), rng.choice([-1, 1]) * rng.choice([1, 2, 4]))
        else:
            w.line(rng.choice([3, 8, 30]))
    elif kind == "tiny":
        if choice < 0.6:
            for _ in range(rng.randint(3, 12)):
                w.line(rng.choice([0.001, 0.002, 0.005, 0.02, 0.3]))
        elif choice < 0.8:
            w.arc(rng.choice([0.002, 0.005, 0.02, 0.2]), rng.uniform(0, 6.28), rng.choice([-1, 1]) * rng.uniform(0.3, 6))
        else:
            w.line(20)
    elif choice < 0.6:
        w.line(rng.choice([1, 20, 80]))
        if choice < 0.15:
            for _ in range(6):
                w.line(0.8)
    elif choice < 0.65:
        w.lines.append("G93")
        w.move(1, [w.grid(v + rng.uniform(-3, 3)) if low + 3 < v < high - 3 else v for v, (low, high) in zip(w.at, w.box)], "XYZ", " F30")
        w.lines += ["G94", "F500" if not w.inch else "F20"]
    else:
        w.arc(rng.choice([0.3, 2, rng.uniform(1, 30)]), rng.uniform(0, 6.28), rng.choice([-1, 1]) * rng.choice([6.2832, rng.uniform(0.1, 6.2)]), rng.choice([0, 0, rng.uniform(-5, 5)]), rng.random() < 0.2, rng.choice([0, 0, 0.004]))


def pair(seed, number):
    """(kind, machine, program text, start_at or None) of one pair; the same for the same seed and number."""
    rng = random.Random(f"{seed}/{number}")
    kind = KINDS[number % len(KINDS)]
    spec = machine(rng, kind)
    w = program(rng, spec, kind)
    return kind, spec, w.text(), w.start_at
