"""Irregularity: the closed-form spectra, and every spectrum a model file can name.

The conversion from wavenumber to hertz is :meth:`Irregularity.density`; the paper's missing one is there
under a name that says so.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat, model_validator

from permway.arrays import Reals
from permway.model.irregularity_spectra import (
    EDGE,
    Conversion,
    Irregularity,
    RangeWarning,
    check_speed,
)
from permway.model.recorded_irregularity import CycleTable, En13848
from permway.model.roughness import DensityTable, Iso3095, RoughnessTable

__all__ = [
    "AnyIrregularity",
    "ChineseBallastless",
    "Conversion",
    "CycleTable",
    "DensityTable",
    "En13848",
    "Fra",
    "GermanHigh",
    "GermanLow",
    "GermanSato",
    "Irregularity",
    "Iso3095",
    "RangeWarning",
    "RoughnessTable",
    "Sato",
    "check_speed",
]

GermanForm = Literal["right", "paper_eq28"]

_GERMAN_C = 0.8246
_GERMAN_R = 0.0206
_PAPER_S = 0.4380

CHINESE_SEGMENTS: tuple[tuple[float, float], ...] = (
    (1.0544e-5, 3.3891),
    (3.5588e-3, 1.9271),
    (1.9784e-2, 1.3643),
    (3.9488e-4, 3.4516),
)
"""(A, k) of S = A / f^k, mm^2/(1/m), f in 1/m, from the longest waves to the shortest."""

CHINESE_LIMITS_PER_M: tuple[float, ...] = (0.0187, 0.0474, 0.1533)
"""Spatial frequencies (1/m) where one segment hands over to the next: 53.5, 21.1 and 6.5 m."""

FRA_AMPLITUDE_CM2_RAD_PER_M: dict[int, float] = {
    1: 1.2107,
    2: 1.0181,
    3: 0.6816,
    4: 0.5376,
    5: 0.2095,
    6: 0.0339,
}
"""A_v of the vertical profile by class of track, cm^2 rad/m; 1 is the worst, 6 the best."""

FRA_WAVENUMBER_C = 0.8245
FRA_K = 0.25


class _German(Irregularity):
    """Vertical profile of the German spectra.

    The right form is S = A w_c^2 / ((W^2 + w_r^2)(W^2 + w_c^2)), m^2/(rad/m), with w_c = 0.8246 and
    w_r = 0.0206 rad/m. The paper prints w_s in place of the second w_c (equation (28)); the published
    spectra use w_s in the cross level only.
    """

    form: GermanForm = "right"
    w_s_rad_per_m: PositiveFloat | None = None

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """1 to 100 m (paper, section 4.1)."""
        return 1.0, 100.0

    @model_validator(mode="after")
    def _check_form(self) -> _German:
        if self.form == "right" and self.w_s_rad_per_m is not None:
            raise ValueError(
                "w_s_rad_per_m has no place in the right form; leave it out or say form = 'paper_eq28'"
            )
        if self.form == "paper_eq28" and self._second_corner() is None:
            raise ValueError(
                "form 'paper_eq28' is printed for the low disturbance only; use form = 'right' "
                "or give w_s_rad_per_m"
            )
        return self

    @abstractmethod
    def _amplitude(self) -> float:
        """A_v, m rad."""

    def _second_corner(self) -> float | None:
        return _GERMAN_C if self.form == "right" else self.w_s_rad_per_m

    def _density(self, wavenumber: Reals) -> Reals:
        corner = self._second_corner()
        assert corner is not None
        return _german_density(wavenumber, self._amplitude(), corner)


class GermanLow(_German):
    """German spectrum of low disturbance, vertical: A = 4.032e-7 m rad.

    One-sided as used by the paper and here; the source does not say. Wavelengths 1 to 100 m (paper; Guo et
    al., Computers & Structures 112-113 (2012) 205-216, take 3 to 150 m).

    Parameters
    ----------
    form : {"right", "paper_eq28"}
        "paper_eq28": w_s = 0.4380 rad/m in place of w_c in the denominator, as printed.
    w_s_rad_per_m : float, optional
        Another w_s for "paper_eq28".
    """

    type: Literal["german_low"] = "german_low"

    def _amplitude(self) -> float:
        return 4.032e-7

    def _second_corner(self) -> float | None:
        if self.form == "paper_eq28":
            return self.w_s_rad_per_m or _PAPER_S
        return _GERMAN_C


class GermanHigh(_German):
    """German spectrum of high disturbance, vertical: A = 1.080e-6 m rad. See :class:`GermanLow`.

    Parameters
    ----------
    form : {"right", "paper_eq28"}
        The paper prints its equation (28) for low disturbance only: with "paper_eq28" give `w_s_rad_per_m`.
    """

    type: Literal["german_high"] = "german_high"

    def _amplitude(self) -> float:
        return 1.080e-6


class Sato(Irregularity):
    """Sato's short-wave spectrum, S = A / W^n, m^2/(rad/m), W in rad/m (paper, equation (29)).

    The paper prints A / W^(-n) and A = 0.065 without a unit. The exponent's sign is a mistake, and A is in
    mm^2 (rad/m)^(n-1): 6.5e-8 in metres meets the German spectrum at 1 m within a factor of 1.35, 0.065
    in metres would lie six orders above it. One-sided as used; the source does not say. Wavelengths 0.01
    to 1 m.

    Parameters
    ----------
    amplitude : float
        A, m^2 (rad/m)^(n-1).
    exponent : float
        n.
    """

    type: Literal["sato"] = "sato"
    amplitude: PositiveFloat = 6.5e-8
    exponent: PositiveFloat = 3.06

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """0.01 to 1 m: the paper takes it below 1 m; under 1 cm the contact patch filters."""
        return 0.01, 1.0

    def _density(self, wavenumber: Reals) -> Reals:
        return self.amplitude * wavenumber**-self.exponent


class GermanSato(Irregularity):
    """The paper's composite: German low disturbance for long waves, Sato for short ones.

    The jump at the crossover is the paper's; at 350 km/h a crossover of 1 m lies at 97.2 Hz.

    Parameters
    ----------
    form : {"right", "paper_eq28"}
        Form of the German part, see :class:`GermanLow`. The paper's tables need "paper_eq28".
    crossover_wavelength_m : float
        German from this wavelength up, Sato below.
    continuous : bool
        Scale Sato's part so that the two meet at the crossover.
    amplitude, exponent : float
        Sato's, see :class:`Sato`.
    """

    type: Literal["german_sato"] = "german_sato"
    form: GermanForm = "right"
    crossover_wavelength_m: float = Field(default=1.0, gt=0.01, lt=100.0)
    continuous: bool = False
    amplitude: PositiveFloat = 6.5e-8
    exponent: PositiveFloat = 3.06

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """0.01 to 100 m."""
        return 0.01, 100.0

    def _density(self, wavenumber: Reals) -> Reals:
        german = GermanLow(form=self.form)
        sato = Sato(amplitude=self.amplitude, exponent=self.exponent)
        crossover = np.array(2.0 * np.pi / self.crossover_wavelength_m)
        short = sato._density(wavenumber)
        if self.continuous:
            short = short * (german._density(crossover) / sato._density(crossover))
        return np.where(wavenumber > crossover * (1.0 + EDGE), short, german._density(wavenumber))


class ChineseBallastless(Irregularity):
    """Mean spectrum of Chinese ballastless high-speed track, vertical profile (TB/T 3352-2014).

    S = A / f^k in mm^2/(1/m), f in 1/m, in four segments; converted here by f = W / (2 pi) and
    S_W = S_f / (2 pi). One-sided. Wavelengths 2 to 200 m. Coefficients as quoted from the standard in the
    literature (Kang et al., 2014), not compared with the standard's own print; the segments meet within 0.5 %
    at the printed limits, which is tested.
    """

    type: Literal["chinese_ballastless"] = "chinese_ballastless"

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """2 to 200 m."""
        return 2.0, 200.0

    def _density(self, wavenumber: Reals) -> Reals:
        cycles = wavenumber / (2.0 * np.pi)
        amplitude, exponent = np.array(CHINESE_SEGMENTS).T
        segment = np.searchsorted(CHINESE_LIMITS_PER_M, cycles, side="right")
        return np.asarray(1e-6 * amplitude[segment] * cycles ** -exponent[segment] / (2.0 * np.pi))


class Fra(Irregularity):
    """Spectrum of the Federal Railroad Administration, vertical profile, classes 1 (worst) to 6 (best).

    S = k A_v w_c^2 / ((W^2 + w_c^2) W^2) with k = 0.25, w_c = 0.8245 rad/m and A_v in cm^2 rad/m, given here
    in m^2/(rad/m). One-sided as used; the source does not say. Wavelengths 1.524 to 304.8 m (5 to 1000 ft).
    A second family of that name, with two corners (Fryba, Dynamics of Railway Bridges, 1996), lies an order
    of magnitude lower for waves under 40 m: the two do not stand for each other.

    Parameters
    ----------
    track_class : int
        1 to 6.
    """

    type: Literal["fra"] = "fra"
    track_class: int = Field(ge=1, le=6)

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """1.524 to 304.8 m."""
        return 1.524, 304.8

    def _density(self, wavenumber: Reals) -> Reals:
        amplitude = 1e-4 * FRA_AMPLITUDE_CM2_RAD_PER_M[self.track_class]
        square = wavenumber**2
        return np.asarray(FRA_K * amplitude * FRA_WAVENUMBER_C**2 / ((square + FRA_WAVENUMBER_C**2) * square))


def _german_density(wavenumber: Reals, amplitude: float, second_corner: float) -> Reals:
    """A w_c^2 / ((W^2 + w_r^2)(W^2 + w^2)), m^2/(rad/m), with w the second corner in rad/m."""
    square = wavenumber**2
    below = (square + _GERMAN_R**2) * (square + second_corner**2)
    return np.asarray(amplitude * _GERMAN_C**2 / below)


AnyIrregularity = Annotated[
    GermanLow
    | GermanHigh
    | Sato
    | GermanSato
    | ChineseBallastless
    | Fra
    | Iso3095
    | RoughnessTable
    | DensityTable
    | CycleTable
    | En13848,
    Field(discriminator="type"),
]
"""Any irregularity a model file can name, chosen by its `type`."""
