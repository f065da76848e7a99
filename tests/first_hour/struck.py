"""Hammer tests of a deck by finite elements that share no code with the solver, as an engineer hands them in."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from permway.arrays import Complexes
from permway.challenge.small.elements_line import Line, line_of
from permway.challenge.small.errors import Errors, blow_noise, root, smooth, struck
from permway.challenge.small.write import write_arrays, write_tables
from simulated import BLOWS, CAMPAIGN, FREQUENCY, MODEL

ERRORS = Errors(size_dB=0.4, length_octaves=1.0, noise=0.02)
"""As of careful measurements."""

STATIONS = [round(0.6 * n, 3) for n in range(21)]

Tables = dict[str, Any]


def nothing(_of: Any) -> None:
    """As it is."""


def as_it_is(values: Complexes) -> Complexes:
    """Responses as they are measured."""
    return values


def struck_deck(
    folder: Path,
    seed: int,
    *,
    pads: float = 1.0,
    there: Callable[[Line], None] = nothing,
    stated: Callable[[Tables, Tables], None] = lambda _campaign, _model: None,
    read: Callable[[Complexes], Complexes] = as_it_is,
) -> Path:
    """Write the campaign; the path of its file.

    Parameters
    ----------
    folder : Path
    seed : int
        Of true values within their tolerances, of calibration errors and of noise.
    pads : float
        True stiffness of all pads over the stated one; these alone are not drawn.
    there : callable
        Changes the true line.
    stated : callable
        Changes what the campaign file and the model file say.
    read : callable
        From responses (sensors, points, F) to what is written down.
    """
    random = np.random.default_rng([seed, 47])
    model, campaign = copy.deepcopy(MODEL), copy.deepcopy(CAMPAIGN)
    model["line"]["joints"][0]["at"] = STATIONS
    true = copy.deepcopy(model["line"])
    for parameter in campaign["parameters"]:
        *path, last = parameter["paths"].split(".")[1:]
        table = true
        for step in path:
            table = table[step]
        off = 0.5 * np.log1p(parameter["tolerance_2sigma"]) * random.standard_normal()
        table[last] *= pads if parameter["name"] == "pad.k" else float(np.exp(off))
    stated(campaign, model)
    path = write_tables(folder, campaign, model)
    line = line_of(true)
    there(line)
    record = campaign["records"][0]
    places = [
        [
            (location["body"], location["x_m"])
            for name in record[key].values()
            for location in locations
            if location["name"] == name
        ]
        for key, locations in (("responses", campaign["sensors"]), ("references", campaign["forces"]))
    ]
    frf = line.receptance(FREQUENCY, 12.0, *places) * -((2.0 * np.pi * FREQUENCY) ** 2)
    functions = root(FREQUENCY, ERRORS.length_octaves)
    sensors, points = (
        np.array([smooth(random, functions, ERRORS.size(kind)) for _ in locations])
        for kind, locations in zip(("sensor", "force"), places, strict=True)
    )
    frf = frf * sensors[:, None, :] * points[None, :, :]
    found, coherence = struck(random, frf, blow_noise(frf, ERRORS, np.ones(frf.shape[0])), BLOWS)
    content = {
        "f": FREQUENCY,
        "frf": np.moveaxis(read(found), -1, 0),
        "coh": np.moveaxis(coherence, -1, 0),
        "sensor": np.array(list(record["responses"])),
        "hammer": np.array(list(record["references"])),
    }
    write_arrays(folder / record["file"], content)
    return path


def tolerance(of: str, value: float) -> Callable[[Tables, Tables], None]:
    """A parameter with another tolerance."""

    def stated(campaign: Tables, _model: Tables) -> None:
        for parameter in campaign["parameters"]:
            if parameter["name"] == of:
                parameter["tolerance_2sigma"] = value

    return stated
