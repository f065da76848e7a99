"""LabVIEW measurement files, written by hand after National Instruments' specification."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
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

    def said(text: str) -> str:
        return text.replace(".", decimal)

    lines = ["LabVIEW Measurement" + separator]
    lines += [separator.join([key, *value]) for key, value in head.items()] + ["***End_of_Header***", ""]
    lines += [separator.join([key, *map(said, value)]) for key, value in inner.items() if value is not None]
    titles = ["X_Value", "acc", *(["X_Value"] if kind == "Multi" else []), "force", "Comment"]
    lines += ["***End_of_Header***", separator.join(titles)]
    for moment, (a, b) in zip(t, x.T, strict=True):
        first = "" if kind == "No" else f"{moment:.9f}"
        second = [f"{moment:.9f}"] if kind == "Multi" else []
        lines.append(separator.join(map(said, [first, f"{a:.6f}", *second, f"{b:.6f}"])))
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
    ("change", "said"),
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
def test_refused(change: dict[str, Any], said: str, tmp_path: Path) -> None:
    path = write(tmp_path, **change)
    with pytest.raises(InputError, match=said):
        read_time(path)
    if "'force'" in said:
        np.testing.assert_array_equal(read_time(path, channels=["acc"]).values[0], X[0])


def test_several_segments(tmp_path: Path) -> None:
    path = write(tmp_path)
    text = path.read_text()
    path.write_text(text + "\n" + text.partition("***End_of_Header***")[2])
    with pytest.raises(InputError, match="holds 2 segments"):
        read_time(path)
