"""Faults of sensors, of channels on board, and of what was written down."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.plan import Plan, Transfer

CHANNELS_MOST = 0.35
"""How often the fault is on board."""


@dataclass(frozen=True)
class SensorFault(Effect):
    """A fault of one sensor: of the hammer test, named "rail@16.32", or of a channel on board."""

    DOMAIN = "measurement"
    sensor: str

    def fault(self, plan: Plan, gain: Transfer) -> None:
        """Multiply what the sensor reads."""
        if "@" in self.sensor:
            plan.line_gain.setdefault(_location(self.sensor), []).append(gain)
        else:
            plan.channel_gain.setdefault(self.sensor, []).append(gain)

    @property
    def place(self) -> dict[str, Any]:
        """The sensor."""
        return {"channels": [self.sensor]}


def _location(label: str) -> tuple[str, float]:
    body, x = label.split("@")
    return body, float(x)


def _sensor(random: np.random.Generator, site: Site) -> str:
    if float(random.random()) < CHANNELS_MOST:
        return str(random.choice(list(site.tests.channels)))
    body, x = site.tests.sensors[int(random.integers(len(site.tests.sensors)))]
    return f"{body}@{x}"


def _constant(value: complex) -> Transfer:
    return lambda f: np.full(f.shape, value, dtype=np.complex128)


@dataclass(frozen=True)
class SensorGain(SensorFault):
    """A wrong calibration."""

    KIND = "sensor_gain"
    ID = "sensor_gain"
    FAMILY = "sensor level"
    ALTERNATIVES = ("sensor_gain", "irregularity_level")
    FADES = (("gain", 1.0),)

    gain: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Factor by strength, too much or too little."""
        gain = (1.0 + size(random, strength, 0.25, 0.5, 1.2)) ** float(random.choice([-1.0, 1.0]))
        return cls(_sensor(random, site), round(gain, 3))

    def apply(self, plan: Plan) -> None:
        """Multiply."""
        self.fault(plan, _constant(self.gain))

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.sensor} reads {self.gain:g} of what is there"


@dataclass(frozen=True)
class SensorDelay(SensorFault):
    """A sensor that reads late."""

    KIND = "sensor_delay"
    ID = "sensor_delay"
    FAMILY = "sensor phase"
    FADES = (("delay_s", 0.0),)

    delay_s: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Delay by strength."""
        return cls(_sensor(random, site), size(random, strength, 1.5e-4, 4e-4, 1e-3))

    def apply(self, plan: Plan) -> None:
        """Turn the phase."""
        self.fault(plan, lambda f: np.exp(-2j * np.pi * f * self.delay_s))

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.sensor} is {1e3 * self.delay_s:g} ms late"


@dataclass(frozen=True)
class SensorPolarity(SensorFault):
    """A sensor mounted upside down."""

    KIND = "sensor_polarity"
    ID = "sensor_polarity"
    FAMILY = "sensor phase"

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """One sensor."""
        return cls(_sensor(random, site))

    def apply(self, plan: Plan) -> None:
        """Change the sign."""
        self.fault(plan, _constant(-1.0))

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.sensor} reads with the wrong sign"


@dataclass(frozen=True)
class SensorMounting(SensorFault):
    """A sensor that swings on its mounting."""

    KIND = "sensor_mounting"
    ID = "sensor_mounting"
    FAMILY = "sensor level"
    FADES = (("resonance_Hz", math.inf),)

    resonance_Hz: float
    quality: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Resonance by strength: the lower, the more is read."""
        return cls(_sensor(random, site), size(random, strength, 900.0, 600.0, 380.0), between(random, 4.0, 15.0))

    def apply(self, plan: Plan) -> None:
        """Multiply by the mounting's amplification."""

        def swing(f: Reals) -> Complexes:
            ratio = f / self.resonance_Hz
            return np.asarray(1.0 / (1.0 - ratio**2 + 1j * ratio / self.quality))

        self.fault(plan, swing)

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.sensor} swings on its mounting at {self.resonance_Hz:g} Hz"


@dataclass(frozen=True)
class NoiseFloor(SensorFault):
    """A noisy sensor."""

    KIND = "noise_floor"
    ID = "noise_floor"
    FAMILY = "noise"
    FADES = (("factor", 1.0),)

    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Factor on the noise's amplitude by strength."""
        return cls(_sensor(random, site), size(random, strength, 10.0, 30.0, 100.0))

    def apply(self, plan: Plan) -> None:
        """Raise the floor."""
        if "@" in self.sensor:
            plan.line_noise[_location(self.sensor)] = self.factor
        else:
            plan.channel_noise[self.sensor] = self.factor

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.sensor} has {self.factor:g} times the noise"


@dataclass(frozen=True)
class MainsLines(Effect):
    """Mains hum on all channels on board."""

    KIND = "mains_lines"
    ID = "mains_lines"
    FAMILY = "noise"
    DOMAIN = "measurement"
    FADES = (("amplitude", 0.0),)

    amplitude: float
    hertz: float
    share_of_third: float
    phase: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Amplitude, m/s2, by strength."""
        turn = round(float(random.uniform(0.0, 6.28)), 3)
        return cls(size(random, strength, 0.02, 0.1, 0.5), 50.0, between(random, 0.2, 0.8), turn)

    def apply(self, plan: Plan) -> None:
        """Add it."""

        def hum(_: str, times: Reals) -> Reals:
            turn = 2.0 * np.pi * self.hertz * times + self.phase
            return np.asarray(self.amplitude * (np.sin(turn) + self.share_of_third * np.sin(3.0 * turn)))

        plan.hums.append(hum)

    @property
    def place(self) -> dict[str, Any]:
        """All channels on board."""
        return {"channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"hum of {self.amplitude:g} m/s2 at {self.hertz:g} Hz and three times that"


@dataclass(frozen=True)
class SpeedError(Effect):
    """The speed written down is wrong for all runs. It is not faded: any speed may be off by half a percent."""

    KIND = "speed_error"
    ID = "speed_error"
    FAMILY = "speed"
    DOMAIN = "measurement"

    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Relative error by strength, fast or slow."""
        off = size(random, strength, 0.012, 0.025, 0.05) * float(random.choice([-1.0, 1.0]))
        return cls(round(1.0 + off, 4))

    def apply(self, plan: Plan) -> None:
        """Run at another speed than written down."""
        plan.speed_factor = [factor * self.factor for factor in plan.speed_factor]

    @property
    def place(self) -> dict[str, Any]:
        """All channels on board."""
        return {"channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the true speed is {self.factor:g} of what is written down"
