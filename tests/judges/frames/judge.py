#!/usr/bin/env python3
"""Judge of frames: does vpost move an axis that the program leaves standing, on any control that its dialect may mean?

What it judges, from the documents alone (no code of vpost is read or imported):

* random programs (programs.py) for random crooked machines (model.py) are corrected; each that is accepted is executed by a
  simulated control (control.py) under every variant that its dialect leaves open, input and output side by side, and
  compared block by block (compare.py). Allowed is 1.5 times the largest error of the machine per axis, and the rounding.
  A program that is refused loses the blamed line and is tried again, so that many programs end accepted.
* directed programs (directed.py): each a named test with what has to become of it.

Run:    judge.py --vpost PATH [--count 2000] [--seed 1] [--only random|directed] [--dialect D] [--keep DIR]
        judge.py --self-test           shows that wrong outputs are found and right ones are not blamed
Prints one line per check and one per kind of failure with its smallest program; exit status 1 when something is wrong.
`--keep DIR` holds a folder for each kind: program, output, profile and tables, command, what was found.
"""

import collections
import os
import random
import re
import shutil
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders, options  # noqa: E402
from common.command import ask, run  # noqa: E402

import compare
import control
import directed
import mock
import model
import programs

DIALECTS = ["fanuc", "fanuc", "fanuc", "linuxcnc", "linuxcnc", "centroid", "perspektiva", "balt-system", "sinumerik"]
LINE = re.compile(r"-->\s*[^\n]*?:(\d+):\d+")


def call(vpost, folder, text, profile, dialect, arguments=()):
    """(exit status, output, messages) of one run."""
    folders.put(folder, "in.nc", text)
    command = [*directed.correct(vpost), "in.nc", "-m", profile, "--zero", "true", "--dialect", dialect, "--color", "never", *arguments]
    return *ask(*command, folder=folder, seconds=60), command


def judge_output(lines, output, machine, dialect, start_at):
    """All that is wrong with an accepted output: a list of compare.Found, one of each kind at most."""
    out, order, rest = compare.segments(output)
    if order != list(range(len(lines))):
        return [compare.Found("blocks: comments lost or out of order", 0, "", f"comments come out as {order}")]
    out["rest"] = rest
    found = {}
    for f in compare.added_words(lines, out, dialect, machine.keeps):
        found.setdefault(f.kind, f)
    for variant in control.variants(dialect, machine.keeps):
        f = compare.motion(lines, out, machine, dialect, variant, start_at)
        if f:
            found.setdefault(f.kind, f)
    f = compare.uncorrected(lines, out, machine, dialect, start_at)
    if f:
        found.setdefault(f.kind, f)
    return list(found.values())


