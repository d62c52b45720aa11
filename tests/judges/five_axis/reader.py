"""Plays five-axis programs: LinuxCNC, Fanuc and Sinumerik words, to motions and to dense places of the axes.

What is not understood raises Unreadable: no verdict rather than a guessed one. Two interpolations: axes linear, and under
tool centre point control (TCP) the tip straight (or on its arc) in the workpiece and the rotary axes linear in the same
parameter, with the joints from the control's kinematics and its own centres.

Coordinates: without TCP an axis command is word + work offset (+ length on Z under G43); with TCP word + work offset is the
tip in the workpiece, which is the machine frame at angles 0. `rs274` gives LinuxCNC's own reading, to compare with.
"""

import math
import re

import numpy as np

from common.interpreter import interpret

import planes
from machine import Machine

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
WORD = re.compile(r"([A-Z](?:[0-9]*(?==)|[345](?==))?)(=?)(?:(DC|AC|IC|ACP|ACN)\(([-+0-9.]+)\)|([-+]?(?:\d+\.?\d*|\.\d+)))")
SILENT = {9, 40, 54, 61, 64, 80, 97, 98, 99, 61.1, 69, 710, 602, 642, 601, 641, 450}
ON = {"linuxcnc": ("M428",), "fanuc": ("G43.4", "G43.5", "G234"), "sinumerik": ("TRAORI",)}
OFF = {"linuxcnc": ("M429",), "fanuc": (), "sinumerik": ("TRAFOOF",)}


class Unreadable(Exception):
    """Something that this reader does not understand."""


class Motion:
    """One block's motion. `start`, `end` (3,): commands, or with `tcp` places of the tip in the workpiece; `rot0`, `rot1` (k,)
    degrees; `f` and `mode` the feed word in force (94 mm/min, 93 1/min, 95); `state` the process in force."""

    def __init__(self, kind, line, start, end, rot0, rot1, tool, tcp, arc, f, mode, state, named, plane=None):
        # With `plane` (rotation, zero) the places are those of the tip in the plane's own coordinates.
        self.plane = plane
        self.kind, self.line, self.tcp, self.arc, self.f, self.mode, self.state = kind, line, tcp, arc, f, mode, state
        self.start, self.end = np.array(start, float), np.array(end, float)
        self.rot0, self.rot1 = np.array(rot0, float), np.array(rot1, float)
        self.tool, self.named = np.array(tool, float), named

    def at(self, u):
        """Commands or tips in the workpiece (n, 3) and angles (n, k) at the shares u of the block."""
        places, rot = self.in_own_frame(u)
        return (places @ self.plane[0].T + self.plane[1] if self.plane else places), rot

    def in_own_frame(self, u):
        """The same in the coordinates of the program's words."""
        u = np.asarray(u, float)
        rot = self.rot0 + u[:, None] * (self.rot1 - self.rot0)
        if self.arc is None:
            return self.start + u[:, None] * (self.end - self.start), rot
        a, b, c = self.arc["axes"]
        out = np.empty((len(u), 3))
        angle = self.arc["angle"] + self.arc["sweep"] * u
        radius = self.arc["r0"] + (self.arc["r1"] - self.arc["r0"]) * u
        out[:, a] = self.arc["centre"][0] + radius * np.cos(angle)
        out[:, b] = self.arc["centre"][1] + radius * np.sin(angle)
        out[:, c] = self.start[c] + u * (self.end[c] - self.start[c])
        return out, rot

    def moves(self):
        return bool(self.arc) or not np.allclose(self.start, self.end, atol=1e-9) or not np.allclose(self.rot0, self.rot1, atol=1e-9)


def arc_of(start, end, plane, clockwise, words, scale, line):
    u, v, w = PLANES[plane]
    (su, sv), (eu, ev) = (start[u], start[v]), (end[u], end[v])
    radius = words.get("R", words.get("CR"))
    if radius is not None:
        r = radius * scale
        du, dv = eu - su, ev - sv
        chord = math.hypot(du, dv)
        if chord == 0:
            raise Unreadable(f"line {line}: a full circle by R")
        rise = math.sqrt(max(r * r - chord * chord / 4, 0.0))
        side = -1.0 if clockwise != (r < 0) else 1.0
        cu, cv = (su + eu) / 2 - side * rise * dv / chord, (sv + ev) / 2 + side * rise * du / chord
    else:
        names = "IJK"
        cu, cv = su + words.get(names[u], 0.0) * scale, sv + words.get(names[v], 0.0) * scale
    a0, a1 = math.atan2(sv - cv, su - cu), math.atan2(ev - cv, eu - cu)
    if abs(eu - su) < 1e-9 and abs(ev - sv) < 1e-9:
        sweep = 2 * math.pi
    else:
        sweep = ((a0 - a1) if clockwise else (a1 - a0)) % (2 * math.pi)
    return {"axes": (u, v, w), "centre": (cu, cv), "r0": math.hypot(su - cu, sv - cv), "r1": math.hypot(eu - cu, ev - cv),
            "angle": a0, "sweep": -sweep if clockwise else sweep}


