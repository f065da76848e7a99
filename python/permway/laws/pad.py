"""From the modulus of a material to the stiffness of a pad."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.records import Number

if TYPE_CHECKING:
    from permway.laws import AnyLaw


class Pad(Law):
    """A pad pressed over an area, k = e A E / h (paper, equation (1)).

    Parameters
    ----------
    material : AnyLaw
        Modulus E, Pa.
    area_m2 : float
        Bottom area A as drawn, m2.
    thickness_m : float
        h, m.
    effective_fraction : float
        e, the part of the area that bears; 0.7 is the paper's "reduced by 30 %".
    """

    type: Literal["pad"] = "pad"
    material: AnyLaw
    area_m2: Number = Field(gt=0.0)
    thickness_m: Number = Field(gt=0.0)
    effective_fraction: Number = Field(default=0.7, gt=0.0)

    @property
    def needs_temperature(self) -> bool:
        """Whether the material does."""
        return self.material.needs_temperature

    @property
    def shape_factor_m(self) -> float:
        """Stiffness per modulus, e A / h, m."""
        return self.effective_fraction * self.area_m2 / self.thickness_m

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return self.shape_factor_m * self.material._at(omega, temperature_C)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return self.material._causal_by_structure()

    def _static(self) -> float | None:
        return self.material._static()

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return self.material._reach(temperature_C)

    def _caveats(self) -> tuple[str, ...]:
        return self.material._caveats()
