"""The page: what it makes of files that are given to it, beside what the command makes of the same files."""

import argparse
import base64
import json
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import tempfile
import threading
import zipfile
from collections.abc import Callable

import jobs
from common.cases import Case
from common.command import short

SCRIPT = pathlib.Path(__file__).with_name("page.mjs")
GOOD, LISTED_S, ENDED_S, PATIENCE_S = "good", 20, 120, 180
NAMES = ("part.nc", "Деталь 1.nc", "a=1.nc", "it's.nc", "O1000.nc", "part.v2.ngc")
FIELDS = ("dialect", "tolerance", "accept", "work-offset", "zero", "tool", "path-control", "outside", "set", "decimal")
FLAGS = ("strict", "guard")
# The number that an operating system has for an error: WebAssembly's is its own.
SYSTEM = re.compile(r" \(os error \d+\)")


class Page:
    """A browser with the page in it."""

    def __init__(self, browser: str, page: str, folder: str):
        line = ["node", "--experimental-websocket", str(SCRIPT), browser, str(pathlib.Path(page).resolve()), folder]
        self.child = subprocess.Popen(line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8")
        self.browser = browser
        self.ask("open")

    def ask(self, what: str, **how: object) -> object:
        self.child.stdin.write(json.dumps({"do": what, **how}) + "\n")
        self.child.stdin.flush()
        patience = threading.Timer(PATIENCE_S, self.child.kill)
        patience.start()
        answer = json.loads(self.child.stdout.readline() or '{"error": "no answer, or the browser ended"}')
        patience.cancel()
        if "error" in answer:
            raise RuntimeError(f"{self.browser}: {what}: {answer['error']}")
        return answer["value"]

    def give(self, paths: list[pathlib.Path], by: str, count: int) -> dict:
        """Files into the page, until it lists so many or says something."""
        self.ask("give", files=[str(path) for path in paths], by=by)
        self.ask("listed", count=count, seconds=LISTED_S)
        return self.ask("state")

    def fill(self, job: jobs.Job) -> list[str]:
        """Program, profile and options into their fields, all others empty; returns what could not be chosen."""
        values = {"": job.program, "machine": job.profile}
        values |= {name: "\n".join(job.options.get(name, [])) for name in FIELDS}
        values |= {name: name in job.options for name in FLAGS}
        said = {name: self.ask("fill", name=name, value=value) for name, value in values.items()}
        return [f"{name or 'program'}: {text}" for name, text in said.items() if text]

    def run(self) -> dict:
        """Presses Run and waits; what the page says then."""
        self.ask("begin")
        return self.ended()

    def ended(self) -> dict:
        over = self.ask("ended", seconds=ENDED_S)
        return {**self.ask("state"), **({} if over else {"status": "no end", "kind": "none"})}

    def take(self, name: str) -> bytes:
        """A file by its button; nothing where there is none."""
        found = self.ask("take", name=name)
        return base64.b64decode(found[1]) if found else b""


def zipped(root: pathlib.Path, names: list[str], kind: int = zipfile.ZIP_DEFLATED) -> pathlib.Path:
    with zipfile.ZipFile(root.with_suffix(".zip"), "w", kind) as out:
        for name in names:
            out.write(root / name, name)
    return root.with_suffix(".zip")


def delivered(rng: random.Random, browser: str, job: jobs.Job) -> tuple[list[pathlib.Path], str, jobs.Job]:
    """What is given to the page and how; and the job with the names that the page has of it."""
    names = [job.program, job.profile, *job.tables]
    how = rng.choice(("single", "zip", "folder") if browser == "chromium" else ("single", "zip"))
    if how == "single":
        paths = [job.path(name) for name in rng.sample(names, len(names))]
        flat = job._replace(program=job.path(job.program).name, profile="mill.toml")
        return paths, rng.choice(("picked", "drop")), flat
    if how == "folder":
        above = job.folder.name + "/"
        return [job.folder], "picked-folder", job._replace(program=above + job.program, profile=above + job.profile)
    archive = zipped(job.folder, names, rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)))
    return [archive], rng.choice(("picked", "drop")), job


