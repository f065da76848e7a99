"""Sweeps on this machine: what lies in the folder, what is computed again, what comes out as one dataset."""

import json
import os
import signal
import sys

import numpy as np
import pytest
import xarray as xr
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.problem.solve import solve
from permway.study import local, open_study, run_study, study_from_dict
from permway.study.answer import CaseResult

PAD = "line.laws.pad."


def files(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.glob("case-*"))}


def direct(model, **pad):
    model["line"]["laws"]["pad"] |= pad
    return solve(model_from_dict(model), threads=1)["receptance"].values


def test_product(table, model, tmp_path):
    calls = []
    study = study_from_dict({**table, "title": "Pads"})
    done = run_study(study, tmp_path / "out", threads=1, progress=lambda *c: calls.append(c))
    assert (done.cases, done.computed, done.already_there, done.failed) == (6, 6, 0, {})
    assert calls == [(i, 6) for i in range(7)]
    data = open_study(tmp_path / "out")
    assert data["receptance"].dims == ("stiffness", "loss", "frequency", "sensor", "force")
    assert data["stiffness"].values.tolist() == [2e7, 5e7, 8e7]
    assert data["stiffness"].attrs["sets"] == PAD + "stiffness"
    assert data["receptance"].attrs["units"] == "m/N"
    assert data.attrs["title"] == "Pads"
    assert (data["case_status"] == "done").all()
    got = data["receptance"].sel(stiffness=5e7, loss=0.3).values
    assert np.array_equal(got, direct(model, stiffness=5e7, loss_factor=0.3))


def test_zip_and_sample(table, tmp_path):
    table["axes"]["loss"]["values"] = [0.1, 0.2, 0.3]
    run_study(study_from_dict({**table, "combine": "zip"}), tmp_path / "zip", threads=1)
    data = open_study(tmp_path / "zip")
    assert data["receptance"].dims[:2] == ("case", "frequency")
    assert data["loss"].dims == ("case",)
    table["axes"]["stiffness"]["values"] = {"from": 2e7, "to": 8e7}
    study = study_from_dict({**table, "combine": "sample", "sample": {"count": 3, "seed": 1}})
    run_study(study, tmp_path / "sample", threads=1)
    data = open_study(tmp_path / "sample")
    assert data["receptance"].dims[:3] == ("sample", "loss", "frequency")
    assert data["stiffness"].dims == ("sample",)


def test_without_dask_the_same_is_read_at_once(table, tmp_path, monkeypatch):
    run_study(study_from_dict(table), tmp_path / "out", threads=1)
    lazy = open_study(tmp_path / "out")
    assert lazy["receptance"].chunks[:2] == ((1, 1, 1), (1, 1))
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "dask.array", None)
        whole = open_study(tmp_path / "out")
    assert whole["receptance"].chunks is None
    xr.testing.assert_identical(lazy.compute(), whole)


def test_processes_give_the_same_files(table, tmp_path, monkeypatch):
    study = study_from_dict(table)
    run_study(study, tmp_path / "loop", threads=1)
    monkeypatch.setattr(local, "START_S", 0.0)
    run_study(study, tmp_path / "processes", threads=2)
    assert files(tmp_path / "processes") == files(tmp_path / "loop")
    assert len(files(tmp_path / "loop")) == 6


def test_only_what_is_missing_is_computed(table, tmp_path):
    study = study_from_dict(table)
    run_study(study, tmp_path / "out", threads=1)
    before = files(tmp_path / "out")
    times = {p: p.stat().st_mtime_ns for p in (tmp_path / "out").glob("case-*")}
    gone = sorted(times)[3]
    gone.unlink()
    (tmp_path / "out" / f".{gone.name}.abc.part").write_bytes(b"half")
    done = run_study(study, tmp_path / "out", threads=1)
    assert (done.computed, done.already_there) == (1, 5)
    assert files(tmp_path / "out") == before
    assert all(p.stat().st_mtime_ns == t for p, t in times.items() if p != gone)
    assert not list((tmp_path / "out").glob(".*.part"))


def test_another_study_is_not_mixed_in(table, tmp_path):
    run_study(study_from_dict(table), tmp_path / "out", threads=1)
    before = files(tmp_path / "out")
    table["axes"]["loss"]["values"] = [0.1, 0.25]
    with pytest.raises(InputError, match=r"out: holds the results of another study.*--fresh"):
        run_study(study_from_dict(table), tmp_path / "out", threads=1)
    assert files(tmp_path / "out") == before
    run_study(study_from_dict(table), tmp_path / "out", threads=1, fresh=True)
    assert open_study(tmp_path / "out")["loss"].values.tolist() == [0.1, 0.25]
    assert len(files(tmp_path / "out")) == 6


def test_a_manifest_that_is_none(table, tmp_path):
    study, folder = study_from_dict(table), tmp_path / "out"
    run_study(study, folder, threads=1)
    whole = (folder / "study.json").read_text(encoding="utf-8")
    for text, message in [("{", "is not JSON"), ("[]", "is no manifest")]:
        (folder / "study.json").write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=message):
            run_study(study, folder, threads=1)
    (folder / "study.json").write_text(whole.replace("20000000.0", "30000000.0"), encoding="utf-8")
    with pytest.raises(InputError, match="was changed"):
        open_study(folder)
    with pytest.raises(InputError, match="cannot be read"):
        open_study(tmp_path)


