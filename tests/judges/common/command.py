"""Runs the command that is judged, and reads what it says of itself and of a refusal."""

import json
import os
import re
import subprocess
from collections.abc import Sequence
from typing import NamedTuple


Command = str | os.PathLike | Sequence[str]
Folder = str | os.PathLike | None


class Ended(NamedTuple):
    status: int
    output: str
    errors: str


def run(vpost: Command, *words: object, folder: Folder = None, seconds: float = 180, given: str = "") -> Ended:
    """Runs it to its end, in `folder`, with `given` at its standard input; TimeoutExpired after `seconds`."""
    first = [vpost] if isinstance(vpost, (str, os.PathLike)) else vpost
    line = [*map(str, first), *map(str, words)]
    done = subprocess.run(line, cwd=folder, input=given.encode(), capture_output=True, timeout=seconds, check=False)
    return Ended(done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace"))


def ask(vpost: Command, *words: object, folder: Folder = None, seconds: float = 180) -> Ended:
    """The same; where there is no end, status -1 and words about that."""
    try:
        return run(vpost, *words, folder=folder, seconds=seconds)
    except subprocess.TimeoutExpired:
        return Ended(-1, "", f"no end within {seconds:g} s")


def code(errors: str, otherwise: str = "none") -> str:
    """The number of the first error."""
    found = re.search(r"error\[(VP\d+)\]", errors)
    return found[1] if found else otherwise


def short(errors: str, length: int = 300) -> str:
    """Messages in one line."""
    return errors.strip().replace("\n", " | ")[:length]


def first_error(errors: str) -> str:
    """The line of the first error."""
    return next((line for line in errors.splitlines() if line.startswith("error")), "")


def microns(messages: str, number: str) -> float | None:
    """The largest number of micrometres in the first lines of messages of that number, mm: 0 if they say none, None
    without one."""
    texts = re.findall(rf"\[{number}\](.*)", messages)
    found = [float(size) * 1e-3 for text in texts for size in re.findall(r"([\d.]+) ?[µu]m", text)]
    return max(found, default=0.0) if texts else None


def schema(vpost: Command, section: str) -> dict:
    """The keys of a section of profiles that the command knows, with what its schema says of each."""
    try:
        found = json.loads(run(vpost, "profile", "schema").output)
    except (OSError, ValueError):
        return {}
    return found.get("$defs", {}).get(section, {}).get("properties", {})