class Random:
    """The random part: makes programs, keeps the smallest of each kind of failure."""

    def __init__(self, options, folder):
        self.o, self.folder = options, folder
        self.count = collections.Counter()
        self.kinds = {}                       # (dialect, kind) -> [times, lines, found, command, machine, arguments]
        self.profiles = {}
        self.machines = [model.Machine(random.Random(f"{options.seed} machine {k}"), k, keeps=k == 0) for k in range(8)]
        if run(options.vpost, "profile", "check", self.profile(self.machines[0], "fanuc"), folder=folder).status:
            print("random: this vpost knows no [program] tool_change: machines without it only")
            self.machines[0].keeps, self.profiles = False, {}

    def profile(self, machine, dialect):
        key = machine.name, dialect
        if key not in self.profiles:
            self.profiles[key] = os.path.basename(machine.write(self.folder, dialect))
        return self.profiles[key]

    def attempt(self, lines, machine, dialect, arguments):
        text = compare.with_marks(lines, dialect)
        return call(self.o.vpost, self.folder, text, self.profile(machine, dialect), dialect, arguments)

    def accepted(self, lines, machine, dialect, arguments):
        """Takes out what is refused until the program is accepted; gives lines, output, messages, or None."""
        for _ in range(12):
            status, output, messages, command = self.attempt(lines, machine, dialect, arguments)
            if status == 0:
                return lines, output, messages, command
            if status != 1:
                self.note(dialect, "status: neither done nor refused", lines, messages, command, machine, arguments)
                return None
            m = LINE.search(messages)
            if not m or output:
                return None
            k = (int(m.group(1)) - 1) // 2
            lines = lines[:k] + lines[k + 1:]
            if not lines:
                return None
        return None

    def note(self, dialect, kind, lines, detail, command, machine, arguments):
        entry = self.kinds.setdefault(kind, [collections.Counter(), lines, detail, command, machine, arguments, dialect])
        entry[0][dialect] += 1
        if len(lines) < len(entry[1]):
            entry[1:] = [lines, detail, command, machine, arguments, dialect]

    def one(self, index):
        r = random.Random(f"{self.o.seed} program {index}")
        dialect = self.o.dialect or r.choice(DIALECTS)
        machine = r.choice(self.machines)
        lines = programs.program(r, machine, dialect)
        start_at, arguments = None, []
        if r.random() < 0.35:
            start_at = [machine.travel[a][0] + x for a, x in zip("XYZ", (350.0, 220.5, 300.0))]
            arguments = ["--start-at=" + ",".join(f"{x:g}" for x in start_at)]
        self.count["programs"] += 1
        done = self.accepted(lines, machine, dialect, arguments)
        if not done:
            self.count["refused for good"] += 1
            return
        lines, output, messages, command = done
        if output == compare.with_marks(lines, dialect):
            self.count["unchanged"] += 1
        self.count["judged"] += 1
        self.count["judged " + dialect] += 1
        if index % 10 == 0:
            plain = call(self.o.vpost, self.folder, "\n".join(lines) + "\n", self.profile(machine, dialect), dialect, arguments)
            without = "".join(x + "\n" for x in output.split("\n")[:-1] if not compare.MARK.match(x.strip()))
            if plain[0] != 0 or plain[1] != without:
                self.note(dialect, "blocks: numbered comments change what is written", lines, plain[2], command, machine, arguments)
        try:
            all_found = judge_output(lines, output, machine, dialect, start_at)
            self.count["programs wrong"] += bool(all_found)
            moved = [f.detail for f in all_found if f.kind.startswith(("moved", "path"))]
            self.count["programs with wrong motion"] += bool(moved)
            self.count["... with offsets as in the profile"] += any("shifted" not in x.split("]")[0] and "longer" not in x.split("]")[0] for x in moved)
            for f in all_found:
                self.note(dialect, f.kind, lines, f.detail, command, machine, arguments)
        except control.NotSimulated as what:
            self.count[f"not simulated: {what}"] += 1
        stated = any(re.search(r"G(20|21)\b", x) for x in lines)
        moves = any(re.search(r"[XYZ]", re.sub(r"\(.*?\)", "", x)) for x in lines)
        if dialect == "fanuc" and not stated and moves and not re.search(r"G20|G21|inch|unit", messages, re.I):
            self.note(dialect, "unsaid: neither G20 nor G21, and no warning", lines, messages, command, machine, arguments)

    def smaller(self, kind):
        """Takes lines out as long as the same kind of failure stays."""
        _, lines, detail, command, machine, arguments, dialect = self.kinds[kind]
        start_at = [float(x) for x in arguments[0].split("=")[1].split(",")] if arguments else None
        shrunk, left = True, 120
        while shrunk and left > 0:
            shrunk = False
            for k in range(len(lines) - 1, -1, -1):
                left -= 1
                fewer = lines[:k] + lines[k + 1:]
                status, output, messages, command = self.attempt(fewer, machine, dialect, arguments)
                if status != 0:
                    continue
                try:
                    same = [f for f in judge_output(fewer, output, machine, dialect, start_at) if f.kind == kind]
                except control.NotSimulated:
                    continue
                if same:
                    lines, detail, shrunk = fewer, same[0].detail, True
        self.kinds[kind][1:3] = [lines, detail]

    def report(self):
        for kind in sorted(self.kinds):
            if not kind.startswith(("status", "unsaid", "blocks")):
                self.smaller(kind)
        for number, kind in enumerate(sorted(self.kinds, key=lambda k: (-sum(self.kinds[k][0].values()), k))):
            times, lines, detail, command, machine, arguments, dialect = self.kinds[kind]
            print(f"WRONG {sum(times.values()):5d} x  {kind}   ({', '.join(f'{d} {n}' for d, n in sorted(times.items()))})")
            print(f"          {dialect}: {' | '.join(lines)[:400]}   {' '.join(arguments)}\n          {detail[:600]}")
            keep(os.path.join(self.o.keep, f"random-{number:02d}"), machine, lines, dialect, kind, detail, command)
        print("random:", ", ".join(f"{k} {v}" for k, v in sorted(self.count.items())))
        print(f"random programs: {self.count['judged']} judged, {self.count['programs wrong']} of them wrong, in {len(self.kinds)} kinds")
        return bool(self.kinds)


def keep(to, machine, lines, dialect, kind, detail, command):
    """Writes a reproducer folder: program, output, profile with its tables, command, what was found."""
    os.makedirs(to, exist_ok=True)
    machine.write(to, dialect)
    folders.put(to, "in.nc", compare.with_marks(lines, dialect))
    done = run(*command, folder=to)
    folders.put(to, "out.nc", done.output)
    folders.put(to, "found.txt", f"{dialect}: {kind}\n{detail}\ncommand: {' '.join(['vpost'] + command[1:])}\n{done.errors}")


