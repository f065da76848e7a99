"""Random bytes, and files damaged at random, end in a record or in one `InputError`, never in anything else.

The readers written by hand (text, UFF, MAT, WAV) let every other exception through: a mistake in them shows.
"""

from __future__ import annotations

import struct
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import written
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_table, read_time
from permway.recordings.record import FrfRecord, TableRecord, TimeRecord

MOST = 2**26
MAGIC = {
    "a.csv": b"a,b\n",
    "a.uff": b"    -1\n    58\n",
    "a.npz": b"PK\x03\x04",
    "a.mat": b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM",
    "a.h5": b"\x89HDF\r\n\x1a\n",
    "a.nc": b"CDF\x01",
    "a.tdms": b"TDSm",
    "a.wav": b"RIFF\x00\x00\x00\x00WAVE",
    "a.dat": b"",
}
TOKENS = [
    b"-1",
    b"    -1\n",
    b"nan",
    b"1e999",
    b",",
    b";",
    b"\n",
    b"\x00",
    b"\xff\xff\xff\xff",
    b"9" * 12,
    b"[",
    b"\t",
]


@cache
def valid(file: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file
        written.WRITERS[file](path, written.samples(40))
        return path.read_bytes()


def attempt(file: str, content: bytes) -> int:
    """How many of the three readers made something of it."""
    made = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_bytes(content)
        for reader, kind in ((read_time, TimeRecord), (read_frf, FrfRecord), (read_table, TableRecord)):
            try:
                record = reader(path, max_bytes=MOST)
            except InputError as error:
                assert error.where  # noqa: PT017
                assert error.what  # noqa: PT017
                continue
            made += 1
            assert isinstance(record, kind)
            if isinstance(record, TimeRecord):
                assert np.isfinite(record.values).all()
                assert record.values.shape[1] > 0
    return made


@st.composite
def damage(draw: st.DrawFn, content: bytes) -> bytes:
    data = bytearray(content)
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, max(len(data) - 1, 0)))
        kind = draw(st.sampled_from(["flip", "cut", "drop", "insert", "repeat", "zero"]))
        if kind == "flip" and data:
            data[at] ^= draw(st.integers(1, 255))
        elif kind == "cut":
            del data[at:]
        elif kind == "drop":
            del data[at : at + draw(st.integers(1, 40))]
        elif kind == "insert":
            data[at:at] = draw(st.sampled_from(TOKENS) | st.binary(min_size=1, max_size=8))
        elif kind == "repeat":
            data[at:at] = data[at : at + draw(st.integers(1, 200))]
        else:
            stop = min(at + draw(st.integers(1, 16)), len(data))
            data[at:stop] = bytes(stop - at)
    return bytes(data)


# Left out, for each is opened in a process of its own first, which takes its time: see tests/fuzz.
HDF5 = ("a.nc", "a.h5", "v73.mat")


@pytest.mark.parametrize("file", [name for name in written.WRITERS if name not in HDF5])
@settings(max_examples=20)
@given(data=st.data())
def test_damaged(file: str, data: st.DataObject) -> None:
    attempt(file, data.draw(damage(valid(file))))


@pytest.mark.parametrize("file", written.WRITERS)
def test_undamaged(file: str) -> None:
    assert attempt(file, valid(file)) >= 1


@pytest.mark.parametrize("file", MAGIC)
@settings(max_examples=20)
@given(tail=st.binary(max_size=400))
def test_random_bytes(file: str, tail: bytes) -> None:
    attempt(file, MAGIC[file] + tail)


@settings(max_examples=100)
@given(st.lists(st.text('ab,;\t 0123456789.-+eE[]()#%"tms/^\r', max_size=20), max_size=8))
def test_random_tables(lines: list[str]) -> None:
    attempt("a.csv", "\n".join(lines).encode())


@settings(max_examples=100)
@given(data=st.data())
def test_random_fields_of_a_universal_file(data: st.DataObject) -> None:
    lines = valid("a.uff").decode().split("\n")
    at = data.draw(st.integers(0, 13))
    width = data.draw(st.integers(1, 14))
    field = data.draw(st.integers(0, 70))
    stated = data.draw(
        st.sampled_from(["0", "-1", "7", "99999999", "nan", "1e300", "-1e-300", "x", "", "inf", "58b"])
    )
    lines[at] = lines[at][:field] + stated.rjust(width) + lines[at][field + width :]
    attempt("a.uff", "\n".join(lines).encode())
