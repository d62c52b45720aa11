"""Runs directed tests: named programs with what has to become of them. The tests themselves are in cases.py.

An expectation is one of
    refuse   exit status 1, nothing on standard output
    warn     exit status 0 and a warning
    pass     exit status 0
    usage    exit status 2
    careful  refused, or exit status 0 with an output that the simulated controls find right
and `says` is a pattern that the messages must match, `silent` one that they must not. `judged` runs the output through
the comparison of compare.py as well (the program then gets a numbered comment behind each line). `blames` is the block
that a refusal must be about; `like` two spellings that have to be corrected alike; `once`: exactly one warning.
"""

import functools
import os
import random
import re
import shutil
import stat
import tempfile

from common import folders
from common.command import ask, run

import cases
import compare
import control
import model


@functools.lru_cache(maxsize=None)
def correct(vpost):
    """How this binary is asked to correct: `vpost IN.nc`, or `vpost correct IN.nc` where it has that command."""
    return [vpost, "correct"] if run(vpost, "help", "correct").status == 0 else [vpost]


def machine():
    r = random.Random("directed")
    m = model.Machine(r, "directed")
    m.travel = {"X": (-700.0, 0.0), "Y": (-450.0, 0.0), "Z": (-520.0, 0.0)}
    low = {a: m.travel[a][0] for a in "XYZ"}
    m.offsets = {"G54": [-420.0, -260.0, -400.0], "G55": [-560.0, -200.0, -388.5]}
    m.home = [0.0, 0.0, 0.0]
    r = random.Random("directed tables")
    for a in "XYZ":
        nodes = [low[a] + (0 - low[a]) * k / 6 for k in range(7)]
        m.tables[a] = [(q, [r.uniform(-30, 30) for _ in range(3)] + [r.uniform(-70, 70) for _ in range(3)]) for q in nodes]
        m._nodes[a] = nodes
    m.square = {"EC0Y": 120.0, "EB0Z": -90.0, "EA0Z": 70.0}
    return m


ROTARY = """
[rotary.A]
centre_mm = [-350, -225, -350]
travel_deg = [-360, 360]
EY0A_um = 25.0
EZ0A_um = -18.0
tilt = "body"
EB0A_urad = 60.0
EC0A_urad = -45.0
"""


def write_profile(m, folder, dialect, test):
    path = m.write(folder, dialect, (ROTARY if test.rotary else "") + test.extra)
    if test.rotary:
        with open(path) as file:
            text = file.read().replace('"[w X Y b Z t]"', '"[w A X Y b Z t]"')
        with open(path, "w") as file:
            file.write(text)
    return os.path.basename(path)


def execute(vpost, folder, test, m):
    """One test; gives (what is wrong or '', status, output, messages, command)."""
    text = compare.with_marks(test.lines, test.dialect) if test.judged is not None else test.text
    folders.put(folder, "in.nc", text)
    wrong, best = "", None
    for extra in test.either or [test.extra]:
        test.extra = extra
        profile = write_profile(m, folder, test.dialect, test)
        if test.check:
            text = corrected_and_changed(vpost, folder, test, profile)
            if text is None:
                return "the program that check is to judge was refused", 1, "", "", []
        command = [*([vpost, "check", "in.nc", "changed.nc"] if test.check else [*correct(vpost), "in.nc"]), "-m", profile, "--zero", "true", "--dialect", test.dialect, "--color", "never", *test.args]
        status, output, messages = ask(*command, folder=folder, seconds=60)
        if status == -1:
            return messages, status, output, "", command
        wrong = verdict(test, text, status, output, messages, m)
        if not wrong and test.like:
            folders.put(folder, "other.nc", text.replace(*test.like))
            other = run(*("other.nc" if x == "in.nc" else x for x in command), folder=folder, seconds=60).output
            if other != output.replace(*test.like):
                wrong = f"{test.like[0]} is not corrected as {test.like[1]} is"
        if best is None or not wrong:
            best = wrong, status, output, messages, command
        if not wrong:
            break
    return best


def corrected_and_changed(vpost, folder, test, profile):
    """For tests of `check`: corrects the program, then puts the same other block into both files."""
    old, new = test.check
    folders.put(folder, "in.nc", test.text)
    done = run(*correct(vpost), "in.nc", "-m", profile, "--zero", "true", "--dialect", test.dialect, folder=folder, seconds=60)
    if done.status or old not in done.output:
        return None
    for name, text in (("in.nc", test.text), ("changed.nc", done.output)):
        folders.put(folder, name, text.replace(old, new))
    return test.text.replace(old, new)


