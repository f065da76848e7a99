"""The tables of the report, as plain data for its template."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from permway.paper.conventions import PAPER, PAPER_FREE_GIRDER, RIGHT
from permway.paper.figures.style import celsius
from permway.paper.reproduce import Reproduction
from permway.paper.tables import FREE, ONE_LAW, Row

QUANTITY = {
    "flexibility_minimum_Hz": "minimum of total flexibility",
    "bridge_peak_Hz": "rail-bridge peak",
    "force": "peak of wheel-rail force",
    "force_peak_Hz": "its peak's frequency",
    "body_bounce": "car body bounce",
    "body_pitch": "car body pitch",
    "wheelset": "peak of wheelset acceleration",
    "wheelset_peak_Hz": "its peak's frequency",
    "rail": "peak of rail acceleration",
    "rail_peak_Hz": "its peak's frequency",
}
UNIT = {"(m/s2)2/Hz": "(m/s²)²/Hz", "(rad/s2)2/Hz": "(rad/s²)²/Hz"}
COLUMNS = (
    (PAPER.name, FREE),
    (PAPER_FREE_GIRDER.name, FREE),
    (PAPER.name, ONE_LAW),
    (PAPER_FREE_GIRDER.name, ONE_LAW),
    (RIGHT.name, ONE_LAW),
)
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MARK = {"holds": "✓", "missed": "✗", "open": "", "shown": ""}


@dataclass(frozen=True)
class Cell:
    """A computed value as text, with its ratio to print, status and the status's mark."""

    value: str
    ratio: str
    status: str
    mark: str


@dataclass(frozen=True)
class Line:
    """One printed number with the bars on it and what is computed for it, by :data:`COLUMNS`.

    `span` is how many lines the quantity goes on for, 0 on all but the first of them.
    """

    quantity: str
    span: int
    unit: str
    temperature: str
    printed: str
    bar_free: str
    bar_one_law: str
    cells: tuple[Cell, ...]


def table(result: Reproduction, name: str) -> list[Line]:
    """All lines of one table of the paper, temperature by temperature within a quantity."""
    rows = [r for r in result.rows if r.table == name]
    found: dict[tuple[str, float | None, int], dict[tuple[str, str], Row]] = {}
    for row in rows:
        at = row.at_Hz if row.quantity.startswith("body") else None
        found.setdefault((row.quantity, at, row.temperature_C), {})[row.convention, row.pad] = row
    order = {quantity: i for i, quantity in enumerate(QUANTITY)}
    keys = sorted(found, key=lambda k: (order[k[0]], k[1] or 0.0, -k[2]))
    spans = Counter(key[:2] for key in keys)
    # Taken out at the first line of a quantity, so that the others find 0.
    return [_line(found[key], spans.pop(key[:2], 0)) for key in keys]


def _line(by_column: dict[tuple[str, str], Row], span: int) -> Line:
    free, one = by_column[COLUMNS[0]], by_column[COLUMNS[2]]
    # Peaks are compared wherever they lie; the body's densities at the printed frequency.
    at = f" at {free.at_Hz:g} Hz" if free.quantity.startswith("body") else ""
    return Line(
        span=span,
        quantity=QUANTITY[free.quantity] + at,
        unit=UNIT.get(free.unit, free.unit),
        temperature=celsius(free.temperature_C),
        printed=number(free.printed),
        bar_free=free.bar,
        bar_one_law=one.bar,
        cells=tuple(_cell(by_column[c]) for c in COLUMNS),
    )


def _cell(row: Row) -> Cell:
    ratio = f"× {row.ratio:.3f}"
    if row.unit == "Hz":
        away = round(row.computed - row.printed)
        ratio = f"{away:+d} Hz" if away else "the same"
    value = f"{row.computed:g}" if row.unit == "Hz" else number(row.computed, whole=True)
    return Cell(value, ratio.replace("-", "−"), row.status, MARK[row.status])


def count(rows: Iterable[Row], status: str) -> int:
    """How many rows have a status."""
    return sum(r.status == status for r in rows)


def number(value: float, *, whole: bool = False) -> str:
    """Four significant digits, thin groups of three, powers of ten below 0.0001 and from a million on.

    Parameters
    ----------
    value : float
    whole : bool
        Whether to keep zeros at the end.
    """
    if value == 0.0:
        return "0"
    if not 1e-4 <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.3e}".split("e")
        text = f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}"
    elif abs(value) >= 1000.0:
        text = f"{value:,.0f}".replace(",", "\u202f")
    else:
        text = f"{value:#.4g}" if whole else f"{value:.4g}"
    return text.replace("-", "−")
