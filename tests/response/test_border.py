"""Where Python meets the core: Ctrl-C, progress, fork, threads, small sweeps, failed frequencies, files."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
import xarray as xr
from permway.errors import InputError, SolveError
from permway.formats.model_file import model_from_dict
from permway.laws import Hysteretic
from permway.model.bodies import Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.problem.solve import solve, write_dataset
from permway.response.quantities import accelerance
from permway.response.receptance import CONVENTION, receptance

LINE = slab_track_viaduct_32m(pad=wj7b_constant())
MIDSPAN = [Place(body="rail", x_m=16.0), Place(body="girder", x_m=16.0)]
BAND = np.linspace(1.0, 1000.0, 200)
LONG = np.linspace(1.0, 1000.0, 200_000)

ENDLESS_SWEEP = {
    "chain": "line, f = slab_track_viaduct_32m(pad=wj7b_constant()), np.linspace(1.0, 1000.0, 1_000_000)",
    "receptance": "line, f = slab_track_viaduct_32m(spans=6, pad=wj7b_constant()), np.linspace(1.0, 1000.0, 2000)",
}
INTERRUPTED = """
    import os, signal, threading, time
    import numpy as np
    from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
    # A shell may start its children with the signal ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    from permway.model.place import Place
    from permway.response.receptance import receptance

    {sweep}
    at = [Place(body="rail", x_m=16.0)]
    sent = []

    def interrupt():
        time.sleep(0.5)
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    try:
        receptance(line, f, forces=at, sensors=at, formulation={formulation!r}, threads=1)
    except KeyboardInterrupt:
        print(time.monotonic() - sent[0])
    else:
        print("the sweep ended by itself")
