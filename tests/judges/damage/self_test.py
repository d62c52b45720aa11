"""Shows that this judge can fail: known-wrong outputs, a check that passes everything, a check that passes nothing."""

import collections
import contextlib
import io
import re
import tempfile

import damages
import judge
from reader import Unreadable, trace


class Stub:
    """The command with another `check`."""

    def __init__(self, command, status):
        self.command, self.status = command, status

    def run(self, *arguments):
        if arguments[0] != "check":
            return self.command.run(*arguments)
        return self.status, '{"findings": []}', ""


def unseen_damages(counts, seeds):
    """Kinds whose effect the reader sees and the referee does not, on a machine without errors, where IN is right."""
    unseen = collections.Counter()
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            case = judge.Case(folder, seed, ["straight"], seed % 5 == 0)
            end = "\r\n" if b"\r\n" in case.text else "\n"
            lines = case.text.decode().split(end)
            if case.judge(case.text):
                unseen["a right program is refused"] += 1
                continue
            items = case.read(case.text)
            inch, now = [], False
            for line in lines:
                codes = re.findall(r"[Gg]0*(20|21)(?![\d.])", re.sub(r"\([^)]*\)", "", line))
                now = codes[-1] == "20" if codes else now
                inch.append(now)
            for kind, edit in damages.KINDS.items():
                new = edit(damages.Text(lines, items, case.dialect, f"{kind} {seed}", inch))
                if new is None or new == lines:
                    continue
                raw = end.join(new).encode()
                try:
                    if trace(case.read(raw)) == trace(items):
                        continue
                except Unreadable:
                    continue
                counts[kind] += 1
                if not case.judge(raw):
                    unseen[kind] += 1
    return unseen


def run(command):
    bad = []
    counts = collections.Counter()
    unseen = unseen_damages(counts, range(1, 16))
    for kind, n in unseen.items():
        print(f"self-test: the referee takes {n} of {counts[kind]}: {kind}")
        # Along a straight line, up in the air, on a motion of micrometres there is nothing to see.
        if kind not in damages.GEOMETRIC | {"G99 becomes G98", "G98 becomes G99", "feed 5 % more"} and n > 0.1 * counts[kind]:
            bad.append(f"the referee does not see: {kind}")
    print(f"self-test: {sum(counts.values())} damages of {len(counts)} kinds, {sum(unseen.values())} not seen by the referee")
    # The program as it is, on machines with play: never right.
    taken = 0
    for seed in range(30):
        with tempfile.TemporaryDirectory() as folder:
            case = judge.Case(folder, seed, ["backlash", "directions", "crooked"], False)
            taken += not case.judge(case.text)
    print(f"self-test: 30 programs as they are on crooked machines, taken: {taken}")
    if taken > 1:
        bad.append("uncorrected programs are taken")
    for status, wanted in ((0, "damage passes"), (1, "false alarm")):
        with tempfile.TemporaryDirectory() as keep, contextlib.redirect_stdout(io.StringIO()) as said:
            tables, done = judge.Tables(keep), 0
            for seed in range(1, 4):
                with tempfile.TemporaryDirectory() as folder:
                    case = judge.Case(folder, seed, ["crooked"], False)
                    raw = judge.correct(case, Stub(command, status), tables)
                    if raw is not None:
                        judge.damage(case, raw, Stub(command, status), tables)
                        done += 1
            good = judge.report(tables, done)
        kinds = sum(wanted in what for what in tables.kept)
        print(f"self-test: a check that answers {status} always: {kinds} kinds of failure '{wanted}'")
        if good or not kinds:
            bad.append(f"a check that answers {status} always is believed")
            print(said.getvalue())
    for text in bad:
        print(f"self-test: FAILED: {text}")
    print("self-test: " + ("FAILED" if bad else "holds"))
    return 1 if bad else 0
