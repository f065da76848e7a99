"""Names of the columns of a DMA table.

A header is read as words: spaces, brackets and dashes do not matter, primes and Greek letters are spelt out, and a
unit may follow the name: `G_storage_pa`, `E' (MPa)`, `Storage modulus [MPa]`, `Frequency, Hz`, `f/Hz`.
What is only nearly a name is none: the columns that were not understood are named where one is missing.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, field

from permway.errors import InputError
from permway.laws.column_units import bare, column_unit, known_units, looks_like_unit, words

_NAMES = {
    "frequency": ("frequency", "freq", "f", "frequenz", "frequence", "test_frequency", "pruffrequenz"),
    "omega": ("omega", "angular_frequency", "circular_frequency", "ang_frequency", "kreisfrequenz", "w"),
    "temperature": ("temperature", "temp", "t", "temperatur", "pruftemperatur"),
    "storage": ("storage_modulus", "storage", "modulus_storage", "speichermodul", "module_de_conservation"),
    "loss": ("loss_modulus", "loss", "modulus_loss", "verlustmodul", "module_de_perte"),
    "loss_factor": (
        *("loss_factor", "loss_tangent", "tan_delta", "tandelta", "tan_d", "tand", "tg_delta", "tgdelta", "eta"),
        *("dissipation_factor", "verlustfaktor", "facteur_de_perte"),
    ),
    "magnitude": (
        *("complex_modulus", "dynamic_modulus", "absolute_modulus", "modulus_magnitude", "dyn_modulus"),
        *("complex_stiffness", "dynamic_stiffness", "absolute_stiffness", "stiffness_magnitude", "dyn_stiffness"),
    ),
    "phase": ("phase_angle", "phase", "loss_angle", "delta", "phase_shift", "phase_lag", "phasenwinkel"),
    "strain": ("strain_dyn", "dynamic_strain", "strain_amplitude", "strain"),
}
_BY_KIND = {
    "storage": (
        "{}_storage_modulus",
        "{}_storage",
        "{}_stor",
        "storage_{}",
        "{}_prime",
        "{}_real",
        "{}_re",
        "re_{}",
    ),
    "loss": (
        *("{}_loss_modulus", "{}_loss", "loss_{}", "{}_double_prime", "{}_prime_prime", "{}_imag", "{}_im"),
        *("{}_imaginary", "im_{}"),
    ),
    "magnitude": ("{}_abs", "abs_{}", "{}_star", "{}_mag", "{}_magnitude", "{}_complex"),
}
_STIFFNESS_NAMES = {
    "storage": ("storage_stiffness", "stiffness_storage", "speichersteifigkeit"),
    "loss": ("loss_stiffness", "stiffness_loss", "verluststeifigkeit"),
}
_BESIDE = {"sample", "specimen", "actual", "measured", "probe"}
"""Words that say of which part or kind a reading is, and not what is read."""
_ALONE_OTHER = {
    "F": ("frequency", "may be a force"),
    "t": ("temperature", "may be a time"),
    "w": ("omega", "may be a width"),
    "W": ("omega", "may be a width"),
}
"""Letters alone that stand for their quantity only with its unit beside them."""
_UNIT_REQUIRED = {"frequency", "omega", "temperature"}
_NO_NAME = re.compile(r"[?!@$&=\\^~+%°\ufffd]|[\[({<]\W*[\])}>]")
_PRIMES = "'′’´″\"`‘”“"
_GREEK = (
    ("δ", " delta "),
    ("∂", " delta "),
    ("ẟ", " delta "),
    ("Δ", " delta "),
    ("ω", " omega "),
    ("η", " eta "),
    ("ε", " strain "),
    ("∗", "*"),
)


@dataclass(frozen=True)
class Column:
    """A recognised column: quantity, place, header, and how to bring it to SI (or degrees Celsius).

    Attributes
    ----------
    quantity, header : str
    index : int
    unit : str
        As found, empty if there is none.
    kind : str
        Letter of the modulus: g (shear), e (tension or compression) or k (a part's), or empty.
    elastic : str
        "modulus" or "stiffness" of storage, loss and magnitude, else empty.
    factor, offset : float
    """

    quantity: str
    index: int
    header: str
    unit: str
    kind: str
    elastic: str
    factor: float
    offset: float

    def to_si(self, value: float) -> float:
        """Bring a cell's value to SI; temperatures to degrees Celsius."""
        return value * self.factor + self.offset


@dataclass(frozen=True)
class Recognised:
    """Columns of a table by quantity, what is wrong with others, and the headers that no name fits."""

    columns: dict[str, Column] = field(default_factory=dict)
    faults: dict[str, str] = field(default_factory=dict)
    unread: tuple[str, ...] = ()


def recognise(headers: tuple[str, ...], units: tuple[str, ...] | None = None, *, where: str) -> Recognised:
    """Find the known quantities among the headers; columns of other names are left aside.

    Parameters
    ----------
    headers : tuple of str
        As in the file.
    units : tuple of str, optional
        A row of units under the header, for columns that have none in it.
    where : str
        File and line, for errors.

    Returns
    -------
    Recognised
        Quantities: "frequency", "temperature", "storage", "loss", "loss_factor", "magnitude", "phase", "strain".

    Raises
    ------
    InputError
        For two columns of one quantity, moduli in different units or of different kinds, a unit in the header that
        the row of units contradicts.
    """
    found: dict[str, Column] = {}
    faults: dict[str, str] = {}
    unread = []
    for index, header in enumerate(headers):
        beneath = bare(units[index]) if units is not None and index < len(units) else ""
        column = _match(index, header, beneath, where)
        if isinstance(column, Column):
            earlier = found.get(column.quantity)
            if earlier is not None:
                what = f"two columns for {column.quantity}: '{earlier.header}' and '{header}'"
                raise InputError(what, where=where, remedy="keep one of them")
            found[column.quantity] = column
        elif header.strip():
            unread.append(header)
            if column is not None:
                faults.setdefault(*column)
    _check_alike([found[name] for name in ("storage", "loss", "magnitude") if name in found], where)
    return Recognised(found, faults, tuple(unread))


def _check_alike(elastic: list[Column], where: str) -> None:
    for other in elastic[1:]:
        one = elastic[0]
        if (one.factor, one.elastic) != (other.factor, other.elastic):
            raise InputError(
                f"mixed units: '{one.header}' and '{other.header}'", where=where, remedy="give both in one unit"
            )
        if one.kind and other.kind and one.kind != other.kind:
            raise InputError(
                f"storage of one modulus, loss of another: '{one.header}' and '{other.header}'",
                where=where,
                remedy="give both in shear (G) or both in tension or compression (E)",
            )


def _match(index: int, header: str, beneath: str, where: str) -> Column | tuple[str, str] | None:
    """The column; or the quantity it is nearly of, and what is wrong with it; or nothing."""
    nearly: tuple[str, str] | None = None
    for name, rest in _splits(header):
        for quantity, kind in _quantities(name):
            inner = bare(rest)
            if _UNIT_REQUIRED & {quantity} and _says_none(rest) and not beneath:
                return target_of(
                    quantity
                ), f"'{header}' states that it has no unit: write it, as in freq_Hz, temp_C"
            target = target_of(quantity)
            unit = column_unit(quantity, inner)
            if unit is None and inner:
                if looks_like_unit(inner) or rest.strip()[:1] in ("[", "("):
                    what = f"'{header}': unit '{inner}' is not known for {quantity}, use one of "
                    nearly = nearly or (target, what + known_units(quantity))
                continue
            if beneath:
                below = column_unit(quantity, beneath)
                if below is None:
                    what = f"'{header}': unit '{beneath}' is not known for {quantity}, use one of "
                    return target, what + known_units(quantity)
                if inner and unit != below:
                    raise InputError(
                        f"'{header}' states {inner!r}, the row of units under it {beneath!r}",
                        where=where,
                        remedy="correct whichever is wrong",
                    )
                unit, inner = below, beneath
            if not inner and name.strip() in _ALONE_OTHER:
                return target, f"'{header}' {_ALONE_OTHER[name.strip()][1]}: write its unit, as in freq_Hz, temp_C"
            if unit is None:
                what = (
                    "an angle without a unit, write deg or rad"
                    if quantity == "phase"
                    else "a modulus without a unit"
                )
                if quantity == "strain":
                    what = "without a unit, write % or 1"
                hint = ", name it as in G_storage_MPa" if what.startswith("a modulus") else ""
                return target, f"'{header}': {what}{hint}"
            return Column(target, index, header, inner, kind, unit.kind, unit.factor, unit.offset)
    return nearly


def target_of(quantity: str) -> str:
    """The quantity that a column is kept as: a circular frequency is a frequency."""
    return "frequency" if quantity == "omega" else quantity


def _says_none(rest: str) -> bool:
    """Whether a header states that there is no unit, as "f [-]" does."""
    return bool(rest.strip()) and not re.search(r"[\w°%℃℉]", rest)


def _splits(header: str) -> Iterator[tuple[str, str]]:
    """Every way to part a header into name and unit, longest name first."""
    text = " ".join(header.split())
    if len(text) > 2 and text[0] == text[-1] == '"':
        text = text[1:-1]
    yield text, ""
    for at in range(len(text) - 1, 0, -1):
        # Half of a double prime is no name: E'' [x] is not E' in the unit "' [x]".
        if text[at] in _PRIMES:
            continue
        boundary = text[at] in " _,/[(<{:;-." or text[at - 1] in _PRIMES + "*"
        if boundary or (text[at - 1].islower() and text[at].isupper()):
            yield text[:at], text[at:]


def _quantities(name: str) -> list[tuple[str, str]]:
    """What a name stands for: quantity and letter of the modulus."""
    # Spelling drops all marks; what is in brackets or odd belongs to no name.
    if _NO_NAME.search(name):
        return []
    spelt = [word for word in _name_words(name).split("_") if word not in _BESIDE]
    whole = _LOOKUP.get("_".join(spelt))
    if whole is not None:
        return [whole]
    # "Storage modulus E'", "Loss factor tan(delta)": two names of one thing.
    for cut in range(1, len(spelt)):
        first, second = _LOOKUP.get("_".join(spelt[:cut])), _LOOKUP.get("_".join(spelt[cut:]))
        if first is not None and second is not None and first[0] == second[0]:
            return [(first[0], first[1] or second[1])]
    return []


def _name_words(name: str) -> str:
    text = unicodedata.normalize("NFKC", name) if "´" not in name else name
    for letter, spelt in _GREEK:
        text = text.replace(letter, spelt)
    text = re.sub(r"\|\s*([EGKegk])\s*\*?\s*\|", r" \1 star ", text).replace("*", " star ")
    text = re.sub(r"(''|\"|″|’’|´´|``|′′|”|“)", " double prime ", text)
    text = re.sub(r"('|′|’|´|`|‘)", " prime ", text)
    text = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    return words(text)


def _lookup() -> dict[str, tuple[str, str]]:
    table = {name: (quantity, "") for quantity, names in _NAMES.items() for name in names}
    table |= {name: (quantity, "k") for quantity, names in _STIFFNESS_NAMES.items() for name in names}
    table |= {
        pattern.format(kind): (quantity, kind)
        for quantity, patterns in _BY_KIND.items()
        for pattern in patterns
        for kind in ("g", "e", "k")
    }
    return table


_LOOKUP = _lookup()
