"""`permway sweep` as a user runs it, the examples and the reference."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from permway.study import open_study, read_study, study_from_dict
from permway.study.axes import Range
from permway.study.file import _File
from permway.study.plan import Sample

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("study*.toml"))
REFERENCE = (ROOT / "docs" / "study-file.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```toml\n(.*?)^```", REFERENCE, flags=re.MULTILINE | re.DOTALL)


def run(*arguments):
    command = [sys.executable, "-m", "permway", "sweep", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_a_sweep_from_end_to_end(study_file, tmp_path):
    path = study_file(3)
    done = run(path, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    folder = tmp_path / "pads.cases"
    expected = {"folder": str(folder), "cases": 6, "computed": 6, "already_there": 0, "failed": []}
    assert json.loads(done.stdout) == expected
    assert np.isfinite(open_study(folder)["receptance"].values).all()
    again = run(path, "-o", folder, "--threads", 1)
    assert (again.returncode, again.stderr) == (0, "")
    assert re.search(r"computed +0\nalready there +6\nfailed +none", again.stdout)

    path.write_text(path.read_text(encoding="utf-8").replace("[0.1, 0.2]", "[0.1, 0.3]"), encoding="utf-8")
    refused = run(path)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.startswith(f"permway: {folder}: holds the results of another study")
    assert refused.stderr.count("\n") == 1
    assert json.loads(run(path, "--fresh", "--json").stdout)["computed"] == 6


def test_bad_study_is_one_line_and_status_2(study_file, tmp_path):
    path = study_file(3)
    path.write_text(path.read_text(encoding="utf-8").replace("pad.loss_factor", "pads.loss_factor"))
    done = run(path)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r"permway: .*case 0 \(.*line\.laws\.pads.*\n", done.stderr)
    assert list(tmp_path.iterdir()) == [path]


def test_failed_cases_are_status_1(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        """
        [model]
        frequencies.values_Hz = [1.0]
        line.bodies.block = { type = "mass", mass_kg = 100.0 }
        line.laws.spring = { type = "hysteretic", stiffness = 3e3 }
        line.joints = [{ between = ["block", "ground"], law = "spring", at = [0.0] }]
        forces = [{ body = "block", x_m = 0.0 }]
        sensors = [{ body = "block", x_m = 0.0 }]
        [axes.k]
        path = "line.laws.spring.stiffness"
        values = [3e3, 3947.8417604357433]
        """,
        encoding="utf-8",
    )
    done = run(path, "--json")
    assert (done.returncode, done.stderr) == (1, "")
    stated = json.loads(done.stdout)
    assert [f["case"] for f in stated["failed"]] == [1]
    assert "at 1 Hz" in stated["failed"][0]["error"]


def test_the_examples_are_here():
    assert len(EXAMPLES) >= 2


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example(path, tmp_path):
    done = run(path, "-o", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    data = open_study(tmp_path / "out")
    assert data.attrs["title"] == read_study(path).title != ""
    assert all(np.isfinite(v.values).all() for v in data.data_vars.values() if v.dtype.kind in "fc")


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_study_in_the_reference_is_right(number):
    study = study_from_dict(tomllib.loads(BLOCKS[number]), folder=ROOT / "examples")
    for index in range(study.plan.cases):
        study.model(index)


def test_reference_names_every_key():
    assert len(BLOCKS) >= 3
    named = set(re.findall(r"`([a-zA-Z_0-9]+)`", REFERENCE))
    records = (_File, Range, Sample)
    keys = {field.alias or name for record in records for name, field in record.model_fields.items()}
    assert (keys | {"path", "paths", "values", "labels"}) - named == set()
