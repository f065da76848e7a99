"""Effects of the profile, held out by every second sixth of an octave of the runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.excitation import WheelLines
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.catalogue._excite import with_irregularity
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.heldout import Rest, between_lines, gains
from permway.diagnosis.recalibrate import recalibrate
from simulated_train import measured, tables, written


def flat(campaign: Campaign, amplitude_m: float = 1.5e-5) -> Campaign:
    lines = WheelLines(wheel=2, amplitude_m=amplitude_m, decay=0.3)
    return with_irregularity(campaign, wheels=(*campaign.stated.irregularity.wheels, lines))


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """Of records with a flat in them, and without it."""
    campaign = written(Path(tmp_path_factory.mktemp("flat")), *tables(cold=False))
    return recalibrate(gather(campaign, measured(campaign, 1, flat), threads=1), learn=False)


def amended(base: Fit, amplitude_m: float) -> Fit:
    return recalibrate(
        base.evidence,
        build=lambda values: flat(base.evidence.campaign.with_values(values), amplitude_m),
        free=base.free,
        start=base.z,
        learn=False,
    )


def test_rows_are_of_runs_and_bands_take_turns(base: Fit) -> None:
    evidence = base.evidence
    (part,) = between_lines(evidence)
    runs = np.array([isinstance(block, SpectraBlock) for block in evidence.blocks])[evidence.block_of]
    assert not part.rows[~runs].any()
    sixth = np.floor(6.0 * np.log2(evidence.rows.frequency_Hz[runs])).astype(int)
    held = part.rows[runs]
    assert set(sixth[held] % 2) == {1}
    assert set(sixth[~held] % 2) == {0}


def test_lines_of_a_flat_are_foretold_by_its_other_lines(base: Fit) -> None:
    part = list(between_lines(base.evidence))
    (right,) = gains(Rest(base), Rest(amended(base, 1.5e-5)), part)
    assert right.nats > 3.0 * right.standard_error
    (far_too_large,) = gains(Rest(base), Rest(amended(base, 1.5e-4)), part)
    assert far_too_large.nats < 0.0
