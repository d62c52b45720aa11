"""Place for place: the motions of the program against those of what vpost wrote, seen through the machine's errors.

Two machines are asked. The one is off by the same vector everywhere, so that cycles and counts may stay as they are; the
other by what grows evenly with the place and across the axes, so that each hole has a correction of its own and whatever
stands for several motions has to be written out. Both errors are linear: lines stay lines, and what the axes of the
output really do is exact.
"""

import math


class Machine:
    """axis -> tool: q + b + A q."""

    def __init__(self, name, shift, slope, near):
        self.name, self.shift, self.slope, self.near = name, shift, slope, near
        self.stale = 0.008 if not any(map(any, slope)) else 0.045    # what an axis may be off that nobody named
        self.tiny = self.stale                                       # motions no longer than this are none

    def real(self, q):
        if any(v is None for v in q):
            known = [0.0 if v is None else v for v in q]
            moved = self.real(known)
            return tuple(None if v is None else m for v, m in zip(q, moved))
        return tuple(q[i] + self.shift[i] + sum(self.slope[i][j] * q[j] for j in range(3)) for i in range(3))

    def table(self, axis):
        """(places, errors in X, Y and Z, um) of the profile's error table of an axis."""
        j, places = "XYZ".index(axis), (-20000.0, 0.0, 20000.0)
        shifts = [self.shift[i] if i == j else 0.0 for i in range(3)]
        return places, [[1000 * (self.slope[i][j] * at + shifts[i]) for i in range(3)] for at in places]


SHIFTED = Machine("shifted", (0.004, -0.003, 0.002), [[0.0] * 3] * 3, 0.0011)
SLOPED = Machine("sloped", (0.004, -0.003, 0.002), [[5e-5, 0.0, 0.0], [3e-5, -4e-5, 0.0], [0.0, 2e-5, 7e-5]], 0.006)
TURN_SHIFTED = Machine("turn_shifted", (0.004, 0.0, 0.002), [[0.0] * 3] * 3, 0.0011)
TURN_SLOPED = Machine("turn_sloped", (0.004, 0.0, 0.002), [[5e-5, 0.0, 3e-5], [0.0] * 3, [2e-5, 0.0, 7e-5]], 0.006)


def machines(turning):
    return (TURN_SHIFTED, TURN_SLOPED) if turning else (SHIFTED, SLOPED)


INCH = 0.003                                # four decimals of an inch instead of three of a millimetre


def squeeze(events, tiny):
    """Motions that move something, and what else happens, each with the number of motions before it."""
    motions, others, at = [], [], None
    for e in events:
        if isinstance(e, tuple):
            others.append((len(motions), e))
            continue
        small = e.kind in ("rapid", "line", "machine") and at is not None and all(
            (a is None and b is None) or (a is not None and b is not None and abs(a - b) <= tiny)
            for a, b in zip(at, e.end))
        if not small:
            motions.append(e)
            at = e.end
    return motions, others


def off(a, b):
    return [None if x is None or y is None else y - x for x, y in zip(a, b)]


