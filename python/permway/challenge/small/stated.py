"""What a truth states of a small campaign: effects, parameters, errors, and how much the effects show."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from permway.campaign.campaign import Campaign
from permway.challenge.beams import Complexes, Reals
from permway.challenge.small import errors as measured
from permway.challenge.small.by_model import LINES_HZ, ByModel
from permway.challenge.small.concealed import Concealed
from permway.challenge.small.draws import TIER
from permway.challenge.small.kinds import Chosen, Maker
from permway.challenge.small.layouts import Layout
from permway.challenge.small.places import BLOWS, RUN_S, Tests
from permway.challenge.small.recalibrated import best_deviance
from permway.challenge.small.strength import Blows, Part, Ride, Scale

FEWEST_SENSORS, LEAST_SCATTER = 5, 0.7
"""Sensors of which one can stand out by its noise, and how far the logarithm of their noise, of power, differs at
least: by a factor of 2. At half of it faults of noise count four times as much, at twice a quarter."""


@dataclass(frozen=True)
class Small:
    """A campaign that is drawn, and what it is measured with.

    Attributes
    ----------
    campaign : Campaign
        As its file has it.
    layout : Layout
    tests : Tests
    errors : Errors
    maker : Maker
    scale : Scale
    chosen : list of (Concealed, share, deviance)
    values : mapping of str to float
        True parameters.
    """

    campaign: Campaign
    layout: Layout
    tests: Tests
    errors: measured.Errors
    maker: Maker
    scale: Scale
    chosen: Chosen
    values: Mapping[str, float]

    @property
    def effects(self) -> list[tuple[Concealed, float]]:
        """Effects with their shares."""
        return [(effect, share) for effect, share, _ in self.chosen]

    def deviances(self) -> list[float]:
        """Of all effects together, and of each alone if there are several, against the best recalibrated base."""
        groups = [self.effects] + ([[one] for one in self.effects] if len(self.effects) > 1 else [])
        return [self._deviance(group) for group in groups] if self.effects else [0.0]

    def _deviance(self, effects: list[tuple[Concealed, float]]) -> float:
        known = list(self.campaign.parameters.known.items())
        # The base is the tool's own for both makers: what a mesh differs by is left out.
        base = ByModel(self.campaign, self.tests, self.layout, self.values)

        def predicted(z: Reals) -> list[Complexes]:
            at = {name: k.value(k.z(self.values[name]) + float(v)) for (name, k), v in zip(known, z, strict=True)}
            return base.at(at)

        parts = parts_of(self.maker.base, self.tests, self.errors, measured.IDEAL)
        found = best_deviance(parts, self.maker.responses(effects), predicted, len(known))
        return found + noise_deviance(self.maker.base[0], noisier(effects))

    def change_dB(self) -> float:
        """Root mean square of what the effects change, level and phase alike, in the record most changed."""
        changed = zip(self.maker.responses(self.effects), self.maker.base, strict=True)
        each = [np.log(one / other) if one.ndim == 4 else _powers(one, other) for one, other in changed]
        return max(float(np.sqrt(np.mean(np.abs(one) ** 2))) / measured.NEPER_PER_DB for one in each)


def _powers(one: Complexes, other: Complexes) -> Reals:
    """Logarithm of the ratio of amplitudes of channels, from spectral densities (F, channels, channels)."""
    ratio = np.einsum("fcc->fc", one).real / np.einsum("fcc->fc", other).real
    return np.asarray(0.5 * np.log(ratio))


def parts_of(base: list[Complexes], tests: Tests, errors: measured.Errors, relative: float) -> list[Part]:
    """Records with their noise, and so large a relative error of every line."""
    noise = noise_of(base[0], errors, np.ones(len(tests.sensors)))
    sigma = np.sqrt(noise[..., None] ** 2 / BLOWS + (relative * np.abs(base[0])) ** 2)
    functions = measured.root(tests.frequency_Hz, errors.length_octaves)
    parts: list[Part] = [Blows(base[0], sigma, functions, (errors.size("sensor"), errors.size("force")))]
    if tests.speed_m_per_s is not None:
        functions = measured.root(LINES_HZ, errors.length_octaves)
        parts.append(Ride(base[1], RUN_S, functions, errors.size("sensor")))
    return parts


def noise_of(base: Complexes, errors: measured.Errors, factors: Reals) -> Reals:
    """Of a blow, by test, sensor and point."""
    return np.stack([measured.blow_noise(one, errors, factors) for one in base])


def noise_deviance(base: Complexes, factors: Mapping[str, float]) -> float:
    """Of factors on the noise of sensors of hammer tests, by how far sensors' noise differs anyway.

    Nobody states how much noise a sensor has: one shows beside the others alone, if there are five or more.
    """
    if base.shape[1] < FEWEST_SENSORS or not factors:
        return 0.0
    level = np.log(np.median(np.abs(base[0]), axis=-1) ** 2).mean(axis=1)
    scatter = max(LEAST_SCATTER, float(np.std(level)))
    return float(sum(np.log(q) ** 2 for q in factors.values())) / scatter**2


def noisier(effects: list[tuple[Concealed, float]]) -> dict[str, float]:
    """Factors of effects on the power of sensors' noise, by name."""
    factors: dict[str, float] = {}
    for effect, share in effects:
        factors |= effect.noise(share)
    return factors


def truth_of(small: Small, seed: int, index: int, deviance: float) -> dict[str, Any]:
    """The content of a truth file."""
    effects = [copy.deepcopy(effect.truth(share)) for effect, share in small.effects]
    for effect in effects:
        effect["place"]["near_m"] = small.layout.near_m
    return {
        "format": 1,
        "tier": TIER,
        "seed": seed,
        "index": index,
        "maker": small.maker.name,
        "layout": small.layout.name,
        "variant": small.layout.variant,
        "records": {
            "sensors": len(small.tests.sensors),
            "points": len(small.tests.forces),
            "temperatures": len(small.tests.temperatures_C),
            "runs": int(small.tests.speed_m_per_s is not None),
        },
        "errors": {
            "size_dB": small.errors.size_dB,
            "length_octaves": small.errors.length_octaves,
            "noise": small.errors.noise,
        },
        "deviance": round(deviance, 4),
        "change_dB": round(small.change_dB(), 5),
        "linear_deviances": [round(one, 4) for _, _, one in small.chosen],
        "effects": effects,
        "parameters": {name: float(value) for name, value in small.values.items()},
    }
