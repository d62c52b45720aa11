"""Bad input: each is refused, or where a measurement is right but poor said, in words about that very mistake, with nothing written."""

import numpy as np

from common import folders, refusals

import generate
from machine import Machine

# name -> (words, whether it may also be answered and said)
CASES = {
    "no-rotary-axis": (r"rotary|turning ax|turns? no", False),
    "no-rotary-axis-but-angles": (r"rotary|[cC]_deg|no axis C|axis C", False),
    "one-angle": (r"one angle|same angle|never turn|not turn|single angle|stands?\b|at one", False),
    "ball-on-the-axis": (r"\baxis\b.*(ball|radius|arm|lever|line)|(ball|radius|arm|lever).*\baxis\b|on the axis|told apart|cannot be told", True),
    "two-machines": (r"\bfit|scatter|residual|noise|disagree|repeat|outlier|another machine|chi", False),
    "swapped-columns": (r"\bfit|scatter|residual|noise|column|swap|exchang|VP0919", False),
    "nan": (r"NaN|nan\b|not a number|finite", False),
    "no-dz": (r"d[xyz]_um|dz|Z\b", True),
    "no-angle-column": (r"[ac]_deg", False),
    "no-x": (r"x_mm", False),
    "no-deviations": (r"dx_um|--sphere|deviation", False),
    "sphere-with-deviations": (r"dx_um|--sphere|deviation", False),
    "axis-never-turned": (r"\bA\b", True),
    "blunder": (r"rows\.csv:58\b|\brow 57\b|\bline 58\b", True),
    "beyond-travel": (r"travel|volume|outside|beyond", False),
    "few-rows": (r"few|rows|readings|more", False),
    "no-rows": (r"row|empty|reading", False),
    "u-zero": (r"u_um|uncertainty", False),
    "magnitude-only": (r"d_um|magnitude|how far|direction|dx_um", False),
    "no-profile": (r"-m\b|--machine|profile", False),
    "unknown-column": (r"colour|unknown column|column", False),
    "radians": (r"deg|degrees|angle|turn|unit|\bfit|residual|scatter|noise|few", False),
}


def prepare(name, folder, seed):
    """Files of a case; returns the arguments."""
    case = generate.Case(seed, 0, "one" if name in ("ball-on-the-axis", "radians") else "ac", "sphere" if name == "sphere-columns" else "locations")
    case.stated = True
    if name == "ball-on-the-axis":
        k, axis = case.names[0], case.truth.direction[case.names[0]]
        centre = np.array(case.truth.spec["rotary"][k]["centre"])
        rot = np.arange(-180, 180, 15.0)[:, None]
        tool = np.tile([0, 0, -150.0], (24, 1))
        case.q = np.round(case.truth.command(np.tile(centre + 70 * axis, (24, 1)), rot, tool), 6)
        case.rot, case.tool, case.run = rot, tool, np.zeros(24, int)
        case.read = 1e3 * case.truth.error(case.q, rot, tool) + case.rng.normal(size=(24, 3))
    if name == "two-machines":
        other = {**case.truth.spec, "rotary": {k: {**one, "location": {n: v + (40 if n[1] in "XYZ" else 60) for n, v in one["location"].items()}} for k, one in case.truth.spec["rotary"].items()}}
        rows = case.run == 1
        case.read[rows] += 1e3 * (Machine(other).error(case.q[rows], case.rot[rows], case.tool[rows]) - case.truth.error(case.q[rows], case.rot[rows], case.tool[rows]))
    if name in ("one-angle", "axis-never-turned"):
        keep = (case.rot[:, 1] == 0) & ((case.rot[:, 0] == -60) | (name != "one-angle"))
        keep = np.repeat(np.nonzero(keep)[0], 8 if name == "one-angle" else 1)
        case.q, case.rot, case.tool, case.run, case.read = (x[keep] for x in (case.q, case.rot, case.tool, case.run, case.read))
    if name == "few-rows":
        keep = np.nonzero(case.run == 0)[0][[0, 70]]
        case.q, case.rot, case.tool, case.run, case.read = (x[keep] for x in (case.q, case.rot, case.tool, case.run, case.read))
    if name == "blunder":
        case.read[56] += [0, 250.0, 0]
    if name == "swapped-columns":
        case.read = case.read[:, [1, 0, 2]]
    if name == "beyond-travel":
        case.rot[10, 0] = 400.0
    case.write(folder)
    head, rows = case.rows()
    column = {c: i for i, c in enumerate(head)}

    def drop(*names):
        keep = [i for i, c in enumerate(head) if c not in names]
        return [head[i] for i in keep], [[r[i] for i in keep] for r in rows]

    if name == "nan":
        rows[30][column["dy_um"]] = "NaN"
    elif name == "no-dz":
        head, rows = drop("dz_um")
    elif name == "no-angle-column":
        head, rows = drop("c_deg", "a_deg")
    elif name == "no-x":
        head, rows = drop("x_mm")
    elif name == "no-deviations":
        head, rows = drop("dx_um", "dy_um", "dz_um")
    elif name == "no-rows":
        rows = []
    elif name == "u-zero":
        rows = [[*r[:-1], "0"] for r in rows]
    elif name == "magnitude-only":
        size = np.linalg.norm(case.read, axis=1)
        head, rows = drop("dx_um", "dy_um", "dz_um")
        head, rows = head + ["d_um"], [r + [f"{s:.3f}"] for r, s in zip(rows, size)]
    elif name == "unknown-column":
        head, rows = head + ["colour"], [r + ["3"] for r in rows]
    elif name == "radians":
        i = next(i for i, c in enumerate(head) if c.endswith("_deg"))
        rows = [[*r[:i], f"{np.radians(float(r[i])):.6f}", *r[i + 1 :]] for r in rows]
    if name.startswith("no-rotary-axis"):
        spec = {**case.base.spec, "chain": "[w b X Y Z t]", "rotary": {}}
        generate.write_profile(Machine(spec), f"{folder}/base.toml")
        if name == "no-rotary-axis":
            head, rows = drop("a_deg", "c_deg")
    folders.table(f"{folder}/rows.csv", head, rows)
    arguments = ["calibrate", "rtest", "rows.csv", "-m", "base.toml", "-o", "out.toml", "--json", "found.json", "--date", "2026-01-02", "--temperature", "20", "--instrument", "R-test"]
    if name == "sphere-with-deviations":
        arguments.insert(3, "--sphere")
    if name == "no-profile":
        del arguments[arguments.index("-m") : arguments.index("-m") + 2]
    return arguments


def main(vpost, keep, seed="1"):
    alike = ("no-dz", "no-angle-column", "no-x", "no-deviations", "magnitude-only", "sphere-with-deviations")
    files = ["out.toml", "found.json"]
    return refusals.asked(vpost, keep, CASES, lambda name, folder: prepare(name, folder, seed), files, bare=["no-profile"], alike=alike)
