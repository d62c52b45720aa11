"""Shows that the judge passes what is right and finds what is wrong, and that its reader reads as LinuxCNC does."""

import pathlib
import re
import tempfile

import numpy as np

from common.interpreter import interpret
from common.trial import Trial

import judge
import mock
import program
from reader import Reader


def cases(count, wanted=lambda case: True):
    out, n = [], 0
    while len(out) < count:
        case = program.Case(77, n)
        if not case.play and wanted(case):
            case.spec["resolution"] = 0.0001
            out.append(case)
        n += 1
    return out


def difference(case, fault):
    """By how much a fault leads off, in times what is allowed."""
    moves = [m for m in Reader(case).read(case.text) if m.feed]
    gap = lambda m: np.linalg.norm(
        fault(case, case.datums[m.offset], m.angles) - mock.right(case, case.datums[m.offset], m.angles), axis=1
    ).max()
    return max(gap(m) / judge.limit(case, m.offset) for m in moves)


def main():
    t = Trial()
    chosen = cases(20)
    wrong = [judge.compare(c, mock.corrected(c, mock.right))[0] for c in chosen]
    t.ask(not any(wrong), "right outputs that pass: %d of %d %s" % (sum(not w for w in wrong), len(chosen), [w for w in wrong if w][:2]))
    for fault in mock.FAULTS:
        bad = [c for c in chosen if difference(c, fault) > 1.3][:4]
        caught = sum(bool(judge.compare(c, mock.corrected(c, fault))[0]) for c in bad)
        t.ask(bad and caught == len(bad), "%s: found %d of %d" % (fault.__name__.replace("_", " "), caught, len(bad)))
    t.ask(all(judge.compare(c, c.text)[0] for c in chosen), "uncorrected: found in all")
    few = [c for c in chosen if c.spec["tolerance"] == 1.0][:4]
    for name, by in (("a feature 3 um aside", 3e-3), ("a feature 0.2 um aside, which passes", 0.2e-3)):
        caught = sum(bool(judge.compare(c, mock.corrected(c, mock.right, aside(c, by)))[0]) for c in few)
        t.ask(caught == (len(few) if by > 1e-3 else 0), "%s: found %d of %d" % (name, caught, len(few)))
    lost = [c for c in chosen if len(judge.stretches(Reader(c).read(c.text))) > 2][:4]
    caught = sum(bool(judge.compare(c, without_last(mock.corrected(c, mock.right)))[0]) for c in lost)
    t.ask(caught == len(lost), "a feed left out: found %d of %d" % (caught, len(lost)))
    agree = [c for c in cases(8, lambda c: c.dialect == "linuxcnc" and not c.rotary)]
    t.ask(all(as_linuxcnc(c) for c in agree), "%d programs read as LinuxCNC's interpreter reads them" % len(agree))
    return t.status()


def aside(case, by):
    """Shifts the last feeds in X."""
    moves = Reader(case).read(case.text)
    last = max(n for n, m in enumerate(moves) if m.feed)
    return lambda number, target: target + [by, 0, 0] if number == last else target


def without_last(text):
    lines = text.splitlines()
    last = max(k for k, x in enumerate(lines) if x.startswith("G1"))
    first = max(k for k in range(last) if lines[k].startswith("G0"))
    return "\n".join(lines[: first + 1] + lines[last + 1 :])


def as_linuxcnc(case):
    """Ends of feeds by rs274 and by the reader, in program coordinates."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case.ini = {d.name: d.at for d in case.datums.values()}
        program.control_files(folder, case)
        said = interpret(case.text, (folder / "shop.tbl").read_text(), (folder / "shop.var").read_text())
    ends = []
    for what, numbers in re.findall(r"\b(STRAIGHT_FEED|ARC_FEED)\((.*?)\)", said.calls):
        v = [float(x) for x in numbers.split(",")]
        ends.append([v[0], v[1], v[5]] if what == "ARC_FEED" else v[:3])
    mine = [m.points[-1] + m.tool - case.datums[m.offset].at for m in Reader(case).read(case.text) if m.feed]
    return len(mine) == len(ends) and np.abs(np.array(mine) - ends).max() < 2e-4