def self_test():
    """Known wrong outputs are found, known right ones pass."""
    r = random.Random("self-test")
    machine = model.Machine(r, 0)
    machine.square = {k: 50.0 for k in machine.square}
    lines = ["G21 G90 G17 G54", "G0 X10. Y20. Z60.", "G43 H1 Z20.", "G0 G53 Z%.0f." % machine.travel["Z"][1], "X50. Y30.", "G0 Z20.", "G1 Z5. F100.",
             "X60.", "G43 H2", "G1 Y40.", "M6", "G0 X1. Y1.", "Z9.", "M30"]
    good = {k: [x] for k, x in enumerate(lines)}
    cases = [
        ("nothing changed", {}, None),
        ("Z added to a rapid behind G53", {4: ["X50. Y30. Z20."]}, ("word added: rapid", "moved")),
        ("Z added to a feed behind a bare G43", {9: ["G1 Y40. Z5."]}, ("word added: feed", "moved")),
        ("an axis added to a feed that named it", {7: ["X60. Z5.01"]}, None),
        ("X one millimetre off", {4: ["X51. Y30."]}, ("moved",)),
        ("a detour that comes back", {7: ["X60. Z15.", "X60. Z5."]}, ("path",)),
        ("a block lost", {5: []}, ("moved",)),
        ("a word left out", {11: ["G0 X1."]}, ("moved",)),
        ("a correction too large by ten", {7: ["X61."]}, ("moved",)),
        ("words of G53 corrected", {3: ["G0 G53 Z%.0f." % (machine.travel["Z"][1] - 120)]}, ("moved",)),
        ("a length doubled", {2: ["G43 H2 Z20."]}, ("moved",)),
        ("offset changed", {0: ["G21 G90 G17 G55"]}, ("moved",)),
        ("inches", {0: ["G20 G90 G17 G54"]}, ("moved",)),
    ]
    wrong = 0
    for name, changes, expected in cases:
        output = "".join("\n".join({**good, **changes}[k]) + f"\n(@{k})\n" for k in range(len(lines)))
        kinds = {f.kind for f in judge_output(lines, output, machine, "fanuc", None) if not f.kind.startswith("uncorrected")}
        missing = [e for e in expected or () if not any(k.startswith(e) for k in kinds)]
        ok = not missing and (expected is not None or not kinds)
        wrong += not ok
        print(("ok    " if ok else "WRONG ") + f"self-test: {name}: {sorted(kinds) or 'nothing found'}")
    output = "".join(f"{x}\n(@{k})\n" for k, x in enumerate(lines))
    plain = {f.kind for f in judge_output(lines, output, machine, "fanuc", None)}
    ok = any(k.startswith("uncorrected") for k in plain)
    wrong += not ok
    print(("ok    " if ok else "WRONG ") + "self-test: an output that was never corrected is found")
    false, judged = collections.Counter(), 0
    for k in range(300):
        r = random.Random(f"self-test {k}")
        dialect = DIALECTS[k % len(DIALECTS)]
        machine = model.Machine(r, k)
        lines = programs.program(r, machine, dialect)
        start_at = [machine.travel[a][0] + 200.0 for a in "XYZ"] if k % 3 == 0 else None
        try:
            found = judge_output(lines, mock.output(lines, machine, dialect, r), machine, dialect, start_at)
        except control.NotSimulated:
            continue
        judged += 1
        for f in found:
            if not f.kind.startswith("uncorrected"):
                false[f.kind] += 1
                print(f"          false alarm: {dialect}: {f.kind}: {f.detail[:300]}\n          {' | '.join(lines)}")
    wrong += bool(false) or judged < 200
    print(("ok    " if not false and judged >= 200 else "WRONG ") + f"self-test: {judged} outputs of a right corrector, {sum(false.values())} false alarms")
    wrong += directed.self_test()
    print(f"self-test: {wrong} wrong")
    return wrong > 0


def main():
    p = options.parser(__doc__, 2000, "jobs", vpost="vpost", seed="1")
    p.add_argument("--only", choices=["random", "directed"])
    p.add_argument("--dialect")
    p.add_argument("--name", help="directed tests whose name contains this")
    o = p.parse_args()
    if o.self_test:
        return self_test()
    o.vpost, o.keep = options.command(p, o.vpost)[0], folders.of_findings(o.keep, "judge-frames-kept-")
    folder = tempfile.mkdtemp(prefix="judge-frames-")
    bad = False
    try:
        if o.only != "random":
            bad |= directed.judge(o, folder)
        if o.only != "directed":
            judge = Random(o, folder)
            index = 0
            while judge.count["judged"] < o.count and index < 20 * o.count:
                judge.one(index)
                index += 1
            bad |= judge.report()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print("something is wrong: reproducers in " + o.keep if bad else "nothing wrong")
    return bad


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
