"""Whether the trains of a campaign roll over the model's own supports, as they do by default."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from permway.arrays import Reals
from permway.campaign.excitation import Rolling
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.problem.model import Model
from permway.response.rolling import reach

if TYPE_CHECKING:
    from permway.campaign.campaign import CampaignFile
    from permway.campaign.parts import Condition

DENSE_M = 0.35
"""Supports closer than this stand for a continuous one, which shakes nothing. Of rails on fasteners 0.5 to 0.8 m
are usual; meshes of continuous supports have 0.1 to 0.3 m."""

EVEN = 0.02
"""Of the spacing, by which a support may lie beside an even row. Stations written to a centimetre are 0.8 % off.
Places that err evenly within 2 % take 0.5 % of the first line's power and 12 % of the fifth's; within twice as
much 2 and 41 %."""

WHERE = "irregularity.rolling"


def rolling_stated(stated: CampaignFile, model: Model) -> CampaignFile:
    """A campaign file with what its trains roll over, where it leaves that to the model.

    Raises
    ------
    InputError
        If it states that trains roll, and they cannot.
    """
    known = stated.irregularity
    if isinstance(known.rolling, Rolling) or known.rolling is False:
        return stated
    runs = list(_runs(stated))
    if not runs and known.rolling is None:
        return stated
    try:
        rolling = Rolling(spacing_m=_supports(model, runs))
    except InputError:
        if known.rolling:
            raise
        return stated
    return stated.model_copy(update={"irregularity": known.model_copy(update={"rolling": rolling})})


def how_trains_run(stated: CampaignFile, model: Model) -> str | None:
    """In words, of a campaign that was read; None without a run on board."""
    known, runs = stated.irregularity, list(_runs(stated))
    if not runs:
        return None
    if known.rolls is not None:
        return f"roll over supports {known.rolls.spacing_m:g} m apart"
    if known.rolling is False:
        return "stand, as the campaign file states"
    try:
        _supports(model, runs)
    except InputError as error:
        return f"stand: {error.what}"
    return "stand"


def _runs(stated: CampaignFile) -> Iterator[Condition]:
    """Conditions of records on board."""
    conditions = {condition.name: condition for condition in stated.conditions}
    degrees = {sensor.name for sensor in stated.sensors if sensor.degree is not None}
    for name in dict.fromkeys(r.condition for r in stated.records if r.spectral):
        on_board = any(
            degrees.intersection(record.channels.values()) for record in stated.records if record.condition == name
        )
        if on_board:
            yield conditions[name]


def _supports(model: Model, runs: list[Condition]) -> float:
    """Spacing of the supports under all runs, m.

    Raises
    ------
    InputError
        Without supports that repeat, and on a rail too short to follow wheels along.
    """
    from permway.campaign.predictions.excitation import speed_of
    from permway.campaign.predictions.motion import wheels_of

    remedy = "write rolling = false if the records are of a model whose train stands"
    if model.train is None or not runs:
        raise InputError("there is no run with sensors on board", where=WHERE, value=True, remedy="leave it out")
    body, found = model.train.body, []
    for run in runs:
        wheels, speed = wheels_of(model, run), speed_of(run)
        spacing = _spacing(model.line, body, wheels)
        if spacing is None:
            what = "supports under the train do not repeat at one spacing"
            raise InputError(what, where=WHERE, value=True, remedy=remedy)
        low, high = reach(model.line, body, wheels, speed_m_per_s=speed, spacing_m=spacing)
        if not any(s.body == body and s.start <= low and s.stop >= high for s in model.line.segments()):
            what = f"{body} is too short: what rolls is followed from {low:.1f} to {high:.1f} m"
            raise InputError(what, where=WHERE, value=True, remedy=remedy)
        found.append(spacing)
    if np.ptp(found) > EVEN * min(found):
        raise InputError("runs pass supports of different spacings", where=WHERE, value=True, remedy=remedy)
    return round(float(np.mean(found)), 9)


def _spacing(line: Line, body: str, wheels_m: Reals) -> float | None:
    """Of the joints that hold a beam from behind the last wheel to ahead of the first, m; None if not even."""
    if not isinstance(line.bodies.get(body), Beam):
        return None
    table, mine = line.joint_table(), [i for i, s in enumerate(line.segments()) if s.body == body]
    held = np.unique(table.x[np.isin(table.upper, mine) | np.isin(table.lower, mine)].round(6))
    first = np.searchsorted(held, wheels_m.min(), side="right") - 1
    last = np.searchsorted(held, wheels_m.max(), side="left")
    if first < 0 or last >= held.size or last - first < 2:
        return None
    row = held[first : last + 1]
    spacing = float((row[-1] - row[0]) / (row.size - 1))
    off = row - row[0] - spacing * np.arange(row.size)
    return spacing if spacing >= DENSE_M and np.abs(off).max() <= EVEN * spacing else None
