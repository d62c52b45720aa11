"""Measurements as arrays: where the axes stood, under what conditions, in which run; and the files made of them.

Lengths in mm, readings in um, times in s; n rows. A design says where and how a machine is measured and knows nothing of its errors.
Machine coordinates of every axis run from 0 to its travel. The tip stands at command + tool.
"""

import numpy

AXES = "XYZ"
CONDITIONS = ("feed_mm_min", "load_kg", "time_s", "temp_c")


class Rows:
    """q, tool, dirs (n, 3); run (n) texts; conditions by name (n); extra columns by name (n), written as they stand."""

    def __init__(self, machine):
        self.machine = machine
        self.run, self.q, self.tool, self.dirs = [], [], [], []
        self.now = {"feed_mm_min": 2000.0, "load_kg": 0.0, "time_s": 60.0, "temp_c": 20.0}
        self.conditions = {name: [] for name in CONDITIONS}
        self.extra, self.d = {}, None

    def path(self, run, places, tool=None, step_s=4.0, **conditions):
        """Appends the places (k, 3) in order as rows of a run; each is approached from the place before it."""
        places = numpy.asarray(places, float)
        self.now.update(conditions)
        steps = approaches(places)
        facing = numpy.zeros(3)
        for place, step in zip(places, steps):
            facing = numpy.where(numpy.abs(step) > 1e-9, numpy.sign(step), facing)
            self.now["time_s"] += step_s
            self.run.append(run)
            self.q.append(place)
            self.tool.append(self.machine.tool if tool is None else tool)
            self.dirs.append(facing)
            for name in CONDITIONS:
                self.conditions[name].append(self.now[name])
        self.now["time_s"] += 30.0
        return self

    def close(self):
        """Lists become arrays; every row gets its reading 0."""
        self.run = numpy.array(self.run)
        self.q, self.tool, self.dirs = (numpy.array(v, float).reshape(-1, 3) for v in (self.q, self.tool, self.dirs))
        for name in CONDITIONS:
            self.conditions[name] = numpy.array(self.conditions[name], float)
        self.d = numpy.zeros_like(self.q)
        return self

    def __len__(self):
        return len(self.run)

    def __getattr__(self, name):
        short = {"feed": "feed_mm_min", "load": "load_kg", "time": "time_s", "temp": "temp_c"}.get(name)
        if short is None:
            raise AttributeError(name)
        return self.conditions[short]

    def runs(self):
        """(run id, indices) in the order of measurement."""
        return [(run, numpy.flatnonzero(self.run == run)) for run in dict.fromkeys(self.run)]

    def take(self, keep):
        """The rows of a mask or of indices, as a copy."""
        other = Rows(self.machine)
        other.run, other.q, other.tool, other.dirs, other.d = (numpy.array(v[keep]) for v in (self.run, self.q, self.tool, self.dirs, self.d))
        other.conditions = {k: v[keep] for k, v in self.conditions.items()}
        other.extra = {k: numpy.asarray(v)[keep] for k, v in self.extra.items()}
        return other

    def table(self, leave=(), kind="deviations", always=()):
        """(header, columns of texts). Conditions that never change are left out: a column with one value is refused (VP0915)."""
        columns = {"run": list(self.run)}
        for k, axis in enumerate("xyz"):
            columns[f"{axis}_mm"] = [f"{v:.4f}" for v in self.q[:, k]]
        if kind == "deviations":
            for k, axis in enumerate("xyz"):
                columns[f"d{axis}_um"] = [f"{v:.3f}" for v in self.d[:, k]]
        for k, axis in enumerate("xyz"):
            columns[f"dir_{axis}"] = [f"{int(v)}" for v in self.dirs[:, k]]
            columns[f"tool_{axis}_mm"] = [f"{v:.3f}" for v in self.tool[:, k]]
        if all(numpy.ptp(self.tool[:, k]) == 0 for k in range(3)) and not any(f"tool_{axis}_mm" in always for axis in "xyz"):
            leave = (*leave, "tool_x_mm", "tool_y_mm", "tool_z_mm")
        for name in CONDITIONS:
            columns[name] = [f"{v:.3f}" for v in self.conditions[name]]
            if numpy.ptp(self.conditions[name]) == 0 and name not in always:
                leave = (*leave, name)
        if all((self.dirs[:, k] == 0).all() for k in range(3)):
            leave = (*leave, "dir_x", "dir_y", "dir_z")
        for name, values in self.extra.items():
            columns[name] = [v if isinstance(v, str) else f"{v:.4f}" for v in values]
        return {name: values for name, values in columns.items() if name not in leave}

    def write(self, path, leave=(), kind="deviations", always=()):
        columns = self.table(leave, kind, always)
        with open(path, "w", encoding="utf-8") as file:
            file.write(",".join(columns) + "\n")
            file.writelines(",".join(row) + "\n" for row in zip(*columns.values()))
        return path


