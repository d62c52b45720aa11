"""Two readers of one program: does what vpost writes mean what the program meant?

    python3 judge.py --vpost target/release/vpost --count 300 --seed 1 [--dialect fanuc] [--keep DIR]
"""

import collections
import os
import random
import re
import shutil
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

from common import command, folders, options  # noqa: E402
from common.profile import Profile, column  # noqa: E402

import compare  # noqa: E402
import readers  # noqa: E402
import rs274  # noqa: E402
from core import Invalid  # noqa: E402

MILL_LENGTHS = {"H1": 120.0, "H2": 80.5, "H7": 95.25}
LATHE_LENGTHS = {"H1": [0, 0, 0], "H2": [5, 0, -7], "H3": [12.5, 0, 41.25]}
LATHE_OFFSETS = {"G54": [100, 0, 40], "G55": [110, 0, 41], "G56": [-60, 0, -12]}
FANUC_LATHE = {
    "thread_chamfer_leads": 0, "drill_pecks": "full", "drill_return_mm": 1.0, "drill_r": "way", "bore_return_percent": 200,
}
OFFSETS = {"G54": (100, 80, 40), "G55": (110, 75, 41), "G56": (-60, 33, -12), "G57": (15, -140, 22), "G58": (7, 9, 3),
           "G59": (-200, 50, 70)}
NUMBERED = {"G54.1P1": (21, 31, -9), "G54.1P2": (-44, 12, 5), "G54.1P7": (3, -73, 18)}


def profile(folder, dialect, machine):
    """The profile of one of the two machines."""
    turning, system = dialect in readers.LATHES, readers.SYSTEMS.get(dialect)
    axes, chain = ("XZ", "[w S b Z X t]") if turning else ("XYZ", "[w X Y b Z t]")
    p = Profile("Judge's lathe (invented)" if turning else "Judge's mill (invented)", "fanuc-lathe" if system else dialect, chain)
    for axis in axes:
        p.axis(axis).update(travel_mm=[-20000, 20000], resolution_mm=0.0001)
        places, rows = machine.table(axis)
        seen = [[row["XYZ".index(k)] for k in axes] for row in rows]
        p.errors(axis, places, seen, digits=".6f", columns=[column(f"E{k}{axis}") for k in axes])
    p["tool"]["lengths_mm"] = LATHE_LENGTHS if turning else MILL_LENGTHS
    p["work_offsets_mm"].update(LATHE_OFFSETS if turning else readers.profile_offsets(dialect, OFFSETS, NUMBERED))
    p["program"].update(zero="true", x="diameter" if turning else None, g_code_system=system, **(FANUC_LATHE if system else {}))
    return str(p.write(folder, f"{dialect}_{machine.name}.toml"))


