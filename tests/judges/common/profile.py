"""Profiles of machines as data: sections with their keys (docs/reference.md), and tables of errors beside them."""

import json
import os
import pathlib
import re
from collections.abc import Iterable, Mapping

from . import folders


def value(what: object) -> str:
    """In TOML: numbers by all their digits, arrays, tables in line."""
    what = what.tolist() if hasattr(what, "tolist") else what
    if isinstance(what, bool):
        return str(what).lower()
    if isinstance(what, str):
        return json.dumps(what, ensure_ascii=False)
    if isinstance(what, Mapping):
        return "{ " + ", ".join(f"{key(k)} = {value(v)}" for k, v in what.items()) + " }"
    if isinstance(what, Iterable):
        return "[" + ", ".join(map(value, what)) + "]"
    return repr(what)


def key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.A) else json.dumps(name)


def column(error: str) -> str:
    """A column or key of an error, by the letters of ISO 230-1, with its unit: `EXY_um`, `EA0C_urad`."""
    return f"{error}_{'um' if error[1] in 'XYZ' else 'urad'}"


def six(axis: str) -> list[str]:
    """Columns of an axis' table: three displacements, three angles."""
    return [column(f"E{c}{axis}") for c in "XYZABC"]


class Profile:
    """Sections are made as they are asked for: `profile["tool"]["default_mm"] = [0, 0, -100]`. None is no value."""

    def __init__(self, name: str, control: str, chain: str):
        self.sections: dict[str, dict] = {"": {"format": 1, "name": name, "control": control, "chain": chain}}
        self.effects: list[Mapping] = []
        self.tables: dict[tuple[str, str], list[list[str]]] = {}

    def __getitem__(self, section: str) -> dict:
        return self.sections.setdefault(section, {})

    def axis(self, name: str) -> dict:
        return self[f"{'rotary' if name in 'ABC' else 'axis'}.{name}"]

    def errors(
        self,
        axis: str,
        places: Iterable[float],
        rows: Iterable[Iterable[float]],
        under: str = "errors",
        digits: str = "",
        columns: Iterable[str] = (),
    ) -> None:
        """A table of an axis, um and urad. `digits`: of its numbers, such as `.6f`, all of them if not given;
        `columns`: six of them if not given."""
        head = ["position_deg" if axis in "ABC" else "position_mm", *(columns or six(axis))]
        shown = (lambda v: format(v, digits)) if digits else (lambda v: repr(float(v)))
        self.tables[axis, under] = [head, *([shown(v) for v in (at, *row)] for at, row in zip(places, rows))]

    def located(self, axis: str, errors: Mapping[str, float]) -> None:
        """Errors of the place of a rotary axis, um and urad."""
        self.axis(axis).update({column(name): size for name, size in errors.items()})

    def text(self) -> str:
        lines = []
        for title, entries in [*self.sections.items(), *(("[effect]", effect) for effect in self.effects)]:
            said = [f"{key(name)} = {value(what)}" for name, what in entries.items() if what is not None]
            lines += [f"[{title}]"] * bool(title and said) + said
        return "\n".join(lines) + "\n"

    def write(self, folder: str | os.PathLike, name: str = "profile.toml") -> pathlib.Path:
        """Writes the profile and, named after it, its tables; returns its path."""
        for (axis, under), (head, *rows) in self.tables.items():
            file = f"{pathlib.Path(name).stem}_{under}_{axis.lower()}.csv"
            folders.table(os.path.join(folder, file), head, rows)
            self.axis(axis)[under] = file
        return pathlib.Path(folders.put(folder, name, self.text()))


def crooked_mill(control: str) -> Profile:
    """A mill that is out of square by tens of microradians: some 0.025 mm over 400 mm."""
    mill = Profile("Judge's machine (invented)", control, "[w X Y b Z t]")
    for name in "XYZ":
        mill.axis(name)["travel_mm"] = [-2000, 2000]
    mill["squareness"].update(EC0Y_urad=60.0, EB0Z_urad=-50.0, EA0Z_urad=40.0)
    return mill
