"""Effects, parameters and sizes as an engineer says them: words, units that fit, digits that are known."""

from __future__ import annotations

import math
import re
from collections import Counter

from permway.diagnosis.verdict_parts import RECALIBRATED, Estimate, Moved, Smallest

NAMES = {
    "ballast_frequency": "ballast stiffer with frequency",
    "beam_damping": "damping law of a beam",
    "contact_filter": "averaging over the contact patch",
    "contact_nonlinear": "contact stiffness at work",
    "damper_series_stiffness": "springs in series with dampers",
    "fastener_loss": "lost fasteners",
    "girder_crack": "crack of the girder",
    "girder_shear": "shear of the girder",
    "irregularity_level": "level of the irregularity",
    "layer_damping": "damping law of a layer",
    "level_friction": "friction that changes with level",
    "level_stiffness": "stiffness that changes with level",
    "mains_lines": "lines of the mains",
    "mortar_void": "void below the slab",
    "noise_floor": "noise of a channel",
    "novel": "something the catalogue does not hold",
    "owner_value": "wrong stated value",
    "pad_amplitude": "pads softer with amplitude",
    "pad_frequency": "pads stiffer with frequency",
    "pad_preload": "pads that change under load",
    "pad_temperature": "pads that change with temperature",
    "parametric_support": "rolling over the supports",
    "recalibrated": "nothing missing",
    "sensor_delay": "delay of a sensor",
    "sensor_gain": "gain of a sensor",
    "sensor_labels": "swapped labels",
    "sensor_mounting": "mounting of a sensor",
    "sensor_polarity": "polarity of a sensor",
    "speed_error": "wrong speed",
    "support_gradient": "gradient of support stiffness",
    "support_scatter": "scatter of support stiffness",
    "wheel_polygon": "polygonal wheel",
}
"""Of effects whose identifier, its underscores taken away, is not what an engineer says."""

PREFIXES = (("G", 1e9), ("M", 1e6), ("k", 1e3))
"""Of what is counted in newtons and pascals."""

SMALL = (("m", 1e-3), ("µ", 1e-6))
"""Of metres and seconds, below a tenth of each."""

SUFFIXES = ("_N2_per_Hz", "_N_per_m", "_m_per_s", "_kg_per_m", "_dB_per_octave", "_per_K", "_per_10K")
"""Units at the end of parameters' names, beside those of one part."""

UNITS = ("_m", "_s", "_kg", "_Hz", "_dB", "_N")

MOST, MOST_OF_SHARE, SHARE = 3, 2, 0.5
"""Significant digits, at most; of an effect's ratio below a half fewer, for no model is right to a hundredth of
what is left. A ratio near 1, as of a gain or a speed, needs all."""

POWER = r"(-?\d(?:\.\d+)?e[+-]\d+)(?: (N m/rad|N/m|Ns/m|kg/m|kg|N|m)\b)?"
"""A number with an exponent, and its unit."""

PLACE_M = 1e-6
"""Within which a place is one of whole millimetres."""


def name_of(identifier: str) -> str:
    """Of an effect of the catalogue, or of several that are joined by " and "."""
    return " and ".join(NAMES.get(one, one.replace("_", " ")) for one in identifier.split(" and "))


def aim(separates: tuple[str, str]) -> str:
    """What a measurement decides between two sets of effects, by what only one of them has."""
    sets = [Counter(one for one in names.split(" and ") if one != RECALIBRATED) for names in separates]
    common = sets[0] & sets[1]
    suspected, rival = (_beside(common, own - common) for own in sets)
    if not suspected:
        return f"see whether {rival} acts, too" if rival else f"be sure of {name_of(separates[0])}"
    return f"tell {suspected} from {rival}" if rival else f"be sure of {suspected}"


def _beside(common: Counter[str], own: Counter[str]) -> str:
    """Names of effects, where some are there without them."""
    return " and ".join(again(n, bool(common[n] + i)) for n, count in own.items() for i in range(count))


def again(name: str, known: bool) -> str:
    """An effect's name, kept apart from one of the same name if such is known already."""
    words = name_of(name).split()
    plural = any(word.endswith("s") and not word.endswith("ss") for word in (words[0], words[-1]))
    return " ".join((["more" if plural else "another"] if known else []) + words)


def parameter_of(identifier: str) -> str:
    """Of an effect's parameter, without its unit."""
    for suffix in (*SUFFIXES, *UNITS):
        if identifier.endswith(suffix):
            identifier = identifier.removesuffix(suffix)
            break
    return identifier.replace("_", " ")


def chance(probability: float) -> str:
    """A probability with two digits; what rounds to 1 or 0 is called more or less than the last before it."""
    if probability >= 0.995:
        return "above 0.99"
    return "below 0.01" if probability < 0.005 else f"{probability:.2f}"


