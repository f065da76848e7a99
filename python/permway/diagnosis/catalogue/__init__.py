"""The catalogue of effects: one small module each, whose names say what it is (see `hypothesis.Entry`)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import cast

from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation


@cache
def entries() -> dict[str, Entry]:
    """All effects by identifier."""
    found = {}
    for module in iter_modules(__path__):
        if not module.name.startswith("_"):
            entry = cast(Entry, import_module(f"{__name__}.{module.name}"))
            found[entry.ID] = entry
    return found


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Everything that the catalogue holds possible in a situation."""
    for entry in entries().values():
        yield from entry.hypotheses(situation)
