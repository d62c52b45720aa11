"""Ways of the tip, from a line on, of a program and of the same begun anew there: what a path mode allows them to part.

Under an exact stop (G61, G61.1) they are the same within `SAME_MM`. Under `G64 P` a control may leave each corner by P,
rapids and feeds alike, and by how much it does depends on the speed with which it comes: the two lie within P of the
way that is commanded, part by at most 2 P, and only where a corner is blended. LinuxCNC begins a blend 2 P / sin(d / 2)
before a corner that turns by d (parabolas) or P / tan(d / 4) before it (arcs); feeds whose common end is within Q of
the line past it, which is P where Q is not written, may become one. Under G64 without P nothing is promised.
"""

import numpy as np

import canon
import judge

SAME_MM = 1.5e-3
INCH_MM = 4.5e-3  # more than that the interpreter's inches of four decimals are off
STRAIGHT = 1e-6


class Wrong(Exception):
    """What is not as it should be."""


class Commanded:
    """Motions of a program from its line `begins` on, which is `line` of the whole, and the one before it."""

    def __init__(self, text, control, begins, line):
        moves = canon.Run(canon.calls(canon.numbered(text), control), chord_deg=0.5).moves
        moves = [move for move in moves if length(move.corners) > STRAIGHT]
        first = next((k for k, move in enumerate(moves) if move.line >= begins), len(moves))
        first = max(first, named(moves))
        self.comes = first > 0
        self.moves = moves[max(0, first - 1) :]
        self.lines = [move.line - begins + line for move in self.moves]

    def blend_mm(self, at):
        """What is allowed at the end of a motion: P of it and of the next; infinite under G64 without P."""
        return max(path_mode(move)[0] for move in self.moves[at : at + 2])

    def allowed_mm(self, at, commands, steps):
        """By how much each run may leave its way for the corner at the end of a motion, by commands of one of them."""
        corner = self.moves[at].corners[-1]
        near = np.linalg.norm(commands - corner, axis=1)
        allowed = np.where(near <= self.corner_mm(at) + steps, self.blend_mm(at), 0.0)
        if self.merges(at):
            leg = max(length(move.corners) for move in self.moves[at : at + 2])
            allowed += self.past_mm(at) * np.clip(1 - near / leg, 0.0, 1.0)
        return allowed

    def corner_mm(self, at):
        """How far from the end of a motion its blend with the next may begin or end."""
        one, other = self.moves[at : at + 2]
        legs = [length(one.corners), length(other.corners)]
        ways = [one.corners[-1] - one.corners[-2], other.corners[1] - other.corners[0]]
        cosine = ways[0] @ ways[1] / (np.linalg.norm(ways[0]) * np.linalg.norm(ways[1]))
        turn = np.arccos(np.clip(cosine, -1.0, 1.0))
        if turn < STRAIGHT or self.blend_mm(at) == 0.0:
            return 0.0
        return min(self.blend_mm(at) * max(2 / np.sin(turn / 2), 1 / np.tan(turn / 4)), max(legs))

    def merges(self, at):
        """Whether a feed may become one line with the next."""
        one, other = self.moves[at : at + 2]
        within = path_mode(other)[1]
        if not one.name == other.name == "STRAIGHT_FEED" or within == 0.0:
            return False
        return self.past_mm(at) <= within

    def past_mm(self, at):
        """How far a corner is from the line past it."""
        one, other = self.moves[at : at + 2]
        return judge.distances(one.corners[-1:], np.array([one.corners[0], other.corners[-1]]))[0]

    def span(self, line):
        """First and last of the motions of a line, of those next to them and, where these are shorter than their blends
        or may be one with others, of those behind: a line's rows begin with its blend."""
        own = [k for k, number in enumerate(self.lines) if number == line and k >= self.comes]
        if not own:
            return None
        low, high = max(own[0] - 1, 0), min(own[-1] + 1, len(self.moves) - 1)
        while low > 0 and self.goes_under(low, low):
            low -= 1
        while high < len(self.moves) - 1 and self.goes_under(high, high - 1):
            high += 1
        return low, high

    def goes_under(self, at, corner):
        """Whether nothing of a motion need be left, for what is done at one of its corners."""
        return self.merges(corner) or length(self.moves[at].corners) <= self.corner_mm(corner)

    def way(self, low, high):
        return np.vstack([move.corners for move in self.moves[low : high + 1]])


def named(moves):
    """Number of motions, by whole lines, until each axis has been moved twice: from where it stood before the program,
    which also says on which side of its play it hangs then, and from a place of the program's."""
    times = np.cumsum([[move.changes(axis) for axis in range(3)] for move in moves], axis=0).min(axis=1)
    found = int(np.argmax(times >= 2)) + 2 if (times >= 2).any() else len(moves)
    while 0 < found < len(moves) and moves[found].line == moves[found - 1].line:
        found += 1
    return found


