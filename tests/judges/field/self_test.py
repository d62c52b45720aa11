"""The judge against engines of its own (played.py): right, it finds nothing; with each slip it says which. Some minutes.

Also the reader on arcs whose centres are known, and the comparison on a path that is off by a known amount.
"""

import contextlib
import io
import os
import sys
import tempfile

import numpy as np

import compare
import judge
import reader

HERE = os.path.dirname(os.path.abspath(__file__))

# (slip, kinds, cases, what has to be found)
SLIPS = [
    ("right", ["rigid-scattered", "loose-scattered", "rigid-lattice", "exact", "nothing"], 5, ()),
    ("overfits", ["loose-scattered"], 1, ("unseen",)),
    ("stiff", ["loose-lattice"], 1, ("unseen",)),
    ("swap", ["rigid-scattered"], 1, ("unseen",)),
    ("missed", ["exact"], 1, ("nodes",)),
    ("curved", ["exact"], 1, ("between",)),
    ("extrapolates", ["rigid-lattice"], 1, ("outside",)),
    ("ends", ["loose-scattered"], 1, ("path",)),
    ("half", ["loose-scattered"], 1, ("path",)),
    ("plane", ["loose-scattered"], 2, ("path",)),
    ("boast", ["rigid-lattice"], 1, ("summary",)),
    ("blind", ["rigid-lattice"], 1, ("check-blind",)),
]


def arcs():
    """Quarter circles in three planes, clockwise and not; R short and long."""
    wrong = []
    for text, middle in (
        ("G17 G2 X10 Y0 I0 J-10", (7.0711, 7.0711, 0)),
        ("G17 G3 X10 Y0 I0 J-10", (-7.0711, -7.0711, 0)),
        ("G17 G2 X10 Y0 R10", (7.0711, 7.0711, 0)),
        ("G17 G2 X10 Y0 R-10", (17.0711, 17.0711, 0)),
        ("G18 G3 X10 Z10 I10 K0", (2.9289, 10, 7.0711)),
        ("G18 G2 X10 Z10 I0 K10", (7.0711, 10, 2.9289)),
        ("G19 G3 Y0 Z10 J-10 K0", (0, 7.0711, 7.0711)),
    ):
        m = reader.read("G0 X0 Y10 Z0\n" + text, [0, 0, 0], {})[1]
        if np.abs(m.at([0.5])[0] - middle).max() > 1e-3:
            wrong.append(f"{text}: {m.at([0.5])[0]} for {middle}")
    m = reader.read("G0 X0 Y10 Z0\nG3 I0 J-10\nG1 X5", [0, 0, 0], {})
    real = lambda q: q + np.array([0, 0, 0.004]) * (q[:, :1] < -5)  # noqa: E731
    found = compare.compare(m, m, real, 0.01, 1.0)
    if abs(found["um"] - 4) > 1e-3 or found["line"] != 2:
        wrong.append(f"a full circle off by 4 um: {found}")
    skipped = reader.read("G0 X0 Y10 Z0\nG1 X5", [0, 0, 0], {})
    if compare.compare(m, skipped, lambda q: q, 0.01, 1.0)["um"] < 1e3:
        wrong.append("a circle that is left out is not found")
    return wrong


def main():
    bad = 0
    for words in arcs():
        print("WRONG", words)
        bad += 1
    for slip, kinds, count, wanted in SLIPS:
        with tempfile.TemporaryDirectory() as keep:
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                # what lies between rigid-body and field is not played
                judge.coincide = lambda *_: []
                judge.judge([sys.executable, os.path.join(HERE, "played.py"), slip], keep, "self-test", 0, count, kinds, programs=1)
        last = said.getvalue().rstrip().splitlines()[-1].split("found:")[1]
        missing = [w for w in wanted if repr(w) not in last]
        wrong = bool(missing) if wanted else "nothing" not in last
        bad += wrong
        print(f"{'WRONG' if wrong else 'ok   '} {slip}: found{last}{' missing ' + ', '.join(missing) if missing else ''}", flush=True)
        if wrong:
            print("      " + "\n      ".join(said.getvalue().splitlines())[:3000])
    return int(bool(bad))
