"""Arrays of points: shapes, units and numbers are seen to here; the compiled half takes bytes."""

from __future__ import annotations

from typing import Any, List, Optional, Tuple

import numpy as np

from ._messages import NotFiniteError, ShapeError, UnitsError

#: A kilometre: no machine is larger.
FARTHEST_MM = 1e6
#: Ten thousand turns.
MOST_DEG = 3.6e6


def rows(values: Any, what: str, count: Optional[int] = None) -> np.ndarray:
    """An array of shape (n, 3) of finite doubles; one row of three stands for all ``count``."""
    if any(hasattr(values, name) for name in ("unit", "units")):
        raise UnitsError(f"{what} carries a unit: give plain numbers, lengths in mm, angles in degrees")
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise UnitsError(f"{what} holds {array.dtype}: give plain numbers, lengths in mm, angles in degrees")
    array = array.astype("<f8")
    if count is not None and array.shape == (3,):
        array = np.broadcast_to(array, (count, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise ShapeError(f"{what} has shape {array.shape}, expected is (n, 3)")
    if count is not None and len(array) != count:
        raise ShapeError(f"{what} has {len(array)} rows, and there are {count} points")
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise NotFiniteError(f"{what}: row {row} holds {array[row].tolist()}")
    return np.ascontiguousarray(array)


def below(array: np.ndarray, most: float, what: str, unit: str) -> None:
    """Refuses numbers that no machine has in this unit."""
    if array.size and np.abs(array).max() > most:
        row = int(np.abs(array).max(axis=1).argmax())
        raise UnitsError(f"{what}: row {row} holds {array[row].tolist()}; are these {unit}?")


def commands(points: Any, rotary_deg: Any, tool_mm: Any, direction: Any) -> Tuple[int, List[bytes]]:
    """Number of points, and the arrays of them as bytes."""
    position = rows(points, "points")
    below(position, FARTHEST_MM, "points", "mm")
    count = len(position)
    rotary = rows((0.0, 0.0, 0.0) if rotary_deg is None else rotary_deg, "rotary_deg", count)
    below(rotary, MOST_DEG, "rotary_deg", "degrees")
    tool = b""
    if tool_mm is not None:
        vectors = rows(tool_mm, "tool_mm", count)
        below(vectors, FARTHEST_MM, "tool_mm", "mm")
        tool = vectors.tobytes()
    signs = rows((0, 0, 0) if direction is None else direction, "direction", count)
    if not np.isin(signs, (-1.0, 0.0, 1.0)).all():
        raise UnitsError("direction holds signs alone: -1, 0 or 1 for each axis")
    return count, [position.tobytes(), rotary.tobytes(), tool, signs.tobytes()]


def table(data: bytes, columns: int) -> np.ndarray:
    """An array of rows of this many doubles."""
    return np.frombuffer(data, dtype="<f8").reshape(-1, columns).astype(float)
