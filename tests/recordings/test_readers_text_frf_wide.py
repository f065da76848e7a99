"""Frequency responses side by side in tables of text."""

from __future__ import annotations

import contextlib
import tomllib
from pathlib import Path

import drawn_text
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.parts import Record
from permway.cli import app
from permway.errors import InputError
from permway.recordings.look import look
from permway.recordings.readers import read_frf, read_time
from permway.recordings.readers.hints import Hints
from permway.recordings.readers.text_numbers import complex_number, is_complex
from typer.testing import CliRunner

F = np.array([10.0, 20.0, 30.0])
H = np.array([1.5 + 2.25j, -0.5 - 4.0j, 3.0 + 0.125j])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.2+3.4j", 1.2 + 3.4j), ("1,2-3,4i", 1.2 - 3.4j), ("(1.2+3.4j)", 1.2 + 3.4j), ("1.2 + j3.4", 1.2 + 3.4j),
        ("-1.2e-3 - 3.4E+2 i", -1.2e-3 - 340j), ("1.5+2*i", 1.5 + 2j), ("-2.5j", -2.5j), ("i0.5", 0.5j),
        ("1.5D-03+2.5D+00i", 1.5e-3 + 2.5j), (".5-.25j", 0.5 - 0.25j), ("−1+2j", -1 + 2j),
    ],
)  # fmt: skip
def test_complex_text(text: str, value: complex) -> None:
    assert is_complex(text)
    assert complex_number(text, "here") == value


@pytest.mark.parametrize("text", ["1.2", "3 Hz", "1+2", "a+bj", "1.2+3.4", "j", "1e5", "2026-01-05", "1+2jj", ""])
def test_what_is_no_complex_text(text: str) -> None:
    assert not is_complex(text)


