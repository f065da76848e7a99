"""Pads that are strained more are softer and lossier: Payne's effect of filled rubber."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._pads import factors, loss_factor, measured_under, pad_laws, scaled, with_factors
from permway.diagnosis.catalogue._roles import fasteners, laws_of
from permway.diagnosis.catalogue._under_wheels import levelled
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free

ID = "pad_amplitude"
DOMAIN: Domain = "path"
FAMILY = "load-dependent pad"
SUMMARY = (
    "Under the train the stiffness falls by s X / (1 + X) and the loss grows by s q 2 sqrt(X) / (1 + X), both "
    "over the stiffness under the hammer; X = a^1.2, a the amplitude, as the speed, and as the rail spreads a "
    "wheel's force."
)
PARAMETERS = {
    "softening": "1, 0 to 0.8: s, share of the stiffness that large amplitudes take",
    "unstrained_factor": "1, 0.4 to 2.5: stiffness under the hammer over the base's, which fits both at once",
    "relative_amplitude": "1, 0.1 to 30: a below a wheel at the train's mean speed, over that where half is taken",
    "loss_share": "1, 0.04 to 2.2: q",
}
SIGNATURE = (
    "Frequency responses by a hammer and spectra on the train ask for different pads: softer and lossier under "
    "the train, and the more so the faster it runs."
)
CONFUSED_WITH = {
    "pad_preload": "stiffer under the train, as lossy, and the same at all speeds",
    "pad_frequency": "both tests show it, at the same frequencies",
}
SOURCE = (
    "Payne, Journal of Applied Polymer Science 6 (1962) 57-63; Kraus, Applied Polymer Symposia 39 (1984) 75-92"
)
EXPONENT = 1.2
"""Of the amplitude, twice Kraus's m."""

LARGEST_LOSS = 4.0
"""Loss factor that no pad exceeds."""


def payne(softening: float, amplitude: float, loss_share: float) -> tuple[float, float]:
    """Stiffness, and loss beside what was there, at an amplitude, over the stiffness at none."""
    strained = amplitude**EXPONENT
    stiffness = 1.0 - softening * strained / (1.0 + strained)
    return stiffness, loss_share * softening * 2.0 * float(np.sqrt(strained)) / (1.0 + strained)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for all pads that have a loss, if there are hammer tests and runs."""
    line = situation.campaign.model.line
    names = [n for n in pad_laws(line) if loss_factor(line, n) > 0.0]
    kinds = {condition.kind for condition in measured_under(situation.campaign)}
    if not names or not {"hammer", "train"} <= kinds:
        return

    fastened = laws_of(fasteners(line))
    spread = [name for name in names if name in fastened]

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        campaign = scaled(campaign, names, values["unstrained_factor"])
        if values["softening"] == 0.0:
            return campaign
        speeds = {c.name: c.speed_m_per_s for c in measured_under(campaign) if c.speed_m_per_s is not None}
        mean = sum(speeds.values()) / len(speeds)
        campaign, levels = levelled(campaign, spread, speeds)
        line = campaign.model.line
        levels |= {name: [(name, 1.0)] for name in names if name not in spread}
        changed: dict[str, dict[str, float]] = {}
        for condition, speed in speeds.items():
            amplitude = values["relative_amplitude"] * speed / mean
            changed[condition] = {}
            for law, share in (one for many in levels.values() for one in many):
                ratio, added = payne(values["softening"], amplitude * share, values["loss_share"])
                before = loss_factor(line, law)
                after = min((before + added) / ratio, LARGEST_LOSS)
                changed[condition].update(factors(line, law, ratio, after / before))
        return with_factors(campaign, changed)

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            between_free("softening", "1", 0.0, 0.8),
            log_free("unstrained_factor", "1", 1.0, 1.2),
            log_free("relative_amplitude", "1", 1.0, 2.0),
            log_free("loss_share", "1", 0.3, 1.5),
        ),
        amend=amend,
        locate=lambda _: Where(what=", ".join(names)),
        starts=((-1.2, 0.0, 0.0, 0.0), (-1.2, 0.5, 0.0, 0.0), (-0.3, 1.0, 0.0, 0.0)),
        law=lambda v: (
            f"{payne(v['softening'], v['relative_amplitude'], v['loss_share'])[0]:.2f} of the stiffness is left "
            "below a wheel at the train's mean speed"
        ),
        size="softening",
        none=0.0,
    )
