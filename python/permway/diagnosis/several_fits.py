"""Several fits side by side: hypotheses in full, and rivals with sizes of smooth errors learnt anew."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.compete import Ring
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Build, Fit, Free
from permway.diagnosis.journal import Arrays, current
from permway.diagnosis.learning import learnt
from permway.diagnosis.quick import Quick, stacked
from permway.diagnosis.refit import learnt_on
from permway.diagnosis.side_by_side import Begun, each
from permway.errors import InputError, SolveError

NUMBERS = ("z", "covariance", "deviations", "clean", "chi2", "prior", "log_determinant", "jacobian", "heat")
"""What a fit found, beside what it was given."""

LEARNT_AT = "learnt_at"
"""Name of the z at which sizes were learnt."""

Item = TypeVar("Item")


def fitted_in_full(ring: Ring, quicks: Sequence[Quick], *, prefix: str, told: Begun) -> list[tuple[Quick, Fit]]:
    """Those that can be solved all around, with their fits.

    Parameters
    ----------
    ring : Ring
    quicks : sequence of Quick
    prefix : str
        Of the effects' parameters.
    told : callable
    """
    found = _each_kept(
        "fit in full",
        lambda quick: (ring.full(quick, prefix=prefix, settle=False), []),
        quicks,
        given=(prefix, *(q.z for q in quicks)),
        threads=ring.evidence.threads,
        told=told,
    )
    fits = []
    for quick, one in zip(quicks, found, strict=True):
        if isinstance(one, Fit):
            fits.append((quick, one))
        elif one is not None:
            build, more = stacked(ring.fit.build, quick.hypothesis, prefix)
            fits.append((quick, _restored(one, (*ring.fit.free, *more), build, ring.evidence)))
    return fits


def relearnt_all(fits: Sequence[Fit], sharp: Evidence, *, best: float, told: Begun) -> list[Fit | None]:
    """As :func:`permway.diagnosis.refit.relearnt`; None for one that ends where its model ends.

    Parameters
    ----------
    fits : sequence of Fit
    sharp : Evidence
        Of the records as they are.
    best : float
        Objective of a rival of all.
    told : callable
    """
    found = _each_kept(
        "relearn",
        lambda fit: learnt_on(fit, sharp, best=best),
        fits,
        given=(best, *(f.z for f in fits)),
        threads=sharp.threads,
        told=told,
    )
    return [
        one
        if one is None or isinstance(one, Fit)
        else _restored(one, fit.free, fit.build, _learnt_there(sharp, fit, one[LEARNT_AT]))
        for fit, one in zip(fits, found, strict=True)
    ]


def _learnt_there(evidence: Evidence, fit: Fit, path: Reals) -> Evidence:
    """What a fit learnt on its way in another process, or in another run."""
    for z in path:
        there = fit.build(_values(fit.free, z))
        evidence, _ = learnt(evidence, evidence.predicted(there))
    return evidence


def _each_kept(
    what: str,
    work: Callable[[Item], tuple[Fit, Sequence[Reals]]],
    items: Sequence[Item],
    *,
    given: Sequence[object],
    threads: int | None,
    told: Begun,
) -> list[Fit | Arrays | None]:
    """Fits of items, where they are made here, else their numbers and where they learnt sizes.

    None for what cannot be solved. All are one step of the journal.
    """
    here: dict[int, Fit] = {}

    def numbers(index: int) -> dict[str, np.ndarray]:
        try:
            # In a fork, what is known here is lost.
            here[index], path = work(items[index])
        except (InputError, SolveError):
            return {}
        found = {name: np.asarray(getattr(here[index], name)) for name in (*NUMBERS, "evaluations")}
        return {**found, LEARNT_AT: np.array(path).reshape(len(path), here[index].z.size)}

    journal = current()
    known = None if journal is None else journal.recall(what, *given)
    found: list[dict[str, np.ndarray]] = [{} for _ in items]
    if known is None:
        found = each(numbers, range(len(items)), threads=threads, told=told)
    else:
        for name, value in known.items():
            index, name = name.split(".")
            found[int(index)][name] = value
    if journal is not None and known is None:
        journal.keep({f"{i}.{name}": value for i, one in enumerate(found) for name, value in one.items()})
    return [here.get(index) or one or None for index, one in enumerate(found)]


def _restored(found: Arrays, free: tuple[Free, ...], build: Build, evidence: Evidence) -> Fit:
    numbers: dict[str, Any] = {name: found[name] if found[name].ndim else float(found[name]) for name in NUMBERS}
    return Fit(
        free=free,
        campaign=build(_values(free, found["z"])),
        evidence=evidence,
        build=build,
        evaluations=int(found["evaluations"]),
        **numbers,
    )


def _values(free: tuple[Free, ...], z: Reals) -> Mapping[str, float]:
    return {f.name: f.value(float(one)) for f, one in zip(free, z, strict=True)}
