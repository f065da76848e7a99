"""The contact of wheel and rail as a spring, linearised about the static load."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal

from pydantic import Field, PositiveFloat

from permway.errors import InputError
from permway.records import FrozenModel

_CONTACT_CONSTANT: dict[str, tuple[float, float]] = {"conical": (4.57e-8, -0.149), "worn": (3.86e-8, -0.115)}
"""G = g R^e in m/N^(2/3) by wheel profile: (g, e), R in m."""


class _Contact(FrozenModel, ABC):
    """A linear contact spring."""

    @abstractmethod
    def wheel_stiffness(self) -> float:
        """Stiffness of one wheel on one rail, N/m."""

    def wheelset_stiffness(self, share: float = 1.0) -> float:
        """Stiffness under one wheelset of a model.

        Parameters
        ----------
        share : float
            Share of the vehicle in the model: 1 (both rails, two wheels side by side) or 0.5 (half model, one
            wheel).

        Returns
        -------
        float
            N/m.

        Raises
        ------
        InputError
            For a share that is not above 0 and at most 1.
        """
        if not 0.0 < share <= 1.0:
            raise InputError(
                "a share must be above 0 and at most 1",
                where="share",
                value=share,
                remedy="1 for the whole vehicle, 0.5 for the half model",
            )
        return 2.0 * share * self.wheel_stiffness()

    def receptance(self, share: float = 1.0) -> float:
        """Flexibility 1/k_c under one wheelset of a model, m/N (paper, equation (17)).

        Parameters and errors as :meth:`wheelset_stiffness`.
        """
        return 1.0 / self.wheelset_stiffness(share)


class GivenContact(_Contact):
    """A contact stiffness that is known.

    Parameters
    ----------
    stiffness_N_per_m : float
        Of one wheel on one rail, N/m.
    """

    type: Literal["given"] = "given"
    stiffness_N_per_m: PositiveFloat

    def wheel_stiffness(self) -> float:
        """Stiffness of one wheel on one rail, N/m."""
        return self.stiffness_N_per_m


class HertzContact(_Contact):
    """Hertz's contact, load = (approach / G)^(3/2), linearised about the static load.

    k_c = (3/2) P0^(1/3) / G with G = 4.57e-8 R^-0.149 (conical tread) or 3.86e-8 R^-0.115 m/N^(2/3) (worn
    tread), R the wheel's radius in m (Zhai, Wang and Cai, Vehicle System Dynamics 47 (2009) 1349-1376).

    Parameters
    ----------
    static_load_N : float
        Static load P0 of one wheel, N: an eighth of the car's weight.
    wheel_radius_m : float
        Rolling radius, m.
    profile : {"worn", "conical"}
        Tread.
    """

    type: Literal["hertz"] = "hertz"
    static_load_N: PositiveFloat
    wheel_radius_m: float = Field(default=0.43, gt=0.1, lt=1.5)
    profile: Literal["worn", "conical"] = "worn"

    @property
    def contact_constant(self) -> float:
        """G, m/N^(2/3)."""
        factor, exponent = _CONTACT_CONSTANT[self.profile]
        return float(factor * self.wheel_radius_m**exponent)

    def wheel_stiffness(self) -> float:
        """Stiffness of one wheel on one rail, N/m."""
        return float(1.5 * self.static_load_N ** (1.0 / 3.0) / self.contact_constant)


ContactStiffness = Annotated[GivenContact | HertzContact, Field(discriminator="type")]
"""Either contact, chosen by its `type`."""
