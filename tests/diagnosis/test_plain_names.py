"""What people read: no underscores, units that fit, and no digit that is not known."""

from __future__ import annotations

import pytest
from permway.diagnosis.catalogue import entries
from permway.diagnosis.plain_names import (
    NAMES,
    aim,
    chance,
    ends,
    estimate,
    measured,
    name_of,
    parameter_of,
    seen,
    spelled,
    stated,
    stretch,
)
from permway.diagnosis.verdict_parts import Estimate, Smallest


def test_no_effect_or_parameter_is_reported_with_an_underscore() -> None:
    for name, entry in entries().items():
        assert "_" not in name_of(name)
        assert all("_" not in parameter_of(one) for one in entry.PARAMETERS)
    assert name_of("fastener_loss and wheel_flat") == "lost fasteners and wheel flat"
    # A word for an effect that is gone would never be missed.
    assert set(NAMES) - set(entries()) == {"novel", "owner_value", "recalibrated", "sensor_labels"}


@pytest.mark.parametrize(
    ("suspected", "rival", "words"),
    [
        (
            "beam_damping and deck_attachment and second_track",
            "beam_damping and deck_attachment and deck_attachment",
            "tell second track from another deck attachment",
        ),
        (
            "second_track",
            "deck_attachment and deck_attachment",
            "tell second track from deck attachment and another deck attachment",
        ),
        ("second_track and second_track", "second_track", "be sure of another second track"),
        ("second_track", "beam_damping and second_track", "see whether damping law of a beam acts, too"),
        ("fastener_loss", "recalibrated", "be sure of lost fasteners"),
        ("fastener_loss and fastener_loss", "fastener_loss", "be sure of more lost fasteners"),
    ],
)
def test_what_a_measurement_decides_is_what_differs(suspected: str, rival: str, words: str) -> None:
    assert aim((suspected, rival)) == words


@pytest.mark.parametrize(
    ("value", "low", "high", "unit", "words", "interval"),
    [
        (0.05, 0.0499, 0.0501, "1", "0.050", "0.050"),
        (0.299938, 0.299642, 0.300235, "1", "0.30", "0.30"),
        (4.9857, 4.9846, 4.9868, "Hz", "4.99 Hz", "4.98 to 4.99 Hz"),
        (0.05, 0.0481, 0.0519, "1", "0.050", "0.048 to 0.052"),
        (0.05, 0.03, 0.08, "1", "0.05", "0.03 to 0.08"),
        (-1.019, -1.09, -0.94, "1", "−1.02", "−1.09 to −0.94"),
        (2.123e7, 1.9e7, 2.4e7, "N/m", "21 MN/m", "19 to 24 MN/m"),
        (2.55e-4, 2.4e-4, 2.7e-4, "s", "255 µs", "240 to 270 µs"),
        (73.15, 73.0, 73.3, "Hz", "73.2 Hz", "73.0 to 73.3 Hz"),
        (1234.0, 1000.0, 1500.0, "kg", "1200 kg", "1000 to 1500 kg"),
        (0.0, -0.1, 0.1, "dB", "0.00 dB", "−0.10 to 0.10 dB"),
    ],
)
def test_a_value_has_the_digits_that_its_interval_leaves(
    value: float, low: float, high: float, unit: str, words: str, interval: str
) -> None:
    one = Estimate(value=value, low=low, high=high, unit=unit)
    assert estimate(one) == words
    assert ends(one) == interval


def test_without_an_interval_three_digits_are_reported_of_a_share_two() -> None:
    one = Estimate(value=0.123456, unit="1")
    assert (estimate(one), ends(one)) == ("0.12", "")
    assert measured(3.1e-6, "m") == "3.10 µm"
    assert measured(4.2e8, "N/m", 2) == "420 MN/m"
    assert stated(3.0e7, "N/m") == "30 MN/m"
    assert stated(-0.05, "1") == "−0.05"


def test_a_probability_that_rounds_to_one_is_called_more_than_its_last_digit() -> None:
    assert [chance(p) for p in (1.0, 0.996, 0.994, 0.5, 0.004)] == [
        "above 0.99",
        "above 0.99",
        "0.99",
        "0.50",
        "below 0.01",
    ]


def test_what_would_have_been_seen_is_a_change_or_a_size_with_its_unit() -> None:
    assert seen(Smallest(parameter="factor", value=0.62, unit="1", none=1.0)) == "a change of 38 %"
    assert seen(Smallest(parameter="mass_kg", value=0.1275, unit="kg")) == "mass above 0.13 kg"
    assert seen(Smallest(parameter="mount_Hz", value=912.0, unit="Hz", none=None)) == "mount below 910 Hz"
    assert seen(Smallest(parameter="length_m", value=None, unit="m")) == "none would have been seen"


def test_a_stretch_is_reported_to_the_decimetre() -> None:
    assert stretch(5.7254, 7.6214) == "5.7 to 7.6 m"
    assert stretch(20.0, 20.0) == "20.00 m"
    assert stretch(6.0052, 6.0504) == "6.01 to 6.05 m"
    # Joints: the second would lie outside the rounded stretch.
    assert stretch(14.3, 14.950000000000001) == "14.3 to 14.95 m"
    assert stretch(-0.625, 6.0) == "−0.625 to 6.0 m"


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("8.6e+03 kg on a spring, 21.4 Hz", "8600 kg on a spring, 21.4 Hz"),
        ("a spring of 7.22e+06 N/m, loss factor 0.67", "a spring of 7.22 MN/m, loss factor 0.67"),
        ("1.1e+09 N m/rad against rotation", "1.10 GN m/rad against rotation"),
        ("54.6 kg on a spring", "54.6 kg on a spring"),
        ("a line of 0.000157 at 16.65 Hz", "a line of 0.000157 at 16.65 Hz"),
    ],
)
def test_laws_have_no_exponents(law: str, words: str) -> None:
    assert spelled(law) == words


def test_an_end_near_nothing_is_not_nothing() -> None:
    wide = Estimate(value=0.021, unit="1", low=0.0004, high=0.4)
    assert ends(wide) == "0.0004 to 0.40"
    assert ends(wide.model_copy(update={"low": 0.0})) == "0 to 0.4"
