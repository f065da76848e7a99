"""A track on rigid ground, struck by a hammer and ridden, by finite elements that share no code with the solver.

The train rolls, marched in time. Its record is of kilometres of such track, of which the bays that were struck are
a small part: what is wrong there is not in it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from permway.arrays import Complexes, Reals
from permway.challenge.assembly import lossy
from permway.challenge.beams import Section
from permway.challenge.closed_mesh import ClosedMesh
from permway.challenge.crossing import Consist, cross
from permway.challenge.irregularity import profile
from permway.challenge.layout import NOMINAL
from permway.challenge.mesh import Mesh
from permway.challenge.newmark import UNDAMPED
from permway.challenge.plan import CONTACT_N_PER_M
from permway.challenge.small.errors import Errors, blow_noise, root, smooth, struck
from permway.challenge.small.write import write_arrays, write_tables
from permway.challenge.track import Beam, Link, Location, Track, grounded
from permway.challenge.vehicle import vehicle
from scipy.interpolate import CubicSpline

SPACING_M, BAYS, STEP_M = 0.6, 50, 0.15
LAP_M = SPACING_M * BAYS

BEYOND_M = 1.8
"""The rail that is struck goes on so far behind the last fasteners."""

PAD_N_PER_M, PAD_LOSS, VISCOUS_AT_HZ = 1.2e8, 0.25, 100.0
"""Of a pad: a spring and a dashpot, as what is marched in time must have."""

RAIL = {"bending": 2.1e11 * 3.05e-5, "mass": 7850.0 * 7.67e-3}

VEHICLE = {**NOMINAL["vehicle"], "lc": 6.0, "lt": 2.0, "Jc": 2.0e5}
SPEED_M_PER_S, RATE_HZ, RUN_S, FINER, BEFORE_S = 40.0, 512.0, 18.0, 4, 2.0
"""Twenty-four laps; fasteners pass at 66.7 Hz. Steps of 0.5 ms have 100 Hz 0.8 % too low, and losses of the car
body's start are gone in two seconds."""

NOISE = {"axlebox1": 1e-4, "axlebox3": 1e-4, "bogie1": 1e-6}
"""Density of each channel's own noise, (m/s2)2/Hz."""

DEGREES = {"axlebox1": "car1.wheelset1", "axlebox3": "car1.wheelset3", "bogie1": "car1.bogie1.bounce"}

READ = (10.5, 14.1)
STRUCK = (9.0, 10.5, 12.3, 15.0)
BLOWS = 8
FREQUENCY = np.arange(20.0, 421.0, 10.0)
ERRORS = Errors(size_dB=0.4, length_octaves=1.0, noise=0.02)

CENTRE_M = 11.0


def track_of(pads: float, lost: tuple[float, ...] = (), beyond: float = BEYOND_M) -> Track:
    """The rail on its pads, which are so many times as stiff as stated; some of them carry nothing."""
    section = Section(RAIL["bending"], RAIL["mass"], loss=0.02)
    pad = lossy(pads * PAD_N_PER_M, PAD_LOSS, VISCOUS_AT_HZ)
    held = [x for x in (SPACING_M * n for n in range(BAYS + 1)) if not any(abs(x - y) < 0.01 for y in lost)]
    links = [Link((("rail", x),), "pad") for x in held]
    return Track(
        {"rail": Beam(section, -beyond, LAP_M + beyond)}, STEP_M, links, {"pad": grounded(pad)}, {"pad": pad}
    )


class Round(ClosedMesh):
    """The rail closed into a ring."""

    def __init__(self, track: Track) -> None:
        self.length_m = LAP_M
        # Where it closes there is one pad, not two on one place.
        self.track = Track(track.beams, track.step_m, track.links[:-1], track.laws, track.springs)
        self._mesh = Mesh(self.track, ())
        numbers = np.arange(self._mesh.size)
        elements = self._mesh.elements("rail")
        numbers[elements[-1][0][2:]] = elements[0][0][:2]
        _, self._same = np.unique(numbers, return_inverse=True)
        self.size = int(self._same.max()) + 1


