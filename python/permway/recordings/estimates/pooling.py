"""Repeats pooled: what varies within a repeat, and what varies between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import special

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, attribute, check_level, variable
from permway.recordings.estimates.intervals import Interval

Between = Literal["reml", "dersimonian_laird", "none"]

_ROUNDS = 60


class Pooled(NamedTuple):
    """A pooled estimate, all of the shape of one repeat."""

    mean: Reals
    variance: Reals
    """Of the pooled mean."""
    degrees_of_freedom: Reals
    """Of that variance; Student's t with so many gives the interval."""
    between: Reals
    """Variance from repeat to repeat, beyond what each repeat's own variance explains."""
    heterogeneity: Reals
    """Probability of repeats that differ at least as much, if nothing varies between them (Cochran's Q)."""
    interval: Interval


def pool_repeats(
    estimate: ArrayLike, variance: ArrayLike, *, between: Between = "reml", level: float = 0.95
) -> Pooled:
    """Mean of repeats with the variance between them, element by element.

    Give logarithms: ln of powers or of moduli (with their bias taken off, `log_power_moments`), phases in rad
    near one another. The mean is weighted by 1 / (own + between). The between part is DerSimonian and Laird's
    (1986) moment estimate, or restricted maximum likelihood (Viechtbauer 2005, by Fisher's scoring). The
    variance of the mean is Hartung and Knapp's (2001), sum w (y - mean)^2 / ((n - 1) sum w), with n - 1 degrees
    of freedom: right on the whole, though few repeats that agree by chance look surer than they are. With
    "none" it is 1 / sum w, and known.

    Parameters
    ----------
    estimate, variance : array_like, shape (repeat, ...)
        Each repeat's estimate and its own variance.
    between : "reml", "dersimonian_laird" or "none"
    level : float
        Of the interval.

    Raises
    ------
    InputError
        For fewer than two repeats, NaN, or variances that are not positive.
    """
    if between not in get_args(Between):
        raise InputError("unknown", where="between", value=between, remedy=f"use one of {get_args(Between)}")
    value, own = as_reals(estimate, "estimate"), as_reals(variance, "variance")
    if value.shape != own.shape or value.ndim == 0 or value.shape[0] < 2:
        raise InputError(
            "needs at least two repeats, and a variance for each value",
            where="estimate, variance",
            value=f"shapes {value.shape} and {own.shape}",
        )
    if np.any(own <= 0.0):
        raise InputError("must be above zero", where="variance", value=float(own.min()))
    count = value.shape[0]
    plain = 1.0 / own
    spread = _weighted_spread(value, plain)
    chance = np.asarray(special.gammaincc(0.5 * (count - 1), 0.5 * spread))
    moment = np.maximum(
        (spread - (count - 1)) / (plain.sum(axis=0) - (plain**2).sum(axis=0) / plain.sum(axis=0)), 0.0
    )
    tau2 = np.zeros_like(moment) if between == "none" else moment
    if between == "reml":
        tau2 = _restricted_likelihood(value, own, moment)
    weight = 1.0 / (own + tau2)
    mean = np.sum(weight * value, axis=0) / weight.sum(axis=0)
    pooled = 1.0 / weight.sum(axis=0)
    freedom = np.full(mean.shape, np.inf)
    if between != "none":
        pooled = pooled * _weighted_spread(value, weight) / (count - 1)
        freedom = np.full(mean.shape, count - 1.0)
    tail = 0.5 * (1.0 - check_level(level))
    known = np.isinf(freedom)
    quantile = np.where(
        known, special.ndtri(1.0 - tail), special.stdtrit(np.where(known, 1.0, freedom), 1.0 - tail)
    )
    reach = quantile * np.sqrt(pooled)
    return Pooled(mean, pooled, freedom, tau2, chance, Interval(mean - reach, mean + reach))


def _weighted_spread(value: Reals, weight: Reals) -> Reals:
    mean = np.sum(weight * value, axis=0) / weight.sum(axis=0)
    return np.asarray(np.sum(weight * (value - mean) ** 2, axis=0))


def _restricted_likelihood(value: Reals, own: Reals, start: Reals) -> Reals:
    """Fisher's scoring for all elements together; the between variance is kept at zero or above."""
    tau2 = start
    for _ in range(_ROUNDS):
        weight = 1.0 / (own + tau2)
        total = weight.sum(axis=0)
        square = (weight**2).sum(axis=0)
        mean = np.sum(weight * value, axis=0) / total
        score = np.sum(weight**2 * (value - mean) ** 2, axis=0) - total + square / total
        information = square - 2.0 * (weight**3).sum(axis=0) / total + (square / total) ** 2
        following = np.maximum(tau2 + score / information, 0.0)
        settled = np.abs(following - tau2) <= 1e-10 * (following + own.mean(axis=0))
        tau2 = following
        if np.all(settled):
            break
    return np.asarray(tau2)


def pool_spectra(spectra: Sequence[xr.Dataset]) -> xr.Dataset:
    """Cross spectra of repeats that differ by chance alone, averaged by their number of averages.

    K adds up, and with it the degrees of freedom. Where repeats differ by more than chance, as blows of different
    men do, pool their logarithms with `pool_repeats` instead.

    Raises
    ------
    InputError
        For channels, lines or windows that are not the same throughout.
    """
    if not spectra:
        raise InputError("empty", where="spectra", remedy="give at least one dataset")
    first = spectra[0]
    for place, other in enumerate(spectra):
        variable(other, "csd", f"spectra[{place}]")
        for name in ("channel", "frequency", "unit"):
            if not np.array_equal(first[name].values, other[name].values):
                raise InputError(f"its {name} is not that of the first", where=f"spectra[{place}]")
        if first.attrs.get("window") != other.attrs.get("window"):
            raise InputError("its window is not that of the first", where=f"spectra[{place}]")
    share = np.array([attribute(data, "averages", f"spectra[{i}]") for i, data in enumerate(spectra)])
    answer = first.copy()
    for name in ("csd", "psd"):
        answer[name] = first[name].copy(
            data=sum(k * data[name].values for k, data in zip(share, spectra, strict=True)) / share.sum()
        )
    answer["degrees_of_freedom"] = first["degrees_of_freedom"].copy(
        data=sum(data["degrees_of_freedom"].values for data in spectra)
    )
    answer["line_covariance"] = first["line_covariance"].copy(
        data=sum(k**2 * d["line_covariance"].values for k, d in zip(share, spectra, strict=True))
        / share.sum() ** 2
    )
    return answer.assign_attrs(
        averages=float(share.sum()),
        segments=int(sum(data.attrs["segments"] for data in spectra)),
        duration_s=float(sum(data.attrs["duration_s"] for data in spectra)),
        repeats=len(spectra),
    )
