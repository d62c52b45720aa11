"""Where controls lead the tool's centre: LinuxCNC by its own interpreter, others by what their manuals say.

Fanuc (B-64484EN, cutter compensation) and Haas (setting 43), types A and B; Sinumerik (Programming Manual Fundamentals,
tool radius compensation), NORM and KONT with G450:

- inner corners: the meeting of both offset ways. Outer ones: Fanuc's and Haas' to 90 degrees by the tangents' offsets
  to where these meet, sharper ones with both ways made longer by the radius; Sinumerik's by an arc about the corner;
- start-up: type A and NORM straight to the place square to the next block's start, cancelling from the place square to
  the last block's end; type B does at an outer corner what it does at any; KONT leads around the contour's start (end)
  where it comes from (goes) behind its tangent. A bare G41, G42 or G40 waits for the plane's next motion (Fanuc's manual
  says "the next move command": here that is one in the plane, as for start-up);
- a block without motion in the plane moves at the place where the block before it ends; look-ahead passes it.
"""

import math
import re

import numpy as np

from common.interpreter import interpret, parameters

from blocks import PLANES, Unreadable

SAG = 2e-5
SMALL = 1e-3  # corners that two pieces of one block make, rad


class Refused(Exception):
    """The control stops."""


def left_of(d):
    return np.array([-d[1], d[0]])


def arc(a, b, centre, left, w0, w1):
    u, v = a - centre, b - centre
    first, sign = math.atan2(u[1], u[0]), 1.0 if left else -1.0
    sweep = (sign * (math.atan2(v[1], v[0]) - first)) % (2 * math.pi)
    if sweep > 2 * math.pi - 1e-4 and np.linalg.norm(b - a) > 0:
        sweep -= 2 * math.pi
    radii = np.linalg.norm(u), np.linalg.norm(v)
    s = np.linspace(0, 1, 2 + int(abs(sweep) / math.sqrt(8 * SAG / max(max(radii), 0.01))))
    angle, radius = first + sign * sweep * s, radii[0] + s * (radii[1] - radii[0])
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), w0 + s * (w1 - w0)], axis=1)


def straight(a, b):
    return a + np.linspace(0, 1, 2 + int(np.linalg.norm(np.nan_to_num(b - a)) / 0.8))[:, None] * (b - a)


def in_space(points, plane):
    out = np.empty_like(points)
    out[:, list(PLANES[plane])] = points
    return out


# -- LinuxCNC ----------------------------------------------------------------------------------------------------------


def linuxcnc(text, radius):
    """[(feed, points)] of the tool's centre, program coordinates. Its test command counts tables in inches."""
    said = interpret(text, "T1 P1 Z4 D%.9f\n" % (2 * radius / 25.4), parameters({}))
    if not said.whole:
        raise Refused(said.trouble(160).replace("\n", " | "))
    out, at, plane = [], np.full(3, np.nan), 17
    for what, inside in re.findall(r"\b(STRAIGHT_TRAVERSE|STRAIGHT_FEED|ARC_FEED|SELECT_PLANE)\((.*?)\)", said.calls):
        if what == "SELECT_PLANE":
            plane = {"XY": 17, "XZ": 18, "YZ": 19}[inside[-2:]]
            continue
        v = [float(x) for x in inside.split(",")]
        if what == "ARC_FEED":
            a = at[list(PLANES[plane])]
            points = in_space(arc(a[:2], np.array(v[:2]), np.array(v[2:4]), v[4] > 0, a[2], v[5]), plane)
        else:
            end = np.array(v[:3])
            points = straight(np.where(np.isnan(at), end, at), end)
        out.append((what != "STRAIGHT_TRAVERSE", points))
        at = points[-1]
    return out


# -- others ------------------------------------------------------------------------------------------------------------


class Element:
    """A block that moves in the plane."""

    def __init__(self, block):
        self.a, self.b = block.across
        self.centre, self.left = block.centre, block.motion == 3
        if self.centre is None:
            self.begins = self.ends = (self.b - self.a) / np.linalg.norm(self.b - self.a)
        else:
            self.begins, self.ends = (
                (1 if self.left else -1) * left_of(p - self.centre) / np.linalg.norm(p - self.centre) for p in (self.a, self.b)
            )


def meeting(one, two, d, near):
    """Where the ways of two elements meet that are offset by d to their left, nearest to a place."""
    ways = []
    for e in (one, two):
        if e.centre is None:
            ways.append(("line", e.a + d * left_of(e.begins), e.begins))
        else:
            ways.append(("arc", e.centre, abs(np.linalg.norm(e.b - e.centre) - (d if e.left else -d))))
    if ways[0][0] == "arc" and ways[1][0] == "line":
        ways.reverse()
    (kind, p, t), (other, q, u) = ways
    if kind == "line" and other == "line":
        return p + t * ((q - p)[0] * u[1] - (q - p)[1] * u[0]) / (t[0] * u[1] - t[1] * u[0])
    if kind == "line":
        along = (q - p) @ t
        rest = u * u - ((q - p - along * t) ** 2).sum()
        found = [p + (along + s * math.sqrt(rest)) * t for s in (-1, 1)] if rest >= 0 else []
    else:
        gap = np.linalg.norm(q - p)
        along = (gap**2 + t**2 - u**2) / (2 * gap)
        rest = t * t - along**2
        found = [p + along * (q - p) / gap + s * math.sqrt(rest) * left_of(q - p) / gap for s in (-1, 1)] if rest >= 0 else []
    if not found:
        raise Refused("offset ways that do not meet")
    return min(found, key=lambda x: np.linalg.norm(x - near))


