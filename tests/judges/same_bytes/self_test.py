"""Shows that the judge of bytes can fail: small commands that differ from each other in one thing each."""

import contextlib
import io
import os
import re
import stat
import sys
import tempfile

import judge
import programs

# A command that behaves as vpost does in what the judge asks for, and in one point otherwise.
STUB = '''#!{python}
import hashlib, json, os, sys, time
FAULT = {fault!r}
words = sys.argv[1:]
def leave(status, out=b"", messages=""):
    sys.stdout.buffer.write(out)
    sys.stderr.write(messages)
    sys.exit(status)
if words[0] == "help":
    leave(2)
if words[0] == "check":
    text = open(words[2], "rb").read()
    bad = b"BAD" in text and FAULT != "blind check"
    answer = dict(passed=not bad, deviation_after_um=2.5 if FAULT == "figure of check" else 1.5)
    leave(int(bad), json.dumps(answer).encode() if "--json" in words else b"passes" + b"!" * (FAULT == "words of check"))
stdin = words[0] == "-"
text = sys.stdin.buffer.read() if stdin else open(words[0], "rb").read()
if b"REFUSE" in text:
    line = text.split(b"REFUSE")[0].count(b"\\n") + 1
    if FAULT == "accepts":
        leave(0, text)
    leave(1, b"", "error[VP0201]: refused\\n --> " + words[0] + ":%d:1\\n" % line + "help: no" * (FAULT == "help"))
out = text.replace(b"X1", b"X1.001")
if FAULT == "last digit" and b"X77" in text:
    out = out.replace(b"X77", b"X77.001")
if FAULT == "standard input" and stdin or FAULT == "line end" and b"\\r\\n" in text:
    out += b"\\n"
if FAULT == "behind a refused line" and b"X88" in text:
    out += b"M0\\n"
if FAULT == "chance":
    out += os.urandom(8)
if FAULT == "warning":
    sys.stderr.write("warning[VP0509]: doubtful\\n")
if FAULT == "hangs" and b"X77" in text:
    time.sleep(60)
if "--summary" in words:
    figures = dict(input=dict(bytes=len(text)), deviation_after_um=2.0 if FAULT == "figure of the summary" else 1.0)
    open(words[words.index("--summary") + 1], "w").write(json.dumps(figures))
if "-o" in words:
    open(words[words.index("-o") + 1], "wb").write(out + b" " * (FAULT == "file"))
    out = b""
leave(0, out)
'''

CASES = [
    programs.Case("self-test", "plain", b"G1 X1 Y2\nG1 X77\n", ["-m", "machine.toml"], ("stdin", "file", "words")),
    programs.Case("self-test", "spoilt", b"G1 X1\nBAD\nG1 X12\n", ["-m", "machine.toml"], ("spoilt", "words")),
    programs.Case("self-test", "refused", b"G1 X1\nREFUSE\nG1 X88\n", ["-m", "machine.toml"], mend=1),
    programs.Case("self-test", "line ends", b"G1 X1\r\nG1 X2\r\n", ["-m", "machine.toml"]),
]

# Fault, what must be said to differ, and whether it still must with --compare-check.
FAULTS = [
    ("last digit", "stdout of correct", True),
    ("line end", "stdout of correct", True),
    ("standard input", "stdout of correct -", True),
    ("file", "new of correct -o", True),
    ("accepts", "status of correct", True),
    ("help", "stderr of correct", True),
    ("warning", "stderr of correct", True),
    ("behind a refused line", "stdout of correct", True),
    ("figure of the summary", "summary.deviation_after_um of correct", True),
    ("figure of check", "check.deviation_after_um of check --json", False),
    ("words of check", "stdout of check in words", False),
    ("blind check", "status of check --json", True),
    ("hangs", "status of correct", True),
]


def stub(folder, fault):
    path = os.path.join(folder, re.sub(r"\W", "-", fault) or "same")
    with open(path, "w", encoding="ascii") as file:
        file.write(STUB.format(python=sys.executable, fault=fault))
    os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    return path


def compared(folder, before, after, verdicts_only=False, leave_out=()):
    """What the judge prints on two commands, and whether it takes them for the same."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        both = judge.Command("before", before), judge.Command("after", after)
        comparison = judge.Comparison(*both, os.path.join(folder, "kept"), leave_out, verdicts_only)
        for case in CASES:
            judge.compare_case(comparison, case, None)
        good = judge.report(comparison, 0)
    return good, said.getvalue()


def generators():
    """Problems of the random programs: the same from the same seed, others from another, every family there."""
    with tempfile.TemporaryDirectory() as folder:
        one, again, other = (programs.Random(seed, folder) for seed in ("1", "1", "2"))
        texts = [one.case(k).text for k in range(40)]
        if texts != [again.case(k).text for k in range(40)]:
            return "the same seed gives other programs"
        if sum(a == b for a, b in zip(texts, (other.case(k).text for k in range(40)))) > 8:
            return "another seed gives the same programs"
        if len(set(texts)) < 36:
            return "programs repeat"
    lying = list(programs.lying())
    if len(lying) < 1500 or {programs.dialect_of(os.path.join(programs.ROOT, c.name)) for c in lying} < set(programs.DIALECTS):
        return f"only {len(lying)} programs of the project"
    return None


def run():
    """Exit status: 0 when every fault was found and the same command was found the same."""
    wrong = 0

    def result(name, good, said=""):
        nonlocal wrong
        wrong += not good
        print(f"{'ok   ' if good else 'WRONG'} {name}" + ("" if good else f"\n{said}"))

    judge.TIMEOUT = 4
    with tempfile.TemporaryDirectory() as folder:
        same, twin = stub(folder, ""), stub(folder, "none")
        good, said = compared(folder, same, twin)
        result("the same in two files", good, said)
        for fault, expected, with_verdicts in FAULTS:
            for verdicts_only in (False, True):
                good, said = compared(folder, same, stub(folder, fault), verdicts_only)
                found = not good and f"differ in {expected}\n" in said
                must = with_verdicts or not verdicts_only
                name = fault + (", verdicts of check alone" if verdicts_only else "") + ("" if must else ": passes")
                result(name, found if must else good, said)
        good, said = compared(folder, same, stub(folder, "figure of the summary"), leave_out=["summary.deviation_after_um"])
        result("a figure that is left out", good, said)
        good, said = compared(folder, same, stub(folder, "chance"))
        result("a command that contradicts itself is named", "(after contradicts itself" in said, said)
        kept = [f for _, _, files in os.walk(os.path.join(folder, "kept")) for f in files]
        result("reproducers are kept", {"in.nc", "found.txt", "before.stdout", "after.stdout"} <= set(kept), str(sorted(set(kept))))
    problem = generators()
    result("random programs", problem is None, problem)
    print(f"self-test: {wrong} wrong")
    return 1 if wrong else 0
