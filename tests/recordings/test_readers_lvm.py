"""LabVIEW measurement files, written by hand after National Instruments' specification."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError
from permway.recordings.readers import read_time

X = np.round(np.random.default_rng(2).standard_normal((2, 20)), 6)


def write(folder: Path, **change: Any) -> Path:
    """A file of two channels; `change` replaces lines of the heads, or `kind`, `separator`, `decimal`, `x`."""
    separator, decimal = change.pop("separator", "\t"), change.pop("decimal", ".")
    kind, x = change.pop("kind", "No"), change.pop("x", X)
    t = change.pop("t", np.arange(x.shape[1]) / 512)
    head = {
        "Writer_Version": ["2"], "Separator": ["Tab" if separator == "\t" else "Comma"],
        "Decimal_Separator": [decimal], "Multi_Headings": ["Yes"], "X_Columns": [kind], "Date": ["2026/01/05"],
    }  # fmt: skip
    inner = {
        "Channels": ["2"], "Samples": ["20", "20"], "Date": ["2026/01/05"] * 2, "Time": ["10:00:00.5"] * 2,
        "Y_Unit_Label": ["m/s^2", "kN"], "X_Dimension": ["Time"] * 2, "X0": ["0.0", "0.0"],
        "Delta_X": [repr(1 / 512)] * 2, **change,
    }  # fmt: skip

    def stated(text: str) -> str:
        return text.replace(".", decimal)

    lines = ["LabVIEW Measurement" + separator]
    lines += [separator.join([key, *value]) for key, value in head.items()] + ["***End_of_Header***", ""]
    lines += [separator.join([key, *map(stated, value)]) for key, value in inner.items() if value is not None]
    titles = ["X_Value", "acc", *(["X_Value"] if kind == "Multi" else []), "force", "Comment"]
    lines += ["***End_of_Header***", separator.join(titles)]
    for moment, (a, b) in zip(t, x.T, strict=True):
        first = "" if kind == "No" else f"{moment:.9f}"
        second = [f"{moment:.9f}"] if kind == "Multi" else []
        lines.append(separator.join(map(stated, [first, f"{a:.6f}", *second, f"{b:.6f}"])))
    path = folder / "a.lvm"
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


@pytest.mark.parametrize("kind", ["No", "One", "Multi"])
@pytest.mark.parametrize(("separator", "decimal"), [("\t", "."), ("\t", ","), (",", ".")])
def test_read(kind: str, separator: str, decimal: str, tmp_path: Path) -> None:
    record = read_time(write(tmp_path, kind=kind, separator=separator, decimal=decimal))
    assert (record.channels, record.units) == (("acc", "force"), ("m/s^2", "kN"))
    assert record.sampling_Hz == pytest.approx(512.0, rel=1e-9)
    np.testing.assert_array_equal(record.values, X)


@pytest.mark.parametrize(
    ("change", "stated"),
    [
        ({"Delta_X": ["0.001", "0.002"]}, "channel 'force': sampled at 500 Hz .*'acc' at 1000 Hz"),
        ({"Time": ["10:00:00", "10:00:01"]}, "channel 'force': begins at 2026/01/05 10:00:01"),
        ({"X_Dimension": ["Time", "Frequency"]}, "channel 'force': does not stand over time .*Frequency"),
        ({"Samples": ["20", "30"]}, "channel 'force': 30 samples announced, 20 there"),
        ({"Delta_X": None}, "Delta_X: the step in time must be above 0 s"),
        ({"kind": "One", "t": np.arange(20) / 500}, "the x values do not follow the step"),
        ({"x": np.where(np.isin(X, X[1, 3]), np.nan, X)}, "line .*, column 3: not a finite number .*nan"),
    ],
)
def test_refused(change: dict[str, Any], stated: str, tmp_path: Path) -> None:
    path = write(tmp_path, **change)
    with pytest.raises(InputError, match=stated):
        read_time(path)
    if "'force'" in stated:
        np.testing.assert_array_equal(read_time(path, channels=["acc"]).values[0], X[0])


def test_several_segments(tmp_path: Path) -> None:
    path = write(tmp_path)
    first = path.read_text()
    second = write(tmp_path, x=2.0 * X, Delta_X=["0.001", "0.001"]).read_text().partition("***End_of_Header***")[2]
    path.write_text(first + "\n" + second)
    with pytest.raises(
        InputError, match=r'holds 2 segments \(got \'"1" from line 9, "2" from line 43.*part = "1"'
    ):
        read_time(path)
    with pytest.raises(InputError, match="no such segment"):
        read_time(path, part="3")
    for part, rate, factor in (("1", 512.0, 1.0), ("2", 1000.0, 2.0)):
        record = read_time(path, part=part)
        assert record.sampling_Hz == pytest.approx(rate)
        np.testing.assert_allclose(record.values, factor * X, rtol=1e-12)


def test_a_segment_that_begins_with_notes(tmp_path: Path) -> None:
    text = write(tmp_path).read_text()
    second = text.partition("***End_of_Header***")[2].replace("Channels", "Notes\tX is guaranteed\nChannels", 1)
    path = tmp_path / "a.lvm"
    path.write_text(f"{text}\n{second}")
    for part in ("1", "2"):
        np.testing.assert_array_equal(read_time(path, part=part).values, X)


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**31),
    kind=st.sampled_from(["No", "One", "Multi"]),
    marks=st.sampled_from([("\t", "."), ("\t", ","), (",", ".")]),
    rate=st.sampled_from([51.2, 512.0, 2560.0, 51200.0]),
    unit=st.sampled_from([None, "g", "m/s^2", "mm/s"]),
    segments=st.integers(1, 3),
)
def test_read_back(
    seed: int,
    kind: str,
    marks: tuple[str, str],
    rate: float,
    unit: str | None,
    segments: int,
    tmp_path_factory: Any,
) -> None:
    """Whatever the writer's settings: the samples, rate and unit of each segment."""
    folder, random = tmp_path_factory.mktemp("lvm"), np.random.default_rng(seed)
    values = np.round(random.standard_normal((segments, 2, 20)) * 10.0 ** random.integers(-2, 4), 6)
    text = ""
    for x in values:
        change = {"Delta_X": [repr(1.0 / rate)] * 2, "Y_Unit_Label": None if unit is None else [unit] * 2}
        path = write(
            folder, kind=kind, separator=marks[0], decimal=marks[1], x=x, t=np.arange(20) / rate, **change
        )
        part = path.read_text()
        text += part if not text else "\n" + part.partition("***End_of_Header***")[2]
    path.write_text(text)
    for number, x in enumerate(values, start=1):
        record = read_time(path, part=None if segments == 1 else str(number))
        assert record.units == (unit, unit)
        assert record.sampling_Hz == pytest.approx(rate, rel=1e-6)
        np.testing.assert_array_equal(record.values, x)
