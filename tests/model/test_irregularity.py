"""Irregularity: printed values, conversions that keep the variance, ranges, and refusals."""

import tomllib
import warnings

import numpy as np
import pytest
import scipy.integrate
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError
from permway.model.irregularity import (
    CHINESE_LIMITS_PER_M,
    CHINESE_SEGMENTS,
    AnyIrregularity,
    ChineseBallastless,
    DensityTable,
    Fra,
    GermanHigh,
    GermanLow,
    GermanSato,
    Iso3095,
    RangeWarning,
    RoughnessTable,
    Sato,
)
from permway.model.roughness import ISO3095_LIMIT_DB
from pydantic import TypeAdapter

SPEED = 350.0 / 3.6
AT_100_M, AT_1_M = 2 * np.pi / 100.0, 2 * np.pi
TABLE = DensityTable(wavenumber_rad_per_m=(0.1, 1.0, 10.0), density_m2_per_rad_per_m=(1e-5, 1e-7, 1e-10))
ROUGHNESS = RoughnessTable(wavelength_m=(0.1, 0.08, 0.063), level_dB=(10.0, 5.0, 0.0))
ALL = [
    GermanLow(),
    GermanLow(form="paper_eq28"),
    GermanHigh(),
    Sato(),
    GermanSato(form="paper_eq28"),
    GermanSato(continuous=True),
    ChineseBallastless(),
    Fra(track_class=6),
    Iso3095(),
    Iso3095(interpolation="smooth"),
    ROUGHNESS,
    TABLE,
]
named = pytest.mark.parametrize("irregularity", ALL, ids=lambda one: one.type)


def valid_band(irregularity):
    shortest, longest = irregularity.valid_wavelength_m
    return 2 * np.pi / longest, 2 * np.pi / shortest


def partial_fraction_variance(amplitude, low, high, c=0.8246, r=0.0206):
    """Closed form of the German variance: A c^2/(c^2-r^2) [atan(W/r)/r - atan(W/c)/c]."""

    def primitive(w):
        return np.arctan(w / r) / r - np.arctan(w / c) / c

    return amplitude * c**2 / (c**2 - r**2) * (primitive(high) - primitive(low))


@pytest.mark.parametrize(("irregularity", "amplitude"), [(GermanLow(), 4.032e-7), (GermanHigh(), 1.08e-6)])
def test_german_variance_from_1_to_100_m(irregularity, amplitude):
    # the quadrature in log W is smooth, so 1e-9 is its own accuracy
    value, _ = scipy.integrate.quad(
        lambda u: float(irregularity.wavenumber_density(np.exp(u))) * np.exp(u),
        np.log(AT_100_M) + 1e-12,
        np.log(AT_1_M) - 1e-12,
        epsrel=1e-11,
    )
    assert value == pytest.approx(partial_fraction_variance(amplitude, AT_100_M, AT_1_M), rel=1e-9)
    if amplitude == 4.032e-7:
        assert np.sqrt(value) == pytest.approx(2.33e-3, rel=0.01)


def test_german_low_values_by_hand():
    w = np.array([0.1, 1.0, 3.0])
    right = 4.032e-7 * 0.8246**2 / ((w**2 + 0.0206**2) * (w**2 + 0.8246**2))
    printed = 4.032e-7 * 0.8246**2 / ((w**2 + 0.0206**2) * (w**2 + 0.4380**2))
    assert GermanLow().wavenumber_density(w) == pytest.approx(right, rel=1e-14)
    assert GermanLow(form="paper_eq28").wavenumber_density(w) == pytest.approx(printed, rel=1e-14)
    assert GermanHigh().wavenumber_density(w) == pytest.approx(right * 10.80 / 4.032, rel=1e-14)


def test_paper_eq28_is_for_the_low_disturbance():
    with pytest.raises(InputError, match="low disturbance only"):
        GermanHigh(form="paper_eq28")
    GermanHigh(form="paper_eq28", w_s_rad_per_m=0.4380)
    with pytest.raises(InputError, match="w_s_rad_per_m has no place"):
        GermanLow(w_s_rad_per_m=0.4380)


def test_the_paper_conversion_is_larger_by_v_over_2_pi():
    frequency = np.array([1.0, 10.0, 90.0])
    irregularity = GermanLow(form="paper_eq28")
    called = irregularity.density(frequency, SPEED, "wavenumber_density_called_per_hertz")
    true = irregularity.density(frequency, SPEED)
    assert called / true == pytest.approx(np.full(3, 15.47), rel=1e-3)
    assert called == pytest.approx(irregularity.wavenumber_density(2 * np.pi * frequency / SPEED))


