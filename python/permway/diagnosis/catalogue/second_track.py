"""A second track on the girder that the model leaves out: mass, part of it on its own springs.

What is fixed to the girder is part of its mass per metre, as its density is: at stations, of whatever spacing, it
would move short waves by some 1e-4, and so seem to be distinguished from the density.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._attached import spread_over
from permway.diagnosis.catalogue._change import attached_mass, with_fields
from permway.diagnosis.catalogue._roles import girders
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.bodies import Beam

ID = "second_track"
DOMAIN: Domain = "path"
FAMILY = "girder"
SUMMARY = "A mass per metre on the girder, and another that stands on springs of one frequency."
PARAMETERS = {
    "mass_kg_per_m": "kg/m, 47 to 48000: of the second track below its springs, the model's share",
    "sprung": "1, 0.002 to 9: mass on springs over that",
    "frequency_Hz": "Hz, 10 to 1500: of the mass on springs",
    "loss_factor": "1, 0.0144 to 1.57: of its springs",
}
SIGNATURE = (
    "All bending frequencies of the girder fall by one factor, beyond what its density may; around the other "
    "track's own frequency a dip and a peak at all places."
)
CONFUSED_WITH = {
    "girder_local_modes": "a sensor on the other track",
    "girder_crack": "frequencies fall each by its own factor there",
}
SOURCE = "EN 1991-1-1, annex A: permanent load of tracks; Fryba, Dynamics of Railway Bridges (1996)"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of girders."""
    for name in girders(situation.campaign.model.line):
        yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        mass, sprung = values["mass_kg_per_m"], values["sprung"]
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        dense = beam.density_kg_per_m3 * (1.0 + mass / beam.mass_kg_per_m)
        law = attached_mass(mass * sprung, values["frequency_Hz"], values["loss_factor"])
        return spread_over(with_fields(campaign, name, density_kg_per_m3=dense), name, {"second_rails": law})

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("mass_kg_per_m", "kg/m", 1500.0, 2.0),
            log_free("sprung", "1", 0.15, 2.5),
            log_free("frequency_Hz", "Hz", 120.0, 1.65),
            log_free("loss_factor", "1", 0.15, 1.6),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=tuple((mass, -0.3, z, 0.0) for mass in (-3.0, -1.5, 0.0, 1.0) for z in (-1.6, -0.8, 0.0, 0.8)),
        law=lambda v: (
            f"{v['mass_kg_per_m']:.3g} kg/m more, and {v['sprung']:.2g} times that on springs at "
            f"{v['frequency_Hz']:.3g} Hz"
        ),
        size="mass_kg_per_m",
        none=0.0,
    )
