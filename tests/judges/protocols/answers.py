"""What vpost answers, and what its written profile does: the command, the JSON, `vpost predict` on a grid."""

import csv
import io
import json
import math
import re
import time

from common.command import ask, run

from machine import AXES

CORRECTABLE = ("scale.", "squareness.", "positioning.", "straightness.", "pitch.", "angular.", "sag.", "local.",
               "joint.", "backlash.", "lost-motion.", "spindle-tilt.", "rotary.", "eccentricity.")
CONDITIONS = "time_s=0,temp_c=20,load_kg=0,feed_mm_min=1000"
VERDICTS = {"NO GAP", "NAMED", "AMBIGUOUS", "PARTIAL", "UNKNOWN", "NOISE MODEL SUSPECT", "UNDERPOWERED"}


class Answer:
    """Exit status, messages, diagnosis and written profile of one call."""

    def __init__(self, status=0, messages="", diagnosis=None, profile="", seconds=0.0, base=""):
        self.status, self.messages, self.seconds = status, messages, seconds
        self.diagnosis, self.profile, self.base = diagnosis or {}, profile, base
        self.verdict = self.diagnosis.get("verdict", "REFUSED")
        self.causes = self.diagnosis.get("causes") or []
        self.codes = sorted(set(re.findall(r"error\[(VP\d+)\]", messages)))

    def names(self):
        return [cause["effect"] for cause in self.causes]

    def rivals(self):
        """All that stands beside the causes."""
        return {name for cause in self.causes for name in cause.get("cannot_be_told_from") or []}

    def written(self):
        """Effects that the written profile has and the base has not."""
        return re.findall(r'^id\s*=\s*"([^"]+)"', self.profile.replace(self.base, "", 1), re.M)

    def travel(self):
        """Volume of the written profile, mm by axis."""
        out = []
        for letter in AXES:
            found = re.search(rf"\[axis\.{letter}\][^\[]*?travel_mm\s*=\s*\[([^\],]+),([^\]]+)\]", self.profile)
            out.append((float(found.group(1)), float(found.group(2))))
        return out

    def forecast(self):
        """Predicted shrinkage with all causes, or None."""
        told = self.causes[-1].get("shrink_predicted") if self.causes else None
        return told.get("mid") if told else None

    def stated_um(self, travel):
        """What the answer states of the places after correction, at 95 %, um: twice what is left of the gap, and the
        uncertainty of each number at the far side of the volume."""
        spans = [high - low for low, high in travel]
        reach = max(spans) / 2
        total = (self.diagnosis.get("leftover") or {}).get("rms_um") or 0.0
        square = (2 * total) ** 2
        for cause in self.causes:
            for one in cause.get("parameters") or []:
                wide = one.get("u95")
                if wide is None or not math.isfinite(wide):
                    continue
                name = one["name"]
                if name.endswith(("_urad", "_um_per_m")):
                    wide *= reach / 1000
                elif not name.endswith("_um"):
                    continue
                square += wide ** 2
        return math.sqrt(square)


def diagnose(vpost, folder, holdout=None, tag="plain"):
    """Runs `vpost diagnose` in a folder that holds machine.toml and rows.csv."""
    command = [vpost, "diagnose", "rows.csv", "-m", "machine.toml", "--json", f"{tag}.json", "--write-profile",
               f"{tag}.toml"]
    if holdout:
        command += ["--holdout", holdout]
    (folder / f"{tag}.command").write_text(" ".join(command) + "\n")
    for name in (f"{tag}.json", f"{tag}.toml"):
        (folder / name).unlink(missing_ok=True)
    begun = time.perf_counter()
    status, out, messages = ask(*command, folder=folder, seconds=300)
    seconds = time.perf_counter() - begun
    (folder / f"{tag}.txt").write_text(f"exit status {status}\n{out}\n{messages}")

    def text(name):
        return (folder / name).read_text() if (folder / name).exists() else ""
    told = text(f"{tag}.json")
    return Answer(status, messages, json.loads(told) if told else None, text(f"{tag}.toml"), seconds,
                  text("machine.toml"))


def predict(vpost, folder, profile, rows, tool):
    """Displacement that a profile foretells for rows, um; None where the command refuses."""
    lines = ["x_mm,y_mm,z_mm,dir_x,dir_y,dir_z,tool_x_mm,tool_y_mm,tool_z_mm"]
    for row in rows:
        lines.append(",".join(f"{v:.9g}" for v in (*row.q, *row.dirs, *(row.tool or tool))))
    (folder / "points.csv").write_text("\n".join(lines) + "\n")
    for extra in ([], ["--at", CONDITIONS]):
        done = run(vpost, "predict", "points.csv", "-m", profile, *extra, folder=folder, seconds=120)
        if done.status == 0:
            table = csv.DictReader(io.StringIO(done.output))
            return [[float(line[f"d{k}_um"]) for k in "xyz"] for line in table]
    return None


def profile_of_causes(answer):
    """The base with all causes that a machine can have, as the answer's numbers say them."""
    text = answer.base
    for cause in answer.causes:
        if not cause["effect"].startswith(CORRECTABLE):
            continue
        text += f'\n[[effect]]\nid = "{cause["effect"]}"\n'
        for one in cause["parameters"]:
            if one.get("value") is not None:
                text += f'{one["name"]} = {float(one["value"])!r}\n'
    return text