def measured(value: float, unit: str, digits: int = MOST) -> str:
    """A number with its unit, whose prefix is such that few zeros are left."""
    factor, named = _scale(abs(value), unit)
    return _with(_text(value / factor, _decimals(value / factor, digits)), named)


def stated(value: float, unit: str) -> str:
    """A number that somebody has stated, with its unit and no nought at its end."""
    factor, named = _scale(abs(value), unit)
    text = f"{value / factor:.4g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")
    return _with(text.replace("-", "−"), named)


def estimate(one: Estimate | Moved) -> str:
    """A value with its unit, with the digits that its 90 % interval leaves."""
    factor, named = _scale(abs(one.value), one.unit)
    return _with(_text(one.value / factor, _known(one, factor)), named)


def ends(one: Estimate | Moved) -> str:
    """The 90 % interval with its unit, once what rounds to one number, or "" where it is not known."""
    if one.low is None or one.high is None:
        return ""
    factor, named = _scale(abs(one.value), one.unit)
    low, high = one.low / factor, one.high / factor
    decimals = _known(one, factor)
    # An end near 0 is not 0.
    texts = (_text(end, decimals if round(end, decimals) else _decimals(end, 1)) for end in (low, high))
    return _with(" to ".join(dict.fromkeys(texts)), named)


def spelled(law: str) -> str:
    """Mechanics in words, whose numbers have a prefix of their unit and no exponent."""
    return re.sub(POWER, lambda found: measured(float(found[1]), found[2] or "1"), law)


def stretch(low: float, high: float) -> str:
    """From and to along the line, to the decimetre, or to the centimetre where that is known; once what is one.

    Places to the millimetre are those of joints, and stand as they are: rounded, the last might lie outside.
    """
    decimals = 2 if high - low < 0.2 else 1
    exact = all(abs(x - round(x, 3)) < PLACE_M for x in (low, high))
    ends = (_decimal(x, decimals, 3) if exact else f"{x:.{decimals}f}" for x in (low, high))
    return f"{' to '.join(dict.fromkeys(ends))} m".replace("-", "−")


def _decimal(value: float, least: int, most: int) -> str:
    """With so many decimals at least, and up to the most without noughts at the end."""
    whole, _, rest = f"{value:.{most}f}".partition(".")
    return f"{whole}.{rest.rstrip('0').ljust(least, '0')}"


def seen(one: Smallest) -> str:
    """The smallest size that would have been seen."""
    if one.value is None:
        return "none would have been seen"
    if one.none:
        return f"a change of {_text(percent := 100.0 * abs(one.value / one.none - 1.0), _decimals(percent, 2))} %"
    side = "below" if one.none is None or one.value < one.none else "above"
    return f"{parameter_of(one.parameter)} {side} {measured(one.value, one.unit, 2)}"


def _known(one: Estimate | Moved, factor: float) -> int:
    """Decimals of a value in a unit: down to the first digit of half the interval, two or three digits at most."""
    share = isinstance(one, Estimate) and one.unit == "1" and abs(one.value) < SHARE
    digits = MOST_OF_SHARE if share else MOST
    if one.low is None or one.high is None or not one.high > one.low:
        return _decimals(one.value / factor, digits)
    half = 0.5 * (one.high - one.low) / factor
    most = _decimals(max(abs(one.value / factor), half), digits)
    # Ends that share their digits with the value would say nothing.
    return min(most, -math.floor(math.log10(half)) + (half < 2.0 * 10.0 ** math.floor(math.log10(half))))


def _scale(size: float, unit: str) -> tuple[float, str]:
    """By what a number is divided, and the unit then."""
    if unit.startswith(("N", "Pa")):
        for prefix, factor in PREFIXES:
            if size >= factor:
                return factor, prefix + unit
    if unit in ("m", "s") and 0.0 < size < 0.1:
        for prefix, factor in SMALL:
            if size >= factor:
                return factor, prefix + unit
    return 1.0, "" if unit == "1" else unit


def _decimals(value: float, digits: int) -> int:
    return digits - 1 - math.floor(math.log10(abs(value))) if value else 0


def _text(value: float, decimals: int) -> str:
    # Without a sign of nought.
    rounded = round(value, decimals) + 0.0
    if rounded and not 1e-4 <= abs(rounded) < 1e6:
        plain = f"{rounded:.{max(0, decimals + math.floor(math.log10(abs(rounded))))}e}"
        plain = plain.replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")
    else:
        plain = f"{rounded:.{max(decimals, 0)}f}"
    return plain.replace("-", "−")


def _with(text: str, unit: str) -> str:
    return f"{text} {unit}" if unit else text
