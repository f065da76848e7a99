"""Track decay rate by EN 15461: the grid, exponential waves, a rail on a Winkler bed, uncertainty.

Source: EN 15461:2008+A1:2010, figure 2 (grid), formula (1), annex A (intervals; A(0) exp(-b x) has 8.686 b dB/m),
6.7 (a drop of 10 dB) and clause 7 (a floor of 4.343 / x_max, at most half the rate).
"""

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lines import hysteretic, supported, uic60
from permway.errors import InputError
from permway.model.place import Place
from permway.recordings.estimates.decay_rate import (
    TruncationWarning,
    band_response,
    grid_intervals,
    grid_positions,
    track_decay_rate,
)
from permway.response.receptance import receptance

NEPER_DB = 20.0 * np.log10(np.e)


def exponential(rate_dB_per_m, position):
    return np.exp(-np.outer(position, np.atleast_1d(rate_dB_per_m)) / NEPER_DB)


def test_grid():
    """29 places: quarter bays to 2.5, half bays to 4, whole bays to 8, and to 66, 39.6 m for bays of 0.6 m."""
    position = grid_positions(0.6)
    assert position.size == 29
    assert position[-1] == pytest.approx(39.6)
    assert np.diff(position[:11]) == pytest.approx(0.15)
    assert np.diff(position[10:14]) == pytest.approx(0.3)
    assert np.diff(position[13:18]) == pytest.approx(0.6)
    length = grid_intervals(position)
    assert length[0] == pytest.approx(0.075)
    assert length[-1] == pytest.approx(7.2)
    assert length.sum() == pytest.approx(39.6 + 3.6)


def test_uniform_grid_is_a_geometric_series():
    step, count, rate = 0.25, 80, 2.6
    position = step * np.arange(count + 1)
    q = np.exp(-2.0 * rate / NEPER_DB * step)
    series = step / 2.0 + step * q * (1.0 - q ** (count - 1)) / (1.0 - q) + step * q**count
    found = track_decay_rate(exponential(rate, position), position)
    assert float(found["decay_rate"][0]) == pytest.approx(0.5 * NEPER_DB / series, rel=1e-12)


def test_single_wave_on_the_standards_grid():
    """What the grid makes of one wave: right to 0.8 % from 0.7 to 7 dB/m, to 1.4 % at 0.4.

    Steep waves meet the trapezium rule at d = 0.15 m, which gives tanh(b d) / (b d) of the rate; flat ones the end
    of the grid at 39.6 m, where the rate cannot fall below its floor.
    """
    position = grid_positions(0.6)
    rate = np.array([0.1, 0.15, 0.25, 0.4, 0.7, 1.0, 2.0, 4.0, 7.0, 12.0, 18.0, 40.0])
    found = track_decay_rate(exponential(rate, position), position, warn=False)
    ratio = found["decay_rate"].values / rate
    good = (rate >= 0.7) & (rate <= 7.0)
    assert np.abs(ratio[good] - 1.0).max() < 0.008
    assert ratio[3] == pytest.approx(1.0, abs=0.014)
    assert list(found["suitable"].values) == list((rate >= 10.0 / 39.6) & (ratio * rate >= NEPER_DB / 39.6))
    steep = rate[-1] / NEPER_DB * 0.15
    assert ratio[-1] == pytest.approx(np.tanh(steep) / steep, rel=1e-3)


@pytest.fixture(scope="module")
def winkler_track():
    """UIC60 on supports every 0.1 m over 100 m, next to a bed of 300 (1 + 0.25 i) MN/m^2, at the grid's places."""
    frequency = np.arange(150.0, 2400.0, 25.0)
    rail = uic60(loss_factor=0.02)
    track = supported(rail, count=1001, spacing_m=0.1, pad=hysteretic(30e6 * (1 + 0.25j)))
    position = grid_positions(0.6)
    force = Place(body="rail", x_m=0.0)
    sensors = [Place(body="rail", x_m=float(x)) for x in position]
    data = receptance(track, frequency, forces=[force], sensors=sensors)
    return frequency, position, data["receptance"].values[:, :, 0].T, rail


