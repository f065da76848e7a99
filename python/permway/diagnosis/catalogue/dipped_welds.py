"""Dips of one shape that do not repeat evenly: welds, squats, soft spots.

The contact is taken never to open: where wheels take off, the depth stated is one that would shake as much.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import Dips
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._lines import coordinate
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free

ID = "dipped_welds"
DOMAIN: Domain = "irregularity"
FAMILY = "dips of the rail"
SUMMARY = "Dips (1 + cos(2 pi x / l)) d / 2 of the rail, one in every 20 m in the mean, none tied to another."
PARAMETERS = {
    "depth_m": "m, 3.1e-6 to 0.029: d, root mean square; larger as the root of how many more there are",
    "length_m": "m, 0.02 to 16: l",
}
SIGNATURE = (
    "All on-board channels, coherent at the wheelsets' lags: more of all wavelengths above the dips' own length, "
    "nothing at whole parts of it; deep ones let wheels leave the rail, and runs look spiky."
)
CONFUSED_WITH = {
    "rail_joint": "evenly spaced, and so a comb of lines",
    "rail_corrugation": "a hump about one wavelength",
    "irregularity_level": "all wavelengths rise alike there",
}
SOURCE = "Campbell (1909), random pulses; Steenbergen and Esveld (2006), rail weld geometry and assessment"
EVERY_M = 20.0
LENGTH_M, LENGTH_FACTOR = 0.5, 2.0
DEPTH_M, DEPTH_FACTOR = 3e-4, 2.5
STARTS_M = ((0.12, 0.17, 0.25, 0.35), (0.5, 0.7, 1.0), (1.4, 2.0, 2.8, 4.0))
"""Lengths to begin with, half an octave apart: what a varying level takes up lies between one and the next."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Dips short, middling and long, where there are runs."""
    if not excesses(situation):
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        added = Dips(depth_m=values["depth_m"], length_m=values["length_m"], every_m=EVERY_M)
        return with_irregularity(campaign, dips=(*campaign.stated.irregularity.dips, added))

    for lengths_m in STARTS_M:
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(
                log_free("depth_m", "m", DEPTH_M, DEPTH_FACTOR),
                log_free("length_m", "m", LENGTH_M, LENGTH_FACTOR, lowest=0.02),
            ),
            amend=amend,
            locate=stays("rail"),
            starts=tuple((-1.0, coordinate(length, LENGTH_M, LENGTH_FACTOR)) for length in lengths_m),
            law=lambda v: (
                f"dips of {1e3 * v['depth_m']:.3g} mm over {v['length_m']:.3g} m, as if one in every {EVERY_M:g} m"
            ),
            size="depth_m",
            power=2.0,
            none=0.0,
        )