def path_mode(move):
    """P and Q in force, mm: 0 under an exact stop."""
    mode = move.state.get("SET_MOTION_CONTROL_MODE", ["CONTINUOUS", 0.0])
    if "EXACT" in mode[0]:
        return 0.0, 0.0
    blend = mode[1] if len(mode) > 1 and mode[1] > 0 else np.inf
    return blend, move.state.get("SET_NAIVECAM_TOLERANCE", [blend])[0]


def length(corners):
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())


class Way:
    """Rows of a recording from a line on: commands and places of the tip, machine mm, lines of the whole program."""

    def __init__(self, recorded, machine, commanded, begins, line):
        """Rows from line `begins` of what was run, which is `line` of the whole; those that stand are left out."""
        tips, lines = machine.tip_mm(recorded[:, :3]), recorded[:, 3].astype(int)
        at = np.flatnonzero(lines >= begins)
        rows = slice(at[0] if len(at) else len(lines), None)
        moved = np.r_[[True] * bool(len(at)), np.abs(np.diff(tips[rows], axis=0)).max(1) > 1e-9]
        self.commanded = commanded
        self.commands, self.tips = recorded[rows, :3][moved], tips[rows][moved]
        self.lines = (np.maximum.accumulate(lines[rows]) - begins + line)[moved]
        steps = np.linalg.norm(np.diff(self.commands, axis=0), axis=1)
        self.steps = np.r_[steps[:1], steps] if len(steps) else np.zeros(len(self.commands))

    def begun(self):
        """Which rows are behind the corner at which the line begins: a blend with what came before is part of that."""
        if not self.commanded.comes or len(self.commanded.moves) < 2 or not len(self.tips):
            return np.ones(len(self.tips), dtype=bool)
        corner, reach = self.commanded.moves[0].corners[-1], self.commanded.corner_mm(0)
        near = np.linalg.norm(self.commands - corner, axis=1) <= reach + self.steps * bool(reach)
        return ~np.logical_and.accumulate(near)

    def between(self, first, last):
        """Rows of a span of lines, with one more on either side, so that a way is whole to its ends."""
        at = np.flatnonzero((self.lines >= first) & (self.lines <= last))
        return slice(max(0, at[0] - 1), at[-1] + 2) if len(at) else slice(0, 0)


def compare(whole, own, inches):
    """Holds two ways against what was commanded and against each other; the largest distance away from corners, mm."""
    if len(whole.tips) < 2 or len(own.tips) < 2:
        if abs(len(whole.tips) - len(own.tips)) > 2:
            raise Wrong(f"{len(own.tips)} places from the line on, the whole has {len(whole.tips)}")
        return 0.0
    same_mm = SAME_MM + (INCH_MM if inches else 0.0)
    worst = 0.0
    for one, other in ((own, whole), (whole, own)):
        begun, commanded = one.begun(), one.commanded
        for line in np.unique(one.lines):
            if (span := commanded.span(line)) is None:
                continue
            blend_mm = max(commanded.blend_mm(k) for k in range(span[0], span[1] + 1))
            if not np.isfinite(blend_mm):
                continue
            rows = np.flatnonzero(one.lines == line)
            off = judge.distances(one.commands[rows], commanded.way(*span)).max()
            if off > blend_mm + same_mm:
                raise Wrong(f"{off * 1e3:.2f} um off what is commanded in line {line}")
            if begun[rows].any():
                worst = max(worst, parted(one, rows[begun[rows]], other, span))
    return worst


def parted(one, rows, other, span):
    """Rows of a line against the other way there; how far they part away from corners, mm."""
    (low, high), commanded = span, one.commanded
    line = one.lines[rows[0]]
    way = other.tips[other.between(commanded.lines[low], commanded.lines[high])]
    if len(way) < 2:
        raise Wrong(f"line {line} has no way in the other run")
    off = judge.distances(one.tips[rows], way)
    blend_mm = np.zeros(len(rows))
    for k in range(low, high):
        if commanded.blend_mm(k):
            blend_mm = np.maximum(blend_mm, commanded.allowed_mm(k, one.commands[rows], one.steps[rows]))
    may = 2 * blend_mm + SAME_MM
    if (off > may).any():
        k = int((off - may).argmax())
        fed = "a rapid" if commanded.moves[commanded.lines.index(line)].name == "STRAIGHT_TRAVERSE" else "a feed"
        where = "where a corner is blended" if blend_mm[k] else "away from corners"
        raise Wrong(f"the tip is {off[k] * 1e3:.2f} um off the other way in line {line}, {fed}, {where}")
    return float(off[blend_mm == 0].max(initial=0.0))