def winkler(rail, frequency, distance):
    """Receptance (distance, frequency) of a Timoshenko rail on the bed, and its slow wave's decay in dB/m.

    Two waves exp(s x), s^4 + (rotary / EI + load / GA) s^2 + load / EI (rotary / GA - 1) = 0 with the bed taken
    off the mass; no rotation at the force, half of which the shear on either side carries.
    """
    omega = 2 * np.pi * frequency
    load, rotary = rail.mass_kg_per_m * omega**2 - 300e6 * (1 + 0.25j), rail.rotary_kg_m * omega**2
    bending, shear = rail.bending_Nm2, rail.shear_N
    total = -(rotary / bending + load / shear)
    root = np.sqrt(total**2 - 4.0 * load / bending * (rotary / shear - 1.0))
    exponents = -np.sqrt(np.stack([total + root, total - root]) / 2.0)
    force = -load / exponents
    rotation = exponents - force / shear
    size = 2.0 * (rotation[0] * force[1] - rotation[1] * force[0])
    waves = np.exp(exponents[:, None] * np.asarray(distance)[:, None])
    return (rotation[1] * waves[0] - rotation[0] * waves[1]) / size, NEPER_DB * np.abs(exponents.real).min(axis=0)


def test_winkler_rail(winkler_track):
    """The solved track against the closed form on the same grid, and against the slow wave alone.

    Supports at 0.1 m differ from a bed by the square of their spacing, 0.3 % in the receptance at 1 kHz. The near
    field at the force adds to |A(x_0)|, in a thin rail as much as the wave itself, and so lifts the rate above the
    slow wave's, by up to 2 (Thompson et al., eprints.soton.ac.uk/506978, find the same).
    """
    frequency, position, response, rail = winkler_track
    exact, slow = winkler(rail, frequency, position)
    found = track_decay_rate(response, position, warn=False)["decay_rate"].values
    assert found == pytest.approx(track_decay_rate(exact, position, warn=False)["decay_rate"].values, rel=0.01)
    above = frequency > 600.0
    assert np.all((found[above] > slow[above]) & (found[above] < 2.0 * slow[above]))
    # A fine grid of the same field: what the standard's steps cost.
    fine = np.arange(0.0, 60.0, 0.01)
    dense = track_decay_rate(winkler(rail, frequency, fine)[0], fine, warn=False)["decay_rate"].values
    assert found[above] == pytest.approx(dense[above], rel=0.05)
    bands = band_response(response, frequency, from_Hz=800.0, to_Hz=1600.0)
    per_band = track_decay_rate(bands.modulus, position, warn=False)["decay_rate"].values
    for value, low, high in zip(per_band, bands.bands.low_Hz, bands.bands.high_Hz, strict=True):
        inside = (frequency > low) & (frequency < high)
        assert 0.98 * found[inside].min() < value < 1.02 * found[inside].max()


def test_only_ratios_count(winkler_track):
    frequency, position, response, _ = winkler_track
    one = track_decay_rate(response, position, warn=False)
    two = track_decay_rate(np.abs(response) * frequency**2 * 3.0, position, warn=False)
    assert one["decay_rate"].values == pytest.approx(two["decay_rate"].values, rel=1e-12)


@pytest.mark.parametrize("rate", [0.8, 5.0])
def test_intervals_cover(rate):
    """Four blows a place, noise of 8 % of the direct response everywhere: 95 % intervals over 4000 sets.

    Variances are themselves estimates with 6 degrees of freedom. Where the vibration has died away only noise is
    left, so it is taken off.
    """
    rng = np.random.default_rng([15461, int(10 * rate)])
    position = grid_positions(0.6)
    exact = exponential(rate, position)
    truth = float(track_decay_rate(exact, position, warn=False)["decay_rate"][0])
    shape = (position.size, 4000)
    sigma = 0.08 * exact**0.5
    estimate = exact + sigma / 2.0 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    estimated = (sigma / 2.0) ** 2 * rng.chisquare(6, shape) / 6.0
    found = track_decay_rate(
        estimate,
        position,
        variance=estimated / np.abs(estimate) ** 2,
        degrees_of_freedom=6.0,
        take_off_noise=True,
        warn=False,
    )
    inside = (found["low"] <= truth) & (truth <= found["high"])
    assert 0.93 <= float(inside.mean()) <= 0.97
    met = np.log(found["decay_rate"].values).var()
    assert float(found["log_variance"].mean()) == pytest.approx(met, rel=0.15)


