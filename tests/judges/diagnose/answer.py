"""Asks the command and reads its answer. What the documents do not fix and the judge has to assume stands here and in README.md."""

import json
import os
import re
import shlex

import numpy

from common import command

NAMING = ("NAMED", "PARTIAL", "AMBIGUOUS")
INSTRUMENT = re.compile(r"instrument|probe|tracker|station|interferometer|abbe|cosine|dead-path", re.I)


class Answer:
    """What `vpost diagnose` said: status, data (None where refused), out, err, written (text of the written profile or None)."""

    def __init__(self, status, data, out="", err="", written=None, base=""):
        self.status, self.data, self.out, self.err, self.written, self.base = status, data, out, err, written, base
        self.codes = re.findall(r"error\[(VP\d+)\]", err)

    @property
    def verdict(self):
        return self.data["verdict"] if self.data else "refused " + "+".join(self.codes or [str(self.status)])

    @property
    def causes(self):
        return [c["effect"] for c in self.data.get("causes", [])] if self.data else []

    def rivals(self, k=0):
        return list(self.data["causes"][k].get("cannot_be_told_from", [])) if self.data and len(self.data.get("causes", [])) > k else []

    @property
    def named(self):
        return self.verdict == "NAMED"

    @property
    def alarm(self):
        """A cause is put forward to be acted on."""
        return self.verdict in NAMING and bool(self.causes)

    def cause(self, effect):
        for cause in self.data.get("causes", []) if self.data else []:
            if cause["effect"] == effect:
                return cause
        return None

    def parameter(self, effect, name):
        """(value, u95) or None."""
        for p in (self.cause(effect) or {}).get("parameters", []):
            if p["name"] == name and p.get("u95") is not None:
                return p["value"], p["u95"]
        return None

    @property
    def effects_written(self):
        """Ids of the effects written beyond those of the profile; the instrument's, which are no part of any correction, do not count."""
        ids = [re.findall(r'^id = "(.*?)"', text or "", re.M) for text in (self.written, self.base)]
        return [i for i in ids[0] if i not in ids[1] and not INSTRUMENT.search(i)]

    @property
    def forecast(self):
        """Predicted shrinkage with all causes in the model, or None."""
        causes = self.data.get("causes", []) if self.data else []
        return causes[-1]["shrink_predicted"]["mid"] if causes and causes[-1].get("shrink_predicted") else None

    def texts(self):
        """Every text of the answer in the order of its JSON."""
        def walk(value):
            if isinstance(value, str):
                yield value
            for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
                yield from walk(inner)
        return list(walk(self.data or {}))

    def formulas(self):
        """Formulas proposed, best first, as the issue writes them (`dx ~ dir_x·(y-140)`): those of a list `formulas`, else any text that holds one."""
        listed = [t for key, v in (self.data or {}).items() if "formula" in key for t in Answer(0, {"v": v}).texts()]
        found = []
        for text in listed or self.texts():
            for formula in re.findall(r"\bd[xyz]\s*[~≈∼].*", text):
                if formula not in found:
                    found.append(formula)
        return found


COLUMN = {
    "x": r"(?<![a-z_])x(?:_mm)?(?![a-z_])", "y": r"(?<![a-z_])y(?:_mm)?(?![a-z_])", "z": r"(?<![a-z_])z(?:_mm)?(?![a-z_])",
    "dir_x": r"dir_x", "dir_y": r"dir_y", "dir_z": r"dir_z", "load": r"load", "temp": r"temp", "time": r"\btime|\bt\b", "feed": r"feed",
}


def columns_of(formula):
    right = re.split(r"[~≈∼]", formula, maxsplit=1)[1].lower()
    return {name for name, pattern in COLUMN.items() if re.search(pattern, right)}


def ask(vpost, folder, measurements, profile, holdout=None, write=True, options=()):
    """Runs the diagnosis; its files stay in the folder."""
    arguments = [vpost, "diagnose", measurements, "-m", profile, "--json", os.path.join(folder, "answer.json"), *options]
    written = os.path.join(folder, "written.toml")
    for old in (written, os.path.join(folder, "answer.json")):
        if os.path.exists(old):
            os.remove(old)
    if holdout:
        arguments += ["--holdout", holdout]
    if write:
        arguments += ["--write-profile", written]
    status, out, err = command.ask(*arguments, seconds=120)
    with open(os.path.join(folder, "command.txt"), "a", encoding="utf-8") as file:
        file.write(shlex.join([os.path.basename(str(a)) if str(a).startswith(folder) else str(a) for a in arguments]) + f"    # exit {status}\n{out}{err}\n")
    data = None
    if status == 0 and os.path.exists(os.path.join(folder, "answer.json")):
        with open(os.path.join(folder, "answer.json"), encoding="utf-8") as file:
            data = json.load(file)
    with open(profile, encoding="utf-8") as file:
        base = file.read()
    text = None
    if os.path.exists(written):
        with open(written, encoding="utf-8") as file:
            text = file.read()
    return Answer(status, data, out, err, text, base)


def predict(vpost, profile, q, tool, dirs, folder, at=None, setup=False):
    """Real minus ideal tool position in mm, (n, 3), by `vpost predict`; raises RuntimeError where it refuses."""
    path = os.path.join(folder, "points.csv")
    with open(path, "w", encoding="utf-8") as file:
        file.write("x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dir_x,dir_y,dir_z\n")
        for a, b, c in zip(q, tool, dirs):
            file.write(",".join(f"{v:.6f}" for v in (*a, *b)) + "," + ",".join(str(int(v)) for v in c) + "\n")
    arguments = [vpost, "predict", path, "-m", profile, "-q"]
    if at:
        arguments += ["--at", ",".join(f"{k}={v}" for k, v in at.items())]
    if setup:
        arguments.append("--include-setup")
    status, out, err = command.ask(*arguments, seconds=120)
    if status:
        raise RuntimeError(err.strip())
    lines = out.split("\n")
    names = lines[0].split(",")
    wanted = [names.index(n) for n in ("dx_um", "dy_um", "dz_um")]
    return numpy.array([[float(line.split(",")[k]) for k in wanted] for line in lines[1:] if line]) * 1e-3

