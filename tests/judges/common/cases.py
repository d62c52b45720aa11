"""Numbered cases: run in order, counted, and kept where something is found."""

import argparse
import collections
import concurrent.futures
import functools
import os
import pathlib
import statistics
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator

from . import folders
from .command import Ended, code, run, short


def in_order(one: Callable, tasks: Iterable, jobs: int = 1) -> Iterator:
    """What `one` makes of each task, in their order; `jobs` processes at the same time."""
    if jobs == 1:
        yield from map(one, tasks)
        return
    with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(one, tasks)


def shown(results: Iterable, about: Callable[[object], tuple[str, list[tuple[str, str]]]]) -> list:
    """All results. What `about` says of each, its name and what is found, is printed as it comes."""
    out = []
    for result in results:
        name, found = about(result)
        for what, text in found:
            print(f"{name} {what}: {text}", flush=True)
        out.append(result)
    return out


def examined(folder: str, examine: Callable[[], tuple[list, dict]]) -> tuple[list, dict]:
    """(findings, figures) of a case; findings also in its `found.txt`. No answer in time is one."""
    try:
        found, figures = examine()
    except subprocess.TimeoutExpired as slow:
        found, figures = [("slow", f"more than {slow.timeout:g} s")], {}
    folders.put(folder, "found.txt", "".join(f"{name}: {words}\n" for name, words in found))
    return found, figures


class Case:
    """One case in a folder of its own: what is counted, found, refused and measured of it."""

    def __init__(self, options: argparse.Namespace, number: int | str, folder: str):
        self.options, self.number, self.folder = options, number, pathlib.Path(folder)
        self.tally: collections.Counter[str] = collections.Counter()
        self.found: list[tuple[str, str]] = []
        self.refused: tuple[str, list[str]] | None = None
        self.figures: dict[str, float] = {}

    def write(self, name: str, text: str) -> pathlib.Path:
        return pathlib.Path(folders.put(self.folder, name, text))

    def find(self, what: str, text: str) -> None:
        """Something is wrong: the folder is kept as it is now."""
        self.found.append((what, text))
        self.tally["found " + what] += 1
        if self.options.keep:
            name = f"{self.options.seed}-{self.number}-{what.replace(' ', '-')}"
            folders.keep(self.folder, os.path.join(self.options.keep, name), text)

    def run(self, *words: object) -> Ended:
        return run(self.options.vpost, *words)

    def correct(self, *flags: object, about: str = "") -> tuple[str, str] | None:
        """Output, kept as `out.nc`, and messages of `in.nc`. None where it is refused, which is counted (with `about`
        before the number), or the profile is, which is found."""
        status, output, errors = self.run("correct", self.folder / "in.nc", *flags)
        if status == 2:
            self.find("profile", short(errors))
        elif status:
            self.refused = about + code(errors), errors.strip().splitlines()[:4]
        else:
            self.write("out.nc", output)
            return output, errors
        return None

    def check(self, wrong: bool, *flags: object, name: str = "out.nc") -> None:
        """Asks `vpost check` too, which is to say of the output what this judge says."""
        status, _, errors = self.run("check", self.folder / "in.nc", self.folder / name, *flags)
        if (status != 0) != wrong:
            self.find("check-blind" if wrong else "check-alarm", short(errors, 200))


def played(one: Callable[[Case], None], options: argparse.Namespace, number: int | str) -> Case:
    with tempfile.TemporaryDirectory() as folder:
        case = Case(options, number, folder)
        try:
            one(case)
        except subprocess.TimeoutExpired as slow:
            case.find("slow", f"{slow.timeout:g} s")
    return case


def asked(options: argparse.Namespace) -> range:
    """The numbers that a command line asks for."""
    return range(options.first, options.first + options.count)


def campaign(
    options: argparse.Namespace, one: Callable[[Case], None], numbers: Iterable[int | str] | None = None
) -> int:
    """Plays the cases that the command line asks for, or those of `numbers`, and prints what came of them; 1 where
    something is found."""
    tally, refused, first, figures = collections.Counter(), collections.Counter(), {}, collections.defaultdict(list)
    numbers = asked(options) if numbers is None else numbers
    for case in in_order(functools.partial(played, one, options), numbers, getattr(options, "jobs", 1)):
        for what, text in case.found:
            print(f"{what:14} {case.number!s:>4}  {text}", flush=True)
        tally.update(case.tally)
        if case.refused:
            refused[case.refused[0]] += 1
            first.setdefault(case.refused[0], (case.number, case.refused[1]))
        for name, value in case.figures.items():
            figures[name].append(value)
    for name, count in sorted(tally.items()):
        print(f"{count:6}  {name}")
    for name, count in refused.most_common():
        print(f"{count:6}  refused by {name}, as number {first[name][0]}: {first[name][1]}")
    for name, values in sorted(figures.items()):
        print(f"{name}: median {statistics.median(values):.3f}, largest {max(values):.3f}")
    return int(any(name.startswith("found ") for name in tally))
