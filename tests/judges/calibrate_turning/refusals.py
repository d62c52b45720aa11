"""Bad input of `vpost calibrate turning`: each refused, with its own message, and nothing written."""

import re
import tempfile

from common import folders
from common.command import run

import generate

MILL = """format = 1
name = "mill"
control = "fanuc"
chain = "[w X Y b Z t]"
[program]
decimal = "millimetres"
[axis.X]
travel_mm = [0, 500]
resolution_mm = 0.001
[axis.Y]
travel_mm = [0, 500]
resolution_mm = 0.001
[axis.Z]
travel_mm = [-100, 600]
resolution_mm = 0.001
"""


def cases():
    """(name, rows or text, what else: dictionary). The first six are those that the page names."""
    case = next(c for c in (generate.make("stated", 7, n) for n in range(50)) if c.parts >= 3 and abs(c.numbers["EB0S_urad"]) > 60)
    rows = [dict(r) for r in case.rows]

    def changed(k, **words):
        out = [dict(r) for r in rows]
        out[k].update(words)
        return out

    def without(key):
        return [{k: v for k, v in r.items() if k != key} for r in rows]

    first = [r for r in rows if r["part"] == "P1"]
    yield "one part", first, {}
    yield "one section a part", [r for k, r in enumerate(rows) if k == 0 or rows[k - 1]["part"] != r["part"]], {}
    yield "no z", without("z_mm"), {}
    yield "mill", rows, {"profile": MILL}
    yield "above 2 mm", changed(3, d_um=2500.0), {}
    yield "duplicates", rows + [{**rows[2], "d_um": rows[2]["d_um"] + 40 * case.noise}], {}
    yield "held out worse", rows, {"held": [{**r, "d_um": round(-r["d_um"], 2)} for r in case.held_rows]}
    # further ones, each a slip of the hand
    yield "z empty", changed(3, z_mm=""), {}
    yield "nan", changed(3, d_um="nan"), {}
    yield "infinite", changed(3, d_um="inf"), {}
    yield "word for number", changed(3, d_um="12 um"), {}
    yield "unknown feature", changed(3, feature="bore"), {}
    yield "diameter of nought", changed(3, diameter_mm=0.0), {}
    yield "negative diameter", changed(3, diameter_mm=-40.0), {}
    yield "u of nought", changed(3, u_um=0.0), {}
    yield "negative u", changed(3, u_um=-1.0), {}
    yield "no diameter_mm", without("diameter_mm"), {}
    yield "no d_um", without("d_um"), {}
    yield "no part", without("part"), {}
    yield "unknown column", [{**r, "colour": "red"} for r in rows], {}
    yield "header only", "part,feature,z_mm,diameter_mm,d_um\n", {}
    yield "empty file", "", {}
    yield "inches for millimetres", [{**r, "d_um": r["d_um"] * 1e3} for r in rows], {}
    yield "z outside travel", [{**r, "z_mm": r["z_mm"] + 5000} for r in rows], {}
    yield "held out empty", rows, {"held": "part,feature,z_mm,diameter_mm,d_um\n"}
    yield "faces alone", [{**r, "feature": "face"} for r in rows], {"may": True}
    yield "repeats that agree", rows + [{**rows[2], "d_um": round(rows[2]["d_um"] + case.noise, 2)}], {"right": True}
    yield "as it is", rows, {"right": True}


def main(vpost, keep=None):
    """Prints one line each; returns the number of findings."""
    found, messages = 0, {}
    base = next(c for c in (generate.make("stated", 7, n) for n in range(50)) if c.parts >= 3)
    for name, rows, how in cases():
        with tempfile.TemporaryDirectory() as folder:
            generate.write_base(folder, base)
            if "profile" in how:
                folders.put(folder, "lathe.toml", how["profile"])
            for to, what in (("parts.csv", rows), ("held.csv", how.get("held"))):
                if isinstance(what, str):
                    with open(f"{folder}/{to}", "w") as file:
                        file.write(what)
                elif what is not None:
                    generate.write_rows(f"{folder}/{to}", what)
            folders.put(folder, "out.toml", "# stands here already\n")
            more = ["--holdout", "held.csv"] if "held" in how else []
            status, _, errors = run(vpost, "calibrate", "turning", "parts.csv", "-m", "lathe.toml", *more, "-o", "out.toml", "--json", "f.json", folder=folder)
            with open(f"{folder}/out.toml") as file:
                stands = file.read() == "# stands here already\n"
        error = re.search(r"error(?:\[(VP\d+)\])?: (.*)", errors)
        wrong = []
        if status not in (0, 1, 2) or "panicked" in errors:
            wrong.append(f"crash, status {status}")
        elif how.get("right"):
            wrong += [f"refused: {error and error[0]}"] if status else []
        elif not (how.get("may") and status == 0):
            wrong += ["not refused"] if status == 0 else []
            wrong += ["what stood there is gone"] if not stands else []
            wrong += ["no code"] if status and not (error and error[1]) else []
            if error and len(messages) < 7:
                words = re.sub(r"[-\d.]+", "#", error[2])
                if words in messages:
                    wrong.append(f"the message of `{messages[words]}`")
                messages[words] = name
        found += bool(wrong)
        print(f"{'!!' if wrong else '  '} {name:24s} status {status} {error[1] if error else ''} {error[2][:150] if error else ''} {'; '.join(wrong)}")
    return found
