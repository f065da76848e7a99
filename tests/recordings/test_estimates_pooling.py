"""Repeats pooled: closed forms, direct maximisation, coverage."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from permway.errors import InputError
from permway.recordings.estimates.intervals import log_power_moments, power_interval
from permway.recordings.estimates.pooling import pool_repeats, pool_spectra
from permway.recordings.estimates.welch import cross_spectra
from scipy import optimize, stats

Y = np.array([0.10, 0.44, -0.21, 0.63, 0.28])
V = np.array([0.02, 0.05, 0.03, 0.01, 0.04])


def test_dersimonian_laird_by_hand():
    """DerSimonian and Laird's formulas, written out."""
    w = 1.0 / V
    fixed = np.dot(w, Y) / w.sum()
    q = np.dot(w, (Y - fixed) ** 2)
    tau2 = (q - 4.0) / (w.sum() - np.dot(w, w) / w.sum())
    pooled = pool_repeats(Y, V, between="dersimonian_laird")
    assert pooled.between == pytest.approx(tau2)
    assert pooled.heterogeneity == pytest.approx(stats.chi2.sf(q, 4))
    assert pooled.mean == pytest.approx(np.average(Y, weights=1.0 / (V + tau2)))


def test_restricted_likelihood_is_the_maximum():
    def loss(tau2):
        w = 1.0 / (V + tau2)
        mean = np.average(Y, weights=w)
        return np.sum(np.log(V + tau2)) + np.log(w.sum()) + np.dot(w, (Y - mean) ** 2)

    best = optimize.minimize_scalar(loss, bounds=(0.0, 1.0), method="bounded", options={"xatol": 1e-10}).x
    assert pool_repeats(Y, V).between == pytest.approx(best, rel=1e-5)


@given(st.integers(2, 9), st.floats(1e-3, 1e3), st.integers(0, 10**6))
def test_equal_variances_give_the_plain_mean_and_students_t(count, variance, seed):
    """With equal variances Hartung and Knapp's is the usual t interval."""
    value = 10.0 * np.sqrt(variance) * np.random.default_rng(seed).standard_normal(count)
    pooled = pool_repeats(value, np.full(count, variance))
    assert pooled.mean == pytest.approx(value.mean(), abs=1e-9 * np.sqrt(variance))
    assert pooled.between == pytest.approx(max(value.var(ddof=1) - variance, 0.0), rel=1e-6, abs=1e-6 * variance)
    usual = value.var(ddof=1) / count
    assert pooled.variance == pytest.approx(usual, rel=1e-6)
    assert pooled.interval.high - pooled.mean == pytest.approx(
        stats.t.ppf(0.975, count - 1) * usual**0.5, rel=1e-6
    )


def test_none_between_is_inverse_variance():
    pooled = pool_repeats(Y, V, between="none")
    assert pooled.variance == pytest.approx(1.0 / (1.0 / V).sum())
    assert np.isinf(pooled.degrees_of_freedom)
    assert pooled.interval.high - pooled.mean == pytest.approx(1.959964 * pooled.variance**0.5, rel=1e-6)


@pytest.mark.parametrize("between", ["reml", "dersimonian_laird"])
@pytest.mark.parametrize("repeats", [3, 6, 12])
def test_pooled_intervals_of_powers_cover(repeats, between):
    """Powers of unequal K about a level that varies by 1.5 dB: 8000 elements, logarithms freed of their bias."""
    rng = np.random.default_rng([11, repeats])
    freedom = 2.0 * rng.uniform(8.0, 40.0, size=(repeats, 1))
    level = 0.345 * rng.standard_normal((repeats, 8000))
    power = np.exp(level) * rng.gamma(freedom / 2.0, 2.0 / freedom, size=level.shape)
    bias, variance = log_power_moments(freedom)
    pooled = pool_repeats(np.log(power) - bias, np.broadcast_to(variance, power.shape), between=between)
    assert np.mean(pooled.interval.covers(0.0)) == pytest.approx(0.95, abs=0.02)
    if between == "reml":
        assert np.mean(pooled.between) == pytest.approx(0.345**2, rel=0.1)


def test_pooled_spectra_are_one_longer_estimate():
    record = np.random.default_rng(2).standard_normal((120, 4, 700))
    covered = []
    for parts in record:
        data = pool_spectra(
            [
                cross_spectra(part[:length], sampling_Hz=100.0, segment_s=1.0)
                for part, length in zip(parts, (700, 300, 500, 120), strict=True)
            ]
        )
        interval = power_interval(data["psd"].values[0, 3:-3], data["degrees_of_freedom"].values[3:-3])
        covered.append(interval.covers(0.02))
    assert data.averages == pytest.approx(data["degrees_of_freedom"].values[10] / 2.0)
    assert data["line_covariance"].values[0] == pytest.approx(1.0 / data.averages)
    assert 0.93 <= np.mean(covered) <= 0.97


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pool_repeats([1.0], [1.0]), "needs at least two repeats"),
        (lambda: pool_repeats(Y, V[:3]), "a variance for each value"),
        (lambda: pool_repeats(Y, 0.0 * V), "variance: must be above zero"),
        (lambda: pool_repeats([1.0, np.nan], [1.0, 1.0]), r"estimate\[1\]: not finite"),
        (lambda: pool_repeats(Y, V, between="ml"), "between: unknown"),
        (lambda: pool_spectra([]), "spectra: empty"),
        (
            lambda: pool_spectra(
                [cross_spectra(np.ones(90) * Y[0] + np.arange(90.0), sampling_Hz=9.0, segment_s=s) for s in (2, 3)]
            ),
            r"spectra\[1\]: its frequency is not that of the first",
        ),
    ],
)
def test_bad_repeats(call, message):
    with pytest.raises(InputError, match=message):
        call()
