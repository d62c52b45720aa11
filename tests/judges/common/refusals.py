"""Bad input: each mistake is refused in words about it, with a number, and nothing is written."""

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from .command import first_error, run


def asked(
    vpost: Sequence[str],
    keep: str,
    cases: Mapping[str, tuple[str, bool]],
    prepare: Callable[[str, str], list[str]],
    written: Iterable[str],
    bare: Iterable[str] = (),
    alike: Iterable[str] = (),
) -> int:
    """Gives each mistake to the command; 1 where an answer is wrong.

    `cases`: name -> (words that are wanted of the message, whether the input may also be taken and what is poor of it
    said). `prepare`: (name, folder) -> words of the command. `written`: files that a refusal may not leave. `bare`:
    cases that may be refused without a number; `alike`: cases that may have the message of another.
    """
    bad, said = 0, {}
    for name, (words, poor) in cases.items():
        folder = os.path.join(keep, name)
        os.makedirs(folder, exist_ok=True)
        targets = [os.path.join(folder, file) for file in written]
        for path in filter(os.path.exists, targets):
            os.remove(path)
        status, out, error = run(vpost, *prepare(name, folder), folder=folder)
        first = first_error(error) or (error or out).strip()[:200]
        found = re.search(r"error\[(VP\d{4})\]", error)
        wrong = [f"exit status {status}"] if status not in (0, 1, 2) or "panicked" in error else []
        wrong += ["taken"] if status == 0 and not poor else []
        wrong += ["no code"] if status and not found and name not in bare else []
        left = [os.path.basename(path) for path in filter(os.path.exists, targets)]
        wrong += [f"refused and yet written: {', '.join(left)}"] if status and left else []
        wrong += [] if re.search(words, error if status else out + error) else ["not a word of it"]
        if status and found and name not in alike:
            said.setdefault((found[1], re.sub(r"[\d.:]+", "#", first)), []).append(name)
        bad += bool(wrong)
        mark, why = ("WRONG", ", ".join(wrong) + ": ") if wrong else ("ok   ", "")
        print(f"{mark} {name:27} {status} {why}{first[:170]}", flush=True)
    for (code, _), many in said.items():
        if len(many) > 1:
            print(f"      one message for {', '.join(many)}: {code}")
    return int(bool(bad))
