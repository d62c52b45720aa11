"""Settings: a call with vpost.toml has the bytes of the same options typed; what is wrong is refused at its place."""

import json
import pathlib
import random
import re

import jobs
from common.cases import Case
from common.command import Ended, run, short
from common.profile import value

OTHER = {"tolerance": ["7"], "accept": ["12"], "zero": ["true"], "outside": ["clamp"], "tool": ["H1=77"],
         "set": ["#701=3"], "work-offset": ["G54=210,210,190"]}
OF_CORRECT = ("guard", "path-control")


def entry(rng: random.Random, name: str, values: list[str]) -> str:
    """A line of TOML for an option, written in one of the ways that hold."""
    if name in jobs.REPEATED and rng.random() < 0.5:
        table = {key: [float(n) for n in rest.split(",")] for key, rest in (one.split("=") for one in values)}
        return f"{name} = " + value({key: at if len(at) > 1 else at[0] for key, at in table.items()})
    if name in ("tolerance", "accept") and rng.random() < 0.5:
        return f"{name} = {values[0]}"
    return f"{name} = " + value(values if len(values) > 1 else values[0] if values else True)


class Split:
    """A job's options, some in the file's top, some in [correct], some typed; other values where those do not hold."""

    def __init__(self, rng: random.Random, job: jobs.Job, at: pathlib.PurePosixPath):
        # As it is counted from the file's folder `at`, and so named in messages.
        counted = "../" * len(at.parts) + job.profile
        self.typed, self.machine = {}, f"{at}/{counted}" if at.parts else counted
        top, table, foreign = [], [], []
        for name, values in {"machine": [counted], **job.options}.items():
            where = rng.choice(("top", "top", "table", "typed"))
            if where == "typed":
                self.typed[name] = values if name != "machine" else [job.profile]
                self.machine = job.profile if name == "machine" else self.machine
            else:
                (table if where == "table" or name in OF_CORRECT else top).append(entry(rng, name, values))
            for lines in [top] * (where != "top") + [table] * (where == "typed") + [foreign]:
                if name in OTHER and rng.random() < 0.5:
                    lines.append(entry(rng, name, OTHER[name]))
        self.text = "\n".join(["# shop", *top, "[batch]", *foreign, "[correct]", *table]) + "\n"


def placed(rng: random.Random, job: jobs.Job) -> tuple[Split, str, list[str]]:
    """Writes vpost.toml beside or above the program, one that does not count still farther; (what, its name, words)."""
    places = list(pathlib.PurePosixPath(job.program).parents)
    at = rng.choice(places)
    for farther in places[places.index(at) + 1 :]:
        jobs.put(job.folder, str(farther / "vpost.toml"), 'no-such = "key"\n')
    own = rng.random() < 0.2
    at, name = (pathlib.PurePosixPath("own"), "own/mine.toml") if own else (at, str(at / "vpost.toml"))
    split = Split(rng, job, at)
    jobs.put(job.folder, name, split.text)
    return split, name, [f"--config={name}"] * own


def called(case: Case, job: jobs.Job, options: list[str]) -> tuple[Ended, bytes, dict]:
    """(how it ended, the program, the summary without what says where its options came from)."""
    line = ["correct", job.program, *options, "--output=out.nc", "--summary=out.json", "--lang=en"]
    ended = run(case.options.vpost, *line, folder=job.folder)
    summary = json.loads(jobs.taken(job.path("out.json")) or b"{}")
    summary.pop("settings", None)
    return ended, jobs.taken(job.path("out.nc")), summary


