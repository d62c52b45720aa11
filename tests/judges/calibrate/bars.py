"""Measurements along lines and with a ball bar: interferometer, circles of linear axes, rotary axes of a table.

interferometer  Runs through a place with the optics at a tool vector. Read are the true motions of that point: the
                position from the first target, straightness less the line of a straightedge that lies askew, and the turn
                of the carriage since the first target, where the instrument's software sets its angles to zero. Squareness
                is the true angle between the least-squares lines of those motions.
circles         Both ways round in three planes; centre up to a millimetre off, a length error a run.
table           The four tests and the spindle turn, for a table of any two rotary axes in either order.
"""

import os

import numpy

import reference
from field import Points, grid, places
from machine import AXES, Machine, Rotary, Smooth, Table, location, tabled, write_profile
from volume import Scenario, drifted, errors, line_angles, lines, save, travel


def turn_vector(matrix):
    """Rotation vectors (n, 3) of small rotations."""
    return numpy.stack([matrix[:, 2, 1] - matrix[:, 1, 2], matrix[:, 0, 2] - matrix[:, 2, 0], matrix[:, 1, 0] - matrix[:, 0, 1]], axis=1) / 2


def readings(rng, truth, axis, place, tool, targets, runs, play, noise, noise_urad, slope=30e-6):
    """Rows (run, side, target, six errors in mm and rad) of an interferometer on one axis."""
    rows = []
    tilt, offset = rng.uniform(-1, 1, 3) * slope, rng.uniform(-1, 1, 3) * 0.02
    tilt[axis] = 0.0
    q0 = numpy.array([place], float)
    q0[0, axis] = targets[0]
    zero, turn0 = truth.linear(q0, tool, None if not play else numpy.eye(3)[axis : axis + 1], turned=True)
    offset[axis] = 0.0
    for number in range(runs):
        for sign in (1, -1) if play else (1,):
            q = numpy.tile(numpy.asarray(place, float), (len(targets), 1))
            q[:, axis] = targets
            side = numpy.zeros_like(q)
            side[:, axis] = sign if play else 0
            p, turn = truth.linear(q, tool, side, turned=True)
            e = p - zero
            e[:, axis] -= targets - targets[0]
            e += (targets - targets.mean())[:, None] * tilt + offset
            e = numpy.hstack([e, turn_vector(turn @ turn0[0].T)])
            e[:, :3] += rng.normal(size=(len(q), 3)) * noise * 1e-3
            e[:, 3:] += rng.normal(size=(len(q), 3)) * noise_urad * 1e-6
            order = range(len(q))[:: sign]
            rows += [[number + 1, sign, targets[k], *e[k]] for k in order]
    return rows


def interferometer(rng, folder, base="none", noise=0.3, order=(0, 1, 2), count=9, runs=5, play=True,
                   axes=(0, 1, 2), only=None, squareness=None, options=(), through=True):
    """`only` names the functions written (all of them else); `axes` those measured; own base: nothing has changed."""
    truth = errors(rng, Machine(order, travel(rng)), play=play)
    place = numpy.array([numpy.round(rng.uniform(l + 0.3 * (h - l), l + 0.7 * (h - l)), 1) for l, h in truth.travel])
    truth.tool = tool = numpy.array([0.0, 0.0, -120.0])
    start, arguments = Machine(order, truth.travel), ["--chain", truth.chain()]
    if base == "none":
        truth = tabled(truth, count)
    else:
        start = truth = tabled(truth, count)
        if base == "scaled":
            start.scale = numpy.array([50e-6, -30e-6, 20e-6])
        start.warm = base == "warm"
        if base == "drift":
            truth = drifted(rng, start, play, nodes=count)
        arguments = ["-m", write_profile(start, folder, "base")]
    if through:
        arguments += ["--through", ",".join(f"{v:g}" for v in place), "--optics", "0,0,-120"]
    paths, data = [], {}
    for axis in axes:
        letter = AXES[axis]
        targets = numpy.linspace(*truth.travel[axis], count)
        rows = readings(rng, truth, axis, place, tool, targets, runs, play, noise, noise)
        data[axis] = rows
        names = [f"E{d}{letter}" for d in "XYZABC"]
        chosen = [k for k, n in enumerate(names) if only is None or n[1] in only]
        header = "run,dir,position_mm," + ",".join(names[k] + ("_um" if k < 3 else "_urad") for k in chosen) + (",temp_c" if base == "warm" else "")
        written = [[*row[:3], *(row[3 + k] * (1e3 if k < 3 else 1e6) for k in chosen), *([24.0] if base == "warm" else [])] for row in rows]
        paths.append(save(os.path.join(folder, f"line_{letter.lower()}.csv"), header, written, 8))
        data[letter] = (header, written, paths[-1])
    angles, _ = line_angles(truth, place, tool, count)
    if squareness is None:
        squareness = base in ("none", "drift")
    if squareness:
        c, b, a = angles * 1e6
        arguments += ["--squareness", f"XY={c:.4f},ZX={b:.4f},YZ={a:.4f}", "--squareness-convention", "right-handed",
                      "--straightness-slopes", "remove"]
    identity = base in ("own", "scaled", "warm")
    points = grid(truth.travel, [tool, (50.0, -60.0, -20.0)] if identity and not noise else [tool], 5, play, spread=bool(noise))

    def own():
        return points.true(line_reference(truth, start, data, place, tool, angles))

    return Scenario(["calibrate", "interferometer", *paths, *arguments, *options], truth, points, own, {}, dict(data, paths=paths, start=start))


