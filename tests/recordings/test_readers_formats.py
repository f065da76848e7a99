"""Every format read back as it was written, by the format's own library or by hand."""

from __future__ import annotations

import struct
import warnings
import wave
from pathlib import Path

import h5py
import numpy as np
import pytest
import written
import xarray as xr
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_table, read_time, time_blocks
from scipy import io
from scipy.io import wavfile

NODES = ("1:+Z", "2:+Z", "3:+Z")
COLUMNS = ("ax", "bo", "ra")


def expected_names(file: str) -> tuple[str, ...]:
    if file.endswith("uff"):
        return NODES
    return {"columns.mat": COLUMNS, "a.wav": ("1", "2", "3")}.get(file, written.NAMES)


@pytest.mark.parametrize("file", written.WRITERS)
def test_read_back(file: str, tmp_path: Path) -> None:
    x = written.samples()
    path = tmp_path / file
    written.WRITERS[file](path, x)
    record = read_time(path)
    assert record.channels == expected_names(file)
    assert record.units == ((None,) * 3 if file in ("a.wav", "columns.mat") else (written.UNIT,) * 3)
    assert record.sampling_Hz == written.RATE
    assert record.source == str(path)
    # ASCII universal files print twelve digits; everything else holds the numbers themselves.
    bound = 1e-11 if file == "a.uff" else 0.0
    np.testing.assert_allclose(record.values, x, rtol=bound, atol=0.0)


@pytest.mark.parametrize("file", written.WRITERS)
def test_a_part_is_that_part(file: str, tmp_path: Path) -> None:
    path = tmp_path / file
    written.WRITERS[file](path, written.samples())
    whole = read_time(path)
    last, first = whole.channels[2], whole.channels[0]
    part = read_time(path, channels=[last, first], samples=(100, 207))
    np.testing.assert_array_equal(part.values, whole.values[[2, 0], 100:207])
    assert part.channels == (last, first)
    assert part.start_s == pytest.approx((whole.start_s or 0.0) + 100 / written.RATE)


@pytest.mark.parametrize("file", written.WRITERS)
def test_blocks_joined_are_the_whole(file: str, tmp_path: Path) -> None:
    path = tmp_path / file
    written.WRITERS[file](path, written.samples())
    whole = read_time(path)
    blocks = list(time_blocks(path, block_samples=77))
    assert [len(block) for block in blocks] == [77, 77, 77, 69]
    np.testing.assert_array_equal(np.concatenate([block.values for block in blocks], axis=1), whole.values)
    starts = [block.start_s or 0.0 for block in blocks]
    np.testing.assert_allclose(np.diff(starts), 77 / written.RATE)


@pytest.mark.parametrize("bits", [8, 16, 24, 32])
def test_wav_whole_numbers_as_parts_of_full_scale(bits: int, tmp_path: Path) -> None:
    # Written by Python's own wave module, read here and by scipy.
    rng = np.random.default_rng(bits)
    top = 2 ** (bits - 1)
    numbers = rng.integers(-top, top, size=(50, 2))
    numbers[0] = (-top, top - 1)
    width = bits // 8
    raw = b"".join(
        struct.pack("<B", n + 128) if bits == 8 else int(n).to_bytes(width, "little", signed=True)
        for n in numbers.ravel().tolist()
    )
    path = tmp_path / "a.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(width)
        file.setframerate(48_000)
        file.writeframes(raw)
    record = read_time(path)
    np.testing.assert_array_equal(record.values, numbers.T / top)
    assert record.units == (None, None)
    assert f"2^{bits - 1}" in record.notes[0]
    rate, other = wavfile.read(path)
    assert rate == record.sampling_Hz
    shifted = (other.astype(np.float64) - 128.0) / 128.0 if bits == 8 else other / 2.0 ** (8 * other.itemsize - 1)
    np.testing.assert_array_equal(record.values, shifted.T)


