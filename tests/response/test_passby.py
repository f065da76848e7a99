"""A train that passes fixed sensors: properties that hold whatever the line, and second formulations."""

import numpy as np
import pytest
from lines import supported, uic60
from permway.laws import KelvinVoigt
from permway.model.bodies import Beam
from permway.model.irregularity import GermanLow
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m
from permway.model.train import Train
from permway.model.vehicle_presets import crh380a
from permway.response.passby import Axles, hslm_a, passby
from permway.response.passby.bands import band_energy, one_third_octaves
from permway.response.passby.carry import arrivals, carried, harmonic_moments, sampled_moments
from permway.response.passby.loads import static_axles
from permway.response.passby.path import path_of
from permway.response.passby.rough import realise
from permway.response.passby.transfer import transfer
from permway.response.receptance import receptance
from permway.response.train import train_response
from scipy.interpolate import CubicSpline

PAD = KelvinVoigt(stiffness=8e7, damping=6e4)
TRACK = supported(uic60(), count=101, spacing_m=0.6, pad=PAD)
MIDDLE = Place(body="rail", x_m=0.3)
BRIDGE = Line(
    bodies={
        "girder": Beam(
            youngs_modulus_Pa=3e10,
            second_moment_m4=2.0,
            density_kg_per_m3=2500.0,
            area_m2=4.0,
            intervals_m=((0.0, 20.0),),
            ends="pinned",
            loss_factor=0.1,
        )
    },
    joints=(),
    laws={},
)
SPOT = Place(body="girder", x_m=7.0)
TRAIN = Train(vehicle=crh380a(share=0.5), centre_m=0.0, speed_m_per_s=80.0)


def axles(*lags, loads=None, speed=50.0, body="rail"):
    return Axles(lags_m=lags, loads_N=loads or (1e5,) * len(lags), speed_m_per_s=speed, body=body)


def run(line=TRACK, train=None, sensors=(MIDDLE,), highest=100.0, **options):
    options = {"window_s": 2.5, "quantity": "displacement", **options}
    return passby(line, train or axles(0.0), sensors=sensors, highest_Hz=highest, threads=1, **options)


def on_entry(data):
    """The spectrum on a clock that starts when the first wheel enters."""
    lead = -float(data["time"][0])
    return data["spectrum"].values * np.exp(2j * np.pi * data["frequency"].values * lead)


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_history_and_spectrum_have_the_same_energy(quantity):
    data = run(quantity=quantity, train=axles(0.0, 2.5))
    step = float(data["time"][1] - data["time"][0])
    in_time = float((data["history"] ** 2).sum() * step)
    energy = data["energy"].values[0, 0]
    df = float(data["frequency"][1])
    assert (energy.sum() - 0.5 * energy[0]) * df == pytest.approx(in_time, rel=1e-12)
    assert band_energy(energy, df, np.array([0.0]), np.array([200.0]))[0] == pytest.approx(in_time, rel=1e-12)


def test_bands_are_those_of_base_ten_and_share_out_the_energy():
    middle, lower, upper = one_third_octaves(0.9, 100.0)
    assert middle[0] == pytest.approx(10 ** (1 / 10))
    assert middle[[-1]] == pytest.approx([10**1.9])
    assert upper / lower == pytest.approx(np.full(middle.size, 10**0.1))
    assert upper[:-1] == pytest.approx(lower[1:])
    data = run(averaging_s=2.0)
    whole = band_energy(
        data["energy"].values,
        float(data["frequency"][1]),
        data["band_lower"].values[[0]],
        data["band_upper"].values[[-1]],
    )
    assert float((data["band_rms"] ** 2).sum()) * 2.0 == pytest.approx(whole[0, 0, 0], rel=1e-12)
    assert data["band_upper"].values[-1] <= 100.0
    assert data["band_level"].values == pytest.approx(20 * np.log10(data["band_rms"].values / 1e-12))


def test_velocity_is_the_derivative_of_displacement():
    position, velocity = (run(quantity=q)["history"][0, 0] for q in ("displacement", "velocity"))
    travelled = CubicSpline(velocity["time"], velocity).antiderivative()(velocity["time"])
    difference = travelled - (position - position[0])
    assert np.abs(difference).max() < 1e-4 * np.abs(position).max()