class Comparison:
    def __init__(self, machine, inch):
        self.rises = 0
        self.m, self.near = machine, machine.near + (INCH if inch else 0.0)

    def place(self, a, n, loose):
        """Whether the output's axes n bring the tool to a."""
        for i, d in enumerate(off(a, self.m.real(n))):
            if d is None:
                if (a[i] is None) != (n[i] is None):
                    return False
            elif abs(d) > self.near + (self.m.stale if loose[i] else 0.0):
                return False
        return True

    def on_path(self, m, n, wide):
        """Whether the motion n of the output stays on the way of m."""
        parts = 64 if m.kind == "line" else 48 + int(60 * abs(m.sweep()))
        samples = [m.at(k / parts) for k in range(parts + 1)]
        for k in range(0, 9):
            place = self.m.real(n.at(k / 8))
            best = min(self.to_segment(place, a, b) for a, b in zip(samples, samples[1:]))
            if best > self.near + 0.006 + wide:
                return False
        return True

    @staticmethod
    def to_segment(p, a, b):
        d = [y - x for x, y in zip(a, b)]
        length = sum(v * v for v in d)
        t = 0.0 if length == 0 else max(0.0, min(1.0, sum((q - x) * v for q, x, v in zip(p, a, d)) / length))
        return math.dist(p, [x + v * t for x, v in zip(a, d)])

    def same_arc(self, m, n, wide):
        for k in range(1, 8):
            if math.dist(m.at(k / 8), self.m.real(n.at(k / 8))) > self.near + 0.004 + wide:
                return False
        return abs(m.sweep() - n.sweep()) < 0.1

    @staticmethod
    def turn_of(m, n):
        """The angle that a piece turns by about the arc's centre."""
        if m.kind != "arc":
            return 0.0
        if n.kind == "arc":
            return n.sweep()
        p, q = m.plane
        a, b = (math.atan2(e[q] - m.centre[1], e[p] - m.centre[0]) for e in (n.start, n.end))
        return math.remainder(b - a, 2 * math.pi)

    @staticmethod
    def same_feed(m, n):
        if m.feed is None or n.feed is None:
            return m.feed == n.feed
        return m.feed[0] == n.feed[0] and math.isclose(m.feed[1], n.feed[1], rel_tol=2e-4, abs_tol=2e-3)

    def run(self, source, output):
        """None, or what differs first."""
        a, self.other_a = squeeze(source, self.m.tiny)
        b, self.other_b = squeeze(output, self.m.tiny)
        i, j, pairs = 0, 0, {0: 0}
        while i < len(a):
            if j >= len(b):
                return f"the output ends before {a[i]}"
            why, k = self.one(a[i], b, j)
            if why:
                ends = None if "turn" in self.m.name else self.rises_first(a, i, b, j)
                if ends:
                    self.rises += 1
                    i, j = ends
                    continue
            if why:
                return why
            j, i = k, i + 1
            pairs[j] = i
        if j < len(b):
            return f"more in the output: {b[j]}"
        return self.process(pairs)

    def rises_first(self, a, i, b, j):
        """Rapids that lead over the same places and end at the same one, the output's nowhere lower: counted apart.

        Fanuc goes over the hole at the level where the tool stands and then to R; vpost, where it writes a hole as moves,
        rises to the higher of the two first.
        """
        def run(events, k):
            first = k
            while k < len(events) and events[k].kind == "rapid" and k - first < 6:
                k += 1
            return k
        for m in range(run(a, i), i, -1):
            for n in range(run(b, j), j, -1):
                if None in a[i].start or not self.place(a[m - 1].end, b[n - 1].end, (True, True, True)):
                    continue
                low = min(e.end[2] for e in a[i:m])
                before, after = [a[i].start] + [e.end for e in a[i:m]], [self.m.real(e.end) for e in b[j:n]]
                levels = {round(e.end[2], 3) for e in a[max(0, i - 400):m] if e.end[2] is not None}
                def over(p, places):
                    return any(math.dist(p[:2], q[:2]) < self.m.stale for q in places)
                if all(p[2] > low - self.m.stale and over(p, before)
                       and any(abs(p[2] - level) < self.m.stale for level in levels) for p in after) and all(
                        over(p, after + [a[i].start]) for p in before[1:]) and (
                        max(p[2] for p in after) > max(p[2] for p in before[1:]) - self.m.stale):
                    return m, n
        return None

    def one(self, m, b, j):
        n = b[j]
        said = f"\n    program: {m}\n    output:  {n}"
        if m.kind == "reference":
            if n.kind != m.kind or n.named != m.named or any(
                    d is not None and abs(d) > self.m.stale + self.near for d in off(m.end, self.m.real(n.end))):
                return f"another return{said}", j
            return None, j + 1
        if m.kind == "machine":
            wide = [None if x is None or y is None else abs(x - y) for x, y in zip(m.end, n.end)]
            if n.kind != m.kind or any(w is None and m.end[i] is not None or w is not None and w > self.m.stale
                                       + self.near for i, w in enumerate(wide)):
                return f"another place of the machine{said}", j
            return None, j + 1
        lost = m.kind == "rapid" and None in m.end                 # where an axis is not known nothing is corrected
        loose = [lost or raw or axis not in m.named for raw, axis in zip(m.raw, "XYZ")]
        wide = self.m.stale if any(loose) else 0.0
        feeds = ("line", "arc", "thread")
        if (m.kind in feeds) != (n.kind in feeds) or (m.kind == "thread") != (n.kind == "thread"):
            return f"another kind of motion{said}", j
        if self.place(m.end, n.end, loose):
            if m.kind == "arc" and n.kind == "arc" and self.same_arc(m, n, wide):
                return (None if self.same_feed(m, n) else f"another feed{said}"), j + 1
            if m.kind != "arc" and n.kind == m.kind:
                if m.kind != "rapid" and not self.same_feed(m, n):
                    return f"another feed{said}", j
                return None, j + 1
        if m.kind not in ("line", "arc") or None in m.start:
            return f"another place{said}", j
        turned = 0.0
        for k in range(j, min(j + 3000, len(b))):                  # in pieces
            n = b[k]
            if n.kind not in ("line", "arc") or None in n.start:
                break
            if not self.on_path(m, n, wide):
                return f"another place or way, piece {k - j}{said}\n    piece:   {n}", j
            if not self.same_feed(m, n):
                return f"another feed{said}", j
            turned += self.turn_of(m, n)
            if self.place(m.end, n.end, loose) and (m.kind != "arc" or abs(turned - m.sweep()) < 0.15):
                return None, k + 1
        return f"another place{said}", j

    def process(self, pairs):
        """Spindle, coolant, stops and dwells between the same motions."""
        def placed(others, back):
            return [(back(at), what) for at, what in others]
        def back(at):
            while at not in pairs and at >= 0:
                at -= 1
            return pairs.get(at, 0)
        a, b = self.other_a, placed(self.other_b, back)
        if a == b:
            return None
        for x, y in zip(a + [None], b + [None]):
            if x != y:
                return f"process: program {x}, output {y}"
        return None


def compare(machine, source, output, inch):
    """(what differs first or None, how often the output rises to R before it goes over the hole)."""
    comparison = Comparison(machine, inch)
    return comparison.run(source, output), comparison.rises
