"""The command line as a user runs it: exit status, what is stated where, what is left behind."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from permway.formats.model_file import model_from_dict, read_model
from permway.laws import AnyLaw, Measured
from permway.model.bodies import Beam, BeamChange, Mass, Shaft
from permway.model.contact import GivenContact, HertzContact
from permway.model.irregularity import AnyIrregularity
from permway.model.joints import Ends, Joints, Spread
from permway.model.place import Place
from permway.model.presets import LAWS, LINES, SlabTrackViaduct
from permway.model.roll import Lever, Roll, Rolling, Twisting
from permway.model.shafts import ShaftChange
from permway.model.train import Train
from permway.model.vehicle import Vehicle
from permway.model.vehicle_presets import VEHICLES
from permway.problem.model import Frequencies
from permway.problem.solve import solve

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
MODELS = [path for path in EXAMPLES if "frequencies" in tomllib.loads(path.read_text(encoding="utf-8"))]
REFERENCE = (ROOT / "docs" / "model-file.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```toml\n(.*?)^```", REFERENCE, flags=re.MULTILINE | re.DOTALL)

SMALL = """
temperature_C = 20.0

[frequencies]
values_Hz = [10.0, 100.0]

[line]
preset = "slab_track_viaduct_32m"

[[forces]]
body = "rail"
x_m = 16.0

[[sensors]]
body = "rail"
x_m = 16.0
"""
SINGULAR = """
[frequencies]
values_Hz = [1.0]

[line]
bodies = { block = { type = "mass", mass_kg = 100.0 } }
laws = { spring = { type = "hysteretic", stiffness = 3947.8417604357433 } }
joints = [{ between = ["block", "ground"], law = "spring", at = [0.0] }]

[[forces]]
body = "block"
x_m = 0.0

[[sensors]]
body = "block"
x_m = 0.0
"""


def run(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "permway", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_the_examples_are_here():
    assert {"viaduct.toml", "sleepers.toml", "hammer.toml"} <= {path.name for path in MODELS}


@pytest.mark.parametrize("model", MODELS, ids=lambda path: path.stem)
def test_example_is_solved(model, tmp_path):
    output = tmp_path / "answer.nc"
    done = run("solve", model, "-o", output, "--threads", 1)
    assert (done.returncode, done.stderr) == (0, "")
    stated = dict(line.split(maxsplit=1) for line in done.stdout.splitlines() if not line.startswith(" "))
    assert stated["dataset"] == str(output)
    with xr.open_dataset(output, engine="h5netcdf") as data:
        assert int(stated["frequencies"]) == data.sizes["frequency"]
        assert all(np.isfinite(values.values).all() for values in data.data_vars.values())
        assert data.attrs["title"] == read_model(model).title != ""


def test_json_is_all_that_is_reported(small):
    done = run("solve", small, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    stated = json.loads(done.stdout)
    assert stated == {"dataset": str(small.with_suffix(".nc")), "frequencies": 2, "variables": ["receptance"]}
    assert small.with_suffix(".nc").exists()


def stated_once(done, status):
    assert done.returncode == status, done.stderr
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("permway: ")
    assert "Traceback" not in done.stderr
    return done.stderr


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x_m = 16.0\n\n[[sensors", "x_m = inf\n\n[[sensors", "forces[0].x_m: input should be a finite number"),
        ("slab_track_viaduct_32m", "viaduct", "line.preset: no such preset (got 'viaduct')"),
        ("[10.0, 100.0]", "[100.0, 10.0]", "frequencies.values_Hz[1]: frequencies must ascend"),
        ("[line]", "[line", "is not TOML: Expected ']'"),
        (
            '[[sensors]]\nbody = "rail"',
            '[[sensors]]\nbody = "[red]rail[/red]"',
            "no such body (got '[red]rail[/red]')",
        ),
    ],
)
def test_bad_file_is_one_line_and_status_2(old, new, message, small):
    assert old in SMALL
    small.write_text(SMALL.replace(old, new, 1), encoding="utf-8")
    text = stated_once(run("solve", small), 2)
    assert message in text
    assert str(small) in text
    assert list(small.parent.iterdir()) == [small]


def test_missing_file(tmp_path):
    assert "none.toml: cannot be read" in stated_once(run("solve", tmp_path / "none.toml", "--json"), 2)
    assert list(tmp_path.iterdir()) == []


def test_singular_model_is_status_1(tmp_path):
    path = tmp_path / "singular.toml"
    path.write_text(SINGULAR, encoding="utf-8")
    assert "at 1 Hz: block" in stated_once(run("solve", path), 1)
    assert list(tmp_path.iterdir()) == [path]


def test_folder_that_does_not_exist_is_reported_before_the_sweep(small):
    assert "there is no such folder" in stated_once(run("solve", small, "-o", small.parent / "no" / "a.nc"), 2)


def test_the_model_is_not_overwritten(small):
    assert "is the model file itself" in stated_once(run("solve", small, "-o", small), 2)
    assert small.read_text(encoding="utf-8") == SMALL
    named_as_data = small.rename(small.with_name("model.nc"))
    assert "is the model file itself" in stated_once(run("solve", named_as_data), 2)


def test_a_warning_is_one_line_beside_the_answer(small):
    """Beyond the spectrum's wavelengths: stated, and computed all the same."""
    train = '[train]\ncentre_m = 16.0\nspeed_km_per_h = 300\nvehicle = { preset = "crh380a", share = 0.5 }\n'
    small.write_text(SMALL + train + '[irregularity]\ntype = "german_low"\n', encoding="utf-8")
    done = run("solve", small)
    assert done.returncode == 0
    assert re.fullmatch(r"permway: note: GermanLow covers wavelengths from 1 to 100 m.*\n", done.stderr)