@pytest.mark.parametrize(
    ("text", "names", "units", "rate", "first"),
    [
        ("a,b\n1,2\n3,4\n", ("a", "b"), (None, None), None, (1, 3)),
        ("a (m/s^2);b [kN]\n1,5;2\n3;4\n", ("a", "b"), ("m/s^2", "kN"), None, (1.5, 3)),
        ("t [s];a\n0,00;1\n0,25;2\n0,50;3\n", ("a",), (None,), 4.0, (1, 2, 3)),
        ("Time [ms]\ta [g]\n0\t1\n2\t2\n4\t3\n", ("a",), ("g",), 500.0, (1, 2, 3)),
        ("time_ms,a\n10,1\n12,2\n14,3\n", ("a",), (None,), 500.0, (1, 2, 3)),
        ("a,b\n[m/s2],[V]\n1,2\n3,4\n", ("a", "b"), ("m/s2", "V"), None, (1, 3)),
        ("time,a\ns,mm/s\n0,1\n1,3\n", ("a",), ("mm/s",), 1.0, (1, 3)),
        ("1,2\n3,4\n", ("column 1", "column 2"), (None, None), None, (1, 3)),
        ("a b\n1 2\n3   4\n", ("a", "b"), (None, None), None, (1, 3)),
        ("a [m/s2]\n1\n3\n", ("a",), ("m/s2",), None, (1, 3)),
        ("% sampling rate: 2 kHz\na;b;\n1;2;\n3;4;\n", ("a", "b"), (None, None), 2000.0, (1, 3)),
        ('"box, left","b"\n1,2\n3,4\n', ("box, left", "b"), (None, None), None, (1, 3)),
        ("a,b\r\n1,2\r\n\r\n# a remark\r\n3,4", ("a", "b"), (None, None), None, (1, 3)),
        ("box (left),b (1)\n1,2\n3,4\n", ("box (left)", "b (1)"), (None, None), None, (1, 3)),
        ("a [µm],b (°C)\n1,2\n3,4\n", ("a", "b"), ("µm", "°C"), None, (1, 3)),
        ("a ((m/s^2)/N),b\n1,2\n3,4\n", ("a", "b"), ("(m/s^2)/N", None), None, (1, 3)),
    ],
)
def test_text_as_loggers_write_it(
    text: str, names: tuple[str, ...], units: tuple[str | None, ...], rate: float | None, first: tuple[float, ...],
    tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode())
    record = read_time(path)
    assert (record.channels, record.units, record.sampling_Hz) == (names, units, rate)
    np.testing.assert_array_equal(record.values[0], first)


def test_latin_1_header(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes("a [µm];b [m/s²]\n1;2\n".encode("latin-1"))
    assert read_time(path).units == ("µm", "m/s²")


def test_text_of_several_pieces(tmp_path: Path) -> None:
    # 4 MB and more, so that the checks run over the seam between pieces.
    x = np.random.default_rng(1).standard_normal((2, 90_000))
    path = tmp_path / "a.csv"
    rows = (f"{i / 1024:.6f},{a:.17g},{b:.17g}" for i, (a, b) in enumerate(x.T.tolist()))
    path.write_text("t,a,b\n" + "\n".join(rows) + "\n")
    record = read_time(path)
    np.testing.assert_array_equal(record.values, x)
    assert record.sampling_Hz == 1024.0
    lines = path.read_text().split("\n")
    del lines[80_000]
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"line 80001, column 't': a step of 0\.00195.* not uniform"):
        read_time(path)


