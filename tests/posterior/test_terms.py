"""Parts of the likelihood: what idealisation does to residuals, and what channels do not share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import evidence_of, gather
from permway.posterior.covariance import UNSHARED, Frame
from permway.posterior.fit import Fitter, Model
from permway.posterior.idealised import SIZE, idealised
from simulated import simulate
from simulated_train import measured, tables, written


@pytest.mark.parametrize("index", [0, 2])
def test_idealisation_is_a_parameter_that_is_off_at_each_frequency(tmp_path: Path, index: int) -> None:
    """At one line the first column is the change that a parameter makes which is off by 0.3 % times octaves."""
    campaign = simulate(tmp_path / "c", 3).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    model = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(model, np.zeros(len(model.free)), fitter.frame.first())
    columns = idealised(fit)
    evidence = fitter.frame.evidence
    frequency = evidence.rows.frequency_Hz
    octaves = np.log2(frequency)
    at = np.median(np.unique(frequency)[:-3])
    line = np.isclose(frequency, np.unique(frequency)[np.argmin(np.abs(np.unique(frequency) - at))])
    line &= fitter.frame.statistic == "frf"
    x = 2.0 * (octaves[line][0] - octaves.min()) / (octaves.max() - octaves.min()) - 1.0
    name, value = model.free[index].name, model.free[index].value(0.0)
    values = {f.name: f.value(0.0) for f in model.free} | {name: value * (1.0 + 0.01 * SIZE * x)}
    moved = evidence.deviations(evidence.predicted(campaign.with_values(values)).datasets)
    change = 100.0 * (moved - fit.state.deviations)[line]
    assert np.abs(change).max() > 0.0
    assert columns[line, 2 * index] == pytest.approx(change, rel=1e-2, abs=1e-3 * np.abs(change).max())


def test_what_channels_do_not_share_is_one_error_of_a_run(tmp_path: Path) -> None:
    """The column is what incoherent power that is 5 % larger does to the residuals, and nothing else."""
    campaign = written(tmp_path, *tables(cold=False))
    datasets = measured(campaign, 5)
    evidence: Evidence = evidence_of(campaign, datasets, gather(campaign, datasets, threads=1))
    block = next(b for b in evidence.blocks if isinstance(b, SpectraBlock))
    rest = np.array([" rest " in label for label in block.rows.channel])
    column = UNSHARED * block.unshared
    assert rest.any()
    assert np.array_equal(column != 0.0, rest)
    assert column[rest] == pytest.approx(UNSHARED * 4.343 / block.rows.scale_dB[rest], rel=1e-3)