def approaches(places):
    """Steps (k, 3) by which the places are reached. A place that comes twice running is run over, and reached from its other side."""
    steps = numpy.diff(places, axis=0, prepend=(2 * places[:1] - places[1:2]) if len(places) > 1 else places[:1])
    for k in range(len(steps) - 2, -1, -1):
        if not steps[k].any():
            steps[k] = steps[k + 1]
    return steps


def uneven(rng, low, high, count):
    """Places between low and high, ends included, with steps that no period divides."""
    step = (high - low) / (count - 1)
    places = numpy.linspace(low, high, count)
    places[1:-1] += rng.uniform(-0.35, 0.35, count - 2) * step
    return numpy.round(places, 3)


def there_and_back(places, passes=1):
    return numpy.concatenate([p for _ in range(passes) for p in (places, places[::-1])])


def along(machine, axis, at, places):
    points = numpy.tile(numpy.asarray(at, float), (len(places), 1))
    points[:, axis] = places
    return points


def lines(rng, machine, per_axis=3, count=9, passes=1, diagonals=True, tools=1, both=True, rows=None, name="r", axes=(0, 1, 2), shuffle=True, change=None):
    """Lines along each axis in several places, and the diagonals of planes; a run each. `change(rows, k)` gives conditions of run k."""
    rows, todo = Rows(machine) if rows is None else rows, []
    travel = machine.travel
    for axis in axes:
        for k in range(per_axis):
            at = travel * rng.uniform(0.1, 0.9, 3) if k else travel / 2
            todo.append(along(machine, axis, at, uneven(rng, 0.03 * travel[axis], 0.97 * travel[axis], count)))
    if diagonals:
        for a, b in ((0, 1), (0, 2), (1, 2)):
            at = travel * rng.uniform(0.2, 0.8, 3)
            part = uneven(rng, 0.05, 0.95, count)
            for back in (False, True):
                points = numpy.tile(at, (count, 1))
                points[:, a] = part * travel[a]
                points[:, b] = (1 - part if back else part) * travel[b]
                todo.append(points)
    vectors = [machine.tool, machine.tool + [0, 0, -90.0], machine.tool + [70.0, 45.0, 0]][:tools]
    if tools > 1:
        todo = [(t, v) for v in vectors for t in todo]
    else:
        todo = [(t, machine.tool) for t in todo]
    order = rng.permutation(len(todo)) if shuffle else range(len(todo))
    for k, number in enumerate(order):
        points, tool = todo[number]
        if not both and k % 2:
            points = points[::-1]
        points = there_and_back(points, passes) if both else numpy.concatenate([points] * passes)
        rows.path(f"{name}{k}", points, tool, **(change(k) if change else {}))
    return rows


def plates(rng, machine, count=8, grid=5, passes=2, rows=None, name="p"):
    """Plates with grid x grid marks, in the planes XY, XZ and YZ in turn, each a run, read forth and back."""
    rows = Rows(machine) if rows is None else rows
    for k in range(count):
        a, b = ((0, 1), (0, 2), (1, 2))[k % 3]
        at = machine.travel * rng.uniform(0.1, 0.9, 3)
        us, vs = uneven(rng, 0.05, 0.95, grid), uneven(rng, 0.05, 0.95, grid)
        points = []
        for m, v in enumerate(vs):
            for u in us if m % 2 == 0 else us[::-1]:
                place = at.copy()
                place[a], place[b] = u * machine.travel[a], v * machine.travel[b]
                points.append(place)
        rows.path(f"{name}{k}", there_and_back(numpy.array(points), passes))
    return rows


def scatter(rng, machine, count=120, runs=4, rows=None, name="s"):
    rows = Rows(machine) if rows is None else rows
    for k in range(runs):
        rows.path(f"{name}{k}", numpy.round(machine.travel * rng.uniform(0.03, 0.97, (count // runs, 3)), 3))
    return rows
