"""A base with an effect on top, and an effect with a smaller size."""

from __future__ import annotations

from collections.abc import Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Build, Free
from permway.diagnosis.hypothesis import Hypothesis


def stacked(
    build: Build, hypothesis: Hypothesis, prefix: str, campaign: Campaign | None = None
) -> tuple[Build, tuple[Free, ...]]:
    """A base with an effect on top: from values to the campaign, and the effect's parameters by their new names.

    Parameters
    ----------
    build : callable
        The base's.
    hypothesis : Hypothesis
    prefix : str
        Before the names of the effect's parameters, as "1.": two effects may be of one kind.
    campaign : Campaign, optional
        Whose nominal parameters a hypothesis may move.
    """
    names = {prefix + f.name: f.name for f in hypothesis.free}

    def made(values: Mapping[str, float]) -> Campaign:
        nominal = {k: v for k, v in values.items() if k not in names}
        if hypothesis.moves and campaign is not None:
            known = campaign.parameters.known[hypothesis.moves]
            shift = values[prefix + hypothesis.free[0].name]
            nominal[hypothesis.moves] = known.value(known.z(nominal[hypothesis.moves]) + shift)
        base = build(nominal)
        return hypothesis.amend(base, {names[k]: v for k, v in values.items() if k in names})

    free = tuple(Free(prefix + f.name, f.unit, f.value, f.limits) for f in hypothesis.free)
    return made, free
