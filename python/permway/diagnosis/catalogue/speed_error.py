"""The train ran faster or slower than noted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._excite import stays, with_speed
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation

ID = "speed_error"
DOMAIN: Domain = "measurement"
FAMILY = "speed"
SUMMARY = "The speed of all runs, or of one run, times a factor."
PARAMETERS = {"factor": "1, 0.9 to 1.1: true speed over the one noted"}
SIGNATURE = "Phases between wheelsets, straight over frequency; lines tied to length; hardly any level."
CONFUSED_WITH = {
    "sensor_delay": "one channel against all others",
    "irregularity_level": "phases are right there",
}
SOURCE = "Brandt, Noise and Vibration Analysis (2011), chapter 12: order tracking"
SIGMA = 0.015
LIMITS = (float(np.log(0.9)) / SIGMA, float(np.log(1.1)) / SIGMA)
STARTS = tuple((sign * z,) for z in (0.02, 0.07, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5) for sign in (1.0, -1.0))
"""So near each other that phases of wheels far apart are less than half a turn off at the nearest."""

WIDE = (
    *STARTS,
    *((float(z),) for z in np.arange(LIMITS[0], LIMITS[1], 0.2) if abs(z) > max(STARTS)[0]),
)
"""Starts of all runs together, to the ends of the prior: by 6 % phases have turned many times. A quarter as far
apart they lead to the same speeds and take four times the looks."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Of all runs; and of each run of several, three at most."""
    names = list(dict.fromkeys(run.condition.name for run in excesses(situation)))
    if not names:
        return
    for name in (None, *(names[:3] if len(names) > 1 else ())):

        def amend(campaign: Campaign, values: Mapping[str, float], name: str | None = name) -> Campaign:
            return with_speed(campaign, values["factor"], name)

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            # Of all runs it does what the runs' own speeds do together: logarithms make that a straight line.
            free=(Free("factor", "1", lambda z: float(np.exp(SIGMA * z)), LIMITS),),
            amend=amend,
            locate=stays("speed" if name is None else f"speed of {name}"),
            starts=WIDE if name is None else STARTS,
            law=lambda v: f"{100 * (v['factor'] - 1):+.2f} % of the speed noted",
            size="factor",
            none=1.0,
        )
