"""Curves by control points, read and evaluated without a line of the product's code.

The text that LinuxCNC's interpreter is given has a line in the place of each curve; the curve itself is evaluated here by
Cox and de Boor's recursion, and held against what LinuxCNC's own evaluation says, where the installed version has the
form: G5, G5.1, and G5.2 in the plane of G17.
"""

import math

# A curve is divided so finely that its polygon leaves it by so much, mm; by second differences of so many places a span.
FINE_MM, LOOKS, MOST = 2e-5, 32, 5000
# LinuxCNC's points, of a curve that both evaluate, agree to the last bits of inches.
SAME_MM = 1e-7

PLANES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}
AXES = "XYZ"


class Fault(Exception):
    """A curve that the interpreter would refuse."""


class Curve:
    """What the blocks of one curve say, in program units."""

    def __init__(self, axes, unit_mm, incremental):
        self.axes, self.unit_mm, self.incremental = axes, unit_mm, incremental
        # (from where, first, second): "zero", "start" or "end".
        self.points, self.weights, self.knots, self.order = [], [], None, 3
        self.linuxcnc = axes == (0, 1)

    def placed(self, start, end):
        """The control points, machine mm, of a curve between two places; the axis across stays at the start's."""
        u, v = self.axes
        where, last_u, last_v = self.points[-1]
        # What the program's zero is in machine mm, by the end point.
        zero = (end[u] - last_u * self.unit_mm, end[v] - last_v * self.unit_mm) if where == "zero" else None
        if self.incremental:
            zero = (start[u], start[v])
        base = {"zero": zero, "start": (start[u], start[v]), "end": (end[u], end[v])}
        return [tuple(base[name][k] + value * self.unit_mm for k, value in enumerate(values)) for name, *values in self.points]

    def basis(self, i, order, t):
        """Cox and de Boor."""
        knots = self.knots
        if order == 1:
            closes = t == knots[-1] and knots[i] < t == knots[i + 1]
            return 1.0 if knots[i] <= t < knots[i + 1] or closes else 0.0
        total = 0.0
        if knots[i + order - 1] > knots[i]:
            total += (t - knots[i]) / (knots[i + order - 1] - knots[i]) * self.basis(i, order - 1, t)
        if knots[i + order] > knots[i + 1]:
            total += (knots[i + order] - t) / (knots[i + order] - knots[i + 1]) * self.basis(i + 1, order - 1, t)
        return total

    def at(self, placed, t):
        # Only as many as the order are not nothing.
        span = max(i for i in range(len(placed)) if self.knots[i] <= t and self.knots[i] < self.knots[-1])
        near = range(max(span - self.order + 1, 0), min(span + 1, len(placed)))
        shares = [(i, self.basis(i, self.order, t) * self.weights[i]) for i in near]
        total = sum(share for _, share in shares)
        return tuple(sum(share * placed[i][k] for i, share in shares) / total for k in (0, 1))

    def whole(self):
        count = len(self.points)
        if count < self.order:
            raise Fault("too few control points")
        if self.knots is None:
            spans = count - self.order + 1
            self.knots = [float(min(max(i - self.order + 1, 0), spans)) for i in range(count + self.order)]
        if len(self.weights) < count:
            self.weights += [1.0] * (count - len(self.weights))

    def path(self, start, end):
        """Places along it, machine mm, from behind the start to the end."""
        placed = self.placed(start, end)
        u, v = self.axes
        breaks = sorted(set(self.knots))
        out = []
        for low, high in zip(breaks, breaks[1:]):
            looks = [self.at(placed, low + (high - low) * k / LOOKS) for k in range(LOOKS + 1)]
            bends = [math.hypot(*(a[i] - 2.0 * b[i] + c[i] for i in (0, 1))) for a, b, c in zip(looks, looks[1:], looks[2:])]
            count = min(max(math.ceil(LOOKS * math.sqrt(max(bends) / 8.0 / FINE_MM)), 4), MOST)
            for k in range(1, count + 1):
                place = list(start)
                place[u], place[v] = self.at(placed, low + (high - low) * k / count)
                out.append(tuple(place))
        out[-1] = end
        return out

    def at_its_places(self, start, end):
        """The places at which LinuxCNC's `gcode` module evaluates it: 15 for each control point, even in the parameter."""
        placed, count = self.placed(start, end), 15 * len(self.points)
        return [self.at(placed, self.knots[-1] * k / count) for k in range(1, count + 1)]


