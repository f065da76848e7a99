"""What is wrong with a file ends in one sentence that states file, place, value and remedy."""

from __future__ import annotations

import io as streams
import pickle
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import written
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_table, read_time, time_blocks
from permway.recordings.record import FrfRecord, TableRecord, TimeRecord
from scipy import io
from test_readers_uff import DOUBLE, body, header

RISING = "".join(f"{i / 100:.2f},{i}\n" for i in range(50))

TEXTS: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "the file is empty"),
    "blank lines only": ("\n\n  \n", "the file is empty"),
    "remarks only": ("# a\n# b\n", "the file is empty"),
    "header alone": ("a,b\n", "a header but no rows"),
    "header and units alone": ("a,b\nm,m\n", "a header but no rows"),
    "ragged row": ("a,b\n1,2\n3\n5,6\n", "line 3: 1 cells where there are 2 columns"),
    "row too long": ("a,b\n1,2\n3,4,5\n", "line 3: 3 cells where there are 2 columns"),
    "cut short": ("a,b\n1,2\n3,4\n5", "line 4: 1 cells"),
    "word": ("a,b\n1,2\n3,x\n", "line 3, column 'b': not a number .*'x'"),
    "empty cell": ("a,b\n1,2\n,4\n", "line 3, column 'a': the cell is empty"),
    "nan": ("a,b\n1,2\nnan,4\n", "line 3, column 'a': not a finite number .*'nan'"),
    "inf": ("a,b\n1,-inf\n3,4\n", "line 2, column 'b': not a finite number"),
    "overflow": ("a,b\n1,1e999\n", "line 2, column 'b': not a finite number"),
    "underscore": ("a,b\n1,2\n1_0,4\n", "line 3, column 'a': not a number"),
    "hexadecimal": ("a,b\n1,2\n0x1p3,4\n", "line 3, column 'a': not a number"),
    "two of one name": ("a,b,a\n1,2,3\n", "channel 3: a channel named twice .*'a'"),
    "two of one name with units": ("a [g],b,a [m]\n1,2,3\n", "a channel named twice"),
    "units that contradict": ("a [g]\nm/s2\n1\n", "the header states 'g', the row of units 'm/s2'"),
    "decimal comma and comma": ("a,b\n1,5,2,5\n", "line 2: 4 cells.*decimal comma needs ;"),
    "point and comma": (
        "a;b\n1,5;2\n1.5;3\n",
        "line 3, column 'a': a decimal point in a table with decimal commas",
    ),
    "thousands": ("a;b\n1.234,5;2\n", "line 2, column 'a': not a number"),
    "zero bytes": (b"a,b\n1,2\n" + bytes(5) + b"\n", "no format that is read|zero bytes"),
    "binary garbage": (bytes(range(256)) * 20, "no format that is read here"),
    "utf-16": ("a,b\n1,2\n".encode("utf-16"), "UTF-16.*UTF-8"),
    "a pickle": (pickle.dumps({"a": 1}), "pickle, which could run code"),
    "a bare array": (b"\x93NUMPY\x01\x00v\x00", "a bare NumPy array"),
    "time falls": ("t,a\n0,1\n1,2\n0.5,3\n", "line 4, column 't': time must rise"),
    "time stands": ("t,a\n0,1\n1,2\n1,3\n", "line 4, column 't': time must rise"),
    "time jumps": ("t,a\n" + RISING + "0.60,1\n", "line 52, column 't': a step of 0.11 s .* not uniform"),
    "time in another unit": ("t [m],a\n0,1\n1,2\n", "column 't': is no unit of time .*'m'"),
    "two times": ("t,time,a\n0,0,1\n1,1,2\n", "more than one time column"),
    "time alone": ("t [s]\n0\n1\n", "no channel in time"),
    "times that may be anything": ("t,a\n0,1\n1,2\n2,3\n", "column 't': times without a unit, .*unit = { t ="),
    "rate of thousands": ("# fs = 51,200 Hz\na\n1\n", "line 1: a remark states the sampling rate"),
    "lines above": (
        "Model,x\nSerial,7\n\na,b\n1,2\n3,4\n",
        "lines 1 to 2 are no part of a table .*header_row = 4",
    ),
    "comma of either kind": ("a;b\n1,024;2,048\n3,072;4,096\n", "decimals or thousands .*decimal = "),
    "a clock": ("t,a\n12:00:01,1\n12:00:02,2\n", "column 't': the times are printed so coarsely .* 0 to 2 Hz"),
    "a clock and a word": ("t,a\n12:00:01,1\n12:00:02,2\nnoon,3\n", "line 4, column 't': not a time of day"),
    "rate against remark": ("# fs = 50 Hz\nt,a\n" + RISING, "means 100 Hz, a remark states 50 Hz"),
    "rate of zero": ("# fs = 0\na\n1\n", "line 1: a sampling rate must be"),
}


