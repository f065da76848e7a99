"""Stretches whose ends are moved by stations, about a fit of their own.

From a stretch to one that has a joint more there is no way that is better all along; and a base that lacks what
acts is bent so far that it does not tell where that ends. A model that has most of it does.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.catalogue._interval import spacing_of
from permway.diagnosis.fit import Fit
from permway.diagnosis.glance import Glance
from permway.diagnosis.quick import Quick
from permway.diagnosis.refit import settled
from permway.errors import InputError

STRETCH = ("centre_m", "length_m")
"""Constants by which a hypothesis says where it begins and ends."""

FURTHER = 4
"""Stations by which either end is moved."""

SPACING_M = 1.0
"""Between stations along a body, which has none of its own."""

WORTH = 5.0
"""Of the objective, that other ends have to promise before a model with them is fitted."""


def further(fit: Fit, found: Quick, prefix: str) -> Quick | None:
    """The same over the stretch that explains most, all other parameters moving in a straight line from a fit.

    Parameters
    ----------
    fit : Fit
        Of base and effect together.
    found : Quick
        From where; of its hypothesis.
    prefix : str
        Of the effect's parameters among the fit's.

    Returns
    -------
    Quick or None
        None if the hypothesis is not over a stretch, or no other one promises more.
    """
    own = len(fit.free) - len(found.hypothesis.free)
    names = [prefix + name for name in STRETCH]
    if [f.name for f in fit.free[own:] if f.name in names] != names:
        return None
    fit = settled(fit)
    glance = Glance(fit, apart=names)
    known = glance.objective(fit.campaign)
    tried = _beside(fit, found, names)
    objectives = [_objective(glance, fit, z) for z in tried]
    if not tried or not min(objectives) < known - WORTH:
        return None
    z = tried[int(np.argmin(objectives))]
    return replace(found, z=z[own:], base_z=z[:own], columns=None)


def _objective(glance: Glance, fit: Fit, z: Reals) -> float:
    try:
        campaign = fit.build({f.name: f.value(float(v)) for f, v in zip(fit.free, z, strict=True)})
    except InputError:
        return np.inf
    return glance.objective(campaign)


def _beside(fit: Fit, found: Quick, names: list[str]) -> list[Reals]:
    """Coordinates with each end some stations further out, or in."""
    line = fit.campaign.model.line
    what = found.hypothesis.locate(found.values).what
    step = spacing_of(line, what) if what in line.laws else SPACING_M
    centre, length = ([f.name for f in fit.free].index(name) for name in names)
    # A station of place or length, in coordinates.
    along, longer = (step / (fit.free[at].value(1.0) - fit.free[at].value(0.0)) for at in (centre, length))
    tried = []
    for left, right in product(range(-FURTHER, FURTHER + 1), repeat=2):
        z = fit.z.copy()
        z[centre] += 0.5 * (left + right) * along
        z[length] += (right - left) * longer
        inside = all(fit.free[at].limits[0] <= z[at] <= fit.free[at].limits[1] for at in (centre, length))
        if inside and (left or right):
            tried.append(z)
    return tried
