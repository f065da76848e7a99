"""Girders that turn and shear as they bend, where the model has Euler's beam."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._roles import girders
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.model.bodies import Beam

ID = "girder_shear"
DOMAIN: Domain = "path"
FAMILY = "girder"
SUMMARY = "Rotary inertia and shear of the girder (Timoshenko), its bending stiffness and mass as they are."
PARAMETERS = {
    "turning": "1, 0.13 to 7.6: of the rotary inertia of the section that the model has",
    "shear": "1, 0 to 12: E over kappa G; 0 turns alone, 3 is a solid section, 6 to 10 a box",
}
SIGNATURE = "Bending frequencies fall, the n-th by n^2 times what the first does; the first hardly."
CONFUSED_WITH = {
    "girder_crack": "falls that do not grow with n^2, and one place",
    "girder_local_modes": "a dip and a peak about one frequency",
}
SOURCE = "Timoshenko (1921), Phil. Mag. 41, 744-746; Cowper (1966), J. Applied Mechanics 33, 335-340"

LEAST, MOST = 1e-3, 12.0
"""Of E over kappa G. The least has the shear's share of the fall at a thousandth of the turning's."""

RIGHT = 0.02
"""Share of a bending frequency by which Euler's beam may be off where it is still called right: that is what the
tolerance of a concrete's modulus, 4 %, makes of it."""

SPREAD = 1.5
"""Factor within which a section of one stiffness and mass has the rotary inertia that the model's I and density
say: halves of girders are condensed, and ballast turns along."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of Euler girders."""
    line = situation.campaign.model.line
    for name in girders(line):
        beam = line.bodies[name]
        if isinstance(beam, Beam) and beam.theory == "euler":
            yield _of(name, beam)


def _of(name: str, euler: Beam) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        if values["turning"] == 0.0:
            return campaign
        # The same E I by another I: rotary inertia is density times I.
        modulus = beam.youngs_modulus_Pa / values["turning"]
        return with_fields(
            campaign,
            name,
            theory="timoshenko",
            youngs_modulus_Pa=modulus,
            second_moment_m4=beam.second_moment_m4 * values["turning"],
            shear_modulus_Pa=modulus,
            shear_coefficient=1.0 / max(values["shear"], LEAST),
            modes=None,
        )

    radius = float(np.sqrt(euler.second_moment_m4 / euler.area_m2))
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("turning", "1", 1.0, SPREAD), between_free("shear", "1", 0.0, MOST)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.0, -1.8), (0.0, -0.4), (0.0, 0.7)),
        law=lambda v: _words(euler, radius * v["turning"] ** 0.5, v["shear"]),
        size="turning",
        none=0.0,
    )


def _words(euler: Beam, radius_m: float, shear: float) -> str:
    return (
        f"the girder turns (radius of gyration {radius_m:.2g} m) and shears (E/kappa G {shear:.2g}) as it bends; "
        f"without both its bending frequencies are right to {100.0 * RIGHT:g} % up to "
        f"{trusted_Hz(euler, radius_m, shear):.2g} Hz"
    )


def trusted_Hz(euler: Beam, radius_m: float, shear: float) -> float:
    """Up to where the bending frequencies of Euler's beam are right.

    Those of waves of wavenumber k are too high by k^2 r^2 (1 + E/(kappa G)) / 2, to the first order.
    """
    squared = 2.0 * RIGHT / (radius_m**2 * (1.0 + shear))
    return float(squared * np.sqrt(euler.bending_Nm2.real / euler.mass_kg_per_m) / (2.0 * np.pi))
