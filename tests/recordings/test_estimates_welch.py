"""Power and cross spectra against scipy.signal, closed forms and published values."""

import h5py
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from permway.errors import InputError
from permway.recordings.estimates import welch
from permway.recordings.estimates.smearing import through_window
from permway.recordings.estimates.stationarity import stationarity
from permway.recordings.estimates.welch import cross_spectra
from permway.recordings.estimates.windows import independent_lines, segment_for_peak, segments
from scipy import signal, stats

RATE = 1000.0


def noise(shape, seed=0):
    return np.random.default_rng(seed).standard_normal(shape)


@pytest.mark.parametrize("length", [256, 255])
@pytest.mark.parametrize("window", ["hann", "boxcar", "blackman"])
def test_agrees_with_scipy(length, window):
    record = noise((3, 5000))
    record[1] += 0.5 * record[0] + 3.0
    data = cross_spectra(record, sampling_Hz=RATE, segment_s=length / RATE, window=window)
    frequency, psd = signal.welch(record, RATE, window=window, nperseg=length, noverlap=length - data.step_samples)
    assert data["frequency"].values == pytest.approx(frequency)
    assert data["psd"].values == pytest.approx(psd, rel=1e-10, abs=1e-15)
    _, cross = signal.csd(
        record[0], record[1], RATE, window=window, nperseg=length, noverlap=length - data.step_samples
    )
    # scipy's is E[conj(X) Y], ours E[X_channel conj(X_channel2)].
    assert data["csd"].values[1, 0] == pytest.approx(cross, rel=1e-10, abs=1e-15)
    assert data["csd"].values == pytest.approx(data["csd"].values.conj().transpose(1, 0, 2))


def test_power_is_that_of_the_record():
    """Without window and overlap the lines add up to the mean square (Parseval)."""
    record = noise((2, 4096))
    data = cross_spectra(record, sampling_Hz=RATE, segment_s=0.512, window="boxcar", overlap=0.0, detrend=False)
    total = data["psd"].sum("frequency").values * data.resolution_Hz
    assert total == pytest.approx(np.mean(record**2, axis=1), rel=1e-12)


def test_a_sine_on_a_line():
    """A cos(2 pi f t) on a line: A^2/2 over the equivalent noise bandwidth of 1.5 lines, 0.25 of it beside."""
    time = np.arange(8000) / RATE
    data = cross_spectra(3.0 * np.cos(2 * np.pi * 100.0 * time), sampling_Hz=RATE, segment_s=0.5)
    psd = data["psd"].values[0]
    line = 50
    assert psd[line] == pytest.approx(4.5 / (1.5 * 2.0), rel=1e-12)
    assert psd[line - 1 : line + 2] / psd[line] == pytest.approx([0.25, 1.0, 0.25], rel=1e-9)
    assert psd[line + 3 : line + 20].max() < 1e-20


def test_effective_averages_by_published_values():
    """Harris 1978, table 1: overlap correlation at 50 % is 0.167 for Hann, 0.5 for the rectangle."""
    for window, rho in (("hann", 1.0 / 6.0), ("boxcar", 0.5)):
        layout = segments(64 * 513, sampling_Hz=1.0, segment_s=1024.0, window=window)
        n = layout.count
        assert layout.averages == pytest.approx(n / (1.0 + 2.0 * (1.0 - 1.0 / n) * rho**2), rel=1e-4)


def test_neighbouring_lines_of_a_hann_window():
    """Its transform is (-1/4, 1/2, -1/4): lines correlate by 2/3 and 1/6 in amplitude, squared in power."""
    single = segments(512, sampling_Hz=1.0, segment_s=512.0).line_covariance(4)
    assert single == pytest.approx([1.0, 4.0 / 9.0, 1.0 / 36.0, 0.0, 0.0], abs=1e-12)
    many = segments(512 * 200, sampling_Hz=1.0, segment_s=512.0).line_covariance(4)
    assert many[1] / many[0] == pytest.approx(0.45, abs=0.015)
    # Over a wide band the record's own length is left, 2 B T degrees of freedom, but for the uneven weight of the
    # samples, sin^4 + cos^4 under half-overlapped windows: mean^2 / mean square = (9/16) / (9/16 + 1/32).
    layout = segments(512 * 200, sampling_Hz=1.0, segment_s=512.0)
    covariance = layout.line_covariance(60)
    lines = independent_lines(covariance, np.ones(10_000))
    assert lines / covariance[0] == pytest.approx(10_000 * 200 * 18 / 19, rel=0.005)


