"""Joints that waves need time to cross: rods in place of what ties two bodies, over a stretch or a whole layer.

A thick soft layer does so. Well below its own resonances it is a joint that has lost most of its stiffness, as at
a void; from there up it has a mass of its own, and passes on with a delay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import REACH_M, fresh, with_factors, with_joints
from permway.diagnosis.catalogue._interval import shares, spacing_of, span_of, stations_of
from permway.diagnosis.catalogue._roles import LOW_HZ, ROOM_C
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, linear_free, log_free
from permway.diagnosis.verdict import NOVEL
from permway.errors import InputError
from permway.laws import Waves
from permway.model.changes import Change
from permway.model.joints import GROUND, Joints

DELAYS_S = (2.5e-4, 5e-4, 1e-3, 2e-3)
"""That a wave through a layer is looked for with: from a hard to a soft rubber of some decimetres."""

LEFT = (0.003, 0.03, 0.3)
"""Shares of a joint's stiffness that a rod in its place is looked for with, where nothing is known of it."""

BAYS = (3.0, 9.0)
"""Usual lengths, in spacings, that a stretch is looked for with."""

LONGEST = 24.0
"""Of a stretch, in spacings."""

DELAY_S, SPREAD = 1e-3, 5.0
"""About which a delay is looked for, and the factor that a rod's stiffness is known to."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Loss:
    """A stretch of joints that a share of their stiffness is left of.

    Attributes
    ----------
    law : str
    centre_m, length_m, left : float
    """

    law: str
    centre_m: float
    length_m: float
    left: float


def over_stretch(situation: Situation, losses: Sequence[Loss]) -> Iterator[Hypothesis]:
    """Rods in place of the joints of stretches that are known to have lost stiffness.

    Parameters
    ----------
    situation : Situation
    losses : sequence of Loss
    """
    for loss in (one for one in losses if _known(situation.campaign, one.law)):
        step = spacing_of(situation.campaign.model.line, loss.law)
        lefts = (max(loss.left, 1e-4), 3.0 * max(loss.left, 1e-4))
        if _has_stretches(situation.campaign, loss.law):
            yield _stretch(situation.campaign, loss.law, loss.centre_m, lefts, (loss.length_m / step,))
        else:
            yield _layer(situation.campaign, loss.law)


def at_joint(situation: Situation, law: str, x_m: float) -> Iterator[Hypothesis]:
    """Rods in place of the joints of a law, about a place and all along.

    Parameters
    ----------
    situation : Situation
    law : str
        Nothing comes of one whose stiffness at low frequency is not known, as of a table.
    x_m : float
    """
    if _known(situation.campaign, law):
        if _has_stretches(situation.campaign, law):
            yield _stretch(situation.campaign, law, x_m, LEFT, BAYS)
        yield _layer(situation.campaign, law)


def with_rods(
    campaign: Campaign, law: str, share: Reals, *, stiffness: float, delay_s: float, loss: float
) -> Campaign:
    """The campaign with rods for shares of the joints of a law.

    Parameters
    ----------
    campaign : Campaign
    law : str
    share : ndarray, shape (J,)
        Of each of the law's stations, ascending: 0 is the joint as it was, 1 a rod in its place.
    stiffness, delay_s, loss : float
        Of a rod: N/m at rest, s from end to end, loss factor.
    """
    line = campaign.model.line
    table = line.joint_table()
    through = fresh(NOVEL, line.laws)
    end = fresh(f"{NOVEL}_end", line.laws)
    laws = {
        name: Waves(stiffness=stiffness, delay_s=delay_s, loss_factor=loss, part=part)
        for name, part in ((through, "through"), (end, "end"))
    }
    x = stations_of(line, law)
    of_place = dict(zip(x.tolist(), share.tolist(), strict=True))
    added: list[Joints] = []
    for index, layer in enumerate(line.joints):
        if layer.law != law:
            continue
        mine = [at for at in np.unique(table.x[table.layer == index]).tolist() if of_place[at] > 0.0]
        changes = tuple(
            Change(from_m=at - REACH_M, to_m=at + REACH_M, factor=of_place[at])
            for at in mine
            if of_place[at] < 1.0
        )
        ends = [(body, GROUND) for body in layer.between if body != GROUND]
        added += [
            Joints(between=between, law=name, at=tuple(mine), changes=changes)
            for between, name in ((layer.between, through), *((pair, end) for pair in ends))
            if mine
        ]
    lost = with_factors(campaign, law, lambda at: 1.0 - np.array([of_place[one] for one in at.tolist()]))
    return with_joints(lost, *added, laws=laws)


def _words(values: Values) -> str:
    return (
        f"a rod of {values['stiffness_N_per_m']:.3g} N/m at rest, loss factor {values['loss_factor']:.2g}, that "
        f"waves cross with a delay of {1e3 * values['delay_s']:.3g} ms"
    )


def _stiffness(campaign: Campaign, law: str) -> float:
    """Of one joint of a law, N/m."""
    line = campaign.model.line
    table = line.joint_table()
    scale = float(np.median(table.scale[table.law == list(line.laws).index(law)]))
    return scale * float(abs(line.laws[law].complex(LOW_HZ, ROOM_C)))


def _known(campaign: Campaign, law: str) -> bool:
    """Whether it has a stiffness at low frequency: a table may begin higher up."""
    try:
        return _stiffness(campaign, law) > 0.0
    except InputError:
        return False


def _own(stiffness: float) -> tuple[Free, ...]:
    """Constants of a rod."""
    return (
        log_free("stiffness_N_per_m", "N/m", stiffness, SPREAD),
        log_free("delay_s", "s", DELAY_S, 2.0),
        log_free("loss_factor", "1", 0.15, 2.0),
    )


def _start(left: float, delay: float) -> tuple[float, ...]:
    """Coordinates of a rod's constants, its stiffness that many times the one it is looked for about."""
    return float(np.log(left) / np.log(SPREAD)), float(np.log2(delay / DELAY_S)), 0.0


