"""Options as the command line spells them: one reader refuses them, in one wording."""

from __future__ import annotations

import math
import os
from typing import Iterable, List, Mapping, Optional, Sequence, Union

from ._messages import NotFiniteError, ShapeError

Path = Union[str, "os.PathLike[str]"]
#: ``{"G54": (100, 50, 0)}``, mm.
Offsets = Mapping[str, Sequence[float]]
#: ``{"H1": 120.0}`` or ``{"H1": (0, 0, 120)}``, mm.
Lengths = Mapping[str, Union[float, Sequence[float]]]


def number(value: float, what: str) -> str:
    """A number as text that reads back the same."""
    value = float(value)
    if not math.isfinite(value):
        raise NotFiniteError(f"{what} is {value}")
    return repr(value)


def three(values: Sequence[float], what: str) -> str:
    """Three numbers as text."""
    values = list(values)
    if len(values) != 3:
        raise ShapeError(f"{what} has {len(values)} numbers, expected are 3: X, Y, Z in mm")
    return ",".join(number(value, what) for value in values)


def options(
    profile: Optional[Path],
    *,
    dialect: Optional[Path] = None,
    engine: Optional[str] = None,
    tolerance_um: Optional[float] = None,
    accept_um: Optional[float] = None,
    zero: Optional[str] = None,
    work_offset: Optional[Offsets] = None,
    tool: Optional[Lengths] = None,
    start_at: Optional[Sequence[float]] = None,
    variables: Optional[Mapping[str, float]] = None,
    include: Iterable[Path] = (),
    decimal: Optional[str] = None,
    at: Optional[Mapping[str, float]] = None,
    outside: Optional[str] = None,
    strict: bool = False,
    guard: bool = False,
    path_control: Optional[str] = None,
) -> List[str]:
    """The words of a command line."""
    words = [] if profile is None else [f"--machine={os.fspath(profile)}"]
    if dialect is not None:
        words.append(f"--dialect={os.fspath(dialect)}")
    if engine is not None:
        words.append(f"--engine={engine}")
    if tolerance_um is not None:
        words.append(f"--tolerance={number(tolerance_um, 'tolerance_um')}")
    if accept_um is not None:
        words.append(f"--accept={number(accept_um, 'accept_um')}")
    if zero is not None:
        words.append(f"--zero={zero}")
    for name, place in (work_offset or {}).items():
        words.append(f"--work-offset={name}={three(place, name)}")
    for name, length in (tool or {}).items():
        text = number(length, name) if isinstance(length, (int, float)) else three(length, name)
        words.append(f"--tool={name}={text}")
    if start_at is not None:
        words.append(f"--start-at={three(start_at, 'start_at')}")
    for name, value in (variables or {}).items():
        words.append(f"--set={name}={number(value, name)}")
    words.extend(f"--include={os.fspath(folder)}" for folder in include)
    if decimal is not None:
        words.append(f"--decimal={decimal}")
    for name, value in (at or {}).items():
        words.append(f"--at={name}={number(value, name)}")
    if outside is not None:
        words.append(f"--outside={outside}")
    words.extend(["--strict"] if strict else [])
    words.extend(["--guard"] if guard else [])
    if path_control is not None:
        words.append(f"--path-control={path_control}")
    return words


def spelt(**asked: Union[None, bool, float, str, Sequence[str]]) -> List[str]:
    """The words of options that one job has: a list is an option that repeats, None and False are not asked for."""
    words = []
    for name, value in asked.items():
        option = f"--{name.replace('_', '-')}"
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, int):
            words.append(f"{option}={value}")
        elif isinstance(value, float):
            words.append(f"{option}={number(value, name)}")
        else:
            words.extend(f"{option}={one}" for one in ([value] if isinstance(value, str) else value))
    return words
