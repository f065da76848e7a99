"""A sliding layer that sticks or slips: another stiffness, and the loss of rubbing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import constant_law, with_law
from permway.diagnosis.catalogue._roles import beds, laws_of, slabs
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.laws import Hysteretic

ID = "sliding_friction"
DOMAIN: Domain = "path"
FAMILY = "interlayer"
SUMMARY = (
    "Equivalent linear friction: stiffness k p with the added loss factor c (1 - p) where it slips, p below 1."
)
PARAMETERS = {
    "stiffness_factor": "1, 0.004 to 240: p, of the stiffness as modelled; below 1 it slips, above it sticks",
    "rubbing": "1, 0 to 1.3: c, loss factor of full slip",
}
SIGNATURE = (
    "Responses of what lies above the layer against what lies below; with stronger blows or heavier trains the "
    "stiffness falls and the loss changes."
)
CONFUSED_WITH = {
    "layer_damping": "tests at two amplitudes",
    "mortar_void": "the effect is of one place there",
}
SOURCE = "Caughey (1960), J. Applied Mechanics 27, 640-643: sinusoidal excitation with bilinear hysteresis"
FULL_SLIP = 1.3
"""4/pi: friction's loss over the stiffness that is left, at the amplitude of half slip."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each hysteretic law of a bed that lies below another bed."""
    line = situation.campaign.model.line
    above = slabs(line)
    for name in laws_of([bed for bed in beds(line) if above and bed.upper not in above]):
        if isinstance(line.laws[name], Hysteretic):
            yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        law = constant_law(campaign, name)
        left = values["stiffness_factor"]
        loss = law.eta + values["rubbing"] * max(0.0, 1.0 - left)
        return with_law(campaign, name, Hysteretic(stiffness=law.stiffness * left, loss_factor=loss))

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("stiffness_factor", "1", 1.0, 3.0), between_free("rubbing", "1", 0.0, FULL_SLIP)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((-1.0, 0.0), (0.7, 0.0)),
        law=lambda v: (
            f"{v['stiffness_factor']:.2g} of the stiffness, loss factor higher by "
            f"{v['rubbing'] * max(0.0, 1.0 - v['stiffness_factor']):.2g}"
        ),
        size="stiffness_factor",
        none=1.0,
    )
