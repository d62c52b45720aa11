"""Mistakes of a user, each made in an otherwise good measurement.

For each: what is wrong, whether the readings contradict it, and how it is made. "contradicted" means that the data, the base or the
documents say that it cannot be: then the command has to refuse and write no profile. "undetectable" means that another
plausible machine would have given the same readings; such a mistake is listed with what is said. For mistakes in a
volumetric measurement the judge's own least squares says by how many times the stated noise the readings miss every
machine of the chain.
"""

import os

import numpy

import reference
from machine import AXES, Machine
from volume import save, tracker, volumetric
import bars

CONTRADICTED, UNDETECTABLE = True, False


def vol(change, base="none", form="deviations", turn=2e-4, chain=None, **options):
    """A volumetric measurement whose table is changed; u_um is stated, so that the data say what noise is."""
    def make(rng, folder):
        s = volumetric(rng, folder, base, turn, 1.0, form, u=1.0, angle=120.0, length=20.0, **options)
        names = s.data["header"].split(",")
        table = s.data["table"].copy()
        header = change(rng, names, table) or s.data["header"]
        save(s.data["path"], header, table, 9)
        arguments = list(s.arguments)
        order = s.truth.order
        if chain:
            order = chain
            arguments[arguments.index("--chain") + 1] = Machine(chain).chain()
        column = header.split(",").index
        get = lambda *wanted: numpy.array(table[:, [column(w) for w in wanted]], float)
        q, tool = get("x_mm", "y_mm", "z_mm"), get("tool_x_mm", "tool_y_mm", "tool_z_mm")
        read = get("xm_mm", "ym_mm", "zm_mm") if form == "positions" else q + tool + get("dx_um", "dy_um", "dz_um") * 1e-3
        start = s.data["start"].copy()
        start.order = order
        _, left = reference.volumetric(start, q, tool, get("dir_x", "dir_y", "dir_z"), table[:, 0].astype(str), read, 5, rounds=4)
        evidence = f"best fit leaves {numpy.sqrt((left**2).mean()) * 1e3:.2f} um where u is 1"
        return arguments, evidence
    return make


def columns(names, *wanted):
    return [names.index(w) for w in wanted]


def swap(a, b):
    def change(_, names, table):
        i, j = columns(names, a, b)
        table[:, [i, j]] = table[:, [j, i]]
    return change


def times(factor, *wanted):
    def change(_, names, table):
        for k in columns(names, *wanted):
            table[:, k] = table[:, k] * factor
    return change


def shifted(*wanted):
    def change(_, names, table):
        for k in columns(names, *wanted):
            table[:, k] = numpy.roll(table[:, k], 1)
    return change


