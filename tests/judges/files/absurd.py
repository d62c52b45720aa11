"""Absurd values: each an error, soon; and time that grows no faster than the input.

NaN and infinity in every numeric option and every number of a profile, a resolution above 0.1 mm, steps that would give 10^9 points.
Values that are only large are asked for an answer in bounded time and memory, without a panic.

Linear time: the same thing with 20, 40 and 80 thousand keys, columns, run ids, subprograms. The processor time of each doubling, least
of two runs, grows less than threefold (2 is linear, 4 is quadratic).
"""

import os
import random
import re
import shutil

from runner import REPOSITORY, broke_down, first_line, profile, program, read, write

SAMPLES = os.path.join(REPOSITORY, "samples")
SECONDS, MEGABYTES = 10, 1000       # of processor time, for the computer may be busy; twice that by the clock
NOT_NUMBERS = ("nan", "NaN", "inf", "-inf", "infinity", "1e999")


def asked(judge, name, case, args, folder, must_refuse=True, files=(), env=None):
    ended = judge.run(args, cwd=folder, timeout=2 * SECONDS, env=env)
    refused = ended.status in (1, 2)
    wrong = broke_down(ended) or ended.timed_out or ended.cpu > SECONDS or ended.peak_mb > MEGABYTES or (must_refuse and not refused) or ended.status not in (0, 1, 2, 75)
    judge.judge(name, wrong, case, "exit status %d%s, %.1f s, %.0f MB; %s" % (ended.status, " (killed: too long)" if ended.timed_out else "", ended.seconds,
                ended.peak_mb, first_line(ended.err)), "an error" if must_refuse else "an answer in %d s and %d MB" % (SECONDS, MEGABYTES), args, files)
    return ended


RICH = """
[rotary.C]
centre_mm = [100.0, 100.0, 0.0]
travel_deg = [-360.0, 360.0]
EX0C_um = 1.5
EY0C_um = 2.5
tilt = "body"
EA0C_urad = 3.5
EB0C_urad = 4.5

[setup]
shift_mm = [1.5, 2.5, 3.5]
rotation_urad = [4.5, 5.5, 6.5]

[[effect]]
id = "scale.X"
scale_um_per_m = 1.5

[[effect]]
id = "backlash.Y"
half_width_um = 1.25

[[effect]]
id = "local.X"
x_um = 1.5
y_um = 0.5
z_um = 0.25
centre_mm = 150.5
width_mm = 20.5

[[effect]]
id = "pitch.Z"
pitch_mm = 10.5
sin1_um = 0.5
cos1_um = 0.75

[[effect]]
id = "straightness.EYX"
p2_um = 1.5
from_mm = 0.5
to_mm = 300.5
"""


