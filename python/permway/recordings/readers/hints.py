"""What whoever wrote a file down knows of it, and the file does not say, or states wrongly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from permway.errors import InputError

NO_TIMES = "none"
"""As `time_column`: the file's own times are left aside."""


@dataclass(frozen=True, kw_only=True)
class Hints:
    """Statements that win over what a file states.

    Each is a key of `[[records]]` in the campaign file, of the same name.

    Attributes
    ----------
    header_row : int, optional
        Of text: number of the line, from 1, that names the columns; 0 if none does.
    skip_rows : int, optional
        Of text: so many lines at the beginning are no part of the table.
    time_column : str, optional
        Column, channel or array that holds the times; "none" leaves the file's times aside.
    decimal : "." or ",", optional
        Of text: sign before the decimals.
    encoding : str, optional
        Of text and universal files: name of the character set, as Python knows it.
    unit : str or dict of label to str, optional
        Of all channels, or of each by its label, in place of the file's; also of the times and of a phase.
    axes : tuple of str, optional
        Of an array of frequency responses: "frequency", "response" and "reference" in the order of its axes.
    pairs : dict of str to (str, str), optional
        Of frequency responses side by side in a table: what was read and what was struck, by a column's name.
    """

    header_row: int | None = None
    skip_rows: int | None = None
    time_column: str | None = None
    decimal: Literal[".", ","] | None = None
    encoding: str | None = None
    unit: str | Mapping[str, str] | None = None
    axes: tuple[str, ...] | None = None
    pairs: Mapping[str, tuple[str, str]] | None = None

    def __post_init__(self) -> None:
        for key in ("header_row", "skip_rows"):
            value = getattr(self, key)
            if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 0):
                raise InputError("must be a whole number from 0 on", where=key, value=value)
        if self.header_row is not None and self.skip_rows is not None and 0 < self.header_row <= self.skip_rows:
            what = "the line of the header is among those that are skipped"
            raise InputError(what, where="header_row", value=self.header_row, remedy="lines count from 1")
        if self.decimal not in (None, ".", ","):
            raise InputError('must be "." or ","', where="decimal", value=self.decimal)
        if self.encoding is not None:
            try:
                "".encode(self.encoding)
            except LookupError:
                remedy = "use utf-8, latin-1, cp1252 or utf-16"
                raise InputError(
                    "no such character set", where="encoding", value=self.encoding, remedy=remedy
                ) from None
        if self.axes is not None and sorted(self.axes) != ["frequency", "reference", "response"]:
            remedy = 'as in axes = ["frequency", "response", "reference"]'
            raise InputError("must name the three axes", where="axes", value=self.axes, remedy=remedy)

    def unit_of(self, label: str) -> str | None:
        """The unit that was stated of a channel or of the times."""
        return self.unit.get(label) if isinstance(self.unit, Mapping) else None

    def channel_unit(self, label: str) -> str | None:
        """The unit that was stated of a channel, by its label or of all."""
        return self.unit if isinstance(self.unit, str) else self.unit_of(label)

    @property
    def no_times(self) -> bool:
        """Whether the file's own times are left aside."""
        return self.time_column == NO_TIMES


NO_HINTS = Hints()
