"""A remark that states the sampling rate: understood whole, or not at all."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from permway.errors import InputError

_RATE = re.compile(
    r"\b(?:fs|sr|f_s|samplerate|sampling[ _-]?(?:rate|frequency|hz)|sample[ _-]?(?:rate|frequency|hz))\b\s*"
    r"(?P<bracket>[(\[]\s*[^)\]]*[)\]])?\s*[:=,;\t]\s*(?P<value>.*)",
    re.IGNORECASE,
)
_VALUE = re.compile(r"(?P<number>[-+]?\d+(?:[.,]\d+)*(?:[eE][-+]?\d+)?|\.\d+)\s*(?P<unit>[A-Za-z/]*)\s*[,;]*\s*")
_UNITS = {
    "": 1.0, "hz": 1.0, "khz": 1e3, "s/s": 1.0, "ks/s": 1e3, "sa/s": 1.0, "ksa/s": 1e3, "samples/s": 1.0,
    "sps": 1.0, "ksps": 1e3, "samples/sec": 1.0, "/s": 1.0,
}  # fmt: skip
# By their capitals alone these differ a billionfold.
_EXACT = {"MHz": 1e6, "MS/s": 1e6, "mHz": 1e-3}


@dataclass(frozen=True)
class RateRemark:
    """What remarks say of the rate.

    Attributes
    ----------
    value_Hz : float or None
    fault : InputError or None
        If one states the rate and is not understood: to be raised where nothing else states it.
    doubt : InputError or None
        The same if the table has decimal commas.
    """

    value_Hz: float | None = None
    fault: InputError | None = field(default=None, compare=False)
    doubt: InputError | None = field(default=None, compare=False)

    def in_decimal_commas(self) -> RateRemark:
        """The same in a table with decimal commas, where a point may part thousands."""
        return self if self.doubt is None else RateRemark(fault=self.doubt)

    def and_then(self, other: RateRemark) -> RateRemark:
        """The first that states something."""
        return other if self.value_Hz is None and self.fault is None else self


def rate_in(remark: str, where: str) -> RateRemark:
    """The sampling rate that a remark states.

    A comma may part decimals or thousands: "51,2" is read, "51,200" is not.
    """
    stated = _RATE.search(remark)
    if stated is None:
        return RateRemark()
    text = stated["value"].strip()
    fault = InputError(
        "a remark states the sampling rate and is not understood",
        where=where,
        value=remark[:80],
        remedy="write it as in 'fs = 51200 Hz', or state it in the record: sampling_Hz = 51200.0",
    )
    found = _VALUE.fullmatch(text)
    if found is None:
        return RateRemark(fault=fault)
    unit = found["unit"] or (stated["bracket"] or "").strip("()[] ")
    factor = _EXACT.get(unit) or (None if unit.lower() in ("mhz", "ms/s") else _UNITS.get(unit.lower()))
    number = found["number"]
    commas, points = number.count(","), number.count(".")
    if factor is None or commas > 1 or points > 1 or (commas and points) or re.search(r",\d{3}(?!\d)", number):
        return RateRemark(fault=fault)
    value = float(number.replace(",", ".")) * factor
    if not 0.0 < value < float("inf"):
        what = "a sampling rate must be finite and above 0 Hz"
        return RateRemark(fault=InputError(what, where=where, value=text, remedy="correct or remove the remark"))
    return RateRemark(value, doubt=fault if re.search(r"\.\d{3}(?!\d)", number) else None)
