"""Messages and exceptions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

Told = Tuple[str, str, str, str, Optional[str], Optional[str], Optional[int], Optional[int], str]


@dataclass(frozen=True)
class Message:
    """One message; ``docs/diagnostics.md`` has an entry for each code."""

    #: ``"error"``, ``"warning"``, or ``"doubt"``: a warning that ``strict`` turns into an error.
    severity: str
    #: ``"VP0204"``
    code: str
    #: What is wrong.
    message: str
    #: What is said at the place; may be empty.
    label: str
    #: What to do.
    help: Optional[str]
    #: The text it is about, by the name that was given.
    file: Optional[str]
    #: From 1.
    line: Optional[int]
    #: From 1.
    column: Optional[int]
    #: All of it, as the command prints it.
    text: str

    def __str__(self) -> str:
        return self.text


def messages(told: Sequence[Told]) -> Tuple[Message, ...]:
    """Messages of what the compiled half tells."""
    return tuple(Message(*one) for one in told)


class Error(Exception):
    """What this package raises."""


class Refused(Error):
    """A program, a profile, an option or a measurement was refused.

    ``str()`` of it is what the command prints on standard error.
    """

    #: All messages, in the order in which the command prints them.
    messages: Tuple[Message, ...]

    def __init__(self, text: str, told: Sequence[Told] = ()) -> None:
        super().__init__(text)
        self.messages = messages(told)

    @property
    def codes(self) -> List[str]:
        """Codes of the messages: ``["VP0204"]``."""
        return [message.code for message in self.messages]


class ShapeError(Error, ValueError):
    """An array has another shape than is asked for."""


class UnitsError(Error, ValueError):
    """Numbers that are in another unit than is asked for."""


class NotFiniteError(Error, ValueError):
    """A number is NaN or infinite."""
