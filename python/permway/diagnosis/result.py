"""What a diagnosis hands on: the verdict and everything it was drawn from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from permway.diagnosis.compare import Comparison
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.weighed import Weighed

Stage = Literal["screened", "quick", "full"]


@dataclass(frozen=True)
class Candidate:
    """A hypothesis that was held against the records.

    Attributes
    ----------
    entry, family, domain : str
        Of the catalogue.
    place : Where
    law : str
        Mechanics in words.
    gain : float
        Of twice the log posterior; the recalibrated base has zero.
    log_evidence : float
        Less the base's, nats.
    parameters : mapping of name to (value, low, high, unit)
        With 90 % intervals.
    stage : "screened", "quick" or "full"
        How far it was followed.
    """

    entry: str
    family: str
    domain: str
    place: Where
    law: str
    gain: float
    log_evidence: float
    parameters: Mapping[str, tuple[float, float, float, str]]
    stage: Stage


@dataclass(frozen=True)
class Diagnosis:
    """A verdict and what it rests on.

    Attributes
    ----------
    verdict : Verdict
    base : Fit
        The owner's model, recalibrated.
    amended : Fit, optional
        With the effects that were found; None without any.
    found : tuple of Found
        Scan of the base, the most telling place first; empty without hammer tests.
    left : tuple of Found
        The same after the amendment; may be empty.
    candidates : tuple of Candidate
        The most telling first.
    comparison : Comparison
        Of the owner's values and the recalibrated.
    after : Comparison, optional
        Of the amended model: its last model is the amended, recalibrated.
    seconds : mapping of stage to float
        Time taken.
    weighed : Weighed, optional
        What the posterior says of places and of sets of effects.
    """

    verdict: Verdict
    base: Fit
    amended: Fit | None
    found: tuple[Found, ...]
    left: tuple[Found, ...]
    candidates: tuple[Candidate, ...]
    comparison: Comparison
    after: Comparison | None
    seconds: Mapping[str, float]
    weighed: Weighed | None = None
