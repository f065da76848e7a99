"""The measuring chain: what lies between the motion of a body and the number that is written down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from permway.arrays import Complexes, Reals
from permway.model.faults import fault
from permway.records import FrozenModel, Number

Quantity = Literal["displacement", "velocity", "acceleration", "force", "strain", "bending_moment"]

Direction = Literal["down", "up", "lateral", "longitudinal"]

DERIVATIVES: dict[str, int] = {"displacement": 0, "velocity": 1, "acceleration": 2}

UNITS: dict[str, dict[str, float]] = {
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3},
    "acceleration": {"m/s2": 1.0, "m/s^2": 1.0, "g": 9.80665, "mm/s2": 1e-3},
    "force": {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605},
}
"""Units of each quantity, and what one of them is in SI."""

BENT_UNITS: dict[str, dict[str, float]] = {
    "strain": {"m/m": 1.0, "um/m": 1e-6},
    "bending_moment": {"N*m": 1.0, "kN*m": 1e3},
}
"""The same of what beams are bent by; files of what moves and pushes are not taken for it."""


class Mains(FrozenModel):
    """Hum that a chain picks up: a line at the mains' frequency and at its multiples.

    All channels with hum of one frequency have it from one source, in one phase.

    Parameters
    ----------
    frequency_Hz : float
    amplitude : float
        Of the first line, in the sensor's unit.
    harmonics : int
        Number of the last line.
    decay : float
        The n-th line has the amplitude times n^-decay.
    shares : tuple of float, optional
        Amplitudes of the second line, the third and so on over that of the first, in place of the two above.
    """

    frequency_Hz: PositiveFloat = 50.0
    amplitude: NonNegativeFloat
    harmonics: int = Field(default=8, ge=1, le=100, strict=True)
    decay: Number = Field(default=1.0, ge=0.0, le=10.0)
    shares: tuple[NonNegativeFloat, ...] | None = Field(default=None, max_length=100)

    def lines(self) -> list[float]:
        """Amplitude of every line, in the sensor's unit."""
        decaying = [float(number) ** -self.decay for number in range(1, 1 + self.harmonics)]
        each = decaying if self.shares is None else [1.0, *self.shares]
        return [self.amplitude * share for share in each]


class Chain(FrozenModel):
    """Transfer from the true quantity, in SI, to the record, in the sensor's unit and in SI.

    Parameters
    ----------
    gain : float
        What is read over what is there.
    delay_s : float
        What is read comes so much later.
    clock_slow : float
        How much slower its clock runs than that of the others, relative: the delay grows so over a run.
    polarity : 1 or -1
        -1 for a sensor mounted, or wired, the wrong way round.
    mount_Hz : float, optional
        Resonance of the sensor on its mount.
    mount_loss_factor : float
        Of the mount.
    noise_floor : float
        One-sided density of what is read with nothing there, unit squared per hertz.
    noise_flicker : float
        Noise that falls with frequency: its density times frequency, unit squared.
    noise_factor : float
        Times that its noise is more than so, or, in hammer tests, than that of the other sensors; of power.
    mains : Mains, optional
    """

    gain: PositiveFloat = 1.0
    delay_s: Number = Field(default=0.0, ge=-10.0, le=10.0)
    clock_slow: Number = Field(default=0.0, ge=-0.01, le=0.01)
    polarity: Literal[1, -1] = 1
    mount_Hz: PositiveFloat | None = None
    mount_loss_factor: NonNegativeFloat = 0.05
    noise_floor: NonNegativeFloat = 0.0
    noise_flicker: NonNegativeFloat = 0.0
    noise_factor: PositiveFloat = 1.0
    mains: Mains | None = None

    @property
    def flat(self) -> bool:
        """Whether the transfer is the same at all frequencies."""
        return not self.delay_s and self.mount_Hz is None

    def transfer(self, frequency_Hz: Reals) -> Complexes:
        """Read over true, shape of the frequencies.

        The mount is a mass on a spring k (1 + i eta): (1 + i eta) / (1 + i eta - (f/f0)^2).
        """
        value: Complexes = np.full(np.shape(frequency_Hz), self.polarity * self.gain, dtype=np.complex128)
        if self.delay_s:
            value = value * np.exp(-2j * np.pi * frequency_Hz * self.delay_s)
        if self.mount_Hz is not None:
            spring = 1.0 + 1j * self.mount_loss_factor
            value = value * (spring / (spring - (frequency_Hz / self.mount_Hz) ** 2))
        return np.asarray(value, dtype=np.complex128)


