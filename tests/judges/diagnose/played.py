"""A played vpost for the self-test: `played.py MODE diagnose|predict|calibrate …` answers in the command's form, rightly or wrongly.

  knows    what truth.json beside the measurements deserves; its numbers scatter as its intervals say
  narrow   the same with intervals of a third            off      the same with numbers 30 % off and forecasts 20 points too hopeful
  silent   NO GAP, always                                boaster  NAMED backlash.X, always, with a correction of a millimetre
  refuser  refuses every file                             stubborn knows, and does not look at the hold-out
  clerk    a flipped sign, always
"""

import csv
import json
import os
import random
import re
import sys
import zlib


def option(arguments, name):
    return arguments[arguments.index(name) + 1] if name in arguments else None


def effect_text(cause):
    return f'\n[[effect]]\nid = "{cause["effect"]}"\n' + "".join(f"{k} = {v}\n" for k, v in cause["parameters"].items())


def diagnose(mode, arguments):
    profile = option(arguments, "-m")
    if option(arguments, "--plan"):
        print("run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,dir_x,dir_y,dir_z,feed_mm_min")
        for line in range(9):
            for k in range(12):
                places = ["100", "100", "100"]
                places[line % 3] = str(20 + 15 * k)
                print(f"p{line},{','.join(places)},,,," + ",".join(str(int(a == line % 3)) for a in range(3)) + ",")
        return 0
    told = {"verdict": "NO GAP", "causes": []}
    if mode in ("knows", "narrow", "off", "stubborn"):
        with open(os.path.join(os.path.dirname(arguments[0]), "truth.json"), encoding="utf-8") as file:
            told = json.load(file)
    if mode == "boaster":
        told = {"verdict": "NAMED", "causes": [{"effect": "backlash.X", "parameters": {"half_width_um": 1000.0}, "rivals": []}], "written": True}
    if mode == "clerk":
        told = {"verdict": "NAMED", "causes": [{"effect": "bookkeeping.sign-flipped", "parameters": {}, "rivals": []}]}
    if "err" in told or mode == "refuser":
        print(told.get("err", "error[VP0910]: no"), file=sys.stderr)
        return 1
    chance = random.Random(zlib.crc32(open(arguments[0], "rb").read()))
    verdict = told.get("holdout_verdict", told["verdict"]) if "--holdout" in arguments and mode != "stubborn" else told["verdict"]
    causes, proposal = [], None
    for cause in told["causes"]:
        sigma = {k: 0.01 * abs(v) for k, v in cause["parameters"].items()}
        shift = 1.3 if mode == "off" else 1.0
        parameters = [{"name": k, "value": shift * v + chance.gauss(0, sigma[k]), "u95": 1.96 * sigma[k] / (3 if mode == "narrow" else 1)} for k, v in cause["parameters"].items()]
        causes.append({"effect": cause["effect"], "parameters": parameters, "cannot_be_told_from": cause["rivals"], "shrink_predicted": {"mid": told.get("shrink", 0.8) + (0.2 if mode == "off" else 0)}})
    if told.get("ambiguous") and os.path.basename(arguments[0]) == "rows.csv":
        verdict = "AMBIGUOUS" if causes else verdict
        proposal = {"rows": [{"run": "n", "x_mm": 20 + 10 * k, "y_mm": 50, "z_mm": 50, "dir_x": 1, "feed_mm_min": 500} for k in range(10)], "text": "this line"}
    noise = told.get("noise_um", 1.0) * (30 if mode == "off" else 1)
    answer = {"verdict": verdict, "gap": {"rms_um": told.get("gap_um", 10.0) * (5 if mode == "off" else 1), "noise_um": noise}, "causes": causes, "next_measurement": proposal,
              "notes": told.get("notes", []), "formulas": told.get("formulas", [])}
    with open(option(arguments, "--json"), "w", encoding="utf-8") as file:
        json.dump(answer, file)
    written = option(arguments, "--write-profile")
    if written:
        with open(profile, encoding="utf-8") as file:
            text = file.read()
        if told.get("written"):
            text += "".join(effect_text(c) for c in told["causes"])
        with open(written, "w", encoding="utf-8") as file:
            file.write(text)
    return 0


def predict(arguments):
    with open(option(arguments, "-m"), encoding="utf-8") as file:
        effects = re.findall(r'\[\[effect\]\]\nid = "([a-z-]+)\.([XYZ])"\n((?:\w+ = .*\n?)*)', file.read())
    at = dict(part.split("=") for part in (option(arguments, "--at") or "").split(",") if part)
    condition = {k: float(at.get(k, 0)) for k in ("load_kg", "temp_c", "time_s", "feed_mm_min")}
    print("dx_um,dy_um,dz_um")
    with open(arguments[0], encoding="utf-8") as file:
        for row in csv.DictReader(file):
            d = [0.0, 0.0, 0.0]
            for name, axis, text in effects:
                values = [float(v) for v in re.findall(r"= (\S+)", text)]
                a = "XYZ".index(axis)
                facing = float(row[f"dir_{axis.lower()}"])
                d[a] += values[0] * {"load": -condition["load_kg"], "thermal": condition["temp_c"] - 20, "warmup": 1 - 2.718281828459045 ** (-condition["time_s"] / 3000.0),
                                     "servo-lag": -facing * condition["feed_mm_min"] / 60, "spindle-tilt": -1e-3 * float(row["tool_z_mm"]), "backlash": -facing}[name]
            print(",".join(f"{v:.6f}" for v in d))
    return 0


def main():
    mode, command, *arguments = sys.argv[1:]
    if command == "diagnose":
        return diagnose(mode, arguments)
    if mode == "refuser":
        print("error[VP0910]: no", file=sys.stderr)
        return 1
    if command == "predict":
        return predict(arguments)
    if "--against" in arguments:
        with open(os.path.join(os.path.dirname(arguments[1]), "truth.json"), encoding="utf-8") as file:
            right = json.load(file)["text"]
        print({"silent": "against old.toml: no change is shown", "boaster": "against old.toml: the machine has changed"}.get(mode, right))
    return 0


if __name__ == "__main__":
    sys.exit(main())