def _made(
    law: str,
    place: str,
    free: tuple[Free, ...],
    starts: Iterable[tuple[float, ...]],
    share_of: Callable[[Values], Reals],
    span: Callable[[Values], tuple[float, float] | None],
) -> Hypothesis:
    def amend(campaign: Campaign, values: Values) -> Campaign:
        rod = {"stiffness": values["stiffness_N_per_m"], "delay_s": values["delay_s"]}
        return with_rods(campaign, law, share_of(values), **rod, loss=values["loss_factor"])

    return Hypothesis(
        entry=NOVEL,
        domain="path",
        family=f"rod in place of {place}",
        free=free,
        amend=amend,
        locate=lambda v: Where(law, span(v)),
        starts=tuple(starts),
        law=lambda v: f"{_words(v)}, in place of {place}",
        size="delay_s",
    )


def _has_stretches(campaign: Campaign, law: str) -> bool:
    """Whether a stretch of a law's joints can be other than the whole layer, which one joint is."""
    return bool(stations_of(campaign.model.line, law).size > 1)


def _stretch(
    campaign: Campaign, law: str, centre: float, lefts: Sequence[float], bays: Sequence[float]
) -> Hypothesis:
    line = campaign.model.line
    x, step = stations_of(line, law), spacing_of(line, law)
    middle, longest = float(np.exp(np.mean(np.log(lefts)))), min(LONGEST * step, float(np.ptp(x)))
    free = (
        *_own(middle * _stiffness(campaign, law)),
        linear_free("centre_m", "m", centre, 2.0 * step, centre - 6.0 * step, centre + 6.0 * step),
        linear_free("length_m", "m", bays[0] * step, 3.0 * step, 0.0, longest),
    )
    return _made(
        law,
        "each joint of a stretch",
        free,
        ((*_start(k / middle, delay), 0.0, (n - bays[0]) / 3.0) for k, delay, n in product(lefts, DELAYS_S, bays)),
        lambda v: shares(x, v["centre_m"], v["length_m"], step),
        lambda v: span_of(x, v["centre_m"], v["length_m"], step),
    )


def _layer(campaign: Campaign, law: str) -> Hypothesis:
    x = stations_of(campaign.model.line, law)
    return _made(
        law,
        "every joint of the layer",
        _own(_stiffness(campaign, law)),
        (_start(1.0, delay) for delay in DELAYS_S),
        lambda _: np.ones(x.size),
        lambda _: None,
    )
