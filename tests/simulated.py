"""The small campaign of the tests: the fixture that the package itself measures a diagnosis by."""

from permway.challenge.small.fixture import (
    BLOWS,
    CAMPAIGN,
    FREQUENCY,
    MODEL,
    SPACING,
    Simulated,
    simulate,
)

__all__ = ["BLOWS", "CAMPAIGN", "FREQUENCY", "MODEL", "SPACING", "Simulated", "simulate"]
