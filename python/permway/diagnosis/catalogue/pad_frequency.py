"""The pad relaxes: its stiffness and loss depend on frequency."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.laws import FractionalKelvinVoigt
from permway.recordings.campaign import Campaign

ID = "pad_frequency"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = "A springpot beside a spring: k (1 - s) + k s (i f / f0)^a, f0 = 60 Hz, for the constant stiffness k."
PARAMETERS = {
    "stiffness_factor": "1, 0.5 to 2: stiffness at 60 Hz over the constant one",
    "order": "1, 0.02 to 0.8: order a of the springpot",
    "share": "1, 0.05 to 0.95: share s of the springpot",
}
SIGNATURE = (
    "All channels from the rail, all pads alike; grows with distance from the frequency that the constant was "
    "fitted at; the same at all speeds; moves with temperature."
)
CONFUSED_WITH = {
    "pad_temperature": "hammer tests at two temperatures",
    "layer_damping": "phase above 200 Hz, where a dashpot's loss keeps rising",
    "pad_preload": "tests with and without a standing vehicle",
}
SOURCE = "Bagley and Torvik (1983); seed paper, equations (17) to (22)"
REFERENCE_HZ = 60.0


def _at(name: str, _: Mapping[str, float]) -> Where:
    return Where(what=name)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law between a rail and what lies below that is constant."""
    line = situation.campaign.model.line
    laws = dict.fromkeys(layer.law for layer in line.joints if layer.between[0].split("[")[0] == "rail")
    for name in laws:
        if line.laws[name].type != "hysteretic":
            continue

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            law = campaign.model.line.laws[name]
            stiffness = float(law.complex(np.array([REFERENCE_HZ]), None)[0].real) * values["stiffness_factor"]
            order, share = values["order"], values["share"]
            # At f0 the real parts add up to the stiffness.
            coefficient = stiffness * share / np.cos(0.5 * np.pi * order) * (2.0 * np.pi * REFERENCE_HZ) ** -order
            relaxing = FractionalKelvinVoigt(
                stiffness=stiffness * (1.0 - share), coefficient=float(coefficient), order=order
            )
            return with_law(campaign, name, relaxing)

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(
                log_free("stiffness_factor", "1", 1.0, 1.25),
                between_free("order", "1", 0.02, 0.8),
                between_free("share", "1", 0.05, 0.95),
            ),
            amend=amend,
            locate=partial(_at, name),
            starts=((0.0, -0.6, 0.5),),
            law=lambda v: (
                f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}"
            ),
        )
