#!/usr/bin/python3
"""Makes the newcomer's files: machines, programs and measurements that ship nowhere, all invented.

    /usr/bin/python3 tests/newcomer/make.py target/release/vpost

`tests/newcomer.rs` reads what stands in the folders; this says where it comes from. Where a measurement needs the tip of a
machine with errors, `vpost predict` says where that is, for a profile with errors that the newcomer does not have; what an
instrument makes of it (noise, its own place, lengths) is computed here.
"""

import csv
import io
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
VPOST = str(Path(sys.argv[1]).resolve())
dice = random.Random(20)


def put(name, text):
    path = HERE / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def table(name, header, rows):
    put(name, header + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))


def predict(profile, header, rows, folder=HERE):
    """Where the tip really is: lists of x, y, z in mm and of the deviations in µm."""
    with tempfile.TemporaryDirectory() as temporary:
        points = Path(temporary) / "points.csv"
        points.write_text(header + "\n" + "".join(",".join(f"{v:.6f}" for v in row) + "\n" for row in rows))
        machine = Path(folder) / "hidden.toml"
        machine.write_text(profile)
        try:
            command = [VPOST, "predict", str(points), "-m", str(machine), "--outside", "clamp"]
            out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        finally:
            machine.unlink()
    read = list(csv.DictReader(io.StringIO(out)))
    number = lambda row, names: [float(row[name]) for name in names]
    return [number(r, ("px_mm", "py_mm", "pz_mm")) for r in read], [number(r, ("dx_um", "dy_um", "dz_um")) for r in read]


# ---- the mill: a table along Y under a column that carries X and Z -----------------------------------------------------

def mill():
    wave = lambda p, a, period, phase: a * math.sin(2 * math.pi * p / period + phase) - a * math.sin(phase)
    rows = [(x, *[f"{v:.2f}" for v in (
        0.017 * x + wave(x, 3.1, 640, 0.4), wave(x, 4.2, 1900, 0.1), wave(x, 2.3, 1300, 1.1),
        wave(x, 9, 1500, 0.2), wave(x, 14, 2100, 0.5), wave(x, 21, 2400, 0.0))]) for x in range(0, 1201, 60)]
    table("vega/x.csv", "position_mm,EXX_um,EYX_um,EZX_um,EAX_urad,EBX_urad,ECX_urad", rows)
    rows = [(y, *[f"{v:.2f}" for v in (
        wave(y, 2.0, 700, 0.7), -0.021 * (y + 480) + wave(y, 1.7, 310, 0.0), wave(y, 3.0, 900, 0.9),
        wave(y, 12, 1100, 0.3), wave(y, 6, 800, 0.2), wave(y, 11, 1300, 1.0))]) for y in range(-480, 1, 40)]
    table("vega/y.csv", "position_mm,EXY_um,EYY_um,EZY_um,EAY_urad,EBY_urad,ECY_urad", rows)
    rows = [(z, *[f"{v:.2f}" for v in (
        wave(z, 2.6, 800, 0.2), wave(z, 1.9, 650, 0.8), 0.012 * (z + 520) + wave(z, 1.2, 250, 0.0),
        wave(z, 7, 900, 0.1), wave(z, 8, 1000, 0.6), wave(z, 4, 700, 0.0))]) for z in range(-520, 1, 40)]
    table("vega/z.csv", "position_mm,EXZ_um,EYZ_um,EZZ_um,EAZ_urad,EBZ_urad,ECZ_urad", rows)
    put("vega/vega.toml", """# Invented: the newcomer's mill.
format  = 1
name    = "Vega 1200"
control = "linuxcnc"
chain   = "[w Y b X Z t]"
calibrated = { date = "2026-09-02", temperature_c = 21.5, instrument = "none: invented" }

[axis.X]
travel_mm      = [-5, 1215]
errors         = "x.csv"
measured_at_mm = { Y = -240, Z = -300, tool = [0, 0, -90] }
[axis.Y]
travel_mm      = [-490, 5]
errors         = "y.csv"
measured_at_mm = { X = 600, Z = -300, tool = [0, 0, -90] }
[axis.Z]
travel_mm      = [-530, 10]
errors         = "z.csv"
measured_at_mm = { X = 600, Y = -240, tool = [0, 0, -90] }

[squareness]
EC0Y_urad = -47
EB0Z_urad = 62
EA0Z_urad = -29

[tool]
default_mm = [0, 0, -90]
lengths_mm = { H1 = 104.2, H2 = 88.6, H3 = 131.0 }
[work_offsets_mm]
G54 = [520, -300, -410]
""")
    put("vega/cell.ini", "[RS274NGC]\nPARAMETER_FILE = cell.var\n[EMCIO]\nTOOL_TABLE = cell.tbl\n"
        "[TRAJ]\nCOORDINATES = XYZ\nLINEAR_UNITS = mm\n")
    put("vega/cell.tbl", "T1 P1 D12 Z+104.2 ;end mill\nT2 P2 D6.8 Z+88.6 ;drill\n")
    variables = {5220: 1, **{5221 + k: v for k, v in enumerate((522.5, -298.25, -407.75))}, 5230: 0, 5210: 0}
    put("vega/cell.var", "".join(f"{k}\t{v:.6f}\n" for k, v in sorted(variables.items())))


