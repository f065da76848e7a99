"""Lines of the profile that repeat along the track: what joints, spans and supports share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import TrackLines
from permway.diagnosis.catalogue._excite import with_irregularity
from permway.diagnosis.hypothesis import Amend

FACTOR = 3.0
"""To which amplitudes are known beforehand."""


def coordinate(value: float, centre: float, factor: float) -> float:
    """Z of a value of a number known to a factor."""
    return float(np.log(value / centre) / np.log(factor))


def repeats(length_m: float | None = None, harmonics: int | None = None) -> Amend:
    """Lines at n V / length, from the values `amplitude_m`, `decay` and, if no length is given, `length_m`."""

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        added = TrackLines(
            length_m=values["length_m"] if length_m is None else length_m,
            amplitude_m=values["amplitude_m"],
            decay=values["decay"],
            harmonics=harmonics,
        )
        return with_irregularity(campaign, series=(*campaign.stated.irregularity.series, added))

    return amend