def test_variance_and_covariance_of_white_noise():
    """The variance of a line's power is 1/K of its square, at the ends 2/K; neighbours covary as stated."""
    record = noise((3000, 64 * 6), seed=2)
    layout = segments(64 * 6, sampling_Hz=1.0, segment_s=64.0)
    cut = np.lib.stride_tricks.sliding_window_view(record, 64, axis=1)[:, :: layout.step]
    power = np.mean(np.abs(np.fft.rfft(cut * layout.window)) ** 2, axis=1)
    power /= power.mean(axis=0)
    relative = power.var(axis=0)
    expected = 2.0 / layout.degrees_of_freedom()
    # 3000 records: a variance is known to 2.6 % or, for so skewed a law, a little more; 33 lines are looked at.
    assert relative == pytest.approx(expected, rel=0.15)
    assert relative[3:-3].mean() == pytest.approx(1.0 / layout.averages, rel=0.02)
    beside = np.mean((power[:, 3:-4] - 1.0) * (power[:, 4:-3] - 1.0))
    assert beside == pytest.approx(layout.line_covariance(1)[1], rel=0.03)


@given(st.integers(8, 64), st.integers(1, 30), st.floats(0.0, 0.9))
def test_averages_never_exceed_segments_nor_fall_below_one(length, extra, overlap):
    layout = segments(length + 7 * extra, sampling_Hz=1.0, segment_s=float(length), overlap=overlap)
    assert 1.0 - 1e-9 <= layout.averages <= layout.count + 1e-9
    assert (layout.count - 1) * layout.step + length <= length + 7 * extra


def test_reading_piece_by_piece_changes_nothing(tmp_path, monkeypatch):
    record = noise((2, 20_000))
    whole = cross_spectra(record, sampling_Hz=RATE, segment_s=0.25)
    monkeypatch.setattr(welch, "_CHUNK", 3000)
    with h5py.File(tmp_path / "record.h5", "w") as file:
        file["record"] = record
    with h5py.File(tmp_path / "record.h5") as file:
        pieces = cross_spectra(file["record"], sampling_Hz=RATE, segment_s=0.25)
    assert pieces["csd"].values == pytest.approx(whole["csd"].values, rel=1e-12)


def test_names_and_units_of_a_labelled_record():
    record = xr.DataArray(noise((800, 2)), dims=("time", "channel"), coords={"channel": ["a", "b"]})
    data = cross_spectra(record.assign_attrs(units="m/s^2"), sampling_Hz=RATE, segment_s=0.1)
    assert list(data["channel"].values) == ["a", "b"]
    assert list(data["unit"].values) == ["m/s^2", "m/s^2"]
    assert list(data["usable"].values[:4]) == [False, False, True, True]
    assert all("units" in data[name].attrs for name in data.data_vars)


def broken(record):
    record[1, 700] = np.nan
    return record


@pytest.mark.parametrize(
    ("record", "options", "message"),
    [
        (broken(noise((2, 2000))), {}, r"record\[1, 700\]: not finite"),
        (noise((2, 50)), {}, "record: 50 samples are shorter than one segment of 100"),
        (noise((2, 2, 2)), {}, r"record: must be \(channel, sample\)"),
        (np.zeros((0, 10)), {}, "record: is empty"),
        (noise(2000) + 1j, {}, "record: must be real"),
        (["a", "b"], {}, "record: not a number or an array of numbers"),
        (noise((2, 2000)), {"channels": ["a", "a"]}, "channels: a channel named twice"),
        (noise((2, 2000)), {"units": ["m"]}, r"units: 1 unit\(s\) for 2"),
        (noise(2000), {"overlap": 1.0}, "overlap: must lie in"),
        (noise(2000), {"window": "hat"}, "window: unknown window"),
        (noise(2000), {"window": np.ones(3)}, "window: 3 values for a segment of 100"),
        (noise(2000), {"sampling_Hz": 0.0}, "sampling_Hz: must be finite and above zero"),
        (noise(2000), {"segment_s": 0.001}, r"segment_s: is 1 sample\(s\)"),
    ],
)
def test_bad_records(record, options, message):
    with pytest.raises(InputError, match=message):
        cross_spectra(record, **{"sampling_Hz": RATE, "segment_s": 0.1, **options})