def programs():
    contour = "\n".join(
        f"G1 X{60 + 34 * math.cos(a) + 5 * math.cos(5 * a):.3f} Y{40 + 22 * math.sin(a):.3f}"
        for a in (math.radians(step) for step in range(0, 361, 6)))
    put("jobs/cover.ngc", f"(cover of a gearbox)\nG21 G17 G40 G49 G80 G90 G94 G54\nT1 M6\nG43 H1\nS4000 M3\n"
        f"G0 X99 Y40\nG0 Z30\nG0 Z12\nG1 Z2 F300\n{contour}\nG1 Z12\nG0 X-6 Y-6\nG1 Z0 F300\nG1 X110 F900\n"
        "G3 X118 Y2 I0 J8\nG1 Y80\nG3 X110 Y88 I-8 J0\nG1 X-6\nG1 Y-6\nG0 Z60\nM5\nM2\n")
    put("jobs/ring.ngc", "g21 g17 g40 g49 g90 g94 g54\nt1 m6\ng43 h1\ns2500 m3\ng0 x70 y30\ng0 z12\ng1 z5 f250\n"
        "g2 x70 y30 z3 i-20 j0\ng2 x70 y30 z1 i-20 j0\ng2 x30 y30 z1 i-20 j0\ng1 z10\ng0 z60\nm5\nm2\n")
    put("jobs/pads.ngc", "N10 G21 G40 G49 G90 G94 G54\nN20 T2 M6\nN30 G43 H2\nN40 S3000 M3\nN50 G0 X10 Y20\nN60 G0 Z20\n"
        "N70 G18 G1 Z10 F400\nN80 G2 X30 Z10 I10 K0\nN90 G19 G1 Y40\nN100 G3 Y60 Z10 J10 K0\nN110 G17 G1 X40\n"
        "N120 G0 Z60\nN130 M5\nN140 M2\n")
    put("jobs/fault.nc", "%\nO0413\nG21 G17 G40 G49 G80 G90 G94 G54\nT1 M6\nG0 X12. Y8.\nG43 H1 Z60.\nG1 Z4. F200.\n"
        "G1 X44. Y8.\nG2 X52. Y16.\nG0 Z60.\nM30\n%\n")
    put("jobs/holes.nc", "%\nO0207(BEARING PLATE)\nN10 G21 G17 G40 G49 G80 G90 G94 G54\nN20 T1 M6\nN30 S1900 M3\n"
        "N40 G0 X15. Y12.\nN50 G43 H1 Z60.\nN60 G98 G81 Z-6. R4. F160.\nN70 X47.5\nN80 Y58.25\nN90 G80\n"
        "N100 G99 G83 X15. Y58.25 Z-14. R4. Q3.5 F120.\nN110 G80\nN120 G0 Z60.\nN130 M30\n%\n")
    relief = "".join(
        f"X{10 + k * 0.4:.3f} Y{30 + row * 1.5:.3f} Z{6 + 3 * math.sin(k / 23 + row):.3f}\n"
        for row in range(4) for k in (range(0, 200) if row % 2 == 0 else range(199, -1, -1)))
    put("jobs/relief.nc", f"%\nO0731\nG21 G17 G40 G49 G80 G90 G94 G54\nT1 M6\nS8000 M3\nG0 X10. Y30.\nG43 H1 Z40.\n"
        f"G1 Z6. F500.\nF1500.\n{relief}G0 Z60.\nM30\n%\n")
    put("jobs/housing.mpf", "%_N_HOUSING_MPF\nN10 G17 G40 G71 G90 G94 G64\nN20 DEF REAL _SAFE=25\nN30 R1=18\nN40 T1\nN50 M6\n"
        "N60 D1\nN70 G54\nN80 S2600 M3\nN90 G0 X50 Y30 Z=_SAFE\nN100 F350\nN110 G1 X=50+R1 Y30 Z-2\n"
        "N120 G3 X=50+R1 Y30 I=AC(50) J=AC(30)\nN130 G1 X50\nN140 G0 Z=_SAFE\nN150 TRANS X80 Y10\nN160 G0 X0 Y0\n"
        "N170 G1 Z-3\nN180 X12.5 Y4\nN190 G0 Z=_SAFE\nN200 TRANS\nN210 M30\n")


