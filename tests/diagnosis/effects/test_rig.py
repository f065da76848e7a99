"""Rubber on a rig, as a data sheet has it: shaken, it says that it depends on frequency, as its DMA knows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.importers.rubber_rig import RIG, import_rubber_rig
from permway.diagnosis.catalogue import pad_frequency
from permway.diagnosis.catalogue._roles import rubbers
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.model.presets import slab_track_viaduct_32m
from permway.posterior.diagnose import diagnose

ORDER, SHARE = 0.4, 0.5
"""Of the springpot, and its share of the stiffness at 60 Hz."""


def modulus(frequency_Hz: np.ndarray) -> np.ndarray:
    """Of the rubber, Pa: a spring beside a springpot."""
    springpot = (1j * frequency_Hz / 60.0) ** ORDER / np.cos(0.5 * np.pi * ORDER)
    return np.asarray(6e6 * (1.0 - SHARE + SHARE * springpot))


def folder_of_a_rig(folder: Path) -> Path:
    """A DMA at room temperature, and two masses shaken, 1 % off from line to line."""
    for part in ("dma", "shaker"):
        (folder / "rubber" / part).mkdir(parents=True)
    rows = ["freq_hz,temperature_C,G_storage_pa,G_loss_pa,strain_dyn_pct"]
    rows += [f"{f},21.0,{g.real},{g.imag},0.15" for f in (1.0, 10.0, 100.0) for g in (modulus(np.array(f)),)]
    (folder / "rubber" / "dma" / "tf_015p.csv").write_text("\n".join(rows) + "\n")
    frequency, random = np.arange(60.0, 500.0, 2.0), np.random.default_rng(4)
    stiffness = RIG.shape_factor_m * modulus(frequency)
    for name, mass in (("253g", 0.2533), ("573g", 0.573)):
        moved = stiffness / (stiffness - (mass + RIG.moving_mass_kg) * (2.0 * np.pi * frequency) ** 2)
        moved *= np.exp(0.01 * (random.standard_normal(moved.size) + 1j * random.standard_normal(moved.size)))
        lines = ["run,freq_hz,base_accel_ms2,base_phase_rad,mass_accel_ms2,mass_phase_rad"]
        lines += [
            f"1g_{name},{f},9.8,0.0,{9.8 * abs(t)},{np.angle(t)}" for f, t in zip(frequency, moved, strict=True)
        ]
        (folder / "rubber" / "shaker" / f"1g_{name}.csv").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    root = tmp_path_factory.mktemp("rig")
    folder = folder_of_a_rig(root / "source")
    (made,) = import_rubber_rig(folder, root / "out", copy=True, law="constant")
    return read_campaign(made.folder / "campaign.toml")


def test_a_data_sheet_knows_no_frequency_and_the_dma_is_withheld(campaign: Campaign) -> None:
    law = campaign.model.line.laws["rubber"].complex([10.0, 500.0])
    expected = complex(0.5 * RIG.shape_factor_m * modulus(np.array(10.0)))
    assert law == pytest.approx([expected] * 2, rel=1e-9)
    assert {record.statistic for record in campaign.stated.records} == {"transmissibility"}
    assert not (campaign.folder / "tf_015p.csv").exists()


def test_rubber_of_a_rig_is_a_pad_only_where_no_rail_is(campaign: Campaign) -> None:
    assert rubbers(campaign.model.line) == ["rubber"]
    assert rubbers(slab_track_viaduct_32m()) == ["pad"]
    fit = recalibrate(gather(campaign, threads=1))
    assert len(list(pad_frequency.hypotheses(Situation(fit, ())))) == 2


def test_its_dependence_on_frequency_is_named_and_its_order_reported(campaign: Campaign) -> None:
    found = diagnose(campaign, threads=1).verdict
    assert found.status == "named"
    (effect,) = found.effects
    assert effect.name == "pad_frequency"
    order = effect.parameters["order"]
    assert order.low is not None
    assert order.high is not None
    assert order.low <= ORDER <= order.high
    assert order.high - order.low < 0.2
    for gain in found.held_out.values():
        assert gain.db_after < 0.5 * gain.db_before
