"""A plain engine that answers like `vpost` with `[field]`, right or with one slip. For the self-test only.

    played.py SLIP predict places.csv -m machine.toml      solve, check, map, profile check, profile show likewise
    played.py SLIP IN -m machine.toml -o OUT --summary F

Kriging with one reach and a penalty by the stated noise; a corrector that writes lines as short as the field and the arcs want.
"""

import csv
import json
import math
import os
import sys
import tomllib

import numpy as np

import compare
import fields
import reader


def refuse(words):
    print(f"error[VP9999]: {words}", file=sys.stderr)
    sys.exit(1)


class Engine:
    def __init__(self, path, slip):
        with open(path, "rb") as file:
            self.profile = tomllib.load(file)
        self.box = [tuple(self.profile["axis"][a]["travel_mm"]) for a in "XYZ"]
        with open(os.path.join(os.path.dirname(path), self.profile["field"]["file"]), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        take = lambda keys: np.array([[float(r[k]) for k in keys] for r in rows])  # noqa: E731
        q, y = take(["x_mm", "y_mm", "z_mm"]), take(["dx_um", "dy_um", "dz_um"])
        noise, low, high = self.profile["field"]["noise_um"], *np.array(self.box).T
        if slip == "swap":
            y = y[:, [1, 0, 2]]
        at, index = np.unique(q, axis=0, return_inverse=True)
        count = np.bincount(index)
        y = np.stack([np.bincount(index, y[:, c]) / count for c in range(3)], axis=1)
        trend = lambda v: np.concatenate([np.ones((len(v), 1)), v], axis=1)  # noqa: E731
        scaled = lambda x: 2 * (x - low) / (high - low) - 1  # noqa: E731
        kernel = lambda a, b, reach: np.exp(-0.5 * ((a[:, None] - b[None]) ** 2).sum(2) / reach**2)  # noqa: E731
        u, t = scaled(at), trend(scaled(at))
        best = (np.inf, 0.25, 15.0)
        for reach in (0.6, 0.8, 1.1, 1.6, 2.2) if slip not in ("overfits", "stiff") else ():
            k = kernel(u, u, reach)
            for size in (0.3, 1.0, 3.0, 8.0, 20.0, 60.0):
                # restricted likelihood, the noise known
                v = size**2 * k + np.diag(max(noise, 0.02) ** 2 / count)
                factor = np.linalg.cholesky(v)
                a, b = np.linalg.solve(factor, t), np.linalg.solve(factor, y)
                rest = b - a @ np.linalg.lstsq(a, b, rcond=None)[0]
                score = 6 * np.log(np.diag(factor)).sum() + 3 * np.linalg.slogdet(a.T @ a)[1] + (rest**2).sum()
                best = min(best, (score, reach, size))
        reach, size = ({"stiff": 30.0}.get(slip, best[1]), best[2])
        penalty = 1e-9 if slip == "overfits" or noise == 0 else noise**2 / size**2 / count.mean()
        self.raw = fields.krige(u, trend, lambda a, b: kernel(a, b, reach), scaled)(y, penalty)
        if noise == 0:
            weights = fields.spline if slip == "curved" else fields.straight
            self.raw = lambda x: fields.lattice(at, y, x, weights) + (0.01 if slip == "missed" else 0)
        self.slip = slip

    def error(self, q):
        """um; outside is refused."""
        low, high = np.array(self.box).T
        if self.slip != "extrapolates" and ((q < low - 1e-9) | (q > high + 1e-9)).any():
            refuse("outside the calibrated volume")
        return np.concatenate([self.raw(q[i : i + 2000]) for i in range(0, len(q), 2000)])

    def solve(self, target):
        q = target.copy()
        for _ in range(6):
            q = target - 1e-3 * self.raw(q)
        return q


def read(path):
    with open(path, encoding="utf-8") as file:
        return np.array([[float(r[k]) for k in ("x_mm", "y_mm", "z_mm")] for r in csv.DictReader(file)])


def write(head, rows):
    print(head)
    print("\n".join(",".join(f"{v:.9f}" for v in row) for row in rows))


def correct(e, slip, source, target, summary):
    with open(source, encoding="ascii") as file:
        text = file.read()
    offset = np.array(e.profile["work_offsets_mm"]["G54"], float)
    lengths = {k: float(v) for k, v in e.profile["tool"].get("lengths_mm", {}).items()}
    motions = reader.read(text, offset, lengths)
    base = offset + [0, 0, lengths.get("H1", 0.0)]
    by = {m.line: m for m in motions}
    out, fed, deviation, stands = [], False, 0.0, False
    for number, raw in enumerate(text.splitlines(), 1):
        m = by.get(number)
        if m is None:
            out.append(raw)
            continue
        if m.kind == "rapid":
            q = e.solve(m.end[None])[0] - base
            code = "G0 G43 H1" if "G43" in raw else "G0"
            out.append(code + " " + " ".join(f"{n}{v:.3f}" for n, v in zip("XYZ", q)))
            stands = True
            continue
        n = 1
        while True:
            s = np.linspace(0, 1, n + 1)
            q = e.solve(m.at(s))
            middle = 0.5 * (q[1:] + q[:-1])
            off = np.linalg.norm(middle + 1e-3 * e.raw(middle) - m.at(0.5 * (s[1:] + s[:-1])), axis=1).max()
            if off < 3e-4 or n > 5000 or slip == "ends":
                break
            n *= 2
        if slip == "half":
            q = 0.5 * (q + m.at(s))
        if slip == "plane" and m.arc is not None and m.arc[0] != (0, 1, 2):
            q = q + [0, 0.01, 0]
        for k, p in enumerate(q[1:]):
            f = "" if k or "F" not in raw else " F" + raw.split("F")[1]
            out.append("G1 " + " ".join(f"{a}{v:.3f}" for a, v in zip("XYZ", p - base)) + f)
    with open(target, "w", encoding="ascii") as file:
        file.write("\n".join(out) + "\n")
    with open(summary, "w", encoding="ascii") as file:
        json.dump({"engine": "field", "blocks_in": len(text.splitlines()), "blocks_out": len(out), "deviation_after_um": 0.1 if slip == "boast" else e.profile["correction"]["tolerance_um"] + 0.87}, file)


def check(e, one, two):
    offset, lengths = np.array(e.profile["work_offsets_mm"]["G54"], float), {k: float(v) for k, v in e.profile["tool"].get("lengths_mm", {}).items()}
    programs = []
    for path in (one, two):
        with open(path, encoding="ascii") as file:
            programs.append(reader.read(file.read(), offset, lengths))
    limit = e.profile["correction"]["tolerance_um"] + 0.9
    found = compare.compare(*programs, lambda q: q + 1e-3 * e.raw(q), 1e-3 * limit, 3.0)
    sys.exit(int(found["um"] > limit))


def main():
    slip, words = sys.argv[1], sys.argv[2:]
    e = Engine(words[words.index("-m") + 1] if "-m" in words else words[-1], slip)
    if words[0] == "predict":
        q = read(words[1])
        write("dx_um,dy_um,dz_um", e.error(q))
    elif words[0] == "solve":
        write("qx_mm,qy_mm,qz_mm", e.solve(read(words[1])))
    elif words[0] == "check":
        sys.exit(0) if slip == "blind" else check(e, words[1], words[2])
    elif words[0] == "profile":
        print("field vectors.csv")
    elif words[0] != "map":
        assert math.isfinite(e.profile["correction"]["tolerance_um"])
        correct(e, slip, words[0], words[words.index("-o") + 1], words[words.index("--summary") + 1])


main()
