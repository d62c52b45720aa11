"""Bad input: each is refused in words about that very mistake, by whatever reads the profile first."""

import os
import re

import numpy as np

from common import folders, refusals

import generate

# name -> (words, whether it may also be taken and said)
CASES = {
    "repeated-places-disagree": (r"disagree|differ|apart|noise|repeat|same place|twice", False),
    "nan": (r"NaN|nan\b|number|finite", False),
    "few-vectors": (r"few|vectors|more|at least|plane", False),
    "in-a-plane": (r"plane|flat|Z|line", False),
    "on-a-line": (r"line|plane|axis", False),
    "lattice-with-holes": (r"hole|lattice|missing|complete", True),
    "magnitudes": (r"d_um|magnitude|how far|direction|dx_um", False),
    "two-runs-with-offsets": (r"run|offset|set-up|setup", False),
    "units-contradict": (r"unit|um|mm", False),
    "noise-too-small": (r"noise|scatter|residual|chi|fit|more than", True),
    "no-vectors": (r"vector|row|empty|few", False),
    "no-file": (r"vectors\.csv", False),
    "no-section": (r"\[field\]|field", False),
    "rotary-axis": (r"rotary|turning|axis C|\bC\b", False),
    "tables-and-field": (r"errors|table|field", True),
    "negative-noise": (r"noise_um|noise|above|negative", False),
    "unknown-key": (r"colour|unknown", False),
    "another-tool": (r"tool", False),
    "program-outside": (r"outside|volume|travel", False),
    "arc-outside": (r"outside|volume|travel", False),
    "points-outside": (r"outside|volume|travel", True),
    "no-x": (r"x_mm", False),
    "no-dz": (r"dz_um", False),
    "travel-beyond-vectors": (r"outside|volume|travel|support|vector", False),
}


def prepare(name, folder, seed):
    """Files of a case; returns the arguments of the command."""
    kind = "rigid-lattice" if name == "lattice-with-holes" else "loose-scattered"
    case = generate.Case(seed, 3, kind)
    case.tool, case.stated, case.tolerance = np.zeros(3), "profile", 1.0
    if name == "another-tool":
        case.tool = np.array([0, 0, -100.0])
    rng, low, high = case.rng, *np.array(case.box).T
    middle = (low + high) / 2
    if name == "repeated-places-disagree":
        case.places[100] = case.places[101]
        case.read[100] = case.read[101] + [0, 40, 0]
    elif name in ("few-vectors", "no-vectors"):
        case.places, case.read = (x[: 5 if name == "few-vectors" else 0] for x in (case.places, case.read))
    elif name in ("in-a-plane", "on-a-line"):
        case.places[:, 2] = np.round(middle[2])
        if name == "on-a-line":
            case.places[:, 1] = np.round(middle[1])
        case.read = case.field(case.places) + rng.normal(size=case.places.shape)
    elif name == "lattice-with-holes":
        keep = np.ones(len(case.places), bool)
        keep[[87, 88, 130]] = False
        case.places, case.read = case.places[keep], case.read[keep]
    elif name == "noise-too-small":
        case.read = case.field(case.places) + 6 * rng.normal(size=case.places.shape)
    case.write(folder, noise={"negative-noise": -1.0, "noise-too-small": 0.5}.get(name))
    head, rows = case.rows()
    column = {c: i for i, c in enumerate(head)}
    if name == "nan":
        rows[20][column["dy_um"]] = "NaN"
    elif name == "magnitudes":
        head, rows = ["x_mm", "y_mm", "z_mm", "d_um"], [r[:3] + [f"{np.linalg.norm(d):.3f}"] for r, d in zip(rows, case.read)]
    elif name == "two-runs-with-offsets":
        head = ["run"] + head
        shift = [np.zeros(3), np.array([150.0, -80, 60])]
        rows = [[f"r{k % 2}"] + r[:3] + [f"{v:.4f}" for v in d + shift[k % 2]] for k, (r, d) in enumerate(zip(rows, case.read))]
    elif name == "units-contradict":
        head[column["dy_um"]] = "dy_um_mm"
    elif name == "no-x":
        head, rows = head[1:], [r[1:] for r in rows]
    elif name == "no-dz":
        head, rows = head[:5], [r[:5] for r in rows]
    folders.table(f"{folder}/vectors.csv", head, rows)
    with open(f"{folder}/machine.toml", encoding="ascii") as file:
        profile = file.read()
    if name == "no-file":
        os.remove(f"{folder}/vectors.csv")
    elif name == "no-section":
        profile = re.sub(r"\[field\]\nfile.*\nnoise.*\n", "", profile)
    elif name == "rotary-axis":
        profile = profile.replace("[w X Y b Z t]", "[w C X Y b Z t]").replace("[field]", "[rotary.C]\ncentre_mm = [0, 0, 0]\ntravel_deg = [-180, 180]\n[field]")
    elif name == "tables-and-field":
        folders.table(f"{folder}/x.csv", ["position_mm", "EXX_um"], [[f"{low[0]}", "0"], [f"{high[0]}", "9"]])
        profile = profile.replace("[axis.X]\n", '[axis.X]\nerrors = "x.csv"\n')
    elif name == "unknown-key":
        profile = profile.replace("[field]\n", "[field]\ncolour = 3\n")
    elif name == "travel-beyond-vectors":
        profile = profile.replace(f"travel_mm = {list(case.box[0])}", f"travel_mm = {[case.box[0][0], case.box[0][1] + 300]}")
    elif name == "another-tool":
        profile = profile.replace("H1 = 100.0", "H1 = 190.0")
    folders.put(folder, "machine.toml", profile)
    base = case.offset + [0, 0, 190.0 if name == "another-tool" else -case.tool[2]]
    start = np.round(middle - base, 3)
    lines = ["G21 G17 G90 G94 G40 G54", ("G0 G43 H1 " if name == "another-tool" else "G0 ") + " ".join(f"{n}{v:.3f}" for n, v in zip("XYZ", start))]
    if name in ("program-outside", "travel-beyond-vectors"):
        lines.append(f"G1 X{high[0] - base[0] + 40:.3f} F500")
    elif name == "arc-outside":
        # ends inside, its side is not
        far = high[0] - base[0]
        lines += [f"G1 X{far - 10:.3f} F500", f"G2 Y{start[1] - 60:.3f} J-30."]
    else:
        lines.append(f"G1 X{start[0] + 30:.3f} F500")
    folders.put(folder, "in.ngc", "\n".join(lines + ["M2"]) + "\n")
    if name == "points-outside":
        folders.table(f"{folder}/points.csv", ["x_mm", "y_mm", "z_mm"], [[f"{v:.3f}" for v in high + 20]])
        return ["predict", "points.csv", "-m", "machine.toml"]
    return ["in.ngc", "-m", "machine.toml", "-o", "out.ngc", *(["--engine", "field"] if name == "no-section" else [])]


def main(vpost, keep, seed="1"):
    return refusals.asked(vpost, keep, CASES, lambda name, folder: prepare(name, folder, seed), ["out.ngc"])
