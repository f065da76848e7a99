"""Components tied to distance: amplitudes, intervals, false alarms, resampling."""

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.estimates.orders import component_levels, resample_to_distance, travelled, wheel_orders
from scipy import signal, stats

RATE = 1000.0
DIAMETER_M = 0.86


def speeding(samples, first=30.0, last=60.0):
    return travelled(np.linspace(first, last, samples), sampling_Hz=RATE)


def test_wheel_orders():
    """At 300 km/h a wheel of 0.86 m turns 30.8 times a second, and 20 polygon waves pass at 617 Hz."""
    wavelength = wheel_orders(DIAMETER_M, [1, 20])
    assert 300.0 / 3.6 / wavelength == pytest.approx([30.84, 616.9], abs=0.05)
    assert travelled(20.0, sampling_Hz=RATE, samples=101)[-1] == pytest.approx(2.0)


@pytest.mark.parametrize("constant", [True, False])
def test_amplitude_and_phase_without_noise(constant):
    """Two components, amplitudes 0.7 and 0.2, whatever the speed does."""
    distance = speeding(4000, last=30.0 if constant else 60.0)
    wavelength = np.array([0.6, wheel_orders(DIAMETER_M, [3])[0]])
    record = 0.7 * np.cos(2 * np.pi * distance / wavelength[0] + 0.4)
    record = record + 0.2 * np.cos(2 * np.pi * distance / wavelength[1] - 1.0)
    data = component_levels(record, distance, wavelength, sampling_Hz=RATE, units="m/s^2")
    amplitude = data["amplitude"].values[0]
    # All that disturbs is the other component and the mirror images, through the far sidelobes of the tapers.
    tapers = signal.windows.dpss(4000, 4.0, 5)
    weight = np.sum(tapers * tapers.sum(axis=1, keepdims=True), axis=0) / np.sum(tapers[::2].sum(axis=1) ** 2)
    sidelobe = np.abs(np.fft.rfft(weight, 16 * 4000))[16 * 60 :].max()
    assert sidelobe < 3e-4
    assert amplitude == pytest.approx(
        [0.7 * np.exp(0.4j), 0.2 * np.exp(-1j)], abs=sidelobe * (0.7 + 0.7 + 0.2 + 0.2)
    )
    assert data["rms"].values[0] == pytest.approx(np.abs(amplitude) / 2**0.5)
    assert data["probability"].values.max() < 1e-12
    assert data["separate"].values.all()
    assert data["frequency_high_Hz"].values[0] == pytest.approx((30.0 if constant else 60.0) / 0.6, rel=1e-3)


def coloured(rng, count, samples):
    """Noise over 20 dB of level."""
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1.0 / RATE)
    root = np.sqrt((0.01 + 1.0 / (1.0 + (frequency / 50.0) ** 2)) * RATE * period / 4.0)
    draw = rng.standard_normal((2, count, frequency.size))
    return np.fft.irfft((draw[0] + 1j * draw[1]) * root, period, axis=1)[:, :samples]


def test_false_alarms_are_as_stated():
    """Noise alone, 600 records at a varying speed: the probability of the F-test is uniform."""
    rng, distance = np.random.default_rng(21), speeding(3000)
    wavelength = wheel_orders(DIAMETER_M, [1, 3, 5])
    data = component_levels(coloured(rng, 600, 3000), distance, wavelength, sampling_Hz=RATE)
    for column in range(3):
        assert stats.kstest(data["probability"].values[:, column], "uniform").pvalue > 0.001
    assert np.mean(data["probability"].values < 0.05) == pytest.approx(0.05, abs=0.016)


