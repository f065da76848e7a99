"""A place of the line at which an effect may be looked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Location:
    """A place at which an effect may be looked for.

    Attributes
    ----------
    kind : "joint" or "body"
    name : str
        Law of the joint, or segment of the body.
    x_m : float
    """

    kind: Literal["joint", "body"]
    name: str
    x_m: float