def spike(name, size):
    def change(_, names, table):
        table[len(table) // 2, names.index(name)] += size
    return change


def millimetres(_, names, table):
    """mm under `_um`, and a set-up shift of 30 um in mm that makes the numbers look large."""
    for k in columns(names, "dx_um", "dy_um", "dz_um"):
        table[:, k] = table[:, k] * 1e-3


def few(rng, names, table):
    keep = numpy.tile(numpy.arange(len(table))[:4], len(table) // 4 + 1)[: len(table)]
    for k in columns(names, "x_mm", "y_mm", "z_mm"):
        table[:, k] = table[keep, k]


def trav(change, base="none", **options):
    def make(rng, folder):
        s = tracker(rng, folder, base, 0.0, 1.0, shift=0.02, **options)
        arguments = list(s.arguments)
        arguments = change(rng, s, arguments) or arguments
        return arguments, ""
    return make


def rows_of(s, axis):
    return numpy.array(s.data["traverses"][axis][4], float), s.data["traverses"][axis][3]


def edit(axes, action):
    """Rows of the traverses changed by action(rows, axis): columns 0-2 commanded, 3-5 measured, 6 direction."""
    def change(_, s, arguments):
        for axis in axes:
            rows, header = rows_of(s, axis)
            rows = action(rows, axis)
            save(s.data["paths"][axis], header, rows.tolist(), 9)
    return change


def columns_changed(*order):
    def action(rows, _):
        rows = rows.copy()
        rows[:, 3:6] = rows[:, [3 + k for k in order]]
        return rows
    return action


def factor(columns_, value):
    def action(rows, _):
        rows = rows.copy()
        rows[:, columns_] *= value
        return rows
    return action


def rolled(rows, _):
    rows = rows.copy()
    rows[:, 3:6] = numpy.roll(rows[:, 3:6], 1, axis=0)
    return rows


def outlier(rows, axis):
    rows = rows.copy()
    rows[len(rows) // 3, 3 + (axis + 1) % 3] += 0.3
    return rows


def files_in_order(*order):
    def change(_, s, arguments):
        at = arguments.index(s.data["paths"][0])
        arguments[at : at + 3] = [s.data["paths"][k] for k in order]
    return change


def line(change, base="none", **options):
    def make(rng, folder):
        s = bars.interferometer(rng, folder, base, **options)
        return (change(rng, s, list(s.arguments)) or list(s.arguments)), ""
    return make


def line_edit(action, axes="XYZ"):
    def change(_, s, arguments):
        for letter in axes:
            if letter in s.data:
                header, rows, path = s.data[letter]
                made = action(header, [list(r) for r in rows])
                save(path, *(made if isinstance(made, tuple) else (header, made)), 8)
        return arguments
    return change


def scaled_columns(value, ending):
    def action(header, rows):
        for k, name in enumerate(header.split(",")):
            if name.endswith(ending):
                for row in rows:
                    row[k] *= value
        return rows
    return action


def through(place):
    def change(_, s, arguments):
        arguments[arguments.index("--through") + 1] = place
        return arguments
    return change


def bar(change, **options):
    def make(rng, folder):
        s = bars.circles(rng, folder, "bare", **options)
        rows = [list(r) for r in s.data["rows"]]
        arguments = list(s.arguments)
        rows = change(rows) or rows
        save(s.data["path"], s.data["header"], rows, 9)
        return arguments, ""
    return make


def every(where, action):
    def change(rows):
        for row in rows:
            if where(row[0]):
                action(row)
    return change


def lengthen(row):
    """A radius that the machine's Y and X share in the first plane alone: the three mismatches no longer add up to 0."""
    arm = numpy.array(row[1:4]) - numpy.array(row[4:7])
    row[-1] += 60e-6 * (arm[0] ** 2 - arm[1] ** 2) / numpy.linalg.norm(arm) / 2


def turned_directions(row):
    row[7:10] = [-v for v in row[7:10]]


def tab(change, rename=None, **options):
    def make(rng, folder):
        s = bars.table(rng, folder, **options)
        rows = [list(r) for r in s.data["rows"]]
        rows = change(rows) or rows
        header = s.data["header"] if rename is None else rename(s.data["header"])
        save(s.data["path"], header, rows, 9)
        arguments = list(s.arguments)
        return arguments, ""
    return make


def no_base(make):
    def made(rng, folder):
        arguments, text = make(rng, folder)
        at = arguments.index("-m")
        return arguments[:at] + ["--chain", "[w C A X Y b Z t]"] + arguments[at + 2 :], text
    return made


def keep(rows):
    return None


def angle_columns(action):
    def change(rows):
        for row in rows:
            row[7:9] = action(row[7:9])
    return change


def foreign_base(rng, s, arguments):
    """The base of another machine: its travel lies elsewhere."""
    path = arguments[arguments.index("-m") + 1]
    other = s.data["start"].copy()
    other.travel = [(l + 5000, h + 5000) for l, h in other.travel]
    for axis in range(3):
        for table in other.functions[axis]:
            table.nodes = table.nodes + 5000
    from machine import write_profile
    write_profile(other, os.path.dirname(path), "base")
    return arguments


def foreign_vol(rng, folder):
    s = volumetric(rng, folder, "own", 2e-4, 1.0, "deviations", u=1.0)
    foreign_base(rng, s, s.arguments)
    return s.arguments, "no point lies in the base's volume"


def stations_without_places(rng, folder):
    from volume import stations
    s = stations(rng, folder)
    names = s.data["header"].split(",")
    kept = [k for k, n in enumerate(names) if n not in ("bx_mm", "by_mm", "bz_mm")]
    save(s.data["path"], ",".join(names[k] for k in kept), s.data["table"][:, kept], 9)
    return s.arguments, "no bx_mm by_mm bz_mm"


DEVIATIONS, UP = ("dx_um", "dy_um", "dz_um"), lambda name: True
MISTAKES = [
    ("volumetric: mm under _um", CONTRADICTED, vol(millimetres)),
    ("volumetric: dx and dy exchanged", CONTRADICTED, vol(swap("dx_um", "dy_um"))),
    ("volumetric: sign of dy alone", CONTRADICTED, vol(times(-1, "dy_um"))),
    ("volumetric: all signs", UNDETECTABLE, vol(times(-1, *DEVIATIONS), turn=0.0)),
    ("volumetric: readings one row late", CONTRADICTED, vol(shifted(*DEVIATIONS))),
    ("volumetric: one outlier of 0.3 mm", CONTRADICTED, vol(spike("dz_um", 300.0))),
    ("volumetric: up and down exchanged", CONTRADICTED, vol(times(-1, "dir_x", "dir_y", "dir_z"))),
    ("volumetric: sign of the tool vectors", CONTRADICTED, vol(times(-1, "tool_x_mm", "tool_y_mm", "tool_z_mm"))),
    ("volumetric: x and y of the commands exchanged", CONTRADICTED, vol(swap("x_mm", "y_mm"))),
    ("volumetric: mirrored positions", CONTRADICTED, vol(times(-1, "zm_mm"), form="positions", turn=0.0)),
    ("volumetric: chain that the readings contradict", CONTRADICTED, vol(lambda *_: None, chain=(2, 1, 0))),
    ("volumetric: base of another machine", CONTRADICTED, foreign_vol),
    ("volumetric: too few places for the functions", CONTRADICTED, vol(few)),
    ("volumetric: stations without places", CONTRADICTED, stations_without_places),
    ("tracker: files in the order Y X Z", CONTRADICTED, trav(files_in_order(1, 0, 2))),
    ("tracker: one file three times", CONTRADICTED, trav(files_in_order(0, 0, 0))),
    ("tracker: measured x and y exchanged", CONTRADICTED, trav(edit((0, 1, 2), columns_changed(1, 0, 2)))),
    ("tracker: one measured sign", CONTRADICTED, trav(edit((0, 1, 2), factor([4], -1)))),
    ("tracker: left-handed across (z of the X and Y files)", CONTRADICTED, trav(edit((0, 1, 2), factor([5], -1)))),
    ("tracker: up and down exchanged", CONTRADICTED, trav(edit((0, 1, 2), factor([6], -1)))),
    ("tracker: measured in inches", CONTRADICTED, trav(edit((0, 1, 2), factor([3, 4, 5], 1 / 25.4)))),
    ("tracker: readings one row late", CONTRADICTED, trav(edit((0,), rolled))),
    ("tracker: one outlier of 0.3 mm", CONTRADICTED, trav(edit((0,), outlier))),
    ("tracker: base of another machine", CONTRADICTED, trav(foreign_base, base="own")),
    ("interferometer: up and down exchanged", CONTRADICTED, line(line_edit(lambda h, rows: [[r[0], -r[1], *r[2:]] for r in rows]))),
    ("interferometer: run broken off", CONTRADICTED, line(line_edit(lambda h, rows: rows[:-4], "X"))),
    ("interferometer: --through outside the travel", CONTRADICTED, line(through("9000,9000,9000"), base="own")),
    ("interferometer: positions in um, with a base", CONTRADICTED, line(line_edit(scaled_columns(1000.0, "position_mm")), base="own")),
    ("interferometer: sign of all deviations", UNDETECTABLE, line(line_edit(scaled_columns(-1, "_um")), play=False)),
    ("interferometer: arc seconds as urad", UNDETECTABLE, line(line_edit(scaled_columns(1 / 4.848, "_urad")))),
    ("interferometer: mm under _um", CONTRADICTED, line(line_edit(scaled_columns(1e-3, "_um")))),
    ("interferometer: one run written five times", CONTRADICTED,
     line(line_edit(lambda h, rows: [[k, *r[1:]] for k in range(1, 6) for r in rows if r[0] == 1]))),
    ("interferometer: X data named Y, targets not Y's", CONTRADICTED,
     line(line_edit(lambda h, rows: ("run,dir,position_mm," + ",".join(f"E{c}Y_{'um' if c in 'XYZ' else 'urad'}" for c in "XYZABC"), rows), "X"),
          base="own", axes=(0,))),
    ("interferometer: base of another machine", CONTRADICTED, line(foreign_base, base="own")),
    ("circles: up and down exchanged", CONTRADICTED, bar(every(UP, turned_directions))),
    ("circles: closure of the scales 60 um/m", CONTRADICTED, bar(every(lambda n: n[:2] == "XY", lengthen), off=0.0)),
    ("circles: lengths in inches", CONTRADICTED, bar(every(UP, lambda r: r.__setitem__(-1, r[-1] / 25.4)))),
    ("circles: lengths one row late", CONTRADICTED, bar(lambda rows: [[*r[:-1], p[-1]] for r, p in zip(rows, rows[-1:] + rows[:-1])])),
    ("table: --crossing 100 mm from centre_mm", CONTRADICTED, tab(keep, options=("--crossing", "300,150,-350"))),
    ("table: profile of a head", CONTRADICTED, tab(keep, head=True)),
    ("table: no spindle turn", CONTRADICTED, tab(keep, spindle=False)),
    ("table: no pivot", CONTRADICTED, no_base(tab(keep))),
    ("table: angles in rad", CONTRADICTED, tab(angle_columns(lambda v: [a * numpy.pi / 180 for a in v]))),
    ("table: A and C exchanged", CONTRADICTED, tab(angle_columns(lambda v: v[::-1]))),
    ("table: C turns the other way", UNDETECTABLE, tab(angle_columns(lambda v: [v[0], -v[1]]))),
    ("table: one outlier of 0.3 mm", CONTRADICTED, tab(lambda rows: rows[5].__setitem__(-1, rows[5][-1] + 0.3))),
]
