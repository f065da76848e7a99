"""A mass on rubber in shear, base shaken: the transmissibility a law predicts, compared with a record.

T = k*/(k* - m omega^2) with k* = n G* A/h for n rubber rings sheared side by side; T is the motion of the
mass over that of the base. The mass is everything that moves with it. A DMA modulus holds at the strain it
was measured at: filled rubber softens with strain (Payne), so a record should be taken near that strain;
`shear_strain` states what a record saw.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field
from scipy import optimize

from permway.arrays import Complexes, Reals, check_frequency
from permway.errors import InputError
from permway.laws.base import Law
from permway.laws.textfile import number, read_lines
from permway.records import FrozenModel, Number

_COLUMNS = ("freq_hz", "base_accel_ms2", "base_phase_rad", "mass_accel_ms2", "mass_phase_rad")


class ShearRig(FrozenModel):
    """Rubber rings sheared between a base and a mass.

    Parameters
    ----------
    outer_diameter_m, inner_diameter_m : float
        Of a ring, m.
    thickness_m : float
        Of a ring, m.
    rings : int
        Working side by side.
    moving_mass_kg : float
        What moves with the mass beside it (end discs), kg.
    """

    outer_diameter_m: Number = Field(gt=0.0)
    inner_diameter_m: Number = Field(ge=0.0)
    thickness_m: Number = Field(gt=0.0)
    rings: int = Field(default=2, ge=1)
    moving_mass_kg: Number = Field(default=0.0, ge=0.0)

    @property
    def shape_factor_m(self) -> float:
        """Stiffness per modulus, n A / h, m."""
        area = 0.25 * np.pi * (self.outer_diameter_m**2 - self.inner_diameter_m**2)
        return float(self.rings * area / self.thickness_m)


@dataclass(frozen=True)
class ShakerRecord:
    """A swept sine: transmissibility over frequency.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (n,)
        Hz.
    transmissibility : ndarray of complex128, shape (n,)
        Acceleration of the mass over that of the base.
    base_acceleration : ndarray of complex128, shape (n,)
        m/s2.
    source : str
        File.
    """

    frequency_Hz: Reals
    transmissibility: Complexes
    base_acceleration: Complexes
    source: str = ""

    def shear_strain(self, rig: ShearRig) -> Reals:
        """Amplitude of shear strain in the rings, relative motion over thickness, shape (n,)."""
        relative = np.abs((self.transmissibility - 1.0) * self.base_acceleration)
        return np.asarray(relative / (2.0 * np.pi * self.frequency_Hz) ** 2 / rig.thickness_m)


@dataclass(frozen=True, kw_only=True)
class TransmissibilityComparison:
    """A prediction compared with a record over the record's whole band.

    Attributes
    ----------
    rms_dB : float
        Root mean square of 20 lg |T predicted / T measured|, the law as it stands.
    rms_constant_dB : float
        The same with the modulus held constant at `constant_Hz`.
    rms_scaled_dB : float
        The same with the law times `stiffness_factor`.
    stiffness_factor : float
        The one factor, fitted to this record unless given.
    constant_Hz : float
        Where the constant modulus was read off the law.
    predicted, constant, scaled : ndarray of complex128, shape (n,)
        The three transmissibilities.
    """

    rms_dB: float
    rms_constant_dB: float
    rms_scaled_dB: float
    stiffness_factor: float
    constant_Hz: float
    predicted: Complexes
    constant: Complexes
    scaled: Complexes


def read_shaker(path: str | Path) -> ShakerRecord:
    """Read a record with the columns freq_hz, base_accel_ms2, base_phase_rad, mass_accel_ms2, mass_phase_rad.

    Raises
    ------
    InputError
        For a missing column, a cell that is not a number, a base at rest, a line cut short.
    """
    source = Path(path)
    header, *rows = read_lines(source)
    missing = [name for name in _COLUMNS if name not in header.cells]
    if missing:
        raise InputError(
            f"no column {', '.join(missing)}", where=f"{source}: line {header.number}", value=header.cells
        )
    if not rows:
        raise InputError("a header but no rows", where=str(source))
    table = np.empty((len(rows), len(_COLUMNS)))
    for index, row in enumerate(rows):
        if len(row.cells) != len(header.cells):
            raise InputError(
                f"{len(row.cells)} cells where the header has {len(header.cells)}",
                where=f"{source}: line {row.number}",
            )
        for column, name in enumerate(_COLUMNS):
            place = f"{source}: line {row.number}, column '{name}'"
            table[index, column] = number(row.cells[header.cells.index(name)], place)
            if name == "base_accel_ms2" and table[index, column] == 0.0:
                raise InputError("the base is at rest, transmissibility has no value", where=place)
    base = table[:, 1] * np.exp(1j * table[:, 2])
    mass = table[:, 3] * np.exp(1j * table[:, 4])
    return ShakerRecord(check_frequency(table[:, 0]), mass / base, base, str(source))


def transmissibility(stiffness: ArrayLike, mass_kg: float, frequency_Hz: ArrayLike) -> Complexes:
    """T = k/(k - m omega^2).

    Parameters
    ----------
    stiffness : array_like of complex, shape (n,) or ()
        k*, N/m.
    mass_kg : float
        m, kg.
    frequency_Hz : array_like, shape (n,)
        Hz.
    """
    omega = 2.0 * np.pi * check_frequency(frequency_Hz)
    value = np.asarray(stiffness, dtype=np.complex128)
    return np.asarray(value / (value - mass_kg * omega**2))


def predict(
    law: Law, rig: ShearRig, mass_kg: float, frequency_Hz: ArrayLike, temperature_C: float | None = None
) -> Complexes:
    """Transmissibility from a law of the shear modulus, nothing fitted.

    Parameters
    ----------
    law : Law
        Shear modulus, Pa.
    rig : ShearRig
        Geometry, and what moves with the mass.
    mass_kg : float
        The mass itself, kg.
    frequency_Hz : array_like, shape (n,)
        Hz.
    temperature_C : float, optional
        Of the rubber.
    """
    stiffness = rig.shape_factor_m * law.complex(frequency_Hz, temperature_C)
    return transmissibility(stiffness, mass_kg + rig.moving_mass_kg, frequency_Hz)


def compare_record(
    law: Law,
    rig: ShearRig,
    mass_kg: float,
    record: ShakerRecord,
    *,
    temperature_C: float | None = None,
    constant_Hz: float = 10.0,
    stiffness_factor: float | None = None,
) -> TransmissibilityComparison:
    """Hold a law's prediction against a record, with a constant modulus and one common factor beside it.

    Parameters
    ----------
    law : Law
        Shear modulus, Pa.
    rig : ShearRig
        Geometry.
    mass_kg : float
        The mass itself, kg.
    record : ShakerRecord
        The measurement.
    temperature_C : float, optional
        Of the rubber.
    constant_Hz : float
        Where to read a constant modulus off the law; 10 Hz is a usual single test frequency, and the middle of
        a DMA sweep from 1 to 100 Hz.
    stiffness_factor : float, optional
        Factor on the stiffness; fitted to this record if None.

    Returns
    -------
    TransmissibilityComparison
        Errors in dB over the record's band, and the curves.
    """
    frequency, mass = record.frequency_Hz, mass_kg + rig.moving_mass_kg
    stiffness = rig.shape_factor_m * law.complex(frequency, temperature_C)
    at_rest = rig.shape_factor_m * law.complex(constant_Hz, temperature_C)
    if stiffness_factor is None:
        stiffness_factor = common_factor([(stiffness, mass, record)])
    curves = [
        transmissibility(value, mass, frequency) for value in (stiffness, at_rest, stiffness_factor * stiffness)
    ]
    errors = [rms_dB(curve, record.transmissibility) for curve in curves]
    return TransmissibilityComparison(
        rms_dB=errors[0],
        rms_constant_dB=errors[1],
        rms_scaled_dB=errors[2],
        stiffness_factor=stiffness_factor,
        constant_Hz=constant_Hz,
        predicted=curves[0],
        constant=curves[1],
        scaled=curves[2],
    )


def common_factor(cases: list[tuple[Complexes, float, ShakerRecord]]) -> float:
    """The one real factor on the stiffness that serves several records best (rms in dB).

    Parameters
    ----------
    cases : list of (stiffness, mass, record)
        Stiffness in N/m at the record's frequencies, shape (n,); moving mass in kg.
    """

    def cost(lg_factor: float) -> float:
        squares = [
            rms_dB(transmissibility(10.0**lg_factor * k, m, r.frequency_Hz), r.transmissibility) ** 2
            for k, m, r in cases
        ]
        return float(np.mean(squares))

    # Coarse first: with little damping the error has side valleys.
    coarse = np.linspace(-0.6, 0.6, 61)
    best = coarse[int(np.argmin([cost(x) for x in coarse]))]
    found = optimize.minimize_scalar(
        cost, bounds=(best - 0.03, best + 0.03), method="bounded", options={"xatol": 1e-7}
    )
    return float(10.0 ** float(found.x))


def rms_dB(predicted: Complexes, measured: Complexes) -> float:
    """Root mean square of 20 lg |predicted/measured|."""
    return float(np.sqrt(np.mean((20.0 * np.log10(np.abs(predicted / measured))) ** 2)))
