"""Programs: correct and check."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Optional, Tuple, Union, overload

from . import _vpost
from ._messages import Message, messages
from ._options import Path, options

Text = Union[str, bytes]


def encoded(text: Text) -> bytes:
    """Bytes of a program; those that were no UTF-8 come back by ``errors="surrogateescape"``."""
    return text if isinstance(text, bytes) else text.encode("utf-8", "surrogateescape")


@dataclass(frozen=True)
class Corrected:
    """A corrected program."""

    #: The program; bytes where bytes were given.
    text: Any
    #: False where nothing needed correction; ``text`` is the input then.
    changed: bool
    #: Blocks of the input.
    blocks_in: int
    #: Blocks of the output.
    blocks_out: int
    #: Motions that were split.
    splits: int
    #: Longest correction of a point, µm.
    largest_correction_um: float
    #: How far the tool is off its path at most without the correction, µm: a bound.
    deviation_before_um: float
    #: The same with it, µm.
    deviation_after_um: float
    #: How far the control itself leaves the path at corners, µm; None where nobody says.
    control_um: Optional[float]
    #: What the command warns of.
    warnings: Tuple[Message, ...]
    #: All figures: the JSON of ``vpost correct --summary``.
    summary: Dict[str, Any]


@dataclass(frozen=True)
class Checked:
    """Two programs, and whether they cut alike."""

    #: True where ``findings`` is empty.
    passed: bool
    #: The tolerance that was asked for, µm.
    tolerance_um: float
    #: What the tool may be off its path, rounding of the output included, µm.
    limit_um: float
    #: Feed motions of the original.
    feed_motions_in: int
    #: Feed motions of the corrected program.
    feed_motions_out: int
    #: Moves that the correction put in.
    approach_moves: int
    #: How far the tool is off its path at most by the original, µm, and in which line.
    deviation_before_um: float
    deviation_before_line: int
    #: The same by the corrected program.
    deviation_after_um: float
    deviation_after_line: int
    #: How far the control leaves the corrected path at corners, µm; None where nobody says.
    control_um: Optional[float]
    #: What is wrong.
    findings: Tuple[str, ...]
    #: What the command prints.
    text: str
    #: What the command warns of.
    warnings: Tuple[Message, ...]
    #: Lines that cannot be held within the tolerance, and were held against what is proven of them.
    accepted_lines: int = 0
    #: Touched zeros from which deviations count.
    datums: Tuple[Dict[str, Any], ...] = ()


@overload
def correct(text: str, profile: Path, *, name: str = ..., force: bool = ..., **asked: Any) -> Corrected: ...
@overload
def correct(text: bytes, profile: Path, *, name: str = ..., force: bool = ..., **asked: Any) -> Corrected: ...
def correct(
    text: Text, profile: Path, *, name: str = "program", force: bool = False, **asked: Any
) -> Corrected:
    """Correct a program, as ``vpost correct`` does: the same bytes, the same refusals.

    Args:
        text: The program. ``str`` in gives ``str`` out, line ends as they are: open files with ``newline=""``.
        profile: Path of the machine profile (TOML).
        name: What messages call the program.
        force: Correct a program that says it was corrected before.
        **asked: Options of the command: ``dialect`` (a name or a grammar file), ``engine``, ``tolerance_um`` (µm),
            ``work_offset`` (``{"G54": (x, y, z)}``, mm), ``tool`` (``{"H1": 120.0}``, mm), ``start_at`` (mm),
            ``variables`` (``{"#500": 12.5}``), ``include`` (folders of subprograms), ``decimal``
            (``"increments"`` or ``"millimetres"``), ``at`` (``{"temp_c": 24.0}``), ``outside`` (``"refuse"`` or
            ``"clamp"``), ``strict``, ``guard``, ``path_control`` (``"keep"``, ``"tolerance"`` or ``"exact"``).

    Raises:
        Refused: With the text that the command prints.
    """
    out, summary, told = _vpost.correct(encoded(text), name, options(profile, **asked), force)
    figures = json.loads(summary)
    names = (
        "changed blocks_in blocks_out splits largest_correction_um "
        "deviation_before_um deviation_after_um control_um".split()
    )
    return Corrected(
        text=out if isinstance(text, bytes) else out.decode("utf-8", "surrogateescape"),
        warnings=messages(told),
        summary=figures,
        **{name: figures[name] for name in names},
    )


def check(
    original: Text,
    corrected: Text,
    profile: Path,
    *,
    names: Tuple[str, str] = ("original", "corrected"),
    **asked: Any,
) -> Checked:
    """Run both programs through the machine model and compare what they make of the part, as ``vpost check`` does.

    Args:
        original: The program as posted.
        corrected: The corrected program.
        profile: Path of the machine profile (TOML).
        names: What messages call the two.
        **asked: As of :func:`correct`.

    Raises:
        Refused: A program cannot be read. Programs that differ are no exception: see ``passed``.
    """
    texts = tuple(zip(names, (encoded(original), encoded(corrected))))
    result, text, told = _vpost.check(texts[0], texts[1], options(profile, **asked))
    figures = json.loads(result)
    del figures["schema"]
    figures["findings"] = tuple(figures["findings"])
    figures["datums"] = tuple(figures.get("datums", ()))
    return Checked(text=text, warnings=messages(told), **figures)