def nearest(machine, wanted, now, travel):
    """Angles of two rotary axes (degrees) whose tool direction in the workpiece is `wanted`, the nearest to `now` in travel."""
    wanted = np.asarray(wanted, float)
    size = np.linalg.norm(wanted)
    if not size > 0:
        raise Unreadable("a direction of no length")
    wanted = wanted / size
    best = None
    zero = np.zeros((1, 3))
    # The ways differ by half a turn of one axis: what is this near from where the axes stand is the nearest.
    starts = [now] + [np.array([a, b], float) for a in range(-180, 180, 20) for b in range(-180, 180, 20)]
    for x in starts:
        if best is not None and best[0] < 60:
            break
        x = np.array(x, float)
        for _ in range(40):
            d = machine.place(zero, x[None, :], zero[0])[1][0] - wanted
            if np.linalg.norm(d) < 1e-13:
                break
            rows = np.concatenate([x + np.eye(2) * 1e-3, x - np.eye(2) * 1e-3])
            way = machine.place(np.zeros((4, 3)), rows, zero[0])[1]
            x = x - np.linalg.lstsq(((way[:2] - way[2:]) / 2e-3).T, d, rcond=1e-9)[0]
        if np.linalg.norm(machine.place(zero, x[None, :], zero[0])[1][0] - wanted) > 1e-10:
            continue
        x = x + 360 * np.round((now - x) / 360)
        if all(low - 1e-6 <= v <= high + 1e-6 for v, (low, high) in zip(x, travel)):
            cost = np.abs(x - now).sum()
            if best is None or cost < best[0] - 1e-9:
                best = (cost, x)
    if best is None:
        raise Unreadable(f"no angles for the direction {wanted}")
    return best[1]


