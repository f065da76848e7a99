"""What sensors on a train see of an irregularity: cross-spectral densities as Welch's method estimates them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache, partial

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.parts import Condition, IrregularityKnown
from permway.campaign.predictions import excitation
from permway.campaign.predictions.aboard import aboard, added_csd
from permway.campaign.predictions.excitation import speed_of
from permway.campaign.predictions.grid import Grid, grid_of, solved_lines
from permway.campaign.predictions.motion import influence, pushed, wheels_of
from permway.campaign.predictions.rolling import passing
from permway.campaign.predictions.sliding import shares
from permway.model.kept import Kept
from permway.problem.model import Model
from permway.recordings.channel import Sensor
from permway.response.rolling import Rolled
from permway.response.sliding import Remainder

__all__ = ["added_csd", "expected_csd", "influence", "solved_lines", "wheels_of"]

_READ: Kept[object, Complexes] = Kept(16)
"""What sensors read of the profile on a grid, by how the vehicle moves: a search may change the profile alone."""


@lru_cache(maxsize=32)
def _late(lines: bytes, lag: bytes) -> Complexes:
    """Phase by which what meets the leading wheel comes later to each wheel, shape (F, wheels)."""
    found = np.asarray(np.exp((-2j * np.pi * np.frombuffer(lines))[:, None] * np.frombuffer(lag)))
    found.flags.writeable = False
    return found


def expected_csd(
    model: Model,
    known: IrregularityKnown,
    condition: Condition,
    sensors: Sequence[Sensor],
    lines_Hz: Reals,
    per_profile: Complexes,
    estimate_Hz: Reals,
    *,
    segment_s: float,
    interpolated: bool,
    duration_s: float | None = None,
    left: Sequence[Remainder] = (),
    rolls: Rolled | None = None,
    away: bool = False,
) -> Complexes:
    """Expectation of Welch's cross-spectral matrix with Hann's window, and the noise of the channels.

    All wheels meet one profile, so its part of the spectrum is of rank one; so is each wheel's own roughness and
    each force on the vehicle, and they add. The window, which cannot resolve what comes late by a good part of a
    segment, makes them less coherent.

    Parameters
    ----------
    lines_Hz : ndarray, shape (L,)
        Frequencies of `per_profile`, from below the first estimate to above the last: see :func:`solved_lines`.
    per_profile : ndarray of complex128, shape (L, degrees, wheels)
        Not to be written to afterwards: what is read of it is kept while it lives.
    estimate_Hz : ndarray, shape (F,)
    segment_s : float
    interpolated : bool
        Whether the record was computed by interpolating transfer functions, lags and all, between `lines_Hz`.
    duration_s : float, optional
        Of the run, over which clocks run apart.
    left : sequence of Remainder
        Forces of suspensions that slide, as :func:`permway.campaign.predictions.sliding.worked` gives them.
    rolls : Rolled, optional
        Of a train that rolls, over the same lines; `per_profile` is then that of the standing train still, by
        which a wheel's own roughness and forces act.
    away : bool
        Whether each part counts by how far it is from its line, in lines, and noise not at all: what an error
        acts on that grows from line to line.

    Returns
    -------
    ndarray of complex128, shape (F, sensors, sensors)
        E[x_i conj(x_j)], units of the sensors in SI squared per hertz.

    Raises
    ------
    InputError
        If clocks run apart and nobody states how long.
    """
    assert model.train is not None
    # Straight lines between transfers that turn have kinks.
    broad, narrow = (
        grid_of(lines_Hz, estimate_Hz, segment_s, narrow=fine or interpolated) for fine in (False, True)
    )
    if away:
        broad, narrow = broad.away, narrow.away
    on_board = aboard(tuple(sensors), tuple(model.train.vehicle.degrees))
    chosen, flat = list(on_board.chosen), on_board.flat
    wheels = wheels_of(model, condition)
    lag = ((wheels[0] - wheels) / speed_of(condition)).tobytes()

    def expected(grid: Grid, fine: Complexes, density: Reals) -> Complexes:
        """Of what sensors on ideal chains read of a source on a grid; chains that are mere gains left out."""
        return grid.expected(fine if flat else fine * on_board.chains(grid.frequency_Hz), density)

    def met(grid: Grid, order: int, part: Complexes, met_Hz: Reals) -> Complexes:
        """What is read of the profile at some frequencies, by which the vehicle moves at the grid's."""
        if interpolated and rolls is None:
            shifted = np.einsum("fsw,fw->fs", part[:, chosen, :], _late(lines_Hz.tobytes(), lag))
            return grid.spread(shifted * on_board.there(lines_Hz), straight=True)
        shifted = grid.spread(part[:, chosen], _late(met_Hz.tobytes(), lag), straight=False)
        return shifted * on_board.ideal(grid)

    passing_Hz, orders, moved = 0.0, [0], [per_profile]
    if rolls is not None:
        passing_Hz, orders, moved = rolls.passing_Hz, rolls.orders.tolist(), list(rolls.per_profile)
    parts = []
    for order, part in zip(orders, moved, strict=True):
        met_Hz = broad.frequency_Hz + order * passing_Hz
        density = excitation.broad(model, known, condition, np.maximum(np.abs(met_Hz), broad.frequency_Hz[0]))
        each = [(broad, met_Hz, density)]
        if known.series and not order:
            each.append((narrow, narrow.frequency_Hz, excitation.series(known, condition, narrow)))
        for grid, at_Hz, density in each:
            read = _READ.of(
                per_profile if rolls is None else rolls,
                partial(met, grid, order, part, at_Hz),
                use=(order, grid, on_board.chosen, on_board.reads, lag, interpolated),
            )
            parts.append(expected(grid, read, density))
    for line_Hz, amplitudes in () if rolls is None else passing(rolls):
        at_Hz = np.array([line_Hz])
        seen = amplitudes[chosen] * on_board.there(at_Hz)[0]
        parts.append(broad.of_line(line_Hz, seen if flat else seen * on_board.chains(at_Hz)[0]))
    upper = np.asarray(sum(parts[1:], start=parts[0]))
    for sources, density in _sources(model, known, condition, narrow, lines_Hz, per_profile):
        for source in sources:
            fine = narrow.spread(source[:, chosen] * on_board.there(lines_Hz), straight=interpolated)
            upper += expected(narrow, fine, density)
    for remainder in left:
        per_force = pushed(model.train.vehicle, lines_Hz, remainder.rows, per_profile)[:, :, chosen]
        per_force = per_force * on_board.there(lines_Hz)[:, None, :]
        fine = narrow.spread(per_force.reshape(lines_Hz.size, -1), straight=interpolated)
        fine = fine.reshape(-1, *per_force.shape[1:])
        mixed = np.einsum("ntk,ntc->knc", shares(remainder, narrow.frequency_Hz), fine)
        upper += np.sum([expected(narrow, one, np.ones(len(fine))) for one in mixed], axis=0)
    if flat:
        upper *= on_board.gains
    apart = on_board.apart(estimate_Hz, segment_s, duration_s)
    if apart is not None:
        upper *= apart
    # Of a matrix that is its own adjoint the upper triangle is enough; lines are side by side in memory.
    (rows, columns), upper = on_board.pairs, np.ascontiguousarray(upper.T)
    matrix = np.empty((len(sensors), len(sensors), estimate_Hz.size), dtype=np.complex128)
    matrix[columns, rows] = upper.conj()
    matrix[rows, columns] = upper
    if not away:
        matrix += added_csd(on_board.sensors, lines_Hz, estimate_Hz, segment_s)
    return np.moveaxis(matrix, -1, 0)


def _sources(
    model: Model,
    known: IrregularityKnown,
    condition: Condition,
    grid: Grid,
    lines_Hz: Reals,
    per_profile: Complexes,
) -> Iterator[tuple[list[Complexes], Reals]]:
    """Sources beside the profile: how each moves the vehicle's degrees, (L, degrees), and their density, (N,)."""
    assert model.train is not None
    vehicle = model.train.vehicle
    for of, density in excitation.wheels(known, condition, len(vehicle.wheel_indices), grid):
        yield [per_profile[:, :, wheel] for wheel in of], density
    for source in known.pushes:
        row = np.eye(len(vehicle.degrees))[[vehicle.degrees.index(source.degree)]]
        yield [pushed(vehicle, lines_Hz, row, per_profile)[:, 0]], excitation.push(source, grid.frequency_Hz)
