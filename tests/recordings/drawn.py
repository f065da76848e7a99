"""Random files by the usual writers of each format, and whether what is read of them is right, refused or wrong.

A case holds what its file means, in SI. Reading may end in an `InputError`, which is no fault here; whatever is
returned has to be what was meant: channels, values, rate, pairs, frequencies.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_time
from permway.units import parse_unit

UNITS = {
    "m/s2": 1.0, "m/s^2": 1.0, "m/s²": 1.0, "mm/s2": 1e-3, "g": 9.80665, "mg": 9.80665e-3, "m/s": 1.0,
    "mm/s": 1e-3, "m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "N": 1.0, "kN": 1e3, "V": 1.0, "mV": 1e-3,
}  # fmt: skip
"""Units as programs write them, and what one is in SI."""

RATES = (20.0, 51.2, 100.0, 256.0, 400.0, 500.0, 512.0, 1000.0, 1024.0, 2048.0, 2560.0, 5120.0, 10240.0, 51200.0)


@dataclass(frozen=True)
class Times:
    """What a record in time means.

    Attributes
    ----------
    channels : dict of label to values
        In SI where the file states the unit, else as they stand.
    units : dict of label to (str or None)
        As stated.
    rate_Hz : float or None
        None if the file does not state it.
    precision : float
        Relative to the largest value of the channel.
    rate_precision : float
    ask : dict
        Arguments of the reader.
    """

    channels: Mapping[str, np.ndarray]
    units: Mapping[str, str | None]
    rate_Hz: float | None
    precision: float = 1e-12
    rate_precision: float = 1e-4
    ask: Mapping[str, Any] = field(default_factory=dict)

    def fault(self, path: Path) -> str:
        """What is wrong with what is read, empty if nothing is."""
        record = read_time(path, **self.ask)
        if set(record.channels) != set(self.ask.get("channels", self.channels)):
            return f"channels {record.channels}, not {list(self.channels)}"
        for name, unit, row in zip(record.channels, record.units, record.values, strict=True):
            meant, stated = self.channels[name], self.units[name]
            if (unit is None) != (stated is None):
                return f"{name}: unit {unit!r}, the file states {stated!r}"
            found = row if unit is None else parse_unit(unit).to_SI(row)
            if found.shape != meant.shape:
                return f"{name}: {found.size} samples, not {meant.size}"
            off = float(np.max(np.abs(found - meant)))
            if not off <= self.precision * max(float(np.max(np.abs(meant))), 1e-300):
                return f"{name}: off by {off:g} of {np.max(np.abs(meant)):g}"
        if record.sampling_Hz is None or self.rate_Hz is None:
            return "" if record.sampling_Hz == self.rate_Hz else f"rate {record.sampling_Hz}, not {self.rate_Hz}"
        if abs(record.sampling_Hz / self.rate_Hz - 1.0) > self.rate_precision:
            return f"rate {record.sampling_Hz}, not {self.rate_Hz}"
        return ""


@dataclass(frozen=True)
class Responses:
    """What frequency responses mean: frequency (F,), values by pair (F,), in SI where the unit is stated."""

    frequency_Hz: np.ndarray
    values: Mapping[tuple[str, str], np.ndarray]
    coherence: Mapping[tuple[str, str], np.ndarray] | None
    factor: float | None
    precision: float = 1e-12
    ask: Mapping[str, Any] = field(default_factory=dict)

    def fault(self, path: Path) -> str:
        """What is wrong with what is read, empty if nothing is."""
        record = read_frf(path, **self.ask)
        pairs = list(zip(record.responses, record.references, strict=True))
        if set(pairs) != set(self.values):
            return f"pairs {pairs}, not {list(self.values)}"
        if record.frequency_Hz.shape != self.frequency_Hz.shape:
            return f"{record.frequency_Hz.size} lines, not {self.frequency_Hz.size}"
        if not np.allclose(record.frequency_Hz, self.frequency_Hz, rtol=1e-5, atol=1e-12):
            return f"frequencies {record.frequency_Hz[:3]}, not {self.frequency_Hz[:3]}"
        for row, pair in enumerate(pairs):
            unit = record.unit_of(row)
            if (unit is None) != (self.factor is None):
                return f"unit {unit!r}, a factor of {self.factor} was stated"
            found = record.values[row] * (1.0 if unit is None else parse_unit(unit).factor)
            off = float(np.max(np.abs(found - self.values[pair])))
            if not off <= self.precision * float(np.max(np.abs(self.values[pair]))):
                return f"{pair}: off by {off:g} of {np.max(np.abs(self.values[pair])):g}"
            if record.coherence is not None and self.coherence is not None:
                off = float(np.max(np.abs(record.coherence[row] - self.coherence[pair])))
                if not off <= max(self.precision, 1e-5):
                    return f"{pair}: coherence off by {off:g}"
        return ""


Meaning = Times | Responses
Writer = Callable[[np.random.Generator, Path], tuple[Path, Meaning]]


def outcome(meaning: Meaning, path: Path) -> str:
    """'right', 'refused: why' or 'wrong: how'."""
    try:
        fault = meaning.fault(path)
    except InputError as error:
        return f"refused: {error}"
    return f"wrong: {fault}" if fault else "right"


def pick(random: np.random.Generator, *choices: Any) -> Any:
    """One of these."""
    return choices[int(random.integers(len(choices)))]


def chance(random: np.random.Generator, share: float) -> bool:
    """True in this share of cases."""
    return bool(random.random() < share)


def signals(random: np.random.Generator, count: int, samples: int) -> np.ndarray:
    """Noise of any size, shape (channel, sample)."""
    size = 10.0 ** random.uniform(-4.0, 4.0, size=(count, 1))
    return np.asarray(size * random.standard_normal((count, samples)))


def responses(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies, responses (frequency, response, reference) and coherence."""
    lines = int(random.integers(3, 30))
    sensors, points = int(random.integers(1, 5)), int(random.integers(1, 5))
    if chance(random, 0.1):
        sensors = lines
    shape = (lines, sensors, points)
    step = pick(random, 0.5, 1.0, 2.0, 3.125)
    values = random.standard_normal(shape) + 1j * random.standard_normal(shape)
    return step * np.arange(1, lines + 1), values, random.uniform(0.01, 1.0, shape)


def by_pair(
    table: np.ndarray, sensors: list[str], points: list[str], factor: float = 1.0
) -> dict[tuple[str, str], np.ndarray]:
    """Of an array (frequency, response, reference)."""
    return {
        (sensor, point): table[:, i, j] * factor
        for i, sensor in enumerate(sensors)
        for j, point in enumerate(points)
    }
