"""Fasteners that a train presses: what share of a wheel's load each carries, and what that makes of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from itertools import pairwise

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.catalogue._change import REACH_M, fresh, with_line
from permway.diagnosis.catalogue._pads import with_factors
from permway.diagnosis.catalogue._roles import LOW_HZ, ROOM_C, Layer, fasteners, spacing
from permway.model.bodies import Beam
from permway.model.changes import Change
from permway.recordings.campaign import Campaign
from permway.recordings.campaign_parts import Condition
from permway.recordings.predict.motion import wheels_of

LEAST = 0.02
"""Share of a wheel's load below which a fastener is as without a train."""

LEVELS = (0.1, 0.3, 0.55, 0.8)
"""Shares from which fasteners are shaken alike."""

FAR = 0.05
"""Share of those that are further away: what travels along the rail."""

Levels = dict[str, list[tuple[str, float]]]


def share_of_load(campaign: Campaign, condition: Condition, layer: Layer, *, squared: bool = False) -> Reals:
    """Load of each fastener of a layer over that of the one below a wheel alone, 0 where it would lift.

    A rail on an even bed (Winkler): e^-bx (cos bx + sin bx), b^4 = k / (4 E I), summed over the wheels; `squared`,
    the root of the sum of squares.
    """
    line = campaign.model.line
    rail = line.bodies[layer.joints.between[0]]
    assert isinstance(rail, Beam)
    stiffness = layer.joints.scale * line.laws[layer.law].complex(LOW_HZ, ROOM_C).real / spacing(layer.x)
    rigidity = rail.youngs_modulus_Pa * rail.second_moment_m4
    away = np.abs(np.unique(layer.x)[:, None] - wheels_of(campaign.model, condition))
    along = away * (float(stiffness) / (4.0 * rigidity)) ** 0.25
    each = np.exp(-along) * (np.cos(along) + np.sin(along))
    return np.asarray(np.sqrt((each**2).sum(axis=1)) if squared else np.maximum(each.sum(axis=1), 0.0))


def pressed(
    campaign: Campaign, laws: Collection[str], factors: Mapping[str, Callable[[Reals], Reals]]
) -> Campaign:
    """The campaign with fasteners near wheels changed under some conditions.

    Parameters
    ----------
    campaign : Campaign
    laws : collection of str
        Of the fasteners.
    factors : mapping of str to callable
        By name of a condition with a train: from shares of the load to factors on the fasteners.
    """
    line, joints = campaign.model.line, list(campaign.model.line.joints)
    by_condition: dict[str, dict[str, float]] = {name: {} for name in factors}
    for layer in fasteners(line):
        if layer.law not in laws:
            continue
        x, before = np.unique(layer.x), joints[layer.index].changes
        shares = {name: share_of_load(campaign, campaign.condition(name), layer) for name in factors}
        near = np.flatnonzero(np.max(list(shares.values()), axis=0) > LEAST)
        more = tuple(Change(from_m=x[i] - REACH_M, to_m=x[i] + REACH_M, factor=1.0) for i in near)
        joints[layer.index] = joints[layer.index].model_copy(update={"changes": (*before, *more)})
        for name, share in shares.items():
            changed = factors[name](share[near])
            for number, factor in enumerate(changed.tolist(), start=len(before)):
                by_condition[name][f"line.joints[{layer.index}].changes[{number}].factor"] = factor
    return with_factors(with_line(campaign, joints=tuple(joints)), by_condition)


def levelled(campaign: Campaign, laws: Collection[str], conditions: Collection[str]) -> tuple[Campaign, Levels]:
    """The same campaign, its fasteners near wheels in layers of their own, by how much each is shaken.

    Wheels shake with forces that have little in common, so their shares add in squares.

    Returns
    -------
    tuple of Campaign and Levels
        The levels by the law that each layer's is a copy of: their own law's name, and the mean share.
    """
    line, joints, copies = campaign.model.line, list(campaign.model.line.joints), dict(campaign.model.line.laws)
    levels: Levels = {}
    gone: list[int] = []
    for layer in fasteners(line):
        if layer.law not in laws:
            continue
        x = np.unique(layer.x)
        shares = [share_of_load(campaign, campaign.condition(name), layer, squared=True) for name in conditions]
        share = np.mean(shares, axis=0)
        levels.setdefault(layer.law, [(layer.law, FAR)])
        far = x[share < LEVELS[0]]
        gone += [layer.index] if not far.size else []
        joints[layer.index] = joints[layer.index].model_copy(update={"at": tuple(far.tolist())})
        for low, high in pairwise((*LEVELS, np.inf)):
            mine = (share >= low) & (share < high)
            if not mine.any():
                continue
            name = fresh(f"{layer.law}_under_wheels", copies)
            copies[name] = line.laws[layer.law]
            at = tuple(x[mine].tolist())
            joints.append(layer.joints.model_copy(update={"law": name, "at": at}))
            levels[layer.law].append((name, float(share[mine].mean())))
    kept = tuple(joint for index, joint in enumerate(joints) if index not in gone)
    return with_line(campaign, joints=kept, laws=copies), levels
