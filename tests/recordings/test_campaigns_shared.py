"""The campaigns and recordings beside the repository: imported without a hand edit, and predicted as they were.

Bounds are for noise: hammer tests by their own coherence, spectra by their averages. Truths are those of the
practice campaigns.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.importers.pad_materials import import_pad_materials
from permway.campaign.importers.rubber_rig import import_rubber_rig
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.importers.track_decay import import_track_decay
from permway.campaign.load import Dataset
from permway.campaign.predict import predict
from permway.laws import TFDV, FractionalKelvinVoigt, FractionalZener, Hysteretic, Pad
from permway.model.bodies import Mass
from permway.model.changes import Change
from permway.model.joints import Joints
from permway.posterior.diagnose import diagnose
from permway.problem.model import Model
from scipy import optimize

SHARED = Path(__file__).resolve().parents[3] / "shared"

pytestmark = pytest.mark.skipif(
    not (SHARED / "campaigns").is_dir(), reason="the campaigns are not here (shared beside the repository)"
)

PRACTICE = ("practice-1", "practice-2", "practice-3", "practice-4")
SEALED = tuple(f"sealed-{letter}" for letter in "abcdefghij")

MESH_NEPER = 0.02
"""Of the finite elements that made the records: they turn the phase by up to 0.5 degrees, 0.009, at 400 Hz."""


@pytest.mark.filterwarnings("default:.*times the noise of the other channels")
@pytest.mark.parametrize("name", SEALED)
def test_sealed_campaigns_import(name: str, tmp_path: Path) -> None:
    campaign = import_sheet(SHARED / "campaigns" / name, tmp_path / name)
    hammers = [r for r in campaign.stated.records if r.statistic == "frf"]
    runs = [r for r in campaign.stated.records if r.statistic == "csd"]
    assert len(hammers) == len(
        json.loads((SHARED / "campaigns" / name / "sheet.json").read_text())["temperature_C"]
    )
    assert len(runs) == 2
    assert all(record.interpolated_Hz is not None for record in runs)
    assert read_campaign(tmp_path / name / "campaign.toml").stated == campaign.stated


def with_truth(campaign: Campaign, truth: dict[str, Any]) -> Campaign:
    """The campaign with its true parameters and, by hand, its true effect."""
    values = {f"{group}.{key}": v for group, table in truth["parameters"].items() for key, v in table.items()}
    reported = campaign.with_values(values)
    model = reported.model
    for effect in truth["fx"]:
        model = _amended(model, effect, truth["parameters"])
    return reported.with_model(model)


def _amended(model: Model, effect: dict[str, Any], parameters: dict[str, Any]) -> Model:
    line = model.line
    bodies, joints, laws = dict(line.bodies), list(line.joints), dict(line.laws)
    match effect["kind"]:
        case "lost":
            change = Change(from_m=effect["x"][0], to_m=effect["x"][1], factor=effect["factor"])
            joints[0] = joints[0].model_copy(update={"changes": (change,)})
        case "attached_resonator":
            bodies["extra"] = Mass(mass_kg=effect["m"])
            laws["extra"] = Hysteretic(stiffness=effect["m"] * effect["w0"] ** 2, loss_factor=effect["eta"])
            joints.append(Joints(between=("extra", effect["body"]), law="extra", at=tuple(effect["x"])))
        case "fractional":
            k = parameters[effect["layer"]]["k"]
            laws[effect["layer"]] = FractionalKelvinVoigt(
                stiffness=k * effect["r0"],
                coefficient=k * effect["r1"] * effect["w0"] ** -effect["alpha"],
                order=effect["alpha"],
            )
    changed = line.model_copy(update={"bodies": bodies, "joints": tuple(joints), "laws": laws})
    return model.model_copy(update={"line": changed})


@pytest.mark.parametrize("name", PRACTICE)
def test_with_the_truth_put_in_only_noise_is_left(name: str, tmp_path: Path) -> None:
    campaign = import_sheet(SHARED / "campaigns" / name, tmp_path / name)
    truth = json.loads((SHARED / "campaigns" / name / "truth.json").read_text())
    reported = with_truth(campaign, truth)
    datasets = campaign.load()
    blows, *runs = zip(datasets, predict(reported, datasets, threads=1), strict=True)
    _check_blows(*blows)
    for run, predicted in runs:
        _check_run(run, predicted)


def _check_blows(dataset: Dataset, predicted: Any) -> None:
    data = dataset.data
    deviation = np.log(data["frf"].values / predicted["frf"].values)
    variance, coherence = data["log_variance"].values, data["coherence"].values
    for row, sensor in enumerate(data["sensor"].values):
        # Where noise rules. The coherence is estimated from the same K = 8 blows, so |dH/H|^2 is (1 - g2)/g2 over
        # K - 1 times an F of 2 and 2 K - 2 degrees, and the mean of the standardised square K / (K - 2).
        noisy = (coherence[row] > 0.8) & (coherence[row] < 0.995)
        assert noisy.sum() > 1000, sensor
        z = np.sqrt(np.mean(np.abs(deviation[row][noisy]) ** 2 / (2.0 * variance[row][noisy])))
        assert z == pytest.approx(np.sqrt(8.0 / 6.0), rel=0.06), sensor
        # Where there is none, what is left is the mesh.
        clear = coherence[row] >= 0.9999
        assert np.sqrt(np.mean(np.abs(deviation[row][clear]) ** 2)) < MESH_NEPER, sensor


def _check_run(dataset: Dataset, predicted: Any) -> None:
    data = dataset.data
    averages = data.attrs["averages"]
    ratio = 10.0 * np.log10(data["psd"].values / predicted["psd"].values)
    scatter = 10.0 / np.log(10.0) / np.sqrt(averages)
    for row, channel in enumerate(data["channel"].values):
        assert abs(ratio[row].mean()) < 0.15, channel
        assert ratio[row].std() == pytest.approx(scatter, rel=0.2), channel
    matrix, expected = data["csd"].values, predicted["csd"].values
    power, known = (np.einsum("ccf->cf", m).real for m in (matrix, expected))
    for i, j in ((0, 1), (0, 2), (0, 4), (0, 5)):
        measured = np.abs(matrix[i, j]) ** 2 / (power[i] * power[j])
        coherence = np.abs(expected[i, j]) ** 2 / (known[i] * known[j])
        # Biased up by (1 - g2)^2 / K.
        assert measured.mean() == pytest.approx(coherence.mean(), abs=0.012)


def test_without_the_truth_there_is_something_to_find(tmp_path: Path) -> None:
    campaign = import_sheet(SHARED / "campaigns" / "practice-2", tmp_path / "c")
    blows = campaign.load()[:1]
    nominal = predict(campaign, blows, threads=1)[0]["frf"].values
    assert (
        np.abs(np.log(blows[0].data["frf"].values / nominal))[blows[0].data["coherence"].values > 0.9].mean() > 0.1
    )


def rms_dB(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.sqrt(np.mean((20.0 * np.log10(np.abs(first / second))) ** 2)))


def test_rubber_rig_by_its_campaign(tmp_path: Path) -> None:
    """1.6 dB from DMA alone, 0.35 dB with the one factor that belongs to the rig (0.774; `tests/laws`)."""
    _, rubber = import_rubber_rig(SHARED / "recordings" / "rubber-rig", tmp_path / "rig")
    shaken = [dataset for dataset in rubber.load() if dataset.record.statistic == "transmissibility"]
    for values, bar in (({}, 1.6), ({"rig.factor": 0.774}, 0.35)):
        for dataset, predicted in zip(shaken, predict(rubber.with_values(values), shaken, threads=1), strict=True):
            assert rms_dB(predicted["transmissibility"].values, dataset.data["transmissibility"].values) < bar
    table = rubber.load()[0]
    assert rms_dB(predict(rubber, [table])[0]["modulus"].values, table.data["modulus"].values) < 1.0


def test_rubber_that_is_shaken_states_what_its_dma_knows(tmp_path: Path) -> None:
    """The DMA withheld, and a data sheet's modulus instead: the order is that of the law that the DMA gives."""
    folder = SHARED / "recordings" / "rubber-rig"
    _, sheet = import_rubber_rig(folder, tmp_path / "sheet", law="constant")
    _, known = import_rubber_rig(folder, tmp_path / "dma")
    law = known.model.line.laws["rubber"]
    assert isinstance(law, Pad)
    assert isinstance(law.material, TFDV)
    assert isinstance(law.material.law, FractionalZener)
    verdict = diagnose(sheet, threads=1).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name) == ("named", "pad_frequency")
    order = effect.parameters["order"]
    assert order.low is not None
    assert order.high is not None
    assert order.low <= law.material.law.order <= order.high
    assert order.high - order.low < 0.2
    assert all(gain.db_after < gain.db_before for gain in verdict.held_out.values())


