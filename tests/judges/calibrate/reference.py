"""The judge's own least squares: what the readings allow.

Reading = rotation of the run (machine position) + shift of the run. The machine is base + change; the change is, for each
axis, six functions as sums of hats on equal nodes (no value is held anywhere: what cannot be told is left to the least
norm), and the play. Gauss-Newton on the exact chain with the first-order Jacobian (14).
"""

import numpy

from field import frame
from machine import Table, rotation

AXES = "XYZ"


def hats(nodes, q):
    """Weights (n, k) of the nodes at q."""
    return numpy.stack([numpy.interp(q, nodes, row) for row in numpy.eye(len(nodes))], axis=1)


def solve(jacobian, rest, cut=1e-7):
    """Least squares of least norm with columns scaled to 1."""
    size = numpy.linalg.norm(jacobian, axis=0)
    size[size == 0] = 1.0
    return numpy.linalg.lstsq(jacobian / size, rest, rcond=cut)[0] / size


def changed(base, nodes, values, play):
    """The base with hat functions and play added."""
    machine = base.copy()
    for axis in range(3):
        machine.functions[axis] = machine.functions[axis] + [Table(nodes[axis], values[axis])]
    machine.play = base.play + play
    return machine


def function_blocks(base, nodes, q, tool, side):
    """Derivatives of the position by the nodes' values, axis by axis and component by component, and by the play."""
    blocks = []
    for axis in range(3):
        arm = numpy.array(tool, float) - base.lever(axis)
        for later in base.order[base.order.index(axis) + 1 :]:
            arm[:, later] += q[:, later]
        weight = hats(nodes[axis], q[:, axis])
        for component in range(6):
            unit = numpy.zeros(3)
            unit[component % 3] = 1.0
            vector = numpy.broadcast_to(unit, q.shape) if component < 3 else numpy.cross(unit, arm)
            blocks.append(vector[:, :, None] * weight[:, None, :])
    if side is not None:
        for axis in range(3):
            unit = numpy.zeros(3)
            unit[axis] = 1.0
            blocks.append((unit * (-side[:, axis : axis + 1] / 2))[:, :, None])
    return blocks


def take(x, values, play, with_play):
    """Adds the step x to the nodes' values and the play; returns the next index and the play."""
    at = 0
    for table in values:
        for component in range(6):
            table[:, component] += x[at : at + len(table)]
            at += len(table)
    if with_play:
        return at + 3, play + x[at : at + 3]
    return at, play


def distances(base, q, tool, runs, stations, length, count, rounds=4):
    """Machine fitted to distances; the station (3) and the zero of the length of each run are unknown as well."""
    travel = [(q[:, a].min(), q[:, a].max()) for a in range(3)]
    nodes = [numpy.linspace(*t, count) for t in travel]
    values = [numpy.zeros((count, 6)) for _ in range(3)]
    functions = numpy.concatenate(function_blocks(base, nodes, q, tool, None), axis=2)
    names = list(numpy.unique(runs))
    marks = numpy.stack([(runs == name).astype(float) for name in names], axis=1)
    place, zero = numpy.stack([stations[runs == name][0] for name in names]), numpy.zeros(len(names))
    machine = base
    for _ in range(rounds):
        away = machine.linear(q, tool) - marks @ place
        far = numpy.linalg.norm(away, axis=1)
        left = length - far - marks @ zero
        ideal = q + tool - marks @ place
        unit = ideal / numpy.linalg.norm(ideal, axis=1)[:, None]  # the ideal geometry keeps exact what is the same
        columns = [numpy.einsum("ni,nik->nk", unit, functions)]
        columns += [-marks * unit[:, k : k + 1] for k in range(3)] + [marks]
        x = solve(numpy.concatenate(columns, axis=1), left, 1e-6)
        at, _ = take(x, values, 0, False)
        place = place + x[at : at + 3 * len(names)].reshape(3, -1).T
        zero = zero + x[at + 3 * len(names) :]
        machine = changed(base, nodes, values, numpy.zeros(3))
    return machine


def volumetric(base, q, tool, side, runs, read, count, weights=None, rounds=3, with_play=True):
    """Machine fitted to measured positions `read` (n, 3), a rotation and shift a run; the rest (n, 3) is returned too."""
    travel = [(q[:, a].min(), q[:, a].max()) for a in range(3)]
    nodes = [numpy.linspace(*t, count) for t in travel]
    values, play = [numpy.zeros((count, 6)) for _ in range(3)], numpy.zeros(3)
    names = list(numpy.unique(runs))
    machine = base
    position = machine.linear(q, tool, side)
    setups = {}
    for name in names:
        rows = runs == name
        setups[name] = frame(position[rows], read[rows])
    functions = function_blocks(base, nodes, q, tool, side if with_play else None)
    weights = numpy.ones(len(q)) if weights is None else weights
    for _ in range(rounds):
        turns = numpy.stack([setups[r][0] for r in runs])
        shifts = numpy.stack([setups[r][1] for r in runs])
        turned = numpy.einsum("nij,nj->ni", turns, position)
        left = read - turned - shifts
        ideal = numpy.einsum("nij,nj->ni", turns, q + tool)  # exact gauge: without errors nothing splits what is the same
        blocks = [numpy.einsum("nij,njk->nik", turns, block) for block in functions]
        for name in names:
            mark = (runs == name).astype(float)
            for k in range(3):
                unit = numpy.zeros(3)
                unit[k] = 1.0
                blocks.append((mark[:, None] * unit)[:, :, None])
                blocks.append((mark[:, None] * numpy.cross(unit, ideal))[:, :, None])
        jacobian = numpy.concatenate(blocks, axis=2) * weights[:, None, None]
        x = solve(jacobian.reshape(-1, jacobian.shape[2]), (left * weights[:, None]).ravel())
        at, play = take(x, values, play, with_play)
        for name in names:
            step = x[at : at + 6]
            r, s = setups[name]
            setups[name] = (rotation(step[1::2])[0] @ r, s + step[0::2])
            at += 6
        machine = changed(base, nodes, values, play)
        position = machine.linear(q, tool, side)
    turns = numpy.stack([setups[r][0] for r in runs])
    shifts = numpy.stack([setups[r][1] for r in runs])
    return machine, read - numpy.einsum("nij,nj->ni", turns, position) - shifts


def gauss_newton(model, start, read, steps, rounds=5):
    """Parameters of a small problem by numeric derivatives; `steps` are the sizes of the differences."""
    x = numpy.array(start, float)
    for _ in range(rounds):
        here = model(x)
        columns = []
        for k, step in enumerate(steps):
            moved = x.copy()
            moved[k] += step
            columns.append((model(moved) - here) / step)
        x = x + solve(numpy.stack(columns, axis=1), read - here)
    return x, read - model(x)
