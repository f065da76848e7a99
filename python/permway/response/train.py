"""A train on a line: wheel-rail forces and power spectra of everything that moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway import _core
from permway.arrays import Complexes, Reals
from permway.errors import SolveError, must_be
from permway.model.irregularity import AnyIrregularity, Conversion
from permway.model.irregularity_spectra import Irregularity
from permway.model.line import Line
from permway.model.place import Place
from permway.model.train import Train
from permway.model.vehicle import Vehicle
from permway.response.limits import check_answer
from permway.response.pseudo import power_spectrum, pseudo_excitation, wheel_rail_forces
from permway.response.receptance import (
    CONVENTION,
    Formulation,
    Progress,
    check_line,
    check_sweep,
    frequency_coordinate,
    receptance,
)
from permway.response.sliding import at_work


def train_response(
    line: Line,
    train: Train,
    irregularity: AnyIrregularity,
    frequency_Hz: ArrayLike,
    *,
    sensors: Sequence[Place] = (),
    temperature_C: float | None = None,
    conversion: Conversion = "per_hertz",
    formulation: Formulation = "chain",
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Random response of train and line to a moving irregularity (paper, equations (16) to (20)).

    Suspensions that slide act as the dashpots that do the same work in the motion over these frequencies; what
    their forces are beside that is left out.

    Parameters
    ----------
    line, train, irregularity
        The model.
    frequency_Hz : array_like, shape (F,)
        Ascending, positive.
    sensors : sequence of Place
        Further places on the line whose power spectra are wanted; the contact points always are.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    conversion : "per_hertz" or "wavenumber_density_called_per_hertz"
        True density per hertz, or the paper's: the density over wavenumber taken for one.
    formulation, threads, progress
        As in :func:`permway.response.receptance.receptance`.

    Returns
    -------
    xarray.Dataset
        Receptances at the contacts in m/N (`wheel_receptance`, `track_receptance`, `total_receptance`, each
        frequency x wheel x wheel_force; `contact_receptance` a scalar), `wheel_rail_force` (complex,
        N/sqrt(Hz), frequency x wheel) and one-sided densities: `irregularity_psd`, `wheel_rail_force_psd`, and
        displacement, velocity and acceleration of the vehicle (frequency x degree) and of the line
        (frequency x place).

    Raises
    ------
    InputError
        For inputs that do not fit.
    SolveError
        If line, or wheels on the line, cannot be solved at a frequency.
    """
    check_line(line)
    must_be(train, Train, "train", remedy="as in Train(vehicle=crh380a(), centre_m=16.0, speed_m_per_s=80.0)")
    must_be(irregularity, Irregularity, "irregularity")
    frequency = check_sweep(frequency_Hz)
    wheels = train.wheels()
    places = [*wheels, *sensors]
    check_answer(frequency.size, 4, len(wheels), len(wheels))
    line_response = receptance(
        line,
        frequency,
        forces=wheels,
        sensors=places,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
        progress=progress,
    )
    to_places = line_response["receptance"].values
    track = to_places[:, : len(wheels), :]
    contact = train.contact.receptance(train.vehicle.share)

    def on(vehicle: Vehicle) -> tuple[Complexes, Complexes, Complexes]:
        """Receptance of the wheels, forces between wheels and rail, motion of the vehicle."""
        wheel = vehicle.wheel_receptance(frequency)
        force = wheel_rail_forces(wheel, track, contact, excitation, frequency_Hz=frequency)
        # Compression pushes the rail down and the wheel up.
        return wheel, force, vehicle.response_to_wheel_force(frequency, -force)

    # What overflows is found below, with its frequency.
    with np.errstate(all="ignore"):
        density = irregularity.density(frequency, train.speed_m_per_s, conversion)
        excitation = pseudo_excitation(frequency, density, train.vehicle.lags_m(), train.speed_m_per_s)
        try:
            vehicle = at_work(train.vehicle, frequency, lambda moving: on(moving)[2])
            wheel, force, on_vehicle = on(vehicle)
        except np.linalg.LinAlgError as error:
            raise SolveError(f"the vehicle alone is singular between {_band(frequency)}") from error
        on_line = np.einsum("fsw,fw->fs", to_places, force)
        total = wheel + track + contact * np.eye(len(wheels))

    def spectrum(response: Complexes, derivatives: int) -> Reals:
        with np.errstate(all="ignore"):
            return power_spectrum(response, frequency, derivatives=derivatives)

    labels = [p.label for p in places]
    data = xr.Dataset(
        coords={
            "frequency": frequency_coordinate(frequency),
            "wheel": [p.label for p in wheels],
            "wheel_force": [p.label for p in wheels],
            "degree": vehicle.degrees,
            "place": labels,
            "place_x": ("place", [p.x_m for p in places], {"units": "m"}),
            "place_body": ("place", [p.body for p in places]),
        },
        attrs={
            **line_response.attrs,
            "convention": f"{CONVENTION}; contact force positive in compression; densities one-sided",
            "conversion": conversion,
            "speed_m_per_s": train.speed_m_per_s,
            "permway_version": _core.__version__,
        },
    )
    square = ("frequency", "wheel", "wheel_force")
    for name, values in (("wheel", wheel), ("track", track), ("total", total)):
        data[f"{name}_receptance"] = (square, values, {"long_name": f"{name} receptance", "units": "m/N"})
    data["contact_receptance"] = ((), contact, {"long_name": "contact receptance", "units": "m/N"})
    data["irregularity_psd"] = ("frequency", density, {"long_name": "irregularity", "units": "m2/Hz"})
    data["wheel_rail_force"] = (
        ("frequency", "wheel"),
        force,
        {"long_name": "wheel-rail pseudo-force", "units": "N/sqrt(Hz)"},
    )
    data["wheel_rail_force_psd"] = (
        ("frequency", "wheel"),
        spectrum(force, 0),
        {"long_name": "wheel-rail force", "units": "N2/Hz"},
    )
    quantities = (("displacement", "m2/Hz"), ("velocity", "(m/s)2/Hz"), ("acceleration", "(m/s2)2/Hz"))
    for name, response, dimension in (("vehicle", on_vehicle, "degree"), ("line", on_line, "place")):
        for derivatives, (quantity, units) in enumerate(quantities):
            data[f"{name}_{quantity}_psd"] = (
                ("frequency", dimension),
                spectrum(response, derivatives),
                {"long_name": f"{name} {quantity}", "units": units},
            )
    _check_finite(data)
    # A pitch is an angle; its densities have rad for m.
    pitch = "pitch degrees in rad, rad/s, rad/s2 instead of m, m/s, m/s2"
    for _, (quantity, _units) in enumerate(quantities):
        data[f"vehicle_{quantity}_psd"].attrs["comment"] = pitch
    return data


def _check_finite(data: xr.Dataset) -> None:
    for name, values in data.data_vars.items():
        if values.dims[:1] != ("frequency",):
            continue
        bad = ~np.isfinite(values.values).reshape(values.shape[0], -1).all(axis=1)
        if bad.any():
            raise SolveError(f"{name} is not finite at {float(data['frequency'][bad][0]):g} Hz")


def _band(frequency: Reals) -> str:
    return f"{frequency[0]:g} and {frequency[-1]:g} Hz"
