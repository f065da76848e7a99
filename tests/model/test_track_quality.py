"""Irregularities as track recording reports them, against closed forms and against profiles drawn from them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from permway.cli import app
from permway.errors import InputError
from permway.formats.irregularity_file import irregularity_of
from permway.model.irregularity import CycleTable, DensityTable, En13848, Fra, GermanHigh, GermanLow, Iso3095
from permway.model.track_quality import BANDS_M, band_deviations, density_per_cycle, draw_profile

A, C, R = 4.032e-7, 0.8246, 0.0206


def german_variance(low: float, high: float) -> float:
    """Integral of A C^2 / ((W^2 + R^2)(W^2 + C^2)) by partial fractions."""

    def primitive(w: float) -> float:
        return float((np.arctan(w / R) / R - np.arctan(w / C) / C) * A * C**2 / (C**2 - R**2))

    return primitive(high) - primitive(low)


def test_standard_deviations_of_the_german_spectrum_are_its_integrals() -> None:
    d1, d2, d3 = band_deviations(GermanLow())
    for found, (short, long) in ((d1, (3.0, 25.0)), (d2, (25.0, 70.0)), (d3, (70.0, 100.0))):
        exact = np.sqrt(german_variance(2.0 * np.pi / long, 2.0 * np.pi / short))
        assert found.deviation_m == pytest.approx(exact, rel=1e-6)
    assert (d1.band, d2.band, d3.band) == ("D1", "D2", "D3")
    assert d1.whole
    assert d2.whole
    # The source ends at 100 m: the rest of D3 is not made up.
    assert not d3.whole
    assert d3.covered_m == pytest.approx((70.0, 100.0))
    # Four times the density is twice the deviation.
    assert band_deviations(GermanLow(scale=4.0))[0].deviation_m == pytest.approx(2.0 * (d1.deviation_m or 0.0))


def test_bands_that_the_source_does_not_cover() -> None:
    assert all(band.covered_m is None and band.deviation_m is None for band in band_deviations(Iso3095()))
    table = DensityTable(
        wavenumber_rad_per_m=(2.0 * np.pi / 10.0, 2.0 * np.pi / 5.0), density_m2_per_rad_per_m=(1e-6, 1e-7)
    )
    d1, d2, _ = band_deviations(table)
    assert d1.covered_m == pytest.approx((5.0, 10.0))
    assert d1.deviation_m is not None
    assert d2.deviation_m is None


def test_a_density_per_cycle_has_the_same_variance() -> None:
    spectrum = Fra(track_class=5)
    n = np.linspace(1.0 / 25.0, 1.0 / 3.0, 200_001)
    variance = np.trapezoid(density_per_cycle(spectrum, n), n)
    assert np.sqrt(variance) == pytest.approx(band_deviations(spectrum)[0].deviation_m, rel=1e-6)
    assert density_per_cycle(spectrum, 0.1) == pytest.approx(
        2.0 * np.pi * spectrum.wavenumber_density(0.2 * np.pi)
    )
    with pytest.raises(InputError, match="above 0"):
        density_per_cycle(spectrum, 0.0)


@pytest.mark.parametrize("exponent", [1.0, 3.0])
def test_an_irregularity_of_standard_deviations_has_them(exponent: float) -> None:
    spectrum = En13848(D1_mm=1.1, D2_mm=2.3, D3_mm=4.7, exponent=exponent)
    found = [1e3 * (band.deviation_m or 0.0) for band in band_deviations(spectrum)]
    np.testing.assert_allclose(found, [1.1, 2.3, 4.7], rtol=1e-6)
    assert spectrum.valid_wavelength_m == (3.0, 150.0)
    # Within a band a power of the wavenumber.
    low, high = spectrum.wavenumber_density([0.5, 1.0])
    assert low / high == pytest.approx(2.0**exponent)
    short = En13848(D1_mm=1.1)
    assert short.valid_wavelength_m == (3.0, 25.0)
    with pytest.raises(InputError, match="not extrapolated"):
        short.wavenumber_density(2.0 * np.pi / 30.0)


def test_a_table_over_cycles_per_metre_is_the_one_over_wavenumber() -> None:
    n = np.array([0.01, 0.04, 0.1, 0.5])
    german = GermanLow()
    table = CycleTable(cycles_per_m=tuple(n), density_mm2_m=tuple(1e6 * density_per_cycle(german, n)))
    np.testing.assert_allclose(
        table.wavenumber_density(2.0 * np.pi * n), german.wavenumber_density(2.0 * np.pi * n)
    )
    np.testing.assert_allclose(density_per_cycle(table, n), density_per_cycle(german, n), rtol=1e-12)
    assert table.valid_wavelength_m == pytest.approx((2.0, 100.0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('type = "en13848"\nD1_mm = 1.0\nD3_mm = 2.0\n', "leaves a gap"),
        ('type = "en13848"\nD1_mm = 900.0\n', "give it in mm"),
        ('type = "en13848"\nD2_mm = 1.0\n', "D1_mm"),
        ('type = "table_per_cycle"\ncycles_per_m = [0.1, 0.01]\ndensity_mm2_m = [1.0, 2.0]\n', "ascending"),
        ('type = "table_per_cycle"\ncycles_per_m = [0.01, 0.1]\ndensity_mm2_m = [1.0, 0.0]\n', "above zero"),
    ],
)
def test_recorded_irregularities_that_cannot_be(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "model.toml"
    path.write_text("[irregularity]\n" + text)
    with pytest.raises(InputError, match=message):
        irregularity_of(path)


def test_a_profile_has_the_spectrum_it_was_drawn_from() -> None:
    """Band by band over 40 km; D2 has some 900 independent waves, so that 12 % are more than five deviations."""
    spectrum = GermanHigh()
    profile = draw_profile(spectrum, length_m=40_000.0, spacing_m=0.5, seed=3)
    assert profile.shape == (80_001,)
    waves = np.fft.rfft(profile) / profile.size
    wavelength = 1.0 / np.maximum(np.fft.rfftfreq(profile.size, 0.5), 1e-12)
    for band, (short, long) in zip(band_deviations(spectrum)[:2], list(BANDS_M.values())[:2], strict=True):
        inside = (wavelength > short) & (wavelength <= long)
        found = np.sqrt(2.0 * np.sum(np.abs(waves[inside]) ** 2))
        assert found == pytest.approx(band.deviation_m, rel=0.12)
    np.testing.assert_array_equal(profile, draw_profile(spectrum, length_m=40_000.0, spacing_m=0.5, seed=3))
    other = draw_profile(spectrum, length_m=40_000.0, spacing_m=0.5, seed=4)
    assert abs(np.corrcoef(profile, other)[0, 1]) < 0.3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"length_m": 0.0, "spacing_m": 0.5}, "length_m"),
        ({"length_m": 10.0, "spacing_m": float("nan")}, "spacing_m"),
        ({"length_m": 1e9, "spacing_m": 0.01}, "samples"),
        ({"length_m": 1000.0, "spacing_m": 100.0}, "smaller spacing"),
        ({"length_m": 10.0, "spacing_m": 0.5, "seed": -1}, "seed"),
    ],
)
def test_profiles_that_cannot_be_drawn(options: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        draw_profile(GermanLow(), **options)  # type: ignore[arg-type]


def test_the_command_reads_only_the_irregularity(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "model.toml"
    path.write_text('[irregularity]\ntype = "german_low"\n')
    assert isinstance(irregularity_of(path), GermanLow)
    table = tmp_path / "profile.csv"
    with pytest.raises(SystemExit) as end:
        app(
            [
                "irregularity",
                str(path),
                "-o",
                str(table),
                "--length",
                "500",
                "--plot",
                str(tmp_path / "p"),
                "--json",
            ]
        )
    assert end.value.code == 0
    stated = json.loads(capsys.readouterr().out)
    assert stated["bands"][0]["deviation_mm"] == pytest.approx(
        1e3 * (band_deviations(GermanLow())[0].deviation_m or 0)
    )
    assert stated["bands"][2]["note"] == "only 70 to 100 m"
    x, level = np.loadtxt(table, delimiter=",", skiprows=1).T
    assert (x[-1], len(x)) == (500.0, 2001)
    assert 1e-3 * level.std() == pytest.approx(1e-3 * stated["profile_deviation_mm"], rel=1e-4)
    assert Path(stated["picture"]).stat().st_size > 3000


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[line]\n", "has no irregularity"),
        ("irregularity = 3\n", "must be a table"),
        ('[irregularity]\ntype = "german"\n', "there is no type 'german'"),
        ('[irregularity]\ntype = "german_low"\nscale = -1.0\n', "irregularity"),
    ],
)
def test_files_without_a_usable_irregularity(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "model.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        irregularity_of(path)
    assert "model.toml" in str(caught.value)