@pytest.mark.parametrize("kind", TEXTS)
def test_text(kind: str, tmp_path: Path) -> None:
    content, stated = TEXTS[kind]
    path = tmp_path / "a.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError, match=stated) as caught:
        read_time(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("content", "stated"),
    [
        ("", "the file is empty"),
        ("a,b\n", "a header but no rows"),
        ("a,a\n1,2\n", "line 1: a column named twice"),
        ("a,\n1,2\n", "column 2 has no name"),
        ("a,b\n1,2\n3\n", "line 3: 1 cells where there are 2 columns"),
        ("a,b\n1,2\n3,x\n", "line 3, column 'b': not a number"),
        ("a,b\n1,nan\n", "line 2, column 'b': not a finite number"),
        ("a;b\n1,5;2\n1.5;3\n", "decimal points and decimal commas"),
    ],
)
def test_table(content: str, stated: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=stated) as caught:
        read_table(path)
    assert str(path) in str(caught.value)


def function(count: int = 6, **changes: object) -> str:
    return header(4, 1, count, even=True, axis=17, **changes)  # type: ignore[arg-type]


VALUES = body(np.arange(6.0), (DOUBLE,) * 4)
END = "    -1\n"
FRF = header(6, 4, 3, even=True) + body(np.arange(6.0), (DOUBLE,) * 4) + END
COHERENCE = header(4, 6, 3, even=True) + body(np.array([0.5, 0.6, 0.7]), (DOUBLE,) * 4) + END
BINARY = "    58b     1     2          11          48     0     0           0           0"

UNIVERSAL: dict[str, tuple[str | bytes, str]] = {
    "not closed": (function() + VALUES, "line 2: a dataset is not closed: cut short"),
    "header cut": (function()[:300], "cut short"),
    "values missing": (function(60) + VALUES + END, "line 9: 60 points announced, which take 15 lines, but 2 are"),
    "values beyond": (
        function(3) + VALUES + END,
        "line 9: 3 points announced, which take 1 lines, but 2 are there",
    ),
    "line short of one": (function() + VALUES.replace("  5.00000000000E+00", "") + END, "line 15: .*cut short"),
    "word": (function() + VALUES.replace("3.00000000000E+00", "3.0000x000000E+00") + END, "line 14: not a number"),
    "nan": (function() + VALUES.replace("3.00000000000E+00", "NaN              ") + END, "line 14: not a finite"),
    "number of points": (function(count=0) + END, "number of points must be 1 or more"),
    "1e9 points": (function(999_999_999) + VALUES + END, "999999999 points announced, more than the file holds"),
    "no function": (END + "   151\nx\n" + END, "holds no function over time"),
    "frequency response": (FRF, "no function over time.*read_frf"),
    "twice": ((function() + VALUES + END) * 2, "a channel named twice .*'101:.Z'"),
    "other lengths": (
        function() + VALUES + END + function(5, node=7) + body(np.arange(5.0), (DOUBLE,) * 4) + END,
        "channel '7:.Z': 5 samples where '101:.Z' has 6",
    ),
    "step of zero": (function(step=0.0) + VALUES + END, "step of the abscissa must be above 0"),
    "direction": (function(way=9) + VALUES + END, "direction must lie between -6 and 6 .*9"),
    "spacing": (
        function().replace(f"{1:10d}{2.0:13.5E}", f"{3:10d}{2.0:13.5E}") + VALUES + END,
        "spacing must be",
    ),
    "between": (function() + VALUES + END + "something\n", 'must begin with a line "    -1"'),
    "binary cut": (function(first=BINARY).encode() + bytes(40), "6 values announced, 40 bytes left: cut short"),
    "binary too long": (
        function(first=BINARY).encode() + bytes(56) + END.encode(),
        "does not end after the 6 points",
    ),
    "binary not finite": (function(first=BINARY).encode() + b"\xff" * 48 + END.encode(), "not a finite number"),
    "binary of another order": (
        function(first=BINARY.replace("b     1", "b     9")).encode() + bytes(48) + END.encode(),
        "byte order 1 or 2",
    ),
}


