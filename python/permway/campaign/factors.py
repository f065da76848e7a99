"""Numbers of the model that are others under one condition: under load, at large amplitude, in the cold."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from operator import mul
from typing import TYPE_CHECKING

from permway.campaign.parts import Condition
from permway.campaign.paths import leads, parse_path, with_numbers
from permway.errors import InputError
from permway.problem.model import Model

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

Factors = tuple[tuple[str, float], ...]
"""Paths into the model file, and what the numbers there are multiplied by; sorted."""

HEADS = ("line", "train", "irregularity")
"""What of a model may differ between conditions."""


def factors_of(condition: Condition) -> Factors:
    """The factors of a condition that are not 1."""
    return tuple(sorted((path, factor) for path, factor in condition.factors.items() if factor != 1.0))


def model_under(model: Model, factors: Factors) -> Model:
    """The model with its numbers multiplied; the model itself where nothing is.

    Raises
    ------
    InputError
        For a path that leads to no number of the model, or a product that the model refuses.
    """
    steps = [parse_path(path, "factors") for path, _ in factors]
    try:
        changed: Model = with_numbers(
            model, [(at, partial(mul, factor)) for at, (_, factor) in zip(steps, factors, strict=True)]
        )
    except KeyError as error:
        path = next(path for at, (path, _) in zip(steps, factors, strict=True) if not leads(model, at))
        raise InputError(f"leads to no number: {error.args[0]}", where="factors", value=path) from error
    return changed


def campaign_under(campaign: Campaign, condition: Condition) -> Campaign:
    """The campaign with its model as it is under a condition."""
    factors = factors_of(condition)
    return replace(campaign, model=model_under(campaign.model, factors)) if factors else campaign


def check_factors(conditions: Iterable[Condition], model: Model) -> None:
    """Check that factors lead to numbers of the model.

    Raises
    ------
    InputError
        With the place in the campaign file.
    """
    for index, condition in enumerate(conditions):
        for path, factor in condition.factors.items():
            where = f'conditions[{index}].factors["{path}"]'
            steps = parse_path(path, where)
            if steps[0] not in HEADS:
                remedy = f"begin with one of {list(HEADS)}"
                raise InputError("does not differ between conditions", where=where, value=path, remedy=remedy)
            try:
                model_under(model, ((path, factor),))
            except InputError as error:
                raise InputError(error.what, where=where, value=error.value, remedy=error.remedy) from error