def verdict(test, text, status, output, messages, m):
    if test.expect == "usage":
        return "" if status == 2 and not re.search(test.silent, messages) else f"exit status {status}: {first(messages)}"
    if status not in (0, 1):
        return f"exit status {status}: {first(messages)}"
    wanted = test.expect
    if wanted == "careful" and status == 1:
        return ""
    if wanted == "refuse" and status != 1:
        return "exit status 0" + (": passed unchanged" if output == text else "") + (", with " + first(messages) if messages else ", without a word")
    if wanted == "refuse" and test.blames and f":{test.lines.index(test.blames) + 1}:" not in messages:
        return f"refused for another reason than {test.blames!r}: {first(messages)}"
    if wanted == "refuse" and output and not test.check:
        return "refused, but something stands on standard output"
    if wanted in ("pass", "warn", "careful") and status != 0:
        return "refused: " + first(messages)
    if wanted == "warn" and "warning" not in messages:
        return "no warning"
    if test.once and len(re.findall(r"^warning", messages, re.M)) != 1:
        return f"{len(re.findall(r'^warning', messages, re.M))} warnings"
    if test.says and not re.search(test.says, messages, re.I | re.S):
        return f"messages do not say /{test.says}/: {first(messages) or 'nothing'}"
    if test.silent and re.search(test.silent, messages, re.I):
        return f"messages say /{test.silent}/: {first(messages)}"
    if status == 0 and test.holds:
        said = test.holds(text, output)
        if said:
            return said
    if status == 0 and test.judged is not None:
        out, order, _ = compare.segments(output)
        if order != list(range(len(test.lines))):
            return "comments lost or out of order"
        found = compare.added_words(test.lines, out, test.dialect, "keeps" in test.extra)
        for variant in control.variants(test.dialect):
            variant.update(test.judged)
            try:
                f = compare.motion(test.lines, out, m, test.dialect, variant, test.start_at)
            except control.NotSimulated:
                f = None
            found += [f] if f else []
        if found:
            return f"{found[0].kind}: {found[0].detail}"
    return ""


def first(messages):
    lines = [x for x in messages.split("\n") if x.startswith(("error", "warning"))]
    return "; ".join(lines)[:240]


def judge(o, folder):
    """All directed tests with the binary `o.vpost`; prints the table; True where something is wrong."""
    m, wrong, items = machine(), 0, {}
    for test in cases.all_tests():
        if o.name and o.name not in test.name or o.dialect and o.dialect != test.dialect:
            continue
        said, status, output, messages, command = execute(o.vpost, folder, test, m)
        ok, total = items.get(test.item, (0, 0))
        items[test.item] = ok + (not said), total + 1
        print(f"{'ok    ' if not said else 'WRONG '} {test.name} [{test.dialect}] expects {test.expect}{': ' + said if said else ''}")
        if said:
            wrong += 1
            to = os.path.join(o.keep, "directed-" + test.name)
            os.makedirs(to, exist_ok=True)
            shutil.copy(os.path.join(folder, "in.nc"), to)
            write_profile(m, to, test.dialect, test)
            folders.put(to, "out.nc", output)
            folders.put(to, "found.txt", f"{test.name}: expects {test.expect}\n{said}\ncommand: {' '.join(['vpost'] + command[1:])}\n{messages}")
    for item in sorted(items, key=lambda x: int(re.match(r"\d+", x).group())):
        print(f"directed, item {item}: {items[item][0]} of {items[item][1]} as expected")
    print(f"directed tests: {wrong} wrong")
    return wrong > 0


def self_test():
    """A command that passes everything, and one that refuses everything, must fail their tests."""
    folder, wrong = tempfile.mkdtemp(), 0
    m = machine()
    for name, script, blamed in [
            ("passes all unchanged", '#!/bin/sh\nif [ "$1" = help ]; then exit 1; fi\nif [ "$1" = check ]; then exit 0; fi\ncat "$1"\n', lambda t: t.expect in ("refuse", "warn")),
            ("refuses all", '#!/bin/sh\necho "error[VP0000]: no" >&2\nexit 1\n', lambda t: t.expect in ("pass", "warn"))]:
        path = os.path.join(folder, "fake")
        with open(path, "w") as file:
            file.write(script)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        missed = [t.name for t in cases.all_tests() if blamed(t) and not execute(path, folder, t, m)[0]]
        wrong += bool(missed)
        print(("ok    " if not missed else "WRONG ") + f"self-test: a command that {name}: " + (f"not found by {missed}" if missed else "found by every test that should"))
    shutil.rmtree(folder)
    return wrong
