"""Distributions of powers, coherences and cross-spectral matrices against closed forms and other formulations."""

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.estimates.coherence import coherence_cdf, coherence_interval, unbiased_coherence
from permway.recordings.estimates.intervals import (
    frf_interval,
    log_frf_variance,
    log_power_moments,
    power_interval,
)
from permway.recordings.estimates.wishart import wishart_deviance, wishart_log_density
from scipy import integrate, special, stats


@pytest.mark.parametrize("freedom", [1.0, 7.3, 58.8, 4000.0])
def test_power_interval_is_chi_square(freedom):
    low, high = power_interval(3.0, freedom, level=0.9)
    assert low == pytest.approx(3.0 * freedom / stats.chi2.ppf(0.95, freedom))
    assert high == pytest.approx(3.0 * freedom / stats.chi2.ppf(0.05, freedom))
    mean, variance = log_power_moments(freedom)
    law = stats.loggamma(freedom / 2.0)
    assert mean == pytest.approx(law.mean() - np.log(freedom / 2.0), rel=1e-6)
    assert variance == pytest.approx(law.var(), rel=1e-6)


@pytest.mark.parametrize("averages", [2.4, 8.0, 29.4])
@pytest.mark.parametrize("truth", [0.0, 0.2, 0.7, 0.95])
def test_coherence_distribution_is_goodmans(averages, truth):
    """The density with its hypergeometric function, integrated."""

    def density(x):
        return (
            (averages - 1.0)
            * (1.0 - truth) ** averages
            * (1.0 - x) ** (averages - 2.0)
            * special.hyp2f1(averages, averages, 1.0, truth * x)
        )

    for x in (0.1, 0.6, 0.93):
        assert coherence_cdf(x, truth, averages) == pytest.approx(integrate.quad(density, 0.0, x)[0], abs=1e-8)


def test_coherence_distribution_joins_where_the_series_gives_way():
    """At a mean of 600 the fitted Gamma law takes over: a step of less than 6e-4 in probability."""
    for averages in (3.3, 12.0, 60.0):
        truth = 600.0 / (600.0 + averages)
        x = np.tanh(np.arctanh(np.sqrt(truth)) + np.linspace(-2.0, 2.0, 41) / np.sqrt(2.0 * averages)) ** 2
        before, after = (coherence_cdf(x, truth * (1.0 + s * 1e-9), averages) for s in (-1.0, 1.0))
        assert 0.0 < np.abs(after - before).max() < 6e-4


def test_coherence_interval_inverts_the_distribution():
    averages = 11.7
    sample = np.array([0.3, 0.6, 0.9, 0.99, 0.9999])
    low, high = coherence_interval(sample, averages, level=0.9)
    assert coherence_cdf(sample, high, averages) == pytest.approx(0.05, abs=5e-4)
    assert coherence_cdf(sample, low, averages) == pytest.approx(0.95, abs=5e-4)
    assert coherence_cdf(sample, unbiased_coherence(sample, averages), averages) == pytest.approx(0.5, abs=2e-3)
    assert np.all((low < sample) & (sample < high))


def test_no_coherence_is_within_the_interval_as_often_as_stated():
    """Without coherence the sample exceeds 1 - 0.025^(1/(K-1)) in 2.5 % (closed form); up to there 0 is within."""
    averages = 9.0
    edge = 1.0 - 0.025 ** (1.0 / (averages - 1.0))
    assert coherence_interval(edge * 0.999, averages).low == 0.0
    assert coherence_interval(edge * 1.001, averages).low > 0.0


def test_frf_interval_closed_forms():
    """The circle is Bendat and Piersol's F; the phase sin(dphi) = t s; little noise gives +- t s in ln|H|."""
    variance, freedom = log_frf_variance(0.9, 20.0), 38.0
    assert variance == pytest.approx(0.1 / 36.0)
    found = frf_interval(2.0j, variance, freedom)
    assert found.radius == pytest.approx(2.0 * np.sqrt(2.0 * variance * stats.f.ppf(0.95, 2, freedom)))
    reach = stats.t.ppf(0.975, freedom) * np.sqrt(variance)
    assert np.sin(found.phase_rad.high - np.pi / 2) == pytest.approx(reach)
    assert found.magnitude.high - found.magnitude.low == pytest.approx(4.0 * reach)
    lost = frf_interval(1.0, 2.0, 4.0)
    assert lost.magnitude.low == 0.0
    assert lost.phase_rad.high - lost.phase_rad.low == pytest.approx(2.0 * np.pi)


