"""A measuring team's folder, made from a sheet: a short deck, its hammer test and two runs.

The line is spelled out joint by joint from the sheet's words, not by the importer's own reading of them.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from permway.laws import Hysteretic
from permway.model.bodies import Beam
from permway.model.irregularity import GermanSato
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.vehicle import Vehicle
from permway.response.pseudo import pseudo_excitation, wheel_rail_forces
from permway.response.receptance import receptance
from scipy import io

SPACING = 0.64
LENGTH = 12.8
SECONDS = 16
RATE_HZ = 1024
SPEEDS_KMH = (180.0, 252.0)
BLOWS = 8
COHERENCE = 0.98
NOISE = 0.002
"""Standard deviation of the runs' noise, m/s2."""

SHEET: dict[str, Any] = {
    "layout": {
        "spans": 1,
        "span_m": LENGTH,
        "fastener_spacing_m": SPACING,
        "approach_m": 6.4,
        "slab_length_m": LENGTH,
    },
    "values": {
        "rail": {"E": 2.1e11, "I": 3.2e-5, "rho": 7850, "A": 7.7e-3, "G": 7.7e10, "kappa": 0.4, "eta": 0.01},
        "slab": {"E": 3.6e10, "I": 8.5e-4, "rho": 2500, "A": 0.255, "eta": 0.1},
        "base": {"E": 3.0e10, "I": 3.7e-3, "rho": 2500, "A": 0.4875, "eta": 0.1},
        "girder": {"E": 3.6e10, "I": 0.5, "rho": 2650, "A": 2.5, "eta": 0.1},
        "pad": {"k": 5.8e7, "eta": 0.12},
        "mortar": {"k": 1.5e11, "eta": 0.2},
        "sliding": {"k": 8.0e10, "eta": 0.2},
        "bearing": {"k": 3.0e9, "eta": 0.25},
        "vehicle": {
            **{"Mc": 42934, "Mt": 3300, "Mw": 1780, "Jc": 1.712e6, "Jt": 1807, "kp": 1.176e6, "cp": 1e4},
            **{"ks": 2.4e5, "cs": 2e4, "lc": 17.5, "lt": 2.5, "half": 0.5},
        },
    },
    "contact_stiffness_N_per_m": 1.3e9,
    "tolerance_2sigma_relative": {
        "pad": {"k": 0.25, "eta": 0.5},
        "girder": {"E": 0.12, "rho": 0.05},
        "vehicle": {"kp": 0.15, "Mc": 0.08},
    },
    "temperature_C": [12.0],
    "hammer": {
        "quantity": f"accelerance (m/s^2)/N, H1 of {BLOWS} blows, with coherence",
        "lines_Hz": [10.0, 300.0, 2.0],
        "sensors": [["rail", 6.4], ["slab", 6.4], ["girder", 0.0]],
        "points": [["rail", 6.4], ["rail", 2.56], ["girder", 6.4]],
    },
    "runs": {
        "sampling_Hz": RATE_HZ,
        "seconds": SECONDS,
        "unit": "m/s^2",
        "speeds_kmh": list(SPEEDS_KMH),
        "channels": ["axlebox1", "axlebox2", "axlebox3", "axlebox4", "bogie1", "carbody"],
        "position": "wheelsets 1..4 at x0+10, x0+7.5, x0-7.5, x0-10 with x0 = 6.4 m (moving-irregularity model), "
        "each rounded to the nearest 0.16 m",
    },
}


def make_folder(folder: Path, *, interpolated: bool = False) -> Path:
    """Write sheet.json, a hammer file and two runs; with `interpolated` as if computed on whole hertz."""
    folder.mkdir()
    (folder / "sheet.json").write_text(json.dumps(SHEET))
    random = np.random.default_rng(7)
    line = _line()
    _hammer(folder / "hammer_+12C.mat", line, random)
    for speed in SPEEDS_KMH:
        _run(folder / f"run_{speed:.0f}kmh.npz", line, speed / 3.6, interpolated, random)
    return folder


