"""A bearing in which a beam's end does not turn freely, as of a roller that is stuck."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_fields, with_line
from permway.diagnosis.catalogue._roles import is_rail
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.laws import Hysteretic
from permway.model.bodies import Beam

ID = "bearing_rotation"
DOMAIN: Domain = "path"
FAMILY = "bearing and pier"
SUMMARY = "A beam's pinned end, or both, turns against a spring."
PARAMETERS = {"stiffness": "N m/rad, 0.0003 to 3000 times E I / L: against rotation"}
SIGNATURE = "Less deflection and strain over the whole span, most near the bearing, where strain changes sign."
CONFUSED_WITH = {"bearing_stiffness": "the end itself moves", "girder_crack": "strain beside the place"}
SOURCE = "Fryba, Dynamics of Railway Bridges (1996), section 2.1: beams clamped elastically at their ends"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each end of every row of beams that is pinned, and one for both."""
    line = situation.campaign.model.line
    for name, body in line.bodies.items():
        if not isinstance(body, Beam) or is_rail(name) or body.intervals_m is None:
            continue
        free = [s for s in (0, 1) if body.pinned[s] and not body.clamped[s] and body.rotation_laws[s] is None]
        start, stop = body.intervals_m[0]
        typical = abs(body.bending_Nm2) / (stop - start)
        for sides in ((0,), (1,), (0, 1)):
            if set(sides) <= set(free):
                yield _of(name, sides, (start, body.intervals_m[-1][1]), typical)


def _of(name: str, sides: tuple[int, ...], ends_m: tuple[float, float], typical: float) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        if not values["stiffness"]:
            return campaign
        line = campaign.model.line
        law = fresh("rotation", line.laws)
        body = line.bodies[name]
        assert isinstance(body, Beam)
        own = tuple(law if side in sides else before or "" for side, before in enumerate(body.rotation_laws))
        campaign = with_line(campaign, laws={**line.laws, law: Hysteretic(stiffness=values["stiffness"])})
        return with_fields(campaign, name, rotation_law=own)

    place = ends_m[sides[0]], ends_m[sides[-1]]
    words = {(0,): "left end", (1,): "right end", (0, 1): "both ends"}[sides]
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("stiffness", "N m/rad", typical, 5.0),),
        amend=amend,
        locate=lambda _: Where(what=name, x_m=place),
        starts=((-0.5,), (0.5,)),
        law=lambda v: f"{v['stiffness']:.3g} N m/rad against rotation, {words}",
        size="stiffness",
        none=0.0,
        variant=words,
    )
