"""What the idealisation of a model may do to its residuals: stiffness and mass vary a little over frequency.

Two discretisations of one structure differ by some hundredths of a per cent, smoothly over frequency and in all
records alike: a mesh is stiffer the shorter the waves, a slab shears, a bed is no row of springs. That is a change
of the structure, and no new error of each line.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.polynomial import legendre

from permway.arrays import Reals
from permway.diagnosis.nearby import Nearby, Part
from permway.diagnosis.side_by_side import SMALL, each
from permway.model.line import Line
from permway.posterior.fit import Fit

SHAPES = 4
"""Legendre's polynomials of octaves, the constant among them: over five octaves they follow what takes two."""

STEP = 1e-4
"""Of differences, as a share."""

LARGEST = 0.002
"""Share up to which the idealisation is expected to go: two standard deviations of its size."""

SHOWN = 0.01
"""Square of an error of that size, in standard deviations, below which it is left out: it would change the
evidence by less than 0.005 nats."""


def idealised(fit: Fit) -> Reals:
    """Columns: each law, beam and mass of the line, off by a share of 1 that varies over frequency.

    How large the share is, is a hyperparameter.

    Parameters
    ----------
    fit : Fit

    Returns
    -------
    ndarray, shape (n, b)
        None where derivatives by all parts would cost too much.
    """
    observations, campaign = fit.frame.observations, fit.state.solved.campaign
    solved = observations.predicted(campaign)
    octaves = np.log2(observations.rows.frequency_Hz)
    band = float(octaves.min()), float(octaves.max())
    nearby = Nearby(observations, solved)
    nearby.derive()

    def column(of: tuple[Part, list[int], int]) -> Reals | None:
        part, indices, order = of
        bent = nearby.perturbed(part, indices, partial(_share, band=band, order=order))
        if bent is None:
            return None
        return np.asarray((observations.residuals(bent.datasets) - fit.state.residuals) / STEP)

    wanted = [(part, indices, order) for part, indices in _parts(campaign.model.line) for order in range(SHAPES)]
    found = [one for one in each(column, wanted, threads=observations.threads, least=SMALL) if one is not None]
    if not found:
        return np.zeros((octaves.size, 0))
    # Turned, errors of one variance stay such; most combinations of them do not show.
    columns = np.column_stack(found)
    roots = fit.covariance.roots(columns)
    shown, turn = np.linalg.eigh(roots.times(roots))
    return np.asarray(columns @ turn[:, shown * LARGEST**2 > SHOWN])


def _parts(line: Line) -> Iterator[tuple[Part, list[int]]]:
    """Each law, each body with all its spans, and all masses."""
    for index in range(len(line.laws)):
        yield "law", [index]
    bodies = [segment.body for _, segment in line.beams()]
    for name in dict.fromkeys(bodies):
        spans = [index for index, body in enumerate(bodies) if body == name]
        yield "bending", spans
        yield "mass", spans
    if line.masses_kg().size:
        yield "point", list(range(line.masses_kg().size))


def _share(frequency_Hz: Reals, *, band: tuple[float, float], order: int) -> Reals:
    """A polynomial of octaves between -1 and 1 over the records' band."""
    low, high = band
    x = np.clip((2.0 * np.log2(frequency_Hz) - low - high) / max(high - low, 1e-9), -1.0, 1.0)
    return np.asarray(STEP * legendre.legval(x, np.eye(SHAPES)[order]))