class Judge:
    def __init__(self, options):
        self.o = options
        self.room = tempfile.TemporaryDirectory(prefix="reader-")
        self.folder = self.room.name
        self.count = collections.defaultdict(collections.Counter)

    def fresh(self):
        """An empty folder for the files that a program calls."""
        self.include = os.path.join(self.folder, "include")
        shutil.rmtree(self.include, ignore_errors=True)
        os.mkdir(self.include)
        return self.include

    def correct(self, dialect, text, machine):
        """What vpost writes, and its error code."""
        source = folders.put(self.folder, "in.nc", text)
        flags = ["-m", machine, "-q", "--include", self.include, *readers.FLAGS.get(dialect, [])]
        status, output, errors = command.run(self.o.vpost, source, *flags, seconds=60)
        if status == 0:
            return output, None
        if status not in (1, 2):
            return None, f"exit {status}"
        return None, command.code(errors, f"exit {status}: {errors[:200]}"), errors

    def one(self, dialect, seed, machines):
        rng = random.Random(f"{dialect} {seed}")
        counts = self.count[dialect]
        for _ in range(400):
            text = readers.generate(dialect, rng, self.fresh())
            try:
                motions = readers.read(dialect, text, self.include)
            except Invalid as why:
                counts[f"invalid: {re.sub('[0-9.-]+', '#', str(why))[:60]}"] += 1
                continue
            except (KeyError, ValueError, IndexError, TypeError) as why:
                print(f"{dialect} {seed}: the judge's reader stumbled: {why!r}")
                self.keep(f"{dialect}-{seed}-stumble", text, "")
                continue
            break
        else:
            counts["never valid"] += 1
            return
        if dialect == "linuxcnc" and not self.like_rs274(seed, text, motions):
            return
        counts["programs"] += 1
        counts["motions"] += sum(not isinstance(m, tuple) for m in motions)
        for machine, path in machines:
            answer = self.correct(dialect, text, path)
            if answer[1]:
                counts[f"refused {answer[1]}"] += 1
                if self.o.keep_refused:
                    self.keep(f"{dialect}-{seed}-{answer[1]}", text, answer[2] if len(answer) > 2 else "")
                return
            counts["read"] += 1
            try:
                output = readers.read(dialect, answer[0])
            except Invalid as why:
                self.wrong(dialect, seed, text, answer[0], f"the output is no program: {why}")
                return
            inch = re.search(r"G70|G20|G700", text) is not None
            why, rises = compare.compare(machine, motions, output, inch)
            counts["rises to R first"] += rises
            if why:
                self.wrong(dialect, seed, text, answer[0], f"({machine.name}) {why}")
                return

    def given(self, dialect, path, machines):
        """One program that somebody wrote."""
        with open(path) as f:
            text = f.read()
        self.include = os.path.dirname(os.path.abspath(path))
        try:
            motions = readers.read(dialect, text, self.include)
        except Invalid as why:
            print(f"{path}: not read: {why}")
            return
        if dialect == "linuxcnc":
            self.like_rs274(path, text, motions)
        for machine, profile_path in machines:
            answer = self.correct(dialect, text, profile_path)
            if answer[1]:
                print(f"{path}: refused {answer[1]}\n{answer[2]}")
                return
            try:
                why, rises = compare.compare(machine, motions, readers.read(dialect, answer[0], self.include), True)
            except Invalid as invalid:
                why, rises = f"the output is no program: {invalid}", 0
            print(f"{path}: {machine.name}: {why or 'the same'}" + (f", rises {rises}" if rises else ""))
            self.count[dialect]["different"] += why is not None

    def like_rs274(self, seed, text, motions):
        """Whether LinuxCNC's own interpreter reads the program as this one does."""
        counts = self.count["linuxcnc"]
        theirs, said = rs274.read(text)
        if theirs is None:
            counts["not taken by rs274"] += 1
            if self.o.invalid:
                print(f"linuxcnc {seed}: rs274 says {said}")
                self.keep(f"linuxcnc-{seed}-rs274", text, said)
            return False
        # places of G28 stand in its variable file; its printer takes a length in mm for one in inches beside G53
        if "G28" in text or "G30" in text or ("G53" in text and "G20" in text and "G43" in text):
            return True
        near = 0.004 if "G20" in text else 0.00025
        why = rs274.differ(motions, theirs, near)
        if why:
            counts["read otherwise by rs274"] += 1
            print(f"linuxcnc {seed}: rs274 reads otherwise: {why}")
            self.keep(f"linuxcnc-{seed}-otherwise", text, why)
            return False
        counts["read the same by rs274"] += 1
        return True

    def wrong(self, dialect, seed, text, output, why):
        self.count[dialect]["different"] += 1
        print(f"{dialect} {seed}: {why}")
        self.keep(f"{dialect}-{seed}", text, output)

    def keep(self, name, text, output):
        if self.o.keep:
            os.makedirs(self.o.keep, exist_ok=True)
            for end, what in ((".in.nc", text), (".out.nc", output)):
                folders.put(self.o.keep, name + end, what)
            for called in os.listdir(self.include):
                shutil.copy(os.path.join(self.include, called), os.path.join(self.o.keep, f"{name}.{called}"))


def main():
    parser = options.parser(__doc__, 100)
    parser.add_argument("--keep-refused", action="store_true")
    parser.add_argument("--dialect", action="append")
    parser.add_argument("--invalid", action="store_true", help="show why the generator's programs were thrown away")
    parser.add_argument("--program", action="append", help="compare this program of one --dialect instead")
    given = parser.parse_args()
    if given.self_test:
        import self_test

        return self_test.run(given)
    judge = Judge(given)
    for dialect in given.dialect or readers.DIALECTS:
        machines = [(m, profile(judge.folder, dialect, m)) for m in compare.machines(dialect in readers.LATHES)]
        for path in given.program or ():
            judge.given(dialect, path, machines)
        if given.program:
            continue
        for seed in range(given.seed, given.seed + given.count):
            judge.one(dialect, seed, machines)
        counts = judge.count[dialect]
        shown = {k: v for k, v in sorted(counts.items(), key=lambda e: (-e[1], e[0]))
                 if given.invalid or not k.startswith("invalid")}
        print(dialect, shown)
    return 1 if any(c["different"] for c in judge.count.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
