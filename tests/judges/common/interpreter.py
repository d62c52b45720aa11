"""LinuxCNC's stand-alone interpreter, `rs274`, as a program: what its calls mean is for each judge to read."""

import os
import subprocess
import tempfile
from collections.abc import Mapping
from typing import NamedTuple

# Of the file of parameters: places of G28 and G30, and all from the offset of G92 to that of G59.3.
PARAMETERS = (*range(5161, 5170), *range(5181, 5190), *range(5210, 5390))


class Said(NamedTuple):
    """`whole`: the program was read to its end. `calls`: canonical calls, a line each."""

    whole: bool
    calls: str
    errors: str

    def trouble(self, length: int) -> str:
        return (self.calls + self.errors).strip()[-length:]


def parameters(values: Mapping[int, float]) -> str:
    """The file of parameters, G54 in force; 0 what is not named. Without a machine it counts in inches, as its tool
    table does."""
    return "".join(f"{k}\t{values.get(k, float(k == 5220)):.10f}\n" for k in PARAMETERS)


def interpret(text: str, tools: str, variables: str, seconds: float = 120) -> Said:
    """Reads a program with this tool table and this file of parameters."""
    with tempfile.TemporaryDirectory() as folder:
        for name, what in (("in.ngc", text), ("tool.tbl", tools), ("var", variables)):
            with open(os.path.join(folder, name), "w", encoding="latin-1", errors="replace", newline="") as out:
                out.write(what)
        # It keeps its tools in a file of the home folder: with one home, runs at the same time mix them.
        words = ["rs274", "-g", "-t", "tool.tbl", "-v", "var", "in.ngc"]
        home = {**os.environ, "HOME": folder}
        done = subprocess.run(words, input=b"", capture_output=True, timeout=seconds, cwd=folder, env=home, check=False)
    calls, errors = done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
    return Said("PROGRAM_END" in calls, calls, errors)
