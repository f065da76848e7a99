"""What hardly acts changes hardly anything: where the search looks for small effects, over random campaigns."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small.make import make_small
from permway.diagnosis.gather import gather
from permway.diagnosis.tangent import Problem
from permway.posterior.cells import Cell, cells, resized, small
from permway.posterior.fit import Fit, grown
from permway.posterior.recalibrated import recalibrated

SHOWS = 1.0
"""Norm of a change, in standard deviations, from which it is held to the rule: below, rounding may show."""


def fitted(folder: Path, seed: int, index: int) -> Fit:
    name = make_small(seed, index, folder)
    return recalibrated(gather(read_campaign(folder / name / "campaign.toml"), threads=1))


def change(fit: Fit, cell: Cell) -> np.ndarray:
    """What a cell changes in the residuals."""
    model = grown(fit, cell.hypothesis, "1.")
    state = Problem(fit.frame.observations, model.build, model.free).at(np.concatenate([fit.z, cell.z]))
    assert state is not None
    return state.residuals - fit.state.residuals


def norm(fit: Fit, cell: Cell) -> float:
    """Of the same, in standard deviations."""
    return float(np.sqrt(fit.covariance.square(change(fit, cell))))


def off(cell: Cell) -> float:
    """How far its size is from none."""
    hypothesis = cell.hypothesis
    return abs(cell.values[hypothesis.size] - hypothesis.none) if hypothesis.size else float(np.abs(cell.z).max())


@pytest.mark.parametrize("index", [0, 1, 2, 3])
def test_a_quarter_of_a_small_change_does_a_quarter_or_less(tmp_path: Path, index: int) -> None:
    """Of every form in the catalogue that has a size; power that grows by its square does a sixteenth."""
    fit = fitted(tmp_path, 5150002, index)
    each = {}
    for cell in small(cells(fit)):
        quarter = resized(cell, 0.25)
        if off(quarter) < 0.5 * off(cell):
            each.setdefault((cell.hypothesis.form, tuple(np.sign(cell.z))), (cell, quarter))
    assert len(each) > 15
    far = []
    for cell, quarter in each.values():
        whole, part = norm(fit, cell), norm(fit, quarter)
        if whole > SHOWS and part > 0.4 * whole:
            far.append((cell.hypothesis.form, cell.values, whole, part))
    assert not far


HARDLY = 1e-6
"""Norm of a change, in standard deviations, below which an effect does not act on these records."""

FEW = 8
"""Starts of each effect, at random places."""


@pytest.mark.parametrize("index", [2, 5])
def test_a_small_change_grows_by_the_power_that_its_effect_states(tmp_path: Path, index: int) -> None:
    """A quarter of an amplitude that adds to a density changes it by a sixteenth."""
    fit = fitted(tmp_path, 5150002, index)
    exponents: dict[tuple[str, str], list[float]] = {}
    found = small(cells(fit))
    for i in np.random.default_rng(index).permutation(len(found)).tolist():
        cell, hypothesis = found[i], found[i].hypothesis
        form = hypothesis.entry, hypothesis.family
        quarter = resized(cell, 0.25)
        if len(exponents.get(form, ())) == FEW or not 0.2 < off(quarter) / off(cell) < 0.3:
            continue
        whole, part = norm(fit, cell), norm(fit, quarter)
        if whole > HARDLY:
            exponents.setdefault(form, []).append(float(np.log(whole / part) / np.log(4.0)) / hypothesis.power)
    assert len(exponents) > 12
    assert ("contact_filter", "contact") in exponents
    wrong = {form: each for form, each in exponents.items() if not 0.75 < np.median(each) < 1.25}
    assert not wrong


def alike(fit: Fit, one: np.ndarray, other: np.ndarray) -> float:
    """Share of what one direction gains that another finds."""

    def square(values: np.ndarray) -> float:
        return float(fit.covariance.square(values))

    both = 0.25 * (square(one + other) - square(one - other))
    return both**2 / (square(one) * square(other))


@pytest.mark.parametrize("index", [0, 3])
def test_an_element_half_way_between_two_starts_is_seen_by_one(tmp_path: Path, index: int) -> None:
    """A spring, dashpot or inertance of no catalogue, from a body to another or the ground."""
    fit = fitted(tmp_path, 5150002, index)
    forms: dict[tuple[str, ...], list[Cell]] = {}
    for cell in small(cells(fit)):
        if cell.hypothesis.entry == "novel" and cell.hypothesis.form[2].startswith(
            ("spring +", "dashpot", "inerter")
        ):
            forms.setdefault(cell.hypothesis.form, []).append(cell)
    seen = 0
    for form, starts in forms.items():
        starts.sort(key=lambda cell: cell.values["x_m"])
        for one, other in list(pairwise(starts))[::6]:
            at = [f.name for f in one.hypothesis.free].index("x_m")
            between = Cell(one.hypothesis, one.z.copy(), one.log_prior)
            middle = 0.5 * (other.values["x_m"] + one.values["x_m"])
            per_z = one.hypothesis.free[at].value(1.0) - one.hypothesis.free[at].value(0.0)
            between.z[at] += (middle - one.values["x_m"]) / per_z
            sizes = [change(fit, cell) for cell in (between, one, other)]
            seen += 1
            assert max(alike(fit, sizes[0], sizes[1]), alike(fit, sizes[0], sizes[2])) > 0.3, form
    assert seen > 3