def held(case: Case, job: jobs.Job, split: Split, name: str, config: list[str]) -> None:
    """The call with the file beside the call with all options typed."""
    typed, besides = ["--config=none", f"--machine={split.machine}", *jobs.words(job.options)], jobs.words(split.typed)
    (expected, *files), (found, *made) = called(case, job, typed), called(case, job, [*config, *besides])
    # A file of which nothing holds is not named.
    silent = len(besides) >= len(typed) - 1
    head, _, errors = ("settings from ", "", found.errors) if silent else found.errors.partition("\n")
    case.tally[f"settings status {expected.status}"] += 1
    differs = (found.status, made, errors) != (expected.status, files, expected.errors)
    if differs or not head.startswith("settings from "):
        what = "bytes" if made != files else "messages" if found.status == expected.status else "status"
        said = [(one.status, short(one.errors)) for one in (found, expected)]
        case.find(f"settings {what}", f"{name}:\n{split.text}typed besides {besides}: {said[0]}; {typed}: {said[1]}")


# A line that is wrong, and what in it the message points to: the key, where that is wrong, else somewhere in the value.
WRONG = (
    ("tolerence = 3", "tolerence"), ("force = true", "force"), ('output = "o"', "output"), ('config = "x"', "config"),
    ("Tolerance = 3", "Tolerance"), ('work_offset = "x"', "work_offset"), ('"" = 1', '""'), ("[corect]", "corect"),
    ("[correct]\nnothing = 1", "nothing"), ("[watch]\nsetle = 2", "setle"), ("[correct]\nsettle = 2", "settle"),
    ('strict = "yes"', '"yes"'), ("strict = 1", "1"), ("tool = { H1 = true }", "{ H1"), ("outside = 5", "5"),
    ("set = [[1]]", "[["),
    ("tolerance == 3", "= 3"), ("tolerance = 3 4", "3 4"), ('zero = "felt"', '"felt"'), ("tolerance = []", "[]"),
    ('tolerance = "much"', '"much"'), ("work-offset = { G54 = [1, 2] }", "{ G54"), ('work-offset = "G54"', '"G54"'),
    ("set = [1, 2]", "[1"), ('at = { temp_c = "warm" }', "{ temp_c"), ('start-at = { X = "far" }', "{ X"),
)
# Values of the right kind that the work itself refuses.
UNFIT = (("tolerance = -1", "-1"), ('dialect = "fanucc"', '"fanucc"'), ('machine = "not.toml"', '"not.toml"'),
         ('engine = "steam"', '"steam"'))


def refused(case: Case, job: jobs.Job, name: str, config: list[str], line: str, pointed: str, about: str) -> None:
    """A file of comments and this line, all else typed: status 2, with file, line and column of what is wrong."""
    text = "# shop\n" * (len(job.program) % 3) + line + "\n"
    jobs.put(job.folder, name, text)
    last, row = line.split("\n")[-1], text.count("\n")
    key, first = last.split(" ")[0], last.index(pointed) + 1
    named = {"machine": [job.profile], **job.options}
    typed = jobs.words({option: some for option, some in named.items() if option != key})
    ended, program, _ = called(case, job, [*config, *typed])
    places = [(file, int(r), int(c)) for file, r, c in re.findall(r"--> (.+):(\d+):(\d+)", ended.errors)]
    columns = {c for file, r, c in places if (pathlib.PurePosixPath(file), r) == (pathlib.PurePosixPath(name), row)}
    fits = {first} if pointed in (key, key.strip("[]")) else {1, *range(first, len(last) + 2)}
    case.tally["settings wrong lines"] += 1
    if ended.status != 2 or program or not fits & columns:
        what = "accepted" if ended.status != 2 else "column" if columns else "place"
        case.find(f"settings {about}{what}", f"{name}: {line!r} in line {row}, typed besides {typed}: {ended.status}, "
                                             f"pointed to {places}: {short(ended.errors)}")


def one(case: Case, rng: random.Random) -> None:
    job = jobs.make(rng, case.folder)
    split, name, config = placed(rng, job)
    held(case, job, split, name, config)
    number = int(str(case.number).split("-")[-1])
    refused(case, job, name, config, *WRONG[number % len(WRONG)], "")
    if number < len(UNFIT):
        refused(case, job, name, config, *UNFIT[number], "unfit ")
