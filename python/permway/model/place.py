"""A place on a body, where a force acts or a sensor reads."""

from __future__ import annotations

from permway.model.bodies import Metres
from permway.records import FrozenModel


class Place(FrozenModel):
    """A place on a body, of a unit force or of a sensor.

    Parameters
    ----------
    body : str
        Name of the body; "girder[2]" for the second of a row.
    x_m : float
        Place along the line.
    name : str, optional
        Label in the dataset; by default "body@x".
    """

    body: str
    x_m: Metres
    name: str | None = None

    @property
    def label(self) -> str:
        """The name, or body and place, which differs where places do."""
        return self.name or f"{self.body}@{self.x_m:.12g}"