def line_reference(truth, start, data, place, tool, angles):
    """Tables straight from the means, the line taken out, then the squareness that makes the lines' angles come out."""
    machine = Machine(truth.order, truth.travel)
    machine.scale = start.scale * 0
    for axis in range(3):
        rows = numpy.array(data[axis], float)
        nodes = numpy.unique(rows[:, 2])
        sides = [numpy.array([rows[(rows[:, 2] == n) & (rows[:, 1] == s), 3:].mean(axis=0) for n in nodes]) for s in numpy.unique(rows[:, 1])]
        mean = sum(sides) / len(sides)
        for k in range(3):
            if k != axis:
                mean[:, k] -= numpy.polyval(numpy.polyfit(nodes, mean[:, k], 1), nodes)
        machine.functions[axis] = [Table(nodes, mean)]
        machine.measured[axis] = {AXES[k]: place[k] for k in range(3) if k != axis} | {"tool": list(tool)}
        if len(sides) == 2:
            machine.play[axis] = (sides[0] - sides[1])[:, axis].mean()
    found, _ = line_angles(machine, place, tool, len(nodes))
    machine.square = angles - found
    return machine


PLANES = [(0, 1), (2, 0), (1, 2)]


def circles(rng, folder, base="bare", noise=0.3, order=(0, 1, 2), off=1.0, arm=100.0, count=60, options=(),
            scales=False, planes=PLANES):
    """Circles; "bare": a base without tables, a machine with squareness, play and constant angles only."""
    truth = errors(rng, Machine(order, travel(rng, (500, 450, 400))))
    centre = numpy.array([numpy.round(rng.uniform(l + arm + 5, h - arm - 5)) for l, h in truth.travel])
    if base in ("bare", "none"):
        for axis in range(3):
            truth.functions[axis] = [Table(truth.travel[axis], numpy.tile(numpy.concatenate([[0] * 3, rng.uniform(-50e-6, 50e-6, 3)]), (2, 1)))]
        if scales:
            truth.scale = rng.uniform(-40e-6, 40e-6, 3)
        start = Machine(order, truth.travel)
        arguments = ["-m", write_profile(start, folder, "base", tables=False)] if base == "bare" else ["--chain", truth.chain()]
    else:
        start = truth = tabled(truth)
        if base == "scaled":
            start.scale = numpy.array([50e-6, -30e-6, 20e-6])
        if base == "drift":
            truth = start.copy()
            truth.square = start.square + rng.uniform(-30, 30, 3) * 1e-6
            truth.play = start.play + rng.uniform(0, 4, 3) * 1e-3
        arguments = ["-m", write_profile(start, folder, "base")]
    rows, q, side, runs, length, middle = [], [], [], [], [], []
    for a, b in planes:
        for way in (1, -1):
            shift, zero = rng.uniform(-off, off, 3), rng.uniform(-0.02, 0.02)
            shift[3 - a - b] *= 0.1  # across the circle nothing shows it, and its square is a longer bar
            angle = way * (numpy.arange(count) + 0.5) * 2 * numpy.pi / count
            commands, sides = numpy.tile(centre, (count, 1)), numpy.zeros((count, 3))
            commands[:, a] += arm * numpy.cos(angle)
            commands[:, b] += arm * numpy.sin(angle)
            commands = numpy.round(commands, 6)
            sides[:, a], sides[:, b] = numpy.sign(-way * numpy.sin(angle)), numpy.sign(way * numpy.cos(angle))
            ball = centre + truth.tool + shift
            read = numpy.linalg.norm(truth.position(commands, truth.tool, sides) - ball, axis=1) + zero
            read += rng.normal(size=count) * noise * 1e-3
            name = f"{AXES[a]}{AXES[b]}{'+' if way > 0 else '-'}"
            for at, s, l in zip(commands, sides, read):
                rows.append([name, *(at + truth.tool), *(centre + truth.tool), *s, l])
            q.append(commands), side.append(sides), length.append(read)
            runs += [name] * count
            middle.append(numpy.tile(centre + truth.tool, (count, 1)))
    header = "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,dir_x,dir_y,dir_z,length_mm"
    q, side, length, middle, runs = numpy.vstack(q), numpy.vstack(side), numpy.concatenate(length), numpy.vstack(middle), numpy.array(runs)
    path = save(os.path.join(folder, "circles.csv"), header, rows, 9)
    points = grid(truth.travel, [truth.tool], 5, True, spread=bool(noise))
    values = {}
    if base in ("bare", "none"):
        found, slopes = line_angles(truth, centre, truth.tool)
        values = {k: v * 1e6 for k, v in zip(("EC0Y", "EB0Z", "EA0Z"), found)}
        values |= {f"backlash {AXES[k]}": truth.play[k] * 1e3 for k in range(3)}
        values |= {f"scale {AXES[a]}-{AXES[b]}": (truth.scale[a] - truth.scale[b]) * 1e6 for a, b in PLANES}

    def own():
        return points.true(circle_reference(start, q, side, runs, middle, length))

    return Scenario(["calibrate", "ballbar", path, *arguments, *options], truth, points, own, values,
                    dict(header=header, rows=rows, path=path, start=start, centre=centre))


