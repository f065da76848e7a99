"""The header of a function at nodes (dataset 58 or 58b): what it is of, and where its values are."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.uff import Block, Text, next_block, skip_block

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


@dataclass(frozen=True)
class Function:
    """One dataset 58: what its header says, and where its values are.

    Attributes
    ----------
    function : int
        Type: 1 time, 4 frequency response, 6 coherence, ...
    response, reference : str
        Node and direction, as "11632:+Z".
    label : str
        First identification line.
    kind : int
        Of the values: 2 and 4 real, 5 and 6 complex; single and double precision.
    count : int
        Of the points.
    even : bool
    start, step : float
        Of an even abscissa.
    axis : int
        What the abscissa is: 17 time, 18 frequency.
    unit : str or None
    at : int
        Position of the header's line of the point count, for messages.
    values_at : int
    binary : str or None
        Type of binary values.
    """

    function: int
    response: str
    reference: str
    label: str
    kind: int
    count: int
    even: bool
    start: float
    step: float
    axis: int
    unit: str | None
    at: int
    values_at: int
    binary: str | None

    @property
    def complex(self) -> bool:
        """Whether the values are complex."""
        return self.kind in (5, 6)

    @property
    def fields(self) -> int:
        """Numbers for each point."""
        return (2 if self.complex else 1) + (0 if self.even else 1)


def functions(text: Text) -> Iterator[Function]:
    """The functions of a file, their headers checked against the extent of their values; other datasets are left.

    Raises
    ------
    InputError
        With the line.
    """
    at = 0
    while (block := next_block(text, at)) is not None:
        if block.kind != 58:
            at = skip_block(text, block)
            continue
        function, at = _function(text, block)
        yield function


def _function(text: Text, block: Block) -> tuple[Function, int]:
    """The header of a dataset 58, and the position after the dataset."""
    lines: list[tuple[str, int]] = []
    at = block.body
    for _ in range(_LINES_BEFORE_VALUES):
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
    item = Function(
        function=text.field(dof, dof_at, 0, 5, "type of the function"),
        response=_degree(text, dof, dof_at, 41, 51),
        reference=_degree(text, dof, dof_at, 66, 76),
        label=ids[0].strip(),
        kind=kind,
        count=count,
        even=spacing == 1,
        start=text.real(form, form_at, 30, 13, "first abscissa"),
        step=text.real(form, form_at, 43, 13, "step of the abscissa"),
        axis=text.field(*lines[7], 0, 10, "type of the abscissa"),
        unit=_unit(lines[8][0], lines[9][0]),
        at=form_at,
        values_at=at,
        binary=_binary(text, block, kind),
    )
    if item.even and item.count > 1 and not item.step > 0.0:
        raise text.error("step of the abscissa must be above 0", form_at, value=item.step)
    return item, _end(text, block, item)


def _end(text: Text, block: Block, item: Function) -> int:
    total = item.count * item.fields
    if item.binary is not None:
        text.binary(item.values_at, item.binary, total)
        size = total * np.dtype(item.binary).itemsize
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
    # The dataset's own lines, the closing one left out.
    body = text.data[item.values_at : end].rstrip()
    lines = body.count(b"\n")
    wanted = -(-total // len(WIDTHS[item.kind, item.even]))
    if lines != wanted:
        what = f"{item.count} points announced, which take {wanted} lines, but {lines} are there"
        raise text.error(what, item.at, remedy="the file is cut short or damaged; export it again")
    return end


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


def _degree(text: Text, line: str, at: int, node: int, direction: int) -> str:
    number = text.field(line, at, node, 10, "node")
    way = text.field(line, at, direction, 4, "direction")
    if abs(way) > 6:
        raise text.error("direction must lie between -6 and 6", at, value=way)
    return str(number) if way == 0 else f"{number}:{'+' if way > 0 else '-'}{_AXES[abs(way)]}"


def _unit(numerator: str, denominator: str) -> str | None:
    over, under = clean_unit(numerator[46:66]), clean_unit(denominator[46:66])
    if over is None or under is None:
        return over
    plain = re.fullmatch(r"[A-Za-zµ%]+", over)
    bottom = under if re.fullmatch(r"[A-Za-zµ%]+", under) else f"({under})"
    return f"{over if plain else f'({over})'}/{bottom}"
