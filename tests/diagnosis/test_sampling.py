"""An effect's parameters sampled, against the closed form where there is one, and against nested sampling."""

from __future__ import annotations

import dynesty
import numpy as np
import pytest
from permway.diagnosis.catalogue import layer_damping, sensor_gain
from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import WIDTH, Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.sampling import ENDS, Posterior, sampled
from scipy import stats
from simulated import simulate


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    case = simulate(tmp_path_factory.mktemp("sampled") / "c", 11)
    return recalibrate(gather(case.campaign, threads=1), learn=False)


def amended(base: Fit, hypothesis: object) -> Fit:
    ring = Ring(base)
    return ring.full(ring.quick(hypothesis), prefix="1.")  # type: ignore[arg-type]


def test_a_gain_whose_logarithm_is_normal_is_as_laplace_has_it(base: Fit) -> None:
    (gain,) = (h for h in sensor_gain.hypotheses(Situation(base, ())) if h.locate({}).channels == ("deck@3",))
    fit = amended(base, gain)
    found = sampled(fit, ["1.gain"], draws=600, seed=1)
    assert found is not None
    assert found.effective > 200.0
    assert abs(found.correction) < 4.0 * found.standard_error + 0.02
    z, sigma = fit.z[-1], np.sqrt(fit.covariance[-1, -1])
    assert found.spans["1.gain"] == pytest.approx((z - WIDTH * sigma, z + WIDTH * sigma), abs=0.25 * sigma)


def test_the_same_seed_draws_the_same_and_too_few_draws_say_nothing(base: Fit) -> None:
    (gain,) = (h for h in sensor_gain.hypotheses(Situation(base, ())) if h.locate({}).channels == ("deck@3",))
    fit = amended(base, gain)
    assert sampled(fit, ["1.gain"], draws=60, seed=2) == sampled(fit, ["1.gain"], draws=60, seed=2)
    with pytest.warns(UserWarning, match=r"12 draws of 1\.gain count for less than 20 .* take more draws"):
        assert sampled(fit, ["1.gain"], draws=12, seed=2) is None


@pytest.mark.injection
def test_evidence_and_ends_are_those_of_nested_sampling(base: Fit) -> None:
    """Dashpots that are not there: their share piles up at its limit, and no normal density describes that."""
    hypothesis = next(iter(layer_damping.hypotheses(Situation(base, ()))))
    fit = amended(base, hypothesis)
    own = ["1." + f.name for f in hypothesis.free]
    found = sampled(fit, own, draws=1000, seed=3)
    assert found is not None
    posterior = Posterior(fit, own)
    low, high = (stats.norm.cdf(ends) for ends in posterior.limits)

    def drawn(uniform: np.ndarray) -> np.ndarray:
        return np.asarray(stats.norm.ppf(low + uniform * (high - low)))

    def likelihood(z: np.ndarray) -> float:
        return max(posterior(np.clip(z, *posterior.limits)) + 0.5 * float(z @ z), -1e30)

    sampler = dynesty.NestedSampler(
        likelihood, drawn, len(own), nlive=60, rstate=np.random.default_rng(4), sample="unif"
    )
    sampler.run_nested(dlogz=0.1, print_progress=False)
    nested = sampler.results
    # Laplace's own evidence of the same density, less the normal prior's constant, which it has taken in.
    laplace = 0.5 * np.linalg.slogdet(posterior.covariance)[1]
    theirs = float(nested.logz[-1]) + float(np.log(np.prod(high - low)))
    spread = float(np.hypot(nested.logzerr[-1], found.standard_error))
    assert found.correction == pytest.approx(theirs - laplace, abs=4.0 * spread)
    weight = np.exp(nested.logwt - nested.logz[-1])
    for index, name in enumerate(own):
        order = np.argsort(nested.samples[:, index])
        reached = np.cumsum(weight[order]) / weight.sum()
        ends = np.interp(ENDS, reached, nested.samples[order, index])
        width = float(np.diff(ends)[0])
        assert found.spans[name] == pytest.approx(tuple(ends), abs=0.15 * width)
