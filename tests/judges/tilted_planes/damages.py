"""Damages to an output that `vpost check` has to find. A damage without harm, by this judge, is not asked for."""

import re

import numpy as np

import generate


def shifted(line, letter, by, decimals=4):
    return re.sub(r"(?<![A-Z])%s(-?[\d.]+)" % letter, lambda f: letter + generate.number(float(f.group(1)) + by, decimals), line, count=1)


def numbers(line, letters):
    found = (re.search(r"(?<![A-Z])%s(-?[\d.]+)" % letter, line) for letter in letters)
    return [float(x.group(1)) if x else 0.0 for x in found]


def laid(lines, k, line, letters, start):
    """The direction that a line's vector has, or of three points that of X and the plane's normal."""
    if not start:
        vector = np.array(numbers(line, letters))
        return vector / np.linalg.norm(vector)
    one, two, three = (np.array(numbers(line if j == k else lines[j], letters)) for j in range(start[0], start[0] + 3))
    x, z = (two - one) / np.linalg.norm(two - one), np.cross(two - one, three - one)
    return np.concatenate([x, z / np.linalg.norm(z)])


def number_of(line):
    found = re.match(r"N(\d+) ", line)
    return int(found.group(1)) if found else None


def all_of(rng, m, text_in, text_out):
    lines_in, lines = text_in.split("\n"), text_out.split("\n")
    blocks = {number_of(x): x for x in lines_in}
    inch = "G20" in text_in
    out = []

    def add(name, k, line):
        if line != lines[k]:
            out.append((name, "\n".join(lines[:k] + [line] + lines[k + 1 :])))

    # Words of a feed: pieces begin with X, Y or Z, or with their G.
    feeds = [k for k, x in enumerate(lines) if re.match(r"N\d+ (G0?[123] )?[XYZ]", x)]
    feeds = [k for k in feeds if number_of(lines[k]) not in blocks or "G0 " not in blocks[number_of(lines[k])]]
    for name in ("20 um", "-20 um"):
        if feeds:
            k = rng.choice(feeds)
            letter = rng.choice(re.findall(r"[XYZ]", lines[k]))
            add(name, k, shifted(lines[k], letter, (0.0008 if inch else 0.02) * (1 if name[0] == "2" else -1)))
    # The correction of one block left out: its own words again, and none of its pieces.
    changed = [k for k, x in enumerate(lines) if number_of(x) in blocks and blocks[number_of(x)] != x and re.search("[XYZ]", x) and k in feeds]
    if changed:
        k = rng.choice(changed)
        end = k + 1
        while end < len(lines) and number_of(lines[end]) is not None and number_of(lines[end]) not in blocks:
            end += 1
        out.append(("left out", "\n".join(lines[:k] + [blocks[number_of(lines[k])]] + lines[end:])))
    rotary = [k for k, x in enumerate(lines) if re.match(r"N\d+ G0 [ABC]", x)]
    if rotary:
        k = rng.choice(rotary)
        letter = rng.choice(re.findall(r"[ABC]", lines[k].split(" ", 1)[1]))
        add("0.01 degree", k, shifted(lines[k], letter, rng.choice((0.01, -0.01)), 6))
    # The other branch, where both angles stand in one block.
    both = [k for k in rotary if all(a in lines[k] for a in m.rotary)]
    if both:
        k = rng.choice(both)
        theta = {a: float(re.search(r"%s(-?[\d.]+)" % a, lines[k]).group(1)) for a in m.rotary}
        pairs = [p for p in m.angles(m.direction(theta)) if None not in p.values()]
        other = [p for p in pairs if any(abs((p[a] - theta[a] + 180) % 360 - 180) > 1 for a in p)]
        if other:
            add("other branch", k, "N%d G0 " % number_of(lines[k]) + " ".join("%s%s" % (a, generate.number(v, 6)) for a, v in other[0].items()))
    # The zero and the turn of each way of writing a plane: a check may know some of them only.
    for kind, mark in (("P0", r"G68\.2 (P0 )?X"), ("P1", r"G68\.2 P1 "), ("P2", r"G68\.2 P2 Q1"), ("P3", r"G68\.2 P3 Q1")):
        plane = [k for k, x in enumerate(lines) if re.search(mark, x)]
        if plane:
            k = rng.choice(plane)
            add("zero of %s 20 um" % kind, k, shifted(lines[k], rng.choice("XYZ"), 0.0008 if inch else 0.02, 6))
    for kind, mark, letters, by in (("P2", r"G68\.2 P2 Q[23]", "XYZ", 0.05), ("P3", r"G68\.2 P3 Q[12]", "IJK", 0.0)):
        plane = [k for k, x in enumerate(lines) if re.search(mark, x)]
        if plane:
            k = rng.choice(plane)
            size = by / (25.4 if inch else 1) or 1e-3 * max(abs(float(x)) for x in re.findall(r"[IJK](-?[\d.]+)", lines[k]))
            start = [j for j in range(k) if re.search(r"G68\.2 P2 Q1", lines[j])][-1:] if kind == "P2" else []
            ways = {c: shifted(lines[k], c, size, 6) for c in letters}
            was = laid(lines, k, lines[k], letters, start)
            # What only becomes longer, or moves in the plane, turns nothing.
            turning = [c for c in letters if np.abs(laid(lines, k, ways[c], letters, start) - was).max() > 1e-9]
            if turning:
                add("%s turned a little" % kind, k, ways[rng.choice(turning)])
    turned = [k for k, x in enumerate(lines) if re.search(r"G68\.2 (P0 )?X.*I.*J.*K", x)]
    if turned:
        k = rng.choice(turned)
        add("P0 turned about its Z", k, shifted(lines[k], "K", 0.02, 6))
    aligned = [k for k, x in enumerate(lines) if re.search(r"G53\.[16]$", x)]
    if aligned:
        k = rng.choice(aligned)
        out.append(("G53.1 gone", "\n".join(lines[:k] + lines[k + 1 :])))
    tool = [k for k, x in enumerate(lines) if "G43 H" in x]
    if tool:
        k = rng.choice(tool)
        add("other length", k, lines[k].replace("H1", "H9").replace("H2", "H1").replace("H9", "H2"))
    fed = [k for k in feeds if "F" in lines[k]]
    if fed:
        k = rng.choice(fed)
        add("feed", k, re.sub(r"F([\d.]+)", lambda f: "F" + generate.number(float(f.group(1)) / 2, 3), lines[k]))
    off = [k for k, x in enumerate(lines) if x.endswith("G69")]
    if off:
        out.append(("G69 gone", "\n".join(lines[: off[0]] + lines[off[0] + 1 :])))
    return out
