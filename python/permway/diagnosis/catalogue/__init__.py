"""The catalogue of effects: one small module each, whose names say what it is (see `hypothesis.Entry`)."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import cast

from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation
from permway.diagnosis.plain_names import name_of
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

    Parameters
    ----------
    names : collection of str
        Identifiers, or the words that a verdict has for them, in any case: "lost fasteners", "bearing stiffness".

    Raises
    ------
    InputError
        For one that the catalogue does not hold, with those that are spelled alike.
    """
    words = {_plain(name_of(one)): one for one in entries()} | {_plain(one): one for one in entries()}
    found = set()
    for name in names:
        if _plain(name) not in words:
            near = list(dict.fromkeys(words[one] for one in get_close_matches(_plain(name), words, 3)))
            asked = f"did you mean {' or '.join(repr(one) for one in near)}? " if near else ""
            remedy = f"{asked}use one of {', '.join(entries())}"
            raise InputError("is no effect of the catalogue", where="ruled out", value=name, remedy=remedy)
        found.add(words[_plain(name)])
    return tuple(sorted(found))


def _plain(name: str) -> str:
    return " ".join(name.replace("_", " ").replace("-", " ").lower().split())


def hypotheses(situation: Situation, ruled_out: Collection[str] = ()) -> Iterator[Hypothesis]:
    """Everything that the catalogue holds possible in a situation, but for what somebody has ruled out."""
    for name, entry in entries().items():
        if name not in ruled_out:
            yield from entry.hypotheses(situation)
