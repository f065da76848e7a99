"""Responses taken less seriously: by one floor, and pair by pair as far as a prediction misses them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.diagnosis.blocks_frf import FLOOR, FrfBlock
from permway.diagnosis.evidence import Evidence, Solved
from permway.diagnosis.gather import gather
from simulated import simulate

MISSED = 0.9
"""Neper by which one pair is off."""


@pytest.fixture(scope="module")
def off(tmp_path_factory: pytest.TempPathFactory) -> tuple[Evidence, Solved, int]:
    """Evidence that is what the model predicts but for one pair of the first hammer test; index of its block."""
    campaign = simulate(tmp_path_factory.mktemp("blunt") / "c", 1).campaign
    plain = gather(campaign, threads=1)
    solved = plain.predicted(campaign)
    moved = []
    for dataset, predicted in zip(plain.datasets, solved.datasets, strict=True):
        if dataset.record.statistic == "frf":
            frf = predicted["frf"].values.copy()
            frf[0, 0] *= np.exp(MISSED)
            dataset = replace(dataset, data=dataset.data.assign(frf=(dataset.data["frf"].dims, frf)))
        moved.append(dataset)
    evidence = gather(campaign, moved, threads=1)
    index = next(i for i, block in enumerate(evidence.blocks) if isinstance(block, FrfBlock))
    return evidence, evidence.predicted(campaign), index


def test_only_the_pair_that_is_missed_counts_less(off: tuple[Evidence, Solved, int]) -> None:
    evidence, solved, index = off
    block = evidence.blunted(0.2, solved).blocks[index]
    assert isinstance(block, FrfBlock)
    floor = np.asarray(block.floor)[..., 0]
    assert floor[0, 0] == pytest.approx(MISSED, rel=1e-6)
    floor[0, 0] = 0.2
    np.testing.assert_allclose(floor, 0.2, rtol=1e-12)


def test_blunting_changes_no_logarithm(off: tuple[Evidence, Solved, int]) -> None:
    """What counts by its logarithm is a matter of noise, and not of how far a pair is off."""
    evidence, solved, index = off
    sharp, blunt = evidence.blocks[index], evidence.blunted(0.2, solved).blocks[index]
    assert isinstance(sharp, FrfBlock)
    assert isinstance(blunt, FrfBlock)
    assert sharp.floor == FLOOR
    one, other = sharp.error(solved.datasets[index]), blunt.error(solved.datasets[index])
    np.testing.assert_array_equal(one, other)
    low = np.sum(np.square(evidence.deviations(solved.datasets)))
    assert np.sum(np.square(evidence.blunted(0.2, solved).deviations(solved.datasets))) < 1e-3 * low