@pytest.mark.xfail(
    strict=True,
    raises=AssertionError,
    reason="0.43 dB are left of one group, since decibels are of the model solved and not of its slopes",
)
def test_rubber_that_is_shaken_is_predicted_to_four_tenths_of_a_decibel(tmp_path: Path) -> None:
    _, sheet = import_rubber_rig(SHARED / "recordings" / "rubber-rig", tmp_path / "sheet", law="constant")
    for gain in diagnose(sheet, threads=1).verdict.held_out.values():
        assert gain.db_after < 0.4 < gain.db_before


def test_pad_materials_by_their_campaigns(tmp_path: Path) -> None:
    campaigns = import_pad_materials(SHARED / "recordings" / "pad-materials", tmp_path / "pads", copy=True)
    assert [campaign.folder.name for campaign in campaigns] == ["eva", "pu_soft"]
    for campaign in campaigns:
        (dataset,) = campaign.load()
        assert rms_dB(predict(campaign, [dataset])[0]["modulus"].values, dataset.data["modulus"].values) < 0.15


FITTED = ("pad.k", "pad.eta", "ballast.k", "ballast.eta", "sleeper.m", "rail.eta")


def deviation_dB(dataset: Dataset, predicted: Any) -> np.ndarray:
    """10 lg of predicted over measured decay rate, 250 to 2500 Hz."""
    band = dataset.data["band"].values
    kept = (band >= 250.0) & (band <= 2500.0)
    return np.asarray(10.0 * np.log10(predicted["decay_rate"].values / dataset.data["decay_rate"].values)[kept])