# ---- an instrument on the mill -----------------------------------------------------------------------------------------

def runs():
    for name, symbol, targets, lost in (("y_runs", "EYY", range(-450, 1, 50), 2.4), ("z_runs", "EZZ", range(-480, -19, 46), 1.1)):
        rows = []
        for run in range(1, 6):
            for way in (1, -1):
                for at in list(targets)[::way]:
                    value = 0.02 * at + 2.2 * math.sin(at / 61) + way * -lost / 2 + dice.gauss(0, 0.5)
                    rows.append((run, way, at, f"{value:.2f}"))
        table(f"measured/{name}.csv", f"run,dir,position_mm,{symbol}_um", rows)


def truth(axes, more):
    text = 'format = 1\nname = "hidden"\n' + f'chain = "{axes}"\n'
    return text + more


LINEAR = """[axis.X]
travel_mm = [-900, 1900]
[axis.Y]
travel_mm = [-900, 1900]
[axis.Z]
travel_mm = [-900, 1900]
"""


def circles():
    """Six half turned circles by a bar of 150 mm, squareness and scales hidden, play put on by hand."""
    hidden = truth("[w Y b X Z t]", LINEAR + "[squareness]\nEC0Y_urad = 41\nEB0Z_urad = -22\nEA0Z_urad = 17\n"
                   '[[effect]]\nid = "scale.X"\nscale_um_per_m = 14\n[[effect]]\nid = "scale.Y"\nscale_um_per_m = -9\n')
    radius, play, centre = 150.0, (5.2, 3.1, 7.4), (610.0, -235.0, -260.0)
    rows, points = [], []
    for number, (a, b) in enumerate(((0, 1), (0, 1), (2, 0), (2, 0), (1, 2), (1, 2))):
        way = 1 if number % 2 == 0 else -1
        for step in range(72):
            turn = way * math.radians(step * 5 + 2.5)
            at, sense = list(centre), [0, 0, 0]
            at[a] += radius * math.cos(turn)
            at[b] += radius * math.sin(turn)
            sense[a] = int(math.copysign(1, -math.sin(turn) * way))
            sense[b] = int(math.copysign(1, math.cos(turn) * way))
            rows.append((number, at, sense))
            points.append(at)
    tips, _ = predict(hidden, "x_mm,y_mm,z_mm", points)
    start, _ = predict(hidden, "x_mm,y_mm,z_mm", [centre])
    made = []
    for (number, at, sense), tip in zip(rows, tips):
        tip = [t - s * p / 2000 for t, s, p in zip(tip, sense, play)]
        length = math.dist(tip, start[0]) + dice.gauss(0, 0.0003)
        made.append((number, *[f"{v:.4f}" for v in at], *centre, *sense, f"{length:.5f}"))
    table("measured/circles.csv", "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,dir_x,dir_y,dir_z,length_mm", made)


ROTARY = """[rotary.A]
centre_mm  = [410, -220, -380]
travel_deg = [-200, 400]
tilt       = "body"
EY0A_um    = {0}
EZ0A_um    = {1}
EB0A_urad  = {2}
EC0A_urad  = {3}
[rotary.C]
centre_mm  = [410, -220, -380]
travel_deg = [-400, 400]
tilt       = "body"
EX0C_um    = {4}
EY0C_um    = {5}
EA0C_urad  = {6}
EB0C_urad  = {7}
"""
CROSSING = (410.0, -220.0, -380.0)


