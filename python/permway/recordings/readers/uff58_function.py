"""The header of a function at nodes (dataset 58 or 58b): what it is of, and where its values are."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from permway.recordings.readers.uff import Block, Text, next_block, skip_block
from permway.recordings.readers.uff58_units import Axis, System, axis_of, system_of

_AXES = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_LINES_BEFORE_VALUES = 11

# Fields of a line of values, by (ordinate, even): E13.5 in single and E20.12 in double precision, abscissa E13.5.
WIDTHS: dict[tuple[int, bool], tuple[int, ...]] = {
    (2, True): (13,) * 6,
    (4, True): (20,) * 4,
    (5, True): (13,) * 6,
    (6, True): (20,) * 4,
    (2, False): (13,) * 6,
    (4, False): (13, 20, 13, 20),
    (5, False): (13,) * 6,
    (6, False): (13, 20, 20),
}

# (I5, I10, I5, I10, 1X, 10A1, I10, I4, 1X, 10A1, I10, I4); a line that does not keep to it is read by its words.
_BLANKS, _EDGES = (30, 55), (51, 76)
_DEGREES = re.compile(
    r"(?P<response>.*\S)?\s+(?P<node>-?\d+)\s+(?P<way>-?\d)\s+(?P<reference>\S.*?)?\s+"
    r"(?P<other>-?\d+)\s+(?P<other_way>-?\d)\s*"
)


@dataclass(frozen=True)
class End:
    """One end of a function: a node with a direction, and the name of the body or sensor there."""

    entity: str
    node: int
    way: int

    @property
    def degree(self) -> str | None:
        """As "11632:+Z"; None where the node is 0."""
        if self.node == 0:
            return None
        sign = "+" if self.way > 0 else "-"
        return str(self.node) if self.way == 0 else f"{self.node}:{sign}{_AXES[abs(self.way)]}"

    @property
    def label(self) -> str:
        """By node and direction, or the entity's name where the node is 0."""
        return self.degree or (self.entity if self.named else "0" if self.way == 0 else f"0:{self.way:+d}")

    @property
    def named(self) -> bool:
        """Whether there is a name."""
        return self.entity.upper() not in ("", "NONE")