def test_sato_takes_over_at_97_2_hz_at_350_km_h():
    irregularity = GermanSato(form="paper_eq28")
    below, above = irregularity.density([97.2, 97.3], SPEED)
    assert below == pytest.approx(float(GermanLow(form="paper_eq28").density(97.2, SPEED)))
    assert above == pytest.approx(float(Sato().density(97.3, SPEED)))
    assert 1.2 < above / below < 1.5
    at_one_metre = irregularity.wavenumber_density(AT_1_M)
    assert at_one_metre == pytest.approx(float(GermanLow(form="paper_eq28").wavenumber_density(AT_1_M)))


def test_continuous_composite_has_no_jump_and_keeps_satos_slope():
    irregularity = GermanSato(continuous=True, crossover_wavelength_m=0.8)
    crossover = 2 * np.pi / 0.8
    below, above, far = irregularity.wavenumber_density(crossover * np.array([1 - 1e-7, 1 + 1e-7, 10]))
    assert above == pytest.approx(below, rel=1e-5)
    assert above / far == pytest.approx(10**3.06, rel=1e-5)


def test_sato_value_by_hand():
    assert Sato().wavenumber_density(20.0) == pytest.approx(6.5e-8 / 20.0**3.06, rel=1e-14)


def test_chinese_segments_meet_at_the_printed_limits():
    """The standard prints coefficients to five digits and limits to four: they meet within 0.5 %."""
    for limit, (a, k), (b, m) in zip(CHINESE_LIMITS_PER_M, CHINESE_SEGMENTS, CHINESE_SEGMENTS[1:], strict=False):
        assert a / limit**k == pytest.approx(b / limit**m, rel=0.005)
        edge = 2 * np.pi * limit * np.array([1 - 1e-9, 1 + 1e-9])
        below, above = ChineseBallastless().wavenumber_density(edge)
        assert above == pytest.approx(below, rel=0.005)


def test_chinese_value_by_hand():
    """At 10 m, f = 0.1 1/m: third segment, 1.9784e-2 / 0.1^1.3643 mm^2/(1/m)."""
    expected = 1e-6 * 1.9784e-2 * 10**1.3643 / (2 * np.pi)
    assert ChineseBallastless().wavenumber_density(2 * np.pi * 0.1) == pytest.approx(expected, rel=1e-12)
    # a ballastless high-speed line is smoother than the German low disturbance from 2 to 30 m
    w = 2 * np.pi / np.array([2.5, 10.0, 30.0])
    assert np.all(ChineseBallastless().wavenumber_density(w) < GermanLow().wavenumber_density(w))


def test_fra_classes():
    """A_v in cm^2 rad/m, classes 1 to 6: 1.2107, 1.0181, 0.6816, 0.5376, 0.2095, 0.0339; k = 0.25."""
    amplitudes = [1.2107, 1.0181, 0.6816, 0.5376, 0.2095, 0.0339]
    w = 0.5
    for track_class, amplitude in enumerate(amplitudes, start=1):
        expected = 0.25 * amplitude * 1e-4 * 0.8245**2 / ((w**2 + 0.8245**2) * w**2)
        assert Fra(track_class=track_class).wavenumber_density(w) == pytest.approx(expected, rel=1e-13)
    for wrong in (0, 7):
        with pytest.raises(InputError, match="track_class"):
            Fra(track_class=wrong)


def test_iso3095_bands_keep_their_mean_square():
    irregularity = Iso3095()
    for wavelength, level in ISO3095_LIMIT_DB:
        centre = 2 * np.pi / 10 ** (round(10 * np.log10(wavelength)) / 10)
        w = np.linspace(centre * 10**-0.05, centre * 10**0.05, 2001)[1:-1]
        mean_square = irregularity.wavenumber_density(w).mean() * centre * (10**0.05 - 10**-0.05)
        assert 10 * np.log10(mean_square / 1e-12) == pytest.approx(level, abs=1e-9)
    smooth = Iso3095(interpolation="smooth").wavenumber_density(2 * np.pi / 0.1)
    assert smooth == pytest.approx(float(irregularity.wavenumber_density(2 * np.pi / 0.1)), rel=1e-12)


def test_roughness_table_takes_either_order():
    rising = RoughnessTable(wavelength_m=(0.063, 0.08, 0.1), level_dB=(0.0, 5.0, 10.0))
    w = 2 * np.pi / np.array([0.063, 0.08, 0.1])
    assert np.array_equal(rising.wavenumber_density(w), ROUGHNESS.wavenumber_density(w))
    assert ROUGHNESS.valid_wavelength_m == pytest.approx((10**-1.25, 10**-0.95))


