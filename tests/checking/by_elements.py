"""Small campaigns whose records are made by finite elements that share no code with the solver."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.challenge.small import places
from permway.challenge.small.by_elements import ByElements
from permway.challenge.small.draws import generator
from permway.challenge.small.errors import Errors, blow_noise, root, smooth, struck
from permway.challenge.small.layouts import draw_layout
from permway.challenge.small.make import true_values
from permway.challenge.small.write import write_arrays, write_tables

ERRORS = Errors(size_dB=0.4, length_octaves=1.0, noise=0.02)
"""As of careful measurements."""

Tables = dict[str, Any]


def nothing(_tables: Tables) -> None:
    """The files as they are drawn."""


def as_it_is(values: Complexes, _frequency_Hz: Reals) -> Complexes:
    """The records as they are measured."""
    return values


def campaign_by_elements(
    folder: Path,
    seed: int,
    *,
    layout: str = "deck",
    read: Callable[[Complexes, Reals], Complexes] = as_it_is,
    stated: Callable[[Tables], None] = nothing,
    concealed: str | None = None,
    scaled: float = 1.0,
) -> Campaign:
    """Write a campaign of hammer tests and read it.

    Parameters
    ----------
    folder : Path
    seed : int
    layout : str
        "deck", "ballast", "slab", "beam" or "rig".
    read : callable
        From responses (sensors, points, F) and frequencies to what is written down.
    stated : callable
        Changes the campaign's table.
    concealed : str, optional
        An effect of the generator, at its largest.
    scaled : float
        Of the first parameter's true value, as of pads that are softer than is believed.
    """
    drawn = next(
        (found, random)
        for index in range(200)
        if (found := draw_layout(random := generator(seed, index, "layout"))).name == layout
    )
    where, random = drawn
    tests = places.draw_tests(random, where, runs=False)
    model, table = tests.model, tests.campaign
    stated(table)
    campaign = read_campaign(write_tables(folder, table, model))
    values, beyond = true_values(campaign, generator(seed, 0, "parameters"))
    for name in list(values)[:1]:
        values[name] *= scaled
    maker = ByElements(tests, where, values, beyond)
    effect = None if concealed is None else maker.draw(generator(seed, 0, "effects"), concealed)
    assert concealed is None or effect is not None
    random = generator(seed, 0, "noise")
    there = maker.responses([] if effect is None else [(effect, 1.0)])[0]
    functions = root(tests.frequency_Hz, ERRORS.length_octaves)
    for index, values_there in enumerate(there):
        sensors, points = (
            np.array([smooth(random, functions, ERRORS.size(kind)) for _ in range(count)])
            for kind, count in (("sensor", values_there.shape[0]), ("force", values_there.shape[1]))
        )
        responses = values_there * sensors[:, None, :] * points[None, :, :]
        noise = blow_noise(responses, ERRORS, np.ones(responses.shape[0]))
        frf, coherence = struck(random, responses, noise, places.BLOWS)
        content = {
            "f": tests.frequency_Hz,
            "frf": np.moveaxis(read(frf, tests.frequency_Hz), -1, 0),
            "coh": np.moveaxis(coherence, -1, 0),
            "sensor": np.array([sensor["name"] for sensor in tests.sensors]),
            "hammer": np.array([force["name"] for force in tests.forces]),
        }
        write_arrays(folder / f"blows{index + 1}.npz", content)
    return campaign
