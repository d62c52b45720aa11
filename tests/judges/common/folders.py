"""Files of cases, and folders of those in which something is found."""

import os
import shutil
import tempfile
from collections.abc import Iterable


def of_findings(keep: str | None, prefix: str) -> str:
    """The folder of what is found, whole path; a temporary one if none is named."""
    path = os.path.abspath(keep or tempfile.mkdtemp(prefix=prefix))
    os.makedirs(path, exist_ok=True)
    return path


def put(folder: str | os.PathLike, name: str, text: str, encoding: str = "utf-8") -> str:
    """Writes a file as it is told, ends of lines too; returns its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding=encoding, newline="") as out:
        out.write(text)
    return path


def table(path: str | os.PathLike, head: Iterable[str], rows: Iterable[Iterable[str]]) -> None:
    """Writes a file of comma-separated values."""
    with open(path, "w", encoding="utf-8") as out:
        out.writelines(",".join(row) + "\n" for row in (head, *rows))


def keep(folder: str | os.PathLike, to: str | os.PathLike, words: str) -> None:
    """Copies a case's folder, with `found.txt`."""
    shutil.copytree(folder, to, dirs_exist_ok=True)
    with open(os.path.join(to, "found.txt"), "a", encoding="utf-8") as out:
        out.write(words + "\n")


def settle(folder: str | os.PathLike, words: str) -> None:
    """Leaves a case's folder with `found.txt`; without words nothing was found, and the folder goes."""
    if words:
        put(folder, "found.txt", words + "\n")
    else:
        shutil.rmtree(folder)