def draw(rng, truth, averages, count):
    """Complex Wishart matrices over K, for whole K."""
    root = np.linalg.cholesky(truth)
    size = truth.shape[0]
    z = rng.standard_normal((2, count, size, averages))
    x = root @ ((z[0] + 1j * z[1]) / np.sqrt(2.0))
    return x @ x.conj().transpose(0, 2, 1) / averages


TRUTH = np.array([[2.0, 0.5 + 0.3j, 0.1], [0.5 - 0.3j, 1.0, -0.2j], [0.1, 0.2j, 3e-6]])
TRUTH[2, :2] *= 1e-3
TRUTH[:2, 2] *= 1e-3


def test_wishart_of_one_channel_is_gamma():
    sample, truth, averages = np.array([[[0.7]]]), np.array([[[1.3]]]), 6.5
    expected = stats.gamma.logpdf(0.7, averages, scale=1.3 / averages)
    assert wishart_log_density(sample, truth, averages) == pytest.approx(expected)


def test_wishart_density_has_mass_one():
    """E over one law of the ratio of two densities is 1 (importance sampling, 40000 draws)."""
    samples = draw(np.random.default_rng(8), TRUTH, 9, 40_000)
    near = TRUTH.copy()
    near[0, 0] *= 1.1
    ratio = np.exp(wishart_log_density(samples, near, 9.0) - wishart_log_density(samples, TRUTH, 9.0))
    assert ratio.mean() == pytest.approx(1.0, abs=5.0 * ratio.std() / 200.0)


@pytest.mark.parametrize("averages", [4, 12, 100])
def test_deviance_of_exact_wishart_matrices(averages):
    """Its probability is uniform: 20000 draws, at most 0.5 % off anywhere (the Gamma law is no exact law)."""
    found = wishart_deviance(draw(np.random.default_rng(averages), TRUTH, averages, 20_000), TRUTH, averages)
    assert stats.kstest(found.probability, "uniform").statistic < 0.015
    assert np.mean(found.probability < 0.05) == pytest.approx(0.05, abs=0.006)
    assert found.standardised.std() == pytest.approx(1.0, abs=0.03)


def test_deviance_is_the_likelihood_lost():
    sample = draw(np.random.default_rng(1), TRUTH, 12, 5)
    best = wishart_log_density(sample, sample, 12.0)
    lost = 2.0 * (best - wishart_log_density(sample, TRUTH, 12.0))
    assert wishart_deviance(sample, TRUTH, 12.0).value == pytest.approx(lost)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: power_interval([1.0, np.nan], 4.0), r"power\[1\]: not finite"),
        (lambda: power_interval(-1.0, 4.0), "power: must not be negative"),
        (lambda: power_interval(1.0, 0.0), "degrees_of_freedom: must be above zero"),
        (lambda: power_interval(1.0, 4.0, level=95.0), "level: must lie between 0 and 1"),
        (lambda: coherence_interval(1.2, 8.0), r"coherence: must lie in \[0, 1\]"),
        (lambda: coherence_interval(0.5, 1.0), "averages: one average has a sample coherence of 1"),
        (lambda: log_frf_variance(0.0, 8.0), r"coherence: must lie in \(0, 1\]"),
        (lambda: frf_interval(np.nan, 0.1, 8.0), "frf: not finite"),
        (lambda: wishart_deviance(TRUTH, TRUTH, 2.5), "averages: a matrix of 3 channels needs at least 3"),
        (lambda: wishart_deviance(TRUTH[:2], TRUTH, 5.0), "sample: must be square"),
        (lambda: wishart_deviance(np.ones((2, 2)), np.eye(2), 5.0), "sample: not positive definite"),
        (lambda: wishart_deviance(np.diag([1.0, 0.0]), np.eye(2), 5.0), "sample: a channel without power"),
        (lambda: wishart_deviance([[1.0, 1j], [1j, 2.0]], np.eye(2), 5.0), "sample: not Hermitian"),
    ],
)
def test_bad_numbers(call, message):
    with pytest.raises(InputError, match=message):
        call()