def test_axles_superpose():
    """Two axles: the first's answer, and the second's, lag / V later."""
    first = on_entry(run())
    both = run(train=axles(0.0, 7.3, loads=(1e5, 6e4)))
    omega = 2 * np.pi * both["frequency"].values
    expected = first * (1.0 + 0.6 * np.exp(-1j * omega * 7.3 / 50.0))
    assert np.abs(on_entry(both) - expected).max() < 1e-12 * np.abs(expected).max()


def test_an_earlier_start_is_a_later_passage():
    """Two bays more to run: the same history, 1.2 m / V later."""
    near, far = run(from_m=-18.0), run(from_m=-19.2)
    shape = CubicSpline(near["time"], near["history"][0, 0])
    time = np.linspace(0.2, 0.6, 500)
    later = CubicSpline(far["time"], far["history"][0, 0])(time + 1.2 / 50.0)
    assert np.abs(later - shape(time)).max() < 1e-4 * np.abs(later).max()


def test_sensors_a_number_of_bays_apart_see_the_same_later():
    sensors = [Place(body="rail", x_m=x) for x in (-1.5, 1.5)]
    first, second = run(sensors=sensors, quantity="velocity")["history"][0]
    time = np.linspace(0.3, 0.8, 500)
    early, late = (CubicSpline(h["time"], h) for h in (first, second))
    assert np.abs(late(time + 3.0 / 50.0) - early(time)).max() < 1e-3 * np.abs(second).max()


def test_a_slow_load_deflects_as_one_at_rest():
    """At 2 m/s the first critical speed is hundreds of times away."""
    data = run(train=axles(0.0, speed=2.0), window_s=50.0, highest=20.0)
    history = CubicSpline(data["time"], data["history"][0, 0])
    place = np.linspace(-3.0, 3.0, 41)
    loads = [Place(body="rail", x_m=x, name=f"{i}") for i, x in enumerate(place)]
    still = receptance(TRACK, [1e-3], forces=[MIDDLE], sensors=loads)["receptance"].values[0, :, 0].real
    passing = history((place - data.attrs["path_m"][0]) / 2.0)
    assert np.abs(passing - 1e5 * still).max() < 5e-3 * np.abs(passing).max()


def test_places_and_sensors_change_roles():
    """From rail to girder as from girder to rail, at rest too."""
    line = slab_track_viaduct_32m(pad=PAD)
    frequency = np.array([0.0, 3.0, 40.0, 150.0])
    rail = [Place(body="rail", x_m=x) for x in (5.0, 16.0, 20.3)]
    girder = [Place(body="girder", x_m=x) for x in (8.0, 16.0)]
    there = transfer(line, frequency, sensors=girder, places=rail)
    back = transfer(line, frequency, sensors=rail, places=girder)
    assert np.abs(there - back.transpose(0, 2, 1)).max() < 1e-9 * np.abs(there).max()
    assert np.isreal(there[0]).all()


def carry(order, *, speed=50.0, moments=None):
    path = path_of(
        TRACK, "rail", from_m=None, to_m=None, ramp_m=None, highest_Hz=100.0, order=order, kinks_m=(MIDDLE.x_m,)
    )
    frequency = np.arange(0.0, 100.0, 2.5)
    omega = 2 * np.pi * frequency
    values = transfer(TRACK, frequency, sensors=[MIDDLE], places=path.places())
    chosen = harmonic_moments(path, omega, speed) if moments is None else moments(path, omega)
    return carried(path.coefficients(values), chosen)


def test_quadrature_converges_and_states_how_far_it_is():
    """Two polynomials more are worth a factor of ten at least; the stated share bounds the error."""
    best, _ = carry(12)
    errors, stated = [], []
    for order in (4, 6, 8):
        value, last = carry(order)
        errors.append(np.abs(value - best).max())
        stated.append(np.abs(last).max())
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert all(error < share for error, share in zip(errors, stated, strict=True))
    assert errors[1] < 1e-5 * np.abs(best).max()


