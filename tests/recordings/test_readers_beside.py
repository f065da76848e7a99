"""What stands beside the numbers and changes them: units, scales, rates, dates, marks of other programs."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_time
from permway.recordings.readers.hints import Hints
from scipy import io

SAMPLES = np.round(np.sin(np.arange(48.0)), 6)
COUNTS = np.arange(48, dtype=np.int16)
HZ = np.arange(1.0, 9.0)
H = HZ + 0.5j
FORMATS = ("npz", "mat", "h5")
ROWS = 30


def save(folder: Path, kind: str, **arrays: object) -> Path:
    path = folder / f"a.{kind}"
    if kind == "npz":
        np.savez(path, **arrays)  # type: ignore[arg-type]
    elif kind == "mat":
        io.savemat(path, arrays)
    else:
        with h5py.File(path, "w") as file:
            for name, value in arrays.items():
                file[name] = value
    return path


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("end", ["_unit", "_units", "unit", "Unit"])
def test_unit_in_a_text_beside(kind: str, end: str, tmp_path: Path) -> None:
    more = {f"time{end}": "ms", f"x{end}": "mm/s2"}
    record = read_time(save(tmp_path, kind, time=2.0 * np.arange(48), x=SAMPLES, **more))
    assert (record.channels, record.units, record.sampling_Hz) == (("x",), ("mm/s2",), 500.0)
    for unit, factor in (("kHz", 1e3), ("rad/s", 0.5 / np.pi), ("Hz", 1.0)):
        names = {"response": "s1", "reference": "p1", f"f{end}": unit}
        found = read_frf(save(tmp_path, kind, f=HZ, H=H, **names))
        np.testing.assert_allclose(found.frequency_Hz, HZ * factor, rtol=1e-14)


def test_unit_beside_contradicts(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["x"], file["fs"], file["x_unit"] = SAMPLES, 512.0, "mm/s2"
        file["x"].attrs["unit"] = "m/s2"
    with pytest.raises(InputError, match="its own unit is 'm/s2', the text beside it states 'mm/s2'"):
        read_time(path)


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    ("name", "value"), [("scale", 1e-3), ("gain", 2.0), ("sensitivity", 0.1), ("offset", 4.0)]
)
def test_whole_numbers_with_a_scale(kind: str, name: str, value: float, tmp_path: Path) -> None:
    path = save(tmp_path, kind, fs=512.0, x=COUNTS, **{name: value})
    with pytest.raises(InputError, match=f"'{name}' beside them, which is not applied"):
        read_time(path)
    # As they stand, where the record states what they are.
    as_said = read_time(path, hints=Hints(unit={"x": "V"}))
    np.testing.assert_array_equal(as_said.channel("x"), COUNTS)
    nothing = 0.0 if name == "offset" else 1.0
    np.testing.assert_array_equal(
        read_time(save(tmp_path, kind, fs=512.0, x=COUNTS, **{name: nothing})).channel("x"), COUNTS
    )
    assert len(read_time(save(tmp_path, kind, fs=512.0, x=SAMPLES, **{name: value}))) == 48


def test_attribute_scales_whole_numbers(tmp_path: Path) -> None:
    path = save(tmp_path, "h5", fs=512.0, x=COUNTS, y=SAMPLES)
    with h5py.File(path, "a") as file:
        file["x"].attrs["scale"] = 1e-3
    with pytest.raises(InputError, match=r"channel .x..*'scale'"):
        read_time(path, channels=["x"])
    assert len(read_time(path, channels=["y"])) == 48


@pytest.mark.parametrize("kind", FORMATS)
def test_several_rates_in_a_list(kind: str, tmp_path: Path) -> None:
    two = np.stack([SAMPLES, -SAMPLES], axis=1)
    with pytest.raises(InputError, match="several sampling rates"):
        read_time(save(tmp_path, kind, fs=np.array([512.0, 256.0]), x=two))


@pytest.mark.parametrize("kind", FORMATS)
def test_a_response_without_names(kind: str, tmp_path: Path) -> None:
    """One needs none; of two it is stated what is missing."""
    record = read_frf(save(tmp_path, kind, f=HZ, H=H))
    assert (record.responses, record.references) == (("response",), ("reference",))
    np.testing.assert_array_equal(record.values, H[None, :])
    with pytest.raises(InputError, match="no names of the responses"):
        read_frf(save(tmp_path, kind, f=HZ, H=np.stack([H, 2.0 * H], axis=1)))


@pytest.mark.parametrize("tick", ["ms", "us", "ns"])
@pytest.mark.parametrize("date", [True, False])
def test_dates_of_numpy(tick: str, date: bool, tmp_path: Path) -> None:
    per_s = {"ms": 1000, "us": 10**6, "ns": 10**9}[tick]
    time = (np.arange(48) * (per_s // 500)).astype(f"m8[{tick}]")
    shifted = np.datetime64("2026-11-27T10:00:00", tick) + time if date else time
    assert read_time(save(tmp_path, "npz", time=shifted, x=SAMPLES)).sampling_Hz == pytest.approx(500.0, rel=1e-12)
    with pytest.raises(InputError, match="neither numbers nor texts"):
        read_time(save(tmp_path, "npz", a=shifted))


@pytest.mark.parametrize("seed", range(6))
def test_numbers_of_other_programs(seed: int, tmp_path: Path) -> None:
    """Ends of lines of old Macs, exponents of Fortran, the minus of typographers: the same numbers."""
    random = np.random.default_rng(seed)
    values = random.normal(size=ROWS) * 10.0 ** random.integers(-6, 6)
    mark = ",;\t"[seed % 3]
    rows = [f"{i / 512:.12E}{mark}{x:.12E}" for i, x in enumerate(values)]
    content = "\n".join([f"t [s]{mark}a [m/s2]", *rows, ""])
    for swap in ((("E", "D"),), (("\n", "\r"),), (("-", "\N{MINUS SIGN}"),), (("E", "d"), ("\n", "\r"))):
        text = content
        for old, new in swap:
            text = text.replace(old, new)
        path = tmp_path / "a.csv"
        path.write_bytes(text.encode())
        record = read_time(path)
        np.testing.assert_allclose(record.values[0], values, rtol=1e-11)
        assert record.sampling_Hz == pytest.approx(512.0, rel=1e-6)


def test_text_of_octave(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    for first in ("# Created by Octave 9.2, Fri Nov 27\n", ""):
        path.write_text(f"{first}# name: fs\n# type: scalar\n512\n\n# name: x\n# type: matrix\n 1\n 2\n 3\n 4\n")
        with pytest.raises(InputError, match=r"text as Octave saves its variables.*save -7"):
            read_time(path)


@pytest.mark.parametrize("second", ["(m/s2)/N", "(mm/s2)/N", ""])
def test_column_of_units(second: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = [f"{x},{name},p1,{x},1,{unit}" for name, unit in (("s1", "(m/s2)/N"), ("s2", second)) for x in HZ]
    path.write_text("\n".join(["frequency_Hz,sensor,force,real,imag,unit", *lines]))
    record = read_frf(path)
    assert [record.unit_of(row) for row in range(2)] == ["(m/s2)/N", second or None]
    lines[1] = lines[1].replace("(m/s2)/N", "mm/N")
    path.write_text("\n".join(["frequency_Hz,sensor,force,real,imag,unit", *lines]))
    with pytest.raises(InputError, match="several units of one response"):
        read_frf(path)
