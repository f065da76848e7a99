"""The pads are stiffer in the cold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.diagnosis.catalogue._pads import factors, measured_under, pad_laws, scaled, with_factors
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.recordings.campaign import Campaign
from permway.recordings.predict.hammer import temperature

ID = "pad_temperature"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = "Stiffness k exp(-a (T - T0)), loss factor eta exp(-q a (T - T0)); T0 is the model's temperature."
PARAMETERS = {
    "softening_per_K": "1/K, -0.02 to 0.1: a",
    "reference_factor": "1, 0.4 to 2.5: stiffness at T0 over the base's, which fits all temperatures at once",
    "loss_ratio": "1, -2 to 5: q, of the loss factor's logarithm over the stiffness's",
}
SIGNATURE = "All channels from the rail, all pads alike; records at two temperatures ask for two stiffnesses."
CONFUSED_WITH = {
    "pad_frequency": "the same at all temperatures, and grows from the frequency that the constant was fitted at",
    "pad_preload": "differs between hammer and train at one temperature",
}
SOURCE = "Ferry, Viscoelastic Properties of Polymers (1980), chapter 11; seed paper, equations (21) and (27)"


def _temperatures(campaign: Campaign) -> dict[str, float]:
    """By condition, where known."""
    known = {c.name: temperature(campaign, c) for c in measured_under(campaign)}
    return {name: t for name, t in known.items() if t is not None}


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for all pads whose law knows no temperature, if there are records at two or more."""
    names = pad_laws(situation.campaign.model.line)
    if not names or len(set(_temperatures(situation.campaign).values())) < 2:
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        campaign = scaled(campaign, names, values["reference_factor"])
        line, known = campaign.model.line, _temperatures(campaign)
        reference = campaign.model.temperature_C
        if reference is None:
            reference = float(np.mean(list(known.values())))
        changed = {}
        for condition, t in known.items():
            stiffer = -values["softening_per_K"] * (t - reference)
            ratio, loss = float(np.exp(stiffer)), float(np.exp(values["loss_ratio"] * stiffer))
            changed[condition] = {p: f for law in names for p, f in factors(line, law, ratio, loss).items()}
        return with_factors(campaign, changed)

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            linear_free("softening_per_K", "1/K", 0.008, 0.012, -0.02, 0.1),
            log_free("reference_factor", "1", 1.0, 1.2),
            linear_free("loss_ratio", "1", 0.7, 0.7, -2.0, 5.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=", ".join(names)),
        starts=((0.0, 0.0, 0.0), (0.0, -1.0, 0.0), (1.5, -2.0, 0.0)),
        law=lambda v: f"{100.0 * (np.exp(10.0 * v['softening_per_K']) - 1.0):.0f} % stiffer for every 10 K colder",
        size="softening_per_K",
        none=0.0,
    )
