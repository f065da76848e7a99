"""Complex numbers where real ones are meant: refused by name, never cut to their real parts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from permway.arrays import check_frequency, check_temperature, real_numbers
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.laws.dma import DmaTable
from permway.laws.shift import Arrhenius
from permway.laws.transmissibility import transmissibility
from permway.model.bodies import Beam, Mass
from permway.model.irregularity import GermanLow
from permway.model.irregularity_spectra import check_speed
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.train import Train
from permway.model.vehicle_presets import crh380a
from permway.problem.model import Frequencies
from permway.recordings.estimates.checks import as_reals, check_positive
from permway.recordings.estimates.intervals import power_interval
from permway.recordings.estimates.welch import cross_spectra
from permway.response.decay import decay_rate
from permway.response.pseudo import power_spectrum, pseudo_excitation
from permway.response.receptance import receptance
from permway.response.sensitivity import sensitivity
from permway.response.train import train_response
from permway.units import parse_unit

RAIL = Beam(
    theory="timoshenko",
    youngs_modulus_Pa=2.1e11,
    second_moment_m4=3.038e-5,
    density_kg_per_m3=7850.0,
    area_m2=7.67e-3,
    shear_modulus_Pa=8.1e10,
    shear_coefficient=0.4,
    loss_factor=0.01,
)
PAD = Hysteretic(stiffness=1e8, loss_factor=0.1)
TRACK = Line(
    bodies={"rail": RAIL},
    joints=(Joints(between=("rail", "ground"), law="spring", at=(0.0, 0.6, 1.2)),),
    laws={"spring": PAD},
)
HERE = [Place(body="rail", x_m=0.3)]
TRAIN = Train(vehicle=crh380a(share=0.5), centre_m=0.0, speed_m_per_s=60.0)

TAKES_AN_ARRAY: dict[str, Callable[[np.ndarray], object]] = {
    "receptance": lambda f: receptance(TRACK, f, forces=HERE, sensors=HERE),
    "sensitivity": lambda f: sensitivity(TRACK, f, forces=HERE, sensors=HERE),
    "train_response": lambda f: train_response(TRACK, TRAIN, GermanLow(), f),
    "a law": PAD.complex,
    "a line's laws": TRACK.stiffness,
    "a vehicle": crh380a().wheel_receptance,
    "a profile over frequency": lambda f: GermanLow().density(f, 60.0),
    "a profile over wavenumber": GermanLow().wavenumber_density,
    "a shift": Arrhenius(activation_energy_J_per_mol=1e5, reference_temperature_C=20.0).log10_factor,
    "transmissibility": lambda f: transmissibility(1e6, 10.0, f),
    "pseudo_excitation, frequencies": lambda f: pseudo_excitation(f, np.ones(f.size), [0.0], 60.0),
    "pseudo_excitation, densities": lambda f: pseudo_excitation(np.ones(f.size), f, [0.0], 60.0),
    "pseudo_excitation, lags": lambda f: pseudo_excitation([1.0], [1.0], f, 60.0),
    "power_spectrum": lambda f: power_spectrum(np.ones(f.size), f, derivatives=1),
    "cross_spectra": lambda f: cross_spectra(np.tile(f, 100), sampling_Hz=100.0, segment_s=0.2),
    "cross_spectra of a list": lambda f: cross_spectra(np.tile(f, 100).tolist(), sampling_Hz=100.0, segment_s=0.2),
    "power_interval": lambda f: power_interval(np.ones(f.size), f),
    "a unit": parse_unit("mm/s").to_SI,
    "a DMA table": lambda f: DmaTable(
        frequency_Hz=f, temperature_C=None, storage_Pa=np.ones(f.size), loss_Pa=np.ones(f.size)
    ),
    "check_frequency": check_frequency,
    "check_temperature": check_temperature,
    "as_reals": lambda f: as_reals(f, "record"),
}


@pytest.mark.parametrize("kind", [np.complex128, np.complex64, object])
@pytest.mark.parametrize("name", TAKES_AN_ARRAY)
def test_a_complex_array_is_refused(name: str, kind: type) -> None:
    act = TAKES_AN_ARRAY[name]
    for values in ([10.0 + 0.0j, 20.0 + 0.0j], [10.0 + 3.0j, 20.0 - 1.0j]):
        with pytest.raises(InputError, match=r"must be real, not complex \(got ") as caught:
            act(np.array([np.complex64(v) for v in values], dtype=kind))
        assert caught.value.where
        assert "real part" in caught.value.remedy


@pytest.mark.parametrize(
    ("act", "where"),
    [
        (check_speed, "speed_m_per_s"),
        (lambda v: check_positive(v, "sampling_Hz"), "sampling_Hz"),
        (lambda v: decay_rate([1.0], [0.5], v), "distance_m"),
        (lambda v: receptance(TRACK, v, forces=HERE, sensors=HERE), "frequency_Hz"),
        (
            lambda v: receptance(TRACK, 10.0, forces=HERE, sensors=HERE, temperature_C=v),
            "laws.spring: temperature_C",
        ),
        (lambda v: Mass(mass_kg=v), "mass.mass_kg"),
        (lambda v: Place(body="rail", x_m=v), "Place.x_m"),
        (lambda v: Frequencies(values_Hz=(1.0, v)), "Frequencies.values_Hz"),
        (lambda v: Joints(between=("rail", "ground"), law="spring", at=(0.0, v)), "Joints.at"),
    ],
)
@pytest.mark.parametrize("value", [3.0 + 2.0j, np.complex128(3.0 + 2.0j), np.complex64(3.0), np.array(3.0 + 2.0j)])
def test_a_complex_number_is_refused(act: Callable[[object], object], where: str, value: object) -> None:
    with pytest.raises(InputError) as caught:
        act(value)
    assert caught.value.where.startswith(where), caught.value


def test_real_numbers_of_any_kind_are_taken() -> None:
    for given in ([1, 2], (1.0, 2.0), np.array([1, 2], dtype=np.int8), np.array([1.0, 2.0], dtype=object)):
        taken = real_numbers(given, "x")
        assert taken.dtype == np.float64
        assert taken.tolist() == [1.0, 2.0]
    with pytest.raises(InputError, match=r"^x: not a number or an array of numbers"):
        real_numbers(["one"], "x")
