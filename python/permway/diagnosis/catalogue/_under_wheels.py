"""Fasteners that a train presses: what share of a wheel's load each carries, and what that makes of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from itertools import pairwise

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Condition
from permway.campaign.predictions.motion import wheels_of
from permway.diagnosis.catalogue._change import REACH_M, fresh, with_line
from permway.diagnosis.catalogue._pads import with_factors
from permway.diagnosis.catalogue._roles import LOW_HZ, ROOM_C, Layer, fasteners, spacing
from permway.errors import SolveError
from permway.model.bodies import Beam
from permway.model.changes import Change

LEAST = 0.02
"""Share of a wheel's load below which a fastener is as without a train."""

LEVELS = (0.1, 0.3, 0.55, 0.8)
"""Shares from which fasteners are shaken alike."""

FAR = 0.05
"""Share of those that are further away: what travels along the rail."""

TURNS = 6
"""By which stiffness and load agree: each leaves a third of what the one before did, for pads that a wheel makes
twice as stiff."""

BEYOND_M = 8.0
"""Past the outer wheels, of the rail that is taken: there nothing bends any more."""

Levels = dict[str, list[tuple[str, float]]]


def share_of_load(campaign: Campaign, condition: Condition, layer: Layer, *, squared: bool = False) -> Reals:
    """Load of each fastener of a layer over that of the one below a wheel alone, 0 where it would lift.

    A rail on an even bed (Winkler): e^-bx (cos bx + sin bx), b^4 = k / (4 E I), summed over the wheels; `squared`,
    the root of the sum of squares.
    """
    stiffness, rigidity = _bed(campaign, layer)
    away = np.abs(np.unique(layer.x)[:, None] - wheels_of(campaign.model, condition))
    along = away * (stiffness / spacing(layer.x) / (4.0 * rigidity)) ** 0.25
    each = np.exp(-along) * (np.cos(along) + np.sin(along))
    return np.asarray(np.sqrt((each**2).sum(axis=1)) if squared else np.maximum(each.sum(axis=1), 0.0))


def _bed(campaign: Campaign, layer: Layer) -> tuple[float, float]:
    """Stiffness of one fastener, N/m, and bending stiffness of the rail, N m2."""
    line = campaign.model.line
    rail = line.bodies[layer.joints.between[0]]
    assert isinstance(rail, Beam)
    stiffness = layer.joints.scale * float(line.laws[layer.law].complex(LOW_HZ, ROOM_C).real)
    return stiffness, rail.youngs_modulus_Pa * rail.second_moment_m4


def settled(campaign: Campaign, condition: Condition, layer: Layer, factor: Callable[[Reals], Reals]) -> Reals:
    """Factors on a layer's fasteners that agree with the load which the rail then spreads to them.

    Fasteners that stiffen draw load from others.

    Parameters
    ----------
    campaign : Campaign
    condition : Condition
    layer : Layer
    factor : callable
        From loads, over that of the one below a wheel alone with all as without a train, to factors.

    Returns
    -------
    ndarray, shape (places,)
    """
    stiffness, rigidity = _bed(campaign, layer)
    x, wheels = np.unique(layer.x), wheels_of(campaign.model, condition)
    near = (x > wheels.min() - BEYOND_M) & (x < wheels.max() + BEYOND_M)
    factors = np.asarray(factor(share_of_load(campaign, condition, layer)))
    if not near.any():
        return factors
    alone = 0.5 * spacing(x) * (stiffness / spacing(x) / (4.0 * rigidity)) ** 0.25
    for _ in range(TURNS):
        carried = _carried(x[near], stiffness * factors[near], rigidity, wheels)
        factors[near] = factor(np.maximum(carried / alone, 0.0))
    return factors


def _carried(x: Reals, springs: Reals, rigidity: float, wheels: Reals) -> Reals:
    """What springs below a beam carry of unit loads on it, at rest.

    Raises
    ------
    SolveError
        If they hold nothing, as where an earlier change made them pull.
    """
    # To a millimetre: what is closer is one node.
    nodes, place = np.unique(np.round(np.concatenate([x, wheels]), 3), return_inverse=True)
    length = np.diff(nodes)
    beam = np.zeros((4, 2 * nodes.size))
    terms = {(0, 0): 12.0, (0, 1): 6.0, (0, 2): -12.0, (0, 3): 6.0, (1, 1): 4.0}
    terms |= {(1, 2): -6.0, (1, 3): 2.0, (2, 2): 12.0, (2, 3): -6.0, (3, 3): 4.0}
    first = 2 * np.arange(length.size)
    for (row, column), number in terms.items():
        turns = row % 2 + column % 2
        np.add.at(beam[3 + row - column], first + column, number * rigidity / length ** (3 - turns))
    np.add.at(beam[3], 2 * place[: x.size], springs)
    load = np.zeros(2 * nodes.size)
    np.add.at(load, 2 * place[x.size :], 1.0)
    try:
        moved = linalg.solveh_banded(beam, load)
    except linalg.LinAlgError as error:
        raise SolveError(
            f"what lies below the wheels holds nothing: {springs.min():.3g} N/m at the least"
        ) from error
    return np.asarray(springs * moved[2 * place[: x.size]])


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
        By name of a condition with a train: from loads to factors on the fasteners, see :func:`settled`.
    """
    line, joints = campaign.model.line, list(campaign.model.line.joints)
    by_condition: dict[str, dict[str, float]] = {name: {} for name in factors}
    for layer in fasteners(line):
        if layer.law not in laws:
            continue
        x, before = np.unique(layer.x), joints[layer.index].changes
        shares = [share_of_load(campaign, campaign.condition(name), layer) for name in factors]
        near = np.flatnonzero(np.max(shares, axis=0) > LEAST)
        more = tuple(Change(from_m=x[i] - REACH_M, to_m=x[i] + REACH_M, factor=1.0) for i in near)
        joints[layer.index] = joints[layer.index].model_copy(update={"changes": (*before, *more)})
        for name, factor_of in factors.items():
            changed = settled(campaign, campaign.condition(name), layer, factor_of)[near]
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