@pytest.mark.parametrize("speed", [5.0, 50.0])
@pytest.mark.parametrize("force_Hz", [0.0, 31.0])
def test_closed_and_sampled_integrals_agree(speed, force_Hz):
    """A cosine is half of either rotation: the Doppler pair against Gauss's points."""
    rotation, entry = 2 * np.pi * force_Hz, np.array([0.1, 0.35])

    def closed(path, omega):
        return sum(
            0.5 * harmonic_moments(path, omega, speed, r) * arrivals(omega, np.ones(2), entry, r)[:, None, None]
            for r in (rotation, -rotation)
        )

    def sampled(path, omega):
        courses = [lambda t: np.cos(rotation * t)] * 2
        return sampled_moments(path, omega, speed, courses, entry, rotation)

    first, second = (carry(6, speed=speed, moments=m)[0] for m in (closed, sampled))
    assert np.abs(first - second).max() < 1e-10 * np.abs(first).max()


def test_a_moving_source_is_heard_at_two_frequencies():
    """Far from the source a wave of speed c comes at f0 / (1 - V/c), then at f0 / (1 + V/c) (Doppler).

    On a rail without supports' stop band, here at 400 Hz; k of the free wave by the phase of the receptance.
    """
    force_Hz, speed = 400.0, 60.0
    track = supported(
        uic60(loss_factor=2e-3), count=201, spacing_m=0.6, pad=KelvinVoigt(stiffness=2e7, damping=1e3)
    )
    sensor = Place(body="rail", x_m=0.3)
    frequency = np.arange(340.0, 460.0, 0.5)
    path = path_of(track, "rail", from_m=-50.0, to_m=50.0, ramp_m=10.0, highest_Hz=460.0, order=6, kinks_m=(0.3,))
    omega, rotation = 2 * np.pi * frequency, 2 * np.pi * force_Hz
    values = transfer(track, frequency, sensors=[sensor], places=path.places())
    spectrum, _ = carried(path.coefficients(values), harmonic_moments(path, omega, speed, rotation))
    loud = np.abs(spectrum[:, 0])
    above, below = (frequency[mask][loud[mask].argmax()] for mask in (frequency > force_Hz, frequency < force_Hz))

    def received(sign):
        # omega = omega0 + sign V k(omega), with k from two places twelve bays apart.
        pair = [Place(body="rail", x_m=x) for x in (0.3, 7.5)]
        source = Place(body="rail", x_m=-30.0 + 0.3)
        answer = receptance(track, frequency, forces=[source], sensors=pair)["receptance"].values[:, :, 0]
        bays = np.unwrap(np.angle(answer[:, 0] / answer[:, 1]))
        # Whole turns that the two places leave open: about ten radians too little.
        free = (60.2 * omega[0] ** 2 / (210e9 * 3038.3e-8)) ** 0.25 * 7.2
        wave = (bays + 2 * np.pi * round((free - bays[0]) / (2 * np.pi))) / 7.2
        return frequency[np.abs(omega - rotation - sign * speed * wave).argmin()]

    assert above == pytest.approx(received(1.0), abs=1.5)
    assert below == pytest.approx(received(-1.0), abs=1.5)
    assert above - force_Hz > 15.0


def test_random_forces_have_the_density_that_they_are_drawn_from():
    """Mean squares over 40 seeds: within 5 standard errors of the integral; a seed is a seed."""
    options = {"length_s": 4.0, "start_s": 0.0, "highest_Hz": 60.0}

    def draw(seed):
        return realise(TRACK, TRAIN, GermanLow(), seed=seed, **options)

    first = draw(0)
    assert np.array_equal(first.amplitude, draw(0).amplitude)
    lines = np.flatnonzero(np.abs(first.amplitude[:, 0]) > 0)
    frequency = lines / 4.0
    assert (frequency[0], frequency[-1]) == first.band_Hz
    assert frequency[0] >= 80.0 / 100.0
    density = train_response(TRACK, TRAIN, GermanLow(), frequency)["wheel_rail_force_psd"].values[:, 0]
    expected = density.sum() / 4.0
    squares = [0.5 * (np.abs(draw(seed).amplitude[:, 0]) ** 2).sum() for seed in range(40)]
    error = np.sqrt((density**2).sum()) / 4.0 / np.sqrt(40)
    assert abs(np.mean(squares) - expected) < 5 * error
    time, force = first.samples()
    assert (force[0] ** 2).mean() == pytest.approx(squares[0], rel=1e-9)
    course = first.courses()[0]
    between = time + 0.5 * (time[1] - time[0])
    rotation = np.exp(2j * np.pi * np.arange(first.amplitude.shape[0])[:, None] / 4.0 * between)
    exact = (first.amplitude[:, 0, None] * rotation).sum(0).real
    assert np.abs(course(between) - exact).max() < 1e-6 * np.abs(force).max()


