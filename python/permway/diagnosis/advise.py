"""The next measurement: the one on the menu that would separate two rivals best, for its cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.predict import predict
from permway.diagnosis.clock import Progress
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import observations_of
from permway.diagnosis.menu import Item, menu
from permway.diagnosis.side_by_side import each
from permway.diagnosis.tangent import STEP
from permway.diagnosis.verdict_parts import NextMeasurement
from permway.errors import InputError, SolveError

MOST = 3
"""Measurements that are advised."""


def advise(
    right: Fit, other: Fit, names: tuple[str, str], *, progress: Progress | None = None
) -> tuple[NextMeasurement, ...]:
    """Which measurements would separate two rivals, the best for its cost first.

    Parameters
    ----------
    right, other : Fit
        Rivals fitted in full; the one is taken to be right, and the other may move its parameters.
    names : (str, str)
        Their names.
    """
    before = abs(other.objective - right.objective)
    found: list[tuple[float, NextMeasurement]] = []
    measured = right.observations.selected(right.observations.records).datasets
    items = list(menu(right.observations.campaign, measured))

    def started(index: int) -> None:
        if progress is not None:
            progress("advise", index, len(items))

    def expected(item: Item) -> float | None:
        try:
            return separation(item, right, other)
        except (InputError, SolveError):
            # What the model cannot predict cannot be advised.
            return None

    expectations = each(expected, items, threads=right.observations.threads, progress=started)
    for item, more in zip(items, expectations, strict=True):
        if more is None:
            continue
        advice = NextMeasurement(
            measurement=item.words,
            separates=names,
            separation_before=before,
            separation_after=before + more,
        )
        found.append((more / item.cost, advice))
    found.sort(key=lambda pair: -pair[0])
    return tuple(advice for _, advice in found[:MOST])


def separation(item: Item, right: Fit, other: Fit) -> float:
    """Deviance that a measurement is expected to add between two rivals."""
    truth = item.planned(right.campaign)
    (values,) = predict(truth, [item.dataset], threads=right.observations.threads)
    dataset = item.dataset
    measured = dataset.data.assign({name: values[name] for name in values.data_vars if name in dataset.data})
    observations = observations_of(truth, [replace(dataset, data=measured)], right.observations)

    # Residuals are compared with what noise does to them on the mean, and here is none.
    nothing = observations.residuals(observations.predicted(truth).datasets)

    def residuals(z: Reals) -> Reals:
        rival = item.planned(other.build({f.name: f.value(float(v)) for f, v in zip(other.free, z, strict=True)}))
        return observations.residuals(observations.predicted(rival).datasets) - nothing

    plain = residuals(other.z)
    jacobian = np.zeros((plain.size, other.z.size))
    for i, f in enumerate(other.free):
        moved = other.z.copy()
        step = STEP if moved[i] + STEP <= f.limits[1] else -STEP
        moved[i] += step
        jacobian[:, i] = (residuals(moved) - plain) / step
    whitener = observations.whitener
    reduced, left = whitener.reduce(jacobian), whitener.reduce(plain)
    curvature = jacobian.T @ jacobian - reduced.T @ reduced
    slope = jacobian.T @ plain - reduced.T @ left
    known = np.linalg.inv(other.covariance)
    square = float(plain @ plain - left @ left)
    return max(square - float(slope @ linalg.solve(known + curvature, slope, assume_a="pos")), 0.0)