def test_table_runs_straight_in_log_log():
    w = np.array([0.1, 10**-0.5, 1.0, 10**0.5, 10.0])
    expected = [1e-5, 1e-6, 1e-7, 10**-8.5, 1e-10]
    assert TABLE.wavenumber_density(w) == pytest.approx(expected, rel=1e-12)


@named
def test_density_per_hertz_keeps_the_variance(irregularity):
    """Trapezoids on one grid: the sums agree to rounding because the map W = 2 pi f / V is linear."""
    low, high = valid_band(irregularity)
    w = np.geomspace(low * (1 + 1e-9), high * (1 - 1e-9), 4001)
    over_w = np.trapezoid(irregularity.wavenumber_density(w), w)
    for speed in (20.0, SPEED):
        f = w * speed / (2 * np.pi)
        assert np.trapezoid(irregularity.density(f, speed), f) == pytest.approx(over_w, rel=1e-9)


@named
def test_scale_is_a_factor_and_density_is_positive(irregularity):
    low, high = valid_band(irregularity)
    w = np.geomspace(low * (1 + 1e-9), high * (1 - 1e-9), 101)
    density = irregularity.wavenumber_density(w)
    assert density.shape == w.shape
    assert density.dtype == np.float64
    assert np.all(density > 0)
    assert not irregularity.outside_range(w).any()
    twice = irregularity.model_copy(update={"scale": 2.0})
    assert twice.wavenumber_density(w) == pytest.approx(2 * density, rel=1e-14)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(ALL), st.floats(1e-3, 1e3, allow_nan=False), st.floats(1.0, 149.0), st.floats(0.1, 1e3))
def test_range_is_named_never_passed_over(irregularity, wavenumber, speed, frequency):
    for call in (
        lambda: irregularity.wavenumber_density(wavenumber),
        lambda: irregularity.density(frequency, speed),
    ):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                value = call()
            except InputError:
                assert irregularity.type in ("table", "iso3095", "roughness_table")
                continue
        assert np.isfinite(value)
        assert all(one.category is RangeWarning for one in caught)
        assert len(caught) <= 1
    outside = bool(irregularity.outside_range(wavenumber))
    shortest, longest = irregularity.valid_wavelength_m
    length = 2 * np.pi / wavenumber
    assert outside == (length < shortest * (1 - 1e-9) or length > longest * (1 + 1e-9))


def test_closed_form_warns_once_outside_its_range():
    for call in (
        lambda: GermanLow().density([0.1, 50.0, 500.0], SPEED),
        lambda: GermanLow().wavenumber_density([0.01, 1.0, 100.0]),
    ):
        with pytest.warns(RangeWarning, match=r"1 to 100 m; 2 value") as caught:
            call()
        assert len(caught) == 1
        assert caught[0].filename == __file__


def test_table_refuses_to_extrapolate():
    with pytest.raises(InputError, match=r"not extrapolated.*extend it"):
        TABLE.wavenumber_density([1.0, 20.0])
    with pytest.raises(InputError, match="not extrapolated"):
        Iso3095().density([10.0], SPEED)


