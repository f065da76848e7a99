"""The recalibrated base, and the one that a search begins from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.clock import Clock
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import relearnt

NEARLY = 1.3
"""Mean square of the deviations below which the recalibrated base is searched itself."""

BENT = 2.0
"""Mean square of the parameters, in standard deviations of their priors, from which a base that fits is bent."""

BLUNT, BLUNTER = 0.2, 1.0
"""Relative error of frequency responses with which the search then begins, and where that leads nowhere."""

BETTER = 0.8
"""Share of the mean square of one start that another may leave to be better."""

MOST_REFINED, STAYS = 4, 0.5
"""Times that a base is weighed by what it predicts, and standard deviations that its parameters may then move."""

FEW = 0.4
"""Share of pairs that may be missed by far if the others are to hold the base without them."""


def bases(evidence: Evidence, clock: Clock) -> tuple[Fit, Fit]:
    """The recalibrated base, and the one that the search begins from.

    Responses are first taken less seriously: far from the records sharp ones lead astray, and what is missing in
    one place bends such a base less. The search begins from it where learnt smooth errors do not explain what is
    left, or do so only with parameters far from what their owner said.
    """

    def fitted(to: Evidence, start: Reals | None, *, reweigh: bool = False, learn: bool = False) -> Fit:
        return recalibrate(
            to, start=start, learn=learn, reweigh=reweigh, settle=not reweigh, progress=lambda _: clock.tick()
        )

    searched = fitted(evidence.blunted(BLUNT), None, reweigh=True)
    # What hides in noise, and what spectra weigh, is told by a prediction: by a better one each time. What rolling
    # changes is known about a line, too.
    evidence = replace(evidence, campaign=evidence.campaign.rolling_about(searched.campaign))
    about = evidence.predicted(searched.campaign)
    sharp = evidence.reweighed(about)
    if searched.heat > NEARLY and sharp.missed(2.0 * BLUNT, about) < FEW:
        # A few pairs are missed by more than all are blunted by: they are blunted by as much, and lead no longer.
        searched = fitted(sharp.blunted(BLUNT, about), searched.z)
        sharp = evidence.reweighed(evidence.predicted(searched.campaign))
    else:
        searched = fitted(sharp.blunted(BLUNT), searched.z)
    base = fitted(sharp, searched.z, learn=True)
    if not _fits(base) and searched.heat > NEARLY:
        # Where blunt ones lead nowhere, still blunter ones may; or else the owner's own values.
        start, blunter = None, fitted(evidence.blunted(BLUNTER), None, reweigh=True)
        if blunter.heat < NEARLY:
            weighed = evidence.reweighed(evidence.predicted(blunter.campaign))
            again = fitted(weighed.blunted(BLUNT), blunter.z)
            if again.heat < BETTER * searched.heat:
                sharp, start, searched = weighed, again.z, again
        base = min(base, fitted(sharp, start, learn=True), key=lambda fit: fit.objective)
    if _fits(base):
        base = _refined(base, clock)
        return base, base
    return base, searched


def _fits(base: Fit) -> bool:
    """Whether learnt smooth errors explain what is left, by parameters near what their owner said."""
    return base.heat < NEARLY and base.prior < BENT * len(base.free)


def _refined(base: Fit, clock: Clock) -> Fit:
    """A base that fits, weighed by what it predicts itself, sizes of errors learnt to the end."""
    for _ in range(MOST_REFINED):
        again = base.evidence.reweighed(base.evidence.predicted(base.campaign))
        before = base.z
        base = recalibrate(again, start=before, reweigh=False, progress=lambda _: clock.tick())
        if np.all(np.abs(base.z - before) < STAYS * np.sqrt(np.diag(base.covariance))):
            break
    # What an amended model gains by being learnt to its end is no gain.
    return relearnt(base, base.evidence)
