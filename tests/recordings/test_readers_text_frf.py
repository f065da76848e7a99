"""Frequency responses in tables of text."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.readers import read_frf

FREQUENCY = np.array([10.0, 20.0, 30.0])
PAIRS = [("rail@8.64", "3.20"), ("rail@8.64", "5.76"), ("slab", "3.20"), ("slab", "5.76")]
VALUES = (np.arange(1.0, 13.0) * np.exp(0.4j * np.arange(12.0))).reshape(4, 3)


def rows(form: str) -> list[str]:
    lines = []
    for (sensor, point), values in zip(PAIRS, VALUES, strict=True):
        for f, value in zip(FREQUENCY, values, strict=True):
            parts = (value.real, value.imag) if form == "parts" else (abs(value), np.rad2deg(np.angle(value)))
            lines.append(";".join([f"{f:g}", sensor, point, *(repr(float(p)) for p in parts), "0.9"]))
    return lines


@pytest.mark.parametrize(
    ("form", "header"),
    [
        ("parts", "frequency [Hz];sensor;force;real [(m/s2)/N];imaginary;coherence"),
        ("polar", "Frequency [Hz];Sensor;Point;Magnitude [(m/s2)/N];Phase [deg];Coherence"),
    ],
)
def test_a_row_for_each_frequency_sensor_and_point(tmp_path: Path, form: str, header: str) -> None:
    path = tmp_path / "frf.csv"
    path.write_text("\n".join([header, *rows(form)]) + "\n")
    record = read_frf(path)
    assert list(zip(record.responses, record.references, strict=True)) == PAIRS
    np.testing.assert_array_equal(record.frequency_Hz, FREQUENCY)
    np.testing.assert_allclose(record.values, VALUES, rtol=1e-12)
    assert record.coherence is not None
    np.testing.assert_array_equal(record.coherence, 0.9)
    assert record.unit == "(m/s2)/N"


HEADER = "frequency;sensor;force;real;imaginary;coherence"


@pytest.mark.parametrize(
    ("lines", "stated"),
    [
        ([HEADER, *rows("parts")[:-1]], "slab < 5.76: does not have the frequencies of rail@8.64 < 3.20"),
        ([HEADER.replace("imaginary", "phase"), *rows("parts")], "no column of imaginary parts"),
        ([HEADER.replace("sensor", "where"), *rows("parts")], "no column of sensors"),
        ([HEADER.replace("frequency", "frequency [rpm]"), *rows("parts")], "frequencies must be in Hz"),
        ([HEADER, *rows("parts"), *rows("parts")[:3]], "rail@8.64"),
        ([HEADER, *rows("parts")[:2], "30;rail@8.64;3.20;x;1;0.9", *rows("parts")[3:]], "not a number"),
        (
            [HEADER.replace("real;imaginary", "real [mm/N];imaginary [m/N]"), *rows("parts")],
            "'imaginary': the file states",
        ),
        ([HEADER.replace("real;imaginary", "magnitude;phase"), *rows("polar")], "degrees or radians"),
        ([HEADER, *[row.replace("0.9", "1.9") for row in rows("parts")]], "coherence"),
    ],
)
def test_what_cannot_be_used_is_reported(tmp_path: Path, lines: list[str], stated: str) -> None:
    path = tmp_path / "frf.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=stated):
        read_frf(path)


def test_a_coherence_in_percent(tmp_path: Path) -> None:
    path = tmp_path / "frf.csv"
    lines = [HEADER.replace("coherence", "coherence [%]"), *rows("parts")]
    path.write_text("\n".join(lines) + "\n")
    coherence = read_frf(path).coherence
    assert coherence is not None
    np.testing.assert_allclose(coherence, 0.009)
