"""What these judges do alike: the command line, and a folder for each case, kept where one is asked for."""

import argparse
import contextlib
import pathlib
import tempfile
from collections.abc import Iterator


def parser(description: str, **counts: int) -> argparse.ArgumentParser:
    """`--vpost`, `--seed`, `--keep`, and a count for each name."""
    words = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--vpost", required=True)
    for name, count in counts.items():
        words.add_argument(f"--{name}", type=int, default=count)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--keep", type=pathlib.Path)
    return words


@contextlib.contextmanager
def folder(keep: pathlib.Path | None, name: str) -> Iterator[pathlib.Path]:
    """The folder of that name under `keep`; without one a folder that goes."""
    if keep:
        (keep / name).mkdir(parents=True, exist_ok=True)
        yield keep / name
        return
    with tempfile.TemporaryDirectory() as temporary:
        yield pathlib.Path(temporary)
