"""A value that is stated wrongly, in words."""

from __future__ import annotations

import pytest
from permway.campaign.parameters import Known, Parameter
from permway.posterior.stated import _words


@pytest.mark.parametrize(
    ("nominal", "log", "sigma", "deviations", "words"),
    [
        (0.0, False, 0.01, 3.0, "about 0.03 s, above the stated 0 s, 3.0 standard"),
        (0.0, False, 0.01, -2.0, "about -0.02 s, below the stated 0 s, 2.0 standard"),
        (-1.0, False, 0.25, -2.0, "about -1.5 s, below the stated -1 s, 2.0 standard"),
        (2.0, False, 0.25, 2.0, "about 2.5 s, 25 % above the stated 2 s, 2.0 standard"),
    ],
)
def test_of_any_sign_and_of_nothing(
    nominal: float, log: bool, sigma: float, deviations: float, words: str
) -> None:
    """A train's entry may be stated as 0 s: no share of that is meant."""
    parameter = Parameter(name="entry", paths=("a",), unit="s", tolerance_2sigma=2.0 * sigma)
    assert _words(Known(parameter, nominal, log, sigma), deviations).startswith(words)
