"""A beam whose loss is viscous where the model has it hysteretic, or the reverse."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._roles import is_rail
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.model.bodies import Beam

ID = "beam_damping"
DOMAIN: Domain = "path"
FAMILY = "damping law"
SUMMARY = (
    "A share of a beam's loss is viscous, with one damping ratio in all modes or as Rayleigh's; or the reverse."
)
PARAMETERS = {
    "share": "1, 0 to 1: share of the loss that goes the other way over frequency",
    "equal_at_Hz": "Hz, about the first bending frequency: where Rayleigh's loss is the constant one",
}
SIGNATURE = (
    "The width of the beam's resonances, and phases between and below them: below the first resonance a viscous "
    "loss vanishes, a hysteretic one does not."
)
CONFUSED_WITH = {
    "layer_damping": "a sensor on either side of the layer",
    "second_track": "frequencies move there, too",
}
SOURCE = (
    "Crandall (1970), J. Sound and Vibration 11, 3-18; Chen and Russell (1982), Q. Applied Mathematics 39, 433-454"
)

Kind = Literal["ratio", "mass", "stiffness", "hysteretic"]

WORDS: dict[Kind, str] = {
    "ratio": "viscous, with one damping ratio in all modes",
    "mass": "viscous in proportion to mass, equal at {equal_at_Hz:.3g} Hz",
    "stiffness": "viscous in proportion to stiffness, equal at {equal_at_Hz:.3g} Hz",
    "hysteretic": "hysteretic, with one loss factor at all frequencies",
}

SPREAD = 2.0
"""Factor about the first bending frequency, one standard deviation: Rayleigh's two terms are set by low modes.
Twice its logarithm costs an effect 0.7 nats at most, half of it gains as much; both act together."""

ALL = 0.995
"""Share that two digits say is all."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For each row of beams other than rails that loses in one way: the other ways."""
    for name, beam in situation.campaign.model.line.bodies.items():
        if not isinstance(beam, Beam) or is_rail(name) or beam.intervals_m is None:
            continue
        if beam.loss_factor > 0.0 and not beam.is_viscous:
            yield from (_of(name, beam, kind) for kind in ("ratio", "mass", "stiffness"))
        elif beam.loss_factor == 0.0 and beam.damping_ratio > 0.0:
            yield _of(name, beam, "hysteretic")


def _of(name: str, stated: Beam, kind: Kind) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        fields = exchanged(beam, kind, values["share"], values.get("equal_at_Hz", 0.0))
        return with_fields(campaign, name, **fields)

    share = linear_free("share", "1", 0.5, 0.5, 0.0, 1.0)
    equal = log_free("equal_at_Hz", "Hz", first_Hz(stated), SPREAD)
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(share, equal) if kind in ("mass", "stiffness") else (share,),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.9, 0.0), (-0.5, 0.0)) if kind in ("mass", "stiffness") else ((0.9,), (-0.5,)),
        law=lambda v: f"{_share(v['share'])} is {WORDS[kind].format(**v)}",
        size="share",
        none=0.0,
        variant=kind,
    )


def _share(share: float) -> str:
    return "all of its loss" if share > ALL else f"{share:.2f} of its loss"


def exchanged(beam: Beam, kind: Kind, share: float, equal_at_Hz: float) -> dict[str, float | None]:
    """Fields of a beam of which a share of the loss is of another kind.

    At a resonance a loss factor of eta is a damping ratio of eta / 2.
    """
    given, omega = share * beam.loss_factor, 2.0 * np.pi * equal_at_Hz
    rest: dict[str, float | None] = {"loss_factor": (1.0 - share) * beam.loss_factor, "modes": None}
    if kind == "hysteretic":
        return {
            "loss_factor": 2.0 * share * beam.damping_ratio,
            "damping_ratio": (1.0 - share) * beam.damping_ratio,
        }
    if kind == "ratio":
        return rest | {"damping_ratio": 0.5 * given}
    if kind == "mass":
        return rest | {"mass_damping_per_s": given * omega}
    return rest | {"stiffness_damping_s": given / omega}


def first_Hz(beam: Beam) -> float:
    """First bending frequency of the first beam of a row on pinned ends."""
    assert beam.intervals_m is not None
    start, stop = beam.intervals_m[0]
    return float(0.5 * np.pi / (stop - start) ** 2 * (beam.bending_Nm2.real / beam.mass_kg_per_m) ** 0.5)
