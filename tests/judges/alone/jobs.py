"""Random jobs: a machine with its tables, a program, options; and what the command makes of them."""

import pathlib
import random
import shlex
from typing import NamedTuple

from common import folders
from common.command import Command, Ended, run
from common.profile import Profile, six
from common.words import number

SAMPLES = pathlib.Path(__file__).resolve().parents[3] / "samples"
OF_SAMPLES = {"linuxcnc": ("plate_linuxcnc.nc", "helix_linuxcnc.ngc", "inverse_time_linuxcnc.ngc"),
              "fanuc": ("plate_fanuc.nc", "bolt_circle_fanuc.nc", "bracket_inch_fanuc.nc", "dome_fanuc.nc"), "haas": ()}
REPEATED = ("work-offset", "tool", "set")
Options = dict[str, list[str]]


class Job(NamedTuple):
    folder: pathlib.Path
    program: str
    profile: str
    tables: list[str]
    options: Options

    def path(self, name: str) -> pathlib.Path:
        return self.folder / name


def words(options: Options) -> list[str]:
    """As they are typed; a flag has no values."""
    return [f"--{name}{value}" for name, values in options.items() for value in ([f"={v}" for v in values] or [""])]


def profile(rng: random.Random, folder: pathlib.Path, name: str) -> list[str]:
    """Writes a mill's profile, its tables beside it or in a folder; returns their names from `folder`."""
    mill = Profile(rng.choice(("Mill", "Станок №1", 'M "2"')), "fanuc", "[w X Y b Z t]")
    path, inside, tables = pathlib.PurePosixPath(name), rng.choice(("", "tables/", "таблицы 1/")), []
    for axis, travel in {"X": 1000, "Y": 600, "Z": 500}.items():
        mill.axis(axis)["travel_mm"] = [0, travel]
        if axis == "X" or rng.random() < 0.7:
            mill.axis(axis)["errors"] = f"{inside}{path.stem}_{axis.lower()}.csv"
            tables.append(str(path.parent / mill.axis(axis)["errors"]))
            (folder / tables[-1]).parent.mkdir(parents=True, exist_ok=True)
            rows = [[str(at), *(f"{rng.uniform(-20, 20):.2f}" for _ in range(6))] for at in range(0, travel + 1, 100)]
            folders.table(folder / tables[-1], ["position_mm", *six(axis)], rows)
    mill["squareness"].update({f"{error}_urad": round(rng.uniform(-80, 80), 1) for error in ("EC0Y", "EB0Z", "EA0Z")})
    mill["tool"].update(default_mm=[0, 0, -50], lengths_mm={"H1": round(rng.uniform(60, 160), 3)})
    mill["work_offsets_mm"]["G54"] = [round(rng.uniform(150, 300), 2) for _ in "XYZ"]
    put(folder, name, mill.text())
    return tables


def put(folder: pathlib.Path, name: str, text: str, encoding: str = "utf-8") -> pathlib.Path:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(text.encode(encoding, "replace"))
    return folder / name


# What becomes of a line.
FAULTS = ("G2 X12. Y11. F100.", "{} G0 Х1.", "{} (end", "{} Z10,5", "G1 X5000. F100.", "G777", "G43 H17", "G1 X#7 F9.")


def program(rng: random.Random, share: float = 0.0, lines: int = 12) -> str:
    """Feeds, rapids and arcs within some 60 mm of the zero; one of FAULTS in this share of programs."""
    out = [rng.choice(("(part)", "(Деталь 5)")), "G21 G17 G90 G40 G49 G80", "G54", "T1 M6", "G43 H1", "S1000 M3"]
    out.append("G0 X0. Y0. Z50.")
    x, y = 0.0, 0.0
    for _ in range(rng.randrange(2, lines)):
        kind, feed = rng.choice(("G0", "G1", "G1", "G1", "G2", "G3")), f" F{rng.randrange(100, 900)}."
        if kind in ("G2", "G3"):
            step = round(rng.uniform(2, 20), 3) * (-1 if y > 0 else 1)
            y = round(y + step, 3)
            out.append(f"{kind} X{number(x)} Y{number(y)} I0. J{number(step / 2)}{feed}")
        else:
            x, y, z = (round(rng.uniform(*within), 3) for within in ((-60, 60), (-60, 60), (1, 40)))
            out.append(f"{kind} X{number(x)} Y{number(y)} Z{number(z)}{feed if kind == 'G1' else ''}")
    if rng.random() < share:
        at = rng.randrange(7, len(out))
        out[at] = rng.choice(FAULTS).format(out[at])
    return "\n".join([*out, "G0 Z80.", "M5", "M30"]) + "\n"


def choices(rng: random.Random, dialect: str) -> Options:
    """Some options of `correct`, with values that are taken."""
    offset = f"G54={rng.randrange(200, 260)},{rng.uniform(200, 260):.1f},200"
    known = {"tolerance": ["1", "2.5", "20"], "accept": ["0", "30"], "zero": ["true", "touched"],
             "path-control": ["keep", "exact"], "outside": ["refuse", "clamp"],
             "decimal": ["millimetres"] + ["increments"] * (dialect != "linuxcnc")}
    some: Options = {name: [rng.choice(values)] for name, values in known.items()}
    some |= {"work-offset": [offset] + ["G55=1,2,3"] * rng.randrange(2), "set": ["#701=12.5"], "strict": [],
             "guard": [], "tool": [f"H1={rng.randrange(60, 140)}"] + ["H17=90.5"] * rng.randrange(2)}
    return {"dialect": [dialect], **{name: values for name, values in some.items() if rng.random() < 0.25}}


def make(rng: random.Random, folder: pathlib.Path, names: tuple[str, ...] = ("part.nc",)) -> Job:
    """A job whose program and profile may lie in folders of their own."""
    name = rng.choice(("", "jobs/", "Работа 1/")) + rng.choice(names)
    machine = rng.choice(("", "machine/")) + "mill.toml"
    dialect, text = rng.choice(sorted(OF_SAMPLES)), program(rng, 0.4)
    if OF_SAMPLES[dialect] and rng.random() < 0.25:
        text = (SAMPLES / rng.choice(OF_SAMPLES[dialect])).read_text(encoding="utf-8")
    text = text.replace("\n", "\r\n") if rng.random() < 0.2 else text
    put(folder, name, text, rng.choice(("utf-8", "utf-8", "cp1251")))
    return Job(folder, name, machine, profile(rng, folder, machine), choices(rng, dialect))


def correct(vpost: Command, job: Job, to: str = "out.nc", summary: str = "out.json") -> tuple[Ended, bytes, bytes]:
    """(how the command ended, program, summary) in the job's folder, in English; what it wrote is taken away."""
    line = ["correct", job.program, f"--machine={job.profile}", *words(job.options), f"--output={to}"]
    ended = run(vpost, *line, f"--summary={summary}", "--lang=en", folder=job.folder)
    return ended, taken(job.path(to)), taken(job.path(summary))


def taken(path: pathlib.Path) -> bytes:
    bytes_ = path.read_bytes() if path.exists() else b""
    path.unlink(missing_ok=True)
    return bytes_


def shown(job: Job) -> str:
    """The call, to be typed."""
    return shlex.join(["vpost", "correct", job.program, f"--machine={job.profile}", *words(job.options)])