def circle_reference(start, q, side, runs, middle, length):
    names = list(numpy.unique(runs))
    index = numpy.array([names.index(r) for r in runs])

    def machine(x):
        m = start.copy()
        m.square, m.play = start.square + x[0:3], start.play + x[3:6]
        m.scale = start.scale + numpy.array([x[6], x[7], -x[6] - x[7]])
        return m

    across = numpy.array([numpy.ptp(q[index == k], axis=0).argmin() for k in range(len(names))])

    def model(x):
        offset = numpy.zeros((len(names), 3))
        for k, (u, v, _) in enumerate(x[8:].reshape(-1, 3)):
            plane = [axis for axis in range(3) if axis != across[k]]
            offset[k, plane] = u, v
        zero = x[8:].reshape(-1, 3)[index, 2]
        return numpy.linalg.norm(machine(x).position(q, start.tool, side) - middle - offset[index], axis=1) + zero

    count = 8 + 3 * len(names)
    x, _ = reference.gauss_newton(model, numpy.zeros(count), length, [1e-4] * 3 + [1e-2] * 3 + [1e-4] * 2 + [1e-2] * (3 * len(names)))
    fitted = machine(x)
    fitted.scale = start.scale  # the mismatch is not the field's: one scale of the three stays unknown
    return fitted


TESTS = {"A": (numpy.array([100.0, 0, 0]), numpy.array([0, -100.0, 0])), "B": (numpy.array([0, 100.0, 0]), numpy.array([100.0, 0, 0])),
         "C": (numpy.array([0, 0, 100.0]), numpy.array([100.0, 0, 0]))}


def rotary_axis(rng, name, centre, size=200.0):
    axis = Rotary(name, centre)
    for k in range(3):
        if k != axis.index:
            axis.shift[k] = numpy.round(rng.uniform(-size, size), 3) * 1e-3
            axis.tilt[k] = numpy.round(rng.uniform(-size, size), 3) * 1e-6
    return axis


