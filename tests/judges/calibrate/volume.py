"""Measurements in the volume: points anywhere (volumetric) and three traverses (tracker), in the documented formats.

`base` says what the command is given: "none" (only the chain), "own" (the machine's own profile: nothing changed since)
or "drift" (a profile, and the machine has changed since). The instrument is turned by up to `turn` rad and stands
anywhere; each run of `volumetric` has its own rotation and shift, the three traverses of a tracker share one.
"""

import os
from dataclasses import dataclass, field as member

import numpy

import reference
from field import Points, frame, grid, rest, rms
from machine import AXES, Machine, Smooth, Table, rotation, tabled, write_profile

ORDERS = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]


@dataclass
class Scenario:
    """One measurement: the command line, the truth and where and against what it is scored."""

    arguments: list
    truth: Machine
    points: Points
    own: object = None  # () -> positions at the points by the judge's own least squares of the same readings
    values: dict = member(default_factory=dict)  # printed name -> true value
    data: dict = member(default_factory=dict)
    corner: int = None  # row of `points` at the far corner

    @property
    def allowed_um(self):
        """RMS error of the judge's own least squares, which take longer than the command."""
        return rms(rest(self.own(), self.points.true(self.truth), self.points.group))


def vector_in_ball(rng, radius):
    v = rng.normal(size=3)
    return v / numpy.linalg.norm(v) * radius * rng.uniform(0.3, 1.0)


def travel(rng, size=(400, 300, 200)):
    low = [float(numpy.round(rng.uniform(-s, 0.2 * s))) for s in size]
    return [(l, l + s) for l, s in zip(low, size)]


def errors(rng, machine, length=8.0, angle=20.0, constant=50.0, slope=0.0, play=True, square=60.0):
    for axis in range(3):
        machine.functions[axis] = [Smooth(rng, *machine.travel[axis], length, angle, constant, slope)]
        machine.measured[axis] = {AXES[k]: float(numpy.round(rng.uniform(*machine.travel[k]), 1)) for k in range(3) if k != axis}
        machine.measured[axis]["tool"] = [float(v) for v in numpy.round(rng.uniform(-80, 80, 3), 1)]
    machine.play = numpy.round(rng.uniform(2, 10, 3), 3) * 1e-3 if play else numpy.zeros(3)
    machine.square = numpy.round(rng.uniform(-square, square, 3), 3) * 1e-6
    return machine


def drifted(rng, base, play=True, angle=6.0, length=4.0, nodes=None):
    """The base some time later: a change of every function (smooth, or hats on so many nodes), squareness and play."""
    truth = base.copy()
    for axis in range(3):
        change = Smooth(rng, *truth.travel[axis], length, angle, angle)
        if nodes:
            at = numpy.linspace(*truth.travel[axis], nodes)
            change = Table(at, change(at))
        truth.functions[axis] = truth.functions[axis] + [change]
    truth.square = truth.square + rng.uniform(-20, 20, 3) * 1e-6
    if play:
        truth.play = truth.play + rng.uniform(0, 3, 3) * 1e-3
    return truth


def save(path, header, rows, digits=6):
    with open(path, "w", encoding="utf-8") as file:
        file.write(header + "\n")
        for row in rows:
            file.write(",".join(v if isinstance(v, str) else f"{v:.{digits}f}".rstrip("0").rstrip(".") for v in row) + "\n")
    return path


def machine_with_base(rng, folder, base, order, nodes=None, **options):
    """(truth, base machine, arguments) for the kinds of base; with `nodes` what is to be found is hats on so many nodes."""
    truth = errors(rng, Machine(order, travel(rng)), **options)
    if base == "none":
        start = Machine(order, truth.travel)
        return (tabled(truth, nodes) if nodes else truth), start, ["--chain", truth.chain()]
    start = tabled(truth)
    if base == "scaled":
        start.scale = numpy.array([50e-6, -30e-6, 20e-6])
    start.warm = base == "warm"
    truth = drifted(rng, start, options["play"], nodes=nodes) if base == "drift" else start
    return truth, start, ["-m", write_profile(start, folder, "base")]


TOOLS = [(0.0, 0.0, 0.0), (0.0, 0.0, -150.0), (60.0, 40.0, -80.0)]


