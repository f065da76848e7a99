"""All that a campaign is computed from, which effects may alter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from permway.challenge.assembly import assemble
from permway.challenge.beams import Complexes, Reals
from permway.challenge.layout import Layout, Tests, Values
from permway.challenge.track import Location, Track
from permway.challenge.under_train import Support
from permway.challenge.vehicle import Vehicle, vehicle

Transfer = Callable[[Reals], Complexes]

CONTACT_N_PER_M = 1.3e9

FLOOR = 7.6e-9
"""Noise of a channel on board, (m/s2)2/Hz."""


@dataclass(frozen=True)
class Chain:
    """How well the campaign was measured.

    Parameters
    ----------
    calibration_dB : float
        Calibration errors of a sensor and a hammer point together, standard deviation of level and, in as many
        nepers, of phase.
    noise : float
        Of a line sensor at one line, (m/s2) for a blow of 1 N.
    speed : tuple of float
        True speed over the one written down, for each run.
    warmer_C : tuple of float
        True temperature less the one written down, for each hammer test.
    clean : bool
        Neither noise nor errors of gain: for tests.
    """

    calibration_dB: float = 1.0
    noise: float = 1.2e-6
    speed: tuple[float, ...] = (1.0, 1.0)
    warmer_C: tuple[float, ...] = (0.0, 0.0)
    clean: bool = False


@dataclass
class Plan:
    """Track, vehicle, profile and measuring chain of one campaign.

    Attributes
    ----------
    line_gain : dict of Location to list of Transfer
        Faults of sensors on the line.
    channel_gain : dict of str to list of Transfer
        Faults of channels on board.
    line_noise, channel_noise : dict
        Factors on the noise's standard deviation.
    shapes : list of callable
        Factors on the profile's amplitude: of frequencies (Hz) and speed (m/s).
    wheel_profiles : list of callable
        Added under the wheels: of times (s) and true speed (m/s), shape (4, N), m.
    hums : list of callable
        Added to channels: of a channel's name and times, shape (N,), m/s2.
    supports : list of Support
        What the track's links are under a train, where that is not what they are under a hammer.
    rolls : bool
        Whether the train runs over the deck, again and again; else it stands while the profile moves.
    recorders : list of callable
        From what a channel reads to what is recorded of it: of the channel's name and values, shape (N,), m/s2.
    """

    layout: Layout
    values: Values
    tests: Tests
    chain: Chain
    track: Track
    vehicle: Vehicle
    line_gain: dict[Location, list[Transfer]] = field(default_factory=dict)
    channel_gain: dict[str, list[Transfer]] = field(default_factory=dict)
    line_noise: dict[Location, float] = field(default_factory=dict)
    channel_noise: dict[str, float] = field(default_factory=dict)
    shapes: list[Callable[[Reals, float], Reals]] = field(default_factory=list)
    wheel_profiles: list[Callable[[Reals, float], Reals]] = field(default_factory=list)
    hums: list[Callable[[str, Reals], Reals]] = field(default_factory=list)
    supports: list[Support] = field(default_factory=list)
    recorders: list[Callable[[str, Reals], Reals]] = field(default_factory=list)
    speed_factor: list[float] = field(default_factory=list)
    rolls: bool = False

    def gain_of(self, gains: list[Transfer], frequency_Hz: Reals) -> Complexes:
        """The product of some faults, (F,)."""
        total = np.ones(frequency_Hz.shape, dtype=np.complex128)
        for gain in gains:
            total = total * gain(frequency_Hz)
        return total


def plan_of(layout: Layout, values: Values, tests: Tests, chain: Chain) -> Plan:
    """A plan with nothing concealed."""
    return Plan(
        layout=layout,
        values=values,
        tests=tests,
        chain=chain,
        track=assemble(layout, values),
        vehicle=vehicle(values, CONTACT_N_PER_M),
        speed_factor=list(chain.speed),
    )
