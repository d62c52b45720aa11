"""Points: predict, solve, map."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Iterable, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _vpost
from ._arrays import commands, table
from ._diagnosis import Rows
from ._diagnosis import table as rows_as_csv
from ._messages import Message, ShapeError, messages
from ._options import Path, number, options, spelt, three


@dataclass(frozen=True)
class Predicted:
    """Where the tool really is."""

    #: (n, 3), mm, machine frame, or the measuring frame with ``include_setup``.
    position_mm: np.ndarray
    #: (n, 3), µm: position minus command.
    error_um: np.ndarray
    #: (n,), µm: length of the error.
    distance_um: np.ndarray
    #: (n,): inside the calibrated volume. Outside, a point has the error of the nearest one inside.
    inside: np.ndarray
    #: (n, 3): the tool's real direction as the workpiece sees it, from the tip up; of machines with rotary axes.
    direction: Optional[np.ndarray]
    #: (n,), µrad: its angle from the ideal one.
    tilt_urad: Optional[np.ndarray]
    #: What the command warns of.
    warnings: Tuple[Message, ...]


@dataclass(frozen=True)
class Solved:
    """What to command."""

    #: (n, 3), mm, machine frame. Rotary axes are commanded as they were asked for.
    command_mm: np.ndarray
    #: (n,): steps of the iteration.
    iterations: np.ndarray
    #: (n,), µm: what is left.
    residual_um: np.ndarray
    #: (n, 3): the tool's real direction, of machines with rotary axes.
    direction: Optional[np.ndarray]
    #: (n,), µrad: its angle from the ideal one.
    tilt_urad: Optional[np.ndarray]


@dataclass(frozen=True)
class ErrorMap:
    """The error at the nodes of a grid."""

    #: (nx,), (ny,), (nz,), mm.
    x_mm: np.ndarray
    y_mm: np.ndarray
    z_mm: np.ndarray
    #: (nx, ny, nz, 3), µm.
    error_um: np.ndarray
    #: Figures, zero points, places: the JSON of ``vpost map --json``.
    summary: Dict[str, Any]
    #: What the command warns of.
    warnings: Tuple[Message, ...]


@dataclass(frozen=True)
class Budget:
    """What each deviation costs, what they may come to together, and what each may be."""

    #: All figures: the JSON of ``vpost budget --json``.
    figures: Dict[str, Any]
    #: Its text.
    json: str
    #: What the command warns of.
    warnings: Tuple[Message, ...]


def _turned(data: bytes) -> Tuple[Optional[np.ndarray], Optional[np.ndarray]]:
    if not data:
        return None, None
    rows = table(data, 4)
    return rows[:, :3], rows[:, 3]


def predict(
    profile: Path,
    points: Any,
    *,
    rotary_deg: Any = None,
    tool_mm: Any = None,
    direction: Any = None,
    include_setup: bool = False,
    engine: Optional[str] = None,
    at: Optional[Mapping[str, float]] = None,
    outside: Optional[str] = None,
) -> Predicted:
    """Where the machine goes for commanded points, as ``vpost predict`` says it.

    Args:
        profile: Path of the machine profile (TOML).
        points: (n, 3), axis commands X, Y, Z, mm, machine coordinates.
        rotary_deg: (n, 3) or (3,), A, B, C, degrees; 0 where nothing is given.
        tool_mm: (n, 3) or (3,), from gauge point to tip, mm; the profile's where nothing is given.
        direction: (n, 3) or (3,), direction of approach, -1, 0 or 1.
        include_setup: Positions in the measuring frame: by the profile's ``[setup]``.
        engine: Another engine than the exact product of transforms.
        at: Conditions, ``{"temp_c": 24.0}``.
        outside: ``"refuse"`` for points outside the calibrated volume.

    Raises:
        ShapeError, UnitsError, NotFiniteError: The arrays.
        Refused: As the command.
    """
    _, arrays = commands(points, rotary_deg, tool_mm, direction)
    words = options(profile, engine=engine, at=at, outside=outside)
    position, error, inside, turned, told = _vpost.predict(arrays, include_setup, words)
    errors = table(error, 4)
    tool, tilt = _turned(turned)
    return Predicted(
        table(position, 3), errors[:, :3], errors[:, 3], np.array(inside, dtype=bool), tool, tilt, messages(told)
    )


def solve(
    profile: Path,
    points: Any,
    *,
    rotary_deg: Any = None,
    tool_mm: Any = None,
    direction: Any = None,
    engine: Optional[str] = None,
    at: Optional[Mapping[str, float]] = None,
) -> Solved:
    """What to command so that the tool reaches points, as ``vpost solve`` says it.

    Args:
        points: (n, 3), where the tool is to go as ideal axes would be commanded, mm, machine coordinates.
        engine: Another engine than the profile's.

    The others are those of :func:`predict`.
    """
    _, arrays = commands(points, rotary_deg, tool_mm, direction)
    command, iterations, residual, turned = _vpost.solve(arrays, options(profile, engine=engine, at=at))
    tool, tilt = _turned(turned)
    return Solved(
        table(command, 3), np.array(iterations, dtype=int), table(residual, 1)[:, 0], tool, tilt
    )


def _angles(rotary_deg: Optional[Mapping[str, float]]) -> Optional[str]:
    return ",".join(f"{axis}={number(deg, axis)}" for axis, deg in (rotary_deg or {}).items()) or None


def _grid(grid: Union[str, Sequence[int]]) -> str:
    if isinstance(grid, str):
        return grid
    if len(grid) != 3:
        raise ShapeError(f"grid has {len(grid)} numbers, expected are 3: nodes along X, Y and Z")
    return "x".join(str(int(count)) for count in grid)


def map(  # noqa: A001: the command's name
    profile: Path,
    *,
    grid: Union[str, Sequence[int]] = (21, 21, 21),
    tool_mm: Optional[Union[str, Sequence[float]]] = None,
    rotary_deg: Optional[Mapping[str, float]] = None,
    within_um: Optional[float] = None,
    region: Optional[Mapping[str, str]] = None,
    plane: Iterable[str] = (),
    part_box: Optional[str] = None,
    clamp_mm: Optional[Sequence[float]] = None,
    second_order: bool = False,
    engine: Optional[str] = None,
    at: Optional[Mapping[str, float]] = None,
    outside: Optional[str] = None,
) -> ErrorMap:
    """The error over the calibrated volume, as ``vpost map`` says it.

    Args:
        profile: Path of the machine profile (TOML).
        grid: Numbers of nodes along X, Y, Z, or from:to:step of each in mm, ``"40:880:40,30:450:20,5:505:25"``.
        tool_mm: From gauge point to tip, mm, or an H number of the profile; the profile's where nothing is given.
        rotary_deg: Where rotary axes stand, ``{"C": 90.0}``, degrees; 0 where nothing is given.
        within_um: Tolerance for the share of nodes within it, µm.
        region: Parts of the volume to give figures and zero points for, mm: ``{"left": "0..400,0..280,0..200"}``.
        plane: The same for layers of nodes: ``["XY=100", "XZ"]``.
        part_box: The same for a workpiece, where its axis commands lie, mm: ``"10..90,10..60,5..40"``.
        clamp_mm: Find the place for a workpiece of this size, mm.
        second_order: At which angles products of errors begin to matter.
        engine: Another engine than the exact product of transforms.
        at: Conditions, ``{"temp_c": 24.0}``.
        outside: ``"clamp"`` for a grid that reaches outside the calibrated volume.

    Raises:
        ShapeError, NotFiniteError: The numbers.
        Refused: As the command.
    """
    words = options(profile, engine=engine, at=at, outside=outside) + spelt(
        grid=_grid(grid),
        tool_vector=tool_mm if tool_mm is None or isinstance(tool_mm, str) else three(tool_mm, "tool_mm"),
        rotary=_angles(rotary_deg),
        within=within_um,
        region=[f"{name}={box}" for name, box in (region or {}).items()],
        plane=list(plane),
        part_box=part_box,
        clamp=None if clamp_mm is None else three(clamp_mm, "clamp_mm"),
        second_order=second_order,
    )
    nodes, error, summary, told = _vpost.map(words)
    x, y, z = (np.array(places) for places in nodes)
    # X runs fastest.
    errors = table(error, 3).reshape(len(z), len(y), len(x), 3).transpose(2, 1, 0, 3) * 1e3
    return ErrorMap(x, y, z, errors, json.loads(summary), messages(told))


def budget(
    profile: Path,
    *,
    grid: Optional[Union[str, Sequence[int]]] = None,
    points: Optional[Rows] = None,
    ball: Optional[str] = None,
    tool_mm: Optional[Union[str, Sequence[float]]] = None,
    rotary_deg: Optional[Mapping[str, float]] = None,
    datum: Optional[str] = None,
    target_um: Optional[float] = None,
    keep: Iterable[str] = (),
    at: Optional[Mapping[str, float]] = None,
    outside: Optional[str] = None,
) -> Budget:
    """What each deviation of a machine costs, as ``vpost budget`` says it.

    Args:
        profile: Path of the machine profile (TOML).
        grid: Control points: nodes along X, Y, Z, as of :func:`map`; 21 each where nothing is given.
        points: Control points instead: the text of a file for ``vpost predict``, its rows, or its columns.
        ball: Control points instead: a ball on the rotary table, ``"R=100,H=50,lead=C"``.
        tool_mm: From gauge point to tip, mm, or an H number of the profile; the profile's where nothing is given.
        rotary_deg: Where rotary axes stand at the nodes of the grid, degrees.
        datum: The zero of the profile from which errors count, ``"G54"``.
        target_um: Wanted largest error, µm: what to mend, and what each deviation may be.
        keep: Deviations that stay as they are, ``["EXX"]``.
        at: Conditions, ``{"temp_c": 24.0}``.
        outside: ``"clamp"`` for points outside the calibrated volume.

    Raises:
        ShapeError, NotFiniteError: The numbers.
        Refused: As the command.
    """
    words = options(profile, at=at, outside=outside) + spelt(
        grid=None if grid is None else _grid(grid),
        points=None if points is None else "points",
        ball=ball,
        tool_vector=tool_mm if tool_mm is None or isinstance(tool_mm, str) else three(tool_mm, "tool_mm"),
        rotary=_angles(rotary_deg),
        datum=datum,
        target=target_um,
        keep=list(keep),
    )
    files = [] if points is None else [("points", rows_as_csv(points))]
    figures, told = _vpost.budget(files, words)
    return Budget(json.loads(figures), figures, messages(told))
