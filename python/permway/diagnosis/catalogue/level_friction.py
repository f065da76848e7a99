"""A joint that slips: it loses more, and is softer, the harder it is driven."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._levels import answering, driven
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free

ID = "level_friction"
DOMAIN: Domain = "path"
FAMILY = "amplitude"
SUMMARY = (
    "At level L, L1 the largest, a joint's loss times 1 + q (L / L1)^p, its stiffness times 1 - s (L / L1)^p."
)
PARAMETERS = {
    "growth": "1, 0.01 to 98: q",
    "softening": "1, 0 to 0.8: s",
    "exponent": "1, 0.03 to 32: p",
}
SIGNATURE = "Resonances widen from level to level, and mostly fall a little; one level by itself looks linear."
CONFUSED_WITH = {"level_stiffness": "resonances as wide as before"}
SOURCE = "Segalman, J. Applied Mechanics 72 (2005) 752-760: dissipation of bolted joints by a power of the force"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of joints, if records were taken at several levels."""
    for name in driven(situation):
        yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        def law(level: float) -> tuple[float, float]:
            share = level ** values["exponent"]
            return 1.0 - values["softening"] * share, 1.0 + values["growth"] * share

        return answering(campaign, name, law) if values["growth"] else campaign

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("growth", "1", 1.0, 2.5),
            linear_free("softening", "1", 0.0, 0.1, 0.0, 0.8),
            log_free("exponent", "1", 1.0, 2.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.0, 0.0, 0.0), (0.0, 0.3, 0.5)),
        law=lambda v: (
            f"at the largest level {1.0 + v['growth']:.2f} times the loss, "
            f"{1.0 - v['softening']:.3f} of the stiffness"
        ),
        size="growth",
        none=0.0,
    )
