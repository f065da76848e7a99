"""Random files of named arrays: MAT by scipy and as MATLAB turns them, NPZ, HDF5 by h5py, NetCDF, TDMS."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from drawn import RATES, UNITS, Meaning, Responses, Times, by_pair, chance, pick, responses, signals
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from permway.recordings.readers.hints import Hints
from scipy import io

_TIME_UNITS = {"s": 1.0, "ms": 1e-3, "milliseconds": 1e-3, "microseconds": 1e-6, "seconds": 1.0}


def _names(random: np.random.Generator, count: int) -> list[str]:
    return [f"{pick(random, 'box', 'rail', 'a', 'Achse ä')} {i}" for i in range(count)]


def _time_arrays(random: np.random.Generator, rate: float, samples: int) -> tuple[dict[str, Any], float | None]:
    """Arrays that state the rate, and the rate that they mean; times in ms without a unit mean none."""
    kind = pick(random, "fs", "dt", "time", "both", "none", "ms")
    t = np.arange(samples) / rate
    arrays = {
        "fs": {"fs": rate}, "dt": {"dt": 1.0 / rate}, "time": {"t": t}, "both": {"time": t, "fs": rate},
        "none": {}, "ms": {"time": t * 1e3},
    }[kind]  # fmt: skip
    return dict(arrays), None if kind == "none" else rate


def _table(random: np.random.Generator) -> tuple[dict[str, Any], Times, np.ndarray]:
    """A table of samples (sample, channel) with what stands beside, and what it means."""
    count, samples = int(random.integers(1, 5)), int(random.integers(6, 80))
    x = signals(random, count, samples)
    if chance(random, 0.5):
        x = x.astype(np.float32).astype(np.float64)
    rate = pick(random, *(r for r in RATES if r < 20_000.0))
    beside, meant_rate = _time_arrays(random, rate, samples)
    names = _names(random, count)
    unit = pick(random, None, *UNITS)
    if unit is not None:
        beside["unit"] = unit
    factor = 1.0 if unit is None else UNITS[unit]
    return (
        {**beside, "channels": names},
        Times(
            channels=dict(zip(names, x * factor, strict=True)),
            units=dict.fromkeys(names, unit),
            rate_Hz=meant_rate,
            rate_precision=1e-4,
            precision=1e-6 if unit else 1e-12,
        ),
        x.T,
    )


def mat(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """MAT of version 5, flat or in a struct."""
    arrays, meant, table = _table(random)
    content = {**arrays, "channels": np.array(arrays["channels"], dtype=object), "acc": table}
    if chance(random, 0.4):
        inside = {key: content.pop(key) for key in list(content) if chance(random, 0.5) or key == "acc"}
        content["data"] = inside
    path = folder / "a.mat"
    io.savemat(path, content, do_compression=chance(random, 0.5), oned_as=pick(random, "row", "column"))
    return path, meant


def _put(group: Any, root: Any, name: str, value: Any) -> None:
    """As MATLAB writes -v7.3: axes turned, texts as numbers, cells as references."""
    if isinstance(value, dict):
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, item in value.items():
            _put(inner, root, key, item)
    elif isinstance(value, str):
        codes = np.array([[ord(c)] for c in value], dtype=np.uint16)
        group.create_dataset(name, data=codes).attrs["MATLAB_class"] = np.bytes_("char")
    elif isinstance(value, list):
        references = []
        for text in value:
            place = f"#refs#/{name}{len(root.require_group('#refs#'))}"
            codes = np.array([[ord(c)] for c in text], dtype=np.uint16)
            root.create_dataset(place, data=codes).attrs["MATLAB_class"] = np.bytes_("char")
            references.append([root[place].ref])
        cells = group.create_dataset(name, data=np.array(references, dtype=h5py.ref_dtype), dtype=h5py.ref_dtype)
        cells.attrs["MATLAB_class"] = np.bytes_("cell")
    else:
        array = np.atleast_2d(np.asarray(value))
        array = array.T if np.ndim(value) == 1 else array
        kind = array.dtype
        if kind.kind == "c":
            array = array.view([("real", "f8"), ("imag", "f8")]).reshape(array.shape)
        data = group.create_dataset(name, data=array.transpose())
        data.attrs["MATLAB_class"] = np.bytes_("single" if kind == np.float32 else "double")


def _turned(path: Path, content: dict[str, Any]) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            _put(file, file, name, value)
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
    with path.open("r+b") as raw:
        raw.write(head)


def mat73(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """MAT of version 7.3, flat or in a struct."""
    arrays, meant, table = _table(random)
    content: dict[str, Any] = {**arrays, "acc": table}
    if chance(random, 0.4):
        content = {"data": content, **({"note": 3.0} if chance(random, 0.5) else {})}
    path = folder / "a73.mat"
    _turned(path, content)
    return path, meant


def npz(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """NumPy's archive."""
    arrays, meant, table = _table(random)
    path = folder / "a.npz"
    np.savez(path, **{**arrays, "channels": np.array(arrays["channels"])}, acc=pick(random, table, table.T))
    return path, meant