def read(text, spec, start=None, wrong=None):
    """Motions and events [(number of motions before, text)] of a program on the machine `spec` (generate.py).

    `wrong`: a plane misread on purpose, for the self-test ("euler", "branch")."""
    control = Machine(spec, perfect=True, centres=spec.get("control_centres"))
    rotary, dialect = control.rotary, spec["control"]
    travel = [spec["rotary"][k]["travel"] for k in rotary]
    offset = np.array(spec["offset"], float)
    here = np.array(start, float) if start is not None else np.zeros(3)
    known = [start is not None] * 3
    rot, mode, plane, absolute, scale, length, tcp, vectors = np.zeros(len(rotary)), None, 17, True, 1.0, None, bool(spec.get("tcp_at_start")), False
    f, feed_mode, state = None, 94, {}
    motions, events = [], []
    tilted, parts, cycle = None, {}, None

    def tool():
        return np.array([0, 0, -spec["lengths"][length]], float) if length else np.array(spec["tool"], float)

    def shift():
        s = offset.copy()
        if length and not tcp:
            s[2] += spec["lengths"][length]
        return s

    def switch(on, line):
        """The axes stand; the coordinates change their meaning."""
        nonlocal here, tcp
        if on != tcp and all(known):
            here = Machine(spec, perfect=True, centres=spec.get("control_centres")).place(here, rot, tool())[0][0] if on else control.joints(here, rot, tool())[0]
        tcp = on

    for number, raw in enumerate(text.splitlines(), 1):
        code = re.sub(r"\([^)]*\)" if dialect != "sinumerik" else r"\x00", " ", raw).split(";")[0].upper().strip()
        if not code or code == "%" or re.match(r"O\d+$", code):
            continue
        if code.startswith("MSG"):
            continue
        compact = re.sub(r"\s+", "", code)
        for name in ("TRAORI", "TRAFOOF"):
            if compact in (name, name + "()") or re.match(r"N\d+" + name + r"(\(\))?$", compact):
                switch(name == "TRAORI", number)
                events.append((len(motions), name))
                compact = ""
        if not compact:
            continue
        pairs, rest = [], compact
        while rest:
            m = WORD.match(rest)
            if not m:
                m = re.match(r"(CR)(=)()()([-+]?(?:\d+\.?\d*|\.\d+))", rest)
            if not m:
                raise Unreadable(f"line {number}: {raw.strip()}")
            pairs.append((m.group(1), m.group(3), float(m.group(4) if m.group(3) else m.group(5))))
            rest = rest[m.end():]
        words, how, machine_frame = {}, {}, False
        tilts, aligns, drills = None, False, None
        g_length = None
        for letter, manner, value in pairs:
            if letter == "G":
                if value in (0, 1, 2, 3):
                    mode = int(value)
                elif value in PLANES:
                    plane = int(value)
                elif value in (20, 21, 70, 71, 700, 710):
                    scale = 25.4 if value in (20, 70, 700) else 1.0
                elif value in (90, 91):
                    absolute = value == 90
                elif value in (93, 94, 95):
                    feed_mode = int(value)
                    state["feed mode"] = feed_mode
                elif value in (43, 49, 43.4, 43.5, 234):
                    g_length = value
                elif value == 53:
                    machine_frame = True
                elif value in (68.2, 53.1, 69) and dialect == "fanuc":
                    tilts, aligns = value if value != 53.1 else tilts, aligns or value == 53.1
                    events.append((len(motions), f"G{value:g}"))
                elif value in (81, 82, 98, 99, 80):
                    drills = value
                    if value in (98, 99):
                        state["return"] = value
                elif value not in SILENT:
                    raise Unreadable(f"line {number}: G{value:g}")
                else:
                    state[f"G{value:g}"] = True
            elif letter == "M":
                if value == 428 or value == 429:
                    switch(value == 428, number)
                events.append((len(motions), f"M{value:g}"))
            elif letter in ("S", "T"):
                events.append((len(motions), f"{letter}{value:g}"))
            elif letter == "F":
                f = value * (1.0 if feed_mode == 93 else scale)
            elif letter in ("N", "P", "Q", "L", "D") and tilts != 68.2:
                if letter == "P" and "P" not in words:
                    events.append((len(motions), f"P{value:g}"))
            else:
                words[letter], how[letter] = value, manner
        if tilts == 68.2:
            if tcp:
                raise Unreadable(f"line {number}: a plane under TCP")
            parts[int(words.get("Q", 0)) if int(words.get("P", 0)) in (2, 3) else 0] = dict(words)
            found = planes.plane(parts, scale, wrong if wrong == "euler" else None)
            if found:
                turn, origin = found
                tilted, parts, known = (turn, origin + offset), {}, [False] * 3
            continue
        if tilts == 69 and tilted:
            tilted, known = None, [False] * 3
        if aligns:
            if not tilted:
                raise Unreadable(f"line {number}: G53.1 without a plane")
            turned = planes.by_rule(control, tilted[0][:, 2], rot, spec, opposite=wrong == "branch")
            motions.append(Motion("rapid", number, here, here, rot, turned, tool(), False, None, f, feed_mode, dict(state), ""))
            rot, known = turned, [False] * 3
            continue
        if g_length is not None:
            events.append((len(motions), f"G{g_length:g} H{words.get('H', 0):g}"))
            if g_length == 49:
                was = tool()
                if tcp:
                    switch(False, number)
                length, vectors = None, False
                del was
            else:
                length = f"H{int(words['H'])}" if "H" in words else length
                if g_length != 43:
                    switch(True, number)
                    vectors = g_length == 43.5
        letters = [c for c in words if c in "XYZ" or c in rotary or c in ("A3", "B3", "C3") or (vectors and c in "IJK")]
        if any(c in "ABC" and c not in rotary for c in words):
            raise Unreadable(f"line {number}: an axis that the machine lacks")
        if not letters and not (mode in (2, 3) and any(c in words for c in "IJK")):
            continue
        end, turned = here.copy(), rot.copy()
        s = np.zeros(3) if machine_frame or tilted else shift()
        if tilted and (machine_frame or any(c in words for c in rotary)):
            raise Unreadable(f"line {number}: a rotary word or G53 in a plane")
        if drills in (81, 82):
            cycle = {"initial": here[2]}
        elif drills == 80 or (mode is not None and any(a == "G" and v in (0, 1, 2, 3) for a, _, v in pairs)):
            cycle = None
        if cycle is not None:
            if "R" in words:
                cycle["R"] = words["R"] * scale + s[2]
            if "Z" in words:
                cycle["Z"] = words["Z"] * scale + s[2]
            if not all(known) or not absolute:
                raise Unreadable(f"line {number}: a hole from an unknown place")
            top = here.copy()
            for i in (0, 1):
                if "XY"[i] in words:
                    top[i] = words["XY"[i]] * scale + s[i]
            top[2] = cycle["R"]
            bottom, out = top.copy(), top.copy()
            bottom[2] = cycle["Z"]
            out[2] = max(cycle["initial"], cycle["R"]) if state.get("return", 98) == 98 else cycle["R"]
            for kind, a, b in (("rapid", here, top), ("feed", top, bottom), ("rapid", bottom, out)):
                motions.append(Motion(kind, number, a, b, rot, rot, tool(), tcp or tilted is not None, None, f, feed_mode, dict(state), "XYZ", tilted))
            here = out
            continue
        for i, c in enumerate("XYZ"):
            if c in words:
                add = how[c] == "IC" or (not absolute and how[c] != "AC")
                if add and not known[i]:
                    raise Unreadable(f"line {number}: an increment from nowhere")
                end[i] = words[c] * scale + (here[i] if add else s[i])
        for k, c in enumerate(rotary):
            if c in words:
                v = words[c]
                if how[c] == "IC" or (not absolute and not how[c]):
                    v = rot[k] + v
                elif how[c] == "DC":
                    v = v + 360 * round((rot[k] - v) / 360)
                elif how[c] == "ACP":
                    v = v + 360 * math.ceil((rot[k] - v) / 360 - 1e-12)
                elif how[c] == "ACN":
                    v = v + 360 * math.floor((rot[k] - v) / 360 + 1e-12)
                turned[k] = v
        if "A3" in words or "B3" in words or "C3" in words:
            turned = nearest(control, [words.get(n, 0.0) for n in ("A3", "B3", "C3")], rot, travel)
        elif vectors and mode in (0, 1) and any(c in words for c in "IJK"):
            turned = nearest(control, [words.get(n, 0.0) for n in "IJK"], rot, travel)
        before = all(known)
        for i, c in enumerate("XYZ"):
            known[i] = known[i] or c in words
        if mode is None:
            raise Unreadable(f"line {number}: a motion without a code")
        if mode and not before:
            raise Unreadable(f"line {number}: a feed from an unknown place")
        arc = arc_of(here, end, plane, mode == 2, words, scale, number) if mode in (2, 3) else None
        motions.append(Motion("feed" if mode else "rapid", number, here, end, rot, turned, tool(), tcp or tilted is not None, arc, f, feed_mode, dict(state), "".join(sorted(letters)), tilted))
        here, rot = end, turned
    return motions, events


