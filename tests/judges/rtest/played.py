"""A plain estimator that answers like `vpost calibrate rtest`, right or with one slip. For the self-test only.

    played.py SLIP calibrate rtest rows.csv [--sphere] -m base.toml -o out.toml --json found.json …
    played.py SLIP predict places.csv -m out.toml

Penalised least squares of reference.py, the penalty by generalised cross-validation; slips change what is said or written.
"""

import csv
import json
import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import numpy as np  # noqa: E402

import generate  # noqa: E402
import machine  # noqa: E402
import reference  # noqa: E402
from machine import SCALE, place, unit  # noqa: E402


class Seen:
    def __init__(self, base, rot):
        self.names = base.rotary
        self.range = {n: (-180, 180) if np.ptp(rot[:, k]) > 300 else (rot[:, k].min(), rot[:, k].max()) for k, n in enumerate(self.names)}


def read(path, names):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    take = lambda keys: np.array([[float(r[k]) for k in keys] for r in rows])  # noqa: E731
    q, tool = take(["x_mm", "y_mm", "z_mm"]), take(["tool_x_mm", "tool_y_mm", "tool_z_mm"])
    rot = take([f"{n.lower()}_deg" for n in names])
    run = np.array([int(r["run"][1:]) if "run" in r else 0 for r in rows])
    return q, rot, tool, run, take(["dx_um", "dy_um", "dz_um"]) if "dx_um" in rows[0] else None


def predict(arguments):
    m = machine.of_profile(arguments[arguments.index("-m") + 1])
    q, rot, tool, _, _ = read(arguments[1], m.rotary)
    e = 1e3 * m.error(q, rot, tool)
    print("dx_um,dy_um,dz_um")
    print("\n".join(",".join(f"{v:.9f}" for v in row) for row in e))


def calibrate(slip, arguments):
    base = machine.of_profile(arguments[arguments.index("-m") + 1])
    q, rot, tool, run, dx = read(arguments[2], base.rotary)
    case = Seen(base, rot)
    rows = reference.Rows(base, case.names, q, rot, tool, run, dx, "--sphere" in arguments)
    y = rows.y.reshape(-1)
    count = 4 * len(case.names)
    n = len(y) - 3 * len(np.unique(run))
    located = rows.located()
    few = np.linalg.pinv(located, rcond=1e-5)
    rest = y - located @ (few @ y)
    fit, best = reference.Fit(case, rows), None
    for penalty in 10.0 ** np.arange(-4, 4.1, 0.5):
        solve = np.linalg.solve(fit.gram + penalty * fit.rough.T @ fit.rough + fit.weak, fit.x.T)
        dof = n - np.trace(solve @ fit.x)
        left = y - fit.x @ (solve @ y)
        score = (left @ left) / dof**2
        if best is None or score < best[0]:
            best = (score, solve, left @ left, dof)
    _, solve, left, dof = best
    # functions only where a fit of few terms, fixed beforehand, shows some
    short = reference.Fit(case, rows, small=True).x
    terms = np.linalg.matrix_rank(short, tol=1e-3 * np.linalg.norm(short, 2)) - count
    less = y - short @ np.linalg.lstsq(short, y, rcond=1e-6)[0]
    tables = slip != "silent" and (rest @ rest - less @ less) / terms > less @ less / (n - count - terms) * (1 + 4 * np.sqrt(2 / terms))
    size = fit.x.shape[1]
    if tables:
        # locations take what they can: along the null space the tables become small
        each = {m: fit.bases[m](np.zeros(1)).shape[1] for m in case.names}
        hidden = reference.null(fit.x, reference.sizes(case.names, each))
        at = [np.linspace(*case.range[m], 49) for m in case.names]
        blocks = []
        for k, name in enumerate(case.names):
            b = fit.bases[name](at[k])
            blocks.append(np.einsum("pm,jl->jplm", b, np.diag([1, 1, 1, 0.15, 0.15, 0.15])).reshape(6 * 49, -1))
        tall = np.zeros((sum(len(b) for b in blocks), size - count))
        r = c = 0
        for b in blocks:
            # coefficients stand (function, basis)
            tall[r : r + b.shape[0], c : c + b.shape[1]] = b
            r, c = r + b.shape[0], c + b.shape[1]
        move = np.eye(size) - hidden @ np.linalg.pinv(tall @ hidden[count:], rcond=1e-6) @ np.hstack([np.zeros((len(tall), count)), tall])
        full = move @ solve
        variance = left / dof
    else:
        full = np.vstack([few, np.zeros((size - count, len(y)))])
        variance = rest @ rest / (n - count)
    x = full @ y
    half = 1.97 * np.sqrt(variance * (full[:count] ** 2).sum(1))
    keys = reference.keys(case.names)
    groups = reference.open_terms(rows, case.names)
    hidden_names = {k for g in groups for k in g}
    # what the locations cannot tell keeps its start
    hidden = reference.null(located, reference.sizes(case.names, None), 1e-3)
    x[:count] -= hidden @ np.linalg.lstsq(hidden, x[:count], rcond=None)[0]
    if slip == "invents":
        x[[i for i, k in enumerate(keys) if k in hidden_names]] += 7.0
    if slip == "sign":
        x = -x
    if slip == "swap":  # the two radial (and the two tilting) errors of each axis change places
        order = np.arange(count).reshape(-1, 2)[:, ::-1].reshape(-1)
        x[:count] = x[order]
    if slip == "boast":
        half = half / 3
    located_, written = {}, {}
    for k, value in zip(keys, x):
        located_.setdefault(k[3], np.zeros(6))[place(k)] = value * SCALE[place(k)]
    col = count
    folder = os.path.dirname(os.path.abspath(arguments[arguments.index("-o") + 1]))
    for k, name in enumerate(case.names):
        m = fit.bases[name](np.zeros(1)).shape[1]
        coefficients = x[col : col + 6 * m].reshape(6, m)
        col += 6 * m
        nodes = np.linspace(*case.range[name], 181)
        values = fit.bases[name](nodes) @ coefficients.T + base.functions(name, nodes) / SCALE
        if slip == "no-tables":
            values *= 0
        if slip == "shift":
            values = np.roll(values, 15, axis=0)
        if tables or np.abs(values).max() > 0:
            written[name] = (nodes, values)
    old = generate.write_profile  # keeps the base's linear axes as read
    spec = base.spec
    for one in spec["rotary"].values():
        one.setdefault("travel", [-180, 180])
    old(base, os.path.join(folder, "out.toml"), located_, written)
    terms = [{"name": k, "value": v, "u95": h, "unit": unit(k)} for k, v, h in zip(keys, x, half) if k not in hidden_names or slip == "invents"]
    if slip == "silent":
        terms = [t for t in terms if abs(t["value"]) < 1e-9]
    say = [] if slip in ("silent", "invents") else [[k for k in g] for g in groups]
    if len(np.unique(run)) == 1 and say is not None and slip != "silent":
        say.append([f"EA{n}" for n in case.names] + [f"EX{n}" for n in case.names])
    with open(os.path.join(folder, "found.json"), "w", encoding="utf-8") as file:
        json.dump({"schema": "vpost.rtest/1", "terms": terms, "not_told_apart": say}, file)
    for t in terms:
        print(f"  {t['name']} {t['value']:.3f} ± {t['u95']:.3f} {t['unit']}")


if sys.argv[2] == "predict":
    predict(sys.argv[2:])
else:
    calibrate(sys.argv[1], sys.argv[2:])
