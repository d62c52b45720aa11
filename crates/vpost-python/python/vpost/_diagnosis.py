"""Diagnosis: which unmodelled effect explains measurements."""

from __future__ import annotations

import json
import math
import typing
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple, Union

from . import _vpost
from ._messages import NotFiniteError, ShapeError
from ._options import Path, options


@dataclass(frozen=True)
class Gap:
    """What machine and model differ by, µm."""

    rows: int
    rms_um: float
    p95_um: float
    max_um: float
    noise_um: float


@dataclass(frozen=True)
class Place:
    """Where the gap is: the share of a cell in one way to divide the rows, and its p value."""

    by: str
    cell: str
    share: float
    p: float


@dataclass(frozen=True)
class Parameter:
    """A number of an effect, in the unit that its name ends in, and its expanded uncertainty (95 %)."""

    name: str
    value: float
    u95: Optional[float]


@dataclass(frozen=True)
class Neighbour:
    """An effect that looks alike."""

    effect: str
    correlation: float
    behind_bic: float


@dataclass(frozen=True)
class Shrink:
    """By which share the gap will shrink on rows that nobody saw."""

    low: float
    mid: float
    high: float


@dataclass(frozen=True)
class Change:
    """A number of the profile that acting on a cause changes; ``from_`` is None where its tables hold it."""

    name: str
    from_: Optional[float]
    by: float
    unit: str


@dataclass(frozen=True)
class Cause:
    """An effect that explains the gap."""

    effect: str
    words: str
    parameters: Tuple[Parameter, ...]
    share_unique: float
    share_alone: float
    p: float
    cannot_be_told_from: Tuple[str, ...]
    nearest: Tuple[Neighbour, ...]
    rms_before_um: float
    rms_after_um: float
    shrink_predicted: Shrink
    remedy: str
    changes: Tuple[Change, ...]


@dataclass(frozen=True)
class Setup:
    """The measuring frame against the machine's."""

    shift_um: Tuple[float, ...]
    rotation_urad: Tuple[float, ...]
    run_offsets_um: Dict[str, Any]
    run_rotations_urad: Dict[str, Any]


@dataclass(frozen=True)
class Leftover:
    """What no cause explains."""

    rms_um: float
    phi: float
    lack_of_fit_p: float
    correlates_with: Any
    absorber: Any


@dataclass(frozen=True)
class Step:
    """The gap of unseen rows after one more part of the model, µm."""

    added: str
    rms_um: float


@dataclass(frozen=True)
class Holdout:
    """Rows that no fit saw."""

    rows: int
    rms_before_um: float
    rms_after_um: float
    shrink: float
    steps: Tuple[Step, ...]


@dataclass(frozen=True)
class NextMeasurement:
    """What to measure to tell rivals apart; ``rows`` in the columns of a measurement file."""

    text: str
    separates: Tuple[str, ...]
    expected_sigma: float
    rows: Tuple[Dict[str, Any], ...]


@dataclass(frozen=True)
class Detectable:
    """The smallest parameter of an effect that these rows could show; None where they show none."""

    effect: str
    parameter: str
    smallest: Optional[float]


@dataclass(frozen=True)
class Formula:
    """A formula for the rest, and the share of unseen rows that it explains."""

    formula: str
    share_unseen: float


@dataclass(frozen=True)
class Diagnosis:
    """The answer of ``vpost diagnose``; fields as in ``vpost.diagnosis/1``."""

    #: NO GAP, NAMED, AMBIGUOUS, PARTIAL, UNKNOWN, NOISE MODEL SUSPECT or UNDERPOWERED.
    verdict: str
    sentence: str
    gap: Gap
    where: Tuple[Place, ...]
    #: By share, the largest first.
    causes: Tuple[Cause, ...]
    #: Why no correction may be made of the causes; None where one may.
    withheld: Optional[str]
    setup: Setup
    leftover: Leftover
    holdout: Optional[Holdout]
    next_measurement: Optional[NextMeasurement]
    outlier_lines: Tuple[int, ...]
    detectable: Tuple[Detectable, ...]
    formulas: Tuple[Formula, ...]
    notes: Tuple[str, ...]
    #: The text that the command writes with ``--json``.
    json: str