def options(judge, folder):
    name = "NaN and infinity in options"
    base = ["part.nc", "-m", "mill.toml"]
    maps = ["map", "-m", "mill.toml", "--grid", "3x3x3"]
    budget = ["budget", "-m", "mill.toml", "--grid", "3x3x3"]
    export = ["profile", "export", "mill.toml", "--format", "lattice", "-O", "exported"]
    new = ["--name", "N", "--chain", "[w X Y b Z t]"]
    volume = ["calibrate", "volumetric", "volume.csv"] + new
    tracker = ["calibrate", "tracker", "tx.csv", "ty.csv", "tz.csv"] + new
    meter = ["calibrate", "interferometer", "iso.csv"] + new
    ball = ["calibrate", "ballbar", "ball.csv"]
    endless = set()
    for number in NOT_NUMBERS if judge.count >= 20 else NOT_NUMBERS[::3]:
        for args, option, value in (
                (base, "--tolerance", "%s"), (base, "--work-offset", "G54=%s,0,0"), (base, "--work-offset", "G54=40,30,%s"), (base, "--tool", "H1=%s"),
                (base, "--tool", "H1=0,0,%s"), (base, "--start-at", "%s,0,0"), (base, "--start-at", "0,0,%s"), (base, "--set", "#500=%s"),
                (base, "--at", "temp_c=%s"), (base, "--at", "time_s=%s"), (base, "--at", "load_kg=%s"), (base, "--at", "feed_mm_min=%s"),
                (maps, "--within", "%s"), (maps, "--tool-vector", "0,0,%s"), (maps, "--region", "A=0..%s,0..1,0..1"), (maps, "--region", "A=%s..9,0..1,0..1"),
                (maps, "--plane", "XY=%s"), (maps, "--part-box", "0..%s,0..100,0..100"), (maps, "--clamp", "%s,10,10"), (maps[:3], "--grid", "0:%s:10,0:10:5,0:10:5"),
                (maps[:3], "--grid", "0:100:%s,0:10:5,0:10:5"), (maps[:3], "--grid", "%sx3x3"), (maps, "--rotary", "C=%s"), (budget, "--target", "%s"),
                (budget, "--rotary", "C=%s"), (budget, "--tool-vector", "%s,0,0"), (export, "--step", "%s"), (volume, "--temperature", "%s"), (volume, "--nodes", "%s"),
                (volume, "--holdout-every", "%s"), (tracker, "--u-um", "%s"), (tracker, "--chord-mm", "%s"), (tracker, "--temperature", "%s"), (tracker, "--interval", "%s"),
                (meter, "--squareness", "XY=%s"), (meter, "--through", "%s,0,0"), (meter, "--optics", "0,0,%s"), (meter, "--refine", "%s"), (meter, "--u-um-per-m", "%s"),
                (meter, "--temperature", "%s"), (ball, "--crossing", "%s,0,0"), (ball, "--crossing", "%s,%s,0"), (ball, "--crossing", "0,0,%s"),
                (["diagnose", "rows.csv", "-m", "backlash.toml"], "--seed", "%s"), (["check", "part.nc", "part.nc", "-m", "mill.toml"], "--tolerance", "%s"),
                (["batch", "part.nc", "-m", "mill.toml", "-O", "outs"], "--tolerance", "%s")):
            if (args[1], option) in endless:
                continue
            ended = asked(judge, name, "%s %s %s" % (" ".join(args[:2]), option, value.replace("%s", number)),
                          args + ["%s=%s" % (option, value.replace("%s", number))], folder)
            if ended.timed_out:
                endless.add((args[1], option))      # once is enough
    for args in (maps, budget, volume, tracker, meter, ball + ["--crossing", "250,150,-300"]):
        ended = judge.run(args, cwd=folder, timeout=60)
        judge.judge(name, ended.status != 0, "the same without the value: %s" % " ".join(args[:2]), "exit status %d, %s" % (ended.status, first_line(ended.err)),
                    "exit status 0, or the refusals above say nothing", args)
    name = "absurd options"
    for args, option, value in (
            (base, "--tolerance", "0"), (base, "--tolerance", "-1"), (maps[:3], "--grid", "1000000x1000000x1000000"),
            (maps[:3], "--grid", "18446744073709551615x2x2"), (maps[:3], "--grid", "0:100:1e-9,0:10:5,0:10:5"), (maps[:3], "--grid", "0:100:0,0:10:5,0:10:5"),
            (maps[:3], "--grid", "0:100:-1,0:10:5,0:10:5"), (maps[:3], "--grid", "0x3x3"), (maps, "--within", "-1"), (maps, "--clamp", "0,0,-1"), (maps, "--clamp", "1e300,1,1"),
            (budget[:3], "--grid", "1000000x1000000x1000000"), (budget, "--target", "0"), (budget, "--target", "-3"), (export, "--step", "1e-9"), (export, "--step", "0"),
            (export, "--step", "-5"), (export, "--step", "1e-300"), (volume, "--nodes", "1000000000"), (volume, "--nodes", "18446744073709551615"),
            (tracker, "--chord-mm", "-1"), (tracker, "--chord-mm", "1e300"), (tracker, "--u-um", "0"), (tracker, "--u-um", "-1"),
            (tracker, "--interval", "18446744073709551615"), (tracker, "--interval", "1000000"), (meter, "--refine", "1e-9"), (meter, "--refine", "0"), (meter, "--refine", "-1"),
            (meter, "--u-um-per-m", "-1"), (ball, "--crossing", "inf,nan,0"),
            (["diagnose", "rows.csv", "-m", "backlash.toml"], "--seed", "-1"), (base, "--work-offset", "G54=1e300,0,0"), (base, "--tool", "H1=1e300")):
        asked(judge, name, "%s %s %s" % (" ".join(args[:2]), option, value), args + ["%s=%s" % (option, value)], folder)
    name = "large options, an answer in bounded time"
    for args, option, value in ((base, "--tolerance", "1e-300"), (base, "--tolerance", "1e300"), (volume, "--nodes", "0"), (volume, "--temperature", "1e300"),
                                (ball, "--crossing", "1e300,0,0"), (base, "--start-at", "1e300,0,0"), (meter + ["-o", "fine.toml"], "--refine", "1e-9"), (base, "--tolerance", "1e-9"), (base, "--tolerance", "1e9"), (export, "--step", "1e300"), (export, "--step", "1e9"),
                                (maps, "--within", "1e300"), (budget, "--target", "1e-300"), (budget, "--target", "1e300"), (volume, "--holdout-every", "18446744073709551615"),
                                (volume, "--holdout-every", "1"), (meter, "--refine", "1e9"), (base, "--set", "#500=1e300"), (base, "--at", "temp_c=1e300"),
                                (["diagnose", "rows.csv", "-m", "backlash.toml"], "--seed", "18446744073709551615"), (maps, "--region", "A=5..1,0..1,0..1"),
                                (maps, "--part-box", "1e300..-1e300,0..1,0..1")):
        asked(judge, name, "%s %s %s" % (" ".join(args[:2]), option, value), args + ["%s=%s" % (option, value)], folder, must_refuse=False)


