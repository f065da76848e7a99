"""Runs whose lines scatter more than a steady process lets them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.ragged import STEADY, explains_elsewhere, raggedness, unexplained_lines, unsteady_misfit
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.speak import Proof, _told, _unsteady
from simulated_train import measured, tables, written


def fitted(folder: Path, impacts: float) -> Fit:
    """The base of records; each line of the runs is larger or smaller by so much, neper, as impacts make it."""
    campaign = written(folder, *tables(cold=False))
    datasets, random = measured(campaign, 3), np.random.default_rng(4)
    for dataset in datasets:
        if "csd" in dataset.data:
            factor = np.exp(impacts * random.standard_normal(dataset.data["frequency"].size))
            for name in ("csd", "psd"):
                dataset.data[name] = dataset.data[name] * factor
    return recalibrate(gather(campaign, datasets, threads=1))


def runs(fit: Fit) -> list[SpectraBlock]:
    return [block for block in fit.evidence.blocks if isinstance(block, SpectraBlock)]


@pytest.fixture(scope="module")
def steady(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return fitted(tmp_path_factory.mktemp("steady"), 0.0)


@pytest.fixture(scope="module")
def struck(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return fitted(tmp_path_factory.mktemp("struck"), 1.0)


def test_steady_runs_are_not_ragged(steady: Fit) -> None:
    assert max(map(raggedness, runs(steady))) < 0.6 * STEADY
    assert unsteady_misfit(steady) == steady.heat


def test_what_scatters_counts_as_misfit_though_it_was_learnt(struck: Fit) -> None:
    assert max(map(raggedness, runs(struck))) > STEADY
    assert unsteady_misfit(struck) > 1.2 * struck.heat
    assert unsteady_misfit(replace(struck, heat=2.0)) == pytest.approx(2.0 / struck.heat * unsteady_misfit(struck))


def test_the_run_and_its_channels_are_told(struck: Fit) -> None:
    effect = unexplained_lines(struck)
    worst = max(runs(struck), key=raggedness)
    assert worst.dataset.record.name in (effect.law.words or "")
    ragged = {channel for channel, size in worst.scatter if size**2 > STEADY}
    assert set(effect.place.channels) == ragged != set()
    assert effect.name is None


def test_what_hammer_tests_tell_is_told_whatever_runs_do(struck: Fit) -> None:
    """A base that lacks something in responses alone, or in runs alone, and a model that lacks neither."""
    of_run = np.array([isinstance(block, SpectraBlock) for block in struck.evidence.blocks])[
        struck.evidence.block_of
    ]
    assert of_run.any()
    assert not of_run.all()
    for lacking, told in ((~of_run, True), (of_run, False)):
        base = replace(struck, clean=np.where(lacking, 2.0, 0.8))
        right, half = (replace(struck, clean=np.where(lacking, left, 0.8)) for left in (1.0, 1.8))
        assert explains_elsewhere(base, right) is told
        assert not explains_elsewhere(base, half)


def test_what_is_not_steady_is_said_before_that_records_do_not_tell(steady: Fit, struck: Fit) -> None:
    """Nothing found, or something that leaves all of it: where it acts is known, and that is more."""
    assert _unsteady(struck, struck)
    assert not _unsteady(steady, steady)
    # A misfit that is no scatter of lines is none of these.
    assert not _unsteady(replace(steady, heat=3.0), replace(steady, heat=3.0))


def test_lines_are_as_steady_as_the_amended_model_weighs_them(steady: Fit, struck: Fit) -> None:
    """A bogie frame's resonance left lines that scattered 3.1 times by the weights of a rigid one."""
    accepted, proof = cast(Any, [SimpleNamespace(fit=struck)]), cast(Proof, SimpleNamespace(weighed=steady))
    assert _told(struck, accepted, proof) is steady
    # Noise that was found where wheels had left welds explained half of it, and made lines less coherent.
    far = cast(Proof, SimpleNamespace(weighed=replace(steady, heat=1.3)))
    assert _told(struck, accepted, far) is struck
    assert _told(steady, accepted, None) is struck
    assert _told(steady, [], None) is steady
    assert not _unsteady(struck, _told(struck, accepted, proof))