def sample(motions, machine, control, sag=1e-5, mm=0.25, degrees=0.1):
    """Dense places of the axes: q (n, 3), rot (n, k), number of the motion (n,), share of it (n,), tool (n, 3). Between two rows
    the tip leaves its chord by at most `sag` mm, from its second differences; table kinks are reached by the steps mm and degrees."""
    q, rot, number, share, tools = [], [], [], [], []
    for n, m in enumerate(motions):
        if m.kind == "rapid":
            u = np.array([1.0])
        else:
            rough = np.linspace(0, 1, 17)
            p, r = joints(m, control, rough)
            tip = machine.place(p, r, m.tool)[0]
            second = np.abs(np.diff(tip, 2, axis=0)).max(axis=0, initial=0.0)
            pieces = 16 * math.sqrt(np.linalg.norm(second) / 8 / sag)
            pieces = max(pieces, np.linalg.norm(np.diff(tip, axis=0), axis=1).sum() / mm, np.abs(m.rot1 - m.rot0).max(initial=0) / degrees, np.abs(np.diff(p, axis=0)).sum(axis=0).max() / mm)
            # The middle at least: by that a piece is told to belong to a block, and its ends lie on two.
            u = np.linspace(0, 1, min(max(int(math.ceil(pieces)), 2), 40000) + 1)
        p, r = joints(m, control, u)
        q.append(p), rot.append(r), number.append(np.full(len(u), n)), share.append(u), tools.append(np.repeat(m.tool[None, :], len(u), axis=0))
    return np.concatenate(q), np.concatenate(rot), np.concatenate(number), np.concatenate(share), np.concatenate(tools)


def joints(m, control, u):
    p, r = m.at(u)
    return (control.joints(p, r, m.tool), r) if m.tcp else (p, r)


CANON = re.compile(r"(STRAIGHT_TRAVERSE|STRAIGHT_FEED|ARC_FEED|COMMENT)\((.*)\)")


def rs274(text, lengths=None, tries=3):
    """LinuxCNC's reading: [(kind, x, y, z, a, b, c)] in program coordinates; M428 and M429 are passed over (no remap here)."""
    tools = "".join(f"T{name[1:]} P{name[1:]} Z{value:.6f} D1\n" for name, value in (lengths or {}).items())
    said = interpret(re.sub(r"(?im)\bM0*42[89]\b", "", text), tools, "")
    if not said.whole and tries > 1:
        return rs274(text, lengths, tries - 1)  # its file of variables is not always written in time
    if not said.whole:
        raise Unreadable("rs274: " + said.trouble(300))
    out = []
    for kind, body in CANON.findall(said.calls):
        if kind == "COMMENT":
            continue
        v = [float(x) for x in body.split(",")]
        if kind == "ARC_FEED":
            out.append((kind, *v))
        else:
            out.append((kind, *v[:6]))
    return out
