"""Calibration with a Gaussian process for what the model lacks, output by output: a rival of the diagnosis.

After Kennedy and O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63 (2001): what is measured
is the model at its parameters, a discrepancy that is smooth over the logarithm of frequency, and noise. Every pair
of sensor and point, and every channel of a run, has a discrepancy of its own, all of a kind of one size, which is
learnt. Whether there is one is told by the evidence with it and without; where, by the sensor that has most; what
it is, nothing tells.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

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

DB_PER_NEPER = 20.0 / float(np.log(10.0))

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
    pair, channel : float
        Its size in a pair of sensor and point, and in a channel of a run, neper.
    """

    gain: float
    sensor: Sensor
    pair: float
    channel: float

    @property
    def place(self) -> Mapping[str, object]:
        """As a verdict has it."""
        x = self.sensor.x_m
        stretch = None if x is None else [x - ASIDE_M, x + ASIDE_M]
        return {"x": stretch, "channels": [self.sensor.name] if x is None else []}

    def on(self, evidence: Evidence) -> Evidence:
        """Records with errors of a discrepancy's size."""
        return _sized(evidence, self.pair, self.channel)


def beyond(evidence: Evidence, levels: Reals, known: np.ndarray) -> Reals:
    """Levels less what is expected of a discrepancy by those that are known.

    Parameters
    ----------
    evidence : Evidence
        With errors of a discrepancy's size.
    levels : ndarray, shape (n,)
        Measured over predicted, dB.
    known : ndarray of bool, shape (n,)
    """
    rows, left = evidence.rows, levels.copy()
    octaves, there = np.log2(rows.frequency_Hz), np.isfinite(levels) & np.isfinite(rows.scale_dB)
    for mine, size, length in _outputs(evidence):
        told, asked = np.flatnonzero(mine & there & known), np.flatnonzero(mine & there & ~known)
        if told.size and asked.size:
            inner = size**2 * _correlation(octaves[told], octaves[told], length)
            inner[np.diag_indices_from(inner)] += rows.scale_dB[told] ** 2
            weights = linalg.solve(inner, levels[told], assume_a="pos")
            left[asked] -= size**2 * _correlation(octaves[asked], octaves[told], length) @ weights
    return left


def _outputs(evidence: Evidence) -> Iterator[tuple[np.ndarray, float, float]]:
    """Rows of every output, the size of its discrepancy in dB, and the octaves over which it correlates."""
    rows, block_of = evidence.rows, evidence.block_of
    paired = np.isin(block_of, [i for i, b in enumerate(evidence.blocks) if isinstance(b, FrfBlock)])
    for index, block in enumerate(evidence.blocks):
        if isinstance(block, FrfBlock):
            for label in dict.fromkeys(block.rows.channel):
                mine = (block_of == index) & (rows.channel == label)
                yield mine, DB_PER_NEPER * block.pair, 1.0 / FrfBlock.KNOTS_PER_OCTAVE
    # Of a channel one run tells of another.
    for label in dict.fromkeys(rows.channel[~paired]):
        mine = ~paired & (rows.channel == label)
        size = evidence.sizes.get(f"channel {rows.sensor[mine][0]}", 0.0)
        yield mine, DB_PER_NEPER * size, evidence.length


def discrepancy(without: Fit) -> Discrepancy:
    """Hold a calibration with a discrepancy against one without.

    Parameters
    ----------
    without : Fit
        A calibration on records whose errors are independent from line to line.
    """
    pair, channel, fit = FIRST, FIRST, without
    for _ in range(ROUNDS):
        fit = recalibrate(_sized(without.evidence, pair, channel), start=fit.z, learn=False, reweigh=False)
        pair, channel = _learnt(fit)
    evidence = fit.evidence
    kinds = len({isinstance(block, FrfBlock) for block in evidence.blocks})
    asked = kinds * float(np.log(max(2, fit.deviations.size // 2)))
    return Discrepancy(without.objective - fit.objective - asked, _most(without), pair, channel)


def _correlation(one: Reals, other: Reals, length: float) -> Reals:
    return np.asarray(np.exp(-0.5 * ((one[:, None] - other[None, :]) / length) ** 2))


def _sized(evidence: Evidence, pair: float, channel: float) -> Evidence:
    blocks: list[Block] = [b.with_pair(pair) if isinstance(b, FrfBlock) else b for b in evidence.blocks]
    sizes = {n: channel if n.startswith("channel ") else size for n, size in evidence.sizes.items()}
    return replace(evidence, blocks=tuple(blocks)).with_sizes(sizes)


def _learnt(fit: Fit) -> tuple[float, float]:
    """Sizes as the coefficients of the last fit tell them, of pairs and of channels."""
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
    return float(np.mean(pairs)) if pairs else FIRST, channel


def _most(fit: Fit) -> Sensor:
    """The sensor whose rows are missed by most, over their noise."""
    rows, square = fit.evidence.rows, _mean_square(fit)
    names = [name for name in dict.fromkeys(rows.sensor) if name in {s.name for s in fit.campaign.stated.sensors}]
    return fit.campaign.sensor(str(max(names, key=lambda name: square[name])))


def _mean_square(fit: Fit) -> dict[str, float]:
    rows = fit.evidence.rows
    deviations: Reals = fit.deviations**2
    return {str(name): float(deviations[rows.sensor == name].mean()) for name in dict.fromkeys(rows.sensor)}
