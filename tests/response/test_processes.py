"""The same numbers in a spawned process, under Dask's threads, and from readers in several threads at once."""

import multiprocessing
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.recordings.readers import read_time
from permway.response.receptance import receptance

sys.path.append(str(Path(__file__).parents[1] / "recordings"))

import written

BAND = np.linspace(1.0, 300.0, 40)


def answer(x_m=16.0, threads=2):
    line = slab_track_viaduct_32m(pad=wj7b_constant())
    here = [Place(body="rail", x_m=x_m)]
    return receptance(line, BAND, forces=here, sensors=here, threads=threads).receptance.values


def test_in_a_spawned_process():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        there = pool.apply(answer)
    assert there.tobytes() == answer().tobytes()


def test_under_dask():
    dask = pytest.importorskip("dask")
    places = [2.0, 9.0, 16.0, 23.0]
    found = dask.compute(*[dask.delayed(answer)(x, 1) for x in places], scheduler="threads", num_workers=4)
    assert all(a.tobytes() == answer(x, 1).tobytes() for a, x in zip(found, places, strict=True))


@pytest.mark.parametrize("name", ["a.h5", "a.nc", "a.uff", "a.tdms"])
def test_readers_in_threads(name, tmp_path):
    samples = written.samples(200)
    written.WRITERS[name](tmp_path / name, samples)
    with ThreadPoolExecutor(4) as pool:
        records = list(pool.map(lambda _: read_time(tmp_path / name), range(4)))
    assert all(np.array_equal(record.values, records[0].values) for record in records)
    assert records[0].values.shape == samples.shape
