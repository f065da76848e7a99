"""What excites a train beside the profile's own spectrum: bands, lines, the roughness of single wheels, forces."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from pydantic import Field, InstanceOf, NonNegativeFloat, PositiveFloat, model_validator

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.faults import fault
from permway.model.line import Line
from permway.records import FrozenModel, Number

if TYPE_CHECKING:
    from permway.campaign.parts import Condition, IrregularityKnown
    from permway.problem.model import Model


class RoughBand(FrozenModel):
    """More roughness about one wavelength, as of corrugated rail.

    The profile's density is multiplied by 1 + (10^(gain/10) - 1) exp(-x^2/2), x = log2(wavelength/centre)/octaves.

    Parameters
    ----------
    wavelength_m : float
        Centre.
    octaves : float
        Width: one standard deviation of the bell over the logarithm of wavelength.
    gain_dB : float
        At the centre.
    """

    wavelength_m: PositiveFloat
    octaves: float = Field(default=0.2, ge=0.005, le=5.0)
    gain_dB: Number = Field(ge=0.0, le=60.0)


class Dips(FrozenModel):
    """Dips of one shape at places that do not repeat: welds, squats, spots of soft ballast.

    Each is a depth times (1 + cos(2 pi x / length)) / 2 over its length. With n of them a metre, independent of
    each other, the profile's one-sided density over wavenumber k = 2 pi / wavelength, m2/(rad/m), gains
    n |D(k)|^2 / pi, D the transform of one dip, D(0) = depth length / 2 (Campbell, 1909).

    Parameters
    ----------
    depth_m : float
        In the root mean square.
    length_m : float
    every_m : float
        Mean distance, 1/n.
    """

    depth_m: float = Field(ge=0.0, le=0.1)
    length_m: float = Field(ge=0.01, le=20.0)
    every_m: float = Field(default=20.0, ge=0.1, le=10_000.0)

    def density(self, wavenumber: Reals) -> Reals:
        """One-sided, m2/(rad/m), shape of the wavenumbers in rad/m."""
        turns = np.asarray(wavenumber) * self.length_m / (2.0 * np.pi)
        # sinc(u) / (1 - u^2) is (sinc(u - 1) + sinc(u + 1)) / 2 + sinc(u), which divides by nothing at u = 1.
        shape = np.sinc(turns) + 0.5 * (np.sinc(turns - 1.0) + np.sinc(turns + 1.0))
        return np.asarray((0.5 * self.depth_m * self.length_m * shape) ** 2 / (np.pi * self.every_m))


class _Lines(FrozenModel):
    """A harmonic series of a profile: amplitude a of the first, a n^-decay of the n-th.

    Parameters
    ----------
    amplitude_m : float
    harmonics : int, optional
        How many; by default as many as the record's band holds.
    decay : float
    width : float
        Standard deviation of a line's frequency over the frequency, of a bell; 0 for a pure line.
    """

    amplitude_m: NonNegativeFloat
    harmonics: int | None = Field(default=None, ge=1, le=10_000, strict=True)
    decay: Number = Field(default=1.0, ge=0.0, le=10.0)
    width: float = Field(default=0.0, ge=0.0, le=0.3)

    def amplitude(self, number: Reals) -> Reals:
        """Of lines by their number, m."""
        return np.asarray(self.amplitude_m * number**-self.decay)


class TrackLines(_Lines):
    """Something that repeats along the track, met by all wheels one after the other: lines at n V / length.

    Parameters
    ----------
    length_m : float
        Of rails between welds, of spans, of the distance between supports.
    dip_m : float, optional
        Lines are those of dips of this length l instead, d (1 - sin(pi |x| / l)), two quarter waves that meet in a
        kink as at the ends of rails; `amplitude_m` is then that of lines far longer than a dip.
    amplitude_m, harmonics, decay, width
        See :class:`_Lines`.
    """

    length_m: float = Field(ge=0.05, le=1000.0)
    dip_m: float | None = Field(default=None, gt=0.0, le=100.0)

    @model_validator(mode="after")
    def _falls_once(self) -> Self:
        if self.dip_m is not None and "decay" in self.model_fields_set:
            raise fault("a dip states how its lines fall: leave out decay, or dip_m", "decay")
        return self

    def amplitude(self, number: Reals) -> Reals:
        """Of lines by their number, m."""
        if self.dip_m is None:
            return super().amplitude(number)
        return np.asarray(self.amplitude_m * np.abs(_quarter_waves(np.pi * number * self.dip_m / self.length_m)))


def _quarter_waves(turns: Reals) -> Reals:
    """Integral of (1 - sin(pi u / 2)) cos(k u) over u from 0 to 1, over that at k = 0."""
    late, early = turns + 0.5 * np.pi, turns - 0.5 * np.pi
    # (1 - cos v) / v, which divides by nothing at v = 0.
    both = [np.sin(0.5 * v) * np.sinc(0.5 * v / np.pi) for v in (late, early)]
    return np.asarray((np.sinc(turns / np.pi) - 0.5 * (both[0] - both[1])) / (1.0 - 2.0 / np.pi))


class WheelLines(_Lines):
    """Roughness of the wheels themselves, lines at n order V / (2 pi R), each wheel for itself.

    Parameters
    ----------
    order : float
        Of the first line, per turn: 18 for a polygon of 18 sides, 1 for a flat.
    wheel : int, optional
        1 is the leading wheelset; by default every wheelset, independent of each other.
    amplitude_m, harmonics, decay, width
        See :class:`_Lines`.
    """

    order: float = Field(default=1.0, ge=0.5, le=500.0)
    wheel: int | None = Field(default=None, ge=1, strict=True)


@dataclass(frozen=True, eq=False)
class About:
    """A line and the runs on it for which it is known what rolling changes.

    Attributes
    ----------
    line : Line
    runs : mapping of str to (float, float or None)
        By condition: speed in m/s, temperature in degC.
    """

    line: Line
    runs: Mapping[str, tuple[float, float | None]]


class Rolling(FrozenModel):
    """Wheels roll over supports that repeat, where else they stand and the profile moves under them.

    They pass stiffer and softer places of the rail: their weight shakes them at multiples of V / spacing, and what
    the profile does to them at a frequency they do at others, too, that far away.

    Parameters
    ----------
    spacing_m : float
        Of the supports.
    share : float
        Of all that rolling changes: 1 as the line has it, 0 stands.
    about : About, optional
        For what it is known what rolling changes: that is carried over to the model's own line and speeds, which
        differ little. Of a campaign that is read, its model and its conditions. Not in files.
    """

    spacing_m: float = Field(ge=0.1, le=10.0)
    share: float = Field(default=1.0, ge=0.0, le=3.0)
    about: InstanceOf[About] | None = Field(default=None, exclude=True, repr=False)


class Push(FrozenModel):
    """A random force on a degree of freedom of the vehicle: a motor, a gear box, the wind.

    Parameters
    ----------
    degree : str
        As "car1.bogie1.bounce".
    density_N2_per_Hz : float
        One-sided; of the centre, if there is one. Moments, for a pitch, in (N m)^2/Hz.
    centre_Hz : float, optional
        By default the density is the same at all frequencies.
    octaves : float
        One standard deviation of the bell about the centre.
    quality : float, optional
        Of a resonance about the centre through which the force comes, instead of a bell; its density falls off
        with the square of frequency on either side.
    """

    degree: str
    density_N2_per_Hz: NonNegativeFloat
    centre_Hz: PositiveFloat | None = None
    octaves: float = Field(default=1.0, ge=0.01, le=10.0)
    quality: float | None = Field(default=None, ge=0.1, le=1000.0)


def check_excitation(known: IrregularityKnown, conditions: Iterable[Condition], model: Model) -> None:
    """Check what an irregularity states about conditions, wheels and degrees of freedom.

    Raises
    ------
    InputError
        With the place in the campaign file.
    """
    trains = [condition.name for condition in conditions if condition.kind == "train"]
    for name in known.level_by_condition_dB:
        if name not in trains:
            where = f"irregularity.level_by_condition_dB.{name}"
            raise InputError("there is no train of that name", where=where, remedy=f"use one of {trains}")
    wheels = 0 if model.train is None else len(model.train.vehicle.wheel_indices)
    for index, lines in enumerate(known.wheels):
        if wheels < (lines.wheel or 1):
            what = f"the vehicle has {wheels} wheelsets" if wheels else "the model has no train"
            raise InputError(what, where=f"irregularity.wheels[{index}].wheel", value=lines.wheel)
    degrees = [] if model.train is None else model.train.vehicle.degrees
    for index, push in enumerate(known.pushes):
        if push.quality is not None and push.centre_Hz is None:
            where = f"irregularity.pushes[{index}].quality"
            raise InputError("is of a resonance without a frequency", where=where, remedy="give centre_Hz, too")
        if push.degree not in degrees:
            where = f"irregularity.pushes[{index}].degree"
            remedy = f"use one of {degrees[:10]}" if degrees else "give the model file a [train]"
            raise InputError(
                "the vehicle has no such degree of freedom", where=where, value=push.degree, remedy=remedy
            )