class Sensor(FrozenModel):
    """A sensor: what it sits on, and what it reads.

    Parameters
    ----------
    name : str
    body : str, optional
        Body of the line, with `x_m`.
    x_m : float, optional
    degree : str, optional
        Instead: a degree of freedom of the vehicle, as "car1.wheelset2" or "car1.body.bounce".
    direction : "down", "up", "lateral" or "longitudinal"
        Of what it reads as positive. The model moves up and down; the others are kept, and not predicted.
    quantity : "displacement", "velocity", "acceleration", "force", "strain" or "bending_moment"
        The last two of a beam while a train passes.
    height_m : float, optional
        Of a strain: how far below the axis of the beam the fibre lies; a beam that sags lengthens there.
    unit : str
        As the file has it.
    chain : Chain
    """

    name: str = Field(min_length=1)
    body: str | None = None
    x_m: Number | None = None
    degree: str | None = None
    direction: Direction = "down"
    quantity: Quantity = "acceleration"
    height_m: Number | None = None
    unit: str
    chain: Chain = Chain()

    @model_validator(mode="after")
    def _check(self) -> Sensor:
        if (self.body is None) == (self.degree is None):
            raise fault("give body and x_m, or degree", "body")
        if (self.body is None) != (self.x_m is None):
            raise fault("x_m goes with body" if self.body is None else "missing: where on the body", "x_m")
        if (self.height_m is not None) != (self.quantity == "strain"):
            raise fault('goes with quantity = "strain", which needs it', "height_m", value=self.height_m)
        if self.bends and self.body is None:
            raise fault("strains and bending moments are of a beam of the line: give body and x_m", "body")
        if self.unit not in self._units:
            what = f"is no unit of {self.quantity} here: use one of {sorted(self._units)}"
            if "/N" in self.unit or "/kN" in self.unit:
                what += "; the unit of the force is the point's"
            raise fault(what, "unit", value=self.unit)
        return self

    @property
    def predicted(self) -> bool:
        """Whether the model states anything of its direction."""
        return self.direction in ("down", "up")

    @property
    def bends(self) -> bool:
        """Whether it reads how a beam is bent, and not how it moves."""
        return self.quantity in ("strain", "bending_moment")

    @property
    def to_SI(self) -> float:
        """One unit of the file in SI."""
        return self._units[self.unit]

    @property
    def _units(self) -> dict[str, float]:
        return (BENT_UNITS if self.bends else UNITS)[self.quantity]

    @property
    def noise_density(self) -> float:
        """One-sided density of the noise floor, SI unit squared per hertz."""
        return self.chain.noise_floor * self.to_SI**2

    def noise(self, frequency_Hz: Reals) -> Reals:
        """One-sided density of all noise of the chain, SI unit squared per hertz, shape (F,)."""
        density = self.noise_density + self.chain.noise_flicker * self.to_SI**2 / frequency_Hz
        return np.asarray(self.chain.noise_factor * density)

    def there(self, frequency_Hz: Reals) -> Complexes:
        """What an ideal chain reads over the displacement down in m (over the force down in N), shape (F,)."""
        return there(self.quantity, self.direction, frequency_Hz)

    def transfer(self, frequency_Hz: Reals) -> Complexes:
        """What is read, in SI, over the displacement down in m (over the force down in N), shape (F,)."""
        return np.asarray(self.there(frequency_Hz) * self.chain.transfer(frequency_Hz))


def there(quantity: Quantity, direction: Direction, frequency_Hz: Reals) -> Complexes:
    """What an ideal chain reads; see :meth:`Sensor.there`."""
    sign = -1.0 if direction == "up" else 1.0
    omega = 2.0 * np.pi * frequency_Hz
    order = DERIVATIVES.get(quantity, 0)
    return np.asarray(sign * 1j**order * omega**order, dtype=np.complex128)


class Point(FrozenModel):
    """A place where a hammer strikes, or a shaker pushes.

    Parameters
    ----------
    name : str
    body : str
    x_m : float
    direction : "down" or "up"
    unit : str
        Of the force as the file has it.
    chain : Chain
        Of the force cell.
    """

    name: str = Field(min_length=1)
    body: str
    x_m: Number
    direction: Literal["down", "up"] = "down"
    unit: Literal["N", "kN", "lbf"] = "N"
    chain: Chain = Chain()

    @property
    def to_SI(self) -> float:
        """One unit of the file in N."""
        return UNITS["force"][self.unit]

    def transfer(self, frequency_Hz: Reals) -> Complexes:
        """What is read over the force down, both in N, shape (F,)."""
        return (-1.0 if self.direction == "up" else 1.0) * self.chain.transfer(frequency_Hz)


def transfers(channels: Sequence[Sensor] | Sequence[Point], frequency_Hz: Reals) -> Complexes:
    """What sensors or force cells read, side by side; those that read alike are computed once.

    Returns
    -------
    ndarray of complex128, shape (F, channels)
        See :meth:`Sensor.transfer` and :meth:`Point.transfer`.
    """
    each: dict[tuple[object, ...], Complexes] = {}
    columns = []
    for channel in channels:
        kind = getattr(channel, "quantity", None), channel.direction, channel.chain
        if kind not in each:
            each[kind] = channel.transfer(frequency_Hz)
        columns.append(each[kind])
    return np.stack(columns, axis=-1)
