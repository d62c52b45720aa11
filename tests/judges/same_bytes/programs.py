"""The programs of the comparison: those that lie in the project, those of LinuxCNC, and random ones from a seed.

A `Case` is a program (bytes), the options that both commands get, and files that belong to it. Nothing here judges.
"""

import dataclasses
import glob
import hashlib
import importlib
import os
import random
import re
import sys

JUDGES = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
ROOT = os.path.dirname(os.path.dirname(JUDGES))
DIALECTS = ("fanuc", "linuxcnc", "perspektiva", "sinumerik", "balt-system", "centroid")
ENDINGS = (".nc", ".ngc", ".mpf", ".spf", ".txt")
# The engines of the users' publication want traverses of a laser tracker, which this one profile has.
TRACKED, ENGINES = "machine-profiles/stan_s500.toml", ("tracker", "tangential-static", "tangential-interval", "tangential-quasi-differential", "kmtpp")
# The first byte of a program that fuzzing found chooses its dialect; a capital, the other machine.
LETTERS = dict(zip("flpsbc", DIALECTS))
FEED = b"G21 G90 G17 G94\nG54\nG43 H1\nT1 M6\nS3000 M3\nG0 X10 Y10 Z30\nG1 Z15 F600\n"


@dataclasses.dataclass
class Case:
    """One program with the options of one job."""

    family: str
    name: str
    text: bytes
    options: list
    # What is tried besides correction and check: "stdin", "file", "strict", "words", "spoilt", "forced".
    more: tuple = ()
    # Lines that are refused are taken out, one after the other, so many times.
    mend: int = 0


def load(judge, *names):
    """Modules of another judge, whose names other judges use too."""
    folder = os.path.join(JUDGES, judge)
    hidden = {k: sys.modules.pop(k) for k in list(sys.modules) if os.path.exists(os.path.join(folder, k + ".py"))}
    sys.path.insert(0, folder)
    try:
        found = [importlib.import_module(name) for name in names]
    finally:
        sys.path.remove(folder)
        for k in list(sys.modules):
            if os.path.dirname(getattr(sys.modules[k], "__file__", None) or "") == folder:
                del sys.modules[k]
        sys.modules.update(hidden)
    return found


def below(folder):
    """Programs in a folder of the project and below it, in order."""
    found = []
    for path, folders, files in os.walk(os.path.join(ROOT, folder)):
        folders.sort()
        found += [os.path.join(path, f) for f in sorted(files) if f.lower().endswith(ENDINGS)]
    return found


def dialect_of(path):
    """The dialect that a path names in a folder or in the file's name; None where it names none."""
    parts = re.split(r"[/_.]", os.path.relpath(path, ROOT))
    return next((d for d in DIALECTS if d in parts), None)


def profiles():
    """Shipped machines and those of the tests, the most crooked first."""
    found = [p for folder in ("tests/profiles", "machine-profiles", "samples/profiles") for p in sorted(glob.glob(os.path.join(ROOT, folder, "*.toml")))]
    found.sort(key=lambda p: os.path.basename(p) != "corpus.toml")
    return [os.path.relpath(p, ROOT) for p in found]


def job(profile, dialect, *more):
    return ["-m", os.path.join(ROOT, profile), "-d", dialect, *more]


def chosen(name, of):
    """One of several by the name, the same every time."""
    return of[int.from_bytes(hashlib.blake2b(name.encode(), digest_size=4).digest(), "big") % len(of)]


EXTRAS = (("stdin",), ("file",), ("strict",), ("words",), ("spoilt",), ("forced",), (), ())


