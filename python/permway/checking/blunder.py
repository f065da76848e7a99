"""Something that was probably written down wrongly, with its remedy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "unreadable",
    "bad channel",
    "factor",
    "quantity",
    "sign",
    "conjugate",
    "exchanged",
    "labels",
    "decibels",
    "angle",
    "noise_floor",
    "tolerance",
    "place",
    "model",
]


@dataclass(frozen=True)
class Blunder:
    """One thing that is probably not as it is stated.

    Attributes
    ----------
    kind : str
        "unreadable": a record that cannot be read or predicted; "bad channel": a channel whose samples are no
        measurement; "factor": one factor on levels; "quantity": a derivative or an integral of what is stated;
        "sign"; "conjugate": phases run backwards; "exchanged": real for imaginary part;
        "labels": two have changed places; "decibels": levels read as
        sizes; "angle": degrees for radians; "noise_floor": none is stated; "tolerance"; "place".
    where : str
        Record, and the sensors or points concerned, as in the campaign file.
    what : str
        In words, with numbers.
    remedy : str
        What to write in the campaign file.
    log_odds : float or None
        Natural logarithm of the odds that it is so and not as stated, by the levels and phases of the records;
        None where it does not rest on them.
    asked : bool
        Whether it is a question: it may be right as it is.
    """

    kind: Kind
    where: str
    what: str
    remedy: str
    log_odds: float | None = None
    asked: bool = False

    @property
    def sentence(self) -> str:
        """All in one line."""
        return f"{self.where}: {self.what}; {self.remedy}"
