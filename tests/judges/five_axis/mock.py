"""A corrector of this judge's own, slow and plain, for the self-test: what a right output looks like, in every motion.

Every feed block becomes lines between places at which the crooked machine, solved with machine.py, has the tip exactly where the
ideal one would; as many as keep it there within a third of the tolerance in between. Machines without play only.
"""

import re

import numpy as np

from machine import Machine, about, times
from reader import joints, read


def solve(spec, m, u):
    """Words' places (n, 3) and angles (n, k) at the shares u of a motion, so that the real tip is the ideal one."""
    control = Machine(spec, perfect=True, centres=spec.get("control_centres"))
    ideal, real = Machine(spec, perfect=True), Machine(spec)
    p, rot = m.at(u)
    rot = np.round(rot, 3)
    target = m.at(u)[0] if m.tcp else ideal.place(p, m.at(u)[1], m.tool)[0]
    x = target.copy() if m.tcp else ideal.joints(target, rot, m.tool)
    for _ in range(6):
        q = control.joints(x, rot, m.tool) if m.tcp else x
        off = real.place(q, rot, m.tool)[0] - target
        if not m.tcp:
            for name in ideal.table:
                off = times(about(ideal.direction[name], rot[:, ideal.rotary.index(name)]), off)
        x = x - off
    return x, rot


def deviation(spec, m, pieces):
    """Largest distance between the ideal tip and that of straight pieces, mm."""
    control = Machine(spec, perfect=True, centres=spec.get("control_centres"))
    ideal, real = Machine(spec, perfect=True), Machine(spec)
    x, rot = solve(spec, m, np.linspace(0, 1, pieces + 1))
    worst = 0.0
    for s in (0.25, 0.5, 0.75):
        a, r = x[:-1] + s * np.diff(x, axis=0), rot[:-1] + s * np.diff(rot, axis=0)
        q = control.joints(a, r, m.tool) if m.tcp else a
        u = (np.arange(pieces) + s) / pieces
        p, wanted = m.at(u)
        target = p if m.tcp else ideal.place(p, wanted, m.tool)[0]
        worst = max(worst, np.linalg.norm(real.place(q, r, m.tool)[0] - target, axis=1).max())
    return worst


def correct(text, spec, split=True, wrong=None):
    """`wrong`: planes are misread on purpose."""
    motions, _ = read(text, spec, wrong=wrong)
    by_line = {m.line: [] for m in motions}
    for m in motions:
        by_line[m.line].append(m)
    rotary = Machine(spec, perfect=True).rotary
    equals = "=" if spec["control"] == "sinumerik" else ""
    out, before = [], "rapid"
    for number, raw in enumerate(text.splitlines(), 1):
        if number not in by_line:
            out.append(raw)
            continue
        if len(by_line[number]) > 1:
            # A hole: its moves.
            f = re.search(r"F[\d.]+", raw)
            for m in by_line[number]:
                pieces = 1
                while m.kind == "feed" and pieces < 4096 and deviation(spec, m, pieces) > spec["tolerance_um"] * 0.33e-3:
                    pieces *= 2
                places = solve(spec, m, np.linspace(0, 1, pieces + 1))[0]
                for x in (places[1:] if m.kind == "feed" else places[-1:]):
                    local = (x - m.plane[1]) @ m.plane[0]
                    out.append(" ".join([f"G{1 if m.kind == 'feed' else 0}"] + [f"{c}{v:.3f}" for c, v in zip("XYZ", local)] + ([f.group(0)] if f and m.kind == "feed" else [])))
            before = "rapid"
            continue
        m = by_line[number][0]
        offset = np.array(spec["offset"]) + ([0, 0, 0] if m.tcp or not spec["lengths"] else [0, 0, -m.tool[2]])

        if m.plane and not m.named:
            out.append(raw)  # G53.1
            continue

        def words(x, rot, linear="XYZ", turning=rotary):
            # In a plane: its own coordinates, and no rotary words.
            linear_words, turning = ((x - m.plane[1]) @ m.plane[0], []) if m.plane else (x - offset, turning)
            texts = [f"{c}{v:.3f}" for c, v in zip("XYZ", linear_words) if c in linear]
            return " ".join(texts + [f"{c}{equals}{v:.3f}" for c, v in zip(rotary, rot) if c in turning])

        rest = re.sub(r"(?<![A-Z])[XYZABCIJKR]=?-?[\d.]+", " ", raw)
        if m.kind == "rapid":
            x, rot = solve(spec, m, np.array([1.0]))
            linear = [c for c in "XYZ" if c in m.named]
            out.append(" ".join((rest + " " + words(x[0], rot[0], linear, [c for c in rotary if c in m.named])).split()))
            before = "rapid"
            continue
        pieces = 1
        while split and pieces < 4096 and m.moves() and deviation(spec, m, pieces) > spec["tolerance_um"] * 0.33e-3:
            pieces *= 2
        x, rot = solve(spec, m, np.linspace(0, 1, pieces + 1))
        rest = re.sub(r"G0?[123](?![\d.])", " ", rest)
        f = re.search(r"F-?[\d.]+", rest)
        rest = re.sub(r"F-?[\d.]+", " ", rest)
        feed = (f" F{m.f * pieces:.5f}" if m.mode == 93 else f" {f.group(0)}" if f else "")
        if before == "rapid":
            out.append(f"G1 {words(x[0], rot[0])}" + (feed if m.mode != 93 else " F60000"))
        before = "feed"
        for k in range(1, pieces + 1):
            out.append(" ".join(f"{rest if k == 1 else ''} G1 {words(x[k], rot[k])}{feed if m.mode == 93 or k == 1 else ''}".split()))
    return "\n".join(out) + "\n"
