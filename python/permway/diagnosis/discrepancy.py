"""Calibration with a Gaussian process for what the model lacks, output by output: a rival of the diagnosis.

After Kennedy and O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63 (2001): what is measured
is the model at its parameters, a discrepancy that is smooth over the logarithm of frequency, and noise. Every pair
of sensor and point, and every channel of a run, has a discrepancy of its own, all of a kind of one size, which is
learnt. Whether there is one is told by the evidence with it and without; where, by the sensor that has most; what
it is, nothing tells.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit
from permway.diagnosis.recalibrate import recalibrate
from permway.recordings.channel import Sensor

FIRST, SMALLEST, LARGEST = 0.05, 1e-4, 1.0
"""Size of a discrepancy that learning begins with, and bounds, neper."""

ROUNDS = 3
"""Fits, each with sizes that the one before has told."""

ASIDE_M = 2.0
"""To either side of a sensor is where its discrepancy is said to be."""


@dataclass(frozen=True)
class Discrepancy:
    """What such a calibration finds.

    Attributes
    ----------
    gain : float
        Of twice the log evidence over a calibration without a discrepancy, the sizes' own parameters paid for.
    sensor : Sensor
        The one with most of it, over what its noise is.
    """

    gain: float
    sensor: Sensor

    @property
    def place(self) -> Mapping[str, object]:
        """As a verdict has it."""
        x = self.sensor.x_m
        stretch = None if x is None else [x - ASIDE_M, x + ASIDE_M]
        return {"x": stretch, "channels": [self.sensor.name] if x is None else []}


def discrepancy(without: Fit) -> Discrepancy:
    """Hold a calibration with a discrepancy against one without.

    Parameters
    ----------
    without : Fit
        A calibration on records whose errors are independent from line to line.
    """
    evidence, fit = _sized(without.evidence, FIRST, FIRST), without
    for _ in range(ROUNDS):
        fit = recalibrate(evidence, start=fit.z, learn=False, reweigh=False)
        evidence = _learnt(fit)
    kinds = len({isinstance(block, FrfBlock) for block in evidence.blocks})
    asked = kinds * float(np.log(max(2, fit.deviations.size // 2)))
    return Discrepancy(without.objective - fit.objective - asked, _most(without))


def _sized(evidence: Evidence, pair: float, channel: float) -> Evidence:
    blocks: list[Block] = [b.with_pair(pair) if isinstance(b, FrfBlock) else b for b in evidence.blocks]
    sizes = {n: channel if n.startswith("channel ") else size for n, size in evidence.sizes.items()}
    return replace(evidence, blocks=tuple(blocks)).with_sizes(sizes)


def _learnt(fit: Fit) -> Evidence:
    """Sizes as the coefficients of the last fit tell them."""
    evidence, block_of = fit.evidence, fit.evidence.block_of
    pairs = [
        block.learnt_pair(fit.clean[block_of == index], SMALLEST, LARGEST)
        for index, block in enumerate(evidence.blocks)
        if isinstance(block, FrfBlock)
    ]
    whitener = evidence.whitener
    coefficients, told = whitener.explained(fit.deviations), 1.0 - whitener.variances()
    channels = [i for i, origin in enumerate(whitener.columns.origins) if origin.name.startswith("channel ")]
    mine = np.isin(whitener.of_origin(), channels)
    old = next((s for n, s in evidence.sizes.items() if n.startswith("channel ")), FIRST)
    power = float(np.sum(coefficients[mine] ** 2)) * old**2 / max(float(told[mine].sum()), 1e-12)
    channel = float(np.clip(np.sqrt(power), SMALLEST, LARGEST)) if mine.any() else FIRST
    return _sized(evidence, float(np.mean(pairs)) if pairs else FIRST, channel)


def _most(fit: Fit) -> Sensor:
    """The sensor whose rows are missed by most, over their noise."""
    rows, square = fit.evidence.rows, _mean_square(fit)
    names = [name for name in dict.fromkeys(rows.sensor) if name in {s.name for s in fit.campaign.said.sensors}]
    return fit.campaign.sensor(str(max(names, key=lambda name: square[name])))


def _mean_square(fit: Fit) -> dict[str, float]:
    rows = fit.evidence.rows
    deviations: Reals = fit.deviations**2
    return {str(name): float(deviations[rows.sensor == name].mean()) for name in dict.fromkeys(rows.sensor)}
