"""Fasteners that differ along the track, smoothly from one to the next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_factors
from permway.diagnosis.catalogue._roles import laws_of, pads
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free
from permway.model.joints import GROUND

ID = "support_scatter"
DOMAIN: Domain = "path"
FAMILY = "uneven support"
SUMMARY = (
    "The logarithm of the pads' stiffness is a sum of cosines of 1 to 4, or to 10, half waves over the structure."
)
PARAMETERS = {
    f"wave{order}": f"1, -1.2 to 1.2: coefficient of {order} half wave{'s' if order > 1 else ''}"
    for order in range(1, 11)
}
SIGNATURE = "Responses of the rail differ from place to place as of softer and stiffer pads, with no place apart."
CONFUSED_WITH = {
    "support_gradient": "all but the first coefficient are small there",
    "fastener_loss": "hammer points at every fastener nearby",
}
SOURCE = "Wu and Thompson (2000), Acta Acustica 86, 313-321; Oscarsson (2002), Vehicle System Dynamics 37, 59-79"
FEW, MANY = tuple(range(1, 5)), tuple(range(1, 11))
"""Half waves: of what changes slowly along the structure, and of what changes within some metres."""

SPREADS = (0.25, 0.03, 0.004)
"""Standard deviation of coefficients, which are of one unknown size. By one that is half of it, or four times as
much, a coefficient loses 1 nat: that is as far as any between 0.003 and 0.5 is from one of these."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of pads, over the structure."""
    found = pads(situation.campaign.model.line)
    for law in laws_of(found):
        mine = [layer for layer in found if layer.law == law]
        carried = [layer for layer in mine if layer.lower != GROUND] or mine
        x = np.unique(np.concatenate([layer.x for layer in carried]))
        for orders in (FEW, MANY):
            # Of as many waves as there are pads some are the others again.
            if x.size > len(orders):
                for spread in SPREADS:
                    yield _of(law, x, orders, spread)


def _of(law: str, at: Reals, orders: tuple[int, ...], spread: float) -> Hypothesis:
    """Over the stations at some places, begun from one wave at a time, up and down."""
    low, high = float(at[0]), float(at[-1])

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        def factors(x: Reals) -> Reals:
            along = np.pi * (x - low) / (high - low)
            inside = (x >= low - 1e-6) & (x <= high + 1e-6)
            waves = sum(values[f"wave{order}"] * np.cos(order * along) for order in orders)
            return np.asarray(np.where(inside, np.exp(waves), 1.0))

        return with_factors(campaign, law, factors)

    starts = tuple(tuple(sign * float(o == order) for o in orders) for order in orders for sign in (1.5, -1.5))
    # Ten that are as large as can be make a factor of e to the power of twelve.
    most = 2.0 if orders is FEW else 1.2
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=tuple(linear_free(f"wave{order}", "1", 0.0, spread, -most, most) for order in orders),
        amend=amend,
        locate=lambda _: Where(what=law, x_m=(low, high)),
        starts=starts,
        variant=f"{len(orders)} waves of {spread:g}",
        law=lambda v: _words([v[f"wave{order}"] for order in orders]),
    )


def _words(waves: Sequence[float]) -> str:
    terms = " ".join(f"{wave:+.2g} cos({order} pi x/L)" for order, wave in enumerate(waves, start=1))
    return f"pads differ by a factor of e to the power of {terms}"