def test_one_sweep_at_a_time(table, tmp_path):
    folder, met = tmp_path / "out", []

    def again(_done, _total):
        with pytest.raises(InputError, match="another sweep is writing here"):
            run_study(study_from_dict(table), folder, threads=1)
        met.append(1)

    run_study(study_from_dict(table), folder, threads=1, progress=again)
    assert met


@pytest.fixture
def resonant(table):
    """An undamped mass on a spring whose resonance the second case hits."""
    table["model"] |= {
        "frequencies": {"values_Hz": [0.5, 1.0, 2.0]},
        "line": {
            "bodies": {"block": {"type": "mass", "mass_kg": 100.0}},
            "laws": {"spring": {"type": "hysteretic", "stiffness": 1.0}},
            "joints": [{"between": ["block", "ground"], "law": "spring", "at": [0.0]}],
        },
        "forces": [{"body": "block", "x_m": 0.0}],
        "sensors": [{"body": "block", "x_m": 0.0}],
    }
    table["axes"] = {"k": {"path": "line.laws.spring.stiffness", "values": [3e3, (2.0 * np.pi) ** 2 * 100.0, 5e3]}}
    return table


def test_a_failed_case_is_data(resonant, tmp_path):
    study = study_from_dict(resonant)
    for _ in range(2):  # what failed is tried again, and may fail again
        done = run_study(study, tmp_path / "out", threads=1)
        assert list(done.failed) == [1]
        assert "at 1 Hz" in done.failed[1]
    assert (done.computed, done.already_there) == (0, 2)
    manifest = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))
    assert manifest["failed"][0]["case"] == 1
    data = open_study(tmp_path / "out")
    assert data["case_status"].values.tolist() == ["done", "failed", "done"]
    assert np.isnan(data["receptance"].values).all(axis=(1, 2, 3)).tolist() == [False, True, False]
    assert json.loads(data.attrs["failed"]) == manifest["failed"]


def test_a_sweep_under_way_can_be_opened(table, tmp_path):
    study, folder = study_from_dict(table), tmp_path / "out"
    run_study(study, folder, threads=1)
    (folder / study.plan.file_name(0)).unlink()
    assert open_study(folder)["case_status"].values.ravel().tolist() == ["missing"] + 5 * ["done"]
    for path in folder.glob("case-*"):
        path.unlink()
    with pytest.raises(InputError, match="no case is done"):
        open_study(folder)


def test_places_that_move_stand_along_the_axis(table, tmp_path):
    table["axes"] = {"x_m": {"path": "sensors[1].x_m", "values": [0.3, 0.6, 1.2]}}
    run_study(study_from_dict(table), tmp_path / "named", threads=1)
    data = open_study(tmp_path / "named")
    assert data["sensor_x"].dims == ("x_m", "sensor")
    assert data["sensor_x"].values[:, 1].tolist() == [0.3, 0.6, 1.2]
    del table["model"]["sensors"][1]["name"]
    run_study(study_from_dict(table), tmp_path / "unnamed", threads=1)
    with pytest.raises(InputError, match="cases differ in sensor"):
        open_study(tmp_path / "unnamed")


class _Dies:
    """A study of which one case takes its process along."""

    def __init__(self, study, times, mark):
        self._study, self._times, self._mark = study, times, mark
        self.plan, self.keep = study.plan, study.keep

    def model(self, index):
        if index == 2 and os.getpid() != self._mark[0]:
            deaths = list(self._mark[1].glob("death*"))
            if len(deaths) < self._times:
                (self._mark[1] / f"death{len(deaths)}").touch()
                os.kill(os.getpid(), signal.SIGKILL)
        return self._study.model(index)


@pytest.mark.parametrize(("times", "fails"), [(1, False), (99, True)])
def test_a_process_that_dies_is_replaced(times, fails, table, tmp_path, monkeypatch):
    monkeypatch.setattr(local, "START_S", 0.0)
    study = _Dies(study_from_dict(table), times, (os.getpid(), tmp_path))
    answers = dict(local.solve_locally(study, range(6), 2))
    assert sorted(answers) == list(range(6))
    assert all(isinstance(got, CaseResult) and got.content for i, got in answers.items() if i != 2)
    assert bool(answers[2].error) == fails
    if fails:
        assert "died, 3 times (exit code -9)" in answers[2].error


def test_notes_are_reported_once(table, tmp_path):
    table["model"]["train"] = {
        "vehicle": {"preset": "crh380a", "share": 0.5},
        "centre_m": 0.9,
        "speed_m_per_s": 90.0,
    }
    table["model"]["irregularity"] = {"type": "german_low"}
    with pytest.warns(UserWarning, match="GermanLow covers") as met:
        run_study(study_from_dict(table), tmp_path / "out", threads=1)
    assert len(met) == len({str(note.message) for note in met})
