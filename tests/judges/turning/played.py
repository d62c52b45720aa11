"""A corrector for the self-test only: writes each move as short lines solved on workpiece.py, and makes mistakes on request.

It proves that the judge passes what is right and finds what is wrong; it is no model of the product. Programs with G70..G73
(blocks P to Q) and LinuxCNC's are written out flat: head, every move, tail. Mistakes: "diameter" (half the correction in X: a radius taken for a diameter),
"U" (one X written as U), "alpha" (tailstock and headstock the wrong way), "tip" (the compensated way written out for another
tip direction), "20um".
"""

import json
import math

import numpy as np

import judge
import reader
import workpiece
from generate import CODES


def flat(spec, text):
    return spec["control"] == "linuxcnc-lathe" or any(f"{c} P" in text for code in CODES.values() for c in (code["71"], code["72"]))


def solve(lathe, spec, wanted, tool, shift, floor):
    """Program coordinates whose tip is really where `wanted` + shift (ideal, part) should be; shift is the way to the tip."""
    work, _, _ = judge.offsets(spec, tool)
    base = wanted + shift - work + np.array([spec["spindle"]["centre_mm"][0], 0])
    held = base.copy()
    held[:, 0] = np.maximum(held[:, 0], floor)
    goal = held + work - np.array([spec["spindle"]["centre_mm"][0], 0])
    q = held.copy()
    for _ in range(6):
        q = q - (judge.real(lathe, spec, q, tool) - goal)
    return base - shift + (q - held)


def pieces(motion):
    """Points of a move, its start left out."""
    if motion.kind != "feed":
        return np.array([motion.b])
    if not motion.arc:
        n = max(1, math.ceil(motion.length() / 2.0))
        t = np.arange(1, n + 1)[:, None] / n
        return np.array(motion.a) + t * (np.array(motion.b) - np.array(motion.a))
    cx, cz, sweep = motion.arc
    r0, r1 = math.hypot(motion.a[0] - cx, motion.a[1] - cz), math.hypot(motion.b[0] - cx, motion.b[1] - cz)
    n = max(2, math.ceil(abs(sweep) / math.sqrt(8 * 2e-4 / r0)))
    t = np.arange(1, n + 1) / n
    angle = math.atan2(motion.a[0] - cx, motion.a[1] - cz) + t * sweep
    r = r0 + t * (r1 - r0)
    return np.column_stack([cx + r * np.sin(angle), cz + r * np.cos(angle)])


def correct(spec, text, mistake=None, explicit=False):
    """The corrected program. explicit: the compensated way is written out under G40."""
    believed = json.loads(json.dumps(spec))
    if mistake == "alpha":
        for name in ("tailstock", "headstock"):
            if name in believed:
                believed[name]["offset_um"] = [-v for v in believed[name]["offset_um"]]
    if mistake == "tip":
        believed["tool"]["noses"]["H1"]["direction"] = {3: 4, 2: 1}[spec["tool"]["noses"]["H1"]["direction"]]
    lathe = workpiece.Lathe(believed)
    floor = judge.floor_of(spec, lathe)
    explicit = explicit or spec["control"] == "linuxcnc-lathe"
    if explicit:
        motions = reader.read(text, believed)[0]
    else:
        motions = (reader.Sinumerik if spec["control"] == "sinumerik-turn" else reader.Fanuc)(believed).play(text).motions
    lines = text.split("\n")
    moving = {m.line for m in motions}
    if flat(spec, text):
        # head: up to the first move, without subroutines; tail: from M9
        first = next(k for k, line in enumerate(lines) if line.startswith("G0 ") and not any("endsub" in later for later in lines[k:]))
        last = max(k for k, line in enumerate(lines) if line == "M9")
        begun = max([k + 1 for k, line in enumerate(lines) if "endsub" in line] or [0])
        tail = "\n".join(lines[last:])
        lines = lines[begun:first]
        moving = set()
        for m in motions:
            m.line = len(lines) + 1
    codes = CODES.get(spec.get("g_code_system", "A"))
    thread = codes["thread"] if spec["control"] == "fanuc-lathe" else "G33"
    factor = 2.0 if spec["x"] == "diameter" else 1.0
    out, copied, comp = [], 0, 0
    feed = None
    for m in motions:
        for k in range(copied, m.line - 1):
            if k + 1 not in moving and codes["75"] + " R" not in lines[k] and codes["76"] + " P" not in lines[k]:
                out.append(lines[k])
        copied = max(copied, m.line)
        radius, to_tip = reader.nose_of(believed, m.tool)
        shift = np.zeros(2)
        # a lead-in or lead-out is one block
        points = pieces(m) if m.comp == comp or explicit else np.array([m.b])
        if m.comp and m.length() > 1e-9 and not explicit:
            hx, hz = m.heading(True)
            side = 1.0 if m.comp == 41 else -1.0
            shift = radius * np.array([side * hz + to_tip[0], -side * hx + to_tip[1]])
        work, _, _ = judge.offsets(spec, m.tool)
        q = solve(lathe, believed, points + work - np.array([spec["spindle"]["centre_mm"][0], 0]), m.tool, shift, floor)
        if mistake == "diameter":
            q[:, 0] = points[:, 0] + (q[:, 0] - points[:, 0]) / 2
        code = {"rapid": "G0", "feed": "G1", "thread": thread}[m.kind]
        for p in q:
            change = "" if m.comp == comp or explicit else {0: "G40 ", 41: "G41 ", 42: "G42 "}[m.comp]
            comp = m.comp
            f = f" F{m.state[0]:g}" if m.kind != "rapid" and m.state[0] is not None and m.state[0] != feed else ""
            if f:
                feed = m.state[0]
            out.append(f"{change}{code} X{factor * p[0]:.4f} Z{p[1]:.4f}{f}")
    out += [tail] if flat(spec, text) else lines[copied:]
    result = "\n".join(out)
    if explicit:
        result = result.replace("G41", "G40").replace("G42", "G40")
    feeds = [k for k, line in enumerate(out) if line.startswith("G1 X")]
    if mistake in ("U", "20um") and feeds:
        k = feeds[len(feeds) // 2]
        if mistake == "U":
            out[k] = out[k].replace("X", "U")
        else:
            head, rest = out[k].split("X", 1)
            number, tail = rest.split(" ", 1)
            out[k] = f"{head}X{float(number) + 0.02 * factor:.4f} {tail}"
        result = "\n".join(out)
    return result