def test_cosine_sum_realisation_has_the_spectrum():
    """Welch's estimate over a profile of random cosines, within 4 standard errors line by line.

    The spectrum is limited to 1 to 60 m; Hann segments of 200 m, half overlapping, 199 of them: a scatter of
    about 1.2/sqrt(199) = 8 % a line. Lines within three of a band's end are left out (leakage).
    """
    rng = np.random.default_rng(3)
    irregularity, step, count = GermanLow(), 0.25, 80_000
    length = step * count
    w = 2 * np.pi * np.arange(1, count // 2) / length
    band = (w > 2 * np.pi / 60.0) & (w < 2 * np.pi / 1.0)
    lines = np.zeros(count // 2 + 1, dtype=complex)
    amplitude = np.sqrt(2 * irregularity.wavenumber_density(w[band]) * 2 * np.pi / length)
    phase = rng.uniform(0, 2 * np.pi, amplitude.size)
    lines[1:-1][band] = 0.5 * count * amplitude * np.exp(1j * phase)
    profile = np.fft.irfft(lines, count)
    cycles, density = scipy.signal.welch(profile, 1 / step, nperseg=800, detrend=False)
    inside = (cycles > 1 / 60 + 3 / 200) & (cycles < 1.0 - 3 / 200)
    expected = irregularity.wavenumber_density(2 * np.pi * cycles[inside]) * 2 * np.pi
    ratio = density[inside] / expected
    assert ratio.mean() == pytest.approx(1.0, abs=0.02)
    assert np.abs(ratio - 1).max() < 0.35
    variance = np.trapezoid(irregularity.wavenumber_density(w[band]), w[band])
    assert np.var(profile) == pytest.approx(variance, rel=0.01)


def test_reads_from_toml_by_type():
    text = """
    [[irregularity]]
    type = "german_sato"
    form = "paper_eq28"
    [[irregularity]]
    type = "fra"
    track_class = 4
    scale = 2
    [[irregularity]]
    type = "roughness_table"
    wavelength_m = [0.1, 0.08]
    level_dB = [5, 3.5]
    [[irregularity]]
    type = "table"
    wavenumber_rad_per_m = [0.1, 1]
    density_m2_per_rad_per_m = [1e-6, 1e-8]
    """
    tables = tomllib.loads(text)["irregularity"]
    read = TypeAdapter(list[AnyIrregularity]).validate_python(tables)
    assert [one.type for one in read] == [table["type"] for table in tables]
    assert read[0] == GermanSato(form="paper_eq28")
    every = TypeAdapter(list[AnyIrregularity])
    assert every.validate_python([one.model_dump() for one in ALL]) == ALL


@pytest.mark.parametrize(
    ("speed", "message"),
    [
        (0.0, "above 0"),
        (-10.0, "above 0"),
        (np.nan, "finite"),
        (350.0, "divide by 3.6: 97.22"),
        ("fast", "number"),
    ],
)
def test_wrong_speeds(speed, message):
    with pytest.raises(InputError, match=f"speed_m_per_s.*{message}"):
        GermanLow().density([10.0], speed)


@pytest.mark.parametrize("frequency", [0.0, -1.0, np.nan, np.inf, "low"])
def test_wrong_frequencies(frequency):
    with pytest.raises(InputError, match="frequency_Hz"):
        GermanLow().density([frequency], SPEED)
    with pytest.raises(InputError, match="wavenumber_rad_per_m"):
        GermanLow().wavenumber_density([frequency])


def test_wrong_conversion():
    with pytest.raises(InputError, match="wavenumber_density_called_per_hertz"):
        GermanLow().density([10.0], SPEED, "per_radian")


@pytest.mark.parametrize(
    ("model", "fields", "message"),
    [
        (GermanLow, {"form": "left"}, "form"),
        (GermanLow, {"scale": 0.0}, "scale"),
        (GermanLow, {"level": 1.0}, "level"),
        (Sato, {"amplitude": -1.0}, "amplitude"),
        (Sato, {"exponent": np.inf}, "exponent"),
        (GermanSato, {"crossover_wavelength_m": 0.0}, "crossover_wavelength_m"),
        (Fra, {}, "track_class"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.08), "level_dB": (1.0,)}, "go in pairs"),
        (RoughnessTable, {"wavelength_m": (0.1,), "level_dB": (1.0,)}, "at least two"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.063), "level_dB": (1.0, 2.0)}, "neighbouring"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.08, 0.1), "level_dB": (1.0, 2.0, 3.0)}, "neighbouring"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.1), "level_dB": (1.0, 2.0)}, "neighbouring"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.09), "level_dB": (1.0, 2.0)}, r"wavelength_m\[1\]"),
        (RoughnessTable, {"wavelength_m": (0.1, -0.08), "level_dB": (1.0, 2.0)}, "above zero"),
        (RoughnessTable, {"wavelength_m": (0.1, 0.08), "level_dB": (1.0, np.nan)}, "level_dB.1"),
        (
            DensityTable,
            {"wavenumber_rad_per_m": (1.0, 0.5), "density_m2_per_rad_per_m": (1e-6, 1e-7)},
            "sort the table",
        ),
        (
            DensityTable,
            {"wavenumber_rad_per_m": (0.5, 1.0), "density_m2_per_rad_per_m": (1e-6, -1e-7)},
            r"density_m2_per_rad_per_m\[1\]",
        ),
        (
            DensityTable,
            {"wavenumber_rad_per_m": (0.5, 1.0, 2.0), "density_m2_per_rad_per_m": (1e-6, 1e-7)},
            "go in pairs",
        ),
        (
            DensityTable,
            {"wavenumber_rad_per_m": (0.0, 1.0), "density_m2_per_rad_per_m": (1e-6, 1e-7)},
            "above zero",
        ),
    ],
)
def test_wrong_spectra_are_refused_with_the_place(model, fields, message):
    with pytest.raises(InputError, match=message):
        model(**fields)
