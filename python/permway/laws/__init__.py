"""Viscoelastic laws: complex stiffness or modulus over frequency and temperature.

Convention exp(+i omega t), positive imaginary part dissipates, SI units, frequencies in Hz, temperatures in
degrees Celsius. A law is a frozen record with a literal `type`, so that a TOML table reads straight into
it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from permway.errors import must_be
from permway.laws.base import Law
from permway.laws.checks import LawCheck
from permway.laws.combined import Parallel, Scaled, Series, StorageLossPair
from permway.laws.elastic import Hysteretic, KelvinVoigt, Maxwell, Zener
from permway.laws.fractional import FVMP, FractionalKelvinVoigt, FractionalZener, HavriliakNegami, Springpot
from permway.laws.measured import Given, Measured
from permway.laws.pad import Pad
from permway.laws.prony import Prony
from permway.laws.shift import WLF, AnyShift, Arrhenius, Free, Shift, WLFArrhenius
from permway.laws.tabulated import Tabulated
from permway.laws.tfdv import TFDV
from permway.laws.waves import Waves
from permway.records import input_error

AnyLaw = Annotated[
    Hysteretic
    | KelvinVoigt
    | Maxwell
    | Zener
    | Springpot
    | FractionalKelvinVoigt
    | FractionalZener
    | HavriliakNegami
    | FVMP
    | Prony
    | Waves
    | Tabulated
    | Measured
    | Given
    | TFDV
    | Pad
    | Series
    | Parallel
    | Scaled
    | StorageLossPair,
    Field(discriminator="type"),
]
"""Any law, distinguished by its `type`."""

__all__ = [
    "FVMP",
    "TFDV",
    "WLF",
    "AnyLaw",
    "AnyShift",
    "Arrhenius",
    "FractionalKelvinVoigt",
    "FractionalZener",
    "Free",
    "Given",
    "HavriliakNegami",
    "Hysteretic",
    "KelvinVoigt",
    "Law",
    "LawCheck",
    "Maxwell",
    "Measured",
    "Pad",
    "Parallel",
    "Prony",
    "Scaled",
    "Series",
    "Shift",
    "Springpot",
    "StorageLossPair",
    "Tabulated",
    "WLFArrhenius",
    "Waves",
    "Zener",
    "law_from_dict",
    "law_to_dict",
]

# Laws made of laws could not name the union before it existed.
for _law in (TFDV, Pad, Series, Parallel, Scaled, StorageLossPair):
    _law.model_rebuild(_types_namespace={"AnyLaw": AnyLaw})

_ADAPTER: TypeAdapter[AnyLaw] = TypeAdapter(AnyLaw)


def law_from_dict(table: Mapping[str, Any], *, where: str = "law") -> AnyLaw:
    """Read a law from a table, as TOML gives it.

    Parameters
    ----------
    table : mapping
        Has a `type` and that law's parameters.
    where : str
        Place to name in an error.

    Returns
    -------
    Law
        One of the union `AnyLaw`.

    Raises
    ------
    InputError
        With the place in the table, the value and what would be right.
    """
    must_be(table, Mapping, where, remedy='as in {"type": "hysteretic", "stiffness": 1e8, "loss_factor": 0.2}')
    try:
        return _ADAPTER.validate_python(dict(table))
    except ValidationError as error:
        raise input_error(error, dict(table), where) from error


def law_to_dict(law: Law) -> dict[str, Any]:
    """Write a law as a table that `law_from_dict` reads back to an equal law."""
    must_be(law, Law, "law")
    return law.model_dump(mode="python", by_alias=True)