class Reader:
    """Takes curves out of a program, line by line."""

    def __init__(self):
        self.plane, self.unit_mm, self.incremental = 17, 1.0, False
        self.open, self.mode, self.leaves = None, None, None
        # By number of the line with which each is whole.
        self.curves = {}

    def line(self, number, words):
        """The words that stand in the line for the interpreter; `None` where it holds no curve.

        `words`: (letter, value, text) of the line.
        """
        codes = [value for letter, value, _ in words if letter == "G"]
        self.plane = next((int(code) for code in codes if code in PLANES), self.plane)
        self.unit_mm = {20.0: 25.4, 21.0: 1.0}.get(next((c for c in codes if c in (20.0, 21.0)), None), self.unit_mm)
        self.incremental = next((code == 91.0 for code in codes if code in (90.0, 91.0)), self.incremental)
        code = next((code for code in codes if code in (5.0, 5.1, 5.2, 5.3, 6.2)), None)
        motion = next((code for code in codes if code in (0.0, 1.0, 2.0, 3.0, 80.0)), None)
        if motion is not None:
            self.mode, self.open, self.leaves = None, None, None
        if code is not None:
            self.mode = code
        value = {letter: value for letter, value, _ in words}
        axes = PLANES[self.plane]
        pair = [AXES[axis] for axis in axes]
        placed = all(letter in value for letter in pair)
        kept = [(letter, text) for letter, _, text in words if letter in "FN" or (letter == "G" and float(text) not in (5.0, 5.1, 5.2, 5.3, 6.2))]
        if self.mode is None or not (code is not None or placed or "K" in value or "P" in value):
            return None
        if self.mode in (5.0, 5.1):
            curve = Curve((0, 1), self.unit_mm, self.incremental)
            end = (value.get("X"), value.get("Y"))
            if None in end:
                raise Fault("G5 with only one of X and Y is not for this reader")
            offset = (value["I"], value["J"]) if "I" in value else self.leaves
            curve.points = [("start", 0.0, 0.0), ("start", *offset)]
            if self.mode == 5.0:
                curve.points.append(("end", value["P"], value["Q"]))
                self.leaves = (-value["P"], -value["Q"])
            curve.points.append(("zero", *end))
            curve.order = len(curve.points)
            self.mode = None
            return self.cut(number, curve, kept)
        if self.mode == 5.2:
            if self.open is None:
                self.open = Curve(axes, self.unit_mm, self.incremental)
                self.open.points, self.open.weights = [("start", 0.0, 0.0)], [1.0 if placed else value.get("P", 1.0)]
            self.open.order = max(self.open.order, int(value.get("L", 0)))
            if placed:
                self.open.points.append(("zero", value[pair[0]], value[pair[1]]))
                self.open.weights.append(value["P"])
            return kept
        if self.mode == 5.3:
            curve, self.open, self.mode = self.open, None, None
            return self.cut(number, curve, kept)
        if self.open is None:
            self.open = Curve(axes, self.unit_mm, self.incremental)
            self.open.order, self.open.knots, self.open.linuxcnc = int(value["P"]), [], False
        if placed:
            self.open.points.append(("zero", value[pair[0]], value[pair[1]]))
            self.open.weights.append(value.get("R", 1.0))
        self.open.knots.append(value["K"])
        if len(self.open.knots) < len(self.open.points) + self.open.order:
            return kept
        curve, self.open, self.mode = self.open, None, None
        return self.cut(number, curve, kept)

    def cut(self, number, curve, kept):
        curve.whole()
        self.curves[number] = curve
        _, *end = curve.points[-1]
        words = [(AXES[axis], f"{value:.9f}") for axis, value in zip(curve.axes, end)]
        return [("G", "1")] + kept + words
