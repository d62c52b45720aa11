#!/usr/bin/python3
"""Bad input of lathes: each is refused (status 1, or 2 for a profile), with a message of its own that says what it is.

    /usr/bin/python3 tests/judges/turning/refusals.py --vpost target/release/vpost

A case passes where the status is 1 or 2 and the message holds the words; a case that is refused for what is no mistake
(the sound twin of it is refused with the same number) does not count as found. Exit status 1 where a case fails.
"""

import argparse
import os
import re
import sys
import tempfile

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import generate  # noqa: E402
import judge  # noqa: E402
import unseen  # noqa: E402

HEAD = "%\nO1000\nG21 G18 G40 G99 G54\nG50 S2500\nT0101\nG96 S180 M3\n"
FOOT = "M5\nM30\n%\n"
GOOD = "G0 X60. Z2.\nG1 X40. F0.2\nZ-30.\nX60.\nG0 Z2.\n"


def sound():
    spec = unseen.lathe(False, "diameter", "A")
    spec["workpiece"] = {"diameters_mm": [[0, 60], [300, 60]], "e_gpa": 210.0, "clamping": "chuck-tailstock", "radial_force_n": 200.0}
    spec["tailstock"] = {"at_mm": 300.0, "offset_um": [20.0, 0.0]}
    spec["tool"]["noses"] = {"H1": {"radius_mm": 0.8, "direction": 3, "height_um": 0.0}}
    return spec


def cases():
    """(name, spec, program, words of the message)."""
    def without(change):
        spec = sound()
        change(spec)
        return spec

    yield "diameter or radius not said", without(lambda s: s.pop("x")), HEAD + GOOD + FOOT, r"diameter"
    yield "system not said", without(lambda s: s.pop("g_code_system")), HEAD + GOOD + FOOT, r"g_code_system|system"
    yield "X below the axis", sound(), HEAD + "G0 X60. Z2.\nG1 X-20. F0.2\nZ-30.\n" + FOOT, r"axis|below|negative"
    yield "G96 without a limit", sound(), (HEAD + GOOD + FOOT).replace("G50 S2500\n", ""), r"G96|limit"
    yield "P-Q block missing", sound(), HEAD + "G0 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2\nN10 G0 X30.\nG1 Z-20.\nX60.\n" + FOOT, r"N20|Q20|20"
    yield "contour not monotone", sound(), HEAD + "G0 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2\nN10 G0 X30.\nG1 Z-20.\nX50.\nZ-10.\nN20 X60.\n" + FOOT, r"monoton|back"
    yield "nose larger than an inner arc", sound(), HEAD + "G0 X60. Z5.\nG42 G1 X40. Z2. F0.2\nZ-10.\nG2 X41. Z-10.5 R0.5\nG1 X60.\nG40 G0 X70.\n" + FOOT, r"nose|radius"
    yield "tailstock beyond the bar", without(lambda s: s["tailstock"].update(at_mm=400.0)), HEAD + GOOD + FOOT, r"tailstock"
    yield "force without clamping", without(lambda s: s["workpiece"].pop("clamping")), HEAD + GOOD + FOOT, r"clamping"
    yield "a C axis word", sound(), HEAD + GOOD + "G0 C90.\n" + FOOT, r"\bC\b"
    yield "a Y axis word", sound(), HEAD + GOOD + "G0 Y5.\n" + FOOT, r"\bY\b"
    yield "two turrets", sound(), HEAD + GOOD + "G68\n" + FOOT, r"turret|G68"
    yield "a wait", sound(), HEAD + GOOD + "!1\n" + FOOT, r"!|wait"
    yield "LinuxCNC's arc in G17", unseen.lathe(True, "radius", "A"), "G21 G40 G90\nT1 M6 G43 H1\nG97 S500 M3 G95 F0.2\nG0 X30 Z2\nG1 X20 Z0\nG2 X25 Z-5 R5\nM2\n", r"G18|plane|G17"
    yield "LinuxCNC with U", unseen.lathe(True, "radius", "A"), "G21 G18 G40 G90 G8\nT1 M6 G43 H1\nG97 S500 M3 G95 F0.2\nG0 X30 Z2\nG1 U-2\nM2\n", r"\bU\b"
    yield "LinuxCNC with G73", unseen.lathe(True, "radius", "A"), "G21 G18 G40 G90 G8\nT1 M6 G43 H1\nG97 S500 M3 G95 F0.2\nG0 X30 Z2\nG73 Q100 X30 Z2 D1\nM2\n", r"G73"


def ask(vpost, spec, text):
    with tempfile.TemporaryDirectory() as folder:
        judge.put(folder, "in.nc", text)
        spec = dict(spec)
        x = spec.setdefault("x", None)
        path = generate.write({**spec, "x": x or "?"}, folder)
        if x is None:
            with open(path, encoding="utf-8") as file:
                profile = file.read().replace('x = "?"\n', "")
            judge.put(folder, "lathe.toml", profile)
        done = judge.correct(vpost, spec, folder)
        return done.status, done.errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--vpost", default="vpost")
    arguments = parser.parse_args()
    status, message = ask(arguments.vpost, sound(), HEAD + GOOD + FOOT)
    base = (judge.lathe_codes(message) or [None])[0] if status else None
    failed = 0
    print(f"sound program: status {status} {base or ''}")
    seen = {}
    for name, spec, text, words in cases():
        status, message = ask(arguments.vpost, spec, text)
        code = (judge.lathe_codes(message) or ["?"])[0]
        error = re.sub(r"(?m)^\s*\d* *\|.*$", "", message)
        good = status in (1, 2) and code != base and re.search(words, error, re.I)
        seen.setdefault(code, []).append(name)
        failed += not good
        print(f"{'ok   ' if good else 'WRONG'} {name}: status {status} {code} {error.strip().splitlines()[0][:110] if error.strip() else ''}")
    shared = {c: n for c, n in seen.items() if len(n) > 1}
    print(f"failed: {failed}; numbers shared by several: {shared or 'none'}")
    return 1 if failed or base else 0


if __name__ == "__main__":
    sys.exit(main())
