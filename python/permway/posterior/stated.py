"""What is stated wrongly: a nominal parameter that is farther off than its tolerance says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.campaign.parameters import Known
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where
from permway.diagnosis.verdict_words import STATED

ID = STATED
DOMAIN: Domain = "path"
FAMILY = "stated value"
SUMMARY = "A nominal parameter is farther from its stated value than its tolerance says."
PARAMETERS = {"deviations": "1: standard deviations by which the stated value is off"}
SIGNATURE = "All records at once, as a change of that parameter has it."
CONFUSED_WITH = {"support_scatter": "hammer points at every fastener"}
SOURCE = "Kennedy and O'Hagan (2001), J. R. Stat. Soc. B 63, 425-464, section 2"

WIDER = 5.0
"""Standard deviation of how far off a wrongly stated value is, in standard deviations of its tolerance. Twice as
much lowers the evidence of a wrong value by at most ln 2 nats."""

STARTS = (-1.0, 1.0)
"""Where a fit begins, in standard deviations of that."""


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """One for each nominal parameter."""
    for known in situation.campaign.parameters.known.values():
        paths = known.parameter.paths
        first = paths[0] if isinstance(paths, tuple) else paths
        yield _of(known, _domain(first))


hypotheses = everywhere


def _of(known: Known, domain: Domain) -> Hypothesis:
    name = known.name

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        # The nominal parameter itself is moved, before the campaign is built.
        del values
        return campaign

    return Hypothesis(
        entry=ID,
        domain=domain,
        family=FAMILY,
        free=(Free("deviations", "1", lambda z: WIDER * z, (-8.0, 8.0)),),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=tuple((start,) for start in STARTS),
        law=lambda v: _words(known, v["deviations"]),
        size="deviations",
        none=0.0,
        variant=name,
        moves=name,
    )


PREFIXED = ("N", "Pa")
"""Beginnings of units that engineers write with kilo, mega and giga."""


def _words(known: Known, deviations: float) -> str:
    """As an engineer says it: the value, how far it is from the stated one, and in standard deviations."""
    value, unit = known.value(deviations), known.parameter.unit
    far = "below " if value < known.nominal else "above "
    if known.nominal > 0.0:
        far = f"{100.0 * abs(value / known.nominal - 1.0):.0f} % {far}"
    return (
        f"about {_size(value, unit, '#.3g')}, {far}the stated {_size(known.nominal, unit, '.3g')}, "
        f"{abs(deviations):.1f} standard deviations of its tolerance"
    )


def _size(value: float, unit: str, digits: str) -> str:
    """With the unit: 21.0 MN/m to three digits, and 30 MN/m as it may have been stated."""
    if unit.startswith(PREFIXED):
        for prefix, factor in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
            if abs(value) >= factor:
                return f"{value / factor:{digits}}".rstrip(".") + f" {prefix}{unit}"
    return f"{value:.3g}" + ("" if unit == "1" else f" {unit}")


def _domain(path: str) -> Domain:
    if path.startswith("train"):
        return "vehicle"
    if path.startswith(("irregularity", "campaign.irregularity")):
        return "irregularity"
    return "measurement" if path.startswith("campaign") else "path"
