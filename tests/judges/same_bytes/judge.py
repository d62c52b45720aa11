#!/usr/bin/python3
"""Judges whether two binaries of vpost do the same: bytes, messages, summaries, verdicts.

    /usr/bin/python3 tests/judges/same_bytes/judge.py --before old/vpost --after target/release/vpost --count 5000

Both get the same programs with the same options: those of the project (tables of dialects, corpus, samples, what fuzzing
found), LinuxCNC's own where its package is installed, large ones that are corrected in chunks, and `--count` random ones from
the generators of the judges `damage`, `frames` and `proofs` and from mutations of the corpus (programs.py). Compared are

  correct   exit status, standard output, standard error, `--summary`; by turns also with the program on standard input, with
            `-o`, `--strict`, and the output once more (refused) and with `--force`
  check     of input and output of --before: exit status, standard error, `--json`; by turns also in words, and of an
            output that was spoilt by chance. With --compare-check only the verdict (exit status) of it
  batch     one folder of each dialect: exit status and the outputs
  points    `predict`, `solve`; `profile show`, `profile check`, `grammar list`; `expand` where both have it

A refused random program loses the blamed line and is compared again, so that many end corrected. A difference is printed
with the command that shows it, and kept in a folder (`--keep`) with program, profile and both answers; then both
commands are asked again, and where one contradicts itself that is said. --leave-out takes away what is meant to
differ: `summary.deviation_after_um`, `check.findings`, `stderr`, `batch`.

Exit status: 0 no difference, 1 some, 2 usage.
"""

import argparse
import collections
import concurrent.futures
import glob
import json
import os
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders  # noqa: E402

import programs  # noqa: E402

TIMEOUT = 120
BLAMED = re.compile(rb"-->\s*[^\n]*?:(\d+):\d+")


class Command:
    """One of the two binaries."""

    def __init__(self, role, path):
        self.role, self.path = role, os.path.abspath(path)
        has = {name: self.run([], "help", name).status == 0 for name in ("correct", "expand")}
        self.correct, self.expands = ["correct"] if has["correct"] else [], has["expand"]

    def run(self, before, *arguments, stdin=b"", cwd=None):
        """The answer to a run; the name of the command is the same for both."""
        # `before` are the words of a command whose name only one of the two may have.
        line = ["vpost", *before, *map(str, arguments)]
        environment = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE")}
        try:
            done = subprocess.run(line, executable=self.path, input=stdin, capture_output=True, timeout=TIMEOUT, cwd=cwd, env=environment)
        except subprocess.TimeoutExpired:
            return Answer("no end", b"", b"", {})
        return Answer(done.returncode, done.stdout, done.stderr, {})


Answer = collections.namedtuple("Answer", "status stdout stderr more")


def flat(value, name=""):
    """A JSON value as its leaves with their names; elements of lists share theirs."""
    if isinstance(value, dict) and value:
        return {k: v for key, below in value.items() for k, v in flat(below, f"{name}.{key}" if name else key).items()}
    return {name: value}


def parsed(raw):
    try:
        return json.loads(raw)
    except ValueError:
        return {"not JSON": raw.decode("utf-8", "replace")}


def parts(kind, answer):
    """What is compared of an answer: names to values."""
    found = {"status": answer.status, "stderr": answer.stderr}
    if kind == "check --json":
        found.update({f"check.{k}": v for k, v in flat(parsed(answer.stdout)).items()} if answer.stdout else {})
    else:
        found["stdout"] = answer.stdout
    for name, raw in answer.more.items():
        if name == "summary":
            found.update({f"summary.{k}": v for k, v in flat(parsed(raw)).items()})
        else:
            found[name] = raw
    return found


def shown(value):
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) < 200 else text[:200] + "…"


def first_difference(a, b):
    """Two unlike values in words; of texts, their first unlike line."""
    if isinstance(a, bytes) and isinstance(b, bytes):
        before, after = a.split(b"\n"), b.split(b"\n")
        for number, (x, y) in enumerate(zip(before, after), 1):
            if x != y:
                return f"line {number}: {shown(x)} | {shown(y)}"
        return f"{len(before)} lines | {len(after)} lines"
    return f"{shown(a)} | {shown(b)}"


