"""Suspensions that slide: the solver's statistical linearisation against the generator's own balance in time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.predict import predict
from permway.campaign.predictions.sliding import with_vehicle
from permway.challenge import write
from permway.challenge.beams import Reals
from permway.challenge.effects import Effect
from permway.challenge.plan import Plan
from permway.challenge.sliders import Slider as Marched
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import Slider
from scipy.special import erf
from short_deck import small_case


@dataclass(frozen=True)
class Rubbing(Effect):
    """A force along each primary suspension of the half vehicle; alone, it stands for the damper."""

    KIND = "rubbing"
    FAMILY = "friction"
    force_N: float
    velocity_m_per_s: float
    alone: bool

    @classmethod
    def draw(cls, *_: Any) -> Self:
        raise NotImplementedError

    @property
    def mechanical(self) -> str:
        return "rubs"

    def apply(self, plan: Plan) -> None:
        v0 = self.velocity_m_per_s

        def force(velocity: Reals) -> Reals:
            return np.asarray(self.force_N * erf(velocity / (np.sqrt(2.0) * v0)))

        if self.alone:
            kp = plan.values["vehicle"]["kp"]
            plan.vehicle.laws["primary"] = lambda f: np.full(f.shape, kp + 0j)
        plan.vehicle.slider = Marched("primary", force, self.force_N * np.sqrt(2.0 / np.pi) / v0)


def off_dB(campaign: Campaign) -> list[dict[str, np.ndarray]]:
    """Channels' powers over what is predicted of them, beyond what all axle boxes have in common."""
    found = []
    for dataset, one in zip(campaign.load(), predict(campaign, campaign.load(), threads=1), strict=True):
        if "psd" not in dataset.data:
            continue
        ratio = 10.0 * np.log10((dataset.data["psd"] / one["psd"]).transpose("channel", "frequency"))
        boxes = ratio.sel(channel=[f"axlebox{i}" for i in range(1, 5)]).mean("channel")
        frequency = ratio["frequency"].values
        bands = [(frequency >= low) & (frequency < 2.0 * low) for low in (8.0, 16.0, 32.0, 64.0, 128.0)]
        found.append(
            {
                str(name): np.array(
                    [float((ratio - boxes).sel(channel=name).values[band].mean()) for band in bands]
                )
                for name in ("bogie1", "carbody")
            }
        )
    return found


@pytest.mark.parametrize(
    ("force_N", "v0", "alone"), [(300.0, 0.01, False), (250.0, 0.02, True)], ids=["friction", "blow-off"]
)
def test_the_generators_balance_is_predicted(tmp_path: Path, force_N: float, v0: float, alone: bool) -> None:
    case = replace(small_case(clean=True), effects=(Rubbing(force_N, v0, alone),))
    write(case, tmp_path / "folder")
    plain = import_sheet(tmp_path / "folder", tmp_path / "imported")
    plain = plain.with_values(
        {f"{group}.{name}": v for group, table in case.truth["parameters"].items() for name, v in table.items()}
    )
    assert plain.model.train is not None
    car = plain.model.train.vehicle
    # The generator has the half of a vehicle, the solver's numbers are of the whole.
    slider = Slider(suspension="primary", force_N=force_N / car.share, velocity_m_per_s=v0, alone=alone)
    sliding = plain.with_model(with_vehicle(plain.model, Vehicle(**{**car.model_dump(), "additions": (slider,)})))
    predicted, linear = off_dB(sliding), off_dB(plain)
    for channel in ("bogie1", "carbody"):
        # By octave from 8 to 256 Hz; the averages of 8 s know their means to some tenths.
        assert max(np.abs(run[channel]).max() for run in predicted) < 1.0
        assert min(np.abs(run[channel]).max() for run in linear) > 10.0
