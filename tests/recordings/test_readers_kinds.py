"""What programs write otherwise than one would think: each kind read rightly or refused with its remedy."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyuff
import written
import xarray as xr
from drawn_arrays import _turned
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_time
from permway.recordings.readers.hints import Hints
from scipy import io
from test_readers_uff import DOUBLE, body, header

END = "    -1\n"
ROWS = "".join(f"{i % 3}\n" for i in range(40))


def text(folder: Path, content: str) -> Path:
    path = folder / "a.csv"
    path.write_text(content)
    return path


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("acc [mm/s2] filtered", "mm/s2"), ("acc (mm/s2), left", "mm/s2"), ("X (100g)", None),
        ("acc [100 g]", "100 g"),
        ("acc / (mm/s²)", "mm/s²"), ("Weg / mm", "mm"), ("Weg in mm", "mm"), ("acc mm/s2", "mm/s2"),
        ("a / b", None),
        ("box (N)", None), ("force (N)", "N"), ("a, b", None), ('"acc, m/s2"', "m/s2"), ("acc (dB)", None),
    ],
)  # fmt: skip
def test_units_in_headers(head: str, unit: str | None, tmp_path: Path) -> None:
    quoted = head if head.startswith('"') else f'"{head}"'
    assert read_time(text(tmp_path, f"{quoted}\n{ROWS}")).units == (unit,)


@pytest.mark.parametrize(
    ("first", "step", "rate"),
    [
        (1_767_607_200_000, 2, 500.0), (1_767_607_200_000_000, 2000, 500.0),
        (1_767_607_200 * 10**9, 2_000_000, 500.0),
        (639_000_000_000_000_000, 20_000, None),  # tenths of a microsecond since the year 1
        (133_000_000_000_000_000, 20_000, None),  # the same since 1601
        (0, 2, None), (0, 1, None),
    ],
)  # fmt: skip
def test_times_without_a_unit(first: int, step: int, rate: float | None, tmp_path: Path) -> None:
    path = text(tmp_path, "time,a\n" + "".join(f"{first + step * i},{i % 3}\n" for i in range(600)))
    if rate is not None:
        assert read_time(path).sampling_Hz == rate
        return
    with pytest.raises(InputError, match="times without a unit, a step of"):
        read_time(path)
    assert read_time(path, hints=Hints(time_column="none"), channels=["a"], sampling_Hz=500.0).sampling_Hz == 500.0


def test_days_without_a_unit_are_no_seconds(tmp_path: Path) -> None:
    rows = "".join(f"{46027.4 + i / 100 / 86400:.12f},{i % 3}\n" for i in range(600))
    with pytest.raises(InputError, match=r"as seconds 8\.64e\+06 Hz"):
        read_time(text(tmp_path, "time,a\n" + rows))


@pytest.mark.parametrize(
    ("remark", "rate"),
    [
        ("fs = 51200 Hz", 51200.0), ("fs = 51,2 kHz", 51200.0), ("fs = 1e3", 1000.0), ("fs: 2 kS/s", 2000.0),
        ("sample rate (kHz): 2", 2000.0), ("fs = 51.200 Hz", 51.2),
        ("fs = 51,200 Hz", None), ("fs = 1 024 Hz", None), ("fs = 1'024 Hz", None), ("fs = 2 mhz", None),
        ("fs = 512 or so", None), ("fs = 512 1/min", None),
    ],
)  # fmt: skip
def test_rates_in_remarks(remark: str, rate: float | None, tmp_path: Path) -> None:
    path = text(tmp_path, f"# {remark}\na;b\n" + "".join(f"{i % 3}.5;1.0\n" for i in range(40)))
    if rate is None:
        with pytest.raises(InputError, match="line 1: a remark states the sampling rate and is not understood"):
            read_time(path)
    else:
        assert read_time(path).sampling_Hz == pytest.approx(rate)
    assert read_time(path, sampling_Hz=640.0).sampling_Hz == 640.0


def test_a_point_of_thousands_beside_decimal_commas(tmp_path: Path) -> None:
    path = text(tmp_path, "# fs = 51.200 Hz\na;b\n" + "".join(f"{i % 3},5;1,0\n" for i in range(40)))
    with pytest.raises(InputError, match="a remark states the sampling rate"):
        read_time(path)


def test_decimal_commas_between_commas(tmp_path: Path) -> None:
    path = text(tmp_path, "".join(f"0,{100 * i:06d}\n" for i in range(1, 40)))
    with pytest.raises(InputError, match=r'a comma that may part decimals or cells .*decimal = ","'):
        read_time(path)
    record = read_time(path, hints=Hints(decimal=","))
    np.testing.assert_allclose(record.values, [1e-4 * np.arange(1, 40)])


def test_temperatures_are_no_times(tmp_path: Path) -> None:
    path = text(tmp_path, "t [degC],T,Time [s],a\n" + "".join(f"20,21,{i / 50},{i % 3}\n" for i in range(40)))
    record = read_time(path)
    assert (record.channels, record.sampling_Hz) == (("t", "T", "a"), 50.0)


@pytest.mark.parametrize("digits", [3, 6])
def test_times_of_day_and_what_their_digits_leave_open(digits: int, tmp_path: Path) -> None:
    start = np.datetime64("2026-01-05T23:59:59.5", "us")
    moments = [start + np.timedelta64(round(i / 512 * 1e6), "us") for i in range(1000)]
    cells = [str(np.datetime_as_string(m, unit="us"))[: 20 + digits] for m in moments]
    path = text(tmp_path, "date,a\n".replace("date", "timestamp") + "".join(f"{c},1\n" for c in cells))
    if digits == 6:
        assert read_time(path).sampling_Hz == pytest.approx(512.0, rel=1e-6)
        return
    with pytest.raises(InputError, match=r"printed so coarsely that the rate may be 51\d.* Hz"):
        read_time(path)
    assert read_time(path, sampling_Hz=512.0).sampling_Hz == 512.0


def store(folder: Path, **channels: dict[str, Any]) -> Path:
    path = folder / "a.h5"
    with h5py.File(path, "w") as file:
        for name, attributes in channels.items():
            data = file.create_dataset(name, data=np.sin(np.arange(64)))
            data.attrs.update(attributes)
    return path


def test_channels_of_their_own_rate_and_start(tmp_path: Path) -> None:
    path = store(tmp_path, a={"fs": 512.0}, b={"fs": 1024.0}, c={"fs": 512.0, "start_time": "10:00:00.5"})
    with pytest.raises(InputError, match="channel 'b': sampled at 1024 Hz"):
        read_time(path, channels=["a", "b"])
    with pytest.raises(InputError, match=r"channel 'c': begins at 10:00:00\.5, 'a' at an unknown time"):
        read_time(path, channels=["a", "c"])
    assert read_time(path, channels=["b"]).sampling_Hz == 1024.0


def test_structs_of_their_own_rate(tmp_path: Path) -> None:
    x = np.sin(np.arange(64.0))
    structs = {"s": {"acc": x, "fs": 1000.0}, "q": {"acc": 2.0 * x, "fs": 500.0}}
    io.savemat(tmp_path / "five.mat", structs)
    _turned(tmp_path / "seven.mat", structs)
    for name in ("five.mat", "seven.mat"):
        path = tmp_path / name
        assert read_time(path, channels=["q/acc"]).sampling_Hz == 500.0
        np.testing.assert_array_equal(read_time(path, part="s").values[0], x)
        with pytest.raises(InputError, match=r"sampled at .*Hz"):
            read_time(path)


def test_rates_and_steps_have_units(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    for name, value, unit, rate in (
        ("fs", 2.0, "kHz", 2000.0),
        ("dt", 2.0, "ms", 500.0),
        ("dt", 0.25, "ms", 4000.0),
    ):
        with h5py.File(path, "w") as file:
            file["a"] = np.sin(np.arange(64))
            file[name] = value
            file[name].attrs["units"] = unit
        assert read_time(path).sampling_Hz == pytest.approx(rate)
    np.savez(tmp_path / "a.npz", a=np.sin(np.arange(64)), dt=1.953125)
    with pytest.raises(InputError, match="a step without a unit"):
        read_time(tmp_path / "a.npz")


def test_rows_of_characters_and_empty_arrays_of_matlab(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    x = np.random.default_rng(1).standard_normal((50, 2))
    _turned(path, {"acc": x, "fs": 512.0})
    with h5py.File(path, "r+") as file:
        names = np.array([[ord(c) for c in row] for row in ("box ", "rail")], dtype=np.uint16)
        file.create_dataset("channels", data=names.T).attrs["MATLAB_class"] = np.bytes_("char")
        empty = file.create_dataset("nothing", data=np.array([0, 0], dtype=np.uint64))
        empty.attrs["MATLAB_class"], empty.attrs["MATLAB_empty"] = np.bytes_("double"), np.uint8(1)
    record = read_time(path)
    assert record.channels == ("box", "rail")
    np.testing.assert_array_equal(record.values, x.T)


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
@pytest.mark.parametrize(
    "attributes",
    [
        {"scale_factor": 0.01}, {"add_offset": -3.0, "scale_factor": 2.0}, {"_FillValue": np.int16(7)},
        {"missing_value": np.int16(5), "scale_factor": 0.5},
    ],
)  # fmt: skip
def test_packed_numbers_as_xarray_decodes_them(engine: str, attributes: dict[str, Any], tmp_path: Path) -> None:
    whole = np.array([5, 7, -3, 100, 7, 20], dtype=np.int16)
    raw = xr.Dataset({"acc": ("time", whole, attributes)}, coords={"time": np.arange(6) / 64.0})
    path = tmp_path / "a.nc"
    raw.to_netcdf(path, engine=engine)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with xr.open_dataset(path, engine=engine, decode_times=False) as meant:
            values = meant["acc"].values.astype(np.float64)
    record = read_time(path, keep_nonfinite=True, hints=Hints(unit={"time": "s"}))
    np.testing.assert_allclose(record.values[0], values, rtol=1e-6)
    if np.isnan(values).any():
        with pytest.raises(InputError, match=f"sample {int(np.flatnonzero(np.isnan(values))[0])}"):
            read_time(path)


def test_valid_ranges_and_what_was_never_written(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    with io.netcdf_file(path, "w") as file:
        file.createDimension("time", 5)
        for name, values in (("a", [1, 2, 3, 99, 4]), ("b", [1, 2, 9.969209968386869e36, 3, 4])):
            data = file.createVariable(name, "f8", ("time",))
            data[:] = values
        file.variables["a"].valid_max = 50.0
    for name, sample in (("a", 3), ("b", 2)):
        with pytest.raises(InputError, match=f"channel '{name}', sample {sample}: not a finite number"):
            read_time(path, channels=[name])


def test_square_responses_in_hdf5(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    values = np.arange(20.0).reshape(5, 2, 2) * 1j
    with h5py.File(path, "w") as file:
        file["f"], file["frf"] = np.arange(1.0, 6.0), values.transpose()
        file["sensor"], file["hammer"] = [b"s1", b"s2"], [b"p1", b"p2"]
    with pytest.raises(InputError, match=r"which axis counts the responses .*axes = "):
        read_frf(path)
    record = read_frf(path, hints=Hints(axes=("reference", "response", "frequency")))
    np.testing.assert_array_equal(record.pair("s1", "p2"), values[:, 0, 1])
    np.testing.assert_array_equal(read_frf(path, hints=Hints(axes=("response", "reference", "frequency")))
                                  .pair("s2", "p1"), values[:, 0, 1])  # fmt: skip


def test_a_unit_that_begins_one_column_early(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    content = header(4, 1, 3, even=True, axis=17).replace(
        "NONE                 m/s^2", "NONE                mm/s^2"
    )
    path.write_text(content + body(np.arange(3.0), (DOUBLE,) * 4) + END)
    assert read_time(path).units == ("(mm/s^2)/N",)


def test_responses_of_real_numbers_at_nodes(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    dataset = pyuff.prepare_55(
        model_type=1, analysis_type=5, data_ch=2, spec_data_type=12, data_type=2, n_data_per_node=3, r1=[1.0, 2.0],
        r2=[1.0, 2.0], r3=[1.0, 2.0], node_nums=[11, 12], load_case=1, freq_step_n=1, freq=20.0,
    )  # fmt: skip
    written.append_uff(path, dataset)
    with pytest.raises(InputError, match="magnitudes without a phase"):
        read_frf(path)


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("even", [False, True])
def test_only_the_pairs_asked_for_must_be_sound(even: bool, binary: bool, tmp_path: Path) -> None:
    """Written by hand: pyuff writes zeros for what is not finite."""
    path = tmp_path / "a.uff"
    content = b""
    for node in (1, 2):
        values = np.tile([0.0, node], (6, 1))
        values[0] = np.nan
        values[3] = np.nan if node == 2 else values[3]
        table = values if even else np.column_stack([np.arange(6.0), values])
        first = f"    58b{1:6d}{2:6d}{11:12d}{table.nbytes:12d}{0:6d}{0:6d}{0:12d}{0:12d}" if binary else "    58"
        head = header(6, 4, 6, even=even, start=0.0, step=1.0, node=node, first=first).encode()
        form = (DOUBLE,) * 4 if even else ("13.5E", DOUBLE, DOUBLE)
        content += head + (table.tobytes() if binary else body(table.ravel(), form).encode()) + END.encode()
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"2:\+Z / 7:-Z, 3 Hz: the response is empty or not a finite number"):
        read_frf(path)
    record = read_frf(path, responses=["1:+Z"])
    np.testing.assert_array_equal(record.values[0, 1:], np.full(5, 1j))


def test_labels_that_tie_are_distinguished(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    for name, quantity in (("left", 12), ("right", 12)):
        dataset = pyuff.prepare_58(
            binary=0, func_type=1, rsp_node=7, rsp_dir=3, ref_node=0, ref_dir=0, rsp_ent_name=name,
            data=np.arange(6.0), x=np.arange(6) / 64, abscissa_spacing=1, abscissa_spec_data_type=17,
            ordinate_spec_data_type=quantity, orddenom_spec_data_type=0,
        )  # fmt: skip
        written.append_uff(path, dataset)
    assert read_time(path).channels == ("7:+Z (left)", "7:+Z (right)")