def wide(folder: Path, head: list[str], columns: list[list[str]], separator: str = ";") -> Path:
    path = folder / "wide.csv"
    rows = [separator.join(row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    return path


def cells(values: np.ndarray) -> list[str]:
    return [repr(float(v)) for v in values]


def test_one_response_of_an_analyser(tmp_path: Path) -> None:
    """Keysight, Bruel & Kjaer and others: one response a file, and no name of it but the part's."""
    size, angle = cells(np.abs(H)), cells(np.rad2deg(np.angle(H)))
    path = wide(
        tmp_path, ["Freq. (Hz);Magnitude (g/N);Phase (deg);Coherence"], [cells(F), size, angle, ["0.9"] * 3]
    )
    record = read_frf(path)
    assert (record.responses, record.references, record.unit) == (("response",), ("reference",), "g/N")
    np.testing.assert_allclose(record.values[0], H, rtol=1e-12)
    assert record.coherence is not None
    np.testing.assert_array_equal(record.coherence[0], 0.9)


def test_levels_with_their_reference(tmp_path: Path) -> None:
    level = cells(20.0 * np.log10(np.abs(H) / 1e-6))
    angle = cells(np.angle(H))
    path = wide(tmp_path, ["f [kHz];a/b mag [dB re 1e-6 m/N];a/b phase [rad]"], [cells(F / 1e3), level, angle])
    record = read_frf(path)
    assert record.unit == "m/N"
    np.testing.assert_allclose(record.values[0], H, rtol=1e-12)
    np.testing.assert_allclose(record.frequency_Hz, F)
    bare = wide(tmp_path, ["f [kHz];a/b mag [dB];a/b phase [rad]"], [cells(F / 1e3), level, angle])
    with pytest.raises(InputError, match=r"decibels without a reference are no ratio .*unit = \{ \"a/b mag\" ="):
        read_frf(bare)
    for unit in ({"a/b mag": "dB re 1e-6 m/N"}, {"a/b": "dB re 1e-6 m/N"}, "dB re 1e-6 m/N"):
        np.testing.assert_allclose(read_frf(bare, hints=Hints(unit=unit)).values[0], H, rtol=1e-12)


def test_names_over_joined_cells(tmp_path: Path) -> None:
    head = ["Frequency;rail / hit 1;;rail / hit 2;", ";Real;Imag;Real;Imag", "Hz;g/N;g/N;m/s^2/N;m/s^2/N"]
    path = wide(tmp_path, head, [cells(F), cells(H.real), cells(H.imag), cells(2 * H.real), cells(2 * H.imag)])
    record = read_frf(path)
    assert list(zip(record.responses, record.references, strict=True)) == [("rail", "hit 1"), ("rail", "hit 2")]
    assert record.units == ("g/N", "m/s^2/N")
    np.testing.assert_array_equal(record.values, [H, 2 * H])


def test_names_that_do_not_state_what_was_struck(tmp_path: Path) -> None:
    path = wide(tmp_path, ["f [Hz];H1 [g/N];H2 [g/N]"], [cells(F), [str(h) for h in H], [str(2 * h) for h in H]])
    with pytest.raises(InputError, match=r"cannot be determined from a name \(got 'H1'\).*pairs = \{ \"H1\" ="):
        read_frf(path)
    stated = ["--pair", "H1=rail@8.64/3.20", "--pair", "H2=rail@8.64/5.76"]
    shown = CliRunner().invoke(app, ["look", str(path), *stated, "--json"])
    assert shown.exit_code == 0, shown.stdout
    part = tomllib.loads(__import__("json").loads(shown.stdout)["campaign"].replace('= ""', '= "c"'))
    record = Record.model_validate(part["records"][0])
    read = read_frf(path, responses=list(record.responses), references=["5.76"], hints=record.hints)
    assert (read.responses, read.references) == (("rail@8.64",), ("5.76",))
    np.testing.assert_array_equal(read.values[0], 2 * H)


def test_only_what_is_asked_for_has_to_be_sound(tmp_path: Path) -> None:
    head = ["f;a/1 re;a/1 im;b/1 re;b/1 im;c/1 mag"]
    columns = [cells(F), cells(H.real), cells(H.imag), ["broken"] * 3, cells(H.imag), cells(H.real)]
    path = wide(tmp_path, head, columns)
    np.testing.assert_array_equal(read_frf(path, responses=["a"]).values[0], H)
    with pytest.raises(InputError, match="line 2, column 'b/1 re'"):
        read_frf(path, responses=["b"])
    with pytest.raises(InputError, match="has no column of its phase"):
        read_frf(path, responses=["c"])


@pytest.mark.parametrize(
    ("head", "columns", "stated"),
    [
        ("f;a/1 mag;a/1 phase", [cells(F), ["1", "2", "3"], ["0", "1", "2"]], "degrees or radians"),
        ("f;a/1 mag;a/1 phase [deg]", [cells(F), ["1", "-2", "3"], ["0", "1", "2"]], "a level in dB"),
        ("f;a/1 re [g/N];a/1 im [m/N]", [cells(F), ["1", "2", "3"], ["0", "1", "2"]], "a/1 im"),
        ("f;a/1", [cells(F), ["1,234+1,111j", "2,500-3,125j", "3,001+1,250j"]], "decimals or thousands"),
        ("f;a/1", [cells(F), ["1,2+1.1j", "2-3j", "3+1j"]], "decimal points and decimal commas"),
        ("f;a/1 re;a/1 im;a/1 im", [cells(F), ["1"] * 3, ["2"] * 3, ["3"] * 3], "more than one column"),
        ("f;a/1", [cells(F), ["1+1j", "", "3+1j"]], "empty or not a finite number"),
    ],
)  # fmt: skip
def test_refused(head: str, columns: list[list[str]], stated: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=stated):
        read_frf(wide(tmp_path, [head], columns))


def test_a_row_for_each_frequency_with_complex_text(tmp_path: Path) -> None:
    head = ["frequency [Hz];sensor;point;frf [g/N];coherence"]
    text = [str(h).strip("()").replace(".", ",") for h in H]
    path = wide(tmp_path, head, [["10", "20", "30"], ["a"] * 3, ["1"] * 3, text, ["0,9"] * 3])
    record = read_frf(path)
    np.testing.assert_array_equal(record.values[0], H)
    assert (record.responses, record.unit) == (("a",), "g/N")


def test_a_coherence_that_names_no_response(tmp_path: Path) -> None:
    columns = [cells(F), cells(H.real), cells(H.imag), ["0.9"] * 3]
    coherence = read_frf(wide(tmp_path, ["f;a/1 re;a/1 im;Coherence"], columns)).coherence
    assert coherence is not None
    np.testing.assert_array_equal(coherence[0], 0.9)


def test_a_magnitude_on_a_logarithmic_scale_is_a_level(tmp_path: Path) -> None:
    columns = [cells(F), ["1", "2", "3"], ["10", "20", "30"]]
    with pytest.raises(InputError, match="decibels without a reference"):
        read_frf(wide(tmp_path, ["f;a/1 Log Mag;a/1 phase [deg]"], columns))
    size = np.abs(read_frf(wide(tmp_path, ["f;a/1 Lin Mag;a/1 phase [deg]"], columns)).values[0])
    np.testing.assert_allclose(size, [1.0, 2.0, 3.0])


@pytest.mark.parametrize("name", ["Gxy a/1", "a/1 CSD".lower(), "Cross spectrum a/1".lower()])
def test_a_spectrum_is_no_response(name: str, tmp_path: Path) -> None:
    columns = [cells(F), cells(H.real), cells(H.imag)]
    with pytest.raises(InputError, match="seems to be a spectrum"):
        read_frf(wide(tmp_path, [f"f;{name} re;{name} im"], columns))


def test_lines_above_the_header(tmp_path: Path) -> None:
    head = ["Test 3", "Operator: x", "f;a/1 re;a/1 im"]
    path = wide(tmp_path, head, [cells(F), cells(H.real), cells(H.imag)])
    with pytest.raises(InputError, match=r"header_row = 3"):
        read_frf(path)
    found = look(path)
    assert found["responses"]["pairs"] == 1
    assert "header_row = 3" in found["campaign"]


def test_a_spectrum_is_no_record_in_time(tmp_path: Path) -> None:
    path = wide(tmp_path, ["Frequency [Hz];PSD [g^2/Hz]"], [cells(F), ["1", "2", "3"]])
    with pytest.raises(InputError, match=r"stands over frequency, not over time \(got 'Frequency'\)"):
        read_time(path)
    assert read_time(path, hints=Hints(time_column="none"), sampling_Hz=512.0).channels == ("Frequency", "PSD")


_TOKENS = (
    b"-1",
    b"nan",
    b"1e999",
    b",",
    b";",
    b"\n",
    b"\x00",
    b"\xff",
    b"(",
    b"j",
    b"/",
    b"dB re 0 g/N",
    b"Real",
    b'"',
)


@settings(max_examples=60)
@given(seed=st.integers(0, 2**31))
def test_damaged_at_random(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    """A record or one clear error, and nothing else."""
    random = np.random.default_rng(seed)
    path, _ = drawn_text.frf_wide(random, tmp_path_factory.mktemp("damaged"))
    raw = bytearray(path.read_bytes())
    for _ in range(int(random.integers(1, 4))):
        at = int(random.integers(len(raw)))
        token = _TOKENS[int(random.integers(len(_TOKENS)))]
        if random.random() < 0.5:
            raw[at:at] = token
        else:
            raw[at : at + len(token)] = token
    path.write_bytes(raw)
    with contextlib.suppress(InputError):
        record = read_frf(path)
        assert np.isfinite(record.values[:, record.frequency_Hz > 0.0]).all()
