"""A law given as a table over frequency."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.laws.frequency_table import check_columns, check_inside
from permway.records import FloatTuple


class Tabulated(Law):
    """Measured storage and loss factor, linear between the points over the logarithm of frequency.

    Parameters
    ----------
    frequency_Hz : tuple of float, shape (n,)
        Strictly increasing, above zero, at least two.
    storage : tuple of float, shape (n,)
        N/m or Pa; kept as the attribute `storage_values`.
    loss_factor : tuple of float, shape (n,)
        Dimensionless; kept as the attribute `loss_factor_values`.

    Raises
    ------
    InputError
        On evaluation outside the table: it refuses to extrapolate.
    """

    type: Literal["tabulated"] = "tabulated"
    frequency_Hz: FloatTuple
    # The aliases are what users write; the bare names belong to the methods every law has.
    storage_values: FloatTuple = Field(alias="storage")
    loss_factor_values: FloatTuple = Field(alias="loss_factor")

    @model_validator(mode="after")
    def _columns_fit(self) -> Tabulated:
        check_columns(self.frequency_Hz, storage=self.storage_values, loss_factor=self.loss_factor_values)
        return self

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        frequency = omega / (2.0 * np.pi)
        check_inside(
            frequency,
            self.frequency_Hz,
            "narrow the band, measure wider, or identify a closed-form law from the table",
        )
        place, nodes = np.log(frequency), np.log(self.frequency_Hz)
        storage = np.interp(place, nodes, self.storage_values)
        return np.asarray(storage * (1.0 + 1j * np.interp(place, nodes, self.loss_factor_values)))

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return self.frequency_Hz[0], self.frequency_Hz[-1]
