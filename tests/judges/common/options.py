"""The command line of a judge: options of the same name mean the same everywhere."""

import argparse
import os
import shlex
import shutil

MORE = {
    "first": {"type": int, "default": 0, "help": "number of the first case"},
    "jobs": {"type": int, "default": 1, "help": "cases at the same time"},
    "json": {"metavar": "FILE", "help": "write all verdicts"},
    "refusals": {"action": "store_true", "help": "bad input instead"},
}


def parser(
    description: str, count: int, *more: str, vpost: str | None = None, seed: int | str = 1
) -> argparse.ArgumentParser:
    """The options of every judge, and those of MORE that are named. `vpost`: the command if none is named; None: one
    must be."""
    words = argparse.ArgumentParser(description=description.strip().split("\n")[0])
    option = words.add_argument
    option("--vpost", metavar="COMMAND", default=vpost, required=vpost is None, help="the command that is judged")
    option("--count", type=int, default=count, metavar="N", help=f"cases; {count} if not given")
    option("--seed", type=type(seed), default=seed, help=f"of all random numbers; {seed} if not given")
    option("--keep", metavar="DIR", help="folder of what is found")
    option("--self-test", action="store_true", help="shows that what is wrong is found, and what is right passes")
    for name in more:
        option(f"--{name}", **MORE[name])
    return words


def command(words: argparse.ArgumentParser, text: str) -> list[str]:
    """The command in `text`, by its whole path, with words behind it if it has some; a usage error if there is none."""
    found = shlex.split(text)
    if not found or not shutil.which(found[0]):
        words.error(f"no command {text}")
    return [os.path.abspath(shutil.which(found[0])), *found[1:]]