def profiles(judge, folder):
    plain = read(os.path.join(folder, "mill.toml")).decode()
    rich = plain.replace('"[w X Y b Z t]"', '"[w C X Y b Z t]"') + RICH
    for text, case in ((plain, "plain"), (rich, "rich")):
        write(os.path.join(folder, "try.toml"), text)
        ended = judge.run(["profile", "check", "try.toml"], cwd=folder)
        judge.judge("NaN and infinity in profiles", ended.status != 0, "undisturbed, " + case, "exit status %d, %s" % (ended.status, ended.err[:200]), "exit status 0", ["profile", "check"])
        if ended.status != 0:
            continue
        body = re.sub(r'"[^"]*"', lambda m: "\0" * len(m.group(0)), text)
        for place in list(re.finditer(r"(?<![\w.\0-])-?\d+(\.\d+)?(?![\w.])", body)):
            line = text[text.rfind("\n", 0, place.start()) + 1:].split("\n")[0]
            if case == "rich" and place.end() < len(plain):
                continue
            for value in ("nan", "inf", "-inf"):
                write(os.path.join(folder, "try.toml"), text[:place.start()] + value + text[place.end():])
                for args in (["profile", "check", "try.toml"], ["part.nc", "-m", "try.toml"]):
                    if case == "rich" and args[0] == "part.nc":
                        continue
                    asked(judge, "NaN and infinity in profiles", "%s with %s: %s" % (line.strip()[:50], value, args[0]), args, folder, files=[os.path.join(folder, "try.toml")])
    name = "resolution"
    for value, good in (("0.2", False), ("0.11", False), ("0.1001", False), ("1", False), ("1e9", False), ("1e300", False), ("0", False), ("-0.001", False), ("0.0", False),
                        ("1e-300", None), ("1e-12", None), ("1e-7", None), ("0.1", True), ("0.01", True), ("0.0001", True)):
        for axis in "XZ":
            text = re.sub(r"(\[axis\.%s\][^\[]*?\[[^\]]*\]\nresolution_mm = )0\.001" % axis, lambda m: m.group(1) + value, plain, flags=re.S)
            write(os.path.join(folder, "try.toml"), text)
            for args in (["profile", "check", "try.toml"], ["part.nc", "-m", "try.toml", "--tolerance", "200"]):
                ended = asked(judge, name, "%s resolution_mm = %s: %s" % (axis, value, args[0]), args, folder, must_refuse=good is False, files=[os.path.join(folder, "try.toml")])
                if good:
                    judge.judge(name, ended.status != 0, "%s resolution_mm = %s: %s" % (axis, value, args[0]), "exit status %d, %s" % (ended.status, first_line(ended.err)),
                                "accepted", args)
    name = "absurd values in profiles, an answer in bounded time"
    for old, new in (("tolerance_um = 1.0", "tolerance_um = 0"), ("tolerance_um = 1.0", "tolerance_um = -1"), ("tolerance_um = 1.0", "tolerance_um = 1e-300"),
                     ("tolerance_um = 1.0", "tolerance_um = 1e300"), ("minimum_segment_mm = 0.0", "minimum_segment_mm = -1"), ("minimum_segment_mm = 0.0", "minimum_segment_mm = 1e300"),
                     ("travel_mm     = [0, 400]", "travel_mm     = [400, 0]"), ("travel_mm     = [0, 400]", "travel_mm     = [-1e300, 1e300]"), ("H1 = 120.0", "H1 = 1e300"),
                     ("G54 = [40.0", "G54 = [1e300"), ("EC0Y_urad = 120.0", "EC0Y_urad = 1e300"), ("EC0Y_urad = 120.0", "EC0Y_urad = 1e9"), ("temperature_c = 20.0", "temperature_c = 1e300"),
                     ("format  = 1", "format  = 18446744073709551616"), ("format  = 1", "format  = 1e999")):
        write(os.path.join(folder, "try.toml"), plain.replace(old, new))
        for args in (["profile", "check", "try.toml"], ["part.nc", "-m", "try.toml"], ["map", "-m", "try.toml"]):
            asked(judge, name, "%s: %s" % (new, args[0]), args, folder, must_refuse=False, files=[os.path.join(folder, "try.toml")])
    name = "NaN and infinity in tables"
    table = read(os.path.join(folder, "x.csv")).decode()
    for value in NOT_NUMBERS:
        for row, column in ((1, 0), (5, 0), (1, 1), (7, 6), (-2, 3)):
            lines = table.split("\n")
            cells = lines[row].split(",")
            cells[column] = value
            lines[row] = ",".join(cells)
            write(os.path.join(folder, "bad.csv"), "\n".join(lines))
            write(os.path.join(folder, "try.toml"), plain.replace("x.csv", "bad.csv"))
            asked(judge, name, "%s in row %d column %d" % (value, row, column), ["part.nc", "-m", "try.toml"], folder, files=[os.path.join(folder, "bad.csv")])
    for command, source in (("diagnose", "rows.csv"), ("predict", "points.csv"), ("solve", "points.csv")):
        text = read(os.path.join(folder, source)).decode().rstrip("\n").split("\n")
        for value in NOT_NUMBERS:
            cells = text[-1].split(",")
            for column, cell in enumerate(cells):
                if not re.fullmatch(r"-?\d+(\.\d+)?", cell):
                    continue
                write(os.path.join(folder, "bad.csv"), "\n".join(text[:-1] + [",".join(cells[:column] + [value] + cells[column + 1:])]) + "\n")
                asked(judge, name, "%s: %s in column %d" % (command, value, column), [command, "bad.csv", "-m", "backlash.toml" if command == "diagnose" else "mill.toml"], folder)