@pytest.mark.parametrize("kind", UNIVERSAL)
def test_universal_file(kind: str, tmp_path: Path) -> None:
    content, stated = UNIVERSAL[kind]
    path = tmp_path / "a.uff"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError, match=stated) as caught:
        read_time(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("content", "stated"),
    [
        (function() + VALUES + END, "no frequency response"),
        (FRF + FRF, "a pair measured twice"),
        (FRF + COHERENCE + COHERENCE, "two coherences of one pair"),
        (FRF + header(4, 6, 3, even=True, node=5) + COHERENCE.split("\n", 13)[13], "a coherence without its"),
        (
            FRF + COHERENCE.replace("5.00000000000E-01", "5.00000000000E+01"),
            "coherence lies between 0 and 1 .*50.0",
        ),
        (FRF + header(6, 4, 3, even=True, node=5, start=3.0) + FRF.split("\n", 13)[13], "has other frequencies"),
        (FRF.replace("m/s^2", "dB   "), "a frequency response in decibels is no ratio .*dB"),
        (FRF.replace("         6         3", "         4         6"), "101:.Z / 7:-Z is of real numbers"),
        (FRF.replace("        18    0", "        19    0"), "does not stand over frequency: .* type 19"),
        (FRF.replace("2.00000E+00", "-3.0000E+00"), "from 0 Hz on"),
    ],
)
def test_frequency_response(content: str, stated: str, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    path.write_text(content)
    with pytest.raises(InputError, match=stated) as caught:
        read_frf(path)
    assert str(path) in str(caught.value)


class Trap:
    """Unpickling it would leave a file behind."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return Path.touch, (self.path,)


def save_huge_header(path: Path) -> None:
    stream = streams.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)})
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.npy", stream.getvalue() + bytes(80))


def save_huge_chunked(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("a", shape=(10**12,), dtype="f8", chunks=(1000,))


def save_huge_written(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("a", shape=(10**12,), dtype="f8", chunks=(1000,))[:1000] = 1.0


def save_external(path: Path) -> None:
    secret = path.parent / "secret.bin"
    secret.write_bytes(bytes(80))
    with h5py.File(path, "w") as file:
        file.create_dataset("a", shape=(10,), dtype="f8", external=[(str(secret), 0, 80)])


def save_external_link(path: Path) -> None:
    with h5py.File(path.parent / "other.h5", "w") as file:
        file["a"] = np.ones(10)
    with h5py.File(path, "w") as file:
        file["a"] = h5py.ExternalLink("other.h5", "/a")


def save_wav(path: Path, **changes: int) -> None:
    fields = {"form": 1, "channels": 1, "rate": 100, "frame": 2, "bits": 16, "size": 20, **changes}
    form = struct.pack(
        "<HHIIHH", *(fields[k] for k in ("form", "channels", "rate")), 200, fields["frame"], fields["bits"]
    )
    data = b"data" + struct.pack("<I", fields["size"]) + bytes(20)
    path.write_bytes(b"RIFF" + struct.pack("<I", 60) + b"WAVE" + b"fmt " + struct.pack("<I", 16) + form + data)


def half(writer: Callable[[Path, np.ndarray], None]) -> Callable[[Path], None]:
    def save(path: Path) -> None:
        writer(path, written.samples())
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])

    return save


FILES: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "objects in npz": (
        "a.npz",
        lambda p: np.savez(p, a=np.array([Trap(p.parent / "ran")])),
        "Python objects, which",
    ),
    "header of 1e12 in npz": (
        "a.npz",
        save_huge_header,
        r"1000000000000 values of 8 bytes announced, 80 bytes there",
    ),
    "half of npz": ("a.npz", half(written.npz), "cannot be read as npz: damaged"),
    "a zip": ("a.npz", lambda p: zipfile.ZipFile(p, "w").writestr("a.txt", "x"), "is no NumPy array"),
    "dates in npz": ("a.npz", lambda p: np.savez(p, a=np.zeros(3, "M8[s]")), "neither numbers nor texts"),
    "channels of two lengths": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones(4), b=np.ones(5)),
        "5 samples where 'a' has 4",
    ),
    "names too few": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones((9, 3)), channels=np.array(["x", "y"])),
        "2 names for an array of 9 x 3",
    ),
    "names twice": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones((9, 2)), channels=np.array(["x", "x"])),
        "a channel named twice .*'x'",
    ),
    "units too few": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones((9, 3)), channels=np.array(["x", "y", "z"]), units=np.array(["g", "g"])),
        "2 units for 3 channels",
    ),
    "square": ("a.npz", lambda p: np.savez(p, a=np.ones((9, 9))), "which axis counts the channels"),
    "two tables": ("a.npz", lambda p: np.savez(p, a=np.ones((9, 2)), b=np.ones((9, 2))), "several arrays .*part="),
    "three axes": ("a.npz", lambda p: np.savez(p, a=np.ones((9, 2, 3))), "one or two axes .*9, 2, 3"),
    "rate and step": ("a.npz", lambda p: np.savez(p, a=np.ones(9), fs=100.0, dt=0.1), "contradict"),
    "rate of nothing": ("a.npz", lambda p: np.savez(p, a=np.ones(9), fs=-1.0), "finite number above 0 .*-1"),
    "rate and times": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones(9), fs=50.0, t=np.arange(9) / 100),
        "also states 50 Hz",
    ),
    "times with a gap": (
        "a.npz",
        lambda p: np.savez(p, a=np.ones(9), t=np.delete(np.arange(10.0) / 4, 6)),
        "'t', sample 6: a step of 0.5 s",
    ),
    "times too few": ("a.npz", lambda p: np.savez(p, a=np.ones(9), t=np.arange(8.0)), "8 times for 9 samples"),
    "a nan": (
        "a.npz",
        lambda p: np.savez(p, a=np.array([1, 2, np.nan, 3]), fs=4.0),
        r"channel 'a', sample 2 \(0.5 s\): not a finite number \(1 such sample here\)",
    ),
    "numbers only": ("a.npz", lambda p: np.savez(p, fs=4.0), "holds no samples"),
    "complex": ("a.npz", lambda p: np.savez(p, frf=np.ones(4) * 1j), "no array of real numbers.*read_frf"),
    "objects in mat": ("a.mat", lambda p: io.savemat(p, {"a": np.array([1, "x"], dtype=object)}), "texts only"),
    "struct in mat": ("a.mat", lambda p: io.savemat(p, {"a": {"x": 1.0}}), "holds no samples"),
    "half of mat": ("a.mat", half(written.mat), "cannot be read as mat: damaged"),
    "half of mat 7.3": ("a.mat", half(written.mat73), "cannot be read as mat73: damaged|cannot be read: "),
    "mat 4": ("a.mat", lambda p: io.savemat(p, {"a": np.ones((9, 2))}, format="4"), "no format that is read.*-v7"),
    "1e12 never written": ("a.h5", save_huge_chunked, "announced, but never written"),
    "1e12 announced": ("a.h5", save_huge_written, r"1e\+12 values take .* GiB, above the limit"),
    "values elsewhere": ("a.h5", save_external, "its values lie in another file"),
    "link elsewhere": ("a.h5", save_external_link, "holds no samples"),
    "half of hdf5": ("a.h5", half(written.hdf5), "cannot be read"),
    "half of netcdf": ("a.nc", half(written.netcdf), "cannot be read"),
    "half of classic netcdf": ("a.nc", half(written.netcdf3), "cannot be read as netcdf3"),
    "half of tdms": ("a.tdms", half(written.tdms), "the file is not whole .*incomplete|less data"),
    "half of wav": ("a.wav", half(written.wav), "bytes of samples announced"),
    "wav of 4 GB": (
        "a.wav",
        lambda p: save_wav(p, size=2**32 - 2),
        "4294967294 bytes of samples announced, 20 there",
    ),
    "wav compressed": ("a.wav", lambda p: save_wav(p, form=85), "code 85, 16 bits"),
    "wav of no channel": ("a.wav", lambda p: save_wav(p, channels=0), "contradict"),
    "wav of 12 bits": ("a.wav", lambda p: save_wav(p, bits=12), "code 1, 12 bits"),
    "wav without samples": ("a.wav", lambda p: save_wav(p, size=0), "holds no sample"),
    "wav cut within a sample": ("a.wav", lambda p: save_wav(p, size=19), "the last sample is cut"),
    "wav header alone": ("a.wav", lambda p: p.write_bytes(b"RIFF\x00\x00\x00\x00WAVE"), "no description"),
    "csv named uff": ("a.uff", lambda p: p.write_text("a,b\n1,2\n"), 'the content is text.*format="text"'),
    "npz named mat": (
        "a.mat",
        lambda p: (p.parent / "a.npz").rename(p),
        "states mat or mat73, the content is npz",
    ),
    "wav named csv": ("a.csv", save_wav, "the name states text, the content is wav"),
    "a folder": ("a.csv", lambda p: p.mkdir(), "is a folder, not a file"),
    "nothing": ("a.csv", lambda p: None, "cannot be read: No such file"),
}


@pytest.mark.parametrize("kind", FILES)
def test_file(kind: str, tmp_path: Path) -> None:
    name, save, stated = FILES[kind]
    path = tmp_path / name
    if kind == "npz named mat":
        written.npz(tmp_path / "a.npz", written.samples())
    save(path)
    with pytest.raises(InputError, match=stated) as caught:
        read_time(path)
    assert str(path) in str(caught.value)
    assert not (tmp_path / "ran").exists()


FREQUENCIES = {"f": np.arange(1.0, 6.0), "frf": np.ones((5, 2, 3)) * 1j}
ENDS = {"sensor": np.array(["a", "b"]), "hammer": np.array(["p", "q", "r"])}


@pytest.mark.parametrize(
    ("arrays", "stated"),
    [
        ({**FREQUENCIES}, "no names of the responses"),
        ({**FREQUENCIES, "sensor": np.array(["a", "b"])}, "no names of the references"),
        ({**FREQUENCIES, **ENDS, "sensor": np.array(["a", "a"])}, "'sensor': a name that stands twice"),
        (
            {**FREQUENCIES, **ENDS, "hammer": np.array(["p"])},
            "is not 5 frequencies by 2 responses by 1 references",
        ),
        ({**FREQUENCIES, **ENDS, "f": np.array([1.0, 2, 3, 3, 4])}, r"frequency_Hz\[3\]"),
        ({**ENDS, "frf": FREQUENCIES["frf"]}, "no array of frequencies"),
        ({**ENDS, "f": FREQUENCIES["f"]}, "no array of complex numbers"),
        ({**FREQUENCIES, **ENDS, "coh": np.ones((5, 3, 2))}, "coherence must be real and of the shape"),
        ({**FREQUENCIES, **ENDS, "coh": np.full((5, 2, 3), 1.5)}, "coherence lies between 0 and 1 .*1.5"),
        ({**FREQUENCIES, **ENDS, "blows": 0.0}, "'blows': must be a finite number above 0"),
    ],
)
def test_frequency_responses_in_arrays(arrays: dict[str, np.ndarray], stated: str, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, **arrays)
    with pytest.raises(InputError, match=stated) as caught:
        read_frf(path)
    assert str(path) in str(caught.value)


def test_arguments(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a,b\n1,2\n3,4\n5,6\n")
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: read_time(path, channels=["c"]), "no such channel .*'c'.*it has a, b"),
        (lambda: read_time(path, channels=["a", "a"]), "asked for twice"),
        (lambda: read_time(path, channels="a"), "must be a list of names"),
        (lambda: read_time(path, channels=[]), "must be a list of names"),
        (lambda: read_time(path, samples=(2, 9)), "within 0 and 3"),
        (lambda: read_time(path, samples=(2, 2)), "no range"),
        (lambda: read_time(path, sampling_Hz=0.0), "above 0 Hz"),
        (lambda: read_time(path, sampling_Hz=float("nan")), "above 0 Hz"),
        (lambda: read_time(path, format="xls"), "no format of this name"),
        (lambda: read_time(path, format="wav"), "the caller states wav, the content is text"),
        (lambda: read_time(path, max_bytes=40), "above the limit"),
        (lambda: list(time_blocks(path, block_samples=0)), "whole number above 0"),
        (lambda: read_frf(path), "no column of frequencies .*a row for each frequency"),
        (lambda: read_table(path, texts=["z"]), "no such column"),
    ]
    for call, stated in calls:
        with pytest.raises(InputError, match=stated):
            call()


def test_a_rate_that_disagrees_with_the_time_column(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,a\n" + RISING)
    assert read_time(path, sampling_Hz=100.0).sampling_Hz == 100.0
    with pytest.raises(InputError, match=r"the file states 100 Hz, but was stated to be sampled at 102\.4 Hz"):
        read_time(path, sampling_Hz=102.4)


def test_records_refuse_what_does_not_fit() -> None:
    ones = np.ones((2, 3))
    with pytest.raises(InputError, match="a channel named twice"):
        TimeRecord(channels=("a", "a"), units=(None, None), values=ones, sampling_Hz=1.0)
    with pytest.raises(InputError, match="1 units for 2 channels"):
        TimeRecord(channels=("a", "b"), units=(None,), values=ones, sampling_Hz=1.0)
    with pytest.raises(InputError, match=r"shape \(channel, sample\)"):
        TimeRecord(channels=("a",), units=(None,), values=ones, sampling_Hz=1.0)
    with pytest.raises(InputError, match="above 0 Hz"):
        TimeRecord(channels=("a", "b"), units=(None, None), values=ones, sampling_Hz=0.0)
    with pytest.raises(InputError, match="a pair measured twice"):
        FrfRecord(responses=("a", "a"), references=("b", "b"), frequency_Hz=np.arange(3.0), values=ones + 0j)
    with pytest.raises(InputError, match="cells, not"):
        TableRecord(columns={"a": np.ones(2), "b": ("x", "y", "z")}, units={"a": None, "b": None})
