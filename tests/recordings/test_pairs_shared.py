"""Campaigns of measured pairs, from recordings beside the repository: what they state against what is known."""

from __future__ import annotations

import csv
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import predict

ROOT = Path(__file__).parents[2]
RECORDINGS = ROOT.parent / "shared" / "recordings"

pytestmark = pytest.mark.skipif(
    not (RECORDINGS / "cmu-cart").is_dir(), reason="the recordings are not here (shared beside the repository)"
)

OWN_SPRING, OWN_DAMPER = 761.0, 0.36
"""Of the cart's rig beside what its software adds, N/m and N s/m, as one model of all six files has them."""


@pytest.fixture(scope="module", autouse=True)
def beside():
    before = list(sys.path)
    sys.path.insert(0, str(ROOT / "benches" / "pairs"))
    yield
    sys.path[:] = before


def module(name: str) -> ModuleType:
    return import_module(name)


def level_dB(dataset: Dataset, predicted: np.ndarray, surer_than_dB: float) -> float:
    """Root mean square over lines whose level is known as surely."""
    data = dataset.data
    sure = 8.686 * np.sqrt(data["log_variance"].values) < surer_than_dB
    levels = 20.0 * np.log10(np.abs(predicted / data["frf"].values))[sure]
    return float(np.sqrt(np.mean(levels**2)))


def test_thirty_pairs_of_carts_state_what_each_base_is(tmp_path: Path) -> None:
    made = module("oscillators").carts(tmp_path)
    assert len(made) == 30
    with (RECORDINGS / "cmu-cart" / "truth.csv").open() as file:
        truth = {row["file"][4]: row for row in csv.DictReader(file)}
    for name, path in made.items():
        _, base, target = name.split("-")
        campaign = read_campaign(path)
        law = campaign.model.line.laws["joint"]
        assert law.stiffness == pytest.approx(OWN_SPRING + float(truth[base]["software_spring_N_per_m"]), rel=0.03)
        damper = OWN_DAMPER + float(truth[base]["software_damper_Ns_per_m"])
        assert law.damping == pytest.approx(damper, abs=0.7)
        (dataset,) = campaign.load()
        assert dataset.data.attrs["noise"] == "scatter"
        assert base != target


def test_the_carts_force_is_a_tenth_less_than_stated(tmp_path: Path) -> None:
    """At rest, where neither a small damper nor the mass counts: 0.894 of what is stated, by all six files."""
    made = module("oscillators").carts(tmp_path)
    for target in ("1", "2", "3"):
        base = "2" if target == "1" else "1"
        campaign = read_campaign(made[f"cart-{base}-{target}"])
        (dataset,) = campaign.load()
        predicted = predict(campaign, [dataset], threads=1)[0]["frf"].values
        at_rest = dataset.frequency_Hz < 1.5
        gain = np.median(np.abs(dataset.data["frf"].values / predicted)[..., at_rest])
        assert 0.8 < gain < 0.97


def test_levels_state_what_each_level_is(tmp_path: Path) -> None:
    oscillators = module("oscillators")
    for make, count, hertz, damping in (
        (oscillators.silverbox, 5, (68.33, 68.66, 69.31, 69.83, 70.83), 0.049),
        (oscillators.reuss, 8, (80.37, 80.18, 80.18, 80.11, 80.26, 80.34, 80.42, 80.47), None),
    ):
        made = make(tmp_path)
        assert len(made) == 1 + count
        for number, (path, expected) in enumerate(zip(list(made.values())[1:], hertz, strict=True), start=1):
            model = read_campaign(path).model.line
            law, mass = model.laws["joint"], model.bodies["mass"].mass_kg
            omega = np.sqrt(law.stiffness / mass)
            assert omega / (2.0 * np.pi) == pytest.approx(expected, abs=0.1), number
            if damping is not None:
                assert law.damping / (2.0 * mass * omega) == pytest.approx(damping, abs=0.003)
        whole = read_campaign(next(iter(made.values())))
        levels = [condition.level for condition in whole.stated.conditions]
        assert levels == sorted(levels)
        datasets = whole.load()
        predicted = predict(whole, datasets[:1], threads=1)[0]["frf"].values
        assert level_dB(datasets[0], predicted, 0.5) < 0.5


def test_a_beam_is_that_of_its_base(tmp_path: Path) -> None:
    beam = module("beam")
    beam.PAIRS = {**beam.PAIRS, "base": beam.BASE}
    try:
        made = beam.beams(tmp_path)
    finally:
        del beam.PAIRS["base"]
    off = {}
    for name, path in made.items():
        campaign = read_campaign(path)
        datasets = campaign.load()
        predicted = predict(campaign, datasets, threads=1)[0]["frf"].values
        off[name] = level_dB(datasets[0], predicted, 0.3)
    assert off["piezo-base"] < 0.35
    assert off["piezo-day"] < off["piezo-resistor"] < off["piezo-absorbers"]


def test_a_truss_is_a_beam_where_moments_are(tmp_path: Path) -> None:
    truss = module("truss")
    bending, heights = truss.bending_and_heights()
    loads = np.array([0.0, 1e5, 0.0, 3e5, 0.0, 0.0, 2e5])
    _, strains = truss.solved(loads)
    at = 5.905 * np.arange(1, 8)
    left = float((loads * (truss.LENGTH_M - at)).sum() / truss.LENGTH_M)
    for name, (member, x) in truss.CHORDS.items():
        moment = left * x - float((loads * np.maximum(x - at, 0.0)).sum())
        assert strains[member] == pytest.approx(moment * heights[name] / bending, rel=1e-6)
    # A thrust at the free end takes from the bottom chord, as the recordings have it.
    _, held = truss.solved(loads, 47e6)
    assert (np.abs(held[:6]) < np.abs(strains[:6])).all()
    (dataset,) = read_campaign(truss.passage(tmp_path)).load()
    assert dataset.data["channel"].values.tolist() == ["d5", "S22", "S25", "S26"]