def growth(judge, folder):
    plain = read(os.path.join(folder, "mill.toml")).decode()
    part = read(os.path.join(folder, "part.nc")).decode()
    table = read(os.path.join(folder, "x.csv")).decode().strip().split("\n")
    rows = read(os.path.join(folder, "rows.csv")).decode()
    lines = [line for line in rows.split("\n") if line and not line.startswith("#")]
    fanuc = read(os.path.join(REPOSITORY, "grammars", "fanuc.toml")).decode()

    def put(name, text):
        write(os.path.join(folder, name), text)
        return name

    def in_profile(text):
        return ["profile", "check", put("big.toml", text)]

    points = [line for line in read(os.path.join(folder, "volume.csv")).decode().split("\n") if line and not line.startswith("#")]

    def measured(n, per_run=1, command="diagnose"):
        source = lines if command == "diagnose" else points
        out = [source[0]]
        for i in range(n):
            cells = source[1 + i % (len(source) - 1)].split(",")
            cells[source[0].split(",").index("run")] = "r%d" % (i // per_run)
            out.append(",".join(cells))
        put("big.csv", "\n".join(out) + "\n")
        if command == "diagnose":
            return ["diagnose", "big.csv", "-m", "backlash.toml"]
        return ["calibrate", "volumetric", "big.csv", "--name", "N", "--chain", "[w X Y b Z t]"]

    def wide(n):
        put("big.csv", "\n".join(row + "," + ",".join("c%d" % i if k == 0 else "1" for i in range(n)) for k, row in enumerate(table[:4])) + "\n")
        put("wide.toml", plain.replace("x.csv", "big.csv"))
        return ["profile", "check", "wide.toml"]

    def wide_rows(n, ignore):
        n = n // 20 if ignore else n            # the command line holds no more
        put("big.csv", "\n".join(row + "," + ",".join("c%d" % i if k == 0 else "1" for i in range(n)) for k, row in enumerate(lines[:3])) + "\n")
        return ["diagnose", "big.csv", "-m", "backlash.toml"] + (["--ignore-column=c%d" % i for i in range(n)] if ignore else [])

    def wide_points(n):
        put("big.csv", "x_mm,y_mm,z_mm," + ",".join("c%d" % i for i in range(n)) + "\n" + "1,1,1," + ",".join("1" for _ in range(n)) + "\n")
        return ["predict", "big.csv", "-m", "mill.toml"]

    def same_columns(n):
        put("big.csv", ",".join(["x_mm", "y_mm", "z_mm"] + ["note"] * n) + "\n" + ",".join(["1"] * (n + 3)) + "\n")
        return ["diagnose", "big.csv", "-m", "backlash.toml"]

    def subprograms(n, calls):
        main = part.replace("%\n", "").replace("G0 Z50.\nM30\n", "".join("M98 P%d\n" % (1000 + i) for i in range(0, n, 1 if calls else n)) + "G0 Z50.\nM30\n")
        return [put("big.nc", "%\n" + main + "".join("O%d\nG1 X%d.%03d Y60.\nM99\n" % (1000 + i, 50 + i % 20, i % 1000) for i in range(n)) + "%\n"), "-m", "mill.toml", "-o", "o.nc"]

    def named(n):
        body = "".join("o<s%d> sub\nG1 X%d.\no<s%d> endsub\n" % (i, 50 + i % 20, i) for i in range(n))
        calls = "".join("o<s%d> call\n" % i for i in range(n))
        main = part.replace("%\n", "").replace("O0001\n", "").replace("G0 Z50.\nM30\n", calls + "G0 Z50.\nM30\n")
        return [put("big.ngc", body + main), "-m", "mill.toml", "-d", "linuxcnc", "-o", "o.nc"]

    def labels(n):
        body = "".join("N%d G1 X%d. Y60.\n" % (i, 50 + i % 20) for i in range(2, n))
        return [put("big.nc", part.replace("G0 Z50.\nM30", "GOTO 7\n" + body.replace("N7 ", "N7 ") + "G0 Z50.\nM30")), "-m", "mill.toml", "-o", "o.nc"]

    def jumps(n):
        body = "".join("GOTO %d\nN%d G1 X%d. Y60.\n" % (100000 + i, 100000 + i, 50 + i % 20) for i in range(n))
        return [put("big.nc", part.replace("G0 Z50.\nM30", body + "G0 Z50.\nM30")), "-m", "mill.toml", "-o", "o.nc"]

    def variables(n):
        body = "".join("#<v%d>=%d\n" % (i, i % 50) for i in range(n)) + "".join("G1 X#<v%d>\n" % i for i in range(0, n))
        return [put("big.ngc", part.replace("O0001\n", "").replace("G0 Z50.\nM30", body + "G0 Z50.\nM30")), "-m", "mill.toml", "-d", "linuxcnc", "-o", "o.nc"]

    def many_sets(n):
        return ["part.nc", "-m", "mill.toml", "-o", "o.nc"] + ["--set=#<v%d>=1" % i for i in range(n // 10)]

    def manifest(n):
        if os.path.exists(os.path.join(folder, "many")):
            shutil.rmtree(os.path.join(folder, "many"))
        shutil.rmtree(os.path.join(folder, "many-out"), ignore_errors=True)
        os.makedirs(os.path.join(folder, "many"))
        for i in range(n // 20):
            put("many/p%d.nc" % i, part)
        return ["batch", "many", "-m", "mill.toml", "-O", "many-out", "--force"]
    cases = (("tool lengths in a profile", lambda n: in_profile(plain.replace("H1 = 120.0", ", ".join("H%d = 1.5" % i for i in range(10, n)) + ", H1 = 120.0"))),
             ("tool lengths in a section", lambda n: in_profile(plain.replace("lengths_mm = { H1 = 120.0, H2 = [0.0, 0.0, 95.5] }", "[tool.lengths_mm]\n" + "\n".join("H%d = 1.5" % i for i in range(1, n))))),
             ("unknown keys at the top of a profile", lambda n: in_profile("\n".join("k%d = 1" % i for i in range(n)) + "\n" + plain)),
             ("unknown keys in a section", lambda n: in_profile(plain.replace("[tool]\n", "[tool]\n" + "\n".join("k%d = 1" % i for i in range(n)) + "\n"))),
             ("dotted keys", lambda n: in_profile(plain.replace("[tool]\n", "[tool]\n" + "\n".join("a.b%d.c = 1" % i for i in range(n)) + "\n"))),
             ("unknown sections", lambda n: in_profile(plain + "\n".join("[s%d]\nk = 1" % i for i in range(n)))),
             ("axes", lambda n: in_profile(plain + "\n".join("[axis.Q%d]\ntravel_mm = [0, 1]" % i for i in range(n)))),
             ("work offsets", lambda n: in_profile(plain.replace("G54 = [", "\n".join('"G54.1P%d" = [1.0, 2.0, 3.0]' % i for i in range(1, n)) + "\nG54 = ["))),
             ("effects", lambda n: in_profile(plain + '[[effect]]\nid = "scale.X"\nscale_um_per_m = 0.001\n' * n)),
             ("keys of a dialect table", lambda n: ["grammar", "check", put("big-dialect.toml", "\n".join("k%d = 1" % i for i in range(n)) + "\n" + fanuc)]),
             ("columns of an error table", wide), ("columns of measurements", lambda n: wide_rows(n, False)), ("columns of measurements, passed over", lambda n: wide_rows(n, True)),
             ("columns of points", wide_points), ("columns of one name", same_columns),
             ("run ids in diagnose", measured), ("run ids in diagnose, ten rows each", lambda n: measured(n, 10)), ("run ids in calibrate", lambda n: measured(n, 1, "calibrate")),
             ("run ids in calibrate, ten rows each", lambda n: measured(n, 10, "calibrate")),
             ("subprograms in a file", lambda n: subprograms(n, False)), ("subprograms in a file, each called", lambda n: subprograms(n, True)), ("subprograms by name", named),
             ("numbered blocks behind a jump", labels), ("jumps", jumps), ("variables by name", variables), ("values given by --set", many_sets), ("programs in a batch", manifest))
    only = os.environ.get("JUDGE_GROWTH")
    for case, make in cases if judge.count >= 20 else cases[:1] + cases[10:11]:
        if only and only not in case:
            continue
        sizes = (20000, 40000, 80000)
        if judge.run(make(20000), cwd=folder, timeout=60).cpu > 3:
            sizes = (3000, 6000, 12000)         # much work for each: less of it shows as much
        times, last = [], None
        for n in sizes:
            args = make(n)
            least = None
            for _ in range(2):
                last = judge.run(args, cwd=folder, timeout=60)
                least = last.cpu if least is None else min(least, last.cpu)
                if last.timed_out or least > 5:
                    break
            times.append(least)
            if last.timed_out or least > 30:
                break
        ratios = [b / max(a, 1e-9) for a, b in zip(times, times[1:])]
        slow = [r for r, b in zip(ratios, times[1:]) if r >= 3 and b > 0.2]
        judge.judge("linear time", slow or last.timed_out or broke_down(last), case, "%s s at %s%s; exit status %d, %s"
                    % (", ".join("%.2f" % t for t in times), ", ".join(str(n) for n in sizes[:len(times)]), ", given up after 60 s" if last.timed_out else "", last.status, first_line(last.err)),
                    "less than threefold for each doubling", args[:8])
        if os.environ.get("JUDGE_TALK"):
            judge.note("%s: %s s at %s, exit status %d, %s" % (case, " ".join("%.2f" % t for t in times), sizes, last.status, first_line(last.err, 90)))


def run(judge):
    folder = judge.folder("absurd")
    mill = profile(folder)
    write(os.path.join(folder, "part.nc"), program(random.Random(2), 12))
    write(os.path.join(folder, "points.csv"), "x_mm,y_mm,z_mm\n10,10,10\n50,60,70\n")
    stan = os.path.join(REPOSITORY, "machine-profiles", "stan_s500")
    for source, to in ((os.path.join(SAMPLES, "diagnosis", "backlash.csv"), "rows.csv"), (os.path.join(SAMPLES, "diagnosis", "backlash.toml"), "backlash.toml"),
                       (os.path.join(SAMPLES, "calibration", "volume_points.csv"), "volume.csv"), (os.path.join(SAMPLES, "calibration", "ballbar_ac.csv"), "ball.csv"),
                       (os.path.join(SAMPLES, "calibration", "iso230_2_psi_2021.csv"), "iso.csv"), (os.path.join(stan, "tracker_315_x.csv"), "tx.csv"),
                       (os.path.join(stan, "tracker_315_y.csv"), "ty.csv"), (os.path.join(stan, "tracker_315_z.csv"), "tz.csv")):
        shutil.copy(source, os.path.join(folder, to))
    if not os.environ.get("JUDGE_GROWTH"):
        options(judge, folder)
        profiles(judge, folder)
    growth(judge, folder)
