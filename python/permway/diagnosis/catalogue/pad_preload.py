"""Pads under load are stiffer: a hammer test without a train finds others than the train does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Condition
from permway.diagnosis.catalogue._pads import factors, measured_under, pad_laws, scaled, with_factors
from permway.diagnosis.catalogue._roles import fasteners, laws_of
from permway.diagnosis.catalogue._under_wheels import pressed
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free

ID = "pad_preload"
DOMAIN: Domain = "path"
FAMILY = "load-dependent pad"
SUMMARY = (
    "A fastener's stiffness under the load L is 1 + (r - 1) L / L0 times that without; L0 is what the one below a "
    "wheel carries of the train's mean, and others less, as the rail spreads it."
)
PARAMETERS = {
    "stiffness_ratio": "1, 0.41 to 3.8: r, stiffness below a wheel over that without load",
    "unloaded_factor": "1, 0.4 to 2.5: stiffness without load over the base's, which fits both at once",
}
SIGNATURE = (
    "Frequency responses by a hammer and spectra on the train ask for different pads; the ratio is the same at "
    "all speeds, and the loss factor stays."
)
CONFUSED_WITH = {
    "pad_amplitude": "softer under the train instead, lossier, and more so at higher speed",
    "pad_temperature": "hammer tests at two temperatures",
    "irregularity_level": "a level moves all on-board channels by one factor at all frequencies",
}
SOURCE = "Wu and Thompson, Journal of Sound and Vibration 219 (1999) 881-904"
LEAST_LEFT = 0.05
"""Of the stiffness, where two wheels together would take more than all."""


def loads(conditions: list[Condition]) -> dict[str, float]:
    """Load under each condition over that of the train: 0 for a hammer alone, 1 for a train."""
    given = [c.load_N for c in conditions if c.kind == "train" and c.load_N]
    mean = sum(given) / len(given) if given else 0.0
    found = {}
    for condition in conditions:
        plain = 1.0 if condition.kind == "train" else 0.0
        found[condition.name] = condition.load_N / mean if condition.load_N is not None and mean else plain
    return found


def _stiffened(share: Reals, more: float) -> Reals:
    return np.maximum(1.0 + more * share, LEAST_LEFT)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for all pads, if records were taken under two loads, as with and without a train."""
    names = pad_laws(situation.campaign.model.line)
    if not names or len(set(loads(measured_under(situation.campaign)).values())) < 2:
        return

    fastened = laws_of(fasteners(situation.campaign.model.line))
    spread = [name for name in names if name in fastened]

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        campaign = scaled(campaign, names, values["unloaded_factor"])
        line, more = campaign.model.line, values["stiffness_ratio"] - 1.0
        conditions = {c.name: c for c in measured_under(campaign)}
        below, alike = {}, {}
        for condition, load in loads(list(conditions.values())).items():
            near = conditions[condition].kind == "train" and campaign.model.train is not None
            if near and more != 0.0:
                below[condition] = partial(_stiffened, more=more * load)
            ratio = 1.0 + more * load
            others = [name for name in names if not (near and name in spread)]
            alike[condition] = {p: f for law in others for p, f in factors(line, law, ratio).items()}
        return with_factors(pressed(campaign, spread, below) if below else campaign, alike)

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("stiffness_ratio", "1", 1.25, 1.25), log_free("unloaded_factor", "1", 1.0, 1.2)),
        amend=amend,
        locate=lambda _: Where(what=", ".join(names)),
        # The base fits the hammer, or the train, or lies between.
        starts=((0.0, 0.0), (0.0, -1.2), (1.0, -2.4), (-1.0, 0.0)),
        law=lambda v: f"{v['stiffness_ratio']:.2f} times as stiff below a wheel as without",
        size="stiffness_ratio",
        none=1.0,
    )
