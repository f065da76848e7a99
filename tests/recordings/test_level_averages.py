"""What a spectrum is worth whose level varies along the record: against how powers do scatter."""

from __future__ import annotations

import numpy as np
import pytest
from permway.campaign.welch import cross_spectra_of
from permway.recordings.record import TimeRecord
from scipy import signal
from scipy.special import polygamma

RATE, SECONDS, RECORDS = 256.0, 64, 30


def _record(random: np.random.Generator, level_dB: float) -> np.ndarray:
    """Coloured noise in two channels, of which the first has another level every 1 to 6 s."""
    samples = int(RATE * SECONDS)
    level, at = np.ones(samples), 0
    while at < samples:
        stretch = int(random.uniform(1.0, 6.0) * RATE)
        level[at : at + stretch] = 10.0 ** (0.05 * level_dB * random.standard_normal())
        at += stretch
    first = signal.lfilter([1.0], [1.0, -0.6], random.standard_normal(samples) * level)
    return np.stack([first, random.standard_normal(samples)])


@pytest.mark.parametrize("level_dB", [0.0, 3.0, 6.0])
def test_powers_scatter_as_their_averages_state(level_dB: float) -> None:
    random = np.random.default_rng(5)
    squares, worth, steady = [], [], 0.0
    for _ in range(RECORDS):
        record = TimeRecord(
            channels=("a", "b"), units=(None, None), values=_record(random, level_dB), sampling_Hz=RATE
        )
        data = cross_spectra_of(
            [record], segment_s=1.0, channels=["a", "b"], units=["m", "m"], band_Hz=(4.0, 120.0)
        )
        worth.append(data["level_averages"].values)
        steady = data.attrs["averages"]
        frequency = data["frequency"].values
        lines = np.flatnonzero((frequency >= 4.0) & (frequency <= 120.0))[::2]
        gain = np.abs(signal.freqz([1.0], [1.0, -0.6], frequency[lines], fs=RATE)[1]) ** 2
        logarithm = np.log(data["psd"].values[0, lines] / gain)
        # The level of all lines is not what they scatter by.
        count = worth[-1][0]
        squares.append(np.var(logarithm, ddof=1) / polygamma(1, count))
    varied, other = np.mean(worth, axis=0)
    assert np.mean(squares) == pytest.approx(1.0, abs=0.12)
    assert other == pytest.approx(steady, rel=0.03)
    if level_dB == 0.0:
        assert varied == pytest.approx(steady, rel=0.03)
    else:
        assert varied < {3.0: 0.8, 6.0: 0.5}[level_dB] * steady


def test_a_silent_channel_is_worth_what_the_record_is() -> None:
    values = np.stack([np.zeros(5000), np.random.default_rng(0).standard_normal(5000)])
    record = TimeRecord(channels=("a", "b"), units=(None, None), values=values, sampling_Hz=RATE)
    data = cross_spectra_of([record], segment_s=1.0, channels=["a", "b"], units=["m", "m"])
    assert data["level_averages"].values[0] == pytest.approx(data.attrs["averages"], rel=0.05)
    assert np.isfinite(data["level_averages"].values).all()
