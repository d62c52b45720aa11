"""What every interpreter here shares: where the axes stand, the frame between words and axes, and the list of motions.

Axes are in machine millimetres. axis = A w + b + offset, where w are the program's words in mm, A and b the programmed
rotation, mirror or scale, offset the sum of work offset, local shift, preset and tool length. An axis whose place is not
known is None; a motion that needs it makes the program Invalid: the generator throws such a program away.
"""

import math

AXES = "XYZ"
PLANES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}


class Invalid(Exception):
    """The program is none that the control's manual allows, or is not modelled."""


class Motion:
    """A motion: kind is rapid, line, arc, thread, machine (G53) or reference (G28)."""

    __slots__ = ("kind", "start", "end", "centre", "plane", "ccw", "turns", "feed", "raw", "line", "named")

    def __init__(self, kind, start, end, feed=None, raw=(False,) * 3, line=0, named="", centre=None, plane=None,
                 ccw=False, turns=0):
        self.kind, self.start, self.end, self.feed = kind, tuple(start), tuple(end), feed
        self.raw, self.line, self.named = tuple(raw), line, named
        self.centre, self.plane, self.ccw, self.turns = centre, plane, ccw, turns

    def __repr__(self):
        end = " ".join("?" if v is None else f"{v:.4f}" for v in self.end)
        more = ""
        if self.kind == "arc":
            more = f" centre {self.centre[0]:.4f} {self.centre[1]:.4f} plane {self.plane} {'ccw' if self.ccw else 'cw'}"
        return f"{self.kind:6s} {end}{more} F{self.feed} (line {self.line})"

    def sweep(self):
        """The angle that an arc turns by, signed."""
        p, q = self.plane
        a = math.atan2(self.start[q] - self.centre[1], self.start[p] - self.centre[0])
        b = math.atan2(self.end[q] - self.centre[1], self.end[p] - self.centre[0])
        turn = b - a if self.ccw else a - b
        turn %= 2 * math.pi
        if turn < 1e-7 or turn > 2 * math.pi - 1e-7:
            turn = 2 * math.pi
        turn += 2 * math.pi * self.turns
        return turn if self.ccw else -turn

    def at(self, share):
        """The place after this share of the way."""
        if self.kind != "arc":
            return tuple(a + (b - a) * share for a, b in zip(self.start, self.end))
        p, q = self.plane
        sweep = self.sweep()
        a = math.atan2(self.start[q] - self.centre[1], self.start[p] - self.centre[0])
        r0 = math.hypot(self.start[q] - self.centre[1], self.start[p] - self.centre[0])
        r1 = math.hypot(self.end[q] - self.centre[1], self.end[p] - self.centre[0])
        r = r0 + (r1 - r0) * share
        place = [s + (e - s) * share for s, e in zip(self.start, self.end)]
        place[p] = self.centre[0] + r * math.cos(a + sweep * share)
        place[q] = self.centre[1] + r * math.sin(a + sweep * share)
        return tuple(place)