@pytest.mark.parametrize(
    "arguments", [["solve"], ["solve", "a.toml", "--threads", "0"], ["sollve"], ["--nonsense"]]
)
def test_wrong_usage_is_status_2(arguments):
    done = run(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert "Usage:" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("command", [None, "solve", "fit-pad", "reproduce", "sweep", "doctor"])
def test_help(command):
    done = run(*([command] if command else []), "--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Usage:")
    assert "--json" in done.stdout


def test_version():
    done = run("--version")
    assert (done.returncode, done.stderr) == (0, "")
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", done.stdout)


def test_doctor():
    stated = json.loads(run("doctor", "--json").stdout)
    assert stated["permway"] == run("--version").stdout.strip()
    assert stated["python"] == ".".join(map(str, sys.version_info[:3]))
    assert stated["processors"] == os.cpu_count()
    assert {"numpy", "scipy", "xarray", "machine"} <= stated.keys()
    assert len(run("doctor").stdout.splitlines()) == len(stated)


INTERRUPTED = """
import os, signal, sys, threading
from permway.cli import main

threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGINT)).start()
main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_is_one_line_and_status_130(tmp_path):
    path = tmp_path / "long.toml"
    path.write_text(SMALL.replace("values_Hz = [10.0, 100.0]", "from_Hz = 1.0\nto_Hz = 900.0\npoints = 1_000_000"))
    command = [sys.executable, "-c", INTERRUPTED, "solve", str(path), "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "permway: interrupted\n")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_model_in_the_reference_is_right(number):
    """Each file printed in docs/model-file.md is read and solved."""
    data = solve(model_from_dict(tomllib.loads(BLOCKS[number])), threads=1)
    assert all(np.isfinite(values.values).all() for values in data.data_vars.values())


def test_reference_names_every_key_and_type():
    assert len(BLOCKS) >= 3
    named = set(re.findall(r"`([a-zA-Z_0-9]+)`", REFERENCE))
    types = set(re.findall(r'"([a-z_0-9]+)"', REFERENCE))
    irregularities = AnyIrregularity.__origin__.__args__
    records = [
        Beam,
        BeamChange,
        Shaft,
        ShaftChange,
        Mass,
        Measured,
        Roll,
        Twisting,
        Rolling,
        Lever,
        GivenContact,
        HertzContact,
        Frequencies,
        Joints,
        SlabTrackViaduct,
        Vehicle,
        Place,
    ]
    keys = {key for record in [*records, *irregularities] for key in record.model_fields} - {"type"}
    assert keys - named - {"scale"} == set()
    for record in (Ends, Spread, Train):
        assert all(re.search(rf"\b{key}\b", REFERENCE) for key in record.model_fields), record
    laws = {law.model_fields["type"].default for law in AnyLaw.__origin__.__args__}
    spectra = {spectrum.model_fields["type"].default for spectrum in irregularities}
    assert (laws | spectra | set(VEHICLES) | set(LAWS)) - types - named == set()
    assert set(LINES) <= named
