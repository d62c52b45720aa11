"""What `calibrate rtest` says: JSON and report, read leniently where the interface leaves the form open.

`terms` {EX0C: (value, half width of its 95 % interval)}; `open_names`: deviations that are said to be open or not told apart;
`written` {name: whether the profile has it}; `holdout`: RMS of the held-out rows after, um.
"""

import json
import re
from dataclasses import dataclass, field

NAME = r"E[XYZABC]0?[ABC]"


@dataclass
class Answer:
    terms: dict = field(default_factory=dict)
    written: dict = field(default_factory=dict)
    open_names: set = field(default_factory=set)
    holdout: float = None


def names(thing):
    """Every deviation that a piece of JSON names, EXC, EX0C …"""
    return set(re.findall(rf"\b(?:rotary\.[ABC]\.)?({NAME})(?![A-Za-z0-9])", re.sub(r"_(um|urad)\b", "", json.dumps(thing))))


def walk(thing, path=()):
    yield path, thing
    if isinstance(thing, dict):
        for key, value in thing.items():
            yield from walk(value, path + (str(key),))
    elif isinstance(thing, list):
        for value in thing:
            yield from walk(value, path)


def number(one, *keys):
    return next((float(one[k]) for k in keys if isinstance(one.get(k), (int, float))), None)


def read(path, report):
    out = Answer()
    with open(path, encoding="utf-8") as file:
        found = json.load(file)
    for at, thing in walk(found):
        if isinstance(thing, dict) and isinstance(thing.get("name"), str):
            located = re.fullmatch(r"(?:rotary\.[ABC]\.)?(E[XYZABC]0[ABC])(_um|_urad)?", thing["name"])
            value, half = number(thing, "value", "value_um", "value_urad", "change"), number(thing, "u95", "half", "half_width", "U95", "u95_um", "u95_urad")
            half = 1.96 * thing["u"] if half is None and isinstance(thing.get("u"), (int, float)) else half
            if located and value is not None and half is not None:
                out.terms[located[1]] = (value, half)
                if "written" in thing:
                    out.written[located[1]] = bool(thing["written"])
        if at and re.search(r"not_told|not_seen|counted_as|open|unidentif|not_identif|cannot|hidden|null|unknown", at[-1]):
            out.open_names |= names(thing)
        if at and at[-1] == "holdout" and isinstance(thing, dict):
            out.holdout = number(thing, "rms_after_um", "after_um")
    for line in report.splitlines():
        if re.search(r"cannot be told|not told|told apart|is open|stays? (as|what)|not written|no information|not shown|cannot be seen", line):
            out.open_names |= names(line)
    return out
