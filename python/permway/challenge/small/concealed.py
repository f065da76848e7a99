"""A concealed effect of any size between nothing and its largest, and what a truth states about it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Concealed:
    """One effect, scaled by a share: 1 is the largest size that was drawn, towards 0 there is nothing.

    Attributes
    ----------
    id : str or None
        Its entry in the catalogue; None for what is in no catalogue.
    kind, family, domain : str
    change : callable
        From a maker's line or campaign, and a share, to the changed one.
    parameters : callable
        From a share to parameters as the catalogue counts them.
    place : callable
        From a share to `body` or `joint`, `x_m` and `channels`.
    scales : bool
        Whether it can be as weak as one likes.
    words : tuple of str
        Of an effect of no catalogue: words of which a right description uses one.
    mechanical : str
    noise : callable, optional
        From a share to factors on the noise's power, by sensor.
    """

    id: str | None
    kind: str
    family: str
    domain: str
    change: Callable[[Any, float], Any]
    parameters: Callable[[float], Mapping[str, float]]
    place: Callable[[float], Mapping[str, Any]]
    scales: bool = True
    words: tuple[str, ...] = ()
    mechanical: str = ""
    noise: Callable[[float], Mapping[str, float]] = field(default=lambda _: {})

    def truth(self, share: float) -> dict[str, Any]:
        """Its entry in a truth file."""
        return {
            "id": self.id,
            "kind": self.kind,
            "family": self.family,
            "domain": self.domain,
            "place": dict(self.place(share)),
            "parameters": {name: float(value) for name, value in self.parameters(share).items()},
            "mechanical": self.mechanical,
            "words": list(self.words),
        }


def displaced(value: float, none: float, share: float) -> float:
    """A size moved towards the value at which there is nothing.

    Parameters
    ----------
    value, none : float
        At the largest, and where there is no effect; infinity goes by its inverse.
    share : float
        Above 0, at most 1: of the logarithm for two positive values, else of the difference.
    """
    if none == float("inf"):
        return value / share
    if none > 0.0 and value > 0.0:
        return float(none * (value / none) ** share)
    return none + (value - none) * share