"""


def solved(frequency=BAND, **options):
    return receptance(LINE, frequency, forces=MIDSPAN[:1], sensors=MIDSPAN, **options)


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_ctrl_c_stops_a_sweep_within_a_second(formulation):
    code = textwrap.dedent(INTERRUPTED).format(sweep=ENDLESS_SWEEP[formulation], formulation=formulation)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert float(done.stdout) < 1.0
    assert done.stderr == ""


def test_progress_counts_up_to_the_end():
    calls = []
    solved(LONG[:20_000], threads=1, progress=lambda done, total: calls.append((done, total)))
    assert len(calls) >= 2
    assert calls == sorted(calls)
    assert calls[-1] == (20_000, 20_000)
    assert {total for _, total in calls} == {20_000}


def test_progress_is_reported_for_a_sweep_too_short_to_watch():
    calls = []
    solved(BAND[:3], progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (3, 3)


class EnoughError(Exception):
    pass


@pytest.mark.parametrize("error", [EnoughError("enough"), ValueError("not of the core"), KeyboardInterrupt()])
def test_exception_from_progress_stops_the_sweep_and_comes_out_as_it_is(error):
    def stop(done, total):
        assert done < total, "the sweep was not stopped"
        raise error

    start = time.monotonic()
    with pytest.raises(type(error)) as caught:
        solved(LONG, threads=1, progress=stop)
    assert caught.value is error
    assert time.monotonic() - start < 2.0


def in_child(queue):
    queue.put(solved(threads=2)["receptance"].values)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_sweep_in_a_forked_child_after_a_sweep():
    """Nothing of a sweep stays behind that a fork would lose: no pool, no lock."""
    expected = solved(threads=2)["receptance"].values
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        try:
            os.write(writer, solved(threads=2)["receptance"].values[-1].tobytes())
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as pipe:
        got = pipe.read()
    assert os.waitpid(child, 0)[1] == 0
    assert got == expected[-1].tobytes()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_sweeps_in_several_forked_processes():
    expected = solved(threads=2)["receptance"].values
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    children = [context.Process(target=in_child, args=(queue,), daemon=True) for _ in range(3)]
    for child in children:
        child.start()
    answers = [queue.get(timeout=30) for _ in children]
    for child in children:
        child.join(timeout=30)
        assert child.exitcode == 0
    assert all(np.array_equal(answer, expected) for answer in answers)


def test_ten_threads_at_once_answer_alike():
    expected = solved(threads=1)["receptance"].values
    answers = [None] * 10

    def run(i):
        answers[i] = solved(threads=1 + i % 3)["receptance"].values

    threads = [threading.Thread(target=run, args=(i,)) for i in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert all(np.array_equal(answer, expected) for answer in answers)


def test_the_interpreter_runs_on_while_the_core_sweeps():
    """A counter in another thread keeps counting: the interpreter is released."""
    counted, running = [0], [True]

    def count():
        while running[0]:
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    start = time.monotonic()
    try:
        solved(LONG[:30_000], threads=1)
    finally:
        running[0] = False
        counter.join()
    assert counted[0] > 50 * (time.monotonic() - start)


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_sweep_of_no_frequency_is_refused_and_of_one_is_that_of_a_number(formulation):
    with pytest.raises(InputError, match="frequency"):
        solved(BAND[:0], formulation=formulation, extensions=True)
    one = solved(BAND[100:101], formulation=formulation)
    assert np.array_equal(one["receptance"].values[0], solved(formulation=formulation)["receptance"].values[100])
    assert np.array_equal(one["receptance"], solved(BAND[100], formulation=formulation)["receptance"])


BLOCK = Line(
    bodies={"block": Mass(mass_kg=100.0)},
    joints=(Joints(between=("block", "ground"), law="spring", at=(0.0,)),),
    laws={"spring": Hysteretic(stiffness=(2.0 * np.pi) ** 2 * 100.0)},
)
ON_BLOCK = [Place(body="block", x_m=0.0)]


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_a_frequency_that_fails_is_data(formulation):
    """Undamped and at resonance at 1 Hz: that frequency is NaN and named, 1 / (k - m omega^2) stands elsewhere."""
    frequency = np.array([0.5, 1.0, 2.0])
    marked = receptance(
        BLOCK,
        frequency,
        forces=ON_BLOCK,
        sensors=ON_BLOCK,
        formulation=formulation,
        extensions=True,
        on_error="mark",
    )
    value = marked["receptance"].values[:, 0, 0]
    assert np.isnan(value).tolist() == [False, True, False]
    assert np.isnan(marked["extension"].values[:, 0, 0]).tolist() == [False, True, False]
    expected = 1.0 / (100.0 * (2.0 * np.pi) ** 2 * (1.0 - frequency[[0, 2]] ** 2))
    np.testing.assert_allclose(value[[0, 2]], expected, rtol=1e-13)
    assert "at 1 Hz" in marked.attrs["failures"]
    with pytest.raises(SolveError, match="at 1 Hz"):
        receptance(BLOCK, frequency, forces=ON_BLOCK, sensors=ON_BLOCK, formulation=formulation)


PAD = {"type": "tabulated", "frequency_Hz": [1.0, 500.0], "storage": [6e7, 8e7], "loss_factor": [0.1, 0.2]}
MODEL = {
    "title": "Midspan",
    "frequencies": {"values_Hz": [10.0, 100.0]},
    "line": {
        "preset": "slab_track_viaduct_32m",
        "laws": {
            "pad": {
                "type": "tabulated",
                "frequency_Hz": [1.0, 500.0],
                "storage": [6e7, 8e7],
                "loss_factor": [0.1, 0.2],
            }
        },
    },
    "temperature_C": 20.0,
    "train": {"vehicle": {"preset": "crh380a", "share": 0.5}, "centre_m": 16.0, "speed_km_per_h": 350},
    "irregularity": {"type": "german_sato"},
    "forces": [{"body": "rail", "x_m": 16.0}],
    "sensors": [{"body": "rail", "x_m": 16.0}, {"body": "girder", "x_m": 16.0}],
}


def test_dataset_states_what_it_holds():
    data = solve(model_from_dict(MODEL), threads=1)
    assert data.attrs["convention"].startswith(CONVENTION)
    assert "one-sided" in data.attrs["convention"]
    assert data.attrs["title"] == "Midspan"
    assert data.attrs["temperature_C"] == 20.0
    assert data.attrs["speed_m_per_s"] == pytest.approx(350 / 3.6)
    assert data.attrs["permway_version"]
    for name, variable in data.data_vars.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert data["frequency"].attrs == {"long_name": "frequency", "units": "Hz"}
    assert data["sensor_body"].values.tolist() == ["rail", "girder"]
    assert accelerance(data["receptance"]).attrs["units"] == "m/s2/N"


def test_dataset_holds_the_model_it_came_from():
    """The text in the dataset reads back to the same model, presets filled in."""
    model = model_from_dict(MODEL)
    text = solve(model, threads=1).attrs["model"]
    assert model_from_dict(json.loads(text)) == model


@pytest.mark.parametrize("in_memory", [True, False])
def test_file_keeps_every_bit(in_memory, tmp_path, monkeypatch):
    if not in_memory:
        monkeypatch.setattr("permway.problem.solve.LARGEST_IN_MEMORY", 0)
    data = solve(model_from_dict(MODEL), threads=1)
    path = write_dataset(data, tmp_path / "answer.nc")
    with xr.open_dataset(path, engine="h5netcdf") as read:
        xr.testing.assert_identical(read.load(), data)
    assert [p.name for p in tmp_path.iterdir()] == ["answer.nc"]


def test_file_is_as_public_as_any_other(tmp_path):
    plain = tmp_path / "plain"
    plain.touch()
    path = write_dataset(solved(BAND[:1]), tmp_path / "answer.nc")
    assert path.stat().st_mode == plain.stat().st_mode


def test_file_replaces_an_older_one(tmp_path):
    path = tmp_path / "answer.nc"
    path.write_text("old")
    write_dataset(solved(BAND[:1]), path)
    with xr.open_dataset(path, engine="h5netcdf") as read:
        assert read.sizes["frequency"] == 1


def test_folder_that_does_not_exist(tmp_path):
    with pytest.raises(InputError, match=r"no/answer\.nc: cannot be written: No such file or directory"):
        write_dataset(solved(BAND[:1]), tmp_path / "no" / "answer.nc")
    assert list(tmp_path.iterdir()) == []


def test_place_taken_by_a_folder(tmp_path):
    (tmp_path / "answer.nc").mkdir()
    with pytest.raises(InputError, match=r"answer\.nc: cannot be written: Is a directory"):
        write_dataset(solved(BAND[:1]), tmp_path / "answer.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["answer.nc"]


@pytest.mark.parametrize(
    ("error", "comes_out"),
    [(OSError(28, "No space left on device"), InputError), (KeyboardInterrupt(), KeyboardInterrupt)],
)
def test_failed_write_leaves_nothing_behind(error, comes_out, tmp_path, monkeypatch):
    data = solved(BAND[:1])
    path = tmp_path / "answer.nc"
    path.write_text("old")

    def half(self, target, **_):
        with open(target, "wb") as file:
            file.write(b"half a file")
        raise error

    monkeypatch.setattr("permway.problem.solve.LARGEST_IN_MEMORY", 0)
    monkeypatch.setattr(xr.Dataset, "to_netcdf", half)
    with pytest.raises(comes_out):
        write_dataset(data, path)
    assert [p.name for p in tmp_path.iterdir()] == ["answer.nc"]
    assert path.read_text() == "old"
