"""Parts of the likelihood: what idealisation does to residuals, and what channels do not share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.blocks_spectra import UNSHARED, SpectraBlock
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather, observations_of
from permway.diagnosis.observations import Observations
from permway.posterior.covariance import Frame
from permway.posterior.fit import Model
from permway.posterior.fitter import Fitter
from permway.posterior.hyper import IDEALISATION
from permway.posterior.idealised import LARGEST, SHOWN, idealised
from simulated import simulate
from simulated_train import measured, tables, written


@pytest.mark.parametrize("name", ["pad.k", "deck.E"])
@pytest.mark.parametrize("power", [0, 1])
def test_idealisation_is_a_stiffness_that_is_off_at_each_frequency(tmp_path: Path, name: str, power: int) -> None:
    """What a stiffness does that is 0.2 % off, evenly or in proportion to octaves, is one unit of such columns."""
    campaign = simulate(tmp_path / "c", 3).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    model = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(model, np.zeros(len(model.free)), fitter.frame.first())
    observations = fitter.frame.observations
    octaves = np.log2(observations.rows.frequency_Hz)
    x = (2.0 * octaves - octaves.min() - octaves.max()) / (octaves.max() - octaves.min())
    values = {f.name: f.value(0.0) for f in model.free}
    moved = campaign.with_values(values | {name: values[name] * (1.0 + 0.01 * LARGEST)})
    change = 100.0 * (observations.residuals(observations.predicted(moved).datasets) - fit.state.residuals)
    expected = np.where(fitter.frame.statistic == "frf", change * x**power, 0.0)
    columns = LARGEST * idealised(fit)
    roots = fit.covariance.roots(columns)
    units = np.linalg.solve(roots.times(roots), roots.times(fit.covariance.roots(expected[:, None])))[:, 0]
    whole, left = (fit.covariance.square(v) for v in (expected, expected - columns @ units))
    assert whole > 10.0 * SHOWN
    assert left < 2.0 * SHOWN + 1e-4 * whole
    assert np.linalg.norm(units) <= 1.02


def test_idealisation_has_a_size_of_its_own(tmp_path: Path) -> None:
    """The covariance with half the size is that of columns half as large; other columns keep theirs."""
    campaign = written(tmp_path, *tables(cold=False))
    frame = Frame.of(gather(campaign, measured(campaign, 5), threads=1))
    count, own = frame.sigma.size, frame.columns.shape[1]
    columns = np.random.default_rng(3).normal(size=(count, 4)) * 100.0
    first = frame.first()
    half = first.moved(first.log - np.log(2.0) * np.array([name == IDEALISATION for name in first.names]))
    size, values = first[IDEALISATION], np.linspace(-1.0, 1.0, count)[:, None]
    assert own
    assert half[IDEALISATION] == pytest.approx(0.5 * size)
    one = frame.with_idealisation(columns).covariance(half)
    other = frame.with_idealisation(0.5 * columns).covariance(first)
    assert one.apply(values) == pytest.approx(other.apply(values), rel=1e-9, abs=1e-12)
    assert one.log_determinant == pytest.approx(other.log_determinant)
    # What is given again replaces what is there.
    assert frame.with_idealisation(columns).with_idealisation(columns[:, :1]).columns.shape[1] == own + 1


def test_what_channels_do_not_share_is_one_error_of_a_run(tmp_path: Path) -> None:
    """The column is what incoherent power that is 5 % larger does to the residuals, and nothing else."""
    campaign = written(tmp_path, *tables(cold=False))
    datasets = measured(campaign, 5)
    observations: Observations = observations_of(campaign, datasets, gather(campaign, datasets, threads=1))
    block = next(b for b in observations.blocks if isinstance(b, SpectraBlock))
    rest = np.array([" rest " in label for label in block.rows.channel])
    column = UNSHARED * block.unshared
    assert rest.any()
    assert np.array_equal(column != 0.0, rest)
    assert column[rest] == pytest.approx(UNSHARED * 4.343 / block.rows.scale_dB[rest], rel=1e-3)
