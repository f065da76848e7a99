"""Files from anyone: what they announce is held against limits before memory is taken, and nothing hangs."""

from __future__ import annotations

import resource
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import written
from permway.errors import InputError
from permway.formats.model_file import read_model
from permway.laws.measured import read_measured
from permway.recordings.readers import hdf5, hdf5_trial, read_frf, read_table, read_time
from permway.study import read_study

TERA = 10**12


def long_names(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["data"] = np.arange(60.0).reshape(20, 3)
        file.create_dataset("channels", shape=(3,), dtype="S100000000")


def long_text(path: Path) -> None:
    """Of any length, as far as its type goes."""
    with h5py.File(path, "w") as file:
        file["data"] = np.arange(60.0).reshape(20, 3)
        file["channels"] = np.array(["a" * 40_000_000, "b" * 40_000_000, "c"], dtype=object)


def tera_of_samples(path: Path) -> None:
    with h5py.File(path, "w") as file:
        data = file.create_dataset("data", shape=(TERA, 3), dtype="f8", chunks=(1000, 3), compression="gzip")
        data[:1000] = 0.0


def tera_of_times(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name in ("t", "data"):
            data = file.create_dataset(name, shape=(TERA,), dtype="f8", chunks=(1000,), compression="gzip")
            data[:1000] = np.arange(1000.0)


def tera_of_lines(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name, kind in (("f", "f8"), ("frf", "c16")):
            data = file.create_dataset(name, shape=(TERA,), dtype=kind, chunks=(1000,), compression="gzip")
            data[:1000] = np.arange(1000.0).astype(kind)


def packed_names(path: Path) -> None:
    """80 MB of zeros, packed to 80 kB, that claim to be names."""
    head = np.lib.format.header_data_from_array_1_0(np.zeros(3, "U7000000"))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("channels.npy", "w") as file:
            np.lib.format.write_array_header_1_0(file, head)
            for _ in range(84):
                file.write(bytes(1_000_000))
        with archive.open("data.npy", "w") as file:
            np.lib.format.write_array(file, np.zeros((20, 3)))


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.h5", long_names),
        ("a.h5", long_text),
        ("a.h5", tera_of_samples),
        ("a.h5", tera_of_times),
        ("a.h5", tera_of_lines),
        ("a.npz", packed_names),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_what_is_announced_is_not_taken(tmp_path: Path, name: str, write: Callable[[Path], None]) -> None:
    path = tmp_path / name
    write(path)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=r"memory|above the limit"):
        (read_frf if write is tera_of_lines else read_time)(path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000


def hollow(path: Path, size: int) -> Path:
    """A file of zeros that takes no room on disc."""
    with path.open("wb") as file:
        file.truncate(size)
    return path


def test_files_that_are_too_large_are_not_read(tmp_path: Path) -> None:
    large = hollow(tmp_path / "a.toml", 2**34)
    for read in (read_model, read_study):
        with pytest.raises(InputError, match="is larger than 16 MiB"):
            read(large)
    with pytest.raises(InputError, match="is larger than 32 MiB"):
        read_measured(hollow(tmp_path / "a.csv", 2**34), "impedance")
    table = tmp_path / "b.csv"
    table.write_text("a,b\n" + "1,2\n" * 5000)
    with table.open("r+b") as file:
        file.truncate(2**34)
    with pytest.raises(InputError, match="above the limit"):
        read_table(table)
    classic = tmp_path / "c.nc"
    written.netcdf3(classic, written.samples(40))
    with classic.open("r+b") as file:
        file.truncate(2**34)
    with pytest.raises(InputError, match="above the limit"):
        read_time(classic)


@pytest.mark.parametrize("does", ["while True: pass", "import time; time.sleep(600)", "import os; os.abort()"])
def test_a_file_on_which_hdf5_hangs_or_crashes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, does: str) -> None:
    """The library's part is played by a script."""
    path, script = tmp_path / "a.h5", tmp_path / "trial.py"
    written.hdf5(path, written.samples(40))
    limit = "import resource as r, sys; t = int(sys.argv[3]); r.setrlimit(r.RLIMIT_CPU, (t, t))\n"
    script.write_text(limit + "r.setrlimit(r.RLIMIT_CORE, (0, 0))\n" + does)
    monkeypatch.setattr(hdf5_trial, "__file__", str(script))
    monkeypatch.setattr(hdf5, "TRIAL_S", 1.0)
    monkeypatch.setattr(hdf5, "_LONGEST_WAIT", 3.0)
    with pytest.raises(InputError, match="hangs or crashes"):
        read_time(path)


@pytest.mark.parametrize("heap", [(0, 0, 0, 0), (1, 1, 0, 2**64 - 16)], ids=["of no length", "length wraps"])
def test_a_damaged_heap_of_texts_on_which_hdf5_hangs(tmp_path: Path, heap: tuple[int, ...]) -> None:
    """The library's reader of the heap goes on by the length that stands there, and by none for ever."""
    path = tmp_path / "a.nc"
    written.netcdf(path, written.samples(40))
    content = bytearray(path.read_bytes())
    first = content.index(b"GCOL") + 16
    content[first : first + 16] = struct.pack("<HHIQ", *heap)
    path.write_bytes(content)
    with pytest.raises(InputError, match="hangs or crashes"):
        read_table(path)


def test_axes_that_are_too_long_together(tmp_path: Path) -> None:
    """Each of a million values is allowed, and run together they are a million cases."""
    axes = [
        f'[axes.a{i}]\npath = "line.joints[{i}].scale"\nvalues = {{ from = 1.0, to = 2.0, count = 1_000_000 }}\n'
        for i in range(3)
    ]
    path = tmp_path / "study.toml"
    path.write_text('combine = "zip"\nmodel = {}\n' + "".join(axes))
    with pytest.raises(InputError, match=r"axes\.a2: makes more than 2000000 values with the axes before it"):
        read_study(path)
