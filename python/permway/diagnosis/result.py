"""What a diagnosis hands on: the verdict and everything it was drawn from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from permway.checking.check import Checked
from permway.diagnosis.compare import Comparison
from permway.diagnosis.fit import Fit
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_parts import Doubt
from permway.diagnosis.weighed import Weighed


@dataclass(frozen=True)
class Diagnosis:
    """A verdict and what it rests on.

    Attributes
    ----------
    verdict : Verdict
    base : Fit
        The nominal model, recalibrated.
    amended : Fit, optional
        With the effects that were found; None without any.
    comparison : Comparison
        Of the nominal values and the recalibrated.
    after : Comparison, optional
        Of the amended model: its last model is the amended, recalibrated.
    seconds : mapping of stage to float
        Time taken.
    weighed : Weighed
        What the posterior says of places and of sets of effects.
    """

    verdict: Verdict
    base: Fit
    amended: Fit | None
    comparison: Comparison
    after: Comparison | None
    seconds: Mapping[str, float]
    weighed: Weighed

    def with_blunders(self, checked: Checked) -> Diagnosis:
        """With what a check of the same campaign found in its verdict."""
        doubts = tuple(
            Doubt(
                kind=one.kind,
                where=one.where,
                what=one.what,
                remedy=one.remedy,
                log_odds=one.log_odds,
                asked=one.asked,
            )
            # Bad channels are effects of the verdict already.
            for one in checked.blunders
            if one.kind != "bad channel"
        )
        return replace(self, verdict=self.verdict.model_copy(update={"blunders": doubts}))
