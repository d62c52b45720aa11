"""Motions of a program of this judge's own small part of Siemens' language, in the coordinates of the frame in force.

Read on a machine, which says where CYCLE800 turns its axes to. What is not known here stops it.
"""

import math
import re

import numpy as np

import cycle
from machine import shift, turn

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
PASSED = {9, 40, 54, 55, 60, 64, 71, 710, 90, 91, 94, 601, 642}


class Unreadable(Exception):
    pass


class Motion:
    def __init__(self, **words):
        self.__dict__.update(words)

    def length(self):
        if self.kind != "arc":
            return float(np.linalg.norm(self.u1 - self.u0))
        return math.hypot(self.radius * abs(self.sweep), self.u1[self.axes[2]] - self.u0[self.axes[2]])

    def at(self, s):
        s = np.asarray(s, float)[:, None]
        out = self.u0 + s * (self.u1 - self.u0)
        if self.kind == "arc":
            a, b, _ = self.axes
            # The radius runs from that of the start to that of the end.
            radius = self.radius + s[:, 0] * (self.end_radius - self.radius)
            out[:, a] = self.centre[a] + radius * np.cos(self.from_angle + s[:, 0] * self.sweep)
            out[:, b] = self.centre[b] + radius * np.sin(self.from_angle + s[:, 0] * self.sweep)
        return out


class State:
    def __init__(self, m):
        self.m = m
        self.at = np.full(3, np.nan)
        self.theta = {k: None for k in m.rotary}
        self.swivel, self.frame = np.eye(4), np.eye(4)
        self.offset, self.length, self.tool = None, 0.0, None
        self.modal, self.plane, self.absolute, self.feed = 0, 17, True, None

    def whole(self):
        return shift(self.offset) @ self.swivel @ self.frame

    def lost(self):
        self.at = np.full(3, np.nan)


def program_frame(s, name, rest):
    """TRANS ROT ATRANS AROT: about one axis at a time, or RPL= in the plane."""
    words = dict((k, float(v)) for k, v in re.findall(r"([XYZ]|RPL=)\s*(-?[\d.]+)", rest))
    if len(re.sub(r"([XYZ]|RPL=)\s*-?[\d.]+", "", rest).split()):
        raise Unreadable(rest)
    if name.endswith("TRANS"):
        made = shift([words.get(k, 0.0) for k in "XYZ"])
    else:
        if len(words) > 1:
            raise Unreadable("several angles")
        made = np.eye(4)
        for k, v in words.items():
            axis = PLANES[s.plane][2] if k == "RPL=" else "XYZ".index(k)
            made = turn(np.eye(3)[axis], v)
    s.frame = s.frame @ made if name.startswith("A") else made


def swivel(s, text):
    if not text.strip():
        s.swivel, s.frame = np.eye(4), np.eye(4)
        s.lost()
        return
    words = cycle.arguments(text)
    made = cycle.frame(words)
    s.swivel = s.swivel @ s.frame @ made if cycle.additive(words) else made
    s.frame = np.eye(4)
    way = int(words["DIR"])
    if way:
        theta = s.m.swivelled(s.swivel[:3, 2], way, s.theta)
        if theta is None:
            raise Unreadable("CYCLE800 leaves it open")
        s.theta = theta
    s.lost()


def read(text, m):
    """[("motion", Motion) or ("do", text)] in order, each with the number of its block."""
    s, out, number = State(m), [], None
    for raw in text.splitlines():
        line = raw.split(";")[0].strip() if "MSG" not in raw else ""
        found = re.match(r"N(\d+)\s*", line)
        if found:
            number, line = int(found.group(1)), line[found.end() :]
        if not line or line.startswith("%"):
            continue
        named = re.match(r"(CYCLE800)\s*\((.*)\)$", line)
        if named:
            swivel(s, named.group(2))
            out.append(("do", number, "CYCLE800(" + ",".join(x.strip() for x in named.group(2).split(",")) + ")"))
            continue
        named = re.match(r"(A?TRANS|A?ROT)\b(.*)", line)
        if named:
            program_frame(s, named.group(1), named.group(2))
            s.lost()
            out.append(("do", number, " ".join(line.split())))
            continue
        block(s, line, number, out)
    return out


WORD = re.compile(r"(CR)\s*=\s*(-?[\d.]+)|([IJKXYZ])=AC\((-?[\d.]+)\)|([XYZ])=IC\((-?[\d.]+)\)|([A-Z])(-?(?:\d+\.?\d*|\.\d+))|(\S+)")


