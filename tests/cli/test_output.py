"""What is printed for people has no identifiers in it."""

from __future__ import annotations

import pytest
from permway.cli.output import heading, print_result


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("from_Hz", "from, Hz"),
        ("noise_dB_rms", "noise, dB rms"),
        ("critical_speed_m_per_s", "critical speed, m/s"),
        ("critical_speed_km_per_h", "critical speed, km/h"),
        ("decay_rate_dB_per_m", "decay rate, dB/m"),
        ("m_per_N", "m per N"),
        ("greatest_m_per_N", "greatest, m/N"),
        ("us_per_frequency", "us per frequency"),
        ("left_tolerance", "left tolerance"),
        ("memory_GiB", "memory, GiB"),
        ("moves_most", "moves most"),
        ("verdict", "verdict"),
    ],
)
def test_a_key_is_reported_in_words_with_its_unit(key: str, words: str) -> None:
    assert heading(key) == words


def test_json_keeps_the_keys_and_people_get_words(capsys: pytest.CaptureFixture[str]) -> None:
    result = {"left_tolerance": ["pad_k"], "rows": [{"from_Hz": 5.0, "name": "a_b"}]}
    print_result(result, True)
    assert '"left_tolerance": ["pad_k"]' in capsys.readouterr().out
    print_result(result, False)
    # What the user named stays as he named it.
    assert (
        capsys.readouterr().out
        == "left tolerance  pad_k\nrows            from, Hz  name\n                5         a_b\n"
    )
