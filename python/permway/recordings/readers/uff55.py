"""Data at nodes (dataset 55): mode shapes, and responses at one frequency after another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from permway.arrays import Complexes
from permway.errors import InputError
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.uff import Block, Text, next_block, open_text, skip_block
from permway.recordings.record import Cells, FrfRecord, TableRecord

NORMAL_MODE, COMPLEX_FIRST, FREQUENCY_RESPONSE, COMPLEX_SECOND = 2, 3, 5, 7
_AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
_WIDTHS = (13,) * 6


@dataclass(frozen=True)
class Shape:
    """One dataset 55.

    Attributes
    ----------
    analysis : int
        2 normal mode, 3 and 7 complex mode, 5 frequency response.
    number : int
        Of the mode or the frequency step.
    frequency_Hz, damping : float
        Damping ratio; 0 where the dataset has none.
    nodes : tuple of int
    values : ndarray of complex128, shape (node, axis)
    complex : bool
    at : int
        Position of its header, for messages.
    """

    analysis: int
    number: int
    frequency_Hz: float
    damping: float
    nodes: tuple[int, ...]
    values: Complexes
    complex: bool
    at: int


def read_shapes(source: Path, *, max_bytes: int = MOST_BYTES) -> TableRecord:
    """Read the mode shapes and responses of a universal file as a table, a row for every node of every dataset.

    Columns: number, frequency (Hz), damping (ratio), node, and for each axis its value; of complex data the real
    and the imaginary part, as "Z real" and "Z imag".
    """
    shapes = _shapes(source, max_bytes)
    axes = {shape.values.shape[1] for shape in shapes}
    if len(axes) > 1:
        what = "datasets of several numbers of axes in one file"
        raise InputError(what, where=str(source), value=sorted(axes), remedy="put them into files apart")
    counts = [len(shape.nodes) for shape in shapes]
    columns: dict[str, Cells] = {
        "number": np.repeat(np.array([float(shape.number) for shape in shapes]), counts),
        "frequency": np.repeat(np.array([shape.frequency_Hz for shape in shapes]), counts),
        "damping": np.repeat(np.array([shape.damping for shape in shapes]), counts),
        "node": np.array([float(node) for shape in shapes for node in shape.nodes]),
    }
    values = np.concatenate([shape.values for shape in shapes])
    for axis in range(values.shape[1]):
        if any(shape.complex for shape in shapes):
            columns[f"{_AXES[axis]} real"] = np.ascontiguousarray(values[:, axis].real)
            columns[f"{_AXES[axis]} imag"] = np.ascontiguousarray(values[:, axis].imag)
        else:
            columns[_AXES[axis]] = np.ascontiguousarray(values[:, axis].real)
    units: dict[str, str | None] = dict.fromkeys(columns)
    units["frequency"] = "Hz"
    return TableRecord(columns=columns, units=units, source=str(source))


def read_frf(source: Path, *, max_bytes: int = MOST_BYTES) -> FrfRecord:
    """Read responses at one frequency after another (analysis type 5) as frequency responses.

    The dataset does not say what they refer to: the reference is "0".
    """
    shapes = [shape for shape in _shapes(source, max_bytes) if shape.analysis == FREQUENCY_RESPONSE]
    if not shapes:
        what = "holds no frequency response (dataset 55 of analysis type 5)"
        raise InputError(what, where=str(source), remedy="mode shapes are a table: use read_table")
    real = next((shape for shape in shapes if not shape.complex), None)
    if real is not None:
        what = "the responses are of real numbers: magnitudes without a phase"
        raise InputError(what, where=f"{source}: frequency step {real.number}", remedy="export them as complex")
    shapes.sort(key=lambda shape: shape.frequency_Hz)
    first = shapes[0]
    for shape in shapes[1:]:
        if shape.nodes != first.nodes or shape.values.shape != first.values.shape:
            where = f"{source}: frequency step {shape.number}"
            what = f"has other nodes than step {first.number}"
            raise InputError(what, where=where, remedy="give all nodes at each frequency")
    axes = range(first.values.shape[1])
    labels = tuple(f"{node}:+{_AXES[axis]}" for node in first.nodes for axis in axes)
    return FrfRecord(
        responses=labels,
        references=("0",) * len(labels),
        frequency_Hz=np.array([shape.frequency_Hz for shape in shapes]),
        values=np.stack([shape.values.reshape(-1) for shape in shapes], axis=1),
        source=str(source),
    )


def _shapes(source: Path, max_bytes: int) -> list[Shape]:
    # A value takes 13 characters in the file and 16 bytes here.
    check_size(source.stat().st_size // 13, str(source), max_bytes=max_bytes, item=32)
    with open_text(source) as text:
        shapes = list(_each(text))
    if not shapes:
        raise InputError("holds no data at nodes (dataset 55)", where=str(source), remedy="see what was exported")
    return shapes


def _each(text: Text) -> Iterator[Shape]:
    at = 0
    while (block := next_block(text, at)) is not None:
        if block.kind == 55:
            shape, at = _shape(text, block)
            yield shape
        else:
            at = skip_block(text, block)


def _shape(text: Text, block: Block) -> tuple[Shape, int]:
    at = block.body
    for _ in range(5):
        _, at = text.line(at)
    here = at
    line, at = text.line(at)
    analysis = text.field(line, here, 10, 10, "analysis type")
    kind = text.field(line, here, 40, 10, "type of the values")
    axes = text.field(line, here, 50, 10, "values for each node")
    if analysis not in (NORMAL_MODE, COMPLEX_FIRST, FREQUENCY_RESPONSE, COMPLEX_SECOND):
        remedy = "export normal modes (2), complex modes (3, 7) or frequency responses (5)"
        raise text.error("data at nodes of an analysis that is not read", here, value=analysis, remedy=remedy)
    if kind not in (2, 5) or axes not in (1, 2, 3, 6):
        what = "values must be real (2) or complex (5), and 1, 2, 3 or 6 for each node"
        raise text.error(what, here, value=(kind, axes))
    number_at = at
    line, at = text.line(at)
    integers = text.field(line, number_at, 0, 10, "number of integers")
    reals = text.field(line, number_at, 10, 10, "number of reals")
    number = text.field(line, number_at, 30, 10, "number of the mode or step")
    if not (2 <= integers <= 6 and 1 <= reals <= 12):
        what = "the analysis' numbers must be 2 to 6 integers and 1 to 12 reals"
        raise text.error(what, number_at, value=(integers, reals))
    numbers, values_at = text.numbers(at, _WIDTHS, reals)
    frequency, damping = _frequency(analysis, [float(x) for x in numbers])
    nodes, values, end = _nodes(text, block, values_at, axes, kind == 5)
    return Shape(analysis, number, frequency, damping, tuple(nodes), values, kind == 5, here), end


def _frequency(analysis: int, numbers: list[float]) -> tuple[float, float]:
    """Frequency in Hz and damping ratio, from an eigenvalue in rad/s where the dataset gives that."""
    if analysis in (COMPLEX_FIRST, COMPLEX_SECOND) and len(numbers) > 1:
        size = float(np.hypot(numbers[0], numbers[1]))
        return size / (2.0 * np.pi), (-numbers[0] / size if size else 0.0)
    return numbers[0], numbers[2] if analysis == NORMAL_MODE and len(numbers) > 2 else 0.0


def _nodes(text: Text, block: Block, at: int, axes: int, is_complex: bool) -> tuple[list[int], Complexes, int]:
    nodes: list[int] = []
    rows: list[list[complex]] = []
    while (after := text.fence(at)) is None:
        here = at
        line, at = text.line(at)
        node = text.field(line, here, 0, 10, "node")
        if line[10:].strip():
            what = "more than a node's number in its line, or one of more than ten columns"
            raise text.error(what, here, value=line.strip(), remedy="the number ends in column 10 at the latest")
        if not line.strip() or node in nodes[-1:]:
            raise text.error("a line with a node's number is missing", here, value=line)
        numbers, at = text.numbers(at, _WIDTHS, axes * (2 if is_complex else 1))
        nodes.append(node)
        rows.append(
            [complex(a, b) for a, b in numbers.reshape(-1, 2)] if is_complex else [complex(x) for x in numbers]
        )
    if not nodes:
        raise text.error("a dataset without nodes", block.head_at)
    if len(set(nodes)) < len(nodes):
        twice = next(node for i, node in enumerate(nodes) if node in nodes[:i])
        raise text.error("a node stands twice", block.head_at, value=twice)
    return nodes, np.array(rows), after
