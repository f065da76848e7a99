"""Whole diagnoses of small campaigns that the tool simulated itself: each stage at work, and no proof of any."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.result import Diagnosis
from permway.errors import InputError
from permway.formats.model_file import read_model
from permway.posterior.diagnose import diagnose
from permway.report.diagnosis import write_diagnosis
from simulated import simulate


def lost(campaign: Campaign) -> Campaign:
    return weakened(campaign, "pad", 7.5, 0.6, 0.05)


def loud(campaign: Campaign) -> Campaign:
    chain = campaign.sensor("deck@3").chain
    return with_chain(campaign, "deck@3", chain.model_copy(update={"gain": 1.26 * chain.gain}))


@pytest.fixture(scope="module")
def lost_fasteners(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    case = simulate(tmp_path_factory.mktemp("lost") / "c", 3, amend=lost)
    return diagnose(case.campaign, threads=1)


@pytest.fixture(scope="module")
def nothing_missing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Diagnosis]:
    """The file of a campaign of which nothing is concealed, and its diagnosis."""
    case = simulate(tmp_path_factory.mktemp("plain") / "c", 3)
    return case.path, diagnose(case.campaign, threads=1)


def test_lost_fasteners_are_named_and_proved(lost_fasteners: Diagnosis) -> None:
    verdict = lost_fasteners.verdict
    assert verdict.status == "named"
    (effect,) = verdict.effects
    assert (effect.domain, effect.name, effect.place.joint) == ("path", "fastener_loss", "pad")
    assert effect.place.x is not None
    assert effect.place.x[0] == pytest.approx(7.2, abs=0.35)
    assert effect.place.x[1] == pytest.approx(7.8, abs=0.35)
    assert effect.parameters["factor"].value < 0.1
    assert verdict.evidence.log10_bayes_factor is not None
    assert verdict.evidence.log10_bayes_factor > 20.0
    assert all((g.db_after or 0.0) < (g.db_before or 0.0) for g in verdict.held_out.values())
    assert all(g.gain_nats > 0.0 for g in verdict.held_out.values())


def test_the_folder_holds_verdict_and_a_model_that_loads(lost_fasteners: Diagnosis, tmp_path: Path) -> None:
    written = write_diagnosis(lost_fasteners, tmp_path / "d", page=False)
    assert written["status"] == "named"
    assert lost_fasteners.amended is not None
    assert read_model(tmp_path / "d" / "amended.toml") == lost_fasteners.amended.campaign.model


def test_nothing_missing_is_called_recalibrated_and_again_the_same(
    nothing_missing: tuple[Path, Diagnosis],
) -> None:
    path, found = nothing_missing
    verdict = found.verdict
    assert verdict.status == "recalibrated"
    assert verdict.detectable
    again = diagnose(read_campaign(path), threads=1).verdict
    assert again.to_json() == verdict.to_json()


@pytest.mark.xfail(
    strict=True,
    raises=AssertionError,
    reason="half as far again as the smallest size that would be seen is a suspicion only, with 0.7 for its name",
)
def test_a_gain_that_would_have_been_seen_is_seen_on_every_channel(
    tmp_path: Path, nothing_missing: tuple[Path, Diagnosis]
) -> None:
    """Half as far again from 1 as stated, for the size is known to first order; a third as far is not seen."""
    smallest = nothing_missing[1].verdict.detectable["sensor_gain"]
    assert smallest.value is not None
    for name, times in (("rail@6", 1.5), ("deck@3", 1.5), ("rail@6", 0.33), ("deck@3", 0.33)):
        gain = 1.0 + times * (smallest.value - 1.0)

        def louder(campaign: Campaign, name: str = name, gain: float = gain) -> Campaign:
            chain = campaign.sensor(name).chain
            return with_chain(campaign, name, chain.model_copy(update={"gain": gain * chain.gain}))

        verdict = diagnose(simulate(tmp_path / f"{name}{times}", 3, amend=louder).campaign, threads=1).verdict
        found = [(effect.name, effect.place.channels) for effect in verdict.effects]
        if times > 1.0:
            assert (verdict.status, found) == ("measurement", [("sensor_gain", (name,))])
        else:
            assert verdict.status == "recalibrated"


def test_one_channel_times_1_26_is_a_fault_of_the_measurement(tmp_path: Path) -> None:
    verdict = diagnose(simulate(tmp_path / "c", 3, amend=loud).campaign, threads=1).verdict
    assert verdict.status == "measurement"
    assert verdict.effects[0].place.channels == ("deck@3",)
    gain = verdict.effects[0].parameters["gain"]
    assert gain.value == pytest.approx(1.26, rel=0.05)


def test_the_tools_own_base_as_data_shows_nothing(tmp_path: Path) -> None:
    case = simulate(tmp_path / "c", 5, noise=1e-4, smooth=0.0)
    assert diagnose(case.campaign, threads=1).verdict.status == "recalibrated"


@pytest.mark.injection
def test_twenty_campaigns_with_nothing_missing_raise_one_alarm_at_most(tmp_path: Path) -> None:
    """Calibration errors of 0.2 to 1.3 dB, parameters from their priors: seeds 100 to 119, not chosen."""
    alarms = []
    for seed in range(100, 120):
        size = (0.02, 0.06, 0.1, 0.15)[seed % 4]
        verdict = diagnose(simulate(tmp_path / str(seed), seed, smooth=size).campaign, threads=1).verdict
        if verdict.status not in ("recalibrated", "insufficient"):
            alarms.append((seed, size, verdict.sentence))
    assert len(alarms) <= 1, alarms


def _changed(path: Path, change: object) -> Campaign:
    file = path.parent / "frf.npz"
    data = dict(np.load(file))
    data["frf"] = change(data["frf"])  # type: ignore[operator]
    np.savez(file, **data)
    return read_campaign(path)


def test_shuffled_labels_are_a_fault_of_the_measurement(tmp_path: Path) -> None:
    case = simulate(tmp_path / "c", 3)
    verdict = diagnose(_changed(case.path, lambda frf: frf[:, ::-1]), threads=1).verdict
    assert verdict.status == "measurement"
    assert verdict.effects[0].name == "sensor_labels"
    assert set(verdict.effects[0].place.channels) == {"rail@6", "deck@3"}


def test_phases_that_run_backwards_are_a_fault_of_the_measurement(tmp_path: Path) -> None:
    """Also where physics is missing, which is then not looked for."""
    case = simulate(tmp_path / "c", 3, amend=lost)
    verdict = diagnose(_changed(case.path, np.conj), threads=1).verdict
    assert verdict.status == "measurement"
    assert verdict.effects[0].name == "sensor_labels"
    assert "conjugate the responses" in verdict.effects[0].law.words
    assert not verdict.detectable


def test_responses_that_no_line_can_be_used_of_are_refused(tmp_path: Path) -> None:
    case = simulate(tmp_path / "c", 3)
    file = case.path.parent / "frf.npz"
    data = dict(np.load(file))
    data["frf"] = np.zeros_like(data["frf"])
    np.savez(file, **data)
    with pytest.raises(InputError, match=r"records\..*: no line of it can be used"):
        diagnose(read_campaign(case.path), threads=1)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="noise that claims to be coherent is taken for missing physics"
)
def test_noise_that_claims_to_be_coherent_names_nothing(tmp_path: Path) -> None:
    case = simulate(tmp_path / "c", 3)
    random = np.random.default_rng(7)

    def noise(frf: np.ndarray) -> np.ndarray:
        size = np.median(np.abs(frf))
        return size * (random.standard_normal(frf.shape) + 1j * random.standard_normal(frf.shape))

    verdict = diagnose(_changed(case.path, noise), threads=1).verdict
    assert verdict.status in ("insufficient", "measurement")
    assert bool(verdict.evidence.unmet) == (verdict.status == "insufficient")
    assert all(effect.domain == "measurement" for effect in verdict.effects)