def volumetric(rng, folder, base="none", turn=0.05, noise=1.0, form="positions", order=(0, 1, 2), nodes=5, count=70,
               play=True, smooth=False, options=(), u=None, shift=1.0, **sizes):
    truth, start, arguments = machine_with_base(rng, folder, base, order, None if smooth else nodes, play=play, **sizes)
    q, tool, side, runs = [], [], [], []
    ends = numpy.array(truth.travel)
    for number, vector in enumerate(TOOLS):
        corners = numpy.stack(numpy.meshgrid(*ends), axis=-1).reshape(-1, 3)
        inside = numpy.round(rng.uniform(ends[:, 0], ends[:, 1], (count - 8, 3)), 3)
        q.append(numpy.vstack([corners, inside]))
        tool.append(numpy.tile(vector, (count, 1)))
        side.append(rng.choice([-1, 1], (count, 3)))
        runs += [f"r{number}"] * count
    q, tool, side, runs = numpy.vstack(q), numpy.vstack(tool), numpy.vstack(side), numpy.array(runs)
    ideal, real = q + tool, truth.position(q, tool, side)
    read = numpy.zeros_like(real)
    setups = {}
    for name in numpy.unique(runs):
        rows = runs == name
        setups[name] = (rotation(vector_in_ball(rng, turn))[0] if turn else numpy.eye(3), rng.uniform(-shift, shift, 3))
        read[rows] = real[rows] @ setups[name][0].T + setups[name][1]
    exact = read
    read = read + rng.normal(size=read.shape) * noise * 1e-3
    columns = [runs.astype(object)[:, None], q.astype(object), tool.astype(object)]
    header = "run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm"
    if play:
        header += ",dir_x,dir_y,dir_z"
        columns.append(side.astype(object))
    if form == "deviations":
        header += ",dx_um,dy_um,dz_um"
        columns.append(((read - ideal) * 1e3).astype(object))
    else:
        header += ",xm_mm,ym_mm,zm_mm"
        columns.append(read.astype(object))
    if u is not None:
        header += ",u_um"
        columns.append(numpy.full((len(q), 1), u, dtype=object))
    if base == "warm":
        header += ",temp_c"
        columns.append(numpy.full((len(q), 1), 24.0, dtype=object))
    table = numpy.hstack(columns)
    path = save(os.path.join(folder, "points.csv"), header, table, 9)
    points = grid(truth.travel, TOOLS, 5, play, one_frame=base in ("own", "scaled", "warm") and not noise, spread=bool(noise))

    def own():
        fitted, _ = reference.volumetric(start, q, tool, side if play else 0 * side, runs, read, nodes, with_play=play)
        return points.true(fitted)

    arguments = ["calibrate", "volumetric", path, "--nodes", nodes, *arguments, *options]
    data = dict(header=header, table=table, path=path, start=start, q=q, tool=tool, side=side, runs=runs, read=read, exact=exact)
    return Scenario(arguments, truth, points, own, {}, data)


def stations(rng, folder, base="none", noise=0.5, order=(0, 1, 2), nodes=5, count=160):
    """Distances of a tracking interferometer from stations that are known to a millimetre, a zero of the length each."""
    truth, start, arguments = machine_with_base(rng, folder, base, order, nodes, play=False)
    ends = numpy.array(truth.travel)
    rows, commands, vectors, places, lengths = [], [], [], [], []
    for number in range(8):
        tool = TOOLS[number % 3]
        corner = numpy.array([ends[k, (number >> k) & 1] for k in range(3)])
        nominal = corner + numpy.sign(corner - ends.mean(axis=1)) * (200.0, 150.0, 120.0) + tool
        station, zero = nominal + rng.uniform(-1, 1, 3), rng.uniform(-1, 1)
        q = numpy.round(rng.uniform(ends[:, 0], ends[:, 1], (count, 3)), 3)
        q[:8] = numpy.stack(numpy.meshgrid(*ends), axis=-1).reshape(-1, 3)
        length = numpy.linalg.norm(truth.position(q, tool) - station, axis=1) + zero
        length += rng.normal(size=count) * noise * 1e-3
        for at, l in zip(q, length):
            rows.append([f"s{number}", *at, *tool, *nominal, l])
        commands.append(q)
        vectors.append(numpy.tile(tool, (count, 1)))
        places.append(numpy.tile(nominal, (count, 1)))
        lengths.append(length)
    header = "run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,bx_mm,by_mm,bz_mm,length_mm"
    path = save(os.path.join(folder, "distances.csv"), header, rows, 9)
    points = grid(truth.travel, TOOLS, 5, False, one_frame=base == "own" and not noise, spread=bool(noise))

    def own():
        runs = numpy.array([row[0] for row in rows])
        stacked = [numpy.concatenate(v) for v in (commands, vectors, places, lengths)]
        return points.true(reference.distances(start, stacked[0], stacked[1], runs, stacked[2], stacked[3], nodes))

    return Scenario(["calibrate", "volumetric", path, "--nodes", nodes, *arguments], truth, points, own, {},
                    dict(header=header, table=numpy.array(rows, dtype=object), path=path))