class Comparison:
    """Asks both, counts what was compared and holds the differences."""

    def __init__(self, before, after, keep, leave_out, verdicts_only):
        self.both, self.keep, self.leave_out, self.verdicts_only = (before, after), keep, set(leave_out), verdicts_only
        self.compared, self.different, self.outcomes = collections.Counter(), collections.Counter(), collections.Counter()
        self.lock = threading.Lock()

    def left_out(self, name):
        return any(name == word or name.startswith(word + ".") for word in self.leave_out)

    def unlike(self, kind, answers):
        """Names of what differs, with both values."""
        a, b = (parts(kind, answer) for answer in answers)
        if self.verdicts_only and kind.startswith("check"):
            a, b = ({"status": v["status"]} for v in (a, b))
        names = [k for k in {**a, **b} if not self.left_out(k)]
        return {k: (a.get(k), b.get(k)) for k in names if a.get(k) != b.get(k)}

    def ask(self, kind, case, asked, folder):
        """Compares the answers to one question; gives that of `before`. `asked` runs one of the two in a folder."""
        answers = [asked(command) for command in self.both]
        found = self.unlike(kind, answers)
        with self.lock:
            self.compared[case.family, kind] += 1
            if kind == "correct":
                self.outcomes["corrected" if answers[0].status == 0 else f"exit status {answers[0].status}"] += 1
        if found:
            again = [asked(command) for command in self.both]
            unsteady = [c.role for c, first, second in zip(self.both, answers, again) if self.unlike(kind, (first, second))]
            with self.lock:
                self.tell(kind, case, found, unsteady, answers, folder)
        return answers[0]

    def tell(self, kind, case, found, unsteady, answers, folder):
        for name in found:
            self.different[kind, name] += 1
        serial = sum(self.different.values())
        line = f"DIFFERS {kind}: {case.family}: {case.name}"
        print(line + (f"   ({' and '.join(unsteady)} contradicts itself when asked again)" if unsteady else ""))
        place = os.path.join(self.keep, f"{serial:05d}")
        for name, (a, b) in list(found.items())[:6]:
            print(f"    {name}: {first_difference(a, b)}")
        if serial > 2000:
            return
        shutil.copytree(folder, place, dirs_exist_ok=True)
        options = case.options
        profile = options[options.index("-m") + 1] if "-m" in options else None
        if profile and os.path.isfile(profile) and not profile.startswith(programs.ROOT):
            shutil.copytree(os.path.dirname(profile), os.path.join(place, "machine"), dirs_exist_ok=True)
            options = [os.path.join(place, "machine", os.path.basename(o)) if o == profile else o for o in options]
        for command, answer in zip(self.both, answers):
            for name, raw in {"stdout": answer.stdout, "stderr": answer.stderr, **answer.more}.items():
                with open(os.path.join(place, f"{command.role}.{name}"), "wb") as file:
                    file.write(raw)
        commands = "\n".join(self.line(kind, command, options) for command in self.both)
        with open(os.path.join(place, "found.txt"), "w", encoding="utf-8") as file:
            file.write(f"{line}\n{commands}\n" + "".join(f"{k}: {first_difference(*v)}\n" for k, v in found.items()))
        print(f"    cd {place} && {self.line(kind, self.both[1], options)}", flush=True)

    @staticmethod
    def line(kind, command, options):
        """What to type, in the folder that was kept."""
        words = {"check --json": ["check", "in.nc", "out.nc", "--json"], "check in words": ["check", "in.nc", "out.nc"],
                 "check of a spoilt output": ["check", "in.nc", "spoilt.nc"], "correct -o": command.correct + ["in.nc", "-o", "new.nc"],
                 "correct -": command.correct + ["-"], "correct --strict": command.correct + ["in.nc", "--strict"],
                 "correct again": command.correct + ["out.nc"], "correct --force": command.correct + ["out.nc", "--force"],
                 "correct": command.correct + ["in.nc", "--summary", "summary.json"], "batch": ["batch", "in", "-O", "out"]}.get(kind, kind.split())
        return shlex.join([command.path, *words, *options]) + (" < in.nc" if kind == "correct -" else "")


def write(folder, name, raw):
    with open(os.path.join(folder, name), "wb") as file:
        file.write(raw)


