"""Corrugated rail: more roughness about one wavelength."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.excitation import RoughBand
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._runs import Excess, excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "rail_corrugation"
DOMAIN: Domain = "irregularity"
FAMILY = "tonal roughness"
SUMMARY = "The profile's density times 1 + (g - 1) exp(-x^2/2), x = log2(wavelength/centre)/octaves."
PARAMETERS = {
    "wavelength_m": "m, 0.03 to 3: centre",
    "octaves": "1, 0.01 to 1: one standard deviation of the band",
    "gain_dB": "dB, 0 to 40: 10 lg g, at the centre",
}
SIGNATURE = "A hump of all on-board channels that goes with the speed, coherent at the wheelsets' lags."
CONFUSED_WITH = {
    "wheel_polygon": "a wheel of another diameter, or coherence between wheelsets",
    "irregularity_level": "all wavelengths rise there",
    "parametric_support": "the wavelength is the fasteners' spacing there",
}
SOURCE = "Grassie, Rail corrugation: characteristics, causes, and treatments (2009)"
CENTRE_M, FACTOR = 0.4, 2.0


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At the wavelengths that stand out at every speed, narrow and wide."""
    runs = excesses(situation)
    if not runs:
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        added = RoughBand(
            wavelength_m=values["wavelength_m"], octaves=values["octaves"], gain_dB=values["gain_dB"]
        )
        return with_irregularity(campaign, bands=(*campaign.stated.irregularity.bands, added))

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("wavelength_m", "m", CENTRE_M, FACTOR),
            log_free("octaves", "1", 0.1, 2.0, lowest=0.01),
            between_free("gain_dB", "dB", 0.0, 40.0),
        ),
        amend=amend,
        locate=stays("rail"),
        starts=tuple(_starts(runs)),
        law=lambda v: (
            f"{v['gain_dB']:.3g} dB more about {v['wavelength_m']:.3g} m, over {v['octaves']:.2g} octaves"
        ),
        size="gain_dB",
    )


def _starts(runs: list[Excess]) -> Iterator[tuple[float, float, float]]:
    """About the wavelengths, of those all runs hold, where most is left: over a line, and over a wider band."""
    low = max(run.speed / run.frequency_Hz[-1] for run in runs)
    high = min(run.speed / run.frequency_Hz[0] for run in runs)
    if not low < high:
        low, high = (run_end(runs[0]) for run_end in (_shortest, _longest))
    # One line of a run is one wavelength.
    wavelengths = np.geomspace(low, high, 400) if low < high else np.array([low])
    per_octave = 399.0 / np.log2(high / low) if low < high else 0.0
    shown = np.array([np.interp(-np.log(wavelengths), np.log(r.frequency_Hz / r.speed), r.neper) for r in runs])
    lowest: Reals = shown.min(axis=0)
    for octaves, z in ((0.04, -1.0), (0.25, 1.0)):
        count = max(1, round(octaves * per_octave))
        smooth = np.convolve(np.pad(lowest, count, "edge"), np.ones(count) / count, "same")[count:-count]
        best = wavelengths[int(np.argmax(smooth))]
        yield float(np.log(best / CENTRE_M) / np.log(FACTOR)), z, -0.7
        yield float(np.log(best / CENTRE_M) / np.log(FACTOR)), z, -1.5


def _shortest(run: Excess) -> float:
    return run.speed / float(run.frequency_Hz[-1])


def _longest(run: Excess) -> float:
    return run.speed / float(run.frequency_Hz[0])