def test_several_groups_of_hdf5(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for run, count in (("one", 10), ("two", 20)):
            data = file.create_dataset(f"{run}/acc", data=np.arange(float(count)))
            data.attrs["unit"] = "g"
            data.attrs["dt"] = 0.01
    record = read_time(path, part="two")
    assert (record.channels, record.units, record.sampling_Hz, len(record)) == (("acc",), ("g",), 100.0, 20)
    with pytest.raises(InputError, match="20 samples where 'one/acc' has 10"):
        read_time(path)


@pytest.mark.parametrize("file", ["a.npz", "a.mat", "a.nc", "a.h5", "v73.mat"])
def test_frequency_responses_in_arrays(file: str, tmp_path: Path) -> None:
    frequency, values, coherence = written.frf()
    sensors, hammers = ["rail@1", "girder@16"], ["p", "q", "r"]
    path = tmp_path / file
    table = {"f": frequency, "frf": values, "coh": coherence, "averages": 8.0}
    if file == "a.npz":
        np.savez(path, **table, sensor=np.array(sensors), hammer=np.array(hammers), unit="m/N")
    elif file == "a.mat":
        io.savemat(path, {**table, "sensor": sensors, "hammer": hammers, "unit": "m/N"})
    elif file == "a.nc":
        axes = ("frequency", "sensor", "hammer")
        data = xr.Dataset(
            {"frf": (axes, values, {"units": "m/N"}), "coh": (axes, coherence), "averages": 8.0},
            coords={"frequency": frequency, "sensor": sensors, "hammer": hammers},
        )
        with warnings.catch_warnings():
            # Complex numbers are beyond NetCDF, states the library; it is how this package writes its own results.
            warnings.simplefilter("ignore", UserWarning)
            data.to_netcdf(path, engine="h5netcdf", invalid_netcdf=True)
    elif file == "a.h5":
        with h5py.File(path, "w") as out:
            for name, value in {**table, "sensor": sensors, "hammer": hammers, "unit": "m/N"}.items():
                out[name] = value
    else:
        turned = np.zeros(values.T.shape, dtype=[("real", "f8"), ("imag", "f8")])
        turned["real"], turned["imag"] = values.T.real, values.T.imag
        with h5py.File(path, "w", userblock_size=512) as out:
            for name, value in {**table, "frf": turned, "coh": coherence.T}.items():
                out[name] = value
            out["sensor"], out["hammer"], out["unit"] = sensors, hammers, "m/N"
        with path.open("r+b") as raw:
            raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + struct.pack("<H", 0x0200) + b"IM")
    record = read_frf(path)
    np.testing.assert_array_equal(record.frequency_Hz, frequency)
    for i, sensor in enumerate(sensors):
        for j, hammer in enumerate(hammers):
            np.testing.assert_array_equal(record.pair(sensor, hammer), values[:, i, j])
            assert record.coherence is not None
            np.testing.assert_array_equal(record.coherence[record.index(sensor, hammer)], coherence[:, i, j])
    assert (record.unit, record.averages) == ("m/N", 8)


def test_table_of_numbers_and_texts(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("rail,temp (degC),100,125\nli,13.0,12.0,\nre,-1,,0.5\n")
    table = read_table(path)
    assert table.texts("rail") == ("li", "re")
    assert table.units["temp"] == "degC"
    np.testing.assert_array_equal(table.numbers("100"), [12.0, np.nan])
    np.testing.assert_array_equal(table.numbers("125"), [np.nan, 0.5])
    with pytest.raises(InputError, match="column 'rail': holds texts"):
        table.numbers("rail")
    with pytest.raises(InputError, match=r"no such column .*'rails'.*rail, temp"):
        table.numbers("rails")
    assert read_table(path, texts=["temp"]).texts("temp") == ("13.0", "-1")


def test_table_with_decimal_commas_and_without_header(tmp_path: Path) -> None:
    path = tmp_path / "a.tsv"
    path.write_text("0\t47\n10,5\t99,3\n")
    table = read_table(path)
    np.testing.assert_array_equal(table.numbers("column 1"), [0.0, 10.5])


def test_table_of_arrays(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, **{"G [MPa]": np.array([1.0, 2.0]), "name": np.array(["x", "y"])})
    table = read_table(path)
    assert (table.units["G"], table.texts("name")) == ("MPa", ("x", "y"))
    np.testing.assert_array_equal(table.numbers("G"), [1.0, 2.0])


def test_what_the_caller_knows_is_taken_where_the_file_states_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a,b\n1,2\n3,4\n")
    record = read_time(path, units={"a": "g"}, sampling_Hz=100)
    assert (record.units, record.sampling_Hz) == (("g", None), 100.0)
    assert record.unit("a") == "g"
    with pytest.raises(InputError, match="channel 'b': has no unit"):
        record.unit("b")


def test_units_that_mean_the_same_agree(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a [m/s²]\n1\n")
    assert read_time(path, units="m/s2").units == ("m/s²",)
    with pytest.raises(InputError, match="the file states 'm/s²', but was stated to be in 'g'"):
        read_time(path, units="g")


def test_samples_that_are_not_finite_are_kept_on_demand(tmp_path: Path) -> None:
    x = written.samples()
    x[1, 40] = np.nan
    for file in ("a.npz", "a.csv"):
        path = tmp_path / file
        written.WRITERS[file](path, x)
        np.testing.assert_array_equal(read_time(path, keep_nonfinite=True).values, x)
        with pytest.raises(InputError, match="bogie"):
            read_time(path)
