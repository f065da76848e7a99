"""Discrete supports: the rail is stiffer over a fastener than between two."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._excite import rail_laws, stays
from permway.diagnosis.catalogue._interval import spacing_of
from permway.diagnosis.catalogue._lines import FACTOR, coordinate, repeats
from permway.diagnosis.catalogue._runs import combs, excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "parametric_support"
DOMAIN: Domain = "irregularity"
FAMILY = "tied to speed over length"
SUMMARY = (
    "Lines a n^-p at multiples n of V over the fasteners' spacing: the rail's deflection under a constant load as "
    "the wheel passes over fasteners. How the stiffness itself varies under the wheel is left out."
)
PARAMETERS = {
    "amplitude_m": "m, 2.1e-8 to 1.2e-3: a, of the first line",
    "decay": "1, 1 to 5: p",
}
SIGNATURE = (
    "One line of all on-board channels, and weaker multiples, that go with the speed; no frequency response."
)
CONFUSED_WITH = {
    "rail_corrugation": "its wavelength is the fasteners' spacing by chance only; a hump, no line",
    "wheel_polygon": "one wheelset, and another length",
}
SOURCE = "Nordborg, Wheel/rail noise generation due to nonlinear effects and parametric excitation (2002)"
AMPLITUDE_M, HARMONICS = 5e-6, 4


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For the law that holds most of the rail."""
    runs, model = excesses(situation), situation.campaign.model
    if not runs or model.train is None:
        return
    for law in rail_laws(model.line, model.train.body)[:1]:
        spacing = spacing_of(model.line, law)
        (found,) = combs(runs, [1.0 / spacing], harmonics=2, decay=2.0, most=1)
        seen = coordinate(found.amplitude_m, AMPLITUDE_M, FACTOR)
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("amplitude_m", "m", AMPLITUDE_M, FACTOR), between_free("decay", "1", 1.0, 5.0)),
            amend=repeats(spacing, HARMONICS),
            locate=stays(law),
            starts=((seen, -0.5), (seen - 2.0, -0.5)),
            law=lambda v: f"{1e6 * v['amplitude_m']:.3g} um at V over the fasteners' spacing",
            size="amplitude_m",
        )
