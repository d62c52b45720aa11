"""A corrector of this judge's own, slow and plain: outputs known to be right, and wrong ones where the self-test misleads it.

Every feed becomes lines between places at which the crooked machine, solved with machine.py, has the tip where the program
says, as many as keep it there within a third of the tolerance. Cycles become their moves. The self-test changes what this
corrector takes machine and program for; the judge keeps its own.
"""

import math
import re

import numpy as np

import generate
import judge
import reader


def solved(m, motion, u):
    """Words (n, 3) at which the real tip is at u (n, 3) of the frame."""
    x = u.copy()
    for _ in range(5):
        x = x - (judge.in_frame(m, motion, x) - u)
    return x


def places(m, motion):
    """Words (n, 3) of straight pieces along a feed, without its start."""
    pieces, allowed = 1, m.spec["tolerance"] * 0.33e-3
    while pieces < 4096:
        x = solved(m, motion, motion.at(np.linspace(0, 1, pieces + 1)))
        worst = 0.0
        for s in (0.25, 0.5, 0.75):
            wanted = motion.at((np.arange(pieces) + s) / pieces)
            off = judge.in_frame(m, motion, x[:-1] + s * np.diff(x, axis=0)) - wanted
            worst = max(worst, float(np.linalg.norm(off, axis=1).max()))
        if worst <= allowed:
            break
        pieces *= 2
    return x[1:]


class Output:
    """Lines under way, with the words that stand for where the tool is: a distance of G91 counts from a rounded place."""

    def __init__(self, spec):
        self.spec, self.lines, self.at, self.unit, self.absolute = spec, [], np.zeros(3), 1.0, True

    def words(self, axes, u):
        out = []
        for k in axes:
            n = "XYZ".index(k)
            decimals = 4 if self.unit != 1.0 else round(-math.log10(self.spec["axes"][k]["resolution"]))
            new = round(float(u[n]) / self.unit, decimals)
            out.append(k + generate.number(new if self.absolute else new - self.at[n], decimals))
            self.at[n] = new
        return " ".join(out)


def correct(text, m):
    """The output for a program on the machine m."""
    blocks = iter(reader.read(text, m))
    out = Output(m.spec)
    for line in text.splitlines():
        if line.strip() in ("", "%") or re.fullmatch(r"O\d+", line.strip()):
            out.lines.append(line)
            continue
        _, words, motions = next(blocks)
        codes = [v for k, v in words if k == "G"]
        if 20 in codes:
            out.unit = 25.4
        if 90 in codes or 91 in codes:
            out.absolute = 90 in codes
        if not motions or np.isnan(motions[-1].u1).any():
            out.lines.append(line)  # no motion, or a rapid whose place nobody knows
            continue
        rest = re.sub(r"(?<![A-Z])[XYZABCIJKRQF]-?[\d.]+|(?<![A-Z])G0?[0123](?![\d.])|G8[13]", " ", line)
        turned = "".join(re.findall(r"[ABC]-?[\d.]+", line))
        fed = "".join(re.findall(r"F[\d.]+", line))
        here = []
        for x in motions:
            aim = solved(m, x, x.u1[None])[0]
            if x.kind == "rapid":
                axes = x.named if len(motions) == 1 else "XYZ"
                here.append("G0 %s %s" % (turned, out.words(axes, aim)))
                continue
            whole = places(m, x)
            if x.peck:
                depth, down = x.length(), 0.0
                while down < depth:
                    down = min(down + x.peck, depth)
                    place = solved(m, x, x.at([down / depth]))[0]
                    here.append("G1 " + out.words("XYZ", place) + " " + fed)
                    fed = ""
                continue
            for u in whole:
                here.append("G1 " + out.words("XYZ", u) + " " + fed)
                fed = ""
        here[0] = rest + " " + here[0]
        out.lines += [" ".join(x.split()) for x in here]
    return "\n".join(out.lines) + "\n"
