"""One record written in every format, by the format's own library or by hand."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyuff
import xarray as xr
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy import io
from scipy.io import wavfile

NAMES = ("axle box", "bogie", "rail")
RATE = 512.0
UNIT = "m/s^2"


def samples(count: int = 300, seed: int = 3) -> np.ndarray:
    """Noise in three channels, exactly representable in single precision."""
    rng = np.random.default_rng(seed)
    return rng.standard_normal((3, count)).astype(np.float32).astype(np.float64)


def csv(path: Path, x: np.ndarray) -> None:
    rows = [",".join([f"{i / RATE:.9f}", *(f"{v:.17g}" for v in row)]) for i, row in enumerate(x.T)]
    header = ",".join(["time [s]", *(f"{name} [{UNIT}]" for name in NAMES)])
    path.write_text("# logger 7\n" + "\n".join([header, *rows]) + "\n")


def tsv(path: Path, x: np.ndarray) -> None:
    rows = ["\t".join(f"{v:.17g}".replace(".", ",") for v in row) for row in x.T]
    path.write_text(f"# fs = {RATE:g} Hz\n" + "\n".join(["\t".join(NAMES), "\t".join([UNIT] * 3), *rows]) + "\n")


def npz(path: Path, x: np.ndarray) -> None:
    np.savez_compressed(path, fs=RATE, acceleration=x.T, channels=np.array(NAMES), unit=UNIT)


def npz_fortran(path: Path, x: np.ndarray) -> None:
    np.savez(
        path, sampling_Hz=RATE, data=np.asfortranarray(x.T), names=np.array(NAMES), units=np.array([UNIT] * 3)
    )


def mat(path: Path, x: np.ndarray) -> None:
    names = np.array(NAMES, dtype=object)
    io.savemat(path, {"fs": RATE, "data": x.T, "channels": names, "unit": UNIT}, do_compression=True)


def mat_columns(path: Path, x: np.ndarray) -> None:
    """A variable for each channel, with names as MATLAB allows them."""
    io.savemat(path, {"t": np.arange(x.shape[1]) / RATE, "ax": x[0], "bo": x[1], "ra": x[2]}, oned_as="column")


def mat73(path: Path, x: np.ndarray) -> None:
    """As MATLAB writes -v7.3: a block of its own before HDF5, arrays turned, texts as numbers."""
    with h5py.File(path, "w", userblock_size=512) as file:

        def put(name: str, value: np.ndarray, kind: str) -> h5py.Dataset:
            data = file.create_dataset(name, data=value)
            data.attrs["MATLAB_class"] = np.bytes_(kind)
            return data

        put("fs", np.array([[RATE]]), "double")
        put("data", x, "double")  # in MATLAB (sample, channel)
        put("unit", np.array([[ord(c)] for c in UNIT], dtype=np.uint16), "char")
        cells = []
        for i, name in enumerate(NAMES):
            put(f"#refs#/{i}", np.array([[ord(c)] for c in name], dtype=np.uint16), "char")
            cells.append([file[f"#refs#/{i}"].ref])
        names = file.create_dataset("channels", data=np.array(cells, dtype=h5py.ref_dtype), dtype=h5py.ref_dtype)
        names.attrs["MATLAB_class"] = np.bytes_("cell")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
    with path.open("r+b") as raw:
        raw.write(head)


def hdf5(path: Path, x: np.ndarray) -> None:
    with h5py.File(path, "w") as file:
        group = file.create_group("run 1")
        group.attrs["sampling_rate"] = RATE
        for name, row in zip(NAMES, x, strict=True):
            group.create_dataset(name, data=row, chunks=(min(64, row.size),), compression="gzip").attrs[
                "units"
            ] = UNIT


def netcdf(path: Path, x: np.ndarray) -> None:
    time = ("time", np.arange(x.shape[1]) / RATE, {"units": "s"})
    data = xr.Dataset(
        {"acceleration": (("channel", "time"), x, {"units": UNIT})}, coords={"time": time, "channel": list(NAMES)}
    )
    data.to_netcdf(path, engine="h5netcdf")


def netcdf3(path: Path, x: np.ndarray) -> None:
    time = ("time", np.arange(x.shape[1]) / RATE, {"units": "s"})
    data = xr.Dataset(
        {"acceleration": (("channel", "time"), x, {"units": UNIT})}, coords={"time": time, "channel": list(NAMES)}
    )
    data.to_netcdf(path, engine="scipy")


def tdms(path: Path, x: np.ndarray) -> None:
    wave = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": UNIT}
    with TdmsWriter(str(path)) as file:
        channels = [ChannelObject("run", name, row, properties=wave) for name, row in zip(NAMES, x, strict=True)]
        file.write_segment([RootObject(), GroupObject("run"), *channels])


def wav(path: Path, x: np.ndarray) -> None:
    wavfile.write(path, int(RATE), x.T.astype(np.float32))


def append_uff(path: Path, dataset: dict[str, object]) -> None:
    """Append a dataset by pyuff."""
    with warnings.catch_warnings():
        # It leaves its file to be closed by the collector after binary values.
        warnings.simplefilter("ignore", ResourceWarning)
        pyuff.UFF(str(path)).write_sets(dataset, mode="add")


def uff_time(path: Path, x: np.ndarray, *, binary: int = 0, even: int = 1) -> None:
    """By pyuff, channels at nodes 1, 2, 3 in +Z."""
    path.unlink(missing_ok=True)
    for node, row in enumerate(x, start=1):
        dataset = pyuff.prepare_58(
            binary=binary,
            func_type=1,
            rsp_node=node,
            rsp_dir=3,
            ref_node=0,
            ref_dir=0,
            data=row,
            x=np.arange(row.size) / RATE,
            id1=NAMES[node - 1],
            abscissa_spacing=even,
            abscissa_spec_data_type=17,
            ordinate_spec_data_type=12,
            ordinate_axis_units_lab=UNIT,
            orddenom_spec_data_type=0,
        )
        append_uff(path, dataset)


def uff_binary(path: Path, x: np.ndarray) -> None:
    uff_time(path, x, binary=1)


WRITERS: dict[str, Callable[[Path, np.ndarray], None]] = {
    "a.csv": csv,
    "a.tsv": tsv,
    "a.npz": npz,
    "fortran.npz": npz_fortran,
    "a.mat": mat,
    "columns.mat": mat_columns,
    "v73.mat": mat73,
    "a.h5": hdf5,
    "a.nc": netcdf,
    "classic.nc": netcdf3,
    "a.tdms": tdms,
    "a.wav": wav,
    "a.uff": uff_time,
    "binary.uff": uff_binary,
}


def frf(points: int = 40, seed: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies, responses (frequency, response, reference) and coherence of two responses, three references."""
    rng = np.random.default_rng(seed)
    values = rng.standard_normal((points, 2, 3)) + 1j * rng.standard_normal((points, 2, 3))
    return 2.0 + 0.5 * np.arange(points), values, rng.random((points, 2, 3))
