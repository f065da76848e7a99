"""WAV: whole numbers of 8 to 32 bits or floats, reported as parts of full scale, for the file knows no unit."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.timefile import TimeFile, Timing

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_BITS = {_PCM: (8, 16, 24, 32), _FLOAT: (32, 64)}


@dataclass(frozen=True)
class _Layout:
    form: int
    channels: int
    rate_Hz: int
    bits: int
    at: int
    size: int


@contextmanager
def open_time(source: Path) -> Iterator[TimeFile]:
    """Open a WAV file: channels "1", "2" and on; whole numbers over their full scale, 2^(bits - 1).

    Source: Microsoft and IBM, Multimedia Programming Interface and Data Specifications 1.0 (1991), "WAVE".
    """
    layout = _layout(source)
    frame = layout.channels * layout.bits // 8

    def read(rows: Sequence[int], first: int, stop: int) -> Reals:
        with source.open("rb") as file:
            file.seek(layout.at + first * frame)
            raw = file.read((stop - first) * frame)
        return np.ascontiguousarray(_values(raw, layout).reshape(-1, layout.channels).T[list(rows)])

    scale = "floats, as they stand" if layout.form == _FLOAT else f"parts of full scale, 2^{layout.bits - 1}"
    yield TimeFile(
        source=str(source),
        channels=tuple(str(i + 1) for i in range(layout.channels)),
        units=(None,) * layout.channels,
        timing=lambda _: Timing(samples=layout.size // frame, sampling_Hz=float(layout.rate_Hz)),
        read=read,
        notes=(scale,),
    )


def _layout(source: Path) -> _Layout:
    size = source.stat().st_size
    form: tuple[int, int, int, int] | None = None
    with source.open("rb") as file:
        at = 12
        while True:
            file.seek(at)
            head = file.read(8)
            if len(head) < 8:
                what = "holds no samples" if form else "has no description of its samples"
                raise InputError(what, where=str(source), remedy="the file is cut short; export it again")
            name, length = head[:4], struct.unpack("<I", head[4:])[0]
            if name == b"fmt ":
                form = _form(source, file.read(min(length, 40)))
            elif name == b"data":
                break
            at += 8 + length + length % 2
    if form is None:
        raise InputError("has no description before its samples", where=str(source), remedy="export it again")
    kind, channels, rate, bits = form
    if length > size - at - 8:
        raise InputError(
            f"{length} bytes of samples announced, {size - at - 8} there",
            where=str(source),
            remedy="the file is cut short; export it again",
        )
    if length % (channels * bits // 8):
        raise InputError("the last sample is cut", where=str(source), value=length, remedy="export it again")
    return _Layout(kind, channels, rate, bits, at + 8, length)


def _form(source: Path, chunk: bytes) -> tuple[int, int, int, int]:
    if len(chunk) < 16:
        raise InputError(
            "the description of its samples is cut short", where=str(source), remedy="export it again"
        )
    kind, channels, rate, _, frame, bits = struct.unpack("<HHIIHH", chunk[:16])
    if kind == _EXTENSIBLE and len(chunk) >= 26:
        kind = struct.unpack("<H", chunk[24:26])[0]
    if bits not in _BITS.get(kind, ()):
        what = "samples must be whole numbers of 8, 16, 24 or 32 bits, or floats of 32 or 64"
        raise InputError(
            what, where=str(source), value=f"code {kind}, {bits} bits", remedy="export it uncompressed"
        )
    if not channels or not rate or frame != channels * bits // 8:
        what = "channels, rate and size of a frame contradict"
        raise InputError(what, where=str(source), value=(channels, rate, frame), remedy="export it again")
    return kind, channels, rate, bits


def _values(raw: bytes, layout: _Layout) -> Reals:
    if layout.form == _FLOAT:
        return np.frombuffer(raw, dtype=f"<f{layout.bits // 8}").astype(np.float64)
    if layout.bits == 8:
        return (np.frombuffer(raw, dtype=np.uint8).astype(np.float64) - 128.0) / 128.0
    if layout.bits == 24:
        parts = np.frombuffer(raw, dtype=np.uint8).reshape(-1, 3)
        # In the upper three of four bytes, the sign comes out by itself.
        wide = np.zeros((len(parts), 4), dtype=np.uint8)
        wide[:, 1:] = parts
        return wide.view("<i4").ravel() / 2.0**31
    return np.frombuffer(raw, dtype=f"<i{layout.bits // 8}") / 2.0 ** (layout.bits - 1)