def laid_out(job: jobs.Job, seen: jobs.Job, folder: pathlib.Path) -> jobs.Job:
    """The same files under the names that the page has, tables where the profile looks for them."""
    machine, to = job.path(job.profile).parent, (folder / seen.profile).parent
    pairs = [(job.path(job.program), folder / seen.program), (job.path(job.profile), folder / seen.profile)]
    for here, there in pairs + [(job.path(name), to / job.path(name).relative_to(machine)) for name in job.tables]:
        there.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(here, there)
    return seen._replace(folder=folder)


def compared(page: Page, case: Case, job: jobs.Job, seen: jobs.Job, about: str = "") -> dict:
    """Runs a job in the page and by the command, and finds what differs; what the page says behind it."""
    wrong = [("fields", text) for text in page.fill(seen)]
    state = page.run()
    seen = laid_out(job, seen, case.folder / "command")
    path = pathlib.PurePosixPath(seen.program)
    made = f"{path.stem}_corrected{path.suffix}", f"{path.stem}_summary.json"
    ended, *files = jobs.correct(case.options.vpost, seen, *made)
    case.tally[f"page {page.browser}: status {ended.status}"] += 1
    if (state["kind"] == GOOD) != (ended.status == 0):
        wrong.append(("status", f"{state['status']!r}, the command ends with {ended.status}: {short(ended.errors)}"))
    wrong += [("bytes", f"{name} is not the command's ({len(bytes_)} bytes); made {state['made']}")
              for name, bytes_ in zip(made, files) if ended.status == 0 and page.take(name) != bytes_]
    if ended.status and state["made"]:
        wrong.append(("made", f"refused, and yet there is {state['made']}"))
    said = page.take("messages.txt").decode().strip()
    if SYSTEM.sub("", said) != SYSTEM.sub("", ended.errors.strip()):
        wrong.append(("messages", f"{short(said)!r} where the command says {short(ended.errors)!r}"))
    typed = {"vpost", "correct", seen.program, f"--machine={seen.profile}", *jobs.words(seen.options)}
    if state["line"] and not typed <= set(shlex.split(state["line"])):
        wrong.append(("line", f"{state['line']} lacks {sorted(typed - set(shlex.split(state['line'])))}"))
    for what, text in wrong:
        case.find(f"page {what}", f"{page.browser}, {about}{jobs.shown(seen)}: {text}")
    return state


def one(page: Page, case: Case, rng: random.Random) -> None:
    job = jobs.make(rng, case.folder / "job", NAMES)
    paths, by, seen = delivered(rng, page.browser, job)
    state = page.give(paths, by, 2 + len(job.tables))
    case.tally[f"page {page.browser}: {by}, {'archive' if paths[0].suffix == '.zip' else 'files'}"] += 1
    if state["said"]:
        case.find("page said", f"{by} {paths}: {state['said']}")
    compared(page, case, job, seen, f"{by} {paths[0].name}, ")


Question = Callable[[Page, Case, random.Random], None]


def campaign(options: argparse.Namespace, browser: str, count: int, directed: dict[str, Question]) -> list[Case]:
    """Random jobs in one browser, then `directed`; no request, no message of the console."""
    done, tasks = [], {**{str(n): one for n in range(count)}, **directed}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        page = Page(browser, options.page, profile)
        for name, ask in tasks.items():
            with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
                case = Case(options, f"{browser}-{name}", folder)
                page.ask("press", label="Remove all")
                ask(page, case, random.Random(f"page {browser} {options.seed} {name}"))
                if name == list(tasks)[-1]:
                    for told in page.ask("told"):
                        case.find("page told", told)
                done.append(case)
        page.child.stdin.close()
        page.child.wait(20)
    return done
