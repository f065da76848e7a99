"""MAT files of version 5 (-v6, -v7) as named arrays: numbers, texts, cell arrays of texts, and structs of these.

Source: MathWorks, MAT-File Format (R2023b), chapter 1. Read here and not with scipy, whose reader can end the
whole process on a damaged file (an unchecked type of data, met by the tests with random damage). The tests write
with scipy.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from permway.errors import InputError
from permway.recordings.readers.limits import MOST_BYTES, MOST_CHANNELS, check_size
from permway.recordings.readers.stored import OBJECT, Store, Variable, unread

_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_CELL, _STRUCT, _CHAR, _SPARSE, _DOUBLE, _SINGLE, _LAST_NUMBER = 1, 2, 4, 5, 6, 7, 15
_OBJECTS = (3, 16, 17)
_DEEPEST = 8
_HEAD_BYTES = 65_536
_CELL_BYTES = 4096


@dataclass(frozen=True)
class _Head:
    """What stands before the values of a matrix, and where they begin."""

    name: str
    kind: int
    shape: tuple[int, ...]
    is_complex: bool
    is_logical: bool
    at: int

    @property
    def size(self) -> int:
        total = 1
        for length in self.shape:
            total *= length
        return total


class _NoTextsError(Exception):
    """A cell array of something else than texts, which is left aside."""


class _Bytes:
    """The bytes of one element, read by position; nothing beyond its end is ever read."""

    def __init__(self, data: bytes, order: str, where: str) -> None:
        self.data, self.order, self.where = data, order, where

    def element(self, at: int) -> tuple[int, bytes, int]:
        """Type and bytes of the element at a position, and the position of the next."""
        if at + 8 > len(self.data):
            raise self.cut()
        kind, size = struct.unpack_from(f"{self.order}II", self.data, at)
        if kind >> 16:
            # Up to four bytes stand within the tag itself.
            kind, size = kind & 0xFFFF, kind >> 16
            return kind, self.data[at + 4 : at + 4 + min(size, 4)], at + 8
        end = at + 8 + size
        if end > len(self.data):
            raise self.cut()
        return kind, self.data[at + 8 : end], end + (-end % 8)

    def cut(self) -> InputError:
        return InputError("cannot be read as mat: damaged or cut short", where=self.where, remedy="save it again")

    def head(self, at: int = 0) -> _Head:
        _, flags, at = self.element(at)
        if len(flags) == 8 and struct.unpack(f"{self.order}II", flags)[0] & 0xFF == _OBJECTS[-1]:
            # An object has no shape, but the names of its variable, system and class.
            _, name, at = self.element(at)
            return _Head(name.decode("latin-1"), _OBJECTS[-1], (), False, False, at)
        _, dims, at = self.element(at)
        _, name, at = self.element(at)
        if len(flags) != 8 or len(dims) % 4 or not 8 <= len(dims) <= 128:
            raise self.cut()
        word = struct.unpack(f"{self.order}II", flags)[0]
        shape = struct.unpack(f"{self.order}{len(dims) // 4}i", dims)
        if min(shape) < 0:
            raise self.cut()
        return _Head(name.decode("latin-1"), word & 0xFF, shape, bool(word & 0x800), bool(word & 0x200), at)

    def numbers(self, at: int, count: int) -> tuple[NDArray[np.generic], int]:
        kind, raw, after = self.element(at)
        if kind not in _NUMBERS or len(raw) != count * np.dtype(_NUMBERS[kind]).itemsize:
            raise self.cut()
        return np.frombuffer(raw, dtype=self.order + _NUMBERS[kind]), after

    def text(self, head: _Head) -> NDArray[np.str_]:
        """Rows of characters, which stand column by column."""
        if head.size == 0:
            return np.array([""])
        kind, raw, _ = self.element(head.at)
        if kind not in _TEXTS:
            raise self.cut()
        coding = _TEXTS[kind] + ("" if kind in (1, 2, 16) else "-le" if self.order == "<" else "-be")
        letters = list(raw.decode(coding, "replace"))
        if len(letters) != head.size:
            raise self.cut()
        table = np.array(letters).reshape(head.shape, order="F").reshape(head.shape[0], -1)
        return np.array(["".join(row) for row in table])


@contextmanager
def open_store(source: Path, *, max_bytes: int = MOST_BYTES) -> Iterator[Store]:
    """The numbers and texts of a MAT file; a variable is read as a whole, when it is asked for.

    Structs are folders: the field `acc` of a struct `data` is "data/acc"; of several, "data(2)/acc".
    """
    variables: dict[str, Variable] = {}
    with source.open("rb") as file:
        order = "<" if file.read(128)[126:128] == b"IM" else ">"
    at, end = 128, source.stat().st_size
    while at < end:
        kind, size = _tag(source, at, order)
        if at + 8 + size > end:
            raise _Bytes(b"", order, str(source)).cut()
        if kind in (_MATRIX, _COMPRESSED):
            for variable in _variables(source, (at + 8, size, kind == _COMPRESSED), order, max_bytes):
                if variable.name in variables:
                    raise InputError("a variable named twice", where=str(source), value=variable.name)
                variables[variable.name] = variable
        at += 8 + size + (0 if kind == _COMPRESSED else -size % 8)
    yield Store(str(source), variables).without_common()


def _tag(source: Path, at: int, order: str) -> tuple[int, int]:
    with source.open("rb") as file:
        file.seek(at)
        raw = file.read(8)
    if len(raw) < 8:
        raise _Bytes(b"", order, str(source)).cut()
    kind, size = struct.unpack(f"{order}II", raw)
    return int(kind), int(size)


def _content(source: Path, place: tuple[int, int, bool], order: str, most: int) -> bytes:
    """The content of a matrix, at most so many bytes of it."""
    at, size, packed = place
    with source.open("rb") as file:
        file.seek(at)
        raw = file.read(size if packed else min(size, most))
    if not packed:
        return raw
    try:
        # The matrix's own tag comes first.
        inner = zlib.decompressobj().decompress(raw, most + 8)
    except zlib.error as error:
        raise _Bytes(b"", order, str(source)).cut() from error
    if len(inner) < 8 or struct.unpack_from(f"{order}I", inner)[0] != _MATRIX:
        raise _Bytes(b"", order, str(source)).cut()
    return inner[8:]


def _variables(source: Path, place: tuple[int, int, bool], order: str, max_bytes: int) -> Iterator[Variable]:
    """The variable at a place; of a struct all of its fields."""
    head = _Bytes(_content(source, place, order, _HEAD_BYTES), order, str(source)).head()
    if not head.name:
        return

    def content() -> bytes:
        # A text in a cell, and a field of a struct, are matrices of their own.
        many = head.kind in (_CELL, _STRUCT)
        most = 2 * max_bytes if head.kind == _STRUCT else (_CELL_BYTES if many else 17) * head.size
        return _content(source, place, order, min(most, 2 * max_bytes) + _HEAD_BYTES)

    yield from _of(head, head.name, content, (order, str(source)), max_bytes, 0)


def _of(
    head: _Head, name: str, content: Callable[[], bytes], about: tuple[str, str], max_bytes: int, depth: int
) -> Iterator[Variable]:
    order, source = about
    where = f"{source}: '{name}'"
    if head.kind in _OBJECTS:
        yield unread(name, OBJECT)
        return
    check_size(head.size, where, max_bytes=max_bytes, item=16 if head.is_complex else 8)
    if head.kind == _SPARSE or head.is_logical or (head.kind == _STRUCT and depth > _DEEPEST):
        return
    if head.kind == _STRUCT:
        check_size(head.size, where, max_bytes=64 * MOST_CHANNELS)
        yield from _fields(_Bytes(content(), order, where), name, about, max_bytes, depth)
        return
    if head.kind not in (_CELL, _CHAR) and not _DOUBLE <= head.kind <= _LAST_NUMBER:
        yield unread(name, f"an array of an unknown class ({head.kind})")
        return

    @cache
    def whole() -> NDArray[np.generic]:
        return _array(_Bytes(content(), order, where))

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        return np.asarray(whole()[slices])

    if head.kind in (_CELL, _CHAR):
        check_size(head.size, where, max_bytes=64 * MOST_CHANNELS)
        try:
            shape = whole().shape
        except _NoTextsError as error:
            yield unread(name, str(error))
            return
        yield Variable(name, shape, "text", read)
        return
    step = float(np.finfo(np.float32 if head.kind == _SINGLE else np.float64).eps)
    whole_numbers = head.kind > _SINGLE
    yield Variable(
        name,
        head.shape,
        "complex" if head.is_complex else "real",
        read,
        step=step,
        ordered=True,
        resolution=1.0 if whole_numbers else 0.0,
    )


def _fields(data: _Bytes, name: str, about: tuple[str, str], max_bytes: int, depth: int) -> Iterator[Variable]:
    """The fields of a struct: a length of names, the names, then a matrix for each, element by element."""
    head = data.head()
    _, raw, at = data.element(head.at)
    _, names, at = data.element(at)
    length = struct.unpack(f"{data.order}i", raw)[0] if len(raw) == 4 else 0
    if length < 1 or len(names) % length:
        raise data.cut()
    fields = [names[i : i + length].split(b"\x00")[0].decode("latin-1") for i in range(0, len(names), length)]
    for index in range(head.size):
        prefix = name if head.size == 1 else f"{name}({index + 1})"
        for field in fields:
            kind, inner, at = data.element(at)
            if kind != _MATRIX:
                raise data.cut()
            if not inner:
                continue
            below = _Bytes(inner, data.order, data.where).head()
            yield from _of(below, f"{prefix}/{field}", lambda inner=inner: inner, about, max_bytes, depth + 1)  # type: ignore[misc]


def _array(data: _Bytes) -> NDArray[np.generic]:
    head = data.head()
    if head.kind == _CHAR:
        return data.text(head)
    if head.kind == _CELL:
        return _cells(data, head)
    real, after = data.numbers(head.at, head.size)
    values = real.astype(np.float64)
    if head.is_complex:
        imaginary, _ = data.numbers(after, head.size)
        return np.asarray(values + 1j * imaginary.astype(np.float64)).reshape(head.shape, order="F")
    return values.reshape(head.shape, order="F")


def _cells(data: _Bytes, head: _Head) -> NDArray[np.str_]:
    """A cell array of texts, one row each."""
    texts, at = [], head.at
    for index in range(head.size):
        kind, raw, at = data.element(at)
        cell = _Bytes(raw, data.order, data.where)
        inner = cell.head() if kind == _MATRIX and raw else None
        if inner is None or inner.kind != _CHAR or (inner.size and inner.shape[0] != 1):
            raise _NoTextsError(
                f"a cell array may hold texts only, element {index + 1} is none: save plain arrays"
            )
        texts.append(str(cell.text(inner)[0]))
    return np.array(texts, dtype=str)
