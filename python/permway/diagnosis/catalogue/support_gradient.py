"""A layer that grows stiffer from one end of the structure to the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_factors
from permway.diagnosis.catalogue._roles import beds, laws_of, layers, pads
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.joints import GROUND

ID = "support_gradient"
DOMAIN: Domain = "path"
FAMILY = "uneven support"
SUMMARY = (
    "The stiffness of a layer changes linearly along the structure, by a ratio from its first joint to its last; "
    "beyond, it goes on as at the ends, or is as it was."
)
PARAMETERS = {"ratio": "1, 0.13 to 8: stiffness at the end over that at the start, the mean unchanged"}
SIGNATURE = "Responses at one end of the structure as of a stiffer layer, at the other as of a softer one."
CONFUSED_WITH = {
    "support_scatter": "hammer points at many fasteners",
    "bearing_stiffness": "responses of the girder only",
}
SOURCE = "Dahlberg (2010), Int. J. Civil Engineering 8: railway track stiffness variations"
FEWEST = 5


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For each law of pads and beds, over its joints on the structure; two if it has others beyond."""
    line = situation.campaign.model.line
    every = layers(line)
    for law in laws_of([*pads(line), *beds(line)]):
        mine = [layer for layer in every if layer.law == law]
        carried = [layer for layer in mine if layer.lower != GROUND] or mine
        x = np.unique(np.concatenate([layer.x for layer in carried]))
        if x.size >= FEWEST:
            low, high = float(x.min()), float(x.max())
            yield _of(law, low, high, beyond=True)
            if any(layer.x.min() < low or layer.x.max() > high for layer in mine):
                yield _of(law, low, high, beyond=False)


def _of(law: str, low: float, high: float, *, beyond: bool) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        ratio = values["ratio"]

        def factors(x: Reals) -> Reals:
            along = np.clip((x - low) / (high - low), 0.0, 1.0)
            found = (1.0 + (ratio - 1.0) * along) * 2.0 / (1.0 + ratio)
            return np.asarray(np.where(beyond | ((x >= low) & (x <= high)), found, 1.0))

        return with_factors(campaign, law, factors)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("ratio", "1", 1.0, 1.5),),
        amend=amend,
        locate=lambda _: Where(what=law, x_m=(low, high)),
        starts=((0.7,), (-0.7,)),
        law=lambda v: (
            f"{v['ratio']:.2f} times as stiff at its end as at its start, and beyond "
            f"{'as at the ends' if beyond else 'as before'}"
        ),
        variant="beyond" if beyond else "structure",
        size="ratio",
        none=1.0,
    )
