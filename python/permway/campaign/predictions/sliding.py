"""Trains whose suspensions slide or blow off: the model at work in one run, and what shakes it beside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.parts import Condition, IrregularityKnown
from permway.campaign.predictions import excitation
from permway.campaign.predictions.excitation import speed_of
from permway.campaign.predictions.grid import Grid, interpolating, weighed
from permway.campaign.predictions.motion import influence, pushed, wheels_of
from permway.errors import SolveError
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import FlexibleMode
from permway.problem.model import Model
from permway.response.sliding import Remainder, at_work, remainders, sliders_of

STEP_HZ = 0.25
"""Of the spectra of velocities: a lag of 0.4 s turns them by 0.6 rad from one to the next, of which interpolating
loses less than 5 %, and of what two bogies have in common alone."""

ROUNDING = 1e-6
"""Share of the forces' power that is added to each of them, so that their density has a root."""


@dataclass(frozen=True, eq=False)
class Work:
    """A model at work in one run.

    Attributes
    ----------
    model : Model
        Its sliders moving as fast as they do.
    left : list of Remainder
        Over multiples of `STEP_HZ`.
    """

    model: Model
    left: list[Remainder]


def worked(
    model: Model, known: IrregularityKnown, condition: Condition, grid: Grid, lines_Hz: Reals, track: Complexes
) -> Work:
    """The model at work in a run; itself where nothing slides.

    Parameters
    ----------
    grid : Grid
        Of the record.
    lines_Hz : ndarray, shape (L,)
    track : ndarray of complex128, shape (L, wheels, wheels)
        Receptance at the contacts, m/N.

    Raises
    ------
    SolveError
        If no velocity at work is found.
    """
    train = model.train
    assert train is not None
    if not sliders_of(train.vehicle):
        return Work(model, [])
    uniform = np.asarray(STEP_HZ * np.arange(int(lines_Hz[-1] / STEP_HZ) + 1), dtype=np.float64)
    wheels = wheels_of(model, condition)
    late = np.exp(-2j * np.pi * np.outer(uniform, (wheels[0] - wheels) / speed_of(condition)))
    rough = np.sqrt(_resampled(excitation.profile(model, known, condition, grid), grid.frequency_Hz, uniform))
    rough[uniform < lines_Hz[0]] = 0.0
    between = interpolating(lines_Hz, np.clip(uniform, lines_Hz[0], lines_Hz[-1]))
    influence_of = retuned(model, lines_Hz, track)

    def motion(vehicle: Vehicle) -> Complexes:
        per_profile = influence_of(vehicle)
        there = weighed(between, per_profile.reshape(lines_Hz.size, -1)).reshape(-1, *per_profile.shape[1:])
        return np.asarray(rough[:, None] * (there @ late[:, :, None])[:, :, 0])

    vehicle = at_work(train.vehicle, uniform, motion)
    return Work(with_vehicle(model, vehicle), remainders(vehicle, STEP_HZ, motion(vehicle)))


def retuned(model: Model, lines_Hz: Reals, track: Complexes) -> Callable[[Vehicle], Complexes]:
    """:func:`influence` of the model's vehicle with sliders that move as fast as they may.

    Their dashpots alone change, so a system of as many unknowns as there are suspensions is enough (Woodbury);
    where flexible modes stretch suspensions too, all is solved again.

    Parameters
    ----------
    model : Model
    lines_Hz : ndarray, shape (L,)
    track : ndarray of complex128, shape (L, wheels, wheels)
        Receptance at the contacts, m/N.
    """
    assert model.train is not None
    vehicle = model.train.vehicle
    if any(isinstance(addition, FlexibleMode) for addition in vehicle.additions):
        return lambda moving: influence(with_vehicle(model, moving), lines_Hz, track)
    before = influence(model, lines_Hz, track)
    rows = [vehicle.stretches(slider.suspension) for slider in sliders_of(vehicle)]
    ties = np.concatenate(rows)
    per_force = np.swapaxes(pushed(vehicle, lines_Hz, ties, before), 1, 2)
    give, imposed = ties @ per_force, ties @ before
    own = np.eye(len(ties))

    def of(moving: Vehicle) -> Complexes:
        more = [
            np.full(len(mine), vehicle.share * (now.damping_Ns_per_m - then.damping_Ns_per_m))
            for mine, now, then in zip(rows, sliders_of(moving), sliders_of(vehicle), strict=True)
        ]
        dashpots = 2j * np.pi * lines_Hz[:, None] * np.concatenate(more)
        stretched = np.linalg.solve(own + give * dashpots[:, None, :], imposed)
        return np.asarray(before - per_force @ (dashpots[:, :, None] * stretched))

    return of


def shares(left: Remainder, frequency_Hz: Reals) -> Complexes:
    """Independent sources of unit density that make up the forces left over.

    Returns
    -------
    ndarray of complex128, shape (F, ties, sources)
        N per root of hertz.

    Raises
    ------
    SolveError
        If their density has no root, beyond what rounding does.
    """
    place = np.clip(frequency_Hz / STEP_HZ, 0.0, len(left.density) - 1.001)
    at = place.astype(np.int64)
    away = (place - at)[:, None, None]
    density = (1.0 - away) * left.density[at] + away * left.density[at + 1]
    size = np.einsum("fii->f", density).real + np.finfo(float).tiny
    # Forces that are all but one another leave eigenvalues that rounding may put below zero.
    lifted = density + (ROUNDING * size)[:, None, None] * np.eye(density.shape[1])
    try:
        return np.asarray(np.linalg.cholesky(lifted))
    except np.linalg.LinAlgError:
        least = np.linalg.eigvalsh(lifted)[:, 0] / size
        worst = int(np.argmin(least))
        raise SolveError(
            f"what the sliders give beside their dashpots has a negative density at {frequency_Hz[worst]:g} Hz "
            f"({least[worst]:.2g} of its power)"
        ) from None


def with_vehicle(model: Model, vehicle: Vehicle) -> Model:
    """The model with another vehicle."""
    assert model.train is not None
    return model.model_copy(update={"train": model.train.model_copy(update={"vehicle": vehicle})})


def _resampled(density: Reals, frequency_Hz: Reals, onto_Hz: Reals) -> Reals:
    """A density on another grid, its power kept from each to the next."""
    power = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(frequency_Hz))])
    half = 0.5 * STEP_HZ
    found = np.interp(onto_Hz + half, frequency_Hz, power) - np.interp(onto_Hz - half, frequency_Hz, power)
    return np.asarray(found / STEP_HZ)