def bar_on_a_table(name, errors):
    hidden = truth("[w C A b X Y Z t]", LINEAR + ROTARY.format(*errors))
    cup = (0.0312, -0.0187)
    tests = (("A1", (0, 0, 0), (0, -100, 0), "a"), ("A2", (100, 0, 0), (0, -100, 0), "a"),
             ("C3", (0, 0, 0), (100, 0, 0), "c"), ("C4", (0, 0, 100), (100, 0, 0), "c"),
             ("spindle", (0, 0, 0), (100, 0, 0), "s"))
    rows, points = [], []
    for run, shift, bar, turns in tests:
        at = [c + s for c, s in zip(CROSSING, shift)]
        other = [v + b for v, b in zip(at, bar)]
        for degrees in range(0, 361, 10):
            angles = {"a": 0, "c": 0, "s": 0, turns: degrees}
            turn = math.radians(angles["s"])
            # The ball sits beside the spindle's axis, and turns with it.
            beside = (cup[0] * math.cos(turn) - cup[1] * math.sin(turn), cup[0] * math.sin(turn) + cup[1] * math.cos(turn), 0)
            points.append([*at, angles["a"], angles["c"], *beside])
            rows.append((run, at, other, angles))
    tips, _ = predict(hidden, "x_mm,y_mm,z_mm,a_deg,c_deg,tool_x_mm,tool_y_mm,tool_z_mm", points)
    made = []
    for (run, at, other, angles), tip in zip(rows, tips):
        length = math.dist(tip, other) + dice.gauss(0, 0.0003)
        made.append((run, *map(int, at), *map(int, other), angles["a"], angles["c"], angles["s"], f"{length:.5f}"))
    table(name, "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,a_deg,c_deg,spindle_deg,length_mm", made)


def turned(point, a_deg, c_deg):
    """Where a place of the table, given at A0 C0 from the crossing, is at other angles."""
    a, c = math.radians(a_deg), math.radians(c_deg)
    x, y, z = point
    x, y = x * math.cos(c) - y * math.sin(c), x * math.sin(c) + y * math.cos(c)
    y, z = y * math.cos(a) - z * math.sin(a), y * math.sin(a) + z * math.cos(a)
    return [v + w for v, w in zip((x, y, z), CROSSING)]


def rtest():
    base = truth("[w C A b X Y Z t]", LINEAR + ROTARY.format(*[0] * 8))
    hidden = truth("[w C A b X Y Z t]", LINEAR + ROTARY.format(18, -23, 61, -44, 31, -12, 77, -35))
    put("table/table.toml", base.replace('"hidden"', '"Tilting table 320"').replace("format", "# Invented, as a drawing has it.\nformat", 1))
    header = "x_mm,y_mm,z_mm,a_deg,c_deg,tool_z_mm"

    def measure(name, balls, angles, first):
        rows, points = [], []
        for run, (place, tool) in enumerate(balls, first):
            for a, c in angles:
                x, y, z = turned(place, a, c)
                rows.append((run, f"{x:.3f}", f"{y:.3f}", f"{z - tool:.3f}", a, c, tool))
                points.append((x, y, z - tool, a, c, tool))
        points = [[float(f"{v:.3f}") for v in point] for point in points]
        _, off = predict(hidden, header, points)
        table(name, "run," + header + ",dx_um,dy_um,dz_um",
              [(*row, *[f"{v + dice.gauss(0, 0.8):.1f}" for v in d]) for row, d in zip(rows, off)])

    angles = [(0, c) for c in range(0, 360, 15)] + [(a, 0) for a in range(-90, 31, 10)] + [(-50, c) for c in range(20, 360, 68)]
    measure("table/rtest.csv", [((105, 12, 70), -140), ((-58, 91, 70), -140), ((-40, -96, 82), -140), ((66, 38, 160), -140)], angles, 1)
    measure("table/rtest_unseen.csv", [((-88, -71, 120), -115)], [(a, c) for a in (-85, -40, 0, 25) for c in range(8, 360, 72)], 5)
    rows = []
    for a in (-90, -60, -30, 0, 30):
        for c in range(0, 360, 45):
            x, y, z = turned((95, 0, 60), a, c)
            rows.append((f"{x:.6f}", f"{y:.6f}", f"{z:.6f}", a, c))
    table("table/followed.csv", "x_mm,y_mm,z_mm,a_deg,c_deg", rows)
    put("table/known.toml", hidden.replace('"hidden"', '"Tilting table 320 (known)"')
        .replace("format", "# Invented.\nformat", 1) + "[squareness]\nEC0Y_urad = 12\nEB0Z_urad = -19\nEA0Z_urad = 8\n"
        + '[[effect]]\nid = "scale.X"\nscale_um_per_m = 21\n[[effect]]\nid = "scale.Z"\nscale_um_per_m = -16\n')