def table(rng, folder, base="bare", names="CA", noise=0.3, order=(0, 1, 2), apart=0.0, step=10, options=(),
          spindle=True, crossing=False, head=False):
    """A table, `names` in chain order from the workpiece ("CA": A carries C); `apart`: the second centre along its own axis."""
    truth = Machine(order, [(0, 600), (0, 500), (-700, 0)])
    place = numpy.array([300.0, 250.0, -350.0])
    if base != "bare":
        truth = tabled(errors(rng, truth))
    second = place.copy()
    second["ABC".index(names[0])] -= apart
    built = [rotary_axis(rng, names[0], second), rotary_axis(rng, names[1], place)]
    truth.table = built
    start = truth.copy()
    if base == "bare":
        for axis in start.table:
            axis.shift[:], axis.tilt[:] = 0, 0
    if base == "drift":
        for axis in truth.table:
            other = rotary_axis(rng, axis.name, axis.centre, 50.0)
            axis.shift, axis.tilt = axis.shift + other.shift, axis.tilt + other.tilt
    written = start.copy()
    if head:
        written.head, written.table = written.table[::-1], []
    arguments = ["-m", write_profile(written, folder, "base", tables=base != "bare")]
    if crossing:
        arguments += ["--crossing", ",".join(f"{v:g}" for v in place)]
    cup, rows, tests = numpy.append(rng.uniform(-0.1, 0.1, 2), 0.0), [], []
    plan = [(n + str(k + 1), n, k) for n in sorted(names) for k in range(2)] + ([("spindle", None, 0)] if spindle else [])
    for name, turning, number in plan:
        beside, bar = TESTS[turning] if turning else (0 * place, numpy.array([100.0, 0, 0]))
        q, zero = place + number * beside, rng.uniform(-0.02, 0.02)
        turns = numpy.arange(0, 361, step, dtype=float)
        angles = numpy.zeros((len(turns), 3))
        if turning:
            angles[:, "ABC".index(turning)] = turns
        tests.append((name, q, bar, angles, turns if not turning else 0 * turns))
        read = bar_length(truth, tests[-1], cup) + zero + rng.normal(size=len(turns)) * noise * 1e-3
        used = sorted("ABC".index(n) for n in names)
        rows += [[name, *q, *(q + bar), *angles[k, used], tests[-1][4][k], read[k]] for k in range(len(turns))]
    header = "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm," + ",".join("abc"["ABC".index(n)] + "_deg" for n in sorted(names)) + ",spindle_deg,length_mm"
    path = save(os.path.join(folder, "readings.csv"), header, rows, 9)
    # All over the travel, any angles: of that the stated uncertainty speaks.
    where = places([*truth.travel, *[(-180.0, 180.0)] * len(names)], 400)
    angles = numpy.zeros((400, 3))
    for k, n in enumerate(names):
        angles[:, "ABC".index(n)] = where[:, 3 + k]
    where = where[:, :3]
    points = Points(where, truth.tool, numpy.zeros((400, 3)), angles)
    values = {}
    for axis in truth.table:
        values |= {k.rsplit("_", 1)[0]: v for k, v in location(axis).items()}
    values |= {"eX": cup[0] * 1e3, "eY": cup[1] * 1e3}

    def own():
        return points.true(table_reference(start, tests, numpy.array([r[-1] for r in rows], float)))

    return Scenario(["calibrate", "ballbar", path, *arguments, *options], truth, points, own, values,
                    dict(header=header, rows=rows, path=path, start=start, place=place))


def bar_length(machine, test, cup):
    """Lengths of one test: the table ball is where the bar from the real tool ball puts it at angle 0 (47)."""
    _, q, bar, angles, spindle = test
    q = numpy.tile(q, (len(angles), 1))
    turn = numpy.radians(spindle)
    c = numpy.stack([cup[0] * numpy.cos(turn) - cup[1] * numpy.sin(turn), cup[0] * numpy.sin(turn) + cup[1] * numpy.cos(turn), 0 * turn], axis=1)
    ball = machine.linear(q, machine.tool) + c
    fixed = ball[:1] + bar
    for axis in reversed(machine.table):
        fixed = axis.map(fixed, numpy.zeros(1), inverse=True)
        ball = axis.map(ball, numpy.radians(angles[:, axis.index]), inverse=True)
    return numpy.linalg.norm(ball - fixed, axis=1)


def table_reference(start, tests, length):
    """All eight location errors, cup and one length a test on the exact chain."""
    def machine(x):
        m = start.copy()
        at = 0
        for axis in m.table:
            for k in range(3):
                if k != axis.index:
                    axis.shift[k] += x[at]
                    axis.tilt[k] += x[at + 1] * 1e-3
                    at += 2
        return m

    def model(x):
        m = machine(x)
        return numpy.concatenate([bar_length(m, t, (x[8], x[9])) + x[10 + k] for k, t in enumerate(tests)])

    x, _ = reference.gauss_newton(model, numpy.zeros(10 + len(tests)), length, [1e-3] * (10 + len(tests)))
    return machine(x)