def matmul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def matvec(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def identity():
    return [[1.0 if i == j else 0.0 for j in range(3)] for i in range(3)]


def rotation(p, q, degrees):
    """About the axis that is normal to p and q, from p towards q."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    found = identity()
    found[p][p], found[p][q], found[q][p], found[q][q] = c, -s, s, c
    return found


def inverse(a):
    m = [list(a[i]) + [1.0 if i == j else 0.0 for j in range(3)] for i in range(3)]
    for i in range(3):
        pivot = max(range(i, 3), key=lambda r: abs(m[r][i]))
        m[i], m[pivot] = m[pivot], m[i]
        d = m[i][i]
        m[i] = [v / d for v in m[i]]
        for r in range(3):
            if r != i:
                f = m[r][i]
                m[r] = [v - f * w for v, w in zip(m[r], m[i])]
    return [row[3:] for row in m]


IDENTITY = identity()


class Frame:
    """axis = a w + b (offsets apart)."""

    def __init__(self, a=None, b=None):
        self.a, self.b = a or identity(), b or [0.0] * 3

    def plain(self, i):
        return all(abs(self.a[i][j]) < 1e-12 for j in range(3) if j != i)

    def apply(self, w):
        return [v + d for v, d in zip(matvec(self.a, w), self.b)]

    def more(self, a, b):
        """This frame with another one within it: w -> a w + b first."""
        return Frame(matmul(self.a, a), self.apply(b))


class Control:
    """Where the axes stand, and how words become places."""

    def __init__(self):
        self.pos = [None] * 3
        self.raw = [False] * 3
        self.work, self.local, self.preset, self.length = [0.0] * 3, [0.0] * 3, [0.0] * 3, [0.0] * 3
        self.frame = Frame()
        self.plane, self.scale, self.absolute, self.mode = 17, 1.0, True, None
        self.feed, self.feed_mode = None, 94
        self.events, self.line = [], 0
        self.corner = None                      # a line that waits for the next one: (start, corner, how, size, feed)
        self.budget = 60000

    # ---- frames ----
    def offset(self):
        return [sum(v) for v in zip(self.work, self.local, self.preset, self.length)]

    def words(self):
        """Where the axes stand, as words; None where not known."""
        off = self.offset()
        if self.frame.a == IDENTITY:
            return [None if p is None else p - o - b for p, o, b in zip(self.pos, off, self.frame.b)]
        v = [None if self.pos[i] is None else self.pos[i] - off[i] - self.frame.b[i] for i in range(3)]
        inv, found = inverse(self.frame.a), [None] * 3
        for i in range(3):
            needed = [j for j in range(3) if abs(inv[i][j]) > 1e-12]
            if all(v[j] is not None for j in needed):
                found[i] = sum(inv[i][j] * v[j] for j in needed)
        return found

    def axes(self, w):
        """Where words lead. An axis none of whose words is known stays None."""
        off, found = self.offset(), [None] * 3
        for i in range(3):
            needed = [j for j in range(3) if abs(self.frame.a[i][j]) > 1e-12]
            if all(w[j] is not None for j in needed):
                found[i] = sum(self.frame.a[i][j] * w[j] for j in needed) + self.frame.b[i] + off[i]
        return found

    def target(self, named, absolute=None):
        """named: {axis: mm}. The place in words and axes, G90 or G91."""
        absolute = self.absolute if absolute is None else absolute
        w, stays = self.words(), list(self.pos)
        for i, value in named.items():
            if absolute:
                w[i] = value
            else:
                if w[i] is None:
                    raise Invalid("increment from a place that is not known")
                w[i] += value
        axes = self.axes(w)
        touched = {i for i in range(3) for j in named if abs(self.frame.a[i][j]) > 1e-12}
        for i in range(3):
            if i not in touched:
                axes[i] = stays[i]
            elif axes[i] is None:
                raise Invalid("an axis of a turned frame is not known")
        sure = {i for i in touched if all(j in named for j in range(3) if abs(self.frame.a[i][j]) > 1e-12)}
        return w, axes, sure

    # ---- motions ----
    def emit(self, event):
        self.events.append(event)
        self.budget -= 1
        if self.budget < 0:
            raise Invalid("too long")

    def move(self, kind, end, touched=(), **more):
        was = list(self.raw)
        for i in touched:
            self.raw[i] = kind in ("machine", "reference")
        if kind in ("line", "thread"):
            for i in range(3):
                if i in touched and self.pos[i] is None:
                    raise Invalid("feed from a place that is not known")
        motion = Motion(kind, self.pos, end, raw=[a or b for a, b in zip(was, self.raw)], line=self.line, named="".join(AXES[i] for i in touched),
                        feed=self.feed_now() if kind in ("line", "arc", "thread") else None, **more)
        self.emit(motion)
        self.pos = list(end)

    def feed_now(self):
        return None if self.feed is None else (self.feed_mode, round(self.feed, 6))

    def side(self, kind, value):
        self.emit((kind, value))

    def arc(self, end, touched, ccw, centre, turns=0, tolerance=0.02):
        """centre: of the plane, in axes. The frame's handedness is the caller's."""
        p, q = PLANES[self.plane]
        if None in (self.pos[p], self.pos[q]):
            raise Invalid("arc from a place that is not known")
        r0 = math.hypot(self.pos[p] - centre[0], self.pos[q] - centre[1])
        r1 = math.hypot(end[p] - centre[0], end[q] - centre[1])
        if abs(r0 - r1) > tolerance:
            raise Invalid(f"arc of two radii {r0} {r1}")
        if r0 < 0.05:
            raise Invalid("arc without radius")
        self.move("arc", end, touched, centre=tuple(centre), plane=(p, q), ccw=ccw, turns=turns)

    def arc_by_words(self, w0, w1, end, touched, ccw, centre_w, turns=0, tolerance=0.02):
        """w0, w1: words of start and end; centre_w: the centre's two words of the plane."""
        p, q = PLANES[self.plane]
        c = list(w0)
        c[p], c[q] = centre_w
        off = self.offset()
        axes = [None if any(c[j] is None and abs(self.frame.a[i][j]) > 1e-12 for j in range(3))
                else sum(self.frame.a[i][j] * (c[j] or 0.0) for j in range(3)) + self.frame.b[i] + off[i]
                for i in range(3)]
        det = self.frame.a[p][p] * self.frame.a[q][q] - self.frame.a[p][q] * self.frame.a[q][p]
        self.arc(end, touched, ccw if det > 0 else not ccw, (axes[p], axes[q]), turns, tolerance)

    @staticmethod
    def centre_of_radius(a, b, r, ccw):
        """The centre of an arc by its radius; a negative one is more than half a turn."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        chord = math.hypot(dx, dy)
        if chord < 1e-6:
            raise Invalid("R without a chord")
        h2 = r * r - chord * chord / 4
        if h2 < -1e-9:
            raise Invalid("R too small")
        h = math.sqrt(max(h2, 0.0))
        side = 1.0 if (r > 0) == ccw else -1.0
        return ((a[0] + b[0]) / 2 - side * h * dy / chord, (a[1] + b[1]) / 2 + side * h * dx / chord)

    # ---- corners between two lines ----
    def corner_line(self, end, how, size, touched):
        """A line whose end is cut or rounded by `size` (machine mm) when the next one is known."""
        if None in self.pos:
            raise Invalid("corner from a place that is not known")
        self.finish_corner(end)
        self.corner = (list(self.pos), list(end), how, size, self.feed, self.feed_mode, self.line, tuple(touched))
        self.pos = list(end)

    def finish_corner(self, end):
        """Makes the waiting line and its corner, towards `end`."""
        if self.corner is None:
            return
        start, at, how, size, feed, mode, line, touched = self.corner
        self.corner = None
        p, q = PLANES[self.plane]
        n = 3 - p - q
        if any(abs(a - b) > 1e-9 for a, b in ((start[n], at[n]), (at[n], end[n]))):
            raise Invalid("corner out of its plane")
        u = (start[p] - at[p], start[q] - at[q])
        v = (end[p] - at[p], end[q] - at[q])
        lu, lv = math.hypot(*u), math.hypot(*v)
        if lu < 1e-6 or lv < 1e-6:
            raise Invalid("corner without lines")
        u, v = (u[0] / lu, u[1] / lu), (v[0] / lv, v[1] / lv)
        cross, dot = u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]
        angle = abs(math.atan2(cross, dot))                        # between the two lines
        if angle > math.pi - 0.02 or angle < 0.05:
            raise Invalid("corner without an angle")
        back = {"round": lambda: size / math.tan(angle / 2), "chamfer": lambda: size,
                "length": lambda: size / 2 / math.sin(angle / 2)}[how]()
        if back > lu - 0.01 or back > lv - 0.01:
            raise Invalid("corner longer than its lines")
        first, second = list(at), list(at)
        first[p], first[q] = at[p] + u[0] * back, at[q] + u[1] * back
        second[p], second[q] = at[p] + v[0] * back, at[q] + v[1] * back
        here = (self.feed, self.feed_mode, self.line)
        self.pos, (self.feed, self.feed_mode, self.line) = start, (feed, mode, line)
        self.move("line", first, touched)
        if how == "round":
            h = size / math.sin(angle / 2)
            m = (u[0] + v[0], u[1] + v[1])
            lm = math.hypot(*m)
            centre = (at[p] + m[0] / lm * h, at[q] + m[1] / lm * h)
            self.move("arc", second, (p, q), centre=centre, plane=(p, q), ccw=cross < 0)
        else:
            self.move("line", second, (p, q))
        self.feed, self.feed_mode, self.line = here
