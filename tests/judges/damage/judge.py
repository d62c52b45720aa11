#!/usr/bin/python3
"""Judges `vpost` and `vpost check` on random programs and on damaged outputs, as a black box.

    /usr/bin/python3 tests/judges/damage/judge.py --vpost target/release/vpost --count 500 --damage 60

Each program (generator.py) is corrected for a random machine: straight, crooked, with backlash, with tables for each
direction; linear and cubic. The output is read by reader.py, led through machine.py with play as a hysteresis operator
along the commands, and judged by referee.py: the tool path within tolerance plus half an output step, the process
(feed, spindle, coolant, tool, compensation, cycles, dwells) motion by motion. `vpost check` judges the same; where the two
disagree is a finding, whichever is right. Outputs that both take are damaged in some seventy ways (damages.py); a damage that
changes what is read (`trace`) and that the referee sees must be found by `vpost check`, edits without effect must pass.
named.py holds single cases of known faults. On machines of the class `straight` the program itself must pass its own check.

Exit status: 0 nothing wrong, 1 something, 2 usage. --keep DIR gets a folder for each failure.
"""

import collections
import json
import os
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import folders, options  # noqa: E402
from common.command import ask  # noqa: E402

import damages  # noqa: E402
import generator  # noqa: E402
import named  # noqa: E402
import referee  # noqa: E402
from machine import Machine  # noqa: E402
from reader import Reader, Unreadable, trace  # noqa: E402

TIMEOUT = 60


class Command:
    """The command under judgement."""

    def __init__(self, path):
        self.path = os.path.abspath(path)

    def run(self, *arguments):
        """(exit status, standard output, standard error)."""
        return ask(self.path, *arguments, seconds=TIMEOUT)


