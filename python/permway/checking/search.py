"""Which changes of a record the levels and phases support."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from permway.checking.change import Change
from permway.checking.compared import Compared
from permway.checking.offered import offered
from permway.checking.score import Scored
from permway.recordings.channel import Sensor

LEAST_ODDS = 5.0
"""Log odds from which a change is reported: 150 to 1. At half of it more honest campaigns are doubted, at twice
of it single channels of short records go unnoticed; the page on `check` has both rates."""

MOST = 6
"""Changes of one record that are reported, one on top of the other."""


NEAR = 4.0
"""Log odds between two factors within which the second is named beside the first: 50 to 1."""


@dataclass(frozen=True)
class Reported:
    """A change that the record supports.

    Attributes
    ----------
    change : Change
    log_odds : float
        Of the change over none.
    rivals : tuple of Change
        Other factors on the same members that are nearly as probable.
    """

    change: Change
    log_odds: float
    rivals: tuple[Change, ...] = ()


def reported(given: Compared, sensors: Sequence[Sensor], forces: Sequence[str]) -> tuple[list[Reported], Compared]:
    """Changes, the surest first, each compared with the record with those before it made; and the record so.

    Parameters
    ----------
    given : Compared
    sensors : sequence of Sensor
    forces : sequence of str
        As of :func:`permway.checking.offered.offered`.
    """
    found: list[Reported] = []
    now = given
    while len(found) < MOST and now.used.any():
        scored = Scored(now)
        changes = [
            one for one in offered(now, sensors, forces) if not any(_undoes(one, old.change) for old in found)
        ]
        odds = [scored.gain(one) for one in changes]
        if not odds or max(odds) < LEAST_ODDS:
            break
        at = odds.index(max(odds))
        rivals = [
            one
            for one, gain in zip(changes, odds, strict=True)
            if one is not changes[at] and gain > odds[at] - NEAR and _alike(one, changes[at])
        ]
        found.append(Reported(changes[at], odds[at], tuple(rivals)))
        now = now.changed(changes[at])
    return found, now


def _alike(one: Change, other: Change) -> bool:
    sized = {"factor", "quantity"}
    return one.kind in sized and other.kind in sized and set(one.ratios) == set(other.ratios)


def _undoes(new: Change, old: Change) -> bool:
    """Whether a change is of the same members and kind as one that was made: no more is estimated of them."""
    if new.kind != old.kind and {new.kind, old.kind} != {"factor", "quantity"}:
        return False
    mine, before = {*new.ratios, *new.exchanged}, {*old.ratios, *old.exchanged}
    return not mine or bool(mine & before)
