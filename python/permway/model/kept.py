"""What was made of frozen records, kept while these live: a search asks of the same ones again and again."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Record = TypeVar("Record")
Made = TypeVar("Made")


class Kept(Generic[Record, Made]):
    """What was made of the last records.

    Parameters
    ----------
    most : int
        Records that are kept, each once for every use.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._known: dict[Hashable, tuple[weakref.ref[Record], object, Made]] = {}

    def of(self, record: Record, make: Callable[[], Made], *, use: Hashable = None, given: object = None) -> Made:
        """What was made of a record, or what is made now.

        Parameters
        ----------
        record
            Frozen: it is known by what it is, not by what it holds.
        make : callable
        use : hashable
            Results of other uses are kept beside it.
        given : object
            What else it is made from; of each use only that of the last is kept.
        """
        name = (id(record), use)
        known = self._known.get(name)
        # An identity may be another's by now.
        if known is None or known[0]() is not record or known[1] != given:
            known = weakref.ref(record, lambda _: self._known.pop(name, None)), given, make()
            self._known.pop(name, None)
            self._known[name] = known
            for old in list(self._known)[: -self._most]:
                self._known.pop(old, None)
        return known[2]
