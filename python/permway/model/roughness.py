"""Roughness in one-third octaves of wavelength, and tables of density."""

from __future__ import annotations

from abc import abstractmethod
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.irregularity_spectra import Irregularity
from permway.records import FloatTuple

Interpolation = Literal["bands", "smooth"]

_HALF_BAND = 10.0**0.05
"""Half a base-ten one-third octave: from a band's centre to its edge."""

_NOMINAL_SLACK = 0.03
"""How far a nominal wavelength may lie from 10^(n/10) m; 0.315, 0.63 and 0.125 need 0.6 %."""

ISO3095_LIMIT_DB: tuple[tuple[float, float], ...] = (
    (0.4, 17.1),
    (0.315, 15.0),
    (0.25, 13.0),
    (0.2, 11.0),
    (0.16, 9.0),
    (0.125, 7.0),
    (0.1, 4.9),
    (0.08, 2.9),
    (0.063, 0.9),
    (0.05, -1.1),
    (0.04, -3.2),
    (0.0315, -5.0),
    (0.025, -5.6),
    (0.02, -6.2),
    (0.016, -6.8),
    (0.0125, -7.4),
    (0.01, -8.0),
    (0.008, -8.6),
    (0.0063, -9.2),
    (0.005, -9.8),
    (0.004, -10.4),
    (0.00315, -11.0),
)
"""ISO 3095:2013, 6.2.5 and Figure 2: upper limit of rail roughness, (wavelength m, level dB re 1 um)."""


class Tabulated(Irregularity):
    """A spectrum that exists at its table only: outside it there is nothing to give, and it says so."""

    def _meet_outside(self, wavenumber: Reals, outside: NDArray[np.bool_]) -> None:
        shortest, longest = self.valid_wavelength_m
        first = float(wavenumber[outside].flat[0])
        raise InputError(
            f"the table covers wavelengths from {shortest:.4g} to {longest:.4g} m and is not extrapolated",
            where="wavenumber_rad_per_m",
            value=f"{first:.6g} rad/m, a wavelength of {2.0 * np.pi / first:.4g} m",
            remedy="ask within the table (frequency = speed / wavelength), or extend it",
        )


class _OneThirdOctaves(Tabulated):
    """Levels per one-third octave of wavelength, read as density: mean square over the band's width."""

    interpolation: Interpolation = "bands"

    @abstractmethod
    def _levels(self) -> tuple[Reals, Reals]:
        """Wavelengths (m, nominal) and levels (dB re 1 um)."""

    def _bands(self) -> tuple[NDArray[np.int64], Reals]:
        """Band numbers n (wavelength 10^(n/10) m), ascending, and densities in m^2/(rad/m)."""
        wavelength, level = self._levels()
        number = _band_number(wavelength)
        order = np.argsort(number)
        number, level = number[order], level[order]
        centre = 2.0 * np.pi / 10.0 ** (number / 10.0)
        width = centre * (_HALF_BAND - 1.0 / _HALF_BAND)
        return number, 1e-12 * 10.0 ** (level / 10.0) / width

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """From the edge of the shortest band to the edge of the longest."""
        number, _ = self._bands()
        return float(10.0 ** ((number[0] - 0.5) / 10.0)), float(10.0 ** ((number[-1] + 0.5) / 10.0))

    def _density(self, wavenumber: Reals) -> Reals:
        number, density = self._bands()
        position = 10.0 * np.log10(2.0 * np.pi / wavenumber)
        if self.interpolation == "smooth":
            return np.exp(np.interp(position, number, np.log(density)))
        index = np.clip(np.rint(position).astype(np.int64) - number[0], 0, number.size - 1)
        return np.asarray(density[index])


class Iso3095(_OneThirdOctaves):
    """The limit of rail roughness of a reference track, ISO 3095:2013, Figure 2.

    Levels in dB re 1 um (r.m.s.) per one-third octave of wavelength, 0.4 m to 3.15 mm; the same 22 values
    are the "2007 TSI limit" listed in EN 15610:2009, B.9.2. A mean square per band is one-sided by nature.

    Parameters
    ----------
    interpolation : {"bands", "smooth"}
        "bands": constant within a band, which keeps each band's mean square; "smooth": log-log between the
        centres, which follows a slope and keeps it nearly.
    """

    type: Literal["iso3095"] = "iso3095"

    def _levels(self) -> tuple[Reals, Reals]:
        table = np.array(ISO3095_LIMIT_DB)
        return table[:, 0], table[:, 1]