def run(random: np.random.Generator, pads: float) -> Reals:
    """Accelerations on board, (samples, channels)."""
    samples = round(RUN_S * RATE_HZ)
    met = profile(random, np.zeros_like, samples=samples, sampling_Hz=RATE_HZ, speed=SPEED_M_PER_S)
    met[np.fft.rfftfreq(samples, 1.0 / RATE_HZ) > 200.0] = 0.0
    fine = samples * FINER
    step = RUN_S / fine
    height = FINER * np.fft.irfft(met, n=fine)
    along = SPEED_M_PER_S * RUN_S * np.arange(fine + 1) / fine
    surface = CubicSpline(along, np.append(height, height[0]), bc_type="periodic", extrapolate="periodic")
    start = round(BEFORE_S * RATE_HZ) * FINER
    car = vehicle({**NOMINAL, "vehicle": VEHICLE}, CONTACT_N_PER_M)
    done = cross(
        Round(track_of(pads, beyond=0.0)),
        Consist({**NOMINAL, "vehicle": VEHICLE}, cars=1, car_m=LAP_M, speed_m_per_s=SPEED_M_PER_S),
        from_m=-start * step * SPEED_M_PER_S,
        to_m=(fine - 1) * step * SPEED_M_PER_S,
        leaves=False,
        profile=surface,
        arms=[car.channels[name] for name in NOISE],
        step_s=step,
        viscous_at_Hz=VISCOUS_AT_HZ,
        beams_at_Hz={"rail": VISCOUS_AT_HZ},
        gamma=UNDAMPED,
    )
    measured = np.fft.irfft(
        np.fft.rfft(done.on_board[start:], axis=0)[: samples // 2 + 1] / FINER, n=samples, axis=0
    )
    own = np.sqrt(0.5 * RATE_HZ * np.array(list(NOISE.values())))
    return np.asarray(measured + own * random.standard_normal(measured.shape))


def hammer(random: np.random.Generator, pads: float, lost: tuple[float, ...]) -> tuple[Complexes, Reals]:
    """Accelerance and coherence, (sensors, points, F)."""
    rows, columns = ([("rail", x) for x in places] for places in (READ, STRUCK))
    locations: list[Location] = [*rows, *columns]
    moved = Mesh(track_of(pads, lost), locations).receptance(FREQUENCY, 12.0, rows, columns)
    frf = np.moveaxis(moved, 0, -1) * -((2.0 * np.pi * FREQUENCY) ** 2)
    functions = root(FREQUENCY, ERRORS.length_octaves)
    sensors, points = (
        np.array([smooth(random, functions, ERRORS.size(kind)) for _ in places])
        for kind, places in (("sensor", READ), ("force", STRUCK))
    )
    frf = frf * sensors[:, None, :] * points[None, :, :]
    return struck(random, frf, blow_noise(frf, ERRORS, np.ones(len(READ))), BLOWS)


def tables(*, floors: bool = True, rides: bool = True) -> tuple[dict[str, Any], dict[str, Any]]:
    """Campaign and model as the user writes them; without floors he states nothing of noise on board."""
    damping = PAD_N_PER_M * PAD_LOSS / (2.0 * np.pi * VISCOUS_AT_HZ)
    rail = {"type": "beam", "youngs_modulus_Pa": 2.1e11, "second_moment_m4": 3.05e-5, "loss_factor": 0.02}
    rail |= {"density_kg_per_m3": 7850.0, "area_m2": 7.67e-3, "intervals_m": [[-BEYOND_M, LAP_M + BEYOND_M]]}
    pad = {"type": "kelvin_voigt", "stiffness": PAD_N_PER_M, "damping": damping}
    at = {"from_m": 0.0, "to_m": LAP_M, "spacing_m": SPACING_M}
    line = {
        "bodies": {"rail": rail},
        "laws": {"pad": pad},
        "joints": [{"between": ["rail", "ground"], "law": "pad", "at": at}],
    }
    model: dict[str, Any] = {"format": 1, "temperature_C": 12.0, "line": line}
    model["frequencies"] = {"from_Hz": 5.0, "to_Hz": 400.0, "step_Hz": 5.0}
    model["forces"] = model["sensors"] = [{"body": "rail", "x_m": 10.5}]
    known = [("pad.k", ["stiffness", "damping"], 0.25), ("pad.c", ["damping"], 0.4)]
    campaign: dict[str, Any] = {
        "format": 1,
        "title": "A track, struck and ridden",
        "model": "model.toml",
        "parameters": [
            {"name": name, "paths": [f"line.laws.pad.{key}" for key in keys], "tolerance_2sigma": tolerance}
            | ({"nominal": PAD_N_PER_M, "unit": "N/m"} if name == "pad.k" else {"unit": "N s/m"})
            for name, keys, tolerance in known
        ],
        "sensors": [{"name": f"rail@{x:g}", "body": "rail", "x_m": x, "unit": "m/s2"} for x in READ],
        "forces": [{"name": f"hit@{x:g}", "body": "rail", "x_m": x} for x in STRUCK],
        "conditions": [{"name": "still", "kind": "hammer", "temperature_C": 12.0}],
        "records": [
            {
                "name": "blows",
                "file": "blows.npz",
                "condition": "still",
                "statistic": "frf",
                "averages": BLOWS,
                "responses": [f"rail@{x:g}" for x in READ],
                "references": [f"hit@{x:g}" for x in STRUCK],
            }
        ],
    }
    if rides:
        _ride(campaign, model, floors)
    return campaign, model


def _ride(campaign: dict[str, Any], model: dict[str, Any], floors: bool) -> None:
    v = VEHICLE
    springs = {f"{n}_stiffness_N_per_m": v[k] / v["half"] for n, k in (("primary", "kp"), ("secondary", "ks"))}
    dampers = {f"{n}_damping_Ns_per_m": v[k] / v["half"] for n, k in (("primary", "cp"), ("secondary", "cs"))}
    masses = {"car_body_mass_kg": v["Mc"], "bogie_mass_kg": v["Mt"], "wheelset_mass_kg": v["Mw"]}
    inertias = {"car_body_inertia_kg_m2": v["Jc"], "bogie_inertia_kg_m2": v["Jt"]}
    lengths = {"bogie_distance_m": v["lc"], "wheelbase_m": v["lt"], "share": v["half"]}
    model["train"] = {
        "centre_m": CENTRE_M,
        "speed_m_per_s": SPEED_M_PER_S,
        "vehicle": {**masses, **inertias, **springs, **dampers, **lengths},
        "contact": {"type": "given", "stiffness_N_per_m": CONTACT_N_PER_M},
    }
    model["irregularity"] = {"type": "german_sato", "continuous": True, "exponent": 3.06}
    campaign["irregularity"] = {"knowledge": "within", "within_dB": 2.0}
    for name, degree in DEGREES.items():
        chain = {"chain": {"noise_floor": NOISE[name]}} if floors else {}
        campaign["sensors"].append({"name": name, "degree": degree, "unit": "m/s2", **chain})
    condition = {"name": "ride", "kind": "train", "temperature_C": 12.0, "speed_m_per_s": SPEED_M_PER_S}
    campaign["conditions"].append(condition)
    record = {"name": "ride", "file": "ride.npz", "condition": "ride", "statistic": "csd", "segment_s": 0.5}
    campaign["records"].append({**record, "band_Hz": [10.0, 90.0], "channels": list(NOISE)})
    level = {"name": "level", "unit": "dB", "paths": ["campaign.irregularity.level_dB"], "acts": "sets"}
    campaign["parameters"].append({**level, "tolerance_2sigma": 2.0, "absolute": True})


Rides = Callable[[np.random.Generator, float], Reals]


def ridden(
    folder: Path,
    seed: int,
    *,
    lost: tuple[float, ...] = (),
    floors: bool = True,
    rides: Rides | None = run,
    stated: Callable[[dict[str, Any]], None] = lambda _campaign: None,
) -> Path:
    """Write the campaign; the path of its file.

    Parameters
    ----------
    folder : Path
    seed : int
        Of the pads' true stiffness within its tolerance, the profile, calibration errors and noise.
    lost : tuple of float
        Places of fasteners that carry nothing where the track was struck, m.
    floors : bool
        Whether the noise on board is stated.
    rides : callable, optional
        Makes the ride; without it there is none.
    stated : callable
        Changes what the campaign file states.
    """
    random = np.random.default_rng([seed, 470])
    pads = float(np.exp(0.5 * np.log1p(0.25) * random.standard_normal()))
    campaign, model = tables(floors=floors, rides=rides is not None)
    stated(campaign)
    path = write_tables(folder, campaign, model)
    frf, coherence = hammer(random, pads, lost)
    names = campaign["records"][0]
    content = {"f": FREQUENCY, "frf": np.moveaxis(frf, -1, 0), "coh": np.moveaxis(coherence, -1, 0)}
    labels = {"sensor": np.array(names["responses"]), "hammer": np.array(names["references"])}
    write_arrays(folder / "blows.npz", content | labels)
    if rides is not None:
        measured = rides(random, pads)
        content = {"fs": RATE_HZ, "acceleration": measured.astype(np.float32), "channels": np.array(list(NOISE))}
        write_arrays(folder / "ride.npz", content)
    return path
