"""Predicted against measured, with the nominal values and recalibrated, of a campaign."""

from __future__ import annotations

from collections.abc import Callable

from permway.campaign.campaign import Campaign
from permway.diagnosis.compare import Comparison, assemble
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.posterior.diagnose import as_base
from permway.posterior.recalibrated import recalibrated

STEPS = 3
"""That progress reports: read, recalibrate, compare."""

Progress = Callable[[int, int], object]


@one_thread_of_blas()
def compare(
    campaign: Campaign, *, raw_only: bool = False, threads: int | None = None, progress: Progress | None = None
) -> Comparison:
    """Hold what a campaign's model predicts against what was measured.

    Parameters
    ----------
    campaign : Campaign
    raw_only : bool
        Whether to leave recalibration out, which takes all of the time.
    threads : int, optional
        Of the solver, or processes that share the work.
    progress : callable, optional
        Called with steps done and how many there are.

    Raises
    ------
    InputError
        If no record can be predicted, or a file cannot be read.
    """

    def done(count: int) -> None:
        if progress is not None:
            progress(count, STEPS)

    kept, left_out, _ = predictable(campaign)
    observations = gather(campaign, kept, threads=threads)
    done(1)
    fit = None if raw_only else as_base(recalibrated(observations))
    done(2)
    found = assemble(observations, fit, left_out=left_out)
    done(STEPS)
    return found