#: A measurement table: its text, its rows, or its columns.
Rows = Union[str, bytes, Iterable[Mapping[str, Any]], Mapping[str, Any]]


def _made(kind: Any, value: Any) -> Any:
    """A value of a type out of JSON."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin is Union:
        return None if value is None else _made(inner[0], value)
    if origin is tuple:
        return tuple(_made(inner[0], one) for one in value)
    if isinstance(kind, type) and is_dataclass(kind):
        kinds = typing.get_type_hints(kind)
        made: Any = kind
        return made(**{f.name: _made(kinds[f.name], value[f.name.rstrip("_")]) for f in fields(kind)})
    return value


def _cell(value: Any, key: str, row: int) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        if any(mark in value for mark in ',;"\n\r'):
            raise ShapeError(f"{key}, row {row}: {value!r} does not fit into one cell")
        return value
    if isinstance(value, int):
        return str(value)
    if not math.isfinite(float(value)):
        raise NotFiniteError(f"{key}, row {row}: {value}; what was not measured is None")
    return repr(float(value))


def table(rows: Rows) -> bytes:
    """A measurement table as the text of a CSV file."""
    if isinstance(rows, bytes):
        return rows
    if isinstance(rows, str):
        return rows.encode("utf-8", "surrogateescape")
    if hasattr(rows, "to_dict") and hasattr(rows, "columns"):
        rows = {str(key): rows[key].tolist() for key in rows.columns}  # type: ignore[index]
    if isinstance(rows, Mapping):
        lengths = {key: len(column) for key, column in rows.items()}
        if len(set(lengths.values())) > 1:
            raise ShapeError(f"columns of different lengths: {lengths}")
        keys = list(rows)
        columns = [column.tolist() if hasattr(column, "tolist") else list(column) for column in rows.values()]
        lines = list(zip(*columns))
    else:
        listed = list(rows)
        keys = list(listed[0]) if listed else []
        for number, row in enumerate(listed):
            if set(row) != set(keys):
                raise ShapeError(f"row {number} has other columns than the first: {sorted(set(row) ^ set(keys))}")
        lines = [tuple(row[key] for key in keys) for row in listed]
    text: List[str] = [",".join(keys)]
    for number, line in enumerate(lines):
        text.append(",".join(_cell(value, key, number) for key, value in zip(keys, line)))
    return ("\n".join(text) + "\n").encode()


def diagnose(
    rows: Rows,
    profile: Path,
    *,
    holdout: Optional[Rows] = None,
    engine: Optional[str] = None,
    ignore_columns: Iterable[str] = (),
    as_written: bool = False,
    seed: int = 1,
    without: Iterable[str] = (),
    name: str = "measurements",
) -> Diagnosis:
    """Which effect that the profile lacks explains measurements, as ``vpost diagnose`` says it.

    Args:
        rows: The text of a measurement file, or its rows as mappings, or its columns (a mapping of arrays, a data
            frame). Columns and units as in docs/reference.md: ``run``, ``x_mm``, …, ``dx_um``, ….
        profile: Path of the machine profile (TOML).
        holdout: Rows that no fit may see.
        engine: Another engine than the exact product of transforms.
        ignore_columns: Columns to pass over.
        as_written: Take the columns as they are named, even where another sign fits better.
        seed: Of the random relabellings behind the p values of places.
        without: Effects to leave out of the library.
        name: What messages call the rows.

    Raises:
        ShapeError, NotFiniteError: The rows.
        Refused: As the command.
    """
    held = None if holdout is None else ("the hold-out", table(holdout))
    asked = (list(ignore_columns), as_written, seed, list(without))
    text = _vpost.diagnose((name, table(rows)), held, asked, options(profile, engine=engine))
    made: Diagnosis = _made(Diagnosis, {**json.loads(text), "json": text})
    return made
