"""Decay rate and insertion loss of models, against closed forms.

Euler beam on a bed s per length under a force F at 0: E I w'''' + (s - m omega^2) w = F delta has, with
4 kappa^4 = (s - m omega^2) / (E I), w = F exp(-kappa x) (cos kappa x + sin kappa x) / (8 E I kappa^3) (Hetenyi,
Beams on Elastic Foundation, 1946), for complex s too. A mass on a spring has the receptance 1 / (k - m omega^2).
"""

from __future__ import annotations

import numpy as np
import permway
import pytest
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints, Spread
from permway.model.line import Line
from permway.recordings.estimates.bands import bands_between
from permway.recordings.estimates.decay_rate import GRID_BAYS, grid_intervals
from scipy.integrate import quad

E, INERTIA, RHO, A = 2.1e11, 3.0e-5, 7850.0, 7.7e-3
SPACING, STIFFNESS, ETA = 0.1, 4.0e6, 0.2


def track(to_m: float = 60.0) -> Line:
    """A rail on springs so close that they are a bed of 40 MN/m2."""
    rail = Beam(youngs_modulus_Pa=E, second_moment_m4=INERTIA, density_kg_per_m3=RHO, area_m2=A)
    joints = Joints(between=("rail", "ground"), law="bed", at=Spread(from_m=0.0, to_m=to_m, spacing_m=SPACING))
    return Line(
        bodies={"rail": rail}, joints=(joints,), laws={"bed": Hysteretic(stiffness=STIFFNESS, loss_factor=ETA)}
    )


