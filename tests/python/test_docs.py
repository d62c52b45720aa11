"""The guide's code runs as it stands."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_code_of_the_guide_runs(tmp_path, monkeypatch, capsys):
    for folder in ("samples", "machine-profiles"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/how-to/python.md").read_text(), re.M | re.S)
    assert len(blocks) == 5
    names = {}
    for block in blocks:
        exec(compile(block, "docs/how-to/python.md", "exec"), names)
    printed = capsys.readouterr().out
    assert "um before" in printed
    assert "VP0" in printed and "NAMED ['backlash.X']" in printed and "(11, 11, 5, 3)" in printed
    assert "EC0Y" in printed and (tmp_path / "made.toml").exists()
    assert (tmp_path / "corrected.nc").stat().st_size > 1000
