"""Simulated faults are found at their places; clean noise is passed; nothing is altered."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from permway.recordings.finding import Screening
from permway.recordings.record import TimeRecord
from permway.recordings.screening import screen
from permway.recordings.screening_levels import FALSE_ALARMS
from scipy import signal

RATE = 1024.0
COUNT = 32_768


def noise(seed: int, count: int = COUNT) -> np.ndarray:
    """White, a lightly damped resonance, low-pass to a tenth of the rate, and pink, in turn."""
    rng = np.random.default_rng(seed)
    white = rng.standard_normal(count)
    filters = ([1.0], [1.0]), ([1.0], [1.0, -1.8, 0.95]), signal.butter(4, 0.2), ([1.0], [1.0, -0.99])
    over, under = filters[seed % 4]
    return np.asarray(signal.lfilter(over, under, white))


def record(*rows: np.ndarray, rate: float | None = RATE, start: float | None = None) -> TimeRecord:
    names = tuple("abcdef"[: len(rows)])
    values = np.array(rows)
    return TimeRecord(channels=names, units=(None,) * len(rows), values=values, sampling_Hz=rate, start_s=start)


def only(found: Screening, kind: str) -> list[tuple[int | None, int | None]]:
    """Places of a kind; nothing else was found."""
    assert {finding.kind for finding in found} == {kind}, str(found)
    return [(finding.first, finding.last) for finding in found]


def test_clean_noise_is_passed() -> None:
    """Of 200 records of four kinds of noise, none has a finding.

    By FALSE_ALARMS a line of the mains is expected in 200 * 1e-5 = 0.002 of white noise; a spike of eight standard
    deviations in 1.6e6 Gaussian samples in 2e-9; the other findings need samples that are equal, or an offset of
    half a standard deviation with six standard errors, which noise this long does not have.
    """
    found = Counter(finding.kind for seed in range(200) for finding in screen(record(noise(seed, 8192))))
    assert FALSE_ALARMS * 200 < 0.01
    assert not found, found


def test_the_data_stay_as_they_are() -> None:
    x = noise(1)
    x[100:120] = np.nan
    x[5000] = 1e3
    data = record(x)
    before = data.values.copy()
    screen(data)
    np.testing.assert_array_equal(data.values, before)


@pytest.mark.parametrize("seed", range(4))
def test_runs_that_are_not_finite(seed: int) -> None:
    x = noise(seed)
    x[700:703], x[9000], x[-1] = np.nan, np.inf, -np.inf
    found = screen(record(x, start=2.0))
    assert only(found, "not finite") == [(700, 702), (9000, 9000), (COUNT - 1, COUNT - 1)]
    assert [finding.severity for finding in found] == ["error"] * 3
    assert found.findings[0].time_s == pytest.approx(2.0 + 700 / RATE)


@pytest.mark.parametrize("seed", range(1, 4))
def test_clipping(seed: int) -> None:
    x = noise(seed)
    level = 2.2 * x.std()
    clipped = np.clip(x, -level, level)
    beyond = np.abs(x) >= level
    edges = np.flatnonzero(np.diff(np.concatenate(([0], beyond.astype(int), [0])))).reshape(-1, 2)
    expected = [(int(a), int(b) - 1) for a, b in edges if b - a >= 3]
    assert len(expected) > 3
    places = [(f.first, f.last) for f in screen(record(clipped)) if f.kind == "clipping"]
    assert places == expected[:20]
    assert {abs(f.value or 0.0) for f in screen(record(clipped)) if f.kind == "clipping"} == {level}


def test_a_quantised_sine_is_not_clipped() -> None:
    t = np.arange(COUNT) / RATE
    x = np.round(2000.0 * np.sin(2.0 * np.pi * 1.3 * t)) / 2000.0
    assert not [finding for finding in screen(record(x)) if finding.severity == "error"]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("held", [0.0, None])
def test_dropouts(seed: int, held: float | None) -> None:
    x = noise(seed)
    for a, b in ((1000, 1008), (20_000, 21_500)):
        x[a:b] = x[a] if held is None else held
    assert only(screen(record(x)), "dropout") == [(1000, 1007), (20_000, 21_499)]


@pytest.mark.parametrize(("held", "reported"), [(5, False), (12, True)])
def test_samples_written_with_four_digits_stand_still_by_chance_where_they_are_large(
    held: int, reported: bool
) -> None:
    """As five did in one run of a hundred campaigns: above 0.1 steps are ten times those below."""
    random = np.random.default_rng(3)
    slow = np.where(np.arange(COUNT) % 4000 < 600, 0.13, 0.04)
    x = slow + 2e-3 * random.standard_normal(COUNT)
    written = np.array([float(f"{value:.4g}") for value in x])
    written[8200 : 8200 + held] = written[8200]
    found = screen(record(written)).of("error")
    assert [(finding.kind, finding.first) for finding in found] == ([("dropout", 8200)] if reported else [])


def test_a_dropout_in_quantised_samples() -> None:
    x = np.round(20.0 * noise(0)) / 20.0
    assert not screen(record(x)).of("error")
    x[3000:3040] = x[3000]
    places = [(finding.first, finding.last) for finding in screen(record(x)).of("error")]
    assert len(places) == 1
    first, last = places[0]
    # Neighbours that happen to be equal belong to the run.
    assert first is not None
    assert last is not None
    assert 2995 <= first <= 3000
    assert 3039 <= last <= 3044


@pytest.mark.parametrize("seed", range(4))
def test_spikes(seed: int) -> None:
    x = noise(seed)
    # White noise is predicted by nothing: only what stands out of its level is a spike.
    size = 6.0 * x.std() if seed == 0 else 2.0 * x.std()
    for at, sign in ((40, 1.0), (12_345, -1.0), (30_000, 1.0)):
        x[at] += sign * size * (2.0 if seed == 0 else 1.0)
    assert only(screen(record(x)), "spike") == [(40, 40), (12_345, 12_345), (30_000, 30_000)]


def test_what_is_loud_for_a_while_is_no_spike() -> None:
    x = noise(0)
    x[10_000:16_000] *= 30.0
    assert not [finding for finding in screen(record(x)) if finding.kind == "spike"]


def test_offset_and_drift() -> None:
    x = noise(0)
    found = screen(record(x + 3.0))
    assert only(found, "offset") == [(None, None)]
    assert found.findings[0].value == pytest.approx(3.0, abs=0.05)
    found = screen(record(x + np.linspace(-2.0, 2.0, COUNT)))
    assert only(found, "drift") == [(None, None)]
    assert found.findings[0].value == pytest.approx(4.0, abs=0.1)


def test_quantisation() -> None:
    found = screen(record(np.round(noise(0))))
    assert only(found, "quantisation") == [(None, None)]
    assert (found.findings[0].value, found.findings[0].severity) == (1.0, "warning")
    assert screen(record(np.round(20.0 * noise(0)) / 20.0)).findings[0].severity == "note"
    assert not screen(record(np.round(1e4 * noise(0)) / 1e4))


def test_a_dead_channel() -> None:
    found = screen(record(noise(0), np.full(COUNT, 1.25), np.full(COUNT, np.nan)))
    kinds = [(finding.channel, finding.kind) for finding in found]
    assert kinds == [("b", "dead"), ("c", "not finite")]


def test_copies() -> None:
    x, y = noise(0), noise(4)
    found = screen(record(x, y, x, -2.0 * y))
    assert [(f.channel, f.kind, f.severity) for f in found] == [
        ("c", "identical", "error"),
        ("d", "identical", "warning"),
    ]
    assert "times -2" in found.findings[1].what
    near = screen(record(x, x + 0.01 * y))
    assert not near, str(near)


@pytest.mark.parametrize(("base", "n"), [(50.0, 1), (50.0, 3), (50.0 / 3.0, 2), (50.0 / 3.0, 5)])
def test_lines_of_the_mains(base: float, n: int) -> None:
    t = np.arange(COUNT) / RATE
    # In noise of density 2/RATE a line of amplitude a stands a^2/2 high over its bandwidth, here 1.5/8 Hz.
    x = noise(0) + 0.2 * np.sin(2.0 * np.pi * (n * base + 0.02) * t)
    found = screen(record(x))
    assert only(found, "mains") == [(None, None)]
    assert found.findings[0].value == pytest.approx(n * base, abs=0.2)
    other = noise(0) + 0.2 * np.sin(2.0 * np.pi * (n * base + 3.0) * t)
    assert not screen(record(other))


def test_sampling() -> None:
    assert only(screen(record(noise(0), rate=None)), "sampling") == [(None, None)]
    found = screen(record(noise(0)), sampling_Hz=1000.0)
    assert (found.findings[0].kind, found.findings[0].severity) == ("sampling", "error")
    assert not screen(record(noise(0)), sampling_Hz=1024.0)


def test_more_places_than_can_be_read_are_counted() -> None:
    x = noise(0)
    x[100:5100:100] = np.nan
    found = screen(record(x))
    assert len(found) == 20
    assert found.findings[-1].what.endswith("and 30 more place(s)")


def test_as_a_table() -> None:
    x = noise(0)
    x[700:703] = np.nan
    lines = str(screen(record(x, noise(1)))).split("\n")
    assert lines[0].split() == ["severity", "channel", "kind", "samples", "time,", "s", "what"]
    assert lines[1].split()[:3] == ["error", "a", "not"]
    assert "700 to 702" in lines[1]
    assert "0.6836" in lines[1]
    assert str(screen(record(noise(1)))).endswith("nothing found")


def test_short_records() -> None:
    for count in (1, 2, 3, 17, 100):
        assert isinstance(screen(record(noise(0, count))), Screening)