class Case:
    """One program on one machine."""

    def __init__(self, folder, seed, kinds, rotated):
        self.folder, self.seed = folder, seed
        os.makedirs(folder, exist_ok=True)
        self.kind, self.dialect = kinds[seed % len(kinds)], generator.DIALECTS[(seed // len(kinds)) % 3]
        self.profile = generator.write_machine(folder, self.kind, self.dialect, seed)
        self.machine = Machine(self.profile)
        self.text = generator.Program(self.dialect, seed, rotated).text
        self.start = generator.START if seed % 4 else None
        self.options = ["-m", self.profile, "--zero", "true"] + ([f"--start-at={','.join(map(str, self.start))}"] if self.start else [])
        self.declared = 0.0
        self.write("in.nc", self.text)

    def write(self, name, raw):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(raw)
        return path

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, raw):
        machine = self.machine
        return Reader(machine.dialect, machine.offsets, machine.lengths, machine.default_tool, self.start).read(raw)

    def judge(self, raw):
        """Failures of an output, in words."""
        try:
            return referee.judge(self.read(self.text), self.read(raw), self.machine, self.start, self.declared).failures
        except Unreadable as error:
            return [f"unreadable: {error}"]


class Tables:
    """What is counted, and where failures are kept."""

    def __init__(self, keep):
        self.keep, self.programs, self.refusals = keep, collections.Counter(), collections.Counter()
        self.damages, self.kept, self.sorts = {}, collections.Counter(), collections.Counter()

    def fail(self, case, what, details, files=()):
        """Prints a failure and keeps the first few of each sort."""
        self.kept[what] += 1
        if self.kept[what] > 12:
            return
        name = re.sub(r"[^A-Za-z0-9]+", "-", what)
        folder = os.path.join(self.keep, f"{name}-{case.seed}")
        command = " ".join(o if not o.startswith(case.folder) else "machine.toml" for o in case.options)
        folders.keep(case.folder, folder, "\n".join([what, f"vpost in.nc {command} -o out.nc", f"vpost check in.nc out.nc {command}", *map(str, details)]))
        for file, raw in files:
            with open(os.path.join(folder, file), "wb") as out:
                out.write(raw)
        print(f"{what}: seed {case.seed} ({case.kind}, {case.dialect}): {'; '.join(map(str, details))[:300]}", flush=True)


def correct(case, command, tables):
    """Corrects, judges and checks one program; the output if it is right and passes."""
    status, _, messages = command.run(case.path("in.nc"), *case.options, "-o", case.path("out.nc"), "--summary", case.path("summary.json"))
    if case.kind == "straight":
        own, out, _ = command.run("check", case.path("in.nc"), case.path("in.nc"), *case.options)
        tables.programs[case.kind, "program against itself", "passes" if own == 0 else "FAILS"] += 1
        if own != 0:
            tables.fail(case, "a program fails its own check", out.splitlines()[:4])
    if status == 1:
        first = messages.split("\n")[0]
        tables.refusals[case.kind, re.sub(r"[\d.]+ um", "… um", first)[:90]] += 1
        tables.programs[case.kind, "refused", ""] += 1
        if "inf um" in first:
            tables.fail(case, "refused by inf um", [first])
        return None
    if status != 0:
        tables.fail(case, "vpost breaks", [f"exit status {status}", messages[:200]])
        return None
    match = re.search(r"VP0506.*by up to ([\d.]+)", messages)
    # What VP0506 says too small is counted where the summary is compared with check.
    case.declared = (float(match[1]) + 0.5) * 1e-3 if match else 0.0
    with open(case.path("out.nc"), "rb") as file:
        raw = file.read()
    found = case.judge(raw)
    status, out, errors = command.run("check", case.path("in.nc"), case.path("out.nc"), *case.options, "--json")
    if status not in (0, 1):
        tables.fail(case, "check breaks", [f"exit status {status}", errors[:200]])
        return None
    report = json.loads(out) if out.strip().startswith("{") else {"findings": [errors[:200]]}
    bounds(case, report, tables)
    says = [str(f) for f in report.get("findings", [])]
    for sort in {text.split(":")[0] for text in found}:
        tables.sorts[sort, "check passes" if status == 0 else "check fails", case.kind] += 1
    sort = found[0].split(":")[0] if found else ""
    if found and status == 0:
        tables.programs[case.kind, "WRONG, and check passes", ""] += 1
        tables.fail(case, f"wrong {sort}, check passes", found[:3])
    elif found:
        tables.programs[case.kind, "WRONG, check finds it", ""] += 1
        tables.fail(case, f"wrong {sort}, check fails", found[:3] + says[:2])
    elif status == 1:
        what = "false alarm" if not match else "check fails, VP0506 declared"
        tables.programs[case.kind, what, ""] += 1
        if not match:
            tables.fail(case, what, says[:3])
    else:
        tables.programs[case.kind, "right, check passes", ""] += 1
        return raw
    return None


def bounds(case, report, tables):
    """The summary's bound is never below what check finds on the same output."""
    try:
        with open(case.path("summary.json"), encoding="utf-8") as file:
            promised = json.load(file)["deviation_after_um"]
        if report["deviation_after_um"] > promised + 0.0006:
            tables.programs[case.kind, "SUMMARY below check", ""] += 1
            tables.fail(case, "the summary's bound is below what check finds", [f"{promised} um promised, {report['deviation_after_um']} found"])
    except (KeyError, TypeError, OSError):
        pass


def damage(case, raw, command, tables):
    """Every damage once on one correct output."""
    end = "\r\n" if b"\r\n" in raw else "\n"
    lines = raw.decode("latin-1").split(end)
    items = case.read(raw)
    right = trace(items)
    inch, now = [], False
    for line in lines:
        codes = re.findall(r"[Gg]0*(20|21)(?![\d.])", re.sub(r"\([^)]*\)", "", line))
        now = codes[-1] == "20" if codes else now
        inch.append(now)
    for kind, edit in list(damages.KINDS.items()) + list(damages.HARMLESS.items()):
        counts = tables.damages.setdefault(kind, collections.Counter())
        text = damages.Text(lines, items, case.dialect, f"{kind} {case.seed}", inch)
        new = edit(text)
        if new is None or new == lines:
            counts["none to do"] += 1
            continue
        spoilt = end.join(new).encode("latin-1")
        try:
            same = trace(case.read(spoilt)) == right
        except Unreadable:
            same = False
        path = case.write("damaged.nc", spoilt)
        status, out, errors = command.run("check", case.path("in.nc"), path, *case.options)
        if status not in (0, 1):
            tables.fail(case, f"check breaks on: {kind}", [f"exit status {status}", errors[:200]], [("damaged.nc", spoilt)])
            counts["broken"] += 1
        elif kind in damages.HARMLESS:
            counts["passed" if status == 0 else "REFUSED"] += 1
            if status:
                tables.fail(case, f"harmless edit fails: {kind}", (out + errors).splitlines()[-6:], [("damaged.nc", spoilt)])
        elif same:
            # A word that is overwritten before anything moves; check may find it all the same.
            counts["without effect"] += 1
        elif status == 1:
            counts["found"] += 1
        else:
            seen = [text for text in case.judge(spoilt) if not text.startswith("peck")]
            if kind not in damages.GEOMETRIC:
                seen = seen or ["the programs differ as they are read"]
            counts["MISSED" if seen else "doubtful"] += 1
            if seen:
                tables.fail(case, f"damage passes: {kind}", seen[:2], [("damaged.nc", spoilt)])
        os.remove(path)


def report(tables, damaged):
    """Prints the tables; True where nothing is wrong."""
    print("\nPrograms")
    sorts = sorted({k[1:] for k in tables.programs})
    for sort in sorts:
        row = [f"{kind} {tables.programs[kind, *sort]}" for kind in generator.MACHINES if tables.programs[kind, *sort]]
        print(f"{sum(n for k, n in tables.programs.items() if k[1:] == sort):6} {' '.join(sort).strip():34} {', '.join(row)}")
    print("\nWhat was wrong (programs)")
    for (sort, says), n in collections.Counter(key[:2] for key in tables.sorts.elements()).most_common():
        row = [f"{kind} {tables.sorts[sort, says, kind]}" for kind in generator.MACHINES if tables.sorts[sort, says, kind]]
        print(f"{n:6} {sort + ', ' + says:34} {', '.join(row)}")
    print("\nRefusals")
    for (kind, text), n in tables.refusals.most_common(25):
        print(f"{n:6} {kind:11} {text}")
    print(f"\nDamages, on {damaged} outputs: must be found, found, missed, of no effect, doubtful (the referee takes them too)")
    bad = False
    for kind, c in tables.damages.items():
        if kind in damages.HARMLESS:
            print(f"  {kind:32} passed {c['passed']:4}  refused {c['REFUSED']:4}")
            bad |= bool(c["REFUSED"])
            continue
        must = c["found"] + c["MISSED"]
        share = f"{100 * c['found'] / must:5.1f} %" if must else "   -   "
        print(f"  {kind:32} {must:4} {c['found']:4} {c['MISSED']:4}  {share}  no effect {c['without effect']:3}, doubtful {c['doubtful']:3}")
        bad |= bool(c["MISSED"] or c["broken"])
    wrong = sum(n for k, n in tables.programs.items() if "WRONG" in k[1] or k[1] in ("false alarm", "SUMMARY below check") or k[2] == "FAILS")
    print("\nFailures")
    for what, n in tables.kept.most_common():
        print(f"{n:6} {what}")
    return not (bad or wrong or tables.kept)


def main():
    parser = options.parser(__doc__, 500, "jobs")
    parser.add_argument("--damage", type=int, default=40, metavar="N", help="outputs to damage in every way")
    parser.add_argument("--machines", default=",".join(generator.MACHINES), help="classes of machines, of " + ", ".join(generator.MACHINES))
    parser.add_argument("--no-named", action="store_true", help="leave out the named cases")
    arguments = parser.parse_args()
    command = Command(arguments.vpost)
    if arguments.self_test:
        import self_test

        return self_test.run(command)
    keep = folders.of_findings(arguments.keep, "judge-damage-")
    tables, kinds, done = Tables(keep), arguments.machines.split(","), 0
    named_bad = [] if arguments.no_named else named.run(command, keep)

    def one(seed):
        nonlocal done
        with tempfile.TemporaryDirectory() as folder:
            case = Case(folder, seed, kinds, seed % 5 == 0)
            raw = correct(case, command, tables)
            if raw is not None and done < arguments.damage:
                done += 1
                damage(case, raw, command, tables)

    seeds = range(arguments.seed, arguments.seed + arguments.count)
    if arguments.jobs > 1:
        with ThreadPoolExecutor(arguments.jobs) as pool:
            list(pool.map(one, seeds))
    else:
        for seed in seeds:
            one(seed)
    good = report(tables, done)
    for name, text in named_bad:
        print(f"named case: {name}: {text}")
    print(f"\nkept in {keep}\n{'HOLDS' if good and not named_bad else 'FAILED'}")
    return 0 if good and not named_bad else 1


if __name__ == "__main__":
    sys.exit(main())
