#!/usr/bin/python3
"""A plain estimator that answers like `vpost calibrate turning`, right or with one slip. For the self-test only.

    played.py SLIP calibrate turning parts.csv -m lathe.toml --holdout held.csv --json found.json -o out.toml …

One tool, diameters: size, slope, even bow by least squares, with Student's intervals.
"""

import csv
import json
import sys

import numpy as np

# quantiles of Student's distribution at 97.5 % (tables)
STUDENT = {3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262, 10: 2.228, 12: 2.179, 15: 2.131, 20: 2.086, 30: 2.042, 60: 2.0}


def read(path):
    with open(path, encoding="cp1251") as file:
        head = file.readline()
        separator = next((s for s in "\t;" if s in head), ",")
        rows = list(csv.DictReader([head, *file], delimiter=separator))
    return [{k: v.replace(",", ".") if separator == ";" else v for k, v in row.items()} for row in rows]


def main():
    slip = sys.argv[1]
    rows, shown = read("parts.csv"), read("held.csv")
    z = np.array([float(r["z_mm"]) for r in rows])
    d = np.array([float(r["d_um"]) for r in rows])
    low, high = z.min(), z.max()
    middle, half = (low + high) / 2, (high - low) / 2
    radius = d if slip == "diameter" else d / 2
    a = np.column_stack([np.ones_like(z), -z * 1e-3, 1 / 3 - ((z - middle) / half) ** 2])
    b, *_ = np.linalg.lstsq(a, radius, rcond=None)
    left = radius - a @ b
    dof = len(z) - 3
    covariance = np.linalg.inv(a.T @ a) * (left @ left) / dof
    t = STUDENT[max(k for k in STUDENT if k <= dof)]
    u = np.sqrt(np.diag(covariance))
    if slip == "narrow":
        u, covariance = u / 3, covariance / 9
    size, taper, bow = b
    if slip == "sign":
        taper = -taper
    if slip == "span":
        taper *= (high - low) / 1000  # um over the measured length for um/m
    if slip == "frame":
        middle += 40.0  # Z from another zero
    names = ["spindle.EB0S_urad", "axis.Z.EXZ_bow_um"]
    with open("lathe.toml") as file:
        base = file.read()
    with open("out.toml", "w") as file:
        file.write(base.replace("[axis.Z]\n", '[axis.Z]\nerrors = "out/z.csv"\n') + f"[spindle]\nEB0S_urad = {taper:.4f}\n")
    import os
    os.makedirs("out", exist_ok=True)
    grid = [-160.0, *np.linspace(low, high, 61), 720.0]
    value = lambda q: bow * (1 / 3 - ((min(max(q, low), high) - (middle)) / half) ** 2)  # noqa: E731
    with open("out/z.csv", "w") as file:
        file.write("position_mm,EXZ_um\n" + "".join(f"{q:.6f},{value(q):.5f}\n" for q in grid))
    hz = np.array([float(r["z_mm"]) for r in shown])
    hd = np.array([float(r["d_um"]) for r in shown])
    model = 2 * (-taper * hz * 1e-3 + np.array([value(q) for q in hz]))
    rms = lambda e: float(np.sqrt(np.mean((e - e.mean()) ** 2)))  # noqa: E731
    print(f"  taper      {names[0]} {taper:.3f} ± {t * u[1]:.3f}, written")
    print(f"  barrel     {names[1]} {bow:.3f} ± {t * u[2]:.3f}, written")
    enter = -2e-3 * size * (-1 if slip == "entry" else 1)
    print(f"  size of T1: {size:.3f} ± {t * u[0]:.3f} um on the radius; with this profile enter {enter:.4f} mm as wear of X on the diameter")
    before, after = rms(hd), rms(hd - model)
    if slip == "nan":
        after = float("nan")
    with open("found.json", "w") as file:
        json.dump({"schema": "vpost.turning/1", "parts": len({r["part"] for r in rows}), "rows": len(rows), "noise_um": 1.0,
                   "terms": [{"name": n, "value": v, "u": w} for n, v, w in zip(names, (taper, bow), u[1:])], "covariance": covariance[1:, 1:].tolist(),
                   "not_told_apart": [], "offsets": [{"tool": "T1", "radius_um": size, "u_um": u[0]}],
                   "holdout": {"rows": len(hd), "rms_before_um": before, "rms_after_um": after, "max_after_um": 0.0}}, file)


main()