def volume():
    """Points all over the mill with three tools, each run with the tracker at another place."""
    hidden = (HERE / "vega/vega.toml").read_text()
    tools = ((0, 0, -90), (0, 0, -230), (55, -35, -160))
    places = [(x, y, z) for x in (0, 400, 800, 1200) for y in (-480, -240, 0) for z in (-520, -260, 0)]
    while len(places) < 100:
        places.append((dice.uniform(0, 1200), dice.uniform(-480, 0), dice.uniform(-520, 0)))
    places = [tuple(float(f"{v:.1f}") for v in place) for place in places]
    points = [(*place, *tool) for place in places for tool in tools]
    _, off = predict(hidden, "x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm", points, HERE / "vega")
    shifts = [[dice.uniform(-40, 40) for _ in range(3)] for _ in tools]
    rows = []
    for k, (point, d) in enumerate(zip(points, off)):
        d = [v + s + dice.gauss(0, 0.8) for v, s in zip(d, shifts[k % 3])]
        rows.append((k % 3, *point, *[f"{v:.2f}" for v in d]))
    table("measured/volume.csv", "run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dx_um,dy_um,dz_um", rows)
    vectors = [(*point[:3], *[f"{v + dice.gauss(0, 1.2):.2f}" for v in d]) for point, d in zip(points, off) if point[5] == -90]
    table("field/vectors.csv", "x_mm,y_mm,z_mm,dx_um,dy_um,dz_um", vectors)
    put("field/field.toml", """# Invented: the mill as vectors in its volume say it.
format  = 1
name    = "Vega 1200 by vectors"
control = "fanuc"
chain   = "[w Y b X Z t]"
[axis.X]
travel_mm = [-5, 1215]
[axis.Y]
travel_mm = [-490, 5]
[axis.Z]
travel_mm = [-530, 10]
[field]
file     = "vectors.csv"
noise_um = 1.2
[tool]
default_mm = [0, 0, -90]
lengths_mm = { H1 = 90.0 }
[work_offsets_mm]
G54 = [520, -300, -410]
[correction]
engine = "field"
""")


def traverses():
    hidden = (HERE / "vega/vega.toml").read_text()
    for name, count, step in (("long", 21, 20.0), ("short", 21, 2.5)):
        for k, axis in enumerate("xyz"):
            start = (380.0, -450.0, -480.0)
            points = [[s + (n * step if i == k else 0) for i, s in enumerate(start)] for n in range(count)]
            _, off = predict(hidden, "x_mm,y_mm,z_mm", points, HERE / "vega")
            rows = []
            for n, d in enumerate(off):
                at = [n * step if i == k else 0 for i in range(3)]
                real = [v + (e - e0) / 1000 + (dice.gauss(0, 0.0009) if n else 0) for v, e, e0 in zip(at, d, off[0])]
                rows.append((*[f"{v:g}" for v in at], *[f"{v:.5f}" for v in real]))
            table(f"measured/{name}_{axis}.csv",
                  "commanded_x_mm,commanded_y_mm,commanded_z_mm,measured_x_mm,measured_y_mm,measured_z_mm", rows)


def gap():
    """Lines along the axes, each both ways: the mill has play in X that its profile does not know."""
    hidden = (HERE / "vega/vega.toml").read_text()
    rows, points = [], []
    for axis, (low, high) in enumerate(((40, 1160), (-470, -10), (-500, -20))):
        for way in (1, -1):
            for n in range(18)[::way]:
                at = [600.0, -240.0, -260.0]
                at[axis] = low + (high - low) * n / 17
                sense = [0, 0, 0]
                sense[axis] = way
                rows.append((f"line {'XYZ'[axis]}", at, sense))
                points.append([float(f"{v:.3f}") for v in at])
    _, off = predict(hidden, "x_mm,y_mm,z_mm", points, HERE / "vega")
    made = []
    for (run, _, sense), at, d in zip(rows, points, off):
        d = [v - (4.6 * sense[0] if k == 0 else 0) + dice.gauss(0, 0.7) for k, v in enumerate(d)]
        made.append((run, *at, *[f"{v:.2f}" for v in d], *sense, 0.7))
    table("measured/lines.csv", "run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,dir_x,dir_y,dir_z,u_um", made)


mill()
programs()
runs()
circles()
bar_on_a_table("measured/bar.csv", (24, -61, 118, -33, 87, -42, 55, -71))
bar_on_a_table("measured/bar_after.csv", (0.2, -0.1, 118, -33, 0.1, -0.2, 55, -71))
rtest()
volume()
traverses()
gap()
