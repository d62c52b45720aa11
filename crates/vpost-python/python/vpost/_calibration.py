"""Calibration: from an instrument's files to a machine profile."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any, Dict, Iterable, Mapping, Optional, Sequence, Tuple, Union

from . import _vpost
from ._diagnosis import Rows
from ._diagnosis import table as as_csv
from ._messages import Message, messages
from ._options import Path, options, spelt, three

#: Instruments that have a JSON of what was found.
_WITH_FIGURES = ("interferometer", "ballbar", "rtest", "turning")


@dataclass(frozen=True)
class Calibration:
    """What was found, and the profile that it makes."""

    #: What the command prints.
    report: str
    #: The profile (TOML) that ``output`` asked for; None without it.
    profile: Optional[str]
    #: Its tables: name relative to the profile, text.
    tables: Dict[str, bytes]
    #: The JSON of ``vpost calibrate … --json``; None of instruments without it.
    figures: Optional[Dict[str, Any]]
    #: What the command warns of.
    warnings: Tuple[Message, ...]
    #: The file name of the profile.
    output: Optional[str]

    def save(self, folder: Path) -> FilePath:
        """Write the profile and its tables into a folder; the path of the profile."""
        if self.profile is None or self.output is None:
            raise ValueError("no profile was made: ask for one with output=")
        path = FilePath(folder) / self.output
        for name, text in self.tables.items():
            table = path.parent / name
            table.parent.mkdir(parents=True, exist_ok=True)
            table.write_bytes(text)
        path.write_bytes(self.profile.encode())
        return path


def calibrate(
    instrument: str,
    files: Mapping[str, Rows],
    *,
    profile: Optional[Path] = None,
    output: Optional[str] = None,
    after: Optional[Rows] = None,
    holdout: Optional[Rows] = None,
    crossing_mm: Optional[Sequence[float]] = None,
    ignore_columns: Iterable[str] = (),
    dialect: Optional[Path] = None,
    engine: Optional[str] = None,
    at: Optional[Mapping[str, float]] = None,
    **asked: Union[None, bool, float, str],
) -> Calibration:
    """A machine profile from what an instrument read, as ``vpost calibrate`` makes it.

    Args:
        instrument: ``"tracker"``, ``"interferometer"``, ``"volumetric"``, ``"ballbar"``, ``"rtest"`` or ``"turning"``.
        files: Measurements by name, in the order of the command: the text of a file, its rows, or its columns. The name
            of an interferometer's file may say what it holds: ``{"x.rtl=EXX:um": text}``.
        profile: Path of the base profile (TOML).
        output: File name of the profile that is to be made, ``"made.toml"``; its tables go to ``made/`` beside it.
        after: Ball bar: the same tests after a compensation.
        holdout: R-test and turning: rows that no fit may see.
        crossing_mm: Ball bar: a point through which the axes of the table should go.
        ignore_columns: Columns to pass over.
        dialect: Of the control of a new profile.
        engine: The engine that a tracker's traverses are to serve.
        at: Conditions, ``{"temp_c": 24.0}``.
        **asked: The other options of the command, with underscores: ``chain="[w X Y b Z t]"``, ``name``,
            ``date="2026-05-15"``, ``temperature=20.0``, ``instrument`` under the name ``measured_with``, ``against``,
            ``squareness="XY=12"``, ``squareness_convention``, ``nodes=5``, ``sphere=True``.

    Raises:
        ShapeError, NotFiniteError: The rows.
        Refused: As the command; nothing is made then.
    """
    specified = instrument == "interferometer"
    given = [(specified and name.rpartition("=")[0] or name, as_csv(rows)) for name, rows in files.items()]
    given += [(name, as_csv(rows)) for name, rows in (("after", after), ("holdout", holdout)) if rows is not None]
    asked["instrument"] = asked.pop("measured_with", None)
    own = spelt(
        output=output,
        after=None if after is None else "after",
        holdout=None if holdout is None else "holdout",
        crossing=None if crossing_mm is None else three(crossing_mm, "crossing_mm"),
        ignore_column=list(ignore_columns),
        json="figures" if instrument in _WITH_FIGURES else None,
        **asked,
    )
    words = [instrument, *files, *own, *options(profile, dialect=dialect, engine=engine, at=at)]
    report, made, found, told = _vpost.calibrate(given, words)
    text, folder, tables = made or (None, "", [])
    return Calibration(
        report=report,
        profile=text,
        tables={f"{folder}/{name}": table for name, table in tables},
        figures=None if found is None else json.loads(found),
        warnings=messages(told),
        output=output,
    )