class RoughnessTable(_OneThirdOctaves):
    """Measured roughness in one-third octaves of wavelength (EN 15610), dB re 1 um.

    Parameters
    ----------
    wavelength_m : sequence of float
        Nominal or exact band centres in metres (EN 15610 prints centimetres), longest or shortest first,
        without gaps.
    level_dB : sequence of float
        Levels, dB re 1 um r.m.s., one for each wavelength.
    interpolation : {"bands", "smooth"}
        See :class:`Iso3095`.
    """

    type: Literal["roughness_table"] = "roughness_table"
    wavelength_m: FloatTuple
    level_dB: FloatTuple

    @model_validator(mode="after")
    def _check_table(self) -> RoughnessTable:
        check_columns("wavelength_m", self.wavelength_m, "level_dB", self.level_dB)
        wavelength = np.array(self.wavelength_m)
        number = _band_number(wavelength)
        off = np.abs(wavelength / 10.0 ** (number / 10.0) - 1.0)
        if off.max() > _NOMINAL_SLACK:
            worst = int(off.argmax())
            raise ValueError(
                f"wavelength_m[{worst}] = {wavelength[worst]:g} m is not a one-third octave band; "
                f"the nearest is {10.0 ** (number[worst] / 10.0):.4g} m"
            )
        step = np.diff(number)
        if not (np.all(step == 1) or np.all(step == -1)):
            bad = int(np.flatnonzero(step != (np.sign(step[0]) or 1))[0])
            raise ValueError(
                f"wavelength_m[{bad}] = {wavelength[bad]:g} m and wavelength_m[{bad + 1}] = "
                f"{wavelength[bad + 1]:g} m are not neighbouring bands; sort the table and fill its gaps"
            )
        return self

    def _levels(self) -> tuple[Reals, Reals]:
        return np.array(self.wavelength_m), np.array(self.level_dB)


class DensityTable(Tabulated):
    """A table of one-sided density over wavenumber, straight lines between its points in log-log.

    Parameters
    ----------
    wavenumber_rad_per_m : sequence of float
        2 pi over wavelength, rad/m, ascending. A table over cycles per metre: multiply by 2 pi.
    density_m2_per_rad_per_m : sequence of float
        One-sided, m^2/(rad/m), above zero. A density in m^2/(1/m): divide by 2 pi.
    """

    type: Literal["table"] = "table"
    wavenumber_rad_per_m: FloatTuple
    density_m2_per_rad_per_m: FloatTuple

    @model_validator(mode="after")
    def _check_table(self) -> DensityTable:
        names = "wavenumber_rad_per_m", "density_m2_per_rad_per_m"
        columns = self.wavenumber_rad_per_m, self.density_m2_per_rad_per_m
        check_columns(names[0], columns[0], names[1], columns[1])
        for name, column in zip(names, columns, strict=True):
            for index, value in enumerate(column):
                if value <= 0.0:
                    raise ValueError(f"{name}[{index}] = {value:g} must be above zero (log-log table)")
        for index, (before, after) in enumerate(zip(columns[0], columns[0][1:], strict=False)):
            if after <= before:
                raise ValueError(
                    f"{names[0]}[{index + 1}] = {after:g} does not exceed the {before:g} before it; "
                    "sort the table by ascending wavenumber, without repeats"
                )
        return self

    @property
    def valid_wavelength_m(self) -> tuple[float, float]:
        """The table's own ends."""
        return 2.0 * np.pi / self.wavenumber_rad_per_m[-1], 2.0 * np.pi / self.wavenumber_rad_per_m[0]

    def _density(self, wavenumber: Reals) -> Reals:
        abscissa, ordinate = np.log(self.wavenumber_rad_per_m), np.log(self.density_m2_per_rad_per_m)
        return np.exp(np.interp(np.log(wavenumber), abscissa, ordinate))


def _band_number(wavelength: Reals) -> NDArray[np.int64]:
    return np.rint(10.0 * np.log10(wavelength)).astype(np.int64)


def check_columns(name: str, column: tuple[float, ...], other: str, values: tuple[float, ...]) -> None:
    """Refuse columns of a table that are not alike in length, too short, or an abscissa that is not above zero."""
    if len(column) != len(values):
        raise ValueError(f"{name} has {len(column)} values and {other} {len(values)}; they go in pairs")
    if len(column) < 2:
        raise ValueError(f"{name} needs at least two values")
    if min(column) <= 0.0:
        index = next(i for i, value in enumerate(column) if value <= 0.0)
        raise ValueError(f"{name}[{index}] = {column[index]:g} must be above zero")