def test_parts_add_up_and_the_seed_decides():
    options = {"train": TRAIN, "irregularity": GermanLow(), "quantity": "velocity", "window_s": 3.0}
    first, again, other = (run(seed=seed, **options) for seed in (3, 3, 4))
    assert list(first["part"].values) == ["quasi_static", "dynamic", "total"]
    parts = first["history"]
    total = parts.sel(part="quasi_static") + parts.sel(part="dynamic")
    assert np.abs(total - parts.sel(part="total")).max() < 1e-12 * np.abs(total).max()
    assert first.identical(again)
    assert np.array_equal(parts.sel(part="quasi_static"), other["history"].sel(part="quasi_static"))
    assert not np.allclose(parts.sel(part="dynamic"), other["history"].sel(part="dynamic"))
    alone = run(**{**options, "irregularity": None})
    assert np.array_equal(alone["history"][0], parts[0])
    assert first["wheel_force"].sizes == {"wheel": 4, "time": first.sizes["time"]}


def test_the_dynamic_part_has_the_power_of_the_standing_wheels():
    """Ensemble: while a train runs slowly over uniform track, a sensor sees what it would under a standing one.

    The energy of the passage, over 30 seeds, against the integral over the wheels' places of the density that
    train_response gives for the sensor; wheels are 2.5 m and more apart, their cross terms kept.
    """
    slow = Train(vehicle=crh380a(share=0.5), centre_m=0.0, speed_m_per_s=25.0)
    irregularity = GermanLow()
    energies = []
    for seed in range(30):
        data = run(train=slow, irregularity=irregularity, seed=seed, window_s=4.2, highest=24.0)
        energies.append(data["energy"].sel(part="dynamic").values[0])
    df = float(data["frequency"][1])
    frequency = data["frequency"].values[1:]
    kept = (frequency > 8.0) & (frequency < 20.0)
    measured = np.mean(energies, axis=0)[1:][kept].sum() * df
    centres = np.arange(-25.0, 25.01, 1.2) + 0.3
    density = []
    for centre in centres:
        standing = Train(vehicle=slow.vehicle, centre_m=float(centre), speed_m_per_s=25.0)
        answer = train_response(TRACK, standing, irregularity, frequency[kept][::6], sensors=[MIDDLE])
        density.append(answer["line_displacement_psd"].values[:, -1].sum() * df * 6)
    expected = np.sum(density) * 1.2 / 25.0
    # 50 lines and 30 seeds, correlated over a few lines: 10 %; the wheels move 1.2 m in a period of 20 Hz.
    assert measured == pytest.approx(expected, rel=0.15)


def test_a_window_is_found_that_holds_the_decay():
    data = run(line=BRIDGE, train=axles(0.0, body="girder"), sensors=(SPOT,), window_s=None, highest=60.0)
    assert data.attrs["wraparound_level"] <= 0.02
    longer = run(line=BRIDGE, train=axles(0.0, body="girder"), sensors=(SPOT,), window_s=40.0, highest=60.0)
    shape = CubicSpline(longer["time"], longer["history"][0, 0])(data["time"])
    assert np.abs(shape - data["history"][0, 0]).max() < 0.02 * np.abs(shape).max()


def test_static_loads_of_a_train_are_its_weight():
    loads = static_axles(TRAIN)
    vehicle = TRAIN.vehicle
    mass = vehicle.car_body_mass_kg + 2 * vehicle.bogie_mass_kg + 4 * vehicle.wheelset_mass_kg
    assert sum(loads.loads_N) == pytest.approx(0.5 * mass * 9.80665)
    assert list(loads.lags_m) == list(vehicle.lags_m())


def test_hslm_trains():
    """EN 1991-2, Table 6.3: 2 N + 14 axles; the ends mirror each other; bogies every D."""
    for number, coaches, length in ((1, 18, 18.0), (10, 11, 27.0)):
        train = hslm_a(number, speed_m_per_s=80.0)
        lags = train.lags
        assert lags.size == 2 * coaches + 14
        assert lags + lags[::-1] == pytest.approx(np.full(lags.size, lags[-1]))
        assert np.diff(lags[4:-4:2]) == pytest.approx(np.full(coaches + 2, length))
        assert lags[-1] == pytest.approx(2 * 20.525 + 2.0 + (coaches + 2) * length)
