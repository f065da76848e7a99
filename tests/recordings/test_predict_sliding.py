"""A vehicle whose sliders move otherwise, by what their dashpots change, against all solved again."""

from __future__ import annotations

import numpy as np
import pytest
from permway.campaign.predictions.motion import influence
from permway.campaign.predictions.sliding import retuned, shares, with_vehicle
from permway.errors import SolveError
from permway.model.irregularity import GermanLow
from permway.model.presets import slab_track_viaduct_32m
from permway.model.train import Train
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import AirSpring, AnyAddition, DamperSeries, FlexibleMode, Resonator, Slider
from permway.model.vehicle_presets import crh380a
from permway.problem.model import Frequencies, Model
from permway.response.sliding import Remainder

LINES_HZ = np.geomspace(0.3, 300.0, 60)
PRIMARY = Slider(suspension="primary", force_N=300.0, velocity_m_per_s=0.002)
SECONDARY = Slider(suspension="secondary", force_N=2000.0, velocity_m_per_s=0.01, alone=True)
BENDING = FlexibleMode(on="body", modal_mass_kg=2e4, frequency_Hz=11.0, loss_factor=0.03, shape=-0.6)


def track(wheels: int) -> np.ndarray:
    """A receptance, passive and reciprocal: springs and dashpots of a random mixture of wheels."""
    random = np.random.default_rng(2)
    mixed = random.standard_normal((wheels, wheels)) / wheels
    own = mixed @ mixed.T + np.eye(wheels)
    size = 1.0 / (6e7 * (1.0 + 0.2j) + 2j * np.pi * LINES_HZ * 3e4)
    return np.asarray(size[:, None, None] * own)


@pytest.mark.parametrize("cars", [1, 2])
@pytest.mark.parametrize(
    "additions",
    [
        (PRIMARY,),
        (SECONDARY, PRIMARY),
        (
            DamperSeries(suspension="primary", stiffness_N_per_m=2e6),
            PRIMARY,
            AirSpring(rise=0.4, transition_Hz=3.0),
            Resonator(on="wheelset1", mass_kg=60.0, frequency_Hz=70.0, loss_factor=0.1),
        ),
        (PRIMARY, BENDING),
    ],
    ids=["one", "two", "among others", "with a mode"],
)
def test_sliders_that_move_otherwise(cars: int, additions: tuple[AnyAddition, ...]) -> None:
    car = crh380a(share=0.5).model_dump()
    own = Vehicle(**{**car, "additions": additions, "cars": cars})
    train = Train(vehicle=own, centre_m=16.0, speed_m_per_s=70.0)
    model = Model(
        frequencies=Frequencies(values_Hz=(1.0, 2.0)),
        line=slab_track_viaduct_32m(),
        temperature_C=20.0,
        train=train,
        irregularity=GermanLow(),
    )
    at_contacts = track(4 * cars)
    influence_of = retuned(model, LINES_HZ, at_contacts)
    for speed in (0.0, 3e-4, 0.05):
        moving = Vehicle(
            **{
                **own.model_dump(),
                "additions": tuple(
                    a.model_copy(update={"rms_m_per_s": speed}) if isinstance(a, Slider) else a for a in additions
                ),
            }
        )
        expected = influence(with_vehicle(model, moving), LINES_HZ, at_contacts)
        size = np.abs(expected).max(axis=(1, 2), keepdims=True)
        np.testing.assert_allclose(influence_of(moving) / size, expected / size, rtol=0.0, atol=1e-10)


def test_forces_whose_density_is_no_density_are_reported_and_where() -> None:
    """Of two ties: all but one force is well, for rounding; what takes power away is not."""
    alike = np.full((3, 2, 2), 4.0 + 0.0j)
    rows = np.eye(2)
    root = shares(Remainder(rows, alike), np.array([0.1, 0.3]))
    np.testing.assert_allclose(root @ root.conj().swapaxes(1, 2), alike[:2], rtol=1e-5)
    wrong = alike.copy()
    wrong[1] = [[1.0, 2.0], [2.0, 1.0]]
    with pytest.raises(SolveError, match=r"negative density at 0\.25 Hz"):
        shares(Remainder(rows, wrong), np.array([0.0, 0.25]))
