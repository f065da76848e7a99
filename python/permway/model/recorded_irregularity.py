"""Irregularities as track recording cars report them: density over cycles per metre, deviations D1 to D3."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat, model_validator

from permway.arrays import Reals
from permway.model.faults import fault
from permway.model.roughness import Tabulated, check_columns
from permway.model.track_quality import BANDS_M
from permway.records import FloatTuple

_HIGHEST_MM = 50.0
"""A standard deviation above this is in another unit: single peaks of some 30 mm in D1 close a line (EN 13848-5).
Half would refuse long waves of poor track, twice would let micrometres of a good one pass."""


class CycleTable(Tabulated):
    """A table of one-sided density over spatial frequency, straight lines between its points in log-log.

    Parameters
    ----------
    cycles_per_m : sequence of float
        One over wavelength, 1/m, ascending.
    density_mm2_m : sequence of float
        One-sided, mm2/(1/m), above zero: its integral over cycles per metre is the variance in mm2.
    """

    type: Literal["table_per_cycle"] = "table_per_cycle"
    cycles_per_m: FloatTuple
    density_mm2_m: FloatTuple

    @model_validator(mode="after")
    def _check_table(self) -> CycleTable:
        check_columns("cycles_per_m", self.cycles_per_m, "density_mm2_m", self.density_mm2_m)
        for index, value in enumerate(self.density_mm2_m):
            if value <= 0.0:
                raise fault(f"{value:g} must be above zero (log-log table)", "density_mm2_m", index)
        for index, (before, after) in enumerate(zip(self.cycles_per_m, self.cycles_per_m[1:], strict=False)):
            if after <= before:
                what = f"{after:g} does not exceed the {before:g} before it: sort by ascending spatial frequency"
                raise fault(what, "cycles_per_m", index + 1)
        return self

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """The table's own ends."""
        return 1.0 / self.cycles_per_m[-1], 1.0 / self.cycles_per_m[0]

    def _density(self, wavenumber: Reals) -> Reals:
        # S(W) dW = S_n(n) dn with W = 2 pi n; mm2 m is 1e-6 m3.
        at = np.interp(np.log(wavenumber / (2.0 * np.pi)), np.log(self.cycles_per_m), np.log(self.density_mm2_m))
        return np.asarray(np.exp(at) * 1e-6 / (2.0 * np.pi))


class En13848(Tabulated):
    """The longitudinal level by its standard deviations in the bands of EN 13848-1.

    A standard deviation states how much there is in a band, not how it is spread: within each band the density is
    taken as a power of the wavenumber, and it may step where two bands meet.

    Parameters
    ----------
    D1_mm, D2_mm, D3_mm : float
        Standard deviations of the waves of 3 to 25, 25 to 70 and 70 to 150 m, mm. D2 and D3 may be left out; the
        irregularity then ends at 25 or 70 m.
    exponent : float
        The density goes as wavenumber to minus this, 0 to 6. Tracks have 2 to 4.
    """

    type: Literal["en13848"] = "en13848"
    D1_mm: PositiveFloat
    D2_mm: PositiveFloat | None = None
    D3_mm: PositiveFloat | None = None
    exponent: float = Field(default=3.0, ge=0.0, le=6.0)

    @model_validator(mode="after")
    def _check_bands(self) -> En13848:
        if self.D3_mm is not None and self.D2_mm is None:
            raise fault("D3_mm without D2_mm leaves a gap between 25 and 70 m", "D2_mm")
        for name in BANDS_M:
            value = getattr(self, f"{name}_mm")
            if value is not None and value > _HIGHEST_MM:
                raise fault(f"{value:g} mm is no standard deviation of a track: give it in mm", f"{name}_mm")
        return self

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """From 3 m to the end of the longest band that is given."""
        given = [reach for name, reach in BANDS_M.items() if getattr(self, f"{name}_mm") is not None]
        return given[0][0], given[-1][1]

    def _density(self, wavenumber: Reals) -> Reals:
        density = np.zeros_like(wavenumber)
        # From the longest waves on, so that a wave on an edge belongs to the shorter band, as in the standard.
        for name, (short, long) in reversed(BANDS_M.items()):
            deviation = getattr(self, f"{name}_mm")
            if deviation is None:
                continue
            low, high = 2.0 * np.pi / long, 2.0 * np.pi / short
            reached = wavenumber >= low * (1.0 - 1e-9)
            spread = _power_integral(low, high, self.exponent)
            density[reached] = (1e-3 * deviation) ** 2 / spread * wavenumber[reached] ** -self.exponent
        return density


def _power_integral(low: float, high: float, exponent: float) -> float:
    """Integral of W^-exponent from low to high."""
    if abs(exponent - 1.0) < 1e-9:
        return math.log(high / low)
    return float((high ** (1.0 - exponent) - low ** (1.0 - exponent)) / (1.0 - exponent))
