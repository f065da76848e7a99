"""Units as loggers write them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from permway.errors import InputError
from permway.units import QUANTITIES, Unit, check_same, parse_unit


# Factors from the definitions of the SI (BIPM, 9th ed.) and of standard gravity; none is computed by the package.
@pytest.mark.parametrize(
    ("text", "quantity", "factor"),
    [
        ("m/s^2", "acceleration", 1.0),
        ("m/s2", "acceleration", 1.0),
        ("m/s²", "acceleration", 1.0),
        ("m s-2", "acceleration", 1.0),
        ("m·s⁻²", "acceleration", 1.0),
        ("m*s^-2", "acceleration", 1.0),
        ("ms-2", "acceleration", 1.0),
        ("m/s/s", "acceleration", 1.0),
        ("m/sec^2", "acceleration", 1.0),
        ("mm/s^2", "acceleration", 1e-3),
        ("g", "acceleration", 9.80665),
        ("mg", "acceleration", 9.80665e-3),
        ("ug", "acceleration", 9.80665e-6),
        ("m/s", "velocity", 1.0),
        ("mm/s", "velocity", 1e-3),
        ("km/h", "velocity", 1.0 / 3.6),
        ("m", "displacement", 1.0),
        ("mm", "displacement", 1e-3),
        ("um", "displacement", 1e-6),
        ("µm", "displacement", 1e-6),
        ("μm", "displacement", 1e-6),
        ("N", "force", 1.0),
        ("kN", "force", 1e3),
        ("(m/s^2)/N", "accelerance", 1.0),
        ("m/s^2/N", "accelerance", 1.0),
        ("g/kN", "accelerance", 9.80665e-3),
        ("1/kg", "accelerance", 1.0),
        ("(mm/s)/N", "mobility", 1e-3),
        ("m/N", "receptance", 1.0),
        ("um/kN", "receptance", 1e-9),
        ("kN/mm", "stiffness", 1e6),
        ("MN/m", "stiffness", 1e6),
        ("Pa", "pressure", 1.0),
        ("MPa", "pressure", 1e6),
        ("N/mm^2", "pressure", 1e6),
        ("Hz", "frequency", 1.0),
        ("kHz", "frequency", 1e3),
        ("1/s", "frequency", 1.0),
        ("rad/s", "angular velocity", 1.0),
        ("rpm", "angular velocity", 2.0 * math.pi / 60.0),
        ("deg", "angle", math.pi / 180.0),
        ("%", "ratio", 1e-2),
        ("um/m", "ratio", 1e-6),
        ("µε", "ratio", 1e-6),
        ("mm/m", "ratio", 1e-3),
        ("ms", "time", 1e-3),
        ("dB/m", "decay rate", 1.0),
        ("K", "temperature", 1.0),
        ("(m/s2)^2/Hz", "acceleration density", 1.0),
        ("(m/s2)2/Hz", "acceleration density", 1.0),
        ("g^2/Hz", "acceleration density", 9.80665**2),
        ("m^2/Hz", "displacement density", 1.0),
        ("mV", "voltage", 1e-3),
        ("mV/(m/s2)", "unnamed", 1e-3),
    ],
)
def test_factor_and_quantity(text: str, quantity: str, factor: float) -> None:
    unit = parse_unit(text)
    assert unit.quantity == quantity
    assert unit.factor == pytest.approx(factor, rel=1e-14)
    assert unit.offset == 0.0
    np.testing.assert_allclose(unit.to_SI([0.0, 2.0]), [0.0, 2.0 * factor], rtol=1e-14)


@pytest.mark.parametrize("text", ["degC", "°C", "C", "deg C"])
def test_degrees_celsius_become_kelvin(text: str) -> None:
    np.testing.assert_allclose(parse_unit(text, quantity="temperature").to_SI([0.0, -273.15]), [273.15, 0.0])


def test_levels() -> None:
    unit = parse_unit("dB re 1 um")
    assert (unit.quantity, unit.level) == ("level of displacement", True)
    np.testing.assert_allclose(unit.to_SI([0.0, 20.0, -6.0]), [1e-6, 1e-5, 1e-6 * 10.0**-0.3])
    assert parse_unit("dB re 1e-6 m/s2").factor == 1e-6


@pytest.mark.parametrize(
    ("text", "stated"),
    [
        ("furlong", "not known .*'furlong'"),
        ("hz", "did you mean Hz"),
        ("Mpa", "did you mean MPa"),
        ("m/s^3x", "two ways"),
        ("kn", "did you mean .*kN"),
        ("EU", "not known"),
        ("", "empty"),
        ("  ", "empty"),
        ("m/", "not known"),
        ("/s", "not known"),
        ("(m/s", "bracket is not closed"),
        ("m)", "not known"),
        ("N/m s", "two ways"),
        ("dB", "level without its reference"),
        ("dB re dB re 1 um", "reference"),
        ("dB re degC", "plain quantity"),
        ("1/0", "above zero"),
        ("m" * 100, "longer than any unit"),
        ("((((((((((m", "not known"),
        ("m^2.5", "not known|two ways"),
        ("kdB", "not known"),
    ],
)
def test_what_is_no_unit_is_reported_with_the_nearest(text: str, stated: str) -> None:
    with pytest.raises(InputError, match=stated) as caught:
        parse_unit(text, where="run.csv: channel 'a'")
    assert caught.value.where == "run.csv: channel 'a'"
    assert caught.value.remedy


def test_another_quantity_is_refused() -> None:
    with pytest.raises(InputError, match="is a unit of velocity, not of acceleration"):
        parse_unit("mm/s", quantity="acceleration")


def test_same_meaning() -> None:
    check_same("m/s²", "m/s2", where="a")
    check_same("kN/mm", "MN/m", where="a")
    for found, stated in (("g", "m/s2"), ("degC", "K"), ("dB re 1 um", "um"), ("Hz", "rad/s")):
        with pytest.raises(InputError, match="was stated to be in"):
            check_same(found, stated, where="a")


@given(st.text(max_size=30) | st.text("mskgNPaHz/()^-*. 12dBre", max_size=20))
def test_any_text_is_a_unit_or_one_error(text: str) -> None:
    try:
        unit = parse_unit(text)
    except InputError as error:
        assert error.where == "unit"  # noqa: PT017
    else:
        assert math.isfinite(unit.factor)
        assert unit.factor > 0.0


units = st.sampled_from(["m", "s", "N", "kN", "mm", "g", "Hz", "kg", "um", "K"])
powers = st.integers(1, 3)


@given(units, powers, units, powers)
def test_a_quotient_is_the_quotient(over: str, n: int, under: str, m: int) -> None:
    a, b = parse_unit(over), parse_unit(under)
    whole = parse_unit(f"{over}^{n}/{under}{m}")
    assert whole.factor == pytest.approx(a.factor**n / b.factor**m, rel=1e-12)
    assert whole.dimension == tuple(n * x - m * y for x, y in zip(a.dimension, b.dimension, strict=True))
    inverse = parse_unit(f"({over}^{n}/{under}{m})^-1")
    assert inverse.factor == pytest.approx(1.0 / whole.factor, rel=1e-12)


def test_names_of_quantities_are_of_one_dimension_each() -> None:
    assert len(set(QUANTITIES.values())) == len(QUANTITIES)
    assert isinstance(parse_unit("m"), Unit)
