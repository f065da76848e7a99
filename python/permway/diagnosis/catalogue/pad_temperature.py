"""The pads are stiffer in the cold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from permway.arrays import ABSOLUTE_ZERO_C
from permway.campaign.campaign import Campaign
from permway.campaign.predictions.hammer import temperature
from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.catalogue._pads import factors, measured_under, pad_laws, scaled, with_factors
from permway.diagnosis.catalogue._relaxing import relaxing, springpot_free
from permway.diagnosis.catalogue._roles import rubbers
from permway.diagnosis.hypothesis import (
    Domain,
    Hypothesis,
    Situation,
    Where,
    linear_free,
    log_free,
)
from permway.laws import TFDV, Arrhenius, Hysteretic
from permway.laws.shift import GAS_CONSTANT

ID = "pad_temperature"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = (
    "Stiffness k exp(-a (T - T0)), loss factor eta exp(-q a (T - T0)); or a springpot beside a spring, "
    "k (1 - s) + k s (i alpha f / f0)^b, f0 = 60 Hz, ln alpha = E / R (1 / T - 1 / T0); T0 is the model's "
    "temperature."
)
PARAMETERS = {
    "softening_per_K": "1/K, -0.02 to 0.1: a",
    "reference_factor": "1, 0.4 to 2.5: stiffness at T0 over the base's, which fits all temperatures at once",
    "loss_ratio": "1, -2 to 5: q, of the loss factor's logarithm over the stiffness's",
    "stiffness_factor": "1, 0.33 to 3.05: stiffness at 60 Hz and T0 over the constant one",
    "order": "1, 0.02 to 0.8: order b of the springpot",
    "share": "1, 0 to 0.98: share s of the springpot",
    "rest": "1, 0 to 1: part of the constant loss that stays beside",
    "decades_per_10K": "1, 0.03 to 11: log10 alpha for the first 10 K below T0",
}
SIGNATURE = "All channels from the rail, all pads alike; records at two temperatures ask for two stiffnesses."
CONFUSED_WITH = {
    "pad_frequency": "the same at all temperatures, and grows from the frequency that the constant was fitted at",
    "pad_preload": "differs between hammer and train at one temperature",
}
SOURCE = (
    "Ferry, Viscoelastic Properties of Polymers (1980), chapter 11; the paper, Insights into Underrail Rubber "
    "Pad's Effect on Vehicle-Track-Viaduct System Dynamics (2021), equations (21) and (27)"
)


def _temperatures(campaign: Campaign) -> dict[str, float]:
    """By condition, where known."""
    known = {c.name: temperature(campaign, c) for c in measured_under(campaign)}
    return {name: t for name, t in known.items() if t is not None}


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Factors on all pads whose law knows no temperature, or a relaxing law's shift, if there are two."""
    names = pad_laws(situation.campaign.model.line)
    if not names or len(set(_temperatures(situation.campaign).values())) < 2:
        return
    yield _stiffer(names)
    line = situation.campaign.model.line
    for name in rubbers(line):
        if isinstance(line.laws[name], Hysteretic):
            yield _shifted(name)


def _reference(campaign: Campaign) -> float:
    """The model's temperature, or the middle of those that were measured at, degC."""
    known = campaign.model.temperature_C
    return float(np.mean(list(_temperatures(campaign).values()))) if known is None else known


def _stiffer(names: Sequence[str]) -> Hypothesis:
    """Stiffness and loss by a factor for each temperature."""

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        campaign = scaled(campaign, names, values["reference_factor"])
        line, reference = campaign.model.line, _reference(campaign)
        changed = {}
        for condition, t in _temperatures(campaign).items():
            stiffer = -values["softening_per_K"] * (t - reference)
            ratio, loss = float(np.exp(stiffer)), float(np.exp(values["loss_ratio"] * stiffer))
            changed[condition] = {p: f for law in names for p, f in factors(line, law, ratio, loss).items()}
        return with_factors(campaign, changed)

    return Hypothesis(
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


def _shifted(name: str) -> Hypothesis:
    """A springpot beside a spring, moved along frequency by temperature."""

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        values, reference = dict(values), _reference(campaign)
        decades = values.pop("decades_per_10K")
        if values["share"] == 0.0:
            return campaign
        campaign = relaxing(campaign, name, **values)
        kelvin = reference - ABSOLUTE_ZERO_C
        shift = Arrhenius(
            activation_energy_J_per_mol=0.1 * decades * GAS_CONSTANT * float(np.log(10.0)) * kelvin**2,
            reference_temperature_C=reference,
        )
        law = campaign.model.line.laws[name]
        return with_law(
            campaign, name, TFDV(law=law, shift=shift, reference_temperature_C=reference, vertical="none")
        )

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(*springpot_free(), log_free("decades_per_10K", "1", 0.6, 1.8)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=(
            (0.0, -0.6, 0.5, -1.0, 0.0),
            (-1.0, -0.6, 0.5, -1.0, 0.8),
            (0.0, -1.2, 1.2, -1.0, 0.0),
            (0.0, 0.2, -0.7, 0.0, 0.0),
        ),
        law=lambda v: (
            f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}, as at "
            f"{v['decades_per_10K']:.2g} decades higher frequency for every 10 K colder"
        ),
        size="share",
        none=0.0,
        variant="shifted",
    )
