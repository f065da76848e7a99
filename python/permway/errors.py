"""What goes wrong, stated once and clearly.

Every error a user can cause carries what is wrong, where, the value met and the remedy.
"""

from __future__ import annotations

from functools import partial


class PermwayError(Exception):
    """Base of all errors that permway raises on purpose."""


class InputError(PermwayError, ValueError):
    """An input that cannot be used.

    Parameters
    ----------
    what
        What is wrong, as a short clause.
    where
        The place: a path in a file ("bodies.rail.E"), a column and line, an argument's name.
    value
        The value met, if there is one to show.
    remedy
        What would be right.
    """

    def __init__(self, what: str, *, where: str, value: object = None, remedy: str = "") -> None:
        self.what, self.where, self.value, self.remedy = what, where, value, remedy
        got = "" if value is None else f" (got {_short(value)})"
        super().__init__(f"{where}: {what}{got}" + (f"; {remedy}" if remedy else ""))

    def __reduce__(self) -> tuple[partial[InputError], tuple[()]]:
        """From one process to another it goes whole."""
        return partial(type(self), self.what, where=self.where, value=self.value, remedy=self.remedy), ()


class SolveError(PermwayError, ArithmeticError):
    """A model that cannot be solved at a frequency: singular, not finite or badly conditioned."""


def must_be(value: object, kinds: type | tuple[type, ...], where: str, *, remedy: str = "") -> None:
    """Refuse an argument of another type than one of these.

    Parameters
    ----------
    value
        The argument.
    kinds
        Its possible types; by their names they are reported.
    where
        Its name.
    remedy
        What would be right.

    Raises
    ------
    InputError
        "line: must be a Line, not a str".
    """
    if isinstance(value, kinds):
        return
    names = [_reported(kind) for kind in (kinds if isinstance(kinds, tuple) else (kinds,))]
    met = "None" if value is None else _reported(type(value))
    raise InputError(f"must be {' or '.join(dict.fromkeys(names))}, not {met}", where=where, remedy=remedy)


def _reported(kind: type) -> str:
    names = {"PosixPath": "a path", "WindowsPath": "a path", "Path": "a path", "Mapping": "a dict"}
    name = kind.__name__
    return names.get(name, f"{'an' if name[0] in 'AEIOaeio' else 'a'} {name}")


def _short(value: object, limit: int = 80) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= limit else text[: limit - 3] + "..."
