"""Shows that the judge can fail, and that a right answer passes: commands that are played (played.py), and the judge's own random numbers. Needs no vpost."""

import concurrent.futures
import os
import stat
import sys
import tempfile

import numpy

import judge as judging
import machine as truth
from answer import columns_of
from machine import Machine, measure
from rows import lines, plates

# What each wrong player must fail in: (family, figure), and what nobody may hold against it.
FAILS = {
    "silent": [("coverage", "cause found"), ("refuted", "NAMED without it"), ("refuted", "all-clear"), ("runs", "cause named"), ("books", "named first"), ("repeats", "all-clear over the parts"), ("repeats", "said that they disagree"),
               ("stations", "told apart"), ("circles", "recall"), ("dates", "change said"), ("plans", "named alone"), ("outside", "a formula is proposed"), ("bad", "message of its own"), ("harm", "said what it is")],
    "boaster": [("noise", "false alarms"), ("noise", "effects written"), ("harm", "beyond twice the largest reading"), ("outside", "not NAMED"), ("repeats", "a cause of the machine"), ("repeats", "the machine is blamed"),
                ("stations", "written as a machine's"), ("dates", "change said"), ("bad", "a name"), ("bad", "effects written"), ("runs", "a cause named"), ("circles", "precision"), ("books", "named first")],
    "stubborn": [("refuted", "refuted but NAMED")],
    "clerk": [("books", "bookkeeping blamed")],
    "narrow": [("coverage", "interval holds the truth")],
    "off": [("runs", "forecast within 5 points"), ("circles", "sizes within 10 %"), ("repeats", "noise within a factor of 2"), ("repeats", "gap is the machine's"), ("coverage", "interval holds the truth")],
}
ONLY = {"stubborn": ("refuted",), "clerk": ("books",), "narrow": ("coverage", "circles"), "off": ("coverage", "runs", "circles", "repeats")}
COUNT = 2
# Of families whose kinds are scored alike, these are enough.
ENOUGH = {"noise": ("isotropic", "instrument warming", "standing, AR(1) 0.9"), "coverage": ("isotropic", "runs turned"), "outside": ("step at a joint", "dead zone"),
          "harm": ("ten set-points 5 mm apart", "clusters", "outliers", "play below zero")}


def play(mode, folder, jobs):
    """The judge's table for a played command."""
    command = os.path.join(folder, mode)
    with open(command, "w", encoding="utf-8") as file:
        file.write(f'#!/bin/sh\nexec "{sys.executable}" -S "{os.path.join(os.path.dirname(os.path.abspath(__file__)), "played.py")}" {mode} "$@"\n')
    os.chmod(command, os.stat(command).st_mode | stat.S_IXUSR)
    every = judging.kinds()
    chosen = [k for k, kind in enumerate(every) if kind.family in ONLY.get(mode, judging.FAMILIES) and kind.name in ENOUGH.get(kind.family, (kind.name,))]
    todo = [(command, k, number, 1, None) for k in chosen for number in range(25 if every[k].name == "isotropic" and mode in ("knows", "narrow") else COUNT)]
    with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        cases = list(pool.map(judging.one, *zip(*todo), chunksize=4))
    for case in cases:
        if case["verdict"] == "JUDGE FAILED":
            print(case["family"], case["kind"], case["note"])
    return judging.table([every[k] for k in chosen], cases)


def main(jobs):
    wrong = []

    def expect(text, good):
        print(("ok    " if good else "WRONG ") + text)
        if not good:
            wrong.append(text)

    rng = numpy.random.default_rng(1)
    machine = Machine(rng)
    rows = lines(rng, machine, 3, 9, 12).close()
    for name, draw, wanted in (("AR(1) 0.8", truth.autoregressive(2.0, 0.8), 0.8), ("white", truth.white(2.0), 0.0)):
        d = measure(rng, rows, draw).d
        parts = [(d[rs][:-1], d[rs][1:]) for _, rs in rows.runs()]
        a, b = (numpy.concatenate([p[k].ravel() for p in parts]) for k in (0, 1))
        found = float((a * b).mean() / (d**2).mean())
        expect(f"{name}: correlation of neighbours {found:.3f}, size {d.std():.2f} of 2", abs(found - wanted) < 0.05 and abs(d.std() - 2) < 0.15)
    d = measure(rng, rows, truth.white([1, 2, 3])).d
    expect(f"anisotropic: {numpy.round(d.std(axis=0), 2).tolist()}", numpy.allclose(d.std(axis=0), [1, 2, 3], rtol=0.1))
    quiet, turned = plates(rng, machine, 8).close(), truth.turned(0.0, 400, 0.0)
    size = numpy.abs(measure(rng, quiet, turned).d).max()
    expect(f"plates turned by up to 400 urad read up to {size:.0f} um", 20 < size < 400 * 1e-3 * 800)
    steps = rows.dirs[rows.runs()[0][1]]
    expect("lines are read from both sides", steps.max() == 1 and steps.min() == -1)
    expect("columns of a formula", columns_of("dx ~ dir_x·(y−140)") == {"dir_x", "y"} and columns_of("dz ~ load_kg * x_mm") == {"load", "x"})
    low, high = judging.wilson(3, 100)
    expect(f"Wilson's interval of 3 in 100: {low:.4f} to {high:.4f}", abs(low - 0.0103) < 2e-4 and abs(high - 0.0845) < 2e-4)

    with tempfile.TemporaryDirectory() as folder:
        for row in play("knows", folder, jobs):
            if row["holds"] not in ("yes", "chance") and not (row["holds"] == "nothing" and row["figure"] in ("proposed as rows", "sizes within 10 %")):
                expect(f"a right answer passes: {row['family']}/{row['kind']}: {row['figure']} {row['hits']} of {row['of']}", False)
        expect("what the truth deserves passes everywhere", not wrong)
        for mode, fails in FAILS.items():
            table = play(mode, folder, jobs)
            for family, figure in fails:
                bad = [r for r in table if (r["family"], r["figure"]) == (family, figure) and r["holds"] in ("NO", "nothing")]
                expect(f"{mode}: {family}, {figure}: found in {len(bad)} kinds", bool(bad))
        for row in play("refuser", folder, jobs):
            if row["holds"] == "yes" and row["family"] != "bad":
                expect(f"a command that refuses everything passes {row['family']}/{row['kind']}: {row['figure']}", False)
    print(f"\nself-test: {len(wrong)} wrong")
    return 1 if wrong else 0
