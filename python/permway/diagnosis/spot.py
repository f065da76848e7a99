"""A place where a stiffness may be added, and what a free one explains there."""

from __future__ import annotations

from dataclasses import dataclass

from permway.arrays import Complexes, Reals


@dataclass(frozen=True)
class Spot:
    """A place where a stiffness may be added.

    Attributes
    ----------
    kind : "joint" or "body"
    name : str
        Law and station, or body.
    x_m : (float, float)
        From and to.
    joints : tuple of int
        Indices in the table of joints; empty for a body.
    """

    kind: str
    name: str
    x_m: tuple[float, float]
    joints: tuple[int, ...] = ()

    @property
    def label(self) -> str:
        """For people."""
        low, high = self.x_m
        return f"{self.name} at {low:g} m" if low == high else f"{self.name}, {low:g} to {high:g} m"


@dataclass(frozen=True)
class Found:
    """What a free stiffness at a spot explains.

    Attributes
    ----------
    spot : Spot
    gain : float
        Of chi square, recalibration projected out.
    degrees : int
        Numbers that were free.
    frequency_Hz : ndarray, shape (F,)
    stiffness_N_per_m : ndarray of complex128, shape (F,)
        The dZ that explains most.
    sigma_N_per_m : ndarray, shape (F,)
        Standard deviation of its real and of its imaginary part.
    by_band : ndarray, shape (F,)
        Share of each frequency in the gain.
    total : float
        Chi square of which the gain is a part.
    """

    spot: Spot
    gain: float
    degrees: int
    frequency_Hz: Reals
    stiffness_N_per_m: Complexes
    sigma_N_per_m: Reals
    by_band: Reals
    total: float
