"""Names and units of the columns of a DMA table.

A header is read as words: case, spaces, brackets and dashes do not matter, primes are spelt out, and a unit
may follow the name: `G_storage_pa`, `E' (MPa)`, `Storage modulus [MPa]`, `Frequency, Hz`, `tan_delta`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from permway.arrays import ABSOLUTE_ZERO_C
from permway.errors import InputError

MODULUS_UNITS = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9, "n_mm2": 1e6, "n_m2": 1.0}

_NAMES = {
    "frequency": ("frequency", "freq", "f"),
    "omega": ("omega", "angular_frequency", "circular_frequency"),
    "temperature": ("temperature", "temp", "t"),
    "storage": ("storage_modulus", "storage", "modulus_storage"),
    "loss": ("loss_modulus", "loss", "modulus_loss"),
    "loss_factor": ("loss_factor", "tan_delta", "tandelta", "tan_d", "tand", "eta"),
    "strain": ("strain_dyn", "dynamic_strain", "strain_amplitude", "strain"),
}
_SHEAR_OR_TENSION = {
    "storage": ("{}_storage_modulus", "{}_storage", "storage_{}", "{}_prime"),
    "loss": ("{}_loss_modulus", "{}_loss", "loss_{}", "{}_double_prime"),
}
_UNITS: dict[str, dict[str, float]] = {
    "frequency": {"hz": 1.0, "khz": 1e3, "": 1.0},
    "omega": {"rad_s": 0.5 / math.pi, "": 0.5 / math.pi},
    "temperature": {"c": 0.0, "degc": 0.0, "deg_c": 0.0, "celsius": 0.0, "k": ABSOLUTE_ZERO_C, "": 0.0},
    "storage": MODULUS_UNITS,
    "loss": MODULUS_UNITS,
    "loss_factor": {"": 1.0, "1": 1.0},
    "strain": {"pct": 0.01, "percent": 0.01, "1": 1.0, "": 1.0},
}


@dataclass(frozen=True)
class Column:
    """A recognised column: quantity, place, header, and how to bring it to SI (or degrees Celsius)."""

    quantity: str
    index: int
    header: str
    unit: str
    kind: str
    factor: float

    def to_si(self, value: float) -> float:
        """Bring a cell's value to SI; temperatures to degrees Celsius."""
        return value + self.factor if self.quantity == "temperature" else value * self.factor


def recognise(headers: tuple[str, ...], *, where: str) -> dict[str, Column]:
    """Find the known quantities among the headers; columns of other names are left aside.

    Parameters
    ----------
    headers : tuple of str
        As in the file.
    where : str
        File and line, for errors.

    Returns
    -------
    dict
        From "frequency", "temperature", "storage", "loss", "loss_factor", "strain" to `Column`.

    Raises
    ------
    InputError
        For two columns of one quantity, a modulus without a unit, storage and loss in different units or of
        different kinds.
    """
    found: dict[str, Column] = {}
    for index, header in enumerate(headers):
        column = _match(index, header, where)
        if column is None:
            continue
        earlier = found.get(column.quantity)
        if earlier is not None:
            raise InputError(
                f"two columns for {column.quantity}: '{earlier.header}' and '{header}'",
                where=where,
                remedy="keep one of them",
            )
        found[column.quantity] = column
    storage, loss = found.get("storage"), found.get("loss")
    if storage is not None and loss is not None:
        if storage.unit != loss.unit:
            raise InputError(
                f"mixed units: '{storage.header}' and '{loss.header}'",
                where=where,
                remedy="give both in one unit",
            )
        if storage.kind and loss.kind and storage.kind != loss.kind:
            raise InputError(
                f"storage of one modulus, loss of another: '{storage.header}' and '{loss.header}'",
                where=where,
                remedy="give both in shear (G) or both in tension or compression (E)",
            )
    return found


def _match(index: int, header: str, where: str) -> Column | None:
    words = _words(header)
    candidates = [(quantity, name, "") for quantity, names in _NAMES.items() for name in names]
    candidates += [
        (quantity, pattern.format(kind), kind)
        for quantity, patterns in _SHEAR_OR_TENSION.items()
        for pattern in patterns
        for kind in ("g", "e")
    ]
    # Longest name first, so that loss_factor is not taken for a loss in the unit "factor".
    for quantity, name, kind in sorted(candidates, key=lambda entry: -len(entry[1])):
        if words != name and not words.startswith(name + "_"):
            continue
        unit = words[len(name) + 1 :]
        factor = _UNITS[quantity].get(unit)
        if factor is not None:
            target = "frequency" if quantity == "omega" else quantity
            return Column(target, index, header, unit, kind, factor)
        if not unit:
            raise InputError(
                "a modulus without a unit",
                where=f"{where}, column '{header}'",
                remedy="name it as in G_storage_MPa",
            )
        if _looks_like_unit(unit):
            raise InputError(
                f"unit '{unit}' is not known for {quantity}",
                where=f"{where}, column '{header}'",
                remedy="use one of " + ", ".join(sorted(filter(None, _UNITS[quantity]))),
            )
        return None
    return None


def _words(header: str) -> str:
    text = header.replace("%", " pct ").replace("°", "deg").replace("²", "2").lower()
    text = re.sub(r"(''|\"|″|’’)", " double prime ", text)
    text = re.sub(r"('|′|’)", " prime ", text)
    return "_".join(re.findall(r"[a-z0-9]+", text))


def _looks_like_unit(words: str) -> bool:
    # "loss_angle" or "temperature_set_point" are other quantities; "storage_psi" and "freq_rpm" are units.
    return words in {
        "psi",
        "ksi",
        "bar",
        "kgf_cm2",
        "rpm",
        "f",
        "degf",
        "fahrenheit",
        "n_cm2",
        "deg",
        "rad",
        "mhz",
    }
