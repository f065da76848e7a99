"""Effects that are faded until the records hardly constrain them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.challenge.case import draw
from permway.challenge.effects import CATALOGUE, FADING, Effect
from permway.challenge.effects.measuring import NoiseFloor
from permway.challenge.graded import NEAR, sought
from permway.challenge.make import make
from permway.challenge.measure import HammerTest, Run
from permway.challenge.weigh import weights
from permway.errors import InputError
from short_deck import small_case, small_site

Records = tuple[list[HammerTest], list[Run]]


def recorded(*effects: Effect) -> Records:
    case = small_case(clean=True)
    tests = replace(case.tests, temperatures_C=(20.0, -15.0), lines_Hz=(8.0, 400.0, 28.0), seconds=4.0)
    return replace(case, tests=tests, effects=effects).measure()


def apart(some: Records, others: Records) -> float:
    """Largest difference of any channel over its own root mean square."""
    frfs = [(a.frf, b.frf) for a, b in zip(some[0], others[0], strict=True)]
    runs = [(a.values, b.values) for a, b in zip(some[1], others[1], strict=True)]
    return max(
        float((np.abs(a - b).max(axis=0) / np.sqrt(np.mean(np.abs(b) ** 2, axis=0))).max()) for a, b in frfs + runs
    )


@pytest.fixture(scope="module")
def nothing() -> Records:
    return recorded()


@pytest.mark.parametrize("kind", FADING, ids=lambda kind: kind.KIND)
def test_an_effect_fades_to_nothing(kind: type[Effect], nothing: Records) -> None:
    effect = kind.draw(np.random.default_rng(3), "medium", small_site())
    assert effect.faded(1.0) == effect
    if kind is NoiseFloor:
        assert effect.faded(1e-3).factor == pytest.approx(1.0, abs=0.01)  # type: ignore[attr-defined]
        return
    whole, hardly = (apart(recorded(effect.faded(share)), nothing) for share in (1.0, 1e-4))
    assert whole > 100.0 * hardly
    assert hardly < 1e-2


def test_what_is_there_or_not_does_not_fade() -> None:
    assert {kind.KIND for kind in CATALOGUE} - {kind.KIND for kind in FADING} == {
        "slab_joints",
        "viscous_layer",
        "sensor_polarity",
        # Half of a percent any speed may be off.
        "speed_error",
    }


@pytest.mark.parametrize(
    "law",
    [
        lambda share: 3e6 * share**2,
        lambda share: 4e3 * share**6,
        lambda share: 2e8 * share**2 / (1.0 + 3e4 * share**2),
        lambda share: 5e4 * share**2 + 2.0 * math.sin(40.0 * share) - 2.0,
        lambda share: 1e9 * share**1.2,
    ],
    ids=["small", "steep", "saturates", "noisy", "flat"],
)
@pytest.mark.parametrize("target", [10.0, 55.0, 300.0])
def test_the_share_that_weighs_what_was_drawn(law: Callable[[float], float], target: float) -> None:
    share, found = sought(law, target)
    assert found == law(share)
    assert target / NEAR <= found <= target * NEAR


def test_what_is_too_light_stays_as_it_was_drawn() -> None:
    assert sought(lambda share: 20.0 * share, 200.0) == (1.0, 20.0)


def test_a_graded_campaign_is_made_with_its_weight(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def against(twin: Path) -> Callable[[Path], float]:
        assert (twin / "sheet.json").is_file()

        def deviance(_: Path) -> float:
            asked.append(40000.0 / 16.0 ** len(asked))
            return asked[-1]

        return deviance

    monkeypatch.setattr("permway.challenge.graded.draw", small_case)
    (folder,) = make(5, 1, "graded", tmp_path, against=against)
    truth = json.loads((tmp_path / "truth" / f"{folder.name}.json").read_text())
    assert 0.0 < truth["share"] < 1.0
    assert weights(tmp_path)[folder.name] in asked
    drawn = small_case(5, "graded").faded(truth["share"])
    assert truth["effects"] == json.loads(json.dumps([effect.truth() for effect in drawn.effects]))


def test_graded_campaigns_need_a_deviance(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs something to weigh"):
        make(5, 1, "graded", tmp_path)


def test_all_of_them_are_noisy() -> None:
    noise = [draw(seed, "graded").chain.noise for seed in range(40)]
    assert min(noise) > 30.0 * 1.2e-6
    assert max(noise) < 4000.0 * 1.2e-6


def test_a_share_of_one_is_the_campaign_as_drawn() -> None:
    case = draw(3, "graded")
    assert case.faded(1.0) == case
