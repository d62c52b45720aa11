"""Running the command, reading what it says, and scoring a profile as a field.

A profile and the truth are compared at scoring points (command, tool, side of approach, rotary angles). What no
measurement can tell from its own set-up is a rigid motion: for each group of points (a run with its own set-up) the
rotation and shift that bring the profile's positions nearest to the true ones are taken off exactly (Kabsch 1976, no small
angles), and what is left is the error of the field.
"""

import os
import re

import numpy

from common import command


def run(vpost, arguments, folder=None):
    """(exit status, standard output, standard error) of one command."""
    return command.run(vpost, *arguments, folder=folder, seconds=120)


def said(stderr):
    """The codes of the messages with their first words, VP1110 (no date given) left out."""
    found = []
    for kind, code, text in re.findall(r"^(error|warning)(?:\[(VP\d+)\])?: (.*)$", stderr, re.M):
        if code != "VP1110":
            found.append(f"{kind[0].upper()}:{code or '-'} {text[:110]}")
    return found


class Points:
    """Where a field is scored."""

    def __init__(self, q, tool, side=None, angles=None, group=None):
        self.q = numpy.asarray(q, float)
        self.tool = numpy.broadcast_to(numpy.asarray(tool, float), self.q.shape)
        self.side, self.angles = side, angles
        self.group = numpy.zeros(len(self.q), int) if group is None else numpy.asarray(group)

    def true(self, machine):
        return machine.position(self.q, self.tool, self.side, self.angles)


def grid(travel, tools, count=5, sides=True, one_frame=True, spread=False):
    """A grid over the volume, or places spread all over it, for every tool (its own frame each, unless one_frame) and both sides."""
    axes = [numpy.linspace(low, high, count) for low, high in travel]
    nodes = places(travel) if spread else numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    q, tool, side, group = [], [], [], []
    for number, vector in enumerate(tools):
        for sign in (1, -1) if sides else (0,):
            q.append(nodes)
            tool.append(numpy.broadcast_to(numpy.asarray(vector, float), nodes.shape))
            side.append(numpy.full(nodes.shape, sign))
            group.append(numpy.full(len(nodes), 0 if one_frame else number))
    return Points(*(numpy.concatenate(v) for v in (q, tool, side)), group=numpy.concatenate(group))


def halton(count, dimensions):
    """Evenly spread numbers between 0 and 1 (count, dimensions), in step with nobody's nodes."""
    columns = []
    for base in (2, 3, 5, 7, 11)[:dimensions]:
        k, value, part = numpy.arange(1, count + 1), numpy.zeros(count), 1.0
        while k.any():
            part /= base
            value += part * (k % base)
            k = k // base
        columns.append(value)
    return numpy.stack(columns, axis=1)


def places(travel, count=216):
    """Places all over the travel: what a statement about 95 % of the volume speaks of, neither nodes nor ends alone."""
    low, high = numpy.array(travel).T
    return low + halton(count, len(low)) * (high - low)


def predict(vpost, profile, points, folder, temperature=None):
    """Positions that the product's own model gives at the points; `predict` is right to a nanometre and knows every key."""
    path = os.path.join(folder, "scored_points.csv")
    header, columns = "x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm", [points.q, points.tool]
    if points.side is not None:
        header += ",dir_x,dir_y,dir_z"
        columns.append(points.side)
    if points.angles is not None:
        with open(profile, encoding="utf-8") as file:
            chain = re.search(r'chain\s*=\s*"([^"]*)"', file.read()).group(1)
        for index, name in enumerate("ABC"):
            if name in chain:
                header += f",{name.lower()}_deg"
                columns.append(points.angles[:, index : index + 1])
    numpy.savetxt(path, numpy.hstack(columns), delimiter=",", header=header, comments="", fmt="%.9g")
    status, out, err = run(vpost, ["predict", path, "-m", profile, "--outside", "clamp", "-q", *(["--at", f"temp_c={temperature}"] if temperature else [])])
    if status:
        raise RuntimeError("predict refused the profile: " + err.strip()[:300])
    lines = out.strip().split("\n")
    first = lines[0].split(",").index("px_mm")
    return numpy.array([[float(v) for v in line.split(",")[first : first + 3]] for line in lines[1:]])


def frame(a, b):
    """Rotation R and shift s with R a + s nearest to b."""
    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    u, _, vt = numpy.linalg.svd((a - mean_a).T @ (b - mean_b))
    r = vt.T @ numpy.diag([1, 1, numpy.sign(numpy.linalg.det(vt.T @ u.T))]) @ u.T
    return r, mean_b - r @ mean_a


def rest(found, true, group):
    """Error vectors in um that no rigid motion per group takes away."""
    error = numpy.zeros_like(true)
    for number in numpy.unique(group):
        rows = group == number
        r, s = frame(found[rows], true[rows])
        error[rows] = found[rows] @ r.T + s - true[rows]
    return error * 1e3


def rms(error):
    return float(numpy.sqrt((error**2).sum(axis=1).mean()))


def stated_uncertainty(profile):
    """`uncertainty_um` of the profile, or None."""
    with open(profile, encoding="utf-8") as file:
        found = re.search(r"(?<![a-z_])uncertainty_um\s*=\s*([-+0-9.eE]+)", file.read())
    return float(found.group(1)) if found else None


NUMBER = r"([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)"


def printed(report):
    """{name: (value, half width)} of lines like `EC0Y   -33.97 ± 1.48 urad`."""
    found = {}
    for name, value, width in re.findall(rf"^ *(\S[^\n±]*?) +{NUMBER} ± +{NUMBER}", report, re.M):
        if "…" not in name:
            found.setdefault(" ".join(name.split()), (float(value), float(width)))
    return found