def bed(x: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Receptance, shape (x, frequency)."""
    omega = 2.0 * np.pi * frequency
    s = STIFFNESS * (1.0 + 1j * ETA) / SPACING
    kappa = ((s - RHO * A * omega**2) / (4.0 * E * INERTIA)) ** 0.25
    # Of the four roots that which decays on both waves, kappa (1 +- i).
    turned = kappa * np.exp(0.5j * np.pi * np.arange(4))[:, None]
    decays = np.minimum((turned * (1 + 1j)).real, (turned * (1 - 1j)).real) > 0.0
    kappa = np.take_along_axis(turned, decays.argmax(axis=0)[None], axis=0)[0]
    k = kappa * x[:, None]
    return np.exp(-k) * (np.cos(k) + np.sin(k)) / (8.0 * E * INERTIA * kappa**3)


def test_decay_rate_of_a_rail_on_a_bed() -> None:
    data = permway.track_decay_rate(track(), at_m=10.0, from_Hz=100.0, to_Hz=1000.0)
    bands = bands_between(100.0, 1000.0)
    x = 0.6 * np.array(GRID_BAYS)
    expected = []
    for middle in bands.middle_Hz:
        f = middle * 10.0 ** (((np.arange(12) + 0.5) / 12 - 0.5) / 10.0)
        power = (np.abs(bed(x, f)) ** 2 * f**4).sum(axis=1)
        expected.append(4.343 / ((power / power[0]) @ grid_intervals(x)))
    assert list(data["band"].values) == list(bands.nominal_Hz)
    assert data["decay_rate"].values == pytest.approx(expected, rel=0.01)
    assert not data["suitable"].values.all(), "above the bed's resonance the rail rings far"
    assert data["suitable"].values[:3].all()
    assert data.attrs["floor_dB_per_m"] == pytest.approx(4.343 / 39.6, rel=1e-3)


def test_a_grid_beyond_the_supports_is_refused() -> None:
    with pytest.raises(InputError, match=r"supported from 0 to 60 m .*give at_m between 0 and 20\.4"):
        permway.track_decay_rate(track(), at_m=30.0)
    with pytest.raises(InputError, match="lengthen the track"):
        permway.track_decay_rate(track(30.0), at_m=0.0)
    with pytest.raises(InputError, match="no such body"):
        permway.track_decay_rate(track(), at_m=0.0, body="Rail")
    with pytest.raises(InputError, match="at_m"):
        permway.track_decay_rate(track(), at_m="begin")


MASS = 40.0
FREQUENCY = np.arange(10.0, 260.0, 0.25)


def oscillator(stiffness: float, frequency: np.ndarray = FREQUENCY, name: str = "m"):
    line = Line(
        bodies={"m": Mass(mass_kg=MASS)},
        joints=(Joints(between=("m", "ground"), law="s", at=(0.0,)),),
        laws={"s": Hysteretic(stiffness=stiffness, loss_factor=0.2)},
    )
    place = permway.Place(body="m", x_m=0.0, name=name)
    return permway.receptance(line, frequency, forces=[place], sensors=[place])


def test_insertion_loss_of_a_softer_spring() -> None:
    stiff, soft = 8.0e6, 2.0e6
    data = permway.insertion_loss(oscillator(stiff), oscillator(soft))
    bands = bands_between(12.5, 200.0)
    assert list(data["band"].values) == list(bands.nominal_Hz)

    def power(stiffness: float, low: float, high: float) -> float:
        def at(f: float) -> float:
            w = 2.0 * np.pi * f
            return abs(w**2 / (stiffness * (1.0 + 0.2j) - MASS * w**2)) ** 2

        return quad(at, low, high, limit=200)[0]

    each = [
        [power(k, low, high) for low, high in zip(bands.low_Hz, bands.high_Hz, strict=True)] for k in (stiff, soft)
    ]
    expected = 10.0 * np.log10(np.divide(*each))
    found = data["insertion_loss"].sel(sensor="m", force="m").values
    assert found == pytest.approx(expected, abs=0.01)
    # Far below both resonances the displacement goes with the flexibility: four times softer, 12 dB more.
    assert found[0] == pytest.approx(-12.0, abs=1.0)
    total = 10.0 * np.log10(sum(each[0]) / sum(each[1]))
    assert data["insertion_loss_total"].item() == pytest.approx(total, abs=0.01)


def test_a_model_with_a_train_against_itself_and_against_softer_pads() -> None:
    def answer(stiffness: float, speed: float = 60.0):
        table = {
            "frequencies": {"from_Hz": 20.0, "to_Hz": 120.0, "step_Hz": 1.0},
            "line": {
                "preset": "slab_track_viaduct_32m",
                "options": {"pad": {"type": "hysteretic", "stiffness": stiffness, "loss_factor": 0.2}},
            },
            "sensors": [{"body": "girder", "x_m": 16.0, "name": "deck"}],
            "train": {"vehicle": {"preset": "crh380a"}, "centre_m": 16.0, "speed_m_per_s": speed},
            "irregularity": {"type": "german_sato"},
        }
        return permway.solve(permway.model_from_dict(table))

    stiff, soft = answer(1.0e8), answer(2.0e7)
    assert permway.insertion_loss(stiff, stiff)["insertion_loss"].values == pytest.approx(0.0, abs=1e-12)
    data = permway.insertion_loss(stiff, soft)
    psd = [a["line_acceleration_psd"].sel(place="deck").values for a in (stiff, soft)]
    f = stiff["frequency"].values
    low, high = 1000.0 * 10.0 ** (np.array([-1.05, -0.95]))
    # The band of 100 Hz in cells of 1 Hz.
    cell = np.clip(np.minimum(f + 0.5, high) - np.maximum(f - 0.5, low), 0.0, None)
    expected = 10.0 * np.log10((psd[0] @ cell) / (psd[1] @ cell))
    assert data["insertion_loss"].sel(place="deck", band=100.0).item() == pytest.approx(expected, abs=1e-9)
    with pytest.raises(InputError, match="another speed"):
        permway.insertion_loss(stiff, answer(1.0e8, speed=61.0))


@pytest.mark.parametrize(
    ("act", "message"),
    [
        (lambda: permway.insertion_loss("a.nc", oscillator(1e6)), "without: must be a Dataset"),
        (lambda: permway.insertion_loss(oscillator(1e6), oscillator(1e6, FREQUENCY + 0.1)), "other frequencies"),
        (lambda: permway.insertion_loss(oscillator(1e6), oscillator(1e6, name="n")), "name them alike"),
        (lambda: permway.insertion_loss(*[oscillator(1e6, FREQUENCY[:4])] * 2), "no one-third octave"),
    ],
)
def test_what_cannot_be_compared_is_refused(act, message: str) -> None:
    with pytest.raises(InputError, match=message):
        act()
