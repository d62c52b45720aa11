"""The package against the command: the same bytes, the same digits, the same refusals.

The command is `VPOST`, or the debug build.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import vpost

ROOT = Path(__file__).resolve().parents[2]
COMMAND = os.environ.get("VPOST", str(ROOT / "target/debug/vpost"))
STAN = "machine-profiles/stan_s500.toml"


@pytest.fixture(autouse=True)
def in_the_root(monkeypatch):
    monkeypatch.chdir(ROOT)


def run(*words, stdin=None):
    return subprocess.run([COMMAND, *map(str, words)], input=stdin, capture_output=True, check=False)


def samples():
    """Programs of the samples and of the corpus, each with its dialect."""
    found = []
    for dialect in ("linuxcnc", "fanuc"):
        found += [(path, dialect) for path in sorted((ROOT / "samples").glob(f"*{dialect}*.n*"))]
    for verdict in ("accept", "reject"):
        for dialect in ("linuxcnc", "fanuc", "centroid", "sinumerik"):
            paths = sorted((ROOT / "tests/corpus" / verdict).glob(f"**/{dialect}*/**/*.*"))
            paths += sorted((ROOT / "tests/corpus" / dialect / verdict).glob("**/*.*"))
            found += [(path, dialect) for path in paths if path.is_file()][:8]
    return [(str(path.relative_to(ROOT)), dialect) for path, dialect in found]


PROGRAMS = samples()


def test_there_are_programs_enough():
    assert len(PROGRAMS) >= 30


def test_of_these_programs_some_are_corrected_and_some_refused():
    statuses = [run(path, "-m", STAN, "-d", dialect).returncode for path, dialect in PROGRAMS]
    assert statuses.count(0) >= 10 and statuses.count(1) >= 5


@pytest.mark.parametrize("path, dialect", PROGRAMS)
def test_correct_is_the_command(path, dialect):
    command = run(path, "-m", STAN, "-d", dialect, "--color", "never")
    text = Path(path).read_bytes()
    try:
        corrected = vpost.correct(text, STAN, dialect=dialect, name=path)
    except vpost.Refused as refused:
        assert command.returncode in (1, 2)
        assert str(refused) + "\n" == command.stderr.decode()
        assert refused.codes and all(f"[{code}]" in str(refused) for code in refused.codes)
        return
    assert command.returncode == 0
    assert corrected.text == command.stdout
    assert "".join(f"{warning}\n" for warning in corrected.warnings) == command.stderr.decode()


def test_the_summary_is_the_command_s(tmp_path):
    path = "samples/plate_linuxcnc.nc"
    run(path, "-m", STAN, "-d", "linuxcnc", "-o", tmp_path / "out.nc", "--summary", tmp_path / "summary.json")
    corrected = vpost.correct(Path(path).read_bytes().decode(), STAN, dialect="linuxcnc", name=path)
    assert corrected.summary == json.loads((tmp_path / "summary.json").read_text())
    assert corrected.text == (tmp_path / "out.nc").read_bytes().decode()
    assert corrected.deviation_after_um < corrected.deviation_before_um


def test_options_are_the_command_s():
    text = b"G21 G90 G17 G54\nG43 H1\nG0 X10. Y10. Z30.\nG1 Z15. F600\nX20.\nM30\n"
    words = ["--work-offset", "G54=200,150,60", "--tool", "H1=100", "--tolerance", "2", "--guard"]
    command = run("-", "-m", STAN, "-d", "linuxcnc", *words, stdin=text)
    corrected = vpost.correct(
        text, STAN, dialect="linuxcnc", work_offset={"G54": (200, 150, 60)}, tool={"H1": 100}, tolerance_um=2, guard=True
    )
    assert corrected.text == command.stdout and corrected.changed


def test_check_is_the_command():
    path = "samples/plate_linuxcnc.nc"
    posted = Path(path).read_bytes()
    corrected = vpost.correct(posted, STAN, dialect="linuxcnc").text
    for text, passed in ((corrected, True), (corrected.replace(b"X119.034", b"X118.934"), False)):
        checked = vpost.check(posted, text, STAN, dialect="linuxcnc", names=(path, "standard input"))
        command = run("check", path, "-", "-m", STAN, "-d", "linuxcnc", stdin=text)
        assert checked.passed is passed and bool(checked.findings) is not passed
        assert checked.text == command.stdout.decode()
        assert command.returncode == (0 if passed else 1)


def table(text):
    return list(csv.DictReader(io.StringIO(text.decode())))


POINTS = np.random.default_rng(5).uniform((0, 0, 0), (900, 500, 480), (200, 3))


def as_csv(points, **more):
    columns = {"x_mm": points[:, 0], "y_mm": points[:, 1], "z_mm": points[:, 2], **more}
    lines = zip(*(column.tolist() for column in columns.values()))
    return (",".join(columns) + "\n" + "".join(",".join(map(repr, line)) + "\n" for line in lines)).encode()


def fixed(value, decimals):
    text = f"{value:.{decimals}f}"
    return text[1:] if float(text) == 0 and text.startswith("-") else text


@pytest.mark.parametrize("engine", [None, "tracker", "kmtpp"])
def test_predict_is_the_command_to_every_digit(engine):
    words = ["-e", engine] if engine else []
    command = run("predict", "-", "-m", STAN, *words, stdin=as_csv(POINTS))
    predicted = vpost.predict(STAN, POINTS, engine=engine)
    printed = table(command.stdout)
    assert len(printed) == len(POINTS)
    for row, line in enumerate(printed):
        assert [fixed(v, 9) for v in predicted.position_mm[row]] == [line[k] for k in ("px_mm", "py_mm", "pz_mm")]
        errors = [*predicted.error_um[row], predicted.distance_um[row]]
        assert [fixed(v, 6) for v in errors] == [line[k] for k in ("dx_um", "dy_um", "dz_um", "d_um")]
    assert "".join(f"{warning}\n" for warning in predicted.warnings) == command.stderr.decode()
    assert ("VP0909" in command.stderr.decode()) == (not predicted.inside.all())


@pytest.mark.parametrize("engine", [None, "tracker", "tangential-static-published"])
def test_solve_is_the_command_to_every_digit(engine):
    inside = np.random.default_rng(6).uniform(20, 200, (100, 3))
    words = ["-e", engine] if engine else []
    command = run("solve", "-", "-m", STAN, *words, stdin=as_csv(inside))
    assert command.returncode == 0, command.stderr.decode()
    solved = vpost.solve(STAN, inside, engine=engine)
    for row, line in enumerate(table(command.stdout)):
        assert [fixed(v, 9) for v in solved.command_mm[row]] == [line[k] for k in ("qx_mm", "qy_mm", "qz_mm")]
        assert str(solved.iterations[row]) == line["iterations"]
        assert fixed(solved.residual_um[row], 9) == line["residual_um"]


def test_machines_that_turn_say_where_the_tool_points():
    profiles = sorted((ROOT / "tests/profiles").glob("*.toml")) + sorted((ROOT / "machine-profiles").glob("*.toml"))
    turning = None
    for path in profiles:
        command = run("predict", "-", "-m", path, stdin=as_csv(np.zeros((1, 3))))
        if b"tilt_urad" in command.stdout:
            turning = path
            break
    assert turning, "no profile with rotary axes"
    points = np.array([[10.0, 20.0, 30.0], [0.0, 0.0, 5.0]])
    for axis, letter in enumerate("abc"):
        angles = np.array([12.5, -3.0])
        command = run("predict", "-", "-m", turning, stdin=as_csv(points, **{f"{letter}_deg": angles}))
        rotary = np.zeros((2, 3))
        rotary[:, axis] = angles
        if command.returncode != 0:
            with pytest.raises(vpost.Refused):
                vpost.predict(turning, points, rotary_deg=rotary)
            continue
        predicted = vpost.predict(turning, points, rotary_deg=rotary)
        for row, line in enumerate(table(command.stdout)):
            assert [fixed(v, 9) for v in predicted.position_mm[row]] == [line[k] for k in ("px_mm", "py_mm", "pz_mm")]
            assert [fixed(v, 9) for v in predicted.direction[row]] == [line[k] for k in ("tool_i", "tool_j", "tool_k")]
            assert fixed(predicted.tilt_urad[row], 3) == line["tilt_urad"]


def test_diagnose_is_the_command_and_has_a_field_for_every_key(tmp_path):
    rows, profile = "samples/diagnosis/backlash.csv", "samples/diagnosis/backlash.toml"
    run("diagnose", rows, "-m", profile, "--json", tmp_path / "diagnosis.json")
    expected = (tmp_path / "diagnosis.json").read_text()
    diagnosis = vpost.diagnose(Path(rows).read_bytes(), profile)
    assert diagnosis.json == expected

    def plain(value):
        if dataclasses.is_dataclass(value):
            names = [field.name for field in dataclasses.fields(value)]
            return {name.rstrip("_"): plain(getattr(value, name)) for name in names}
        if isinstance(value, (tuple, list)):
            return [plain(one) for one in value]
        return {key: plain(one) for key, one in value.items()} if isinstance(value, dict) else value

    made = plain(diagnosis)
    del made["json"]
    document = json.loads(expected)
    del document["schema"]
    assert made == document
    assert diagnosis.verdict == "NAMED" and diagnosis.causes[0].effect == "backlash.X"


def test_rows_and_columns_are_the_file():
    profile = "samples/diagnosis/backlash.toml"
    text = Path("samples/diagnosis/backlash.csv").read_text()
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    read = list(csv.DictReader(lines))

    def value(cell):
        try:
            return float(cell) if cell else None
        except ValueError:
            return cell

    rows = [{key: cell if key == "run" else value(cell) for key, cell in row.items()} for row in read]
    columns = {key: [row[key] for row in rows] for key in rows[0]}
    of_file = vpost.diagnose(text, profile)
    # Line numbers of outliers count the comments of the file.
    for given in (rows, columns):
        of_rows = vpost.diagnose(given, profile)
        assert of_rows.causes == of_file.causes and of_rows.gap == of_file.gap


def test_the_map_is_the_command_s_rows(tmp_path):
    run("map", "-m", STAN, "--grid", "5x4x3", "--csv", tmp_path / "map.csv")
    printed = table((tmp_path / "map.csv").read_bytes())
    found = vpost.map(STAN, grid=(5, 4, 3))
    assert found.error_um.shape == (5, 4, 3, 3) and len(printed) == 60
    for index, line in enumerate(printed):
        x, y, z = index % 5, index // 5 % 4, index // 20
        place = [found.x_mm[x], found.y_mm[y], found.z_mm[z]]
        assert [fixed(v, 9) for v in place] == [line[k] for k in ("x_mm", "y_mm", "z_mm")]
        assert [fixed(v, 6) for v in found.error_um[x, y, z]] == [line[k] for k in ("dx_um", "dy_um", "dz_um")]


def test_the_map_s_figures_are_the_command_s(tmp_path):
    words = ["--grid", "5x4x3", "--within", "50", "--region", "left=0..200,0..280,0..200", "--plane", "XY=100"]
    words += ["--part-box", "10..90,10..60,5..40", "--clamp", "100,80,40", "--tool-vector", "0,0,-50", "--second-order"]
    command = run("map", "-m", STAN, *words, "--json", tmp_path / "map.json")
    assert command.returncode == 0, command.stderr.decode()
    found = vpost.map(
        STAN,
        grid=(5, 4, 3),
        within_um=50,
        region={"left": "0..200,0..280,0..200"},
        plane=["XY=100"],
        part_box="10..90,10..60,5..40",
        clamp_mm=(100, 80, 40),
        tool_mm=(0, 0, -50),
        second_order=True,
    )
    assert found.summary == json.loads((tmp_path / "map.json").read_text())
    assert [part["name"] for part in found.summary["parts"]] == ["volume", "left", "XY at Z 100", "part box"]
    with pytest.raises(vpost.Refused) as caught:
        vpost.map(STAN, grid="0:5000:100,0:100:50,0:100:50")
    assert caught.value.codes == ["VP0909"]


def test_the_budget_is_the_command_s(tmp_path):
    words = ["--grid", "4x4x3", "--target", "300", "--keep", "EXX,EYY", "--tool-vector", "0,0,-50"]
    command = run("budget", "-m", STAN, *words, "--json", tmp_path / "budget.json")
    assert command.returncode == 0, command.stderr.decode()
    found = vpost.budget(STAN, grid=(4, 4, 3), target_um=300, keep=["EXX", "EYY"], tool_mm=(0, 0, -50))
    assert found.json == (tmp_path / "budget.json").read_text()
    assert "".join(f"{warning}\n" for warning in found.warnings) == command.stderr.decode()
    points = as_csv(np.array([[10.0, 20.0, 30.0], [300.0, 200.0, 150.0]]))
    run("budget", "-m", STAN, "--points", "-", "--json", tmp_path / "points.json", stdin=points)
    assert vpost.budget(STAN, points=points).json == (tmp_path / "points.json").read_text()
    with pytest.raises(vpost.Refused) as caught:
        vpost.budget(STAN, keep=["EXX"])
    assert caught.value.codes == ["VP0002"]


CHAIN = {"chain": "[w X Y b Z t]", "date": "2026-05-15", "temperature": 20, "measured_with": "test"}
CALIBRATIONS = [
    ("tracker", [f"machine-profiles/stan_s500/tracker_315_{axis}.csv" for axis in "xyz"], CHAIN),
    ("interferometer", ["samples/calibration/iso230_2_psi_2023.csv"], CHAIN),
    ("volumetric", ["samples/calibration/volume_points.csv"], {**CHAIN, "nodes": 4}),
    ("ballbar", ["samples/calibration/ballbar_circles.csv"], CHAIN),
    ("rtest", ["samples/calibration/rtest_bc.csv"], {"profile": "samples/profiles/table_bc.toml"}),
]


@pytest.mark.parametrize("instrument, files, asked", CALIBRATIONS)
def test_calibrate_is_the_command(instrument, files, asked, tmp_path):
    words = ["-m", asked["profile"]] if "profile" in asked else []
    for name, value in asked.items():
        if name != "profile":
            words += [f"--{'instrument' if name == 'measured_with' else name}", value]
    (tmp_path / "command").mkdir()
    has_figures = instrument not in ("tracker", "volumetric")
    words += ["--json", tmp_path / "found.json"] if has_figures else []
    command = run("calibrate", instrument, *files, *words, "-o", tmp_path / "command/made.toml")
    assert command.returncode == 0, command.stderr.decode()
    found = vpost.calibrate(
        instrument, {name: Path(name).read_bytes() for name in files}, output="made.toml", **asked
    )
    assert found.report == command.stdout.decode()
    said = "".join(f"{warning}\n" for warning in found.warnings)
    assert command.stderr.decode().startswith(said) and "written, tables in" in command.stderr.decode()[len(said) :]
    assert found.profile == (tmp_path / "command/made.toml").read_text()
    tables = {f"made/{path.name}": path.read_bytes() for path in (tmp_path / "command/made").iterdir()}
    assert found.tables == tables and bool(tables) == (instrument != "ballbar")
    assert (found.figures is not None) == has_figures
    if has_figures:
        expected = json.loads((tmp_path / "found.json").read_text())
        # Where files are, and what was typed, is the command's alone.
        for figures in (expected, found.figures):
            figures.pop("made", None)
        assert found.figures == expected
    saved = found.save(tmp_path)
    assert vpost.predict(saved, np.full((1, 3), 50.0), outside="clamp").error_um.shape == (1, 3)


def test_calibrate_reads_rows_and_refuses_as_the_command():
    lathe = "tests/profiles/lathe.toml"
    with pytest.raises(vpost.Refused) as caught:
        vpost.calibrate("turning", {"parts.csv": [{"part": "A", "z_mm": 1.0, "diameter_mm": 40.0}]}, profile=lathe)
    assert caught.value.messages[0].file == "parts.csv"
    with pytest.raises(vpost.Refused) as caught:
        vpost.calibrate("ballbar", {"b.csv": Path("samples/calibration/ballbar_ac.csv").read_text()})
    assert caught.value.codes == ["VP1106"]
    with pytest.raises(vpost.Refused):
        vpost.calibrate("plumb-line", {})
    text = Path("samples/calibration/iso230_2_psi_2021.csv").read_text()
    report = vpost.calibrate("interferometer", {"runs.csv": text})
    assert report.profile is None and "ISO 230-2" in report.report
    with pytest.raises(ValueError):
        report.save(".")


@pytest.mark.parametrize("job", [vpost.predict, vpost.solve])
def test_wrong_arrays_have_an_exception_each(job):
    for shape in ((3,), (2, 2), (2, 3, 1), (0,)):
        with pytest.raises(vpost.ShapeError):
            job(STAN, np.zeros(shape))
    with pytest.raises(vpost.ShapeError):
        job(STAN, np.zeros((2, 3)), tool_mm=np.zeros((3, 3)))
    for wrong in (np.nan, np.inf):
        with pytest.raises(vpost.NotFiniteError):
            job(STAN, [[0.0, wrong, 0.0]])
    for wrong in ([["1", "2", "3"]], [[True, False, True]], [[1j, 0, 0]], [[4e8, 0.0, 0.0]]):
        with pytest.raises(vpost.UnitsError):
            job(STAN, wrong)
    with pytest.raises(vpost.UnitsError):
        job(STAN, np.zeros((1, 3)), direction=(0.5, 0, 0))
    assert issubclass(vpost.ShapeError, ValueError) and not issubclass(vpost.Refused, ValueError)


def test_wrong_rows_have_an_exception_each():
    profile = "samples/diagnosis/backlash.toml"
    good = {"run": "r", "x_mm": 1.0, "y_mm": 2.0, "z_mm": 3.0, "dx_um": 1.0}
    with pytest.raises(vpost.NotFiniteError):
        vpost.diagnose([{**good, "dx_um": float("nan")}], profile)
    with pytest.raises(vpost.ShapeError):
        vpost.diagnose([good, {"run": "r"}], profile)
    with pytest.raises(vpost.ShapeError):
        vpost.diagnose({"run": ["r"], "x_mm": [1.0, 2.0]}, profile)
    with pytest.raises(vpost.Refused):
        vpost.diagnose([{**good, "dx_inch": 1.0}], profile)


def test_refusals_say_where():
    with pytest.raises(vpost.Refused) as caught:
        vpost.correct("G21 G90 G54\nG0 X0 Y0 Z0\nG77 X1\n", STAN, dialect="fanuc", name="part.nc")
    message = caught.value.messages[0]
    assert (message.file, message.line, message.column, message.severity) == ("part.nc", 3, 1, "error")
    assert f"part.nc:{message.line}:{message.column}" in str(caught.value) and message.help
    with pytest.raises(vpost.Refused) as caught:
        vpost.correct("", "no/such/profile.toml")
    assert caught.value.codes == ["VP0001"]
    with pytest.raises(vpost.Refused) as caught:
        vpost.correct("", STAN, outside="perhaps")
    assert caught.value.codes == ["VP0002"]
    with pytest.raises(vpost.NotFiniteError):
        vpost.correct("", STAN, tolerance_um=float("nan"))