def around(corner, one, two, d, rule):
    """Places of an outer corner, ends of the offset ways first and last, by tangents (Fanuc) or on an arc (Sinumerik)."""
    n1, n2 = d * left_of(one), d * left_of(two)
    if rule in ("NORM", "KONT"):
        return arc(corner + n1, corner + n2, corner, d < 0, 0.0, 0.0)[:, :2]
    if one @ two < 0:
        longer = abs(d)
        return np.array([corner + n1, corner + n1 + longer * one, corner + n2 - longer * two, corner + n2])
    return np.array([corner + n1, corner + (n1 + n2) / (1 + one @ two), corner + n2])


def joint(one, two, d, rule):
    """Places of the centre from the end of one element to the start of the next."""
    turn = math.atan2(one.ends[0] * two.begins[1] - one.ends[1] * two.begins[0], one.ends @ two.begins)
    n1, n2 = d * left_of(one.ends), d * left_of(two.begins)
    if abs(turn) < SMALL:
        return np.array([one.b + (n1 + n2) / (1 + one.ends @ two.begins)])
    if turn * d < 0:
        return around(one.b, one.ends, two.begins, d, rule)
    return np.array([meeting(one, two, d, one.b + n1 + n2)])


def lead(place, corner, way, d, rule, going):
    """Places from the plane's start-up (or, going, to its cancelling) beside the contour's first (last) place."""
    square = corner + d * left_of(way)
    to = corner - place
    if rule == "B":
        d_in, d_out = (way, -to) if going else (to, way)
        d_in, d_out = d_in / np.linalg.norm(d_in), d_out / np.linalg.norm(d_out)
        turn = d_in[0] * d_out[1] - d_in[1] * d_out[0]
        if turn * d < 0:
            places = around(corner, d_in, d_out, d, rule)
            # An obtuse corner: straight to where the offset lines meet.
            return places if len(places) == 4 else (places[:2] if going else places[1:])
    if rule == "KONT" and np.linalg.norm(to) > abs(d) and -to @ left_of(way) * d < 0:
        turn = math.asin(abs(d) / np.linalg.norm(to)) * math.copysign(1, -d if going else d)
        u = to / np.linalg.norm(to)
        along = np.array([u[0] * math.cos(turn) - u[1] * math.sin(turn), u[0] * math.sin(turn) + u[1] * math.cos(turn)])
        touch = place + along * math.sqrt(to @ to - d * d)
        return (arc(square, touch, corner, d < 0, 0, 0) if going else arc(touch, square, corner, d < 0, 0, 0))[:, :2]
    return np.array([square])


def by_manual(blocks, radius, rule):
    """[(feed, points)] of the tool's centre, by one of the rules A, B, NORM, KONT."""
    out, v, before = [], np.zeros(2), None
    moving = [b for b in blocks if b.motion is not None]
    for k, b in enumerate(moving):
        axes = list(PLANES[b.plane])
        start, end, feed = b.start[axes], b.end[axes], b.motion > 0
        if not b.in_plane:
            out.append((feed, in_space(straight(np.append(start[:2] + v, start[2]), np.append(end[:2] + v, end[2])), b.plane)))
            continue
        now, d = Element(b), radius * b.side
        ahead = next((x for x in moving[k + 1 :] if x.in_plane), None)
        here = np.append(start[:2] + v, start[2])
        if not b.side:
            out.append((feed, in_space(straight(here, end), b.plane)))
            v, before = np.zeros(2), None
            continue
        if ahead is None:
            raise Unreadable("compensation that does not end")
        if before is None:
            places = lead(now.a, now.b, Element(ahead).begins, d, rule, False)
            first, rest = np.append(places[0], end[2]), places[1:]
            out.append((feed, in_space(straight(here, first), b.plane)))
        else:
            # A bare G40 leaves the tool square to the last block; with G40 in the block ahead type B and KONT go around.
            places = (
                joint(now, Element(ahead), d, rule)
                if ahead.side
                else lead(ahead.across[1], now.b, now.ends, d, rule if cancels_moving(blocks, ahead) else "A", True)
            )
            first, rest = np.append(places[0], end[2]), places[1:]
            if now.centre is None:
                out.append((feed, in_space(straight(here, first), b.plane)))
            else:
                out.append((feed, in_space(arc(here[:2], first[:2], now.centre, now.left, here[2], first[2]), b.plane)))
        for p in rest:
            out.append((feed, in_space(straight(first, np.append(p, end[2])), b.plane)))
            first = np.append(p, end[2])
        v, before = first[:2] - end[:2], now
    return out


def cancels_moving(blocks, ahead):
    """G40 stands in the block that moves, not in one of its own before it."""
    k = blocks.index(ahead)
    return k == 0 or blocks[k - 1].side != 0
