"""The catalogue of effects: one small module each, whose names say what it is (see `hypothesis.Entry`)."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import cast

from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation
from permway.errors import InputError


@cache
def entries() -> dict[str, Entry]:
    """All effects by identifier."""
    found = {}
    for module in iter_modules(__path__):
        if not module.name.startswith("_"):
            entry = cast(Entry, import_module(f"{__name__}.{module.name}"))
            found[entry.ID] = entry
    return found


def known(names: Collection[str]) -> tuple[str, ...]:
    """Identifiers without repeats, in order.

    Raises
    ------
    InputError
        For one that the catalogue does not hold.
    """
    for name in names:
        if name not in entries():
            remedy = f"use one of {', '.join(entries())}"
            raise InputError("is no effect of the catalogue", where="ruled out", value=name, remedy=remedy)
    return tuple(sorted(set(names)))


def hypotheses(situation: Situation, ruled_out: Collection[str] = ()) -> Iterator[Hypothesis]:
    """Everything that the catalogue holds possible in a situation, but for what somebody has ruled out."""
    for name, entry in entries().items():
        if name not in ruled_out:
            yield from entry.hypotheses(situation)