def test_noise_bias_is_reported():
    """Noise at half the response's size at the far places lowers the rate as read, by what the dataset states."""
    rng = np.random.default_rng(3)
    position = grid_positions(0.6)
    exact = exponential(2.0, position)
    shape = (position.size, 5000)
    part = 0.3 * exact
    estimate = exact + part * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    variance = part**2 / np.abs(estimate) ** 2
    variance[0], estimate[0] = 0.0, 1.0
    found = track_decay_rate(estimate, position, variance=np.broadcast_to(variance, shape), warn=False)
    truth = float(track_decay_rate(exact, position, warn=False)["decay_rate"][0])
    met = -10.0 * np.log10(np.mean(truth / found["decay_rate"].values))
    stated = -10.0 * np.log10(np.mean(10.0 ** (-found["noise_bias_dB"].values / 10.0)))
    assert stated < -0.3
    assert met == pytest.approx(stated, rel=0.1)


def test_bands_of_noisy_lines():
    """The variance of a band's modulus, from independent lines and from lines that hang together."""
    rng = np.random.default_rng(4)
    frequency = np.arange(100.0, 400.0, 2.0)
    modulus = 1.0 + 0.3 * np.sin(frequency / 40.0)
    error = 0.05 * rng.standard_normal((4000, frequency.size + 1))
    for noise, covariance in ((error[:, 1:], [1.0]), ((error[:, 1:] + error[:, :-1]) / 2**0.5, [1.0, 0.5])):
        found = band_response(
            modulus * np.exp(noise),
            frequency,
            variance=np.full(noise.shape, 0.0025),
            line_covariance=covariance,
            from_Hz=160.0,
            to_Hz=315.0,
        )
        assert np.log(found.modulus).var(axis=0) == pytest.approx(found.variance.mean(axis=0), rel=0.1)
    assert found.bands.label == ["160", "200", "250", "315"]


def test_truncation_is_warned_of():
    position = grid_positions(0.6)
    with pytest.warns(TruncationWarning, match=r"in 1 of 2 line\(s\).*index 1: drop 7.9 dB"):
        found = track_decay_rate(exponential([1.0, 0.2], position), position)
    assert list(found["suitable"].values) == [True, False]
    assert found.floor_dB_per_m == pytest.approx(4.343 / 39.6, rel=1e-4)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        track_decay_rate(exponential(1.0, position), position)


@given(st.floats(0.3, 10.0), st.floats(0.4, 0.8), st.floats(0.1, 10.0))
def test_scaling_lengths_scales_the_rate(rate, bay, factor):
    position = grid_positions(bay)
    response = exponential(rate, position)
    one = track_decay_rate(response, position, warn=False)["decay_rate"].values
    two = track_decay_rate(response, factor * position, warn=False)["decay_rate"].values
    assert two == pytest.approx(one / factor, rel=1e-9)


GRID = grid_positions()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: grid_positions(0.0), "bay_m: must be finite and above zero"),
        (lambda: grid_intervals([0.1, 0.6]), "position_m: must begin at the accelerometer"),
        (lambda: grid_intervals([0.0, 0.6, 0.6]), "position_m: must begin at the accelerometer, 0 m, and ascend"),
        (lambda: track_decay_rate(np.ones((3, 2)), GRID), r"response: shape \(3, 2\) for 29 positions"),
        (lambda: track_decay_rate(np.where(GRID > 1.0, np.nan, 1.0), GRID), r"response\[7\]: not finite"),
        (lambda: track_decay_rate(np.where(GRID > 1.0, 1.0, 0.0), GRID), r"response\[0, 0\]: zero at the accel"),
        (lambda: track_decay_rate(np.exp(-GRID), GRID, variance=-np.ones(29)), "variance: must not be negative"),
        (
            lambda: track_decay_rate(np.exp(-GRID), GRID, variance=np.ones(29), take_off_noise=True),
            r"response\[0\]: nothing but noise",
        ),
        (lambda: band_response(np.ones((2, 3)), [100.0, 110.0, 130.0]), "frequency_Hz: must ascend in equal"),
        (lambda: band_response(np.ones((2, 3)), [100.0, 101.0, 102.0]), "do not cover a band"),
        (lambda: band_response(np.ones((2, 3)), [100.0, 200.0, 300.0], to_Hz=800.0), "do not cover a band"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(InputError, match=message):
        call()
