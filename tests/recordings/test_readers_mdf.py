"""MDF by asammdf, which need not be installed."""

from __future__ import annotations

import gc
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.look import look
from permway.recordings.readers import read_time

asammdf = pytest.importorskip("asammdf")

X = np.random.default_rng(4).standard_normal((2, 60))


def write(path: Path, *, version: str = "4.10", **more: Any) -> Path:
    """A fast group of two channels, one of them converted, and a slow one of a temperature and a text."""
    t, slow = np.arange(60) / 512.0, np.arange(6) / 10.0
    signal = asammdf.Signal
    with asammdf.MDF(version=version) as file:
        whole = np.round(X[1] * 1000.0).astype("i4")
        fast = [
            signal(X[0], t, name="ax", unit="m/s^2", **more),
            signal(whole, t, name="force", unit="kN", conversion={"a": 0.001, "b": 0.0}),
        ]
        file.append(fast, acq_name="fast", common_timebase=True)
        texts = signal(np.array([b"on"] * 6), slow, name="state", encoding="utf-8")
        other = [signal(np.arange(6.0), slow, name="ax", unit="degC"), texts]
        file.append(other, acq_name="slow", common_timebase=True)
        return Path(file.save(path, overwrite=True))


def test_channels_and_groups(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mf4")
    record = read_time(path, channels=["fast/ax", "force"])
    assert (record.units, record.sampling_Hz) == (("m/s^2", "kN"), 512.0)
    np.testing.assert_array_equal(record.values[0], X[0])
    np.testing.assert_allclose(record.values[1], np.round(X[1], 3), atol=1e-12)
    assert read_time(path, part="fast").channels == ("ax", "force")
    with pytest.raises(InputError, match="channel 'slow/ax': 6 samples where 'force' has 60"):
        read_time(path, channels=["force", "slow/ax"])
    with pytest.raises(InputError, match=r"channel 'state': samples must be real numbers"):
        read_time(path, channels=["state"])
    with pytest.raises(InputError, match=r"no such group \(got 'x'\); it has \['fast', 'slow'\]"):
        read_time(path, part="x")


def test_the_first_command(tmp_path: Path) -> None:
    found = {row["channel"]: row for row in look(write(tmp_path / "a.mf4"))["channels"]}
    assert found["fast/ax"]["sampling_Hz"] == 512.0
    assert found["slow/ax"]["unit"] == "degC"


def test_invalid_samples(tmp_path: Path) -> None:
    bits = np.zeros(60, dtype=bool)
    bits[[7, 9]] = True
    path = write(tmp_path / "a.mf4", invalidation_bits=bits)
    with pytest.raises(InputError, match=r"2 samples are marked as invalid \(got 'the first is sample 7'\)"):
        read_time(path, channels=["fast/ax"])
    assert read_time(path, channels=["force"]).values.shape == (1, 60)


def test_over_an_angle(tmp_path: Path) -> None:
    angle = asammdf.Signal(X[0], np.arange(60.0), name="ax", master_metadata=("crank", 2))
    with asammdf.MDF(version="4.10") as file:
        file.append([angle], common_timebase=True)
        path = Path(file.save(tmp_path / "a.mf4"))
    with pytest.raises(InputError, match="stands over angle"):
        read_time(path)
    assert read_time(path, sampling_Hz=100.0, hints=_no_times()).sampling_Hz == 100.0


def _no_times() -> Any:
    from permway.recordings.readers.hints import Hints

    return Hints(time_column="none")


def test_without_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "a.mf4")
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(InputError, match=r"asammdf, which is not installed; pip install 'permway\[mdf\]'"):
        read_time(path)


# What the library states to nobody while it drops a damaged file is not of the reader.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("keep", [64, 300, 1500])
def test_cut_short(keep: int, tmp_path: Path) -> None:
    path = write(tmp_path / "a.mf4")
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(InputError):
        read_time(path, channels=["force"])
    gc.collect()


def test_not_finalised(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mf4")
    path.write_bytes(b"UnFinMF " + path.read_bytes()[8:])
    with pytest.raises(InputError, match="was not finalised"):
        read_time(path)
