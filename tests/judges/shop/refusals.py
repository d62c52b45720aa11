"""Zeros that cannot be what they say: each has to end with exit status 2, no output and a message of its own."""

import pathlib
import random
import re
import tempfile

from common.command import first_error, run

import machine as machines

PROGRAM = "G21 G17 G90 G94 G40 G49 G54\nG0 X0. Y0.\nG43 H1 Z30.\nG0 Z2.\nG1 Z-1. F100\nX20. F300\nG0 Z30.\nM30\n"
PLACE, ZERO = [10.0, 20.0, -5.0], [10.0, 20.0, 0.0]
SOUND = {"at": ZERO, "zero": "touched", "touched_at": {"X": {"at": PLACE, "tool": "H1"}, "Z": {"at": PLACE, "tool": 40.0}}}
# What is said of the touch; `zero` beside it, and the axis that the machine lacks.
BAD = {
    "a touch outside the volume": lambda lacks: {"touched_at": {"X": {"at": [900.0, 20.0, 0.0], "tool": "H1"}}},
    "a touch by a tool that the profile lacks": lambda lacks: {"touched_at": {"Y": {"at": PLACE, "tool": "H9"}}},
    "two places for one axis": lambda lacks: {"touched_at": {"at": PLACE, "tool": "H1", "X": {"at": PLACE, "tool": "H1"}}},
    "a rotary axis that the machine lacks": lambda lacks: {"touched_at": {"at": PLACE, "tool": "H1", "rotary_deg": {lacks: 30.0}}},
    "an offset both touched and true": lambda lacks: {"zero": "true", "touched_at": {"at": PLACE, "tool": "H1"}},
}


def attempt(vpost, rotary, offset):
    rng = random.Random("shop refusals %s" % rotary)
    spec = machines.random_machine(rng, rotary, False)
    while rotary and ("B" in spec["chain"] or spec["chain"].endswith("A t]")):
        spec = machines.random_machine(rng, rotary, False)
    spec["lengths"] = {"H1": 80.0}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        where = machines.profile(spec, "fanuc", folder, {"G54": offset})
        (folder / "in.nc").write_text(PROGRAM.replace("G0 X0.", "G0 A0. C0.\nG0 X0.", 1) if rotary else PROGRAM)
        return run(vpost, "correct", folder / "in.nc", "-m", where)


def judged(vpost):
    """[(good, text)]"""
    out, seen = [], {}
    for rotary in (False, True):
        machine = "on five axes" if rotary else "on three axes"
        status, text, errors = attempt(vpost, rotary, SOUND)
        out.append((status == 0 and text, "a sound one, %s: status %d %s" % (machine, status, first_error(errors))))
        for name, said in BAD.items():
            status, text, errors = attempt(vpost, rotary, {"at": ZERO, **said("B" if rotary else "A")})
            out.append((status == 2 and not text, "%s, %s: status %d %s" % (name, machine, status, first_error(errors))))
            seen.setdefault(message(errors), set()).add(name)
    for words, names in seen.items():
        out.append((len(names) == 1 and words, "a message of its own: %s: %s" % (" and ".join(sorted(names)), words)))
    return out


def message(errors):
    """The message without what it says of this case: numbers, and what stands in quotes."""
    code, _, text = first_error(errors).partition("]")
    return code + "]" + re.sub(r"`[^`]*`|\"[^\"]*\"|[-+]?\d[\d.]*", "", text)


def main(vpost):
    failed = 0
    for good, text in judged(vpost):
        failed += not good
        print("%s %s" % ("ok  " if good else "FAIL", text))
    return 1 if failed else 0
