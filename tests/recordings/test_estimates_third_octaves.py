"""One-third octaves: the standard's numbers and mask, band powers, the filter bank over time."""

import numpy as np
import pytest
from permway.errors import InputError
from permway.recordings.estimates.bands import Bands, band_of, bands_between, bands_within, class1_limits
from permway.recordings.estimates.filter_bank import band_filter, band_levels_over_time
from permway.recordings.estimates.third_octaves import band_levels
from permway.recordings.estimates.welch import cross_spectra
from scipy import signal

IEC_1995_CLASS_1 = (
    # octaves, least, greatest attenuation dB: IEC 61260:1995, table 1, everywhere narrower than the 2014 edition's
    (0.0, -0.3, 0.3),
    (1 / 8, -0.3, 0.4),
    (1 / 4, -0.3, 0.6),
    (3 / 8, -0.3, 1.3),
    (1 / 2, -0.3, 5.0),
    (1 / 2, 2.0, np.inf),
    (1.0, 17.5, np.inf),
    (2.0, 42.0, np.inf),
    (3.0, 61.0, np.inf),
    (4.0, 70.0, np.inf),
)


def test_frequencies_of_the_standard():
    """IEC 61260-1:2014: exact mid-band frequencies to five figures, and nominal ones."""
    bands = bands_between(100.0, 1000.0)
    exact = [100.0, 125.89, 158.49, 199.53, 251.19, 316.23, 398.11, 501.19, 630.96, 794.33, 1000.0]
    assert bands.middle_Hz == pytest.approx(exact, rel=5e-5)
    nominal = [100.0, 125.0, 160.0, 200.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0, 1000.0]
    assert bands.nominal_Hz == pytest.approx(nominal)
    assert bands.label[-1] == "1k"
    assert bands_between(0.8, 3.15).label == ["0.8", "1", "1.25", "1.6", "2", "2.5", "3.15"]
    assert [band_of(f) for f in (1.25, 3.15, 31.5, 1250.0, 8000.0)] == [1, 5, 15, 31, 39]


def test_bands_meet_and_are_a_third_of_an_octave():
    bands = bands_between(1.0, 5000.0)
    assert bands.high_Hz[:-1] == pytest.approx(bands.low_Hz[1:])
    assert bands.high_Hz / bands.low_Hz == pytest.approx(np.full(bands.number.size, 10.0**0.1))
    assert bands.middle_Hz[3:] / bands.middle_Hz[:-3] == pytest.approx(10.0**0.3)
    assert list(bands_within(bands.low_Hz[4], bands.high_Hz[9]).number) == list(bands.number[4:10])


def test_breakpoints_of_one_third_octaves():
    """As the standard lists them for one-third octaves, to five decimals."""
    printed = [1.02667, 1.05575, 1.08746, 1.12202, 1.29437, 1.88173, 3.05365, 5.39195]
    low, high = class1_limits(np.array(printed) * (1.0 + 1e-6))
    assert low[4:] == pytest.approx([16.6, 40.5, 60.0, 70.0], abs=1e-3)
    assert high[:3] == pytest.approx([0.5, 0.7, 1.4], abs=1e-3)
    assert np.isinf(high[3:]).all()
    above, below = class1_limits(printed), class1_limits(1.0 / np.array(printed))
    assert np.array(above) == pytest.approx(np.array(below))


@pytest.mark.parametrize("share", [1e-4, 0.003, 0.03, 0.2, 0.31])
def test_filters_keep_the_stricter_mask_of_1995(share):
    """From 1e-4 to 0.31 of the sampling rate. The mask's form is checked above; the table here is another's."""
    number = round(10.0 * np.log10(share * 1e5))
    middle = 10.0 ** (number / 10.0)
    table = np.array(IEC_1995_CLASS_1)
    growth = 10.0**0.3
    shrink = (growth ** (1.0 / 6.0) - 1.0) / (growth**0.5 - 1.0)
    points = np.log(1.0 + shrink * (growth ** table[:, 0] - 1.0))
    off = np.linspace(-3.0, 3.0, 4001)
    ratio = np.exp(off)[np.exp(off) * middle < 0.49e5]
    _, response = signal.sosfreqz(band_filter(number, 1e5), ratio * middle, fs=1e5)
    attenuation = -20.0 * np.log10(np.abs(response))
    distance = np.abs(np.log(ratio))
    passing = distance < points[4]
    assert np.all(attenuation >= -0.3)
    assert np.all(attenuation[passing] <= np.interp(distance[passing], points[:5], table[:5, 2]))
    assert np.all(attenuation[~passing] >= np.interp(distance[~passing], points[5:], table[5:, 1]))


def test_a_flat_spectrum_by_band():
    """A constant density gives density times width, to rounding, whatever part of a line an edge cuts."""
    data = cross_spectra(np.random.default_rng(0).standard_normal(8192), sampling_Hz=1000.0, segment_s=1.024)
    data["psd"][:] = 3.0
    bands = band_levels(data, reference=1.0)
    assert bands["power"].values[0] == pytest.approx(3.0 * (bands["high_Hz"] - bands["low_Hz"]).values)
    assert bands["level_dB"].values == pytest.approx(10.0 * np.log10(bands["power"].values))
    assert bands["lines"].values.min() >= 3.0
    assert bands["high_Hz"].values[-1] <= 500.0
    # Many lines: 2 B T degrees of freedom, less the uneven weight under Hann windows, 18/19, and ends.
    last = bands.isel(band=-1)
    product = float(last["high_Hz"] - last["low_Hz"]) * 8.192
    assert float(last["degrees_of_freedom"][0]) == pytest.approx(2.0 * product * 18 / 19, rel=0.08)