def compare_case(comparison, case, only):
    """All questions about one program."""
    with tempfile.TemporaryDirectory(prefix="same-bytes-") as folder:
        text, pick = case.text, random.Random(f"{case.family} {case.name}")
        for _ in range(case.mend + 1):
            write(folder, "in.nc", text)
            answer = compare_text(comparison, case, folder, only, pick)
            blamed = BLAMED.search(answer.stderr)
            if answer.status != 1 or not blamed:
                return
            lines = text.split(b"\n")
            at = int(blamed[1]) - 1
            text = b"\n".join(lines[:at] + lines[at + 1:])
            if not text.strip():
                return


def taken(command, folder, name, *arguments):
    """Runs the command in the folder and takes a file that it writes; the folder is as it was then."""
    answer = command.run(*arguments, cwd=folder)
    path = os.path.join(folder, name)
    if os.path.exists(path):
        with open(path, "rb") as file:
            answer.more[name.split(".")[0]] = file.read()
        os.remove(path)
    return answer


def compare_text(comparison, case, folder, only, pick):
    options, ask = case.options, lambda kind, asked: comparison.ask(kind, case, asked, folder)
    if only == "check":
        answer = comparison.both[0].run(comparison.both[0].correct, "in.nc", *options, cwd=folder)
    else:
        answer = ask("correct", lambda c: taken(c, folder, "summary.json", c.correct, "in.nc", "--summary", "summary.json", *options))
        if "stdin" in case.more:
            ask("correct -", lambda c: c.run(c.correct, "-", *options, stdin=case.text, cwd=folder))
        if "file" in case.more:
            ask("correct -o", lambda c: taken(c, folder, "new.nc", c.correct, "in.nc", "-o", "new.nc", *options))
        if "strict" in case.more:
            ask("correct --strict", lambda c: c.run(c.correct, "in.nc", "--strict", *options, cwd=folder))
    if answer.status != 0:
        return answer
    write(folder, "out.nc", answer.stdout)
    if only != "check" and "forced" in case.more:
        ask("correct again", lambda c: c.run(c.correct, "out.nc", *options, cwd=folder))
        ask("correct --force", lambda c: c.run(c.correct, "out.nc", "--force", *options, cwd=folder))
    if only != "correct":
        ask("check --json", lambda c: c.run([], "check", "in.nc", "out.nc", "--json", *options, cwd=folder))
        if "words" in case.more:
            ask("check in words", lambda c: c.run([], "check", "in.nc", "out.nc", *options, cwd=folder))
        if "spoilt" in case.more and len(answer.stdout) > 1:
            write(folder, "spoilt.nc", programs.spoilt(answer.stdout, pick))
            ask("check of a spoilt output", lambda c: c.run([], "check", "in.nc", "spoilt.nc", *options, cwd=folder))
    return answer


def compare_batches(comparison):
    """Folders of programs: outputs by their names."""
    for dialect in programs.DIALECTS:
        with tempfile.TemporaryDirectory(prefix="same-bytes-") as folder:
            count = 0
            for path in programs.below("grammars") + programs.below("tests/corpus"):
                if programs.dialect_of(path) == dialect:
                    target = os.path.join(folder, "in", os.path.basename(os.path.dirname(path)), os.path.basename(path))
                    os.makedirs(os.path.dirname(target), exist_ok=True)
                    shutil.copyfile(path, target)
                    count += 1

            def asked(command):
                answer = command.run([], "batch", "in", "-O", "out", "-q", *options, cwd=folder)
                for path, _, files in os.walk(os.path.join(folder, "out")):
                    for name in files:
                        if ".vpost" not in path.split(os.sep):
                            with open(os.path.join(path, name), "rb") as file:
                                answer.more[os.path.join(os.path.basename(path), name).replace("/", "-")] = file.read()
                shutil.rmtree(os.path.join(folder, "out"), ignore_errors=True)
                # Its messages hold the time it took.
                return answer._replace(stderr=b"")

            options = programs.job("tests/profiles/corpus.toml", dialect)
            if count and not comparison.left_out("batch"):
                comparison.ask("batch", programs.Case("folders", dialect, b"", options), asked, folder)