def _line() -> Line:
    values = SHEET["values"]

    def beam(name: str, **more: Any) -> Beam:
        v = values[name]
        return Beam(
            youngs_modulus_Pa=v["E"],
            second_moment_m4=v["I"],
            density_kg_per_m3=v["rho"],
            area_m2=v["A"],
            loss_factor=v["eta"],
            **more,
        )

    rail = {"theory": "timoshenko", "shear_modulus_Pa": 7.7e10, "shear_coefficient": 0.4}
    deck = {"intervals_m": ((0.0, LENGTH),)}
    bays = round(LENGTH / SPACING)
    stations = tuple(SPACING * i for i in range(bays + 1))
    inner, outer = stations[1:-1], (stations[0], stations[-1])
    approach = tuple(SPACING * i for i in (*range(-10, 0), *range(bays + 1, bays + 11)))
    joints = [
        Joints(between=("rail", "slab"), law="pad", at=stations),
        Joints(between=("rail", "ground"), law="pad", at=approach),
        Joints(between=("girder", "ground"), law="bearing", at=outer),
    ]
    for upper, lower, law in (("slab", "base", "mortar"), ("base", "girder", "sliding")):
        joints.append(Joints(between=(upper, lower), law=law, at=inner, scale=1.0 / bays))
        joints.append(Joints(between=(upper, lower), law=law, at=outer, scale=0.5 / bays))
    laws = {
        name: Hysteretic(stiffness=values[name]["k"], loss_factor=values[name]["eta"])
        for name in ("pad", "mortar", "sliding", "bearing")
    }
    bodies = {"rail": beam("rail", **rail), **{name: beam(name, **deck) for name in ("slab", "base", "girder")}}
    return Line(bodies=bodies, joints=tuple(joints), laws=laws)


def _hammer(path: Path, line: Line, random: np.random.Generator) -> None:
    first, last, step = SHEET["hammer"]["lines_Hz"]
    frequency = np.arange(first, last + 1e-9, step)
    locations = {
        key: [Place(body=b, x_m=x, name=f"{b}@{x}") for b, x in SHEET["hammer"][key]]
        for key in ("sensors", "points")
    }
    h = receptance(line, frequency, forces=locations["points"], sensors=locations["sensors"], threads=1)[
        "receptance"
    ].values
    accelerance = -((2.0 * np.pi * frequency)[:, None, None] ** 2) * h
    error = np.sqrt((1.0 - COHERENCE) / (2.0 * BLOWS * COHERENCE))
    noise = random.normal(size=(2, *h.shape)) * error
    io.savemat(
        path,
        {
            "f": frequency,
            "frf": accelerance * np.exp(noise[0] + 1j * noise[1]),
            "coh": np.full(h.shape, COHERENCE),
            "sensor": np.array([place.label for place in locations["sensors"]]),
            "hammer": np.array([place.label for place in locations["points"]]),
        },
    )


def _run(path: Path, line: Line, speed: float, interpolated: bool, random: np.random.Generator) -> None:
    v = SHEET["values"]["vehicle"]
    vehicle = Vehicle(
        car_body_mass_kg=v["Mc"],
        bogie_mass_kg=v["Mt"],
        wheelset_mass_kg=v["Mw"],
        car_body_inertia_kg_m2=v["Jc"],
        bogie_inertia_kg_m2=v["Jt"],
        primary_stiffness_N_per_m=2.0 * v["kp"],
        primary_damping_Ns_per_m=2.0 * v["cp"],
        secondary_stiffness_N_per_m=2.0 * v["ks"],
        secondary_damping_Ns_per_m=2.0 * v["cs"],
        share=0.5,
    )
    wheels = np.round((6.4 + np.array([10.0, 7.5, -7.5, -10.0])) / 0.16) * 0.16
    all_Hz = np.fft.rfftfreq(SECONDS * RATE_HZ, 1.0 / RATE_HZ)
    inside = (all_Hz >= 1.0) & (all_Hz <= 300.0)
    frequency = all_Hz[inside]
    lines = np.concatenate([np.arange(1.0, 30.0, 0.5), np.arange(30.0, 301.0)]) if interpolated else frequency
    places = [Place(body="rail", x_m=float(x), name=f"w{i}") for i, x in enumerate(wheels)]
    track = receptance(line, lines, forces=places, sensors=places, threads=1)["receptance"].values
    profile = pseudo_excitation(lines, np.ones(lines.size), wheels[0] - wheels, speed)
    force = wheel_rail_forces(vehicle.wheel_receptance(lines), track, 1.0 / 1.3e9, profile)
    moved = vehicle.response_to_wheel_force(lines, -force)[:, [6, 7, 8, 9, 2, 0]]
    transfer = -((2.0 * np.pi * lines)[:, None] ** 2) * moved
    if interpolated:
        transfer = np.stack([np.interp(frequency, lines, column) for column in transfer.T], axis=-1)
    density = GermanSato(continuous=True).density(frequency, speed)
    white = (random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size)) / np.sqrt(2.0)
    # One-sided density S: |X|^2 = S fs n / 2.
    spectrum = np.zeros((all_Hz.size, 6), dtype=complex)
    spectrum[inside] = transfer * (white * np.sqrt(0.5 * density * RATE_HZ * SECONDS * RATE_HZ))[:, None]
    samples = np.fft.irfft(spectrum, n=SECONDS * RATE_HZ, axis=0)
    samples += NOISE * random.normal(size=samples.shape)
    np.savez(
        path,
        fs=float(RATE_HZ),
        acceleration=samples.astype(np.float32),
        channels=np.array(SHEET["runs"]["channels"]),
    )
