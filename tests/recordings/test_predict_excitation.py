"""What excites a train beside the profile's spectrum, against time series that Welch's method was run on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.excitation import Push, TrackLines
from permway.campaign.predictions.excitation import deposit, push
from permway.campaign.predictions.grid import grid_of
from permway.campaign.predictions.run import expected_csd, influence, solved_lines, wheels_of
from permway.errors import InputError
from permway.model.place import Place
from permway.recordings.estimates.welch import cross_spectra
from permway.response.receptance import receptance

SAMPLING_HZ, SPEED, RADIUS = 512.0, 50.0, 0.43
ESTIMATE_HZ = np.arange(10.0, 81.0)
LINES_HZ = solved_lines(ESTIMATE_HZ, 1.0, None)


def campaign_with(folder: Path, irregularity: dict[str, Any], chain: dict[str, Any] | None = None) -> Campaign:
    plain, model = tables()
    plain["irregularity"] = {**plain["irregularity"], **irregularity}
    plain["sensors"][3]["direction"] = "down"
    plain["sensors"].append({"name": "axle3", "degree": "car1.wheelset3", "unit": "m/s2"})
    plain["sensors"][2]["chain"] = {"noise_floor": 1e-6, **(chain or {})}
    return read_campaign(write(folder, plain, model))


@pytest.fixture(scope="module")
def per_profile(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    campaign = campaign_with(tmp_path_factory.mktemp("plain"), {})
    x = wheels_of(campaign.model, campaign.condition("fast"))
    at = [Place(body="rail", x_m=float(v), name=f"w{i}") for i, v in enumerate(x)]
    track = receptance(campaign.model.line, LINES_HZ, forces=at, sensors=at, temperature_C=12.0, threads=1)
    return influence(campaign.model, LINES_HZ, track["receptance"].values)


def expected(campaign: Campaign, per_profile: np.ndarray, duration_s: float | None = None) -> np.ndarray:
    sensors = [campaign.sensor(name) for name in ("axle", "axle3", "floor")]
    return expected_csd(
        campaign.model,
        campaign.stated.irregularity,
        campaign.condition("fast"),
        sensors,
        LINES_HZ,
        per_profile,
        ESTIMATE_HZ,
        segment_s=1.0,
        interpolated=False,
        duration_s=duration_s,
    )


def response(campaign: Campaign, per_profile: np.ndarray, frequency: float, phases: np.ndarray) -> np.ndarray:
    """Accelerations of axle, axle3 and floor by a wave of such phases under the wheels."""
    degrees = campaign.model.train.vehicle.degrees  # type: ignore[union-attr]
    chosen = [degrees.index(d) for d in ("car1.wheelset1", "car1.wheelset3", "car1.body.bounce")]
    flat = per_profile[:, chosen, :].reshape(LINES_HZ.size, -1)
    there = np.array([np.interp(frequency, LINES_HZ, column) for column in flat.T]).reshape(3, -1)
    return np.asarray(-((2.0 * np.pi * frequency) ** 2) * (there @ phases))


def welch(lines: list[tuple[float, np.ndarray]], seconds: float = 400.0) -> np.ndarray:
    """Cross spectra of lines of complex amplitudes by channel, (line, channel, channel)."""
    t = np.arange(round(seconds * SAMPLING_HZ)) / SAMPLING_HZ
    x = sum((a[:, None] * np.exp(2j * np.pi * f * t)).real for f, a in lines)
    data = cross_spectra(np.asarray(x), sampling_Hz=SAMPLING_HZ, segment_s=1.0)
    csd = data["csd"].sel(frequency=ESTIMATE_HZ).values
    return np.moveaxis(csd, -1, 0)


def same_within(found: np.ndarray, wanted: np.ndarray, share: float) -> bool:
    """Equal within a share of the greatest power by pair of channels, line by line."""
    power = np.sqrt(np.einsum("fii,fjj->ijf", wanted.real, wanted.real)).max(axis=-1)
    return bool((np.abs(found - wanted) <= share * power).all())


def test_a_line_of_the_track_is_what_welch_makes_of_it(tmp_path: Path, per_profile: np.ndarray) -> None:
    """At 4 m and 50 m/s lines lie at 12.5 Hz, midway between two of the estimate, 25, 37.5, ..."""
    series = {"series": [{"length_m": 4.0, "amplitude_m": 1e-3, "decay": 1.0}]}
    campaign = campaign_with(tmp_path, series)
    quiet = expected(campaign_with(tmp_path, {}), per_profile)
    found = expected(campaign, per_profile) - quiet
    wheels = wheels_of(campaign.model, campaign.condition("fast"))
    lines = []
    for n in range(1, 7):
        f = 12.5 * n
        late = np.exp(-2j * np.pi * f * (wheels[0] - wheels) / SPEED)
        lines.append((f, 1e-3 / n * response(campaign, per_profile, f, late)))
    assert same_within(found, welch(lines), 0.01)


def test_a_line_of_one_wheel_is_its_own(tmp_path: Path, per_profile: np.ndarray) -> None:
    polygon: dict[str, Any] = {"wheels": [{"wheel": 3, "order": 2.0, "amplitude_m": 1e-4, "harmonics": 1}]}
    campaign = campaign_with(tmp_path, polygon)
    found = expected(campaign, per_profile) - expected(campaign_with(tmp_path, {}), per_profile)
    f = 2.0 * SPEED / (2.0 * np.pi * RADIUS)
    alone = np.array([0.0, 0.0, 1.0, 0.0])
    assert same_within(found, welch([(f, 1e-4 * response(campaign, per_profile, f, alone))]), 0.01)
    every = campaign_with(tmp_path, {"wheels": [{k: v for k, v in polygon["wheels"][0].items() if k != "wheel"}]})
    both = expected(every, per_profile) - expected(campaign_with(tmp_path, {}), per_profile)
    each = [welch([(f, 1e-4 * response(every, per_profile, f, wheel))]) for wheel in np.eye(4)]
    assert same_within(both, np.sum(each, axis=0), 0.01)


def test_hum_is_a_line_in_its_channel(tmp_path: Path, per_profile: np.ndarray) -> None:
    hum = {"mains": {"frequency_Hz": 49.9, "amplitude": 0.3, "harmonics": 1}}
    plain = expected(campaign_with(tmp_path, {}), per_profile)
    found = expected(campaign_with(tmp_path, {}, hum), per_profile) - plain
    wanted = welch([(49.9, np.array([0.3, 0.0, 0.0], dtype=complex))])
    assert found[:, 0, 0].real == pytest.approx(wanted[:, 0, 0].real, abs=0.003 * wanted.real.max())
    assert not found[:, 1:, 1:].any()


def test_hum_may_have_lines_of_their_own(tmp_path: Path, per_profile: np.ndarray) -> None:
    hum = {"mains": {"frequency_Hz": 21.0, "amplitude": 0.3, "shares": [0.0, 0.6]}}
    plain = expected(campaign_with(tmp_path, {}), per_profile)
    found = expected(campaign_with(tmp_path, {}, hum), per_profile) - plain
    wanted = welch([(f, np.array([a, 0.0, 0.0], dtype=complex)) for f, a in ((21.0, 0.3), (63.0, 0.18))])
    assert found[:, 0, 0].real == pytest.approx(wanted[:, 0, 0].real, abs=0.003 * wanted.real.max())
    assert abs(found[ESTIMATE_HZ == 42.0, 0, 0]) < 1e-6 * found[ESTIMATE_HZ == 63.0, 0, 0].real


def test_a_broad_line_keeps_its_power() -> None:
    grid = grid_of(np.arange(1.0, 200.0), np.arange(5.0, 190.0), 1.0)
    for width in (0.0, 0.001, 0.05):
        density = deposit(grid, np.array([60.03, 90.0]), np.array([2.0, 1.0]), width)
        step = grid.step_Hz
        assert density.sum() * step == pytest.approx(3.0, rel=1e-6)
        mean = (density * grid.frequency_Hz).sum() * step / 3.0
        assert mean == pytest.approx((2.0 * 60.03 + 90.0) / 3.0, rel=1e-6)
    wide = deposit(grid, np.array([100.0]), np.array([1.0]), 0.05)
    bell = np.exp(-0.5 * ((grid.frequency_Hz - 100.0) / 5.0) ** 2) / (5.0 * np.sqrt(2.0 * np.pi))
    assert wide == pytest.approx(bell, abs=1e-4 * bell.max())
    assert not deposit(grid, np.array([500.0]), np.array([1.0]), 0.0).any()


def test_a_force_shakes_the_vehicle_on_its_track(tmp_path: Path, per_profile: np.ndarray) -> None:
    """The wheels' own impedance and the track's take part: against all of it solved at once."""
    pushes = {"pushes": [{"degree": "car1.bogie1.bounce", "density_N2_per_Hz": 100.0}]}
    campaign = campaign_with(tmp_path, pushes)
    found = expected(campaign, per_profile) - expected(campaign_with(tmp_path, {}), per_profile)
    model = campaign.model
    assert model.train is not None
    vehicle = model.train.vehicle
    stiffness = vehicle.dynamic_stiffness(LINES_HZ)
    wheels = vehicle.wheel_indices
    response = np.linalg.inv(stiffness)
    # per_profile = R_w T^-1, of which the contacts' dynamic stiffness T^-1 follows.
    contact = np.linalg.solve(response[:, wheels][:, :, wheels], per_profile[:, wheels, :])
    # T holds the wheels' receptance: on the contacts acts (T - R_ww)^-1.
    alone = np.linalg.inv(np.linalg.inv(contact) - response[:, wheels][:, :, wheels])
    whole = stiffness.copy()
    whole[np.ix_(range(LINES_HZ.size), wheels, wheels)] += alone
    moved = np.linalg.solve(whole, np.eye(stiffness.shape[1])[:, [vehicle.degrees.index("car1.bogie1.bounce")]])
    bounce = vehicle.degrees.index("car1.body.bounce")
    power = 100.0 * np.abs((2.0 * np.pi * LINES_HZ) ** 2 * moved[:, bounce, 0]) ** 2
    at = np.searchsorted(LINES_HZ, ESTIMATE_HZ)
    # The window smears a smooth spectrum little.
    assert found[20:, 2, 2].real == pytest.approx(power[at][20:], rel=0.02)


def test_a_force_through_a_resonance_is_what_a_dashpot_on_a_sprung_mass_passes_on() -> None:
    mass, centre, quality = 3.0, 40.0, 2.5
    frequency = np.array([0.0, 1.0, 20.0, 39.0, 40.0, 45.0, 200.0])
    omega, tuned = 2.0 * np.pi * frequency, 2.0 * np.pi * centre
    dashpot = mass * tuned / quality
    passed = 1j * omega * dashpot / (mass * (tuned**2 - omega**2) + 1j * omega * dashpot)
    source = Push(degree="car1.bogie1.bounce", density_N2_per_Hz=7.0, centre_Hz=centre, quality=quality)
    np.testing.assert_allclose(push(source, frequency), 7.0 * np.abs(passed) ** 2, rtol=1e-12)


def test_bands_patch_and_levels_are_their_formulas(tmp_path: Path, per_profile: np.ndarray) -> None:
    plain = expected(campaign_with(tmp_path, {}), per_profile)[:, 0, 0].real - 1e-6
    wavelength = SPEED / ESTIMATE_HZ
    band = {"bands": [{"wavelength_m": 1.25, "octaves": 1.0, "gain_dB": 6.0}]}
    bell = 1.0 + (10.0**0.6 - 1.0) * np.exp(-0.5 * np.log2(wavelength / 1.25) ** 2)
    patch = 1.0 / (1.0 + 0.25 * np.pi * (2.0 * np.pi / wavelength * 0.1) ** 3)
    cases = [
        (band, bell),
        ({"contact_patch_m": 0.1}, patch),
        ({"level_by_condition_dB": {"fast": 3.0}}, np.full(wavelength.size, 10.0**0.3)),
    ]
    for stated, factor in cases:
        found = expected(campaign_with(tmp_path, stated), per_profile)[:, 0, 0].real - 1e-6
        assert found == pytest.approx(factor * plain, rel=0.01)


def test_a_slow_clock_takes_from_cross_spectra_what_it_takes_from_samples(
    tmp_path: Path, per_profile: np.ndarray
) -> None:
    slow, seconds = 1e-4, 100.0
    late = campaign_with(tmp_path, {}, {"clock_slow": slow})
    with pytest.raises(InputError, match="duration_s"):
        expected(late, per_profile)
    right = expected(campaign_with(tmp_path, {}), per_profile)
    found = expected(late, per_profile, seconds)
    random = np.random.default_rng(1)
    lines = random.uniform(5.0, 85.0, 1500)
    sizes = random.standard_normal(lines.size) + 1j * random.standard_normal(lines.size)
    t = np.arange(round(seconds * SAMPLING_HZ)) / SAMPLING_HZ
    x = np.zeros((2, t.size))
    for frequency, size in zip(lines, sizes, strict=True):
        for row, times in enumerate((t * (1.0 - slow), t)):
            x[row] += (size * np.exp(2j * np.pi * frequency * times)).real
    data = cross_spectra(x, sampling_Hz=SAMPLING_HZ, segment_s=1.0).sel(frequency=ESTIMATE_HZ)
    power, shared = data["psd"].values[0], data["csd"].values[0, 1]

    def smooth(values: np.ndarray) -> np.ndarray:
        return np.convolve(values, np.ones(9) / 9.0, "valid")

    seen = smooth(shared) / smooth(power)
    stated = smooth(found[:, 0, 2] / right[:, 0, 2])
    assert np.abs(stated[0]) > 0.95
    assert np.abs(stated[-1]) < 0.80
    assert np.abs(seen - stated).max() < 0.1
    np.testing.assert_allclose(found[:, [0, 1, 2], [0, 1, 2]], right[:, [0, 1, 2], [0, 1, 2]])


@pytest.mark.parametrize(
    ("stated", "where"),
    [
        ({"level_by_condition_dB": {"faster": 3.0}}, "irregularity.level_by_condition_dB.faster"),
        ({"wheels": [{"wheel": 5, "amplitude_m": 1e-5}]}, r"irregularity.wheels\[0\].wheel"),
        ({"pushes": [{"degree": "car1.motor", "density_N2_per_Hz": 1.0}]}, r"irregularity.pushes\[0\].degree"),
        (
            {"pushes": [{"degree": "car1.bogie1.bounce", "density_N2_per_Hz": 1.0, "quality": 3.0}]},
            r"irregularity.pushes\[0\].quality",
        ),
        ({"bands": [{"wavelength_m": 0.3, "gain_dB": -1.0}]}, r"irregularity.bands\[0\].gain_dB"),
        ({"series": [{"length_m": 0.0, "amplitude_m": 1e-5}]}, r"irregularity.series\[0\].length_m"),
        (
            {"series": [{"length_m": 12.0, "amplitude_m": 1e-5, "dip_m": 0.6, "decay": 2.0}]},
            r"irregularity.series\[0\].*decay",
        ),
    ],
)
def test_faults_are_reported_with_their_place(tmp_path: Path, stated: dict[str, Any], where: str) -> None:
    with pytest.raises(InputError, match=where):
        campaign_with(tmp_path, stated)


def test_lines_of_dips_are_those_of_their_shape() -> None:
    length, dip, count = 12.0, 0.9, 1 << 16
    x = (np.arange(count) / count - 0.5) * length
    shape = np.where(np.abs(x) < 0.5 * dip, 1.0 - np.sin(np.pi * np.abs(x) / dip), 0.0)
    by_fourier = 2.0 / count * np.abs(np.fft.rfft(shape))
    number = np.arange(1.0, 61.0)
    of_long_lines = 2.0 * shape.mean()
    lines = TrackLines(length_m=length, amplitude_m=of_long_lines, dip_m=dip)
    assert lines.amplitude(number) == pytest.approx(by_fourier[1:61], rel=1e-5, abs=1e-9)
    # The kink: (n dip / length)^-2 at last; and no division by nothing where a quarter wave meets its own length.
    assert np.isfinite(lines.amplitude(np.array([0.5 * length / dip, 1e5]))).all()