@dataclass(frozen=True)
class Function:
    """One dataset 58: what its header states, and where its values are.

    Attributes
    ----------
    function : int
        Type: 1 time, 4 frequency response, 6 coherence, ...
    number, version : int
        Of the function, as its program counts.
    response, reference : End
    ids : tuple of str
        Identification lines.
    kind : int
        Of the values: 2 and 4 real, 5 and 6 complex; single and double precision.
    count : int
        Of the points.
    even : bool
    start, step : float
        Of an even abscissa, as printed.
    abscissa, ordinate, denominator : Axis
    system : System or None
        Of units, where a dataset 164 stands before.
    at : int
        Position of the header's line of the point count, for messages.
    values_at, end : int
        Where the values begin, and where the dataset ends.
    binary : str or None
        Type of binary values.
    single_abscissa : bool
        Whether an uneven abscissa has single precision beside ordinates of double.
    """

    function: int
    number: int
    version: int
    response: End
    reference: End
    ids: tuple[str, ...]
    kind: int
    count: int
    even: bool
    start: float
    step: float
    abscissa: Axis
    ordinate: Axis
    denominator: Axis
    system: System | None
    at: int
    values_at: int
    end: int
    binary: str | None
    single_abscissa: bool = False

    @property
    def complex(self) -> bool:
        """Whether the values are complex."""
        return self.kind in (5, 6)

    @property
    def fields(self) -> int:
        """Numbers for each point."""
        return (2 if self.complex else 1) + (0 if self.even else 1)

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Of a point of binary values."""
        assert self.binary is not None
        first = [] if self.even else [self.binary[0] + "f4" if self.single_abscissa else self.binary]
        names = [first[0]] if first else []
        return np.dtype(
            [(f"f{i}", kind) for i, kind in enumerate([*names, *[self.binary] * (2 if self.complex else 1)])]
        )


def functions(text: Text) -> Iterator[Function]:
    """The functions of a file, their headers checked against the extent of their values; other datasets are left.

    Raises
    ------
    InputError
        With the line.
    """
    at, system = 0, None
    while (block := next_block(text, at)) is not None:
        if block.kind != 58:
            if block.kind == 164:
                system = system_of(text, block)
            at = skip_block(text, block)
            continue
        function, at = _function(text, block, system)
        yield function


def _function(text: Text, block: Block, system: System | None) -> tuple[Function, int]:
    """The header of a dataset 58, and the position after the dataset."""
    lines: list[tuple[str, int]] = []
    at = block.body
    binary = block.head.ljust(80)[6:7].lower() == "b"
    wanted = _LINES_BEFORE_VALUES
    if binary:
        wanted = max(text.field(block.head.ljust(80), block.head_at, 19, 12, "number of lines"), wanted)
        if wanted > 4 * _LINES_BEFORE_VALUES:
            raise text.error("more lines before binary values than can be", block.head_at, value=wanted)
    for _ in range(wanted):
        line, after = text.line(at)
        lines.append((line, at))
        at = after
    ids, (dof, dof_at), (form, form_at) = [line for line, _ in lines[:5]], lines[5], lines[6]
    kind = text.field(form, form_at, 0, 10, "type of the values")
    count = text.field(form, form_at, 10, 10, "number of points")
    spacing = text.field(form, form_at, 20, 10, "spacing")
    if kind not in (2, 4, 5, 6):
        raise text.error("type of the values must be 2, 4, 5 or 6", form_at, value=kind)
    if spacing not in (0, 1):
        raise text.error("spacing must be 0 or 1", form_at, value=spacing)
    if count < 1:
        raise text.error("number of points must be 1 or more", form_at, value=count)
    response, reference = _ends(text, dof, dof_at)
    item = Function(
        function=text.field(dof, dof_at, 0, 5, "type of the function"),
        number=text.field(dof, dof_at, 5, 10, "number of the function"),
        version=text.field(dof, dof_at, 15, 5, "version of the function"),
        response=response,
        reference=reference,
        ids=tuple(line.strip() for line in ids),
        kind=kind,
        count=count,
        even=spacing == 1,
        start=text.real(form, form_at, 30, 13, "first abscissa"),
        step=text.real(form, form_at, 43, 13, "step of the abscissa"),
        abscissa=axis_of(text, *lines[7]),
        ordinate=axis_of(text, *lines[8]),
        denominator=axis_of(text, *lines[9]),
        system=system,
        at=form_at,
        values_at=at,
        end=at,
        binary=_binary(text, block, kind),
    )
    if item.even and item.count > 1 and not item.step > 0.0:
        raise text.error("step of the abscissa must be above 0", form_at, value=item.step)
    if item.binary is not None:
        size = text.field(block.head.ljust(80), block.head_at, 31, 12, "number of bytes")
        single = replace(item, single_abscissa=True)
        if not item.even and size == single.count * single.dtype.itemsize != item.count * item.dtype.itemsize:
            item = single
    end = _end(text, block, item)
    return replace(item, end=end), end


def _end(text: Text, block: Block, item: Function) -> int:
    total = item.count * item.fields
    if item.binary is not None:
        size = item.count * item.dtype.itemsize
        if size > len(text.data) - item.values_at:
            what = f"{total} values announced, {max(len(text.data) - item.values_at, 0)} bytes left: cut short"
            raise text.error(what, item.values_at, remedy="export it again")
        found = re.compile(rb"(?:\r?\n)? *-1[ \t]*(?:\r?\n|\r|$)").match(
            text.data[item.values_at + size : item.values_at + size + 100]
        )
        if found is None:
            what = f"the dataset does not end after the {item.count} points announced"
            raise text.error(what, item.at, remedy="the file is cut short or damaged; export it again")
        return item.values_at + size + found.end()
    if total > len(text.data) - item.values_at:
        raise text.error(f"{item.count} points announced, more than the file holds", item.at, value=item.count)
    end = skip_block(text, block)
    lines = _lines(text, item, end)
    wanted = -(-total // len(WIDTHS[item.kind, item.even]))
    if (
        lines != wanted
        and text.loose(item.values_at, values_end(text, item, end), item.fields, total, keep=True) is None
    ):
        what = f"{item.count} points announced, which take {wanted} lines, but {lines} are there"
        raise text.error(what, item.at, remedy="the file is cut short or damaged; export it again")
    return end


def values_end(text: Text, item: Function, end: int) -> int:
    """Where the lines of printed values end: before the line that closes the dataset."""
    return item.values_at + max(text.data[item.values_at : end].rstrip().rfind(b"\n"), 0)


def _lines(text: Text, item: Function, end: int) -> int:
    # The dataset's own lines, the closing one left out.
    return text.data[item.values_at : end].rstrip().count(b"\n")


def values_of(text: Text, item: Function, *, keep: bool = False) -> np.ndarray:
    """All numbers of a function as printed, shape (point, field): the abscissa first if it is uneven.

    Parameters
    ----------
    keep : bool
        Keep numbers that are not finite.

    Raises
    ------
    InputError
        With the line of the first that is missing or, unless kept, not finite.
    """
    total = item.count * item.fields
    if item.binary is not None:
        points = np.frombuffer(
            text.data[item.values_at : item.values_at + item.count * item.dtype.itemsize], dtype=item.dtype
        )
        table = np.stack([points[name].astype(np.float64) for name in item.dtype.names or ()], axis=1)
        if not (keep or np.isfinite(table).all()):
            point = int(np.flatnonzero(~np.isfinite(table).all(axis=1))[0])
            what = f"point {point} of {item.response.label} / {item.reference.label} is not a finite number"
            raise text.error(what, item.at, remedy="measure it again")
        return table
    widths = WIDTHS[item.kind, item.even]
    numbers: np.ndarray | None
    if _lines(text, item, item.end) == -(-total // len(widths)):
        numbers, _ = text.numbers(item.values_at, widths, total, keep=keep)
    else:
        numbers = text.loose(item.values_at, values_end(text, item, item.end), item.fields, total, keep=keep)
        if numbers is None:
            raise text.error("holds a number that is not finite", item.at, remedy="measure it again")
    return np.asarray(numbers, dtype=np.float64).reshape(item.count, item.fields)


def _binary(text: Text, block: Block, kind: int) -> str | None:
    head = block.head.ljust(80)
    if head[6:7].lower() != "b":
        return None
    order = text.field(head, block.head_at, 7, 6, "byte order")
    form = text.field(head, block.head_at, 13, 6, "floating-point format")
    if order not in (1, 2) or form != 2:
        raise text.error(
            "binary values must be IEEE 754 with byte order 1 or 2",
            block.head_at,
            value=(order, form),
            remedy="export it in ASCII",
        )
    return ("<" if order == 1 else ">") + ("f4" if kind in (2, 5) else "f8")


def _ends(text: Text, line: str, at: int) -> tuple[End, End]:
    """Response and reference, by columns; by words where a number stands across the edge of its field."""
    line = line.expandtabs().ljust(80)
    cut = any(line[edge].strip() for edge in (*_BLANKS, *_EDGES)) or bool(line[80:].strip())
    if cut:
        found = _DEGREES.fullmatch(line[30:].rstrip())
        if found is None:
            what = "the fields of nodes and directions are not in their columns"
            raise text.error(what, at, value=line.strip(), remedy="they are (1X,10A1,I10,I4) from column 31 on")
        ends = (
            End((found["response"] or "").strip(), int(found["node"]), int(found["way"])),
            End((found["reference"] or "").strip(), int(found["other"]), int(found["other_way"])),
        )
    else:
        ends = _end_of(text, line, at, 31), _end_of(text, line, at, 56)
    for end in ends:
        if abs(end.way) > 6:
            raise text.error("direction must lie between -6 and 6", at, value=end.way)
    return ends


def _end_of(text: Text, line: str, at: int, first: int) -> End:
    return End(
        line[first : first + 10].strip(),
        text.field(line, at, first + 10, 10, "node"),
        text.field(line, at, first + 20, 4, "direction"),
    )
