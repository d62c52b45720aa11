"""The page with files that leave something open, or are wrong: said, nothing taken by guess, nothing lost."""

import random
import time

import jobs
from common.cases import Case
from common.command import short
from page import GOOD, Page, compared, zipped

DIALECT = {"dialect": ["linuxcnc"]}


Names = tuple[str, ...]


def given(page: Page, case: Case, rng: random.Random, programs: Names, machines: Names, lost: int = 0) -> jobs.Job:
    """An archive of programs and machines in the page, `lost` tables missing; the job of the first of both."""
    root = case.folder / "job"
    for name in programs:
        jobs.put(root, name, jobs.program(rng))
    tables = {name: jobs.profile(rng, root, name) for name in machines}
    here = [table for some in tables.values() for table in some][lost:]
    page.give([zipped(root, [*programs, *machines, *here])], "picked", len(programs) + len(machines) + len(here))
    return jobs.Job(root, programs[0], machines[0], tables[machines[0]][lost:], DIALECT)


def two_profiles(page: Page, case: Case, rng: random.Random) -> None:
    job = given(page, case, rng, ("part.nc",), ("a/mill.toml", "b/mill.toml"))
    page.fill(job._replace(profile=""))
    state = page.run()
    if state["kind"] == GOOD or state["made"] or "2" not in state["status"]:
        case.find("page guess", f"nobody chose one of two profiles: {state['status']!r}, made {state['made']}")
    compared(page, case, job, job)


def missing_table(page: Page, case: Case, rng: random.Random) -> None:
    job = given(page, case, rng, ("part.nc",), ("mill.toml",), lost=1)
    state = compared(page, case, job, job)
    if state["kind"] == GOOD or "mill_x.csv" not in state["found"] + state["status"]:
        case.find("page guess", f"mill_x.csv is not there, and it says {state['status']!r} {short(state['found'])}")


def table_of_another(page: Page, case: Case, rng: random.Random) -> None:
    """A profile without its tables; the other's have the same names, and figures of their own."""
    job = given(page, case, rng, ("part.nc",), ("b/mill.toml",))
    path = jobs.put(job.folder, "a/mill.toml", job.path("b/mill.toml").read_text(encoding="utf-8"))
    page.give([zipped(path.parent.parent, ["a/mill.toml"])], "picked", 3 + len(job.tables))
    page.fill(job._replace(profile="a/mill.toml"))
    state = page.run()
    if state["kind"] == GOOD:
        case.find("page guess", f"a/mill.toml has no tables, and got those of b/: {short(state['found'])}")


def changed(page: Page, case: Case, rng: random.Random) -> None:
    """A file changes between the choice and the run, and while it is read: refused, or of one text."""
    body = "".join(f"G1 X{k % 90}.{k % 10} Y{k % 70}. F5000.\n" for k in range(60_000))
    text = jobs.program(rng).replace("M30\n", body + "M30\n")
    for pause in (-1, 0.0, 0.15, 0.4, 0.8):
        page.ask("press", label="Remove all")
        root = case.folder / f"job {pause}"
        tables, path = jobs.profile(rng, root, "mill.toml"), jobs.put(root, "part.nc", text)
        page.give([path, root / "mill.toml", *(root / name for name in tables)], "picked", 2 + len(tables))
        page.fill(jobs.Job(root, "part.nc", "mill.toml", tables, DIALECT))
        if pause >= 0:
            page.ask("begin")
            time.sleep(pause)
        path.write_text(text.replace("F5000", "F3000"), encoding="utf-8")
        state = page.ended() if pause >= 0 else page.run()
        feeds = [feed for feed in (b"F5000.", b"F3000.") if feed in page.take("part_corrected.nc")]
        case.tally[f"page changed {'while read' if pause >= 0 else 'before'}: {'done' if feeds else 'refused'}"] += 1
        if len(feeds) == 2:
            case.find("page mixed", f"{page.browser}: another text {pause} s behind the start, the output has some of both")
        if not feeds and "part.nc" not in state["status"] + state["found"] + state["said"]:
            case.find("page changed", f"says {state['status']!r} {short(state['found'])}, and not which file")


def second_of_a_name(page: Page, case: Case, rng: random.Random) -> None:
    job = given(page, case, rng, ("part.nc",), ("mill.toml",))
    path = jobs.put(case.folder, "second/part.nc", jobs.program(rng))
    state = page.give([path], rng.choice(("picked", "drop")), 3 + len(job.tables))
    rows = [name for name, _ in state["listed"] if "part" in name]
    if len(rows) < 2 and not state["said"]:
        case.find("page lost", f"another part.nc took the place of the first, and nothing is said: {rows}")


def refused_keeps(page: Page, case: Case, rng: random.Random) -> None:
    """A refused run leaves the earlier result, and it can still be had."""
    job = given(page, case, rng, ("part.nc",), ("mill.toml",))
    compared(page, case, job, job)
    before = page.take("part_corrected.nc")
    page.fill(job._replace(options={**DIALECT, "work-offset": ["G54=5000,0,0"]}))
    state = page.run()
    if state["kind"] == GOOD or "part_corrected.nc" not in [name for name, _ in state["listed"]]:
        case.find("page lost", f"refused behind a correction: {state['status']!r}, listed {state['listed']}")
    elif page.take("part_corrected.nc") != before:
        case.find("page lost", "refused behind a correction: part_corrected.nc is listed, no button gives its bytes")


def two_of_a_stem(page: Page, case: Case, rng: random.Random) -> None:
    job = given(page, case, rng, ("a/part.nc", "b/part.nc"), ("mill.toml",))
    for name in "ab":
        page.fill(job._replace(program=f"{name}/part.nc"))
        state = page.run()
    listed = [name for name, _ in state["listed"] if "_corrected" in name and name.endswith(".nc")]
    if len(listed) < 2:
        case.find("page lost", f"the correction of b/part.nc took the place of that of a/part.nc: {listed}")


def bad_archives(page: Page, case: Case, rng: random.Random) -> None:
    jobs.put(case.folder / "job", "part.nc", jobs.program(rng))
    whole = zipped(case.folder / "job", ["part.nc"], 0).read_bytes()
    at = whole.index(b"G43")
    for name, bytes_ in {"flipped": whole[:at] + b"X" + whole[at + 1 :], "cut": whole[:-30]}.items():
        page.ask("press", label="Remove all")
        (case.folder / f"{name}.zip").write_bytes(bytes_)
        state = page.give([case.folder / f"{name}.zip"], "picked", 1)
        if not state["said"]:
            case.find("page archive", f"{name}: nothing is said; listed {state['listed']}")


def dragged(page: Page, case: Case, rng: random.Random) -> None:
    """By the system's drag, the page opened from the disk as users have it. To such a page Chromium gives what a folder
    holds through the dialog alone: then it has to name that."""
    job = given(page, case, rng, ("part.nc",), ("mill.toml",))
    paths = {"file": job.path("part.nc"), "archive": job.folder.with_suffix(".zip"), "folder": job.folder}
    for what, path in paths.items() if page.browser == "chromium" else ():
        page.ask("press", label="Remove all")
        state = page.give([path], "drag", 1 if what == "file" else 2 + len(job.tables))
        if not state["listed"] and not (what == "folder" and "Choose a folder" in state["said"]):
            case.find("page dragged", f"{what}: {state['said']!r}")


QUESTIONS = (two_profiles, missing_table, table_of_another, changed, second_of_a_name, refused_keeps, two_of_a_stem,
             bad_archives, dragged)
ALL = {ask.__name__: ask for ask in QUESTIONS}
