"""A joint that is stiffer, or softer, the harder it is driven."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._levels import answering, driven
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free

ID = "level_stiffness"
DOMAIN: Domain = "path"
FAMILY = "amplitude"
SUMMARY = "A joint's stiffness times 1 + s (L / L1)^p at level L, L1 the largest; its loss force stays."
PARAMETERS = {
    "change": "1, -0.9 to 10: s",
    "exponent": "1, 0.27 to 15: p, 2 of a cubic spring under noise or at one amplitude",
}
SIGNATURE = "Resonances rise (or fall) from level to level, as wide as before; one level by itself looks linear."
CONFUSED_WITH = {"level_friction": "resonances widen, too", "pad_temperature": "levels in both orders"}
SOURCE = "Worden and Tomlinson, Nonlinearity in Structural Dynamics (2001), chapters 2 and 3"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of joints, if records were taken at several levels."""
    for name in driven(situation):
        yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        def law(level: float) -> tuple[float, float]:
            stiffness = 1.0 + values["change"] * level ** values["exponent"]
            return stiffness, 1.0 / stiffness

        return answering(campaign, name, law) if values["change"] else campaign

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(linear_free("change", "1", 0.0, 0.3, -0.9, 10.0), log_free("exponent", "1", 2.0, 1.5)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.3, 0.0), (-0.3, 0.0)),
        law=lambda v: (
            f"{1.0 + v['change']:.3f} times as stiff at the largest level, by its power {v['exponent']:.2g}"
        ),
        size="change",
        none=0.0,
    )