def lying():
    """The project's own programs, each for the machine of the corpus and for another one or another engine."""
    machines = profiles()
    others = [(p, "rigid-body") for p in machines[1:]] + [(TRACKED, e) for e in ENGINES]
    offsets = ["--work-offset", "G54=100,80,40", "--work-offset", "G55=110,75,41"]
    for path in below("grammars") + below("tests/corpus") + below("samples"):
        dialect, name = dialect_of(path), os.path.relpath(path, ROOT)
        if dialect is None:
            continue
        with open(path, "rb") as file:
            text = file.read()
        beside = ["--include", os.path.dirname(path)]
        yield Case("corpus", name, text, job(machines[0], dialect, *beside), chosen(name, EXTRAS))
        profile, engine = chosen(name + " other", others)
        tool = ["--start-at=300,200,250", "--tool", "H1=50", *beside]
        yield Case("corpus, other machines", name, text, job(profile, dialect, "-e", engine, *tool), chosen(name + " more", EXTRAS))
    for path in below("tests/fuzz/found"):
        with open(path, "rb") as file:
            text = file.read()
        dialect, name = LETTERS.get(chr(text[0]).lower(), DIALECTS[text[0] % 6]), os.path.relpath(path, ROOT)
        for profile in (machines[0], "machine-profiles/generic_vmc.toml"):
            yield Case("found by fuzzing", name, text[1:], job(profile, dialect, "--tolerance", "4", "--start-at=100,80,40", *offsets), chosen(name + profile, EXTRAS))


def installed():
    """LinuxCNC's own programs, where its package is installed."""
    seen = set()
    for path in sorted(glob.glob("/usr/share/linuxcnc/**/*.ngc", recursive=True) + glob.glob("/usr/share/doc/linuxcnc*/**/*.ngc", recursive=True)):
        with open(path, "rb") as file:
            text = file.read()
        if text not in seen:
            seen.add(text)
            options = job("tests/profiles/linuxcnc_samples.toml", "linuxcnc", "--include", os.path.dirname(path))
            yield Case("LinuxCNC's own", os.path.basename(path), text, options, ("file",), mend=3)


def large(seed):
    """Programs above the size from which the command works in chunks on several threads (4 MiB)."""
    for number, style in enumerate(("plain", "comments", "increments", "numbered", "arcs", "one axis")):
        pick = random.Random(f"{seed} large {style}")
        lines, x, y, z = [], 10000, 10000, 15000
        for k in range(230_000 if style != "numbered" else 190_000):
            to = [min(max(v + pick.randrange(-400, 401), 5000), 110000) for v in (x, y)] + [min(max(z + pick.randrange(-20, 21), 5000), 40000)]
            step = [(b - a) / 1000 for a, b in zip((x, y, z), to)]
            if style == "increments":
                lines.append(f"X{step[0]:.3f} Y{step[1]:.3f} Z{step[2]:.3f}")
            elif style == "one axis":
                axis = pick.randrange(3)
                to = [b if i == axis else a for i, (a, b) in enumerate(zip((x, y, z), to))]
                lines.append(f"G1 {'XYZ'[axis]}{to[axis] / 1000:.3f} F{pick.choice([300, 600])}")
            elif style == "arcs" and k % 50 == 0:
                lines.append(f"G3 X{x / 1000:.3f} Y{y / 1000:.3f} I1.5 J0.")
                lines.append("G1")
                to = [x, y, z]
            else:
                head = f"N{k} " if style == "numbered" else ""
                tail = " (c)" if style == "comments" else ""
                lines.append(f"{head}X{to[0] / 1000:.3f} Y{to[1] / 1000:.3f} Z{to[2] / 1000:.3f}{tail}")
            x, y, z = to
        mode = b"G91\n" if style == "increments" else b""
        text = b"%\n" + FEED + mode + "\n".join(lines).encode() + b"\nG90\nM5\nM30\n%\n"
        profile = ("tests/profiles/corpus.toml", "machine-profiles/generic_vmc.toml")[number % 2]
        yield Case("large", style, text, job(profile, "linuxcnc"), ("stdin",))