def lines(machine, place, tool, count=16, side=None):
    """Least-squares directions of the three axes' true motions through a place: unit vectors and slopes."""
    slopes = []
    for axis in range(3):
        at = numpy.linspace(*machine.travel[axis], count)
        q = numpy.tile(numpy.asarray(place, float), (count, 1))
        q[:, axis] = at
        p = machine.position(q, tool)
        centred = at - at.mean()
        slopes.append(centred @ p / (centred @ centred))
    unit = [s / numpy.linalg.norm(s) for s in slopes]
    return unit, slopes


def line_angles(machine, place, tool, count=16):
    """EC0Y, EB0Z, EA0Z between those lines (rad) and the three scales."""
    (x, y, z), slopes = lines(machine, place, tool, count)
    return numpy.array([-x @ y, x @ z, -y @ z]), [numpy.linalg.norm(s) - 1 for s in slopes]


def tracker(rng, folder, base="none", turn=0.05, noise=1.0, order=(0, 1, 2), count=9, repeats=3, play=True,
            options=(), u=None, shift=1.0):
    """Three traverses through a common place; without a base only a machine whose angles are constant can be known."""
    truth = errors(rng, Machine(order, travel(rng)), angle=0.0 if base == "none" else 20.0, play=play)
    truth.tool = numpy.array([0.0, 0.0, 0.0])
    start, arguments = Machine(order, truth.travel), ["--chain", truth.chain()]
    ends = numpy.array(truth.travel)
    place = numpy.array([numpy.linspace(*t, count)[rng.integers(count)] for t in truth.travel])
    if base != "none":
        truth.tool = numpy.array([0.0, 0.0, -120.0])
        start = truth = tabled(truth)
        if base == "scaled":
            start.scale = numpy.array([50e-6, -30e-6, 20e-6])
        start.warm = base == "warm"
        if base == "drift":
            truth = drifted(rng, start, play, angle=0.0)
        arguments = ["-m", write_profile(start, folder, "base")]
    r = rotation(vector_in_ball(rng, turn))[0] if turn else numpy.eye(3)
    shift = rng.uniform(-shift, shift, 3)
    paths, traverses = [], []
    for axis, letter in enumerate("xyz"):
        at = numpy.linspace(*truth.travel[axis], count)
        rows, commands, sides, reads = [], [], [], []
        for sign in (1, -1) if play else (0,):
            for _ in range(repeats):
                for value in at[:: sign or 1]:
                    command, side = place.copy(), numpy.zeros(3)
                    command[axis], side[axis] = value, sign
                    commands.append(command)
                    sides.append(side)
        commands, sides = numpy.array(commands), numpy.array(sides)
        reads = truth.position(commands, truth.tool, sides) @ r.T + shift + rng.normal(size=commands.shape) * noise * 1e-3
        header = "x_mm,y_mm,z_mm,xm_mm,ym_mm,zm_mm" + (f",dir_{letter}" if play else "") + (",temp_c" if base == "warm" else "")
        for command, side, read in zip(commands, sides, reads):
            rows.append([*command, *read] + ([side[axis]] if play else []) + ([24.0] if base == "warm" else []))
        paths.append(save(os.path.join(folder, f"traverse_{letter}.csv"), header, rows, 9))
        traverses.append((commands, sides, reads, header, rows))
    points = grid(truth.travel, [truth.tool], 6, play, spread=bool(noise))

    def own():
        return tracker_reference(start, traverses, points, place)

    angles, scales = line_angles(truth, place, truth.tool, count)
    values = {k: v * 1e6 for k, v in zip(("EC0Y", "EB0Z", "EA0Z"), angles)}
    values |= {f"scale {AXES[k]}": scales[k] * 1e6 for k in range(3)}
    arguments = ["calibrate", "tracker", *paths, *arguments, *options]
    if u is not None:
        arguments += ["--u-um", u]
    return Scenario(arguments, truth, points, own, values, dict(paths=paths, traverses=traverses, start=start, place=place))


def tracker_reference(start, traverses, points, place):
    """Positions of base + change: what the three lines say beyond the base, added up along the axes."""
    expected = [start.position(c, start.tool, s) for c, s, *_ in traverses]
    r, shift = frame(numpy.vstack([t[2] for t in traverses]), numpy.vstack(expected))
    position = start.position(points.q, points.tool, points.side)
    for axis, (commands, sides, reads, *_) in enumerate(traverses):
        change = reads @ r.T + shift - expected[axis]
        nodes = numpy.unique(commands[:, axis])
        signs = numpy.unique(sides[:, axis])
        means = [
            numpy.array([change[(sides[:, axis] == sign) & (commands[:, axis] == n)].mean(axis=0) for n in nodes])
            for sign in signs
        ]
        middle = sum(means) / len(means)
        for k in range(3):
            position[:, k] += numpy.interp(points.q[:, axis], nodes, middle[:, k])
        if len(signs) == 2:  # the play: one number along the axis
            half = (means[0] - means[1])[:, axis].mean() / 2
            position[:, axis] -= half * points.side[:, axis]
    return position
