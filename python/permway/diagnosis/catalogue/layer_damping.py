"""A layer whose loss grows with frequency, as a dashpot's, where the model has it constant; or the reverse."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import constant_loss, with_loss
from permway.diagnosis.catalogue._roles import laws_of, layers, pads
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.errors import InputError
from permway.laws import Hysteretic, KelvinVoigt
from permway.laws.base import Law
from permway.records import type_name

ID = "layer_damping"
DOMAIN: Domain = "path"
FAMILY = "damping law"
SUMMARY = "A share s of a layer's loss is that of a dashpot, eta f / f0, for a constant eta; or the reverse."
PARAMETERS = {
    "share": "1, 0 to 1: share s of the loss that goes the other way over frequency",
    "equal_at_Hz": "Hz, 0.93 to 3860: f0, where both ways are the same loss",
}
SIGNATURE = (
    "All channels that the layer reaches, by phase and by the width of resonances more than by their frequency: "
    "less damped below f0 and more above, or the reverse."
)
CONFUSED_WITH = {
    "pad_frequency": "the stiffness changes, too",
    "sliding_friction": "the loss falls with amplitude there",
}
SOURCE = "Fenander (1997), Proc. IMechE F 211, 51-62; Crandall (1970), J. Sound and Vibration 11, 3-18"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of joints that is hysteretic or a spring beside a dashpot."""
    line = situation.campaign.model.line
    of_pads = laws_of(pads(line))
    for name in laws_of(layers(line)):
        law = line.laws[name]
        if isinstance(law, Hysteretic | KelvinVoigt) and law.stiffness > 0.0 and _loses(law):
            viscous, family = isinstance(law, KelvinVoigt), "pad law" if name in of_pads else FAMILY
            yield _of(name, viscous=viscous, family=family)


def _loses(law: Hysteretic | KelvinVoigt) -> bool:
    return law.eta > 0.0 if isinstance(law, Hysteretic) else law.damping > 0.0


def exchanged(law: Law, share: float, equal_at_Hz: float) -> tuple[Law, Law]:
    """The law less a share of its loss, and that share as the other kind of loss without stiffness."""
    omega = 2.0 * np.pi * equal_at_Hz
    if isinstance(law, Hysteretic):
        kept = Hysteretic(stiffness=law.stiffness, loss_factor=law.eta * (1.0 - share))
        return kept, KelvinVoigt(stiffness=0.0, damping=share * law.stiffness * law.eta / omega)
    if not isinstance(law, KelvinVoigt):
        raise InputError(
            "its loss is not constant or viscous any more", where="line.laws", value=type_name(type(law))
        )
    rest = KelvinVoigt(stiffness=law.stiffness, damping=law.damping * (1.0 - share))
    return rest, constant_loss(share * law.damping * omega)


def _of(name: str, *, viscous: bool, family: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        law = campaign.model.line.laws[name]
        return with_loss(campaign, name, *exchanged(law, values["share"], values["equal_at_Hz"]))

    kinds = ("constant over frequency", "a dashpot's") if viscous else ("a dashpot's", "constant over frequency")
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=family,
        free=(between_free("share", "1", 0.0, 1.0), log_free("equal_at_Hz", "Hz", 60.0, 2.3)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.5, 0.0), (-0.8, 0.0)),
        law=lambda v: (
            f"{v['share']:.2f} of the loss is {kinds[0]}, the rest {kinds[1]}; equal at {v['equal_at_Hz']:.3g} Hz"
        ),
        size="share",
        none=0.0,
    )