def test_through_a_window():
    """White stays white; a resonance loses 4/3 (1 / (B T))^2 at its peak, to first order."""
    fine = np.arange(0.0, 200.0, 0.02)
    at = np.array([60.0, 100.0])
    assert through_window(fine, np.full(fine.size, 2.0), at, segment_s=2.0) == pytest.approx(2.0)
    width = 10.0
    peak = 1.0 / (1.0 + (2.0 * (fine - 100.0) / width) ** 2)
    for segment in (1.0, 2.0):
        lost = 1.0 - through_window(fine, peak, at, segment_s=segment)[1].real
        # The next order of a Lorentzian is a share 4 (2 / (B T))^2 of the first or less.
        assert lost == pytest.approx(4.0 / 3.0 / (width * segment) ** 2, rel=0.16 / segment**2)
    assert 4.0 / 3.0 / (width * segment_for_peak(width, 25.0)) ** 2 == pytest.approx(0.3 / 5.0)


def test_welch_gives_in_the_mean_what_the_window_shows():
    """Over 400 records a peak four lines wide is biased, and by as much as stated."""
    rng, length, period = np.random.default_rng(6), 128, 2048
    frequency = np.fft.rfftfreq(period, 1.0 / RATE)
    density = 1.0 / (1.0 + (2.0 * (frequency - 250.0) / 30.0) ** 2) + 1e-3
    draw = rng.standard_normal((2, 400, frequency.size)) * np.sqrt(density * RATE * period / 4.0)
    record = np.fft.irfft(draw[0] + 1j * draw[1], period, axis=1)
    mean = cross_spectra(record, sampling_Hz=RATE, segment_s=length / RATE)["psd"].mean("channel").values
    fine = np.arange(0.0, 500.0, 1.0)
    smooth = 1.0 / (1.0 + (2.0 * (fine - 250.0) / 30.0) ** 2) + 1e-3
    lines = np.arange(20, 45) * RATE / length
    seen = through_window(fine, smooth, lines, segment_s=length / RATE).real
    # 400 records of some 30 averages: 0.9 % of one standard error.
    assert mean[20:45] / seen == pytest.approx(np.ones(25), abs=0.035)
    assert np.interp(250.0, lines, seen) < 0.95


def test_stationarity_probabilities_are_uniform_for_coloured_noise():
    """2000 stationary records: Kolmogorov and Smirnov find nothing; the runs test, discrete, has at most 5 %."""
    record = signal.lfilter([1.0], [1.0, -1.2, 0.8], noise((2000, 4096), seed=3), axis=1)[:, 96:]
    found = stationarity(record, sampling_Hz=RATE, segment_s=0.2)
    assert stats.kstest(found.spread_probability, "uniform").pvalue > 0.001
    assert np.mean(found.runs_probability < 0.05) < 0.07
    assert np.mean(found.spread_probability < 0.05) == pytest.approx(0.05, abs=0.015)


def test_bursts_and_drifts_are_seen():
    record = noise((2, 20_000), seed=5)
    record[0, 9000:10_000] *= 2.0
    record[1] *= np.linspace(1.0, 1.5, 20_000)
    found = stationarity(record, sampling_Hz=RATE, segment_s=0.2)
    assert found.spread_probability.max() < 1e-6
    assert found.runs_probability[1] < 1e-3
    with pytest.raises(InputError, match="too few to compare"):
        stationarity(record, sampling_Hz=RATE, segment_s=5.0)
    with pytest.raises(InputError, match=r"record\[1\]: has no power"):
        stationarity(record * [[1.0], [0.0]], sampling_Hz=RATE, segment_s=0.2)
