"""The track is rougher or smoother than stated, at all times or in one run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, linear_free

ID = "irregularity_level"
DOMAIN: Domain = "irregularity"
FAMILY = "level"
SUMMARY = "Level, and slope over wavenumber, added to the profile's density, in all runs; or the level of one run."
PARAMETERS = {
    "level_dB": "dB, -20 to 20: at 1 rad/m",
    "slope_dB_per_octave": "dB, -6 to 6: per doubling of the wavenumber, where it is of all runs",
}
SIGNATURE = "All on-board channels by one factor, their ratios unchanged; no frequency response."
CONFUSED_WITH = {
    "sensor_gain": "one channel only",
    "contact_filter": "short waves only",
}
SOURCE = "EN 13848-6:2014, characterisation of track geometry quality"
SIGMA_DB, SLOPE_DB = 5.0, 1.5


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Of all runs; and of each run of several, three at most."""
    runs = excesses(situation)
    if not runs:
        return

    def tilted(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        known = campaign.stated.irregularity
        return with_irregularity(
            campaign,
            level_dB=known.level_dB + values["level_dB"],
            slope_dB_per_octave=known.slope_dB_per_octave + values["slope_dB_per_octave"],
        )

    level = linear_free("level_dB", "dB", 0.0, SIGMA_DB, -20.0, 20.0)
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(level, linear_free("slope_dB_per_octave", "dB", 0.0, SLOPE_DB, -6.0, 6.0)),
        amend=tilted,
        locate=stays("irregularity"),
        starts=((0.0, 0.0),),
        law=lambda v: f"{v['level_dB']:+.3g} dB and {v['slope_dB_per_octave']:+.2g} dB an octave",
        size="level_dB",
    )
    names = list(dict.fromkeys(run.condition.name for run in runs))
    for name in names[:3] if len(names) > 1 else ():

        def shifted(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            levels = campaign.stated.irregularity.level_by_condition_dB
            changed = {**levels, name: levels.get(name, 0.0) + values["level_dB"]}
            return with_irregularity(campaign, level_by_condition_dB=changed)

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(level,),
            amend=shifted,
            locate=stays(f"irregularity in {name}"),
            starts=((0.0,),),
            law=lambda v: f"{v['level_dB']:+.3g} dB",
            size="level_dB",
        )
