"""Something else shakes the vehicle: a motor, a gear box, a compressor, the wind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import Push
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._runs import excesses, measured_psd, on_board, suspects
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free
from permway.model.vehicle import Vehicle

ID = "second_source"
DOMAIN: Domain = "measurement"
FAMILY = "noise"
SUMMARY = (
    "A random force on one degree of freedom of the vehicle, independent of the track, over a band: "
    "a bell, or noise through a resonance."
)
PARAMETERS = {
    "density_N2_per_Hz": "N2/Hz: one-sided, at the centre",
    "centre_Hz": "Hz, 1 to 1000",
    "octaves": "1, 0.05 to 10: one standard deviation of the bell",
    "quality": "1, 0.5 to 76: of the resonance, instead",
}
SIGNATURE = "Power of channels near the force, incoherent with the track's part, the same at all speeds."
CONFUSED_WITH = {
    "noise_floor": "one channel, and no resonance of the vehicle",
    "irregularity_level": "coherent, and all channels",
}
SOURCE = "Bendat and Piersol, Random Data (2010), chapter 7: multiple inputs"
CENTRE_HZ, FACTOR = 40.0, 3.0


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """On the three degrees with a sensor that fit worst."""
    runs, train = excesses(situation), situation.campaign.model.train
    if not runs or train is None:
        return
    degree_of = {sensor.name: str(sensor.degree) for sensor in on_board(situation)}
    peaks = [run.frequency_Hz[int(np.argmax(np.convolve(run.neper, np.ones(5) / 5)[2:-2]))] for run in runs]
    z = float(np.log(np.exp(np.mean(np.log(peaks))) / CENTRE_HZ) / np.log(FACTOR))
    for name in suspects(situation, degree_of, 3):
        sensor, degree = situation.campaign.sensor(name), degree_of[name]
        # The force that would move the mass alone as it is seen to move, its power a twentieth of that.
        power = [
            np.median(p * (2.0 * np.pi * f) ** (4 - 2 * _order(sensor.quantity)))
            for f, p in measured_psd(situation, name)
        ]
        centre = 0.05 * float(np.min(power)) * _mass(train.vehicle, degree) ** 2

        def amend(campaign: Campaign, values: Mapping[str, float], degree: str = degree) -> Campaign:
            added = Push(degree=degree, **values)
            return with_irregularity(campaign, pushes=(*campaign.stated.irregularity.pushes, added))

        for width in (
            log_free("octaves", "1", 0.7, 1.7, lowest=0.05),
            log_free("quality", "1", 4.0, 1.8, lowest=0.5),
        ):
            yield Hypothesis(
                entry=ID,
                domain=DOMAIN,
                family=FAMILY,
                free=(
                    log_free("density_N2_per_Hz", "N2/Hz", centre, 10.0),
                    log_free("centre_Hz", "Hz", CENTRE_HZ, FACTOR),
                    width,
                ),
                amend=amend,
                locate=stays(degree, channels=(name,)),
                starts=((0.0, z, 0.0), (0.0, 0.0, 1.0 if width.name == "octaves" else -1.5)),
                law=lambda v: (
                    f"a force of {np.sqrt(v['density_N2_per_Hz']):.3g} N/sqrt(Hz) about {v['centre_Hz']:.3g} Hz"
                ),
                size="density_N2_per_Hz",
            )


def _order(quantity: str) -> int:
    return {"displacement": 0, "velocity": 1}.get(quantity, 2)


def _mass(vehicle: Vehicle, degree: str) -> float:
    """Mass, or inertia, of a degree in the model, kg or kg m2."""
    part, _, motion = degree.split(".", 1)[1].partition(".")
    if part == "body":
        return vehicle.share * (vehicle.car_body_inertia_kg_m2 if motion == "pitch" else vehicle.car_body_mass_kg)
    if part.startswith("bogie"):
        return vehicle.share * (vehicle.bogie_inertia_kg_m2 if motion == "pitch" else vehicle.bogie_mass_kg)
    return vehicle.share * vehicle.wheelset_mass_kg