def test_intervals_cover():
    """A component 3 dB above to 25 dB above its own error, 600 records each: 95 % intervals of its rms."""
    rng, distance = np.random.default_rng(22), speeding(3000)
    wavelength = wheel_orders(DIAMETER_M, [4])
    noise = coloured(rng, 600, 3000)
    shares = []
    for amplitude in (0.2, 0.6, 2.0):
        record = noise + amplitude * np.cos(2 * np.pi * distance / wavelength[0] + 1.0)
        data = component_levels(record, distance, wavelength, sampling_Hz=RATE)
        truth = amplitude / 2**0.5
        shares.append(float(((data["rms_low"] <= truth) & (truth <= data["rms_high"])).mean()))
    # 600 records: a share of 0.95 is known to 0.009.
    assert np.mean(shares) == pytest.approx(0.95, abs=0.02)
    assert min(shares) > 0.92


def test_neighbours_within_the_tapers_band_are_marked():
    distance = travelled(30.0, sampling_Hz=RATE, samples=2000)
    data = component_levels(np.cos(distance), distance, [0.6, 0.62, 0.3], sampling_Hz=RATE)
    assert list(data["separate"].values) == [False, False, True]
    assert data.half_band_Hz == pytest.approx(2.0)


def test_resampled_to_distance():
    """A chirp in time is a sine in distance; against the sine itself, away from the ends."""
    distance = speeding(4000, first=20.0, last=35.0)
    record = np.stack([np.sin(2 * np.pi * distance / 0.25), np.cos(2 * np.pi * distance / 1.7)])
    found = resample_to_distance(record, distance, step_m=0.02)
    place = distance[0] + 0.02 * np.arange(found.shape[1])
    assert place[-1] <= distance[-1] < place[-1] + 0.02
    inside = slice(100, -100)
    assert found[0, inside] == pytest.approx(np.sin(2 * np.pi * place / 0.25)[inside], abs=3e-3)
    assert found[1, inside] == pytest.approx(np.cos(2 * np.pi * place / 1.7)[inside], abs=3e-3)


def test_coarse_steps_do_not_alias():
    """At steps of 0.2 m a wavelength of 0.25 m cannot be held, and must not appear as another."""
    distance = speeding(6000, first=20.0, last=35.0)
    record = np.sin(2 * np.pi * distance / 0.25) + np.sin(2 * np.pi * distance / 4.0)
    found = resample_to_distance(record, distance, step_m=0.2)[0]
    place = 0.2 * np.arange(found.size)
    inside = slice(40, -40)
    assert found[inside] == pytest.approx(np.sin(2 * np.pi * place / 4.0)[inside], abs=0.02)


STEADY = travelled(30.0, sampling_Hz=RATE, samples=1000)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: travelled([30.0, 0.0, 20.0], sampling_Hz=RATE), r"speed_m_per_s\[1\]: must be above zero"),
        (lambda: travelled(30.0, sampling_Hz=RATE), "samples: needed with a constant speed"),
        (lambda: wheel_orders(-1.0, [1]), "diameter_m: must be finite and above zero"),
        (lambda: wheel_orders(0.9, [0]), "orders: must be above zero"),
        (lambda: component_levels(np.ones(999), STEADY, [0.6], sampling_Hz=RATE), "1000 distances for 999"),
        (
            lambda: component_levels(np.ones(1000), -STEADY, [0.6], sampling_Hz=RATE),
            r"distance_m\[1\]: must ascend",
        ),
        (
            lambda: component_levels(np.ones(1000), STEADY, [0.05], sampling_Hz=RATE),
            r"wavelength_m\[0\]: 600 to 600",
        ),
        (lambda: component_levels(np.ones(1000), STEADY, [60.0], sampling_Hz=RATE), "lies outside 4 to 496 Hz"),
        (lambda: component_levels(np.full(1000, np.nan), STEADY, [0.6], sampling_Hz=RATE), r"record\[0, 0\]: not"),
        (lambda: component_levels(np.ones(10), STEADY[:10], [0.6], sampling_Hz=RATE), "10 samples are too few"),
        (lambda: resample_to_distance(np.ones(1000), STEADY, step_m=10.0), "step_m: fewer than ten steps"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(InputError, match=message):
        call()