@pytest.mark.parametrize(
    ("support", "both", "mean"),
    # Bars: 1.1 and 1.5 dB. Of the two rails 0.66 dB is their difference, which no common curve can meet; against
    # their mean rate the continuous support leaves 1.51 dB, the best that any pads, ballast and sleepers do here.
    [("discrete", 1.1, 0.85), ("continuous", 1.70, 1.55)],
)
def test_track_decay_at_13_to_15_degrees(tmp_path: Path, support: str, both: float, mean: float) -> None:
    campaign = import_track_decay(SHARED / "recordings" / "track-decay", tmp_path / "tdr", support=support)
    vertical = [dataset for dataset in campaign.load() if dataset.record.channels == {"rail": "rail vertical"}]
    assert len(vertical) == 8
    known = campaign.parameters.known
    warm = [
        d for d in vertical if d.condition.temperature_C is not None and 13.0 <= d.condition.temperature_C < 15.2
    ]
    assert len(warm) == 2
    average = warm[0].data.copy(deep=True)
    average["decay_rate"] = (warm[0].data["decay_rate"] + warm[1].data["decay_rate"]) / 2.0
    target = Dataset(warm[0].record, warm[0].condition, average)

    def reported(z: np.ndarray) -> Campaign:
        return campaign.with_values(
            {name: known[name].value(value) for name, value in zip(FITTED, z, strict=True)}
        )

    def deviation(z: np.ndarray) -> np.ndarray:
        predicted = predict(reported(z), [target], threads=1)[0]
        return np.concatenate([deviation_dB(target, predicted), 0.05 * z])

    found = optimize.least_squares(
        deviation, np.zeros(len(FITTED)), bounds=(-6.0, 6.0), diff_step=1e-2, max_nfev=40
    )
    predicted = predict(reported(found.x), warm, threads=1)
    rails = np.concatenate([deviation_dB(d, p) for d, p in zip(warm, predicted, strict=True)])
    assert np.sqrt(np.mean(rails**2)) < both
    assert np.sqrt(np.mean(deviation_dB(target, predicted[0]) ** 2)) < mean
    # The same track is another at another temperature.
    hot = [d for d in vertical if d.condition.temperature_C is not None and d.condition.temperature_C > 27.0]
    others = np.concatenate([deviation_dB(d, predicted[0]) for d in hot])
    assert np.sqrt(np.mean(others**2)) > np.sqrt(np.mean(rails**2)) + 0.5
