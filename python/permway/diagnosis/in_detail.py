"""The hypothesis that leads, told in more detail: over the stretch that explains most, and by more constants."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.diagnosis.choose import penalty
from permway.diagnosis.compete import Ring
from permway.diagnosis.ends import further
from permway.diagnosis.fit import Fit
from permway.diagnosis.quick import Quick
from permway.diagnosis.recalibrate import UNFIT, recalibrate
from permway.diagnosis.refit import relearnt
from permway.errors import InputError, SolveError

NEARLY = 1.05
"""Mean square of the deviations from which the leading hypothesis is told by more constants, if it can be."""

PASSES = 8
"""Times that a stretch is moved at its ends."""

Told = tuple[Quick, Fit, Fit]
"""A hypothesis as it was begun with, fitted in full, and with sizes of smooth errors learnt."""


def in_detail(ring: Ring, told: Told, learnt_base: Fit, prefix: str) -> Told:
    """The same, or over another stretch, or more finely, as far as it gains by it.

    Parameters
    ----------
    ring : Ring
        Of what the hypothesis is put into.
    told : (Quick, Fit, Fit)
    learnt_base : Fit
        The base with sizes learnt.
    prefix : str
        Of the effect's parameters.
    """
    told = _over_its_stretch(ring, told, learnt_base, prefix)
    while (begun := _finer(ring, told)) is not None:
        nearer = _full(ring, begun, prefix)
        finer = None if nearer is None else _better(ring, (begun, nearer, nearer), told, learnt_base)
        if finer is None:
            break
        told = finer
    return told


def _over_its_stretch(ring: Ring, told: Told, learnt_base: Fit, prefix: str) -> Told:
    """With its ends where a fit in full does best."""
    one, rough, amended = told
    # Blunted responses do not tell between stretches that all explain them.
    best = rough if rough.heat > UNFIT else amended
    for _ in range(PASSES):
        begun = further(best, one, prefix)
        if begun is None:
            break
        try:
            nearer = recalibrate(
                best.evidence,
                build=best.build,
                free=best.free,
                start=np.concatenate([begun.base_z, begun.z]),
                learn=False,
                settle=False,
            )
        except (InputError, SolveError):
            break
        if nearer.objective > best.objective:
            break
        one, best = begun, nearer
    if one is told[0]:
        return told
    again = best if best.evidence is rough.evidence else _full(ring, one, prefix)
    return told if again is None else _better(ring, (one, again, best), told, learnt_base) or told


def _finer(ring: Ring, told: Told) -> Quick | None:
    """To begin with by more constants, if what it leaves asks for it."""
    one, _, amended = told
    own = len(ring.fit.free)
    values = {f.name: f.value(float(z)) for f, z in zip(one.hypothesis.free, amended.z[own:], strict=True)}
    finer = one.hypothesis.finer(values) if amended.heat > NEARLY else None
    if finer is None:
        return None
    return replace(one, hypothesis=finer, z=np.array(finer.starts[0]), base_z=amended.z[:own], columns=None)


def _full(ring: Ring, begun: Quick, prefix: str) -> Fit | None:
    """Base and effect together; None if that cannot be solved."""
    try:
        return ring.full(begun, prefix=prefix, settle=False)
    except (InputError, SolveError):
        return None


def _better(ring: Ring, other: Told, told: Told, learnt_base: Fit) -> Told | None:
    """With sizes learnt from its last fit, if it then does better than what was known."""
    begun, rough, last = other
    try:
        amended = relearnt(last, learnt_base.evidence)
    except (InputError, SolveError):
        return None
    before, _, known = told
    if amended.objective + penalty(begun, ring) > known.objective + penalty(before, ring):
        return None
    return replace(begun, gain=before.gain + known.objective - amended.objective), rough, amended