class Random:
    """Random programs, each from the seed and its number; machines are written into a folder of their own."""

    FAMILIES = ("damage", "frames", "proofs", "mutants")

    def __init__(self, seed, folder):
        self.seed, self.folder = seed, folder
        (self.damage,) = load("damage", "generator")
        self.frames, self.model = load("frames", "programs", "model")
        self.pairs, self.files = load("proofs", "generate", "files")
        self.seeds = [c for c in lying() if c.family != "corpus, other machines" and len(c.text) < 4000]
        self.machines = [self.model.Machine(random.Random(f"{seed} machine {k}"), k, keeps=k == 0) for k in range(8)]

    def case(self, number):
        """The case of a number."""
        family = self.FAMILIES[number % len(self.FAMILIES)]
        case = getattr(self, "of_" + family)(number, random.Random(f"{self.seed} {family} {number}"))
        case.more = EXTRAS[number // len(self.FAMILIES) % len(EXTRAS)]
        return case

    def place(self, number):
        folder = os.path.join(self.folder, str(number))
        os.makedirs(folder, exist_ok=True)
        return folder

    def of_damage(self, number, pick):
        """Posts' programs: mill work on six kinds of machine."""
        kind, dialect = pick.choice(self.damage.MACHINES), pick.choice(self.damage.DIALECTS)
        profile = self.damage.write_machine(self.place(number), kind, dialect, f"{self.seed} {number}")
        text = self.damage.Program(dialect, f"{self.seed} {number}", pick.random() < 0.3).text
        options = ["-m", profile] + (["--start-at=20,20,400"] if pick.random() < 0.75 else [])
        if pick.random() < 0.2:
            options += ["--tolerance", str(pick.choice([0.3, 3, 20]))]
        if pick.random() < 0.15:
            options = job(TRACKED, dialect, "-e", pick.choice(ENGINES), "--start-at=400,200,250")
        return Case(f"damage, {kind}", str(number), text, options, mend=4)

    def of_frames(self, number, pick):
        """Programs that mix the codes on which controls differ."""
        machine, dialect = pick.choice(self.machines), pick.choice(sorted(self.frames.FEATURES))
        lines = self.frames.program(pick, machine, dialect)
        options = ["-m", machine.write(self.place(number), dialect)]
        if pick.random() < 0.6:
            start = [machine.travel[a][0] + v for a, v in zip("XYZ", (350.0, 220.5, 300.0))]
            options.append("--start-at=" + ",".join(f"{v:g}" for v in start))
        return Case(f"frames, {dialect}", str(number), ("\n".join(lines) + "\n").encode(), options, mend=10)

    def of_proofs(self, number, _):
        """Adversarial pairs of a machine and a program."""
        kind, spec, text, start = self.pairs.pair(self.seed, number // len(self.FAMILIES))
        options = ["-m", self.files.write(spec, self.place(number))] + self.files.conditions(spec)
        if start:
            options.append("--start-at=" + ",".join(f"{v:.6f}" for v in start))
        return Case(f"proofs, {kind}", str(number), text.encode(), options)

    def of_mutants(self, number, pick):
        """A program of the corpus with lines or bytes changed, taken out, doubled, or taken from another one."""
        one, other = pick.choice(self.seeds), pick.choice(self.seeds)
        text = spoilt(one.text, pick, other.text)
        return Case("mutants", f"{number} of {one.name}", text, one.options, mend=2)


def spoilt(text, pick, other=b""):
    """Bytes with one to four changes by chance; never the same bytes."""
    new, ways = text, pick.randint(1, 4)
    while ways > 0 or new == text:
        ways -= 1
        lines = new.split(b"\n")
        at = pick.randrange(len(lines))
        digits = [m.start() for m in re.finditer(rb"[0-9]", new)]
        kind = pick.randrange(5)
        if kind == 0 and len(lines) > 2:
            del lines[at]
        elif kind == 1:
            lines.insert(pick.randrange(len(lines)), lines[at])
        elif kind == 2 and other:
            lines.insert(at, pick.choice(other.split(b"\n")))
        elif kind == 3 and digits:
            place = pick.choice(digits)
            lines = (new[:place] + b"%d" % pick.randrange(10) + new[place + 1:]).split(b"\n")
        else:
            place = pick.randrange(len(new) + 1)
            lines = (new[:place] + pick.choice([b"-", b".", b" ", b"X", b"G1", b"(", b"#1", b"R2", b"/", b"\xd0"]) + new[place:]).split(b"\n")
        new = b"\n".join(lines)
    return new
