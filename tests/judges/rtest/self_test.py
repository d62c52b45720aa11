"""The judge against estimators of its own (played.py): right, it finds nothing; with each slip it says which. Some minutes.

Also the machine against LinuxCNC's formula of xyzac-trt, and the two ways of reading a table against each other.
"""

import contextlib
import io
import os
import shlex
import sys
import tempfile

import numpy as np

import generate
import judge
import machine

HERE = os.path.dirname(os.path.abspath(__file__))

# (slip, chains, kinds, cases, what has to be found)
SLIPS = [
    ("right", ["ac", "bc", "one", "nutating"], None, 24, ()),
    ("right", ["head-table", "head-head"], ["locations", "tables", "perfect"], 6, ()),
    ("boast", ["ac", "bc"], ["tables", "locations"], 12, ("interval",)),
    ("silent", ["ac", "head-table"], ["tables"], 4, ("silent", "unseen", "unnamed")),
    ("swap", ["ac", "one"], ["locations", "sphere"], 4, ("far", "unseen")),
    ("sign", ["bc", "head-head"], ["based", "tables"], 4, ("far", "unseen", "worse")),
    ("no-tables", ["ac"], ["tables"], 2, ("unseen",)),
    ("shift", ["bc"], ["tables"], 2, ("unseen",)),
    ("invents", ["head-head"], ["locations"], 2, ("invented", "unnamed")),
]


def formula():
    """xyzac-trt: p = O + Rz(-C) [d + Rx(-A) (J - O - d)], c_C = O, c_A = O + d."""
    o, d = np.array([3.0, -4, -70]), np.array([0.5, 6, 11])
    spec = {"chain": "[w C A b X Y Z t]", "axes": {a: {} for a in "XYZ"}, "rotary": {"C": {"centre": o}, "A": {"centre": o + d}}}
    q, a, c, t = np.array([50.0, 20, -10]), 0.4, -1.1, np.array([0, 0, -130.0])
    rx = np.array([[1, 0, 0], [0, np.cos(-a), -np.sin(-a)], [0, np.sin(-a), np.cos(-a)]])
    rz = np.array([[np.cos(-c), -np.sin(-c), 0], [np.sin(-c), np.cos(-c), 0], [0, 0, 1]])
    wanted = o + rz @ (d + rx @ (q + t - o - d))
    got = machine.Machine(spec).tip(q[None], np.degrees([[c, a]]), t[None])[0]
    return np.abs(wanted - got).max() < 1e-11


def main():
    bad = 0
    if not formula():
        print("WRONG the machine is not xyzac-trt")
        bad += 1
    case = generate.Case("t", 0, "nutating", "based")
    there = case.truth.command(case.base.tip(*case.unseen[:3], ideal=True), case.unseen[1], case.unseen[2], ideal=False)
    if np.abs(case.truth.tip(there, *case.unseen[1:3]) - case.base.tip(*case.unseen[:3], ideal=True)).max() > 1e-9:
        print("WRONG the command does not bring the tip there")
        bad += 1
    for slip, chains, kinds, count, wanted in SLIPS:
        with tempfile.TemporaryDirectory() as keep:
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                vpost = [sys.executable, os.path.join(HERE, "played.py"), slip]
                judge.judge(vpost, keep, "self-test", 0, count, chains, kinds)
        last = said.getvalue().rstrip().splitlines()[-1].split("found:")[1]
        missing = [w for w in wanted if repr(w) not in last]
        wrong = bool(missing) if wanted else "nothing" not in last
        bad += wrong
        print(f"{'WRONG' if wrong else 'ok   '} {slip}: found{last}{' missing ' + shlex.join(missing) if missing else ''}", flush=True)
        if wrong:
            print("      " + "\n      ".join(x for x in said.getvalue().splitlines() if " " in x)[:3000])
    return int(bool(bad))
