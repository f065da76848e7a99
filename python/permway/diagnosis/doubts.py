"""A diagnosis that names blunders first."""

from __future__ import annotations

from dataclasses import replace

from permway.checking.check import Checked
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict_parts import Doubt


def doubted(diagnosis: Diagnosis, checked: Checked) -> Diagnosis:
    """The diagnosis with what a check of its campaign found in its verdict.

    Parameters
    ----------
    diagnosis : Diagnosis
    checked : Checked
        Of the same campaign, as :func:`permway.checking.check.check` gives it.
    """
    doubts = tuple(
        Doubt(
            kind=one.kind,
            where=one.where,
            what=one.what,
            remedy=one.remedy,
            log_odds=one.log_odds,
            asked=one.asked,
        )
        # Spoilt channels are effects of the verdict already.
        for one in checked.blunders
        if one.kind != "bad channel"
    )
    return replace(diagnosis, verdict=diagnosis.verdict.model_copy(update={"blunders": doubts}))
