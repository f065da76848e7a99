"""The symbols that units are written with, and what is near a text that is none."""

from __future__ import annotations

import difflib
import math

from permway.errors import InputError

Dimension = tuple[int, ...]
"""Powers of metre, kilogram, second, kelvin, ampere, radian and decibel."""


STANDARD_GRAVITY = 9.80665
"""m/s2, exact by definition (ISO 80000-3)."""


NONE = (0, 0, 0, 0, 0, 0, 0)


DECIBEL = (0, 0, 0, 0, 0, 0, 1)


PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}


# Symbol: factor to SI, dimension, prefixes it is met with.
SYMBOLS: dict[str, tuple[float, Dimension, str]] = {
    "m": (1.0, (1, 0, 0, 0, 0, 0, 0), "numck"),
    "in": (0.0254, (1, 0, 0, 0, 0, 0, 0), ""),
    "ft": (0.3048, (1, 0, 0, 0, 0, 0, 0), ""),
    "s": (1.0, (0, 0, 1, 0, 0, 0, 0), "num"),
    "sec": (1.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "min": (60.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "h": (3600.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "kg": (1.0, (0, 1, 0, 0, 0, 0, 0), ""),
    "g": (STANDARD_GRAVITY, (1, 0, -2, 0, 0, 0, 0), "um"),
    "gn": (STANDARD_GRAVITY, (1, 0, -2, 0, 0, 0, 0), ""),
    "gal": (1e-2, (1, 0, -2, 0, 0, 0, 0), "m"),
    "N": (1.0, (1, 1, -2, 0, 0, 0, 0), "mkM"),
    "lbf": (4.4482216152605, (1, 1, -2, 0, 0, 0, 0), ""),
    "Pa": (1.0, (-1, 1, -2, 0, 0, 0, 0), "umkMG"),
    "bar": (1e5, (-1, 1, -2, 0, 0, 0, 0), "m"),
    "Hz": (1.0, (0, 0, -1, 0, 0, 0, 0), "mkM"),
    "rad": (1.0, (0, 0, 0, 0, 0, 1, 0), "um"),
    "deg": (math.pi / 180.0, (0, 0, 0, 0, 0, 1, 0), ""),
    "rpm": (math.pi / 30.0, (0, 0, -1, 0, 0, 1, 0), ""),
    "K": (1.0, (0, 0, 0, 1, 0, 0, 0), "m"),
    "A": (1.0, (0, 0, 0, 0, 1, 0, 0), "um"),
    "V": (1.0, (2, 1, -3, 0, -1, 0, 0), "numk"),
    "pC": (1e-12, (0, 0, 1, 0, 1, 0, 0), ""),
    "dB": (1.0, DECIBEL, ""),
    "%": (1e-2, NONE, ""),
    "strain": (1.0, NONE, "um"),
    "eps": (1.0, NONE, "um"),
}


_USUAL = (
    *(
        "m/s^2",
        "m/s2",
        "m/s²",
        "mm/s^2",
        "g",
        "mg",
        "m/s",
        "mm/s",
        "km/h",
        "m",
        "mm",
        "um",
        "N",
        "kN",
        "N/m",
        "kN/mm",
    ),
    *("(m/s^2)/N", "g/N", "(m/s)/N", "m/N", "Pa", "kPa", "MPa", "GPa", "Hz", "kHz", "rad/s", "rpm", "degC", "K"),
    *("%", "strain", "ustrain", "um/m", "dB/m", "V", "mV", "s", "ms", "(m/s^2)^2/Hz", "g^2/Hz"),
)


def unknown(text: str, where: str, what: str = "the unit is not known") -> InputError:
    """The error of a text that is no unit, with what it is near to."""
    near = difflib.get_close_matches(text.strip(), _USUAL, n=3, cutoff=0.5)
    remedy = (
        "did you mean " + " or ".join(near) + "?"
        if near
        else "write it as in m/s^2, g, mm/s, um, kN, (m/s^2)/N, MPa"
    )
    return InputError(what, where=where, value=text, remedy=remedy)
