"""What may have been done to records on their way into the campaign: one change of what was read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from permway.checking.blunder import Kind

Reading = Literal["", "decibels", "radians"]
"""How numbers are taken otherwise than as they are: sizes as levels, degrees as radians."""


@dataclass(frozen=True)
class Ratio:
    """A factor on what was read that would put it right: `size` (i omega)^`order`.

    Attributes
    ----------
    size : float
        Its sign counts.
    order : int
        1 where an integral was taken for its derivative.
    """

    size: float = 1.0
    order: int = 0


@dataclass(frozen=True)
class Change:
    """One way in which a record may not be what it is stated to be.

    Attributes
    ----------
    kind : str
        As of :class:`permway.checking.blunder.Blunder`.
    log_prior : float
        Of the change over no change.
    ratios : mapping of (int, Ratio)
        By row of :class:`permway.checking.compared.Compared`: channels, then points.
    exchanged : tuple of int
        Rows of channels whose real and imaginary parts change places.
    conjugate : bool
        Whether phases are reversed.
    swapped : (int, int), optional
        Rows that change places.
    reading : str
    reference : float
        Of decibels.
    whole : bool
        Whether the change is of the whole record.
    """

    kind: Kind
    log_prior: float
    ratios: Mapping[int, Ratio] = field(default_factory=dict)
    exchanged: tuple[int, ...] = ()
    conjugate: bool = False
    swapped: tuple[int, int] | None = None
    reading: Reading = ""
    reference: float = 1.0
    whole: bool = False