def hdf5(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """A dataset for each channel, the rate as an attribute, in a group or not; packed or with a fill."""
    _, meant, table = _table(random)
    path = folder / "a.h5"
    channels: dict[str, np.ndarray] = {}
    precision = 1e-12
    with h5py.File(path, "w") as file:
        group = file.create_group("run") if chance(random, 0.5) else file
        group.attrs[pick(random, "fs", "sampling_rate", "sampling_Hz")] = meant.rate_Hz or 100.0
        packed = chance(random, 0.3)
        for name, row in zip(meant.channels, table.T, strict=True):
            unit = meant.units[name]
            if packed:
                scale, offset = float(np.abs(row).max()) / 2.0**14, float(row.mean())
                whole = np.round((row - offset) / scale).astype(np.int32)
                data = group.create_dataset(name, data=whole)
                data.attrs["scale_factor"], data.attrs["add_offset"] = scale, offset
                row = whole * scale + offset
            else:
                data = group.create_dataset(name, data=row)
            if unit is not None:
                data.attrs["units"] = unit
            channels[name] = row * (1.0 if unit is None else UNITS[unit])
    return path, Times(channels, meant.units, meant.rate_Hz or 100.0, precision=max(precision, 1e-9))


def netcdf(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """By xarray, of both kinds, packed and with missing values."""
    count, samples = int(random.integers(1, 4)), int(random.integers(6, 60))
    x = signals(random, count, samples)
    rate = pick(random, *(r for r in RATES if r < 900.0))
    names = _names(random, count)
    unit = pick(random, None, *(u for u in UNITS if u.isascii()))
    time_unit = list(_TIME_UNITS)[int(random.integers(len(_TIME_UNITS)))]
    time = np.arange(samples) / rate / _TIME_UNITS[time_unit]
    attrs = {} if unit is None else {"units": unit}
    engine = pick(random, "h5netcdf", "scipy")
    turned = chance(random, 0.5)
    dims = ("time", "channel") if turned else ("channel", "time")
    encoding: dict[str, Any] = {}
    if chance(random, 0.4):
        scale, offset = float(np.abs(x).max()) / 2.0**14, float(x.mean())
        encoding = {"dtype": "int16", "scale_factor": scale, "add_offset": offset, "_FillValue": -32768}
        x = np.round((x - offset) / scale) * scale + offset
    if chance(random, 0.2):
        x[0, 2] = np.nan
        encoding = encoding or {"_FillValue": -9999.0}
    data = xr.Dataset(
        {"acc": (dims, x.T if turned else x, attrs)},
        coords={"time": ("time", time, {"units": time_unit}), "channel": names},
    )
    path = folder / f"{engine}.nc"
    # Times in units of time are decoded by whoever reads, not here.
    data.to_netcdf(path, engine=engine, encoding={"acc": encoding})
    factor = 1.0 if unit is None else UNITS[unit]
    return path, Times(dict(zip(names, x * factor, strict=True)), dict.fromkeys(names, unit), rate, precision=1e-6)


def tdms(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """By npTDMS's writer: waveforms with starts, scales and units, or channels of times."""
    count, samples = int(random.integers(1, 4)), int(random.integers(4, 60))
    x = signals(random, count, samples)
    rate = pick(random, *RATES)
    names = _names(random, count)
    scale, axis = pick(random, (1.0, None), (1.0, "s"), (1e3, "ms"), (1.0, None))
    times = chance(random, 0.3)
    objects: list[Any] = []
    units: dict[str, str | None] = {}
    meant: dict[str, np.ndarray] = {}
    start = np.datetime64("2026-01-05T10:00:00", "us")
    late = chance(random, 0.2)
    for i, (name, row) in enumerate(zip(names, x, strict=True)):
        unit = pick(random, None, *UNITS)
        properties: dict[str, Any] = {} if unit is None else {"unit_string": unit}
        if not times:
            properties |= {"wf_increment": scale / rate, "wf_start_offset": 0.0, "wf_start_time": start}
            if late and i:
                properties["wf_start_time"] = start + np.timedelta64(500, "ms")
            if axis:
                properties["wf_xunit_string"] = axis
        data = row
        if chance(random, 0.3):
            slope, intercept = float(np.abs(row).max()) / 2.0**14, float(row.mean())
            data = np.round((row - intercept) / slope).astype(np.int16)
            row = data * slope + intercept
            properties |= {
                "NI_Scaling_Status": "unscaled", "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
                "NI_Scale[0]_Linear_Slope": slope, "NI_Scale[0]_Linear_Y_Intercept": intercept,
                "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
            }  # fmt: skip
        objects.append(ChannelObject("run", name, data, properties=properties))
        units[name] = unit
        meant[name] = row * (1.0 if unit is None else UNITS[unit])
    if times:
        t = np.arange(samples) / rate
        objects.insert(0, ChannelObject("run", pick(random, "Time [s]", "time", "t"), t))
    path = folder / "a.tdms"
    with TdmsWriter(str(path)) as file:
        file.write_segment([RootObject(), GroupObject("run"), *objects])
    if late and not times and count > 1:
        # Records that do not begin together are no record: whatever is returned is wrong.
        meant = {name: row * np.nan for name, row in meant.items()}
    return path, Times(meant, units, rate, precision=1e-6)


def _frf_arrays(random: np.random.Generator) -> tuple[dict[str, Any], Responses]:
    f, values, coherence = responses(random)
    sensors, points = ([f"{k}{i}" for i in range(n)] for k, n in zip("sp", values.shape[1:], strict=True))
    unit, factor = pick(random, (None, 1.0), ("(m/s2)/N", 1.0), ("mm/kN", 1e-6))
    arrays: dict[str, Any] = {"f": f, "frf": values, "coh": coherence, "sensor": sensors, "hammer": points}
    if unit is not None:
        arrays["unit"] = unit
    meant = Responses(
        f, by_pair(values, sensors, points, factor), by_pair(coherence, sensors, points),
        None if unit is None else factor,
    )  # fmt: skip
    return arrays, meant


def frf_mat(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses in MAT of version 5."""
    arrays, meant = _frf_arrays(random)
    cells = {key: np.array(value, dtype=object) for key, value in arrays.items() if isinstance(value, list)}
    content: dict[str, Any] = {**arrays, **cells}
    path = folder / "frf.mat"
    io.savemat(path, {"result": content} if chance(random, 0.3) else content)
    return path, meant


def frf_mat73(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses in MAT of version 7.3."""
    arrays, meant = _frf_arrays(random)
    path = folder / "frf73.mat"
    _turned(path, {"result": arrays} if chance(random, 0.3) else arrays)
    return path, meant


def frf_npz(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses in NumPy's archive."""
    arrays, meant = _frf_arrays(random)
    path = folder / "frf.npz"
    np.savez(path, **arrays)
    return path, meant


def frf_hdf5(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses in plain HDF5, in either order of axes; with what states it, or without."""
    arrays, meant = _frf_arrays(random)
    path = folder / "frf.h5"
    turned = chance(random, 0.5)
    axes = ["frequency", "response", "reference"]
    with h5py.File(path, "w") as file:
        for key, value in arrays.items():
            array = value if isinstance(value, str) else np.asarray(value)
            if key in ("frf", "coh") and turned:
                array = np.transpose(value)
            file[key] = [t.encode() for t in value] if isinstance(value, list) else array
    if chance(random, 0.3):
        ask = {"hints": Hints(axes=tuple(axes[::-1] if turned else axes))}
        meant = Responses(meant.frequency_Hz, meant.values, meant.coherence, meant.factor, ask=ask)
    return path, meant


def frf_netcdf(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses by xarray, axes named, in any order."""
    arrays, meant = _frf_arrays(random)
    names = {"frequency": "f", "sensor": "sensor", "hammer": "hammer"}
    data = xr.Dataset(
        {key: (tuple(names), arrays[key]) for key in ("frf", "coh")},
        coords={dim: (dim, np.asarray(arrays[key])) for dim, key in names.items()},
    )
    order = [str(name) for name in random.permutation(list(names))]
    data["frf"] = data["frf"].transpose(*order)
    if "unit" in arrays:
        data["frf"].attrs["units"] = arrays["unit"]
    path = folder / "frf.nc"
    with warnings.catch_warnings():
        # Complex numbers are outside the standard, and it says so each time.
        warnings.simplefilter("ignore", UserWarning)
        data.to_netcdf(path, engine="h5netcdf", invalid_netcdf=True)
    return path, meant
