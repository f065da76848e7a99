"""Parameters of a campaign: numbers of its model, and how surely they are known."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, PositiveFloat, model_validator

from permway.errors import InputError
from permway.model.faults import fault
from permway.records import FrozenModel, Number

SPREAD_UNKNOWN = 2.0
"""Standard deviation, in natural logarithm, of a scaled parameter without a tolerance."""


def _several(value: object) -> object:
    return (value,) if isinstance(value, str) else value


class Parameter(FrozenModel):
    """A number that is not known exactly.

    Parameters
    ----------
    name : str
        As "pad.k".
    unit : str
        Of its values.
    paths : str or sequence of str
        Numbers of the model file that it sets; into the campaign file itself if they begin with "campaign.".
    acts : "scales", "sets" or "adds"
        With the value v and the nominal n: every number is multiplied by v/n, or becomes v, or grows by v - n.
    nominal : float, optional
        What the user believes; by default the number at the first path, and 0 for "adds".
    tolerance_2sigma : float, optional
        Two standard deviations: relative to the nominal, or with `absolute` in `unit`.
    absolute : bool
        Whether the tolerance is in `unit`.
    prior : "log_normal" or "normal", optional
        By default log-normal for a relative tolerance below 1 of a positive nominal, else normal.
    bounds : (low, high), optional
        In `unit`; values outside are refused.
    """

    name: str = Field(min_length=1)
    unit: str = "1"
    paths: Annotated[tuple[str, ...], BeforeValidator(_several), Field(min_length=1)]
    acts: Literal["scales", "sets", "adds"] = "scales"
    nominal: Number | None = None
    tolerance_2sigma: PositiveFloat | None = None
    absolute: bool = False
    prior: Literal["log_normal", "normal"] | None = None
    bounds: tuple[Number, Number] | None = None

    @model_validator(mode="after")
    def _check(self) -> Parameter:
        if self.bounds is not None and not self.bounds[0] < self.bounds[1]:
            raise fault("the lower bound does not lie below the upper", "bounds", value=self.bounds)
        if self.absolute and self.tolerance_2sigma is None:
            raise fault("absolute goes with tolerance_2sigma", "absolute")
        if self.absolute and self.prior == "log_normal":
            raise fault("an absolute tolerance goes with a normal prior", "prior")
        relative = self.tolerance_2sigma if not self.absolute else None
        if self.prior == "log_normal" and relative is not None and relative >= 1.0:
            what = f"a relative tolerance of {relative:g} reaches below zero: a log-normal prior needs less than 1"
            raise fault(what, "tolerance_2sigma")
        return self


@dataclass(frozen=True)
class Known:
    """A parameter with its nominal value and prior.

    Attributes
    ----------
    parameter : Parameter
    nominal : float
        In the parameter's unit.
    log : bool
        Whether the prior is normal in the logarithm.
    sigma : float
        Standard deviation: of the logarithm, or in the parameter's unit.
    """

    parameter: Parameter
    nominal: float
    log: bool
    sigma: float

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.parameter.name

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value, in the parameter's unit."""
        if self.parameter.bounds is not None:
            return self.parameter.bounds
        return (0.0, math.inf) if self.log else (-math.inf, math.inf)

    def value(self, z: float) -> float:
        """The value that lies `z` standard deviations of the prior from the nominal."""
        return self.nominal * math.exp(self.sigma * z) if self.log else self.nominal + self.sigma * z

    def z(self, value: float) -> float:
        """Standard deviations of the prior between the nominal and a value.

        Raises
        ------
        InputError
            For a value that a log-normal prior excludes.
        """
        if not self.log:
            return (value - self.nominal) / self.sigma
        if not value > 0.0:
            raise InputError("must be above zero", where=self.name, value=value)
        return math.log(value / self.nominal) / self.sigma


def known_of(parameter: Parameter, base: float, where: str) -> Known:
    """A parameter with its nominal and prior.

    Parameters
    ----------
    parameter : Parameter
    base : float
        The number at its first path.
    where : str
        The parameter's place in the campaign file, for errors.

    Raises
    ------
    InputError
        For a nominal, a prior and bounds that do not go together.
    """
    nominal = parameter.nominal
    if nominal is None:
        nominal = 0.0 if parameter.acts == "adds" else base
    if parameter.acts == "sets" and nominal != base:
        what = f"the file has {base:g} there, and a number that is set cannot be believed to be another"
        raise InputError(what, where=f"{where}.nominal", value=nominal, remedy="leave nominal out")
    if parameter.acts == "scales" and nominal == 0.0:
        remedy = 'say acts = "adds" or "sets"'
        raise InputError("a nominal of 0 cannot be scaled", where=f"{where}.acts", remedy=remedy)
    if parameter.bounds is not None and not parameter.bounds[0] <= nominal <= parameter.bounds[1]:
        raise InputError("do not hold the nominal", where=f"{where}.bounds", value=[*parameter.bounds, nominal])
    tolerance = parameter.tolerance_2sigma
    fits_log = nominal > 0.0 and not parameter.absolute and (tolerance is None or tolerance < 1.0)
    log = parameter.prior == "log_normal" or (parameter.prior is None and fits_log)
    if log and not nominal > 0.0:
        raise InputError("a log-normal prior needs a nominal above 0", where=f"{where}.prior", value=nominal)
    if log:
        # As wide, in the logarithm, as the interval from 1 - tolerance to 1 + tolerance.
        return Known(parameter, nominal, True, 0.5 * math.atanh(tolerance) if tolerance else SPREAD_UNKNOWN)
    if tolerance is None:
        what = "a normal prior needs tolerance_2sigma"
        raise InputError(what, where=f"{where}.tolerance_2sigma", remedy="say how well the number is known")
    scale = 1.0 if parameter.absolute else abs(nominal)
    if scale == 0.0:
        what = "is relative to a nominal of 0"
        raise InputError(what, where=f"{where}.tolerance_2sigma", remedy="say absolute = true")
    return Known(parameter, nominal, False, 0.5 * tolerance * scale)