def test_one_line_rules_its_band():
    """With all power in one line the band has that line's degrees of freedom, 2 K."""
    data = cross_spectra(np.random.default_rng(0).standard_normal(60_000), sampling_Hz=1000.0, segment_s=1.0)
    data["psd"][:] = 1e-12
    data["psd"][0, 160] = 1.0
    bands = band_levels(data, reference=1e-6, from_Hz=160.0, to_Hz=160.0)
    assert float(bands["degrees_of_freedom"][0, 0]) == pytest.approx(2.0 * data.averages, rel=1e-6)
    assert float(bands["level_dB"][0, 0]) == pytest.approx(120.0, abs=1e-4)


def test_filter_bank_covers():
    """Stationary coloured noise: 95 % intervals of mean squares over 0.5 s hold, 400 records, 40 to 200 Hz."""
    rng = np.random.default_rng(9)
    period, rate = 4096, 1000.0
    frequency = np.fft.rfftfreq(period, 1.0 / rate)
    density = 1.0 / (1.0 + (frequency / 80.0) ** 2)
    draw = rng.standard_normal((2, 400, frequency.size)) * np.sqrt(density * rate * period / 4.0)
    record = np.fft.irfft(draw[0] + 1j * draw[1], period, axis=1)[:, :2500]
    data = band_levels_over_time(
        record, sampling_Hz=rate, from_Hz=40.0, to_Hz=200.0, interval_s=0.5, reference=1.0
    )
    truth = []
    for number in range(16, 24):
        _, response = signal.sosfreqz(band_filter(number, rate), frequency, fs=rate)
        truth.append(np.sum(density * np.abs(response) ** 2) * rate / period)
    level = 10.0 * np.log10(np.array(truth))[None, :, None]
    inside = (data["low_dB"].values <= level) & (level <= data["high_dB"].values)
    settled = np.broadcast_to(data["settled"].values, inside.shape)
    assert not data["settled"].values[:, 0].any()
    assert data["settled"].values[:, 1:].all()
    assert 0.93 <= inside[settled].mean() <= 0.97
    width = (data["high_Hz"] - data["low_Hz"]).values
    # (int 1/(1+x^6))^2 / int 1/(1+x^6)^2 = (pi/3)^2 / (5 pi/18) = 2 pi / 5, and more while B T is small.
    assert data["degrees_of_freedom"].values[-1] / (2.0 * width[-1] * 0.5) == pytest.approx(0.4 * np.pi, rel=0.02)
    # Nominally -3 dB at the edges: the filter's own power differs from the band's by less than a tenth of a dB.
    assert data["power"].values[..., 1:].mean(axis=(0, 2)) == pytest.approx(np.array(truth), rel=0.05)


def test_a_pass_by_rises_and_falls():
    time = np.arange(8000) / 1000.0
    loud = np.exp(-(((time - 4.0) / 1.0) ** 2))
    tone = loud * np.sqrt(2.0) * np.cos(2 * np.pi * 100.0 * time)
    data = band_levels_over_time(
        tone, sampling_Hz=1000.0, from_Hz=63.0, to_Hz=160.0, interval_s=0.25, reference=1e-3
    )
    level = data["level_dB"].sel(band=100.0).values[0]
    assert level.max() == pytest.approx(60.0, abs=0.15)
    assert float(data["time"][level.argmax()]) == pytest.approx(4.0, abs=0.26)
    assert level[4] < 30.0
    assert np.all(data["level_dB"].sel(band=160.0).values[0][8:24] < level[8:24] - 16.6)


def white(samples=4000):
    return np.random.default_rng(1).standard_normal(samples)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"from_Hz": 5.0, "to_Hz": 50.0}, "does not resolve this band .*'5 Hz'.*segments of 2.59 s or longer"),
        ({"to_Hz": 500.0}, "does not resolve this band .*'500 Hz'"),
        ({"from_Hz": 200.0, "to_Hz": 100.0}, "ends before it begins"),
        ({"reference": 0.0}, "reference: must be finite and above zero"),
    ],
)
def test_bands_that_cannot_be_had(options, message):
    data = cross_spectra(white(), sampling_Hz=1000.0, segment_s=0.5)
    with pytest.raises(InputError, match=message):
        band_levels(data, **{"reference": 1.0, **options})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"to_Hz": 500.0}, "no class 1 filter for the band of 500 Hz"),
        ({"from_Hz": 1e-5}, "no class 1 filter for the band of 1e-05 Hz"),
        ({"interval_s": 10.0}, "interval_s: 4000 samples do not fill"),
        ({"interval_s": 1e-5}, "interval_s: 4000 samples do not fill"),
    ],
)
def test_filters_that_cannot_be_had(options, message):
    usual = {"from_Hz": 100.0, "to_Hz": 200.0, "interval_s": 0.5, "reference": 1.0, "sampling_Hz": 1000.0}
    with pytest.raises(InputError, match=message):
        band_levels_over_time(white(), **{**usual, **options})
    with pytest.raises(InputError, match=r"record\[0, 7\]: not finite"):
        band_levels_over_time(np.where(np.arange(4000) == 7, np.nan, white()), **usual)


def test_weights_share_a_cell_between_bands():
    bands = Bands(number=np.array([19, 20]))
    edge = bands.high_Hz[0]
    share = bands.weights(np.array([edge - 1.0, edge + 3.0]))
    assert share[:, 0] == pytest.approx([0.25, 0.75])
