"""How much less parameters are known because no structure is quite the beams and springs of its model.

A stiffness that is a constant in the model is none in the structure, nor in another discretisation of it: a mesh
is stiffer the shorter the waves, a slab shears, a bed is no row of springs. Of thousands of lines each constant
would be told to some millionths, if its law were exact. So every law's stiffness and each body's bending stiffness
is taken to be off by a little, smoothly over frequency, and what that moves parameters by adds to their variance.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import Fit
from permway.diagnosis.nearby import Nearby, Part
from permway.diagnosis.side_by_side import SMALL, each
from permway.model.line import Line

OFF: dict[Part, float] = {"law": 2e-4, "bending": 8e-4}
"""Standard deviation of the share by which a stiffness is off. So large is what the parameters of the practice
campaigns, made by another discretisation and known to all digits, come out wrong by: of a pad 0.03 %, of a slab,
which bends in short waves, 1.5 to 2 %."""

APART, WIDTH = 1.0, 0.6
"""Octaves between the humps that the share is made of, and their width: their squares add up alike anywhere."""

STEP = 1e-4
"""Of finite differences, as a share."""


def idealised(fit: Fit) -> Reals:
    """Variance of the parameters' z, shape (p,); none where derivatives would cost too much."""
    evidence, found = fit.evidence, np.zeros(fit.z.size)
    solved = evidence.predicted(fit.campaign)
    nearby, line = Nearby(evidence, solved), fit.campaign.model.line
    low, high = np.log2([evidence.rows.frequency_Hz.min(), evidence.rows.frequency_Hz.max()])
    centres = np.arange(low, high + APART, APART)
    plain = evidence.deviations(solved.datasets)
    reduced = evidence.whitener.reduce(fit.jacobian)

    def variance(of: tuple[Part, list[int], float]) -> Reals | None:
        part, indices, centre = of
        bent = nearby.bent(part, indices, partial(_hump, centre=centre))
        if bent is None:
            return None
        off = (evidence.deviations(bent.datasets) - plain) * (OFF[part] / STEP)
        slope = (fit.jacobian.T @ off - reduced.T @ evidence.whitener.reduce(off)) / fit.heat
        return np.asarray((fit.covariance @ slope) ** 2)

    nearby.derive()
    humps = [(part, indices, float(centre)) for part, indices in _parts(line) for centre in centres]
    for one in each(variance, humps, threads=evidence.threads, least=SMALL):
        if one is None:
            return found
        found += one
    return found


def _parts(line: Line) -> Iterator[tuple[Part, list[int]]]:
    """Each law, and each body with all its spans."""
    for index in range(len(line.laws)):
        yield "law", [index]
    bodies = [segment.body for _, segment in line.beams()]
    for name in dict.fromkeys(bodies):
        yield "bending", [index for index, body in enumerate(bodies) if body == name]


def _hump(frequency_Hz: Reals, *, centre: float) -> Reals:
    return np.asarray(STEP * np.exp(-0.5 * ((np.log2(frequency_Hz) - centre) / WIDTH) ** 2))
