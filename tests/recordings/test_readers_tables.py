"""Tables and timetables of MATLAB by mat-io, which need not be installed."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.readers import mat_objects, mat_objects_child, read_frf, read_time

pd = pytest.importorskip("pandas")
matio = pytest.importorskip("matio")

X = np.random.default_rng(5).standard_normal((2, 40))


@pytest.fixture
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take tables out in this process: a process of its own lasts seconds, and is tried by some tests below."""
    monkeypatch.setattr(mat_objects, "_extract", lambda source, to: mat_objects_child.main(str(source), str(to)))


def timetable() -> Any:
    index = pd.Index((np.arange(40) * 1_953_125).astype("timedelta64[ns]"), name="Time")
    return pd.DataFrame({"ax": X[0], "ay": X[1]}, index=index)


def save(path: Path, version: str, **held: Any) -> Path:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        matio.save_to_mat(str(path), mdict=held, version=version)
    return path


@pytest.mark.usefixtures("_here")
@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_timetables(version: str, tmp_path: Path) -> None:
    path = save(tmp_path / "a.mat", version, TT=timetable(), other=timetable() * 2.0)
    with pytest.raises(InputError, match=r'more than one array of times .*part = "(TT|other)"'):
        read_time(path)
    for part, factor in (("TT", 1.0), ("other", 2.0)):
        record = read_time(path, part=part)
        assert (record.channels, record.sampling_Hz) == (("ax", "ay"), 512.0)
        np.testing.assert_allclose(record.values, factor * X, rtol=1e-15)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_without_the_library(version: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = save(tmp_path / "a.mat", version, TT=timetable())
    monkeypatch.setattr(mat_objects, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"table2struct\(T, 'ToScalar', true\).*writetimetable.*permway\[mat\]"):
        read_time(path)


@pytest.mark.usefixtures("_here")
def test_a_table_of_a_response(tmp_path: Path) -> None:
    """A response alone needs no names; of several, what was read and struck has to be beside."""
    path = save(tmp_path / "a.mat", "v7.3", TT=timetable(), T=pd.DataFrame({"f": [1.0, 2.0], "H": [1j, 2j]}))
    record = read_frf(path, part="T")
    assert (record.responses, record.references) == (("response",), ("reference",))
    np.testing.assert_array_equal(record.values, [[1j, 2j]])


def test_damaged(tmp_path: Path) -> None:
    """Whatever byte is another: the same numbers, or a refusal, and never the end of this process."""
    path = save(tmp_path / "a.mat", "v7", TT=timetable())
    np.testing.assert_allclose(read_time(path).values, X, rtol=1e-15)
    raw = bytearray(path.read_bytes())
    raw[len(raw) // 2] ^= 0xFF
    path.write_bytes(raw)
    with pytest.raises(InputError):
        read_time(path)


def about(times: Any, **more: Any) -> Any:
    """What a timetable holds, as mat-io returns it raw."""
    fields = {
        "versionSavedFrom": np.array([[6.0]]), "minCompatibleVersion": np.array([[2.0]]),
        "varNames": np.array([["acc", "pair"]], dtype=object), "varUnits": np.array([["g", "mm/s"]], dtype=object),
        "data": _cells(np.arange(3.0)[:, None], np.arange(6.0).reshape(3, 2)), "rowTimes": times, **more,
    }  # fmt: skip
    table = np.empty((1, 1), dtype=[(name, object) for name in fields])
    for name, value in fields.items():
        table[name][0, 0] = value
    return table


def _cells(*values: np.ndarray) -> np.ndarray:
    found = np.empty((1, len(values)), dtype=object)
    for i, value in enumerate(values):
        found[0, i] = value
    return found


class Opaque:
    def __init__(self, classname: str, **properties: Any) -> None:
        self.classname, self.properties = classname, properties


def rate(as_rate: bool, origin: float = 0.0) -> Any:
    fields = {
        "origin": Opaque("duration", millis=np.array([[origin]])), "specifiedAsRate": np.array([[as_rate]]),
        "stepSize": Opaque("duration", millis=np.array([[0.5]])), "sampleRate": np.array([[2560.0]]),
    }  # fmt: skip
    table = np.empty((1, 1), dtype=[(name, object) for name in fields])
    for name, value in fields.items():
        table[name][0, 0] = value
    return table


def test_rows_by_a_rate_or_a_step() -> None:
    assert mat_objects_child._timetable(about(rate(True)))["rate_Hz"] == 2560.0
    found = mat_objects_child._timetable(about(rate(False, 250.0)))
    assert (found["step_s"], found["begins"]) == (0.0005, "250 ms")
    columns = {name: (unit, list(values)) for name, unit, values in found["columns"]}
    assert columns == {
        "acc": ("g", [0.0, 1.0, 2.0]),
        "pair_1": ("mm/s", [0.0, 2.0, 4.0]),
        "pair_2": ("mm/s", [1.0, 3.0, 5.0]),
    }


def test_dates_keep_what_their_milliseconds_round_off() -> None:
    exact = 1_767_607_200_000.0
    low = np.array([[0.0], [0.953125e-4], [1.90625e-4]])
    dates = Opaque("datetime", data=exact + np.array([[0.0], [1.0], [2.0]]) + 1j * low)
    found = mat_objects_child._timetable(about(dates))
    name, unit, values = found["columns"][0]
    assert (name, unit) == ("Time", "ms")
    np.testing.assert_array_equal(values, np.array([0.0, 1.0, 2.0]) + low.ravel())


def test_a_later_version_is_not_guessed() -> None:
    later = about(rate(True), minCompatibleVersion=np.array([[9.0]]))
    with pytest.raises(ValueError, match="timetable of version"):
        mat_objects_child._timetable(later)
