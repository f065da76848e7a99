"""A sweep on a real Dask cluster: a scheduler and two workers, each a process of its own."""

import io
import os
import signal
import threading

import pytest
import xarray as xr
from permway.errors import InputError
from permway.study import cluster as cluster_module
from permway.study import read_study, run_study

distributed = pytest.importorskip("distributed")
# What distributed states about itself on closing, above all when a worker was killed.
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

COUNT = 16


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=":0",
        host="127.0.0.1",
        silence_logs=50,
    ) as local:
        yield local


@pytest.fixture(scope="module")
def here(study_in, tmp_path_factory):
    folder = tmp_path_factory.mktemp("here")
    path = study_in(folder, COUNT)
    run_study(read_study(path), folder / "here", threads=1)
    return read_study(path), files(folder / "here")


def files(folder):
    return {path.name: path.read_bytes() for path in folder.glob("case-*.nc")}


def assert_same(folder, expected):
    """All numbers, names and attributes. HDF5 may lay the same out otherwise in another process: seen in CI."""
    found = files(folder)
    assert found.keys() == expected.keys()
    for name in sorted(found):
        with (
            xr.open_dataset(io.BytesIO(found[name]), engine="h5netcdf") as one,
            xr.open_dataset(io.BytesIO(expected[name]), engine="h5netcdf") as other,
        ):
            xr.testing.assert_identical(one, other)


def test_the_same_numbers_as_here_also_when_a_worker_is_killed(cluster, here, tmp_path):
    study, expected = here
    done = run_study(study, tmp_path / "whole", scheduler=cluster.scheduler_address)
    assert (done.computed, done.failed) == (2 * COUNT, {})
    assert_same(tmp_path / "whole", expected)

    before = {worker.pid for worker in cluster.workers.values()}
    killed = []

    def kill(cases, _total):
        if cases == 10 and not killed:
            killed.append(next(iter(cluster.workers.values())).pid)
            os.kill(killed[0], signal.SIGKILL)

    done = run_study(study, tmp_path / "killed", scheduler=cluster.scheduler_address, progress=kill)
    assert killed
    assert killed[0] in before
    assert (done.computed, done.failed) == (2 * COUNT, {})
    assert_same(tmp_path / "killed", expected)


def test_no_more_cases_are_out_than_the_bound(cluster, here, tmp_path, monkeypatch):
    study, expected = here
    monkeypatch.setattr(cluster_module, "MOST_UNDER_WAY", 3)
    most, submit = [0], distributed.Client.submit

    def count(client, *arguments, **options):
        future = submit(client, *arguments, **options)
        most[0] = max(most[0], sum(f.status == "pending" for f in client.futures.values()))
        return future

    monkeypatch.setattr(distributed.Client, "submit", count)
    run_study(study, tmp_path / "out", scheduler=cluster.scheduler_address)
    assert 1 <= most[0] <= 3
    assert_same(tmp_path / "out", expected)


def test_a_stopped_sweep_goes_on_there_or_here(cluster, here, tmp_path):
    study, expected = here

    def stop(done, _total):
        if done >= 12:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(study, tmp_path / "out", scheduler=cluster.scheduler_address, progress=stop)
    there = files(tmp_path / "out")
    assert len(there) == 12
    done = run_study(study, tmp_path / "out", scheduler=cluster.scheduler_address)
    assert done.already_there == 12
    assert_same(tmp_path / "out", expected)


def test_a_worker_of_another_version(cluster, here, tmp_path, monkeypatch):
    study, _ = here
    monkeypatch.setattr(cluster_module, "_core", type("Core", (), {"__version__": "0.0.0"}))
    done = run_study(study, tmp_path / "out", scheduler=cluster.scheduler_address)
    assert len(done.failed) == 2 * COUNT
    assert "the client 0.0.0: install the same" in done.failed[0]


def test_no_scheduler(here, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_module, "CONNECT_S", 0.5)
    with pytest.raises(InputError, match=r"scheduler: no scheduler answers.*127\.0\.0\.1:9'"):
        run_study(here[0], tmp_path / "out", scheduler="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="scheduler"):
        run_study(here[0], tmp_path / "out", scheduler="nonsense://x")
    assert threading.active_count() < 50


def test_no_worker(here, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_module, "CONNECT_S", 1.0)
    with (
        distributed.LocalCluster(
            n_workers=0, dashboard_address=":0", host="127.0.0.1", protocol="tcp", processes=False, silence_logs=50
        ) as empty,
        pytest.raises(InputError, match="the scheduler has no worker"),
    ):
        run_study(here[0], tmp_path / "out", scheduler=empty.scheduler_address)