def compare_points(comparison):
    """Commands without a program."""
    points = sorted(glob.glob(os.path.join(programs.ROOT, "samples/points/*.csv")))
    questions = [["grammar", "list"]] + [["profile", what, os.path.join(programs.ROOT, p)] for p in programs.profiles() for what in ("show", "check")]
    for path in points:
        questions += [["predict", path, "-m", os.path.join(programs.ROOT, p)] for p in programs.profiles()]
        questions += [["solve", path, "-m", os.path.join(programs.ROOT, programs.TRACKED), "-e", e] for e in ("rigid-body", *programs.ENGINES)]
    with tempfile.TemporaryDirectory(prefix="same-bytes-") as folder:
        for words in questions:
            case = programs.Case("points and tables", shlex.join(words), b"", [])
            comparison.ask(shlex.join(words), case, lambda c, w=words: c.run([], *w, cwd=folder), folder)
        if all(c.expands for c in comparison.both):
            for case in programs.lying():
                write(folder, "in.nc", case.text)
                comparison.ask("expand", case, lambda c, o=case.options: c.run([], "expand", "in.nc", *o, cwd=folder), folder)


def report(comparison, seconds):
    """Prints what was compared and what differs; True where nothing does."""
    total = sum(comparison.compared.values())
    families = collections.Counter()
    for (family, _), n in comparison.compared.items():
        families[family.split(",")[0]] += n
    kinds = collections.Counter()
    for (family, kind), n in comparison.compared.items():
        kinds[kind if family not in ("points and tables",) else kind.split()[0]] += n
    print(f"\n{total} answers compared in {seconds:.0f} s")
    print("  from " + ", ".join(f"{name}: {n}" for name, n in families.most_common()))
    print("  to   " + ", ".join(f"{name}: {n}" for name, n in kinds.most_common()))
    print("  programs " + ", ".join(f"{name}: {n}" for name, n in comparison.outcomes.most_common()))
    for (kind, name), n in comparison.different.most_common():
        print(f"{n:6} differ in {name} of {kind}")
    if comparison.different:
        print(f"kept in {comparison.keep}")
    print("SAME" if not comparison.different else "DIFFERENT")
    return not comparison.different


def run(arguments):
    before, after = Command("before", arguments.before), Command("after", arguments.after)
    keep = folders.of_findings(arguments.keep, "same-bytes-kept-")
    comparison, begun = Comparison(before, after, keep, arguments.leave_out, arguments.compare_check), time.time()
    parent = tempfile.mkdtemp(prefix="same-bytes-machines-")
    try:
        made = programs.Random(arguments.seed, parent)

        def by_chance(number):
            case = made.case(number)
            if arguments.family in case.family:
                compare_case(comparison, case, arguments.only)
            shutil.rmtree(os.path.join(parent, str(number)), ignore_errors=True)

        fixed = [] if arguments.no_lying else [*programs.lying(), *programs.installed(), *programs.large(arguments.seed)]
        fixed = [c for c in fixed if arguments.family in c.family]
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            for _ in pool.map(lambda c: compare_case(comparison, c, arguments.only), fixed):
                pass
            for _ in pool.map(by_chance, range(arguments.count)):
                pass
        if not arguments.no_lying and not arguments.only and not arguments.family:
            compare_batches(comparison)
            compare_points(comparison)
    finally:
        shutil.rmtree(parent, ignore_errors=True)
    good = report(comparison, time.time() - begun)
    if good and not arguments.keep:
        os.rmdir(keep)
    return 0 if good else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", metavar="COMMAND")
    parser.add_argument("--after", metavar="COMMAND")
    parser.add_argument("--count", type=int, default=5000, help="random programs")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--jobs", type=int, default=1, help="programs at the same time")
    parser.add_argument("--compare-check", action="store_true", help="of `check`, compare the verdict alone, not its words and figures")
    parser.add_argument("--only", choices=("correct", "check"), help="leave out the other one, `batch` and the points")
    parser.add_argument("--family", default="", metavar="TEXT", help="only programs of families with this in their name: corpus, large, proofs …")
    parser.add_argument("--no-lying", action="store_true", help="random programs only")
    parser.add_argument("--leave-out", action="append", default=[], metavar="NAME", help="what is meant to differ (repeatable)")
    parser.add_argument("--keep", metavar="DIR", help="folder of the differences")
    parser.add_argument("--self-test", action="store_true", help="shows that differences are found")
    arguments = parser.parse_args()
    if arguments.self_test:
        import self_test

        return self_test.run()
    for path in (arguments.before, arguments.after):
        if not path or not os.access(path, os.X_OK):
            parser.error(f"--before and --after name two commands; found {path or 'nothing'}")
    return run(arguments)


if __name__ == "__main__":
    sys.exit(main())
