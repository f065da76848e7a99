"""Random files by each format's usual writer, read back: the same in SI, or a refusal; never anything else.

The same for ten thousand files: `python tests/fuzz/ten_thousand.py`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import drawn_arrays
import drawn_mdf
import drawn_tables
import drawn_text
import drawn_uff
import numpy as np
import pytest
from drawn import Writer, outcome
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.recordings.readers import hdf5, mat_objects, mat_objects_child

WRITERS: dict[str, Writer] = {
    "text": drawn_text.times, "text frf": drawn_text.frf, "text frf wide": drawn_text.frf_wide,
    "uff": drawn_uff.times, "uff frf": drawn_uff.frf,
    "mat": drawn_arrays.mat, "mat73": drawn_arrays.mat73, "npz": drawn_arrays.npz, "hdf5": drawn_arrays.hdf5,
    "netcdf": drawn_arrays.netcdf, "tdms": drawn_arrays.tdms, "mat frf": drawn_arrays.frf_mat,
    "mat73 frf": drawn_arrays.frf_mat73, "npz frf": drawn_arrays.frf_npz, "hdf5 frf": drawn_arrays.frf_hdf5,
    "netcdf frf": drawn_arrays.frf_netcdf,
}  # fmt: skip
if find_spec("asammdf") is not None:
    WRITERS["mdf"] = drawn_mdf.times
if find_spec("matio") is not None:
    WRITERS["tables"] = drawn_tables.times


@pytest.fixture(autouse=True, scope="module")
def _no_trial() -> Iterator[None]:
    """No file here is damaged: that libraries come to an end need not be tried in a process of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hdf5, "check_sound", lambda _: None)
        patch.setattr(mat_objects, "_extract", lambda source, to: mat_objects_child.main(str(source), str(to)))
        yield


@pytest.mark.parametrize("kind", WRITERS)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_read_back_or_refused(kind: str, seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path, meaning = WRITERS[kind](np.random.default_rng(seed), Path(folder))
        assert not outcome(meaning, path).startswith("wrong")


@pytest.mark.parametrize("kind", WRITERS)
def test_most_are_read(kind: str, tmp_path: Path) -> None:
    """A reader that refuses everything is never wrong: of eight files of each kind, three at least are read."""
    found = []
    for seed in range(8):
        path, meaning = WRITERS[kind](np.random.default_rng(seed), tmp_path)
        found.append(outcome(meaning, path))
    assert sum(text == "right" for text in found) >= 3, found
