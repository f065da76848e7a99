"""What every law is: a complex dynamic stiffness or modulus over frequency, and its checks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Strict, ValidationError

from permway.errors import InputError

if TYPE_CHECKING:
    from permway.laws.checks import LawCheck

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]

ABSOLUTE_ZERO_C = -273.15


def _as_python(value: object) -> object:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


Number = Annotated[float, Strict(), BeforeValidator(_as_python)]
"""A float that takes integers and numpy's numbers, but neither text nor a truth value."""

FloatTuple = Annotated[tuple[Number, ...], BeforeValidator(_as_python)]
"""A tuple of such numbers that also takes a numpy array."""


class FrozenModel(BaseModel):
    """A frozen record whose faults are reported as :class:`permway.errors.InputError`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise input_error(error, place=_type_name(type(self))) from error

    # Pydantic then builds nested records itself, so that a fault inside one keeps its full path.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]


def input_error(error: ValidationError, *, place: str) -> InputError:
    """Turn pydantic's first complaint into an `InputError` with its place and value."""
    first = error.errors(include_url=False)[0]
    tags = _tags(FrozenModel)
    # The tag of a discriminated union is part of pydantic's path but not of the user's table.
    where = ".".join([place, *(str(part) for part in first["loc"] if part not in tags)])
    others = error.error_count() - 1
    remedy = f"{others} further fault(s) in the same table" if others else ""
    what = first["msg"].removeprefix("Value error, ")
    value = None if first["type"] in ("missing", "value_error", "union_tag_invalid") else first["input"]
    return InputError(what[:1].lower() + what[1:], where=where, value=value, remedy=remedy)


def _tags(model: type[BaseModel]) -> set[str]:
    below = set().union(*(_tags(child) for child in model.__subclasses__())) if model.__subclasses__() else set()
    return below | {_type_name(model)}


def _type_name(model: type[BaseModel]) -> str:
    field = model.model_fields.get("type")
    return str(field.default) if field is not None else model.__name__


class Law(FrozenModel, ABC):
    """A linear viscoelastic law k(omega, T) under exp(+i omega t).

    The value is a stiffness (N/m) or a modulus (Pa), whichever its parameters are given in. A positive
    imaginary part is dissipation.
    """

    @property
    def needs_temperature(self) -> bool:
        """Whether the law cannot be evaluated without a temperature."""
        return False

    def complex(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Complexes:
        """Complex dynamic stiffness (N/m) or modulus (Pa).

        Parameters
        ----------
        frequency_Hz : array_like, any shape
            Frequencies in Hz, finite and above zero.
        temperature_C : array_like, optional
            Temperature in degrees Celsius: a number, or an array that broadcasts against the frequencies.
            Ignored by a law that does not depend on it.

        Returns
        -------
        ndarray of complex128
            Shape of `frequency_Hz` (broadcast with `temperature_C` if that is an array).

        Raises
        ------
        InputError
            For a frequency that is not finite and positive, and a temperature that is needed and missing.
        """
        frequency = check_frequency(frequency_Hz)
        temperature = check_temperature(temperature_C)
        if temperature is None and self.needs_temperature:
            raise InputError(
                f"the law '{_type_name(type(self))}' depends on temperature and none was given",
                where="temperature_C",
                remedy="give a temperature in degrees Celsius",
            )
        if temperature is None or not self.needs_temperature:
            value = self._at(2.0 * np.pi * frequency, None)
        else:
            frequency, temperature = np.broadcast_arrays(frequency, temperature)
            value = self._at(2.0 * np.pi * frequency, temperature)
        return np.asarray(value, dtype=np.complex128)

    def storage(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Real part of :meth:`complex`: what is stored. N/m or Pa."""
        return np.asarray(self.complex(frequency_Hz, temperature_C).real)

    def loss(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Imaginary part of :meth:`complex`: what is dissipated. N/m or Pa."""
        return np.asarray(self.complex(frequency_Hz, temperature_C).imag)

    def loss_factor(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Loss over storage, tan delta (paper, equation (26)). Dimensionless."""
        value = self.complex(frequency_Hz, temperature_C)
        return np.asarray(value.imag / value.real)

    def check(self, band_Hz: tuple[float, float], temperature_C: float | None = None) -> LawCheck:
        """Say whether the law is passive and causal over a band.

        Parameters
        ----------
        band_Hz : (float, float)
            Lowest and highest frequency in Hz.
        temperature_C : float, optional
            Needed by a law that depends on temperature.

        Returns
        -------
        LawCheck
            See :class:`permway.laws.checks.LawCheck`.
        """
        from permway.laws.checks import check_law

        return check_law(self, band_Hz, temperature_C)

    @abstractmethod
    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        """Value at circular frequencies (rad/s), inputs already checked."""

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        """Causality read off the closed form: (known answer or None, why)."""
        return None, ""

    def _static(self) -> float | None:
        """Stiffness at rest if the closed form has one; it must not be negative in a passive law."""
        return None

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        """Frequencies at which the law can be evaluated."""
        del temperature_C
        return 0.0, np.inf

    def _caveats(self) -> tuple[str, ...]:
        """What a user of the law must know beside passivity and causality."""
        return ()


def check_frequency(frequency_Hz: ArrayLike) -> Reals:
    """Frequencies as float64, refused with index and value unless finite and positive."""
    frequency = _as_floats(frequency_Hz, "frequency_Hz")
    bad = ~(np.isfinite(frequency) & (frequency > 0.0))
    if bad.any():
        where, value = _first(frequency, bad)
        raise InputError(
            "a frequency must be finite and above 0 Hz",
            where=f"frequency_Hz{where}",
            value=value,
            remedy="leave the static case out; laws are dynamic stiffnesses",
        )
    return frequency


def check_temperature(temperature_C: ArrayLike | None) -> Reals | None:
    """Temperatures as float64, refused unless finite and above absolute zero."""
    if temperature_C is None:
        return None
    temperature = _as_floats(temperature_C, "temperature_C")
    bad = ~(np.isfinite(temperature) & (temperature > ABSOLUTE_ZERO_C))
    if bad.any():
        where, value = _first(temperature, bad)
        raise InputError(
            "a temperature must be finite and above -273.15 degC",
            where=f"temperature_C{where}",
            value=value,
            remedy="give degrees Celsius",
        )
    return temperature


def _as_floats(values: ArrayLike, name: str) -> Reals:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("not a number or an array of numbers", where=name, value=values) from error


def _first(values: Reals, bad: NDArray[np.bool_]) -> tuple[str, float]:
    index = tuple(int(axis[0]) for axis in np.nonzero(bad)) if values.ndim else ()
    where = "[" + ", ".join(map(str, index)) + "]" if index else ""
    return where, float(values[index])