def block(s, line, number, out):
    w, codes, done, increments = {}, [], [], {}
    for match in WORD.finditer(line):
        cr, cr_value, ac, ac_value, ic, ic_value, letter, value, other = match.groups()
        if other == "SUPA":
            codes.append("SUPA")
        elif other:
            raise Unreadable(line)
        elif cr:
            w["CR"] = float(cr_value)
        elif ac:
            w[ac + "="] = float(ac_value)
        elif ic:
            increments[ic] = float(ic_value)
        elif letter == "G":
            codes.append(float(value))
        elif letter in "MSTDH":
            done.append("%s%g" % (letter, float(value)))
            if letter == "T":
                s.tool = int(float(value))
            elif letter == "D":
                s.length = s.m.spec["lengths"]["H%d" % s.tool] if float(value) else 0.0
        else:
            w[letter] = float(value)
    move = False
    for g in codes:
        if g in (0, 1, 2, 3):
            s.modal = int(g)
        elif g in (17, 18, 19):
            s.plane = int(g)
        elif g in (54, 55):
            s.offset = np.array(s.m.spec["offsets"]["G%d" % g])
            s.lost()
        elif g in (90, 91):
            s.absolute = g == 90
        elif g not in PASSED and g != "SUPA" and g != 153 and g != 4:
            raise Unreadable("G%s" % g)
    if 4 in codes:
        done.append("dwell %g" % w.get("F", 0))
        w = {}
    if "F" in w:
        s.feed = w.pop("F")
    modes = [g for g in codes if g not in (0, 1, 2, 3)]
    if modes or done:
        out.append(("do", number, " ".join([str(g) for g in modes] + done)))
    turned = {k: w[k] for k in s.m.rotary if k in w}
    for k, v in turned.items():
        s.theta = {**s.theta, k: v}
    if "SUPA" in codes or 153 in codes:
        out.append(("do", number, "machine " + " ".join(k for k in "XYZ" if k in w)))
        s.lost()
        return
    if turned:
        s.lost()
        out.append(("do", number, "turn " + " ".join("%s%.4f" % x for x in sorted(turned.items()))))
    axes = [k for k in "XYZ" if k in w or k in increments or k + "=" in w]
    if not axes:
        return
    target = s.at.copy()
    for k in axes:
        n = "XYZ".index(k)
        if k in increments:
            target[n] = s.at[n] + increments[k]
        elif k + "=" in w:
            target[n] = w[k + "="]
        else:
            target[n] = w[k] + (0.0 if s.absolute else s.at[n])
    words = dict(whole=s.whole(), theta=dict(s.theta), length_=s.length, feed=s.feed, number=number, named=axes, block=line)
    move = Motion(kind="rapid" if s.modal == 0 else "line", u0=s.at.copy(), u1=target, **words)
    if s.modal != 0 and (np.isnan(s.at).any() or None in s.theta.values()):
        raise Unreadable("feed from nowhere: " + line)
    if s.modal in (2, 3):
        arc(s, w, move)
    out.append(("motion", number, move))
    s.at = target


def arc(s, w, move):
    a, b, c = PLANES[s.plane]
    clockwise = s.modal == 2
    start, end, centre = move.u0, move.u1, move.u0.copy()
    if "CR" in w:
        chord = end[[a, b]] - start[[a, b]]
        half = np.linalg.norm(chord) / 2
        height = math.sqrt(max(w["CR"] ** 2 - half**2, 0.0))
        side = (-1.0 if clockwise else 1.0) * (1.0 if w["CR"] > 0 else -1.0)
        centre[[a, b]] = (start[[a, b]] + end[[a, b]]) / 2 + side * height * np.array([-chord[1], chord[0]]) / (2 * half)
    else:
        for n, name in ((a, "IJK"[a]), (b, "IJK"[b])):
            centre[n] = w[name + "="] if name + "=" in w else start[n] + w.get(name, 0.0)
    from_angle = math.atan2(start[b] - centre[b], start[a] - centre[a])
    sweep = math.atan2(end[b] - centre[b], end[a] - centre[a]) - from_angle
    sweep = -((-sweep) % (2 * math.pi)) if clockwise else sweep % (2 * math.pi)
    if np.array_equal(start[[a, b]], end[[a, b]]) or sweep == 0.0:
        sweep = -2 * math.pi if clockwise else 2 * math.pi
    r0, r1 = (math.hypot(p[a] - centre[a], p[b] - centre[b]) for p in (start, end))
    if not r0 > 0 or abs(r0 - r1) > 0.02:
        raise Unreadable("no arc: " + move.block)
    move.__dict__.update(kind="arc", axes=(a, b, c), centre=centre, from_angle=from_angle, sweep=sweep, radius=r0, end_radius=r1)
