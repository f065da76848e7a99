"""A model: a line and all that is asked of it."""

from __future__ import annotations

import re
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat, field_validator, model_validator

from permway.arrays import COLDEST_C, HOTTEST_C, Reals
from permway.errors import InputError
from permway.model.faults import below, fault
from permway.model.irregularity import AnyIrregularity, Conversion
from permway.model.line import Line
from permway.model.passby import PassBy
from permway.model.place import Place
from permway.model.roll import Roll, antisymmetric
from permway.model.train import Train
from permway.notebook import Shown
from permway.records import FrozenModel
from permway.response.receptance import Formulation, check_places, check_sweep

MOST_FREQUENCIES = 10_000_000


class Frequencies(FrozenModel):
    """Frequencies of a sweep: a list, equal steps, or equal ratios.

    Parameters
    ----------
    values_Hz : sequence of float, optional
    from_Hz, to_Hz : float, optional
    step_Hz : float, optional
        Equal steps.
    points : int, optional
        Number of frequencies at equal ratios.
    """

    values_Hz: tuple[float, ...] | None = Field(default=None, min_length=1, max_length=MOST_FREQUENCIES)
    from_Hz: PositiveFloat | None = None
    to_Hz: PositiveFloat | None = None
    step_Hz: PositiveFloat | None = None
    points: int | None = Field(default=None, ge=2, le=MOST_FREQUENCIES)

    @model_validator(mode="after")
    def _check(self) -> Frequencies:
        ranged = (self.from_Hz, self.to_Hz)
        if self.values_Hz is not None:
            if ranged != (None, None) or self.step_Hz is not None or self.points is not None:
                raise ValueError("give values_Hz, or from_Hz and to_Hz, not both")
        else:
            self._check_range()
        return self

    @field_validator("values_Hz")
    @classmethod
    def _check_values(cls, values: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if values is None:
            return None
        try:
            check_sweep(values)
        except InputError as error:
            index = re.search(r"\[(\d+)\]", error.where)
            place = (int(index[1]),) if index else ()
            raise fault(f"{error.what} (got {error.value}): {error.remedy}", *place) from error
        return values

    def _check_range(self) -> None:
        if self.from_Hz is None or self.to_Hz is None:
            raise ValueError("give values_Hz, or from_Hz and to_Hz with step_Hz or points")
        if (self.step_Hz is None) == (self.points is None):
            raise ValueError("give one of step_Hz (equal steps) and points (equal ratios)")
        if self.to_Hz < self.from_Hz:
            raise fault(f"{self.to_Hz:g} Hz lies below from_Hz = {self.from_Hz:g}", "to_Hz")
        if self.points is not None and self.to_Hz < self.from_Hz * (1.0 + 1e-12 * self.points):
            raise fault(
                f"{self.points} points do not fit between {self.from_Hz:g} and {self.to_Hz:g} Hz", "points"
            )
        if self.step_Hz is not None and (self.to_Hz - self.from_Hz) / self.step_Hz >= MOST_FREQUENCIES:
            raise fault(f"{self.step_Hz:g} Hz makes more than {MOST_FREQUENCIES} frequencies", "step_Hz")
        if self.step_Hz is not None and self.step_Hz < 1e-12 * self.to_Hz:
            raise fault(
                f"{self.step_Hz:g} Hz is below what numbers near {self.to_Hz:g} Hz can distinguish", "step_Hz"
            )

    def array(self) -> Reals:
        """The frequencies in Hz."""
        if self.values_Hz is not None:
            return check_sweep(self.values_Hz)
        assert self.from_Hz is not None
        assert self.to_Hz is not None
        if self.points is not None:
            return np.geomspace(self.from_Hz, self.to_Hz, self.points)
        assert self.step_Hz is not None
        count = int(np.floor((self.to_Hz - self.from_Hz) / self.step_Hz * (1.0 + 1e-12))) + 1
        return self.from_Hz + self.step_Hz * np.arange(count, dtype=np.float64)


class Model(FrozenModel, Shown):
    """All that a computation needs, as a model file states it.

    Parameters
    ----------
    format : 1
        Version of the file format.
    title : str
    frequencies : Frequencies
    line : Line
    temperature_C : float, optional
        Of all laws that depend on it.
    forces, sensors : sequence of Place
        Receptances are computed from every force to every sensor.
    train : Train, optional
        With an irregularity: power spectra of the train and of the line at contacts and sensors.
    irregularity : irregularity, optional
    passby : PassBy, optional
        The train's run over the line, read at the sensors; needs no irregularity.
    roll : Roll, optional
        Of a half model that stands for two rails: forces are then on one of them, and receptances are computed on
        its side and on the other. A train runs on both alike.
    conversion : "per_hertz" or "wavenumber_density_called_per_hertz"
    formulation : "chain" or "receptance"
    """

    format: Literal[1] = 1
    title: str = ""
    frequencies: Frequencies
    line: Line
    temperature_C: float | None = None
    forces: tuple[Place, ...] = ()
    sensors: tuple[Place, ...] = ()
    train: Train | None = None
    irregularity: AnyIrregularity | None = None
    passby: PassBy | None = None
    roll: Roll | None = None
    conversion: Conversion = "per_hertz"
    formulation: Formulation = "chain"

    @model_validator(mode="after")
    def _check(self) -> Model:
        if self.passby is not None and (self.train is None or not self.sensors):
            raise fault("needs a [train] and [[sensors]]", "passby")
        if (self.train is None) != (self.irregularity is None) and self.passby is None:
            raise ValueError("a train needs an irregularity, and an irregularity a train: give both or neither")
        if self.train is None and not self.forces:
            raise ValueError("nothing to compute: give [[forces]] and [[sensors]], or [train] and [irregularity]")
        if self.forces and not self.sensors:
            raise ValueError("forces without [[sensors]]: say where the response is wanted")
        if self.roll is not None and not self.forces:
            raise fault("without [[forces]] nothing rolls: a train runs on both rails alike", "roll")
        if self.temperature_C is not None and not COLDEST_C <= self.temperature_C <= HOTTEST_C:
            what = "is no temperature of a track: give degrees Celsius, not kelvin"
            raise fault(what, "temperature_C", value=self.temperature_C)
        return self

    def check(self) -> None:
        """Check what the parts say of each other: names, places, and the laws at the ends of the band.

        Raises
        ------
        InputError
            With the place in the model file.
        """
        try:
            self.line.joint_table()
            self.line.stiffness(self.frequencies.array()[[0, -1]], self.temperature_C)
        except InputError as error:
            raise below("line", error) from error
        for kind, places in (("forces", self.forces), ("sensors", self.sensors)):
            check_places(self.line, places, kind)
        if self.roll is not None:
            try:
                antisymmetric(self.line, self.roll)
            except InputError as error:
                raise below("roll", error) from error
        if self.train is not None:
            try:
                check_places(self.line, self.train.wheels(), "wheels")
            except InputError as error:
                raise below("train", error) from error
