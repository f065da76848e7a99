"""Stands for a measurement: `python make_deck.py FOLDER` writes what a data logger would have written.

A hammer test, a CSV for each point struck, and two runs of a train, a CSV each. In truth two fasteners about
x = 7.5 m carry 5 % of what they should, and the pads are 6 % softer than the user believes.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
import permway
from permway.model.changes import Change
from permway.model.line import Line
from permway.response.pseudo import pseudo_excitation, wheel_rail_forces

HERE = Path(__file__).parent
STRUCK = {"rail 6.0": ("rail", 6.0), "rail 9.3": ("rail", 9.3), "deck 4.5": ("deck", 4.5)}
READ = {"rail": ("rail", 6.0), "deck": ("deck", 3.0)}
BLOWS, BLOW_S, RUN_S, RATE_HZ = 16, 4.0, 64.0, 512.0
PULSE_S, PEAK_N, NOISE = 0.004, 8000.0, 0.004


def truth(believed: Line) -> Line:
    """The line as it is."""
    pads, bearings = believed.joints
    attached = pads.model_copy(update={"changes": (Change(from_m=7.1, to_m=7.9, factor=0.05),)})
    pad = believed.laws["pad"]
    laws = {**believed.laws, "pad": pad.model_copy(update={"stiffness": 0.94 * pad.stiffness})}
    return Line(bodies=believed.bodies, joints=(attached, bearings), laws=laws)


def blows(line: Line, random: np.random.Generator) -> dict[str, np.ndarray]:
    """Of each point struck: force and two accelerations, one blow after the other, shape (samples, 3)."""
    samples = int(BLOW_S * RATE_HZ)
    frequency = np.fft.rfftfreq(samples, 1.0 / RATE_HZ)
    places = [[permway.Place(body=b, x_m=x) for b, x in table.values()] for table in (STRUCK, READ)]
    answer = permway.receptance(line, frequency[1:], forces=places[0], sensors=places[1], threads=1)
    accelerance = permway.accelerance(answer["receptance"]).values
    time = np.arange(samples) / RATE_HZ
    pulse = PEAK_N * np.where(time < PULSE_S, np.sin(np.pi * time / PULSE_S), 0.0)
    found = {}
    for point, name in enumerate(STRUCK):
        pieces = []
        for _ in range(BLOWS):
            force = pulse * random.uniform(0.7, 1.3)
            spectrum = np.zeros((frequency.size, 2), dtype=complex)
            spectrum[1:] = accelerance[:, :, point] * np.fft.rfft(force)[1:, None]
            read = np.fft.irfft(spectrum, n=samples, axis=0)
            read += NOISE * np.abs(read).max(axis=0) * random.standard_normal(read.shape)
            pieces.append(np.column_stack([force, read]))
        found[name] = np.concatenate(pieces)
    return found


def run(model: permway.Model, line: Line, speed: float, random: np.random.Generator) -> np.ndarray:
    """Accelerations of the first and the third axle box, shape (samples, 2)."""
    assert model.train is not None
    assert model.irregularity is not None
    samples = int(RUN_S * RATE_HZ)
    every = np.fft.rfftfreq(samples, 1.0 / RATE_HZ)
    inside = (every >= 2.0) & (every <= 120.0)
    frequency, wheels, vehicle = every[inside], model.train.wheels(), model.train.vehicle
    track = permway.receptance(line, frequency, forces=wheels, sensors=wheels, threads=1)["receptance"].values
    profile = pseudo_excitation(frequency, np.ones(frequency.size), vehicle.lags_m(), speed)
    contact = model.train.contact.receptance(vehicle.share)
    force = wheel_rail_forces(vehicle.wheel_receptance(frequency), track, contact, profile)
    axles = [vehicle.degrees.index(f"car1.wheelset{n}") for n in (1, 3)]
    moved = vehicle.response_to_wheel_force(frequency, -force)[:, axles]
    density = model.irregularity.density(frequency, speed)
    white = (random.standard_normal(frequency.size) + 1j * random.standard_normal(frequency.size)) / np.sqrt(2.0)
    spectrum = np.zeros((every.size, 2), dtype=complex)
    size = np.sqrt(0.5 * density * RATE_HZ * samples) * (2.0 * np.pi * frequency) ** 2
    spectrum[inside] = -moved * (white * size)[:, None]
    return np.fft.irfft(spectrum, n=samples, axis=0) + np.sqrt(1e-5 * RATE_HZ / 2) * random.standard_normal(
        (samples, 2)
    )


def write(folder: Path) -> None:
    """Model and campaign as the user wrote them, and the records."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("model.toml", "campaign.toml"):
        shutil.copy(HERE / "deck" / name, folder / name)
    model = permway.read_model(folder / "model.toml")
    line, random = truth(model.line), np.random.default_rng(1)
    for name, values in blows(line, random).items():
        _csv(folder / f"blows {name}.csv", "hammer [N],rail [m/s2],deck [m/s2]", values)
    for speed in (144, 288):
        _csv(folder / f"run_{speed}.csv", "axlebox1 [m/s2],axlebox3 [m/s2]", run(model, line, speed / 3.6, random))


def _csv(path: Path, header: str, values: np.ndarray) -> None:
    remark = f"# fs = {RATE_HZ:g}\n{header}"
    np.savetxt(path, values, fmt="%.6g", delimiter=",", header=remark, comments="")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
