"""The irregularity's level where its owner's word does not hold: an effect that recalibration takes up by itself.

The base has that level free, within the owner's tolerance. So a line that is much rougher fits, and no effect
gains anything beside it: what tells is how far the level goes from what was said.
"""

from __future__ import annotations

import numpy as np

from permway.diagnosis.catalogue import irregularity_level
from permway.diagnosis.choose import lines
from permway.diagnosis.decide import NOVEL_PRIOR
from permway.diagnosis.fit import WIDTH, Fit
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.verdict import NOVEL
from permway.diagnosis.verdict_parts import ClassMember, Effect, Estimate, Mechanics, Place

PATH = "campaign.irregularity.level_dB"


def beyond(fit: Fit, threshold: float) -> Effect | None:
    """The level as an effect, if the objective without its owner's word were lower by more than BIC asks for that.

    Parameters
    ----------
    fit : Fit
        Of a model that fits.
    threshold : float
        Gain of BIC from which something is called missing.

    Returns
    -------
    Effect or None
        If the level is not among the campaign's parameters, or stands where it may.
    """
    known = fit.evidence.campaign.parameters.known
    names = [f.name for f in fit.free]
    for name, parameter in known.items():
        if parameter.parameter.paths != (PATH,) or name not in names:
            continue
        index = names.index(name)
        # The prior is one of z, of unit width: without it the records alone would have the level there.
        share = 1.0 - float(fit.covariance[index, index])
        alone = float(fit.z[index]) / share
        if share * alone**2 - float(np.log(lines(fit))) < threshold:
            return None
        reach = WIDTH * float(np.sqrt((1.0 - share) / share))
        value, low, high = (parameter.value(z) - parameter.nominal for z in (alone, alone - reach, alone + reach))
        line = fit.campaign.model.line
        return Effect(
            domain=irregularity_level.DOMAIN,
            place=Place.of(Where("irregularity"), line),
            name=irregularity_level.ID,
            class_=(
                ClassMember(name=irregularity_level.ID, probability=1.0 - NOVEL_PRIOR),
                ClassMember(name=NOVEL, probability=NOVEL_PRIOR),
            ),
            law=Mechanics(words=f"{value:+.3g} dB from what its owner says, by the records alone"),
            parameters={"level_dB": Estimate(value=value, unit="dB", low=low, high=high)},
        )
    return None
