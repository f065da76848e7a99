"""Moving forces, moving sprung masses and trains over simply supported beams; a moving harmonic force on a track.

Sources, as printed in the project's reference values: Fryba, Vibration of Solids and Structures under Moving Loads
(1999), force at constant speed, with the numbers of a benchmark of 5750 kg; Yang and Yau, Journal of Structural
Engineering 123 (1997) 1512-1518, sprung mass; HSLM-A, EN 1991-2:2003, 6.4.6.1.1. Symbols: L, E, I, m of the beam;
P = Mv g, Mv and k of the vehicle; V, speed. Signs: displacement positive down (Yang and Yau print it up).

The printed beams have no loss, and the solver takes real frequencies only: the beams get small hysteretic losses
eta, windows of 1 / eta s and more, and the answer is extrapolated to no loss, Richardson's way, over eta, eta / 2
(and eta / 4). Printed values are those of a grid of time, so they are held at their printed time.

Left out: the printed first-mode figure of 54.8 m/s2 for HSLM-A1. It does not come out of the standard's train as
written here; see the test.
"""

from itertools import pairwise

import numpy as np
import pytest
from lines import hysteretic, supported, uic60
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.model.place import Place
from permway.response.passby import Axles, MassOnSpring, couple, hslm_a, passby
from permway.response.passby.carry import arrivals, carried, harmonic_moments
from permway.response.passby.path import path_of
from permway.response.passby.transfer import transfer
from scipy.interpolate import CubicSpline
from scipy.signal import cont2discrete, lfilter

CENTRE = [Place(body="beam", x_m=12.5)]
G = 9.81
STANDARD_GRAVITY = 9.80665


def bridge(modulus, second_moment, mass, loss_factor, *, length=25.0, modes=None):
    # An area that goes with the second moment; the mass is what counts.
    beam = Beam(
        youngs_modulus_Pa=modulus,
        second_moment_m4=second_moment,
        density_kg_per_m3=mass / second_moment,
        area_m2=second_moment,
        intervals_m=((0.0, length),),
        ends="pinned",
        loss_factor=loss_factor,
        modes=modes,
    )
    return Line(bodies={"beam": beam}, joints=(), laws={})


def lossless(answer, *losses):
    """Richardson's extrapolation of a row of losses, each half of the one before."""
    row = [answer(eta) for eta in losses]
    for power in range(1, len(losses)):
        row = [(2**power * fine - coarse) / (2**power - 1) for coarse, fine in pairwise(row)]
    return row[0]


def test_moving_force():
    """Printed to seven digits, and the closed form of 100 modes: both held to 5e-6.

    What is left is the cut at 150 Hz, above which modes 7 and on are; it is five times as much for a cut at 60 Hz.
    """

    def centre(eta):
        axles = Axles(lags_m=(0.0,), loads_N=(5750 * G,), speed_m_per_s=25.0, body="beam")
        line = bridge(3.5e10, 1.3901, 18358.0, eta)
        data = passby(
            line,
            axles,
            sensors=CENTRE,
            highest_Hz=150.0,
            quantity="displacement",
            window_s=1.4 / eta,
            wraparound_limit=0.05,
        )
        return CubicSpline(data["time"], data["history"][0, 0])(np.array([0.2, 0.438, 0.7]))

    value = lossless(centre, 0.02, 0.01, 0.005)
    assert value[1] == pytest.approx(4.192782e-4, rel=5e-6)
    order, time = np.arange(1, 101)[:, None], np.array([0.2, 0.438, 0.7])
    natural = (order * np.pi / 25.0) ** 2 * np.sqrt(3.5e10 * 1.3901 / 18358.0)
    driven = order * np.pi
    modes = np.sin(driven * time) - driven / natural * np.sin(natural * time)
    shape = np.sin(order * np.pi / 2) / (natural**2 - driven**2)
    closed = (2 * 5750 * G / (18358.0 * 25.0) * shape * modes).sum(axis=0)
    assert np.abs(value - closed).max() < 5e-6 * np.abs(closed).max()


@pytest.mark.parametrize(
    ("beam", "speed", "time", "printed", "half_unit"),
    [
        ((3.5e10, 1.3901, 18358.0), 25.0, 0.436, 4.186e-4, 0.0005e-4),
        ((2.87e9, 2.90, 2303.0), 100 / 3.6, 0.371, 2.4073e-3, 0.00005e-3),
    ],
    ids=["Fryba", "Yang and Yau"],
)
def test_moving_sprung_mass(beam, speed, time, printed, half_unit):
    """5750 kg on 1.595e6 N/m, to all digits printed; steps of 5 ms. Weights are with g = 9.81."""

    def centre(eta):
        data = couple(
            bridge(*beam, eta),
            MassOnSpring(mass_kg=5750.0),
            speed_m_per_s=speed,
            contact_N_per_m=1.595e6,
            step_s=0.005,
            sensors=CENTRE,
            body="beam",
            window_s=1.0 / eta,
        )
        history = CubicSpline(data["time"], data["displacement"][0])
        return history(np.linspace(0.3, 0.5, 2001)) * G / STANDARD_GRAVITY

    value = lossless(centre, 0.04, 0.02, 0.01)
    assert value[np.argmin(np.abs(np.linspace(0.3, 0.5, 2001) - time))] == pytest.approx(printed, abs=half_unit)
    assert np.linspace(0.3, 0.5, 2001)[value.argmax()] == pytest.approx(time, abs=0.001)


def first_mode(axles, mass, length, frequency, damping):
    """Largest acceleration at midspan, from the equation of the first mode with viscous damping, in time."""
    omega, step = 2 * np.pi * frequency, 2e-4
    time = np.arange(0.0, (length + axles.lags_m[-1]) / axles.speed_m_per_s + 1.0, step)
    place = axles.speed_m_per_s * time - axles.lags[:, None]
    on = (place > 0) & (place < length)
    force = 2 / (mass * length) * (axles.loads[:, None] * on * np.sin(np.pi * place / length)).sum(axis=0)
    system = np.array([[0.0, 1.0], [-(omega**2), -2 * damping * omega]])
    out = system[[1]]
    discrete = cont2discrete((system, np.array([[0.0], [1.0]]), out, np.array([[1.0]])), step, "foh")
    poles = np.poly(discrete[0])
    zeros = np.poly(discrete[0] - discrete[1] @ discrete[2]) + (discrete[3][0, 0] - 1) * poles
    return float(np.abs(lfilter(zeros, poles, force)).max())


SPEEDS_KM_PER_H = (315.0, 320.0, 322.5, 325.0, 327.5, 330.0, 335.0)


def one_more_coach(axles):
    """The train with a bogie more: 19 intermediate coaches."""
    lags = axles.lags
    lags = np.concatenate([lags[:-4], lags[-6:-4] + 18.0, lags[-4:] + 18.0])
    return axles.model_copy(update={"lags_m": tuple(lags), "loads_N": (170e3,) * lags.size})


def test_hslm_a1_is_in_resonance_at_the_frequency_times_the_coach():
    """Printed: 54.8 m/s2 at 325 km/h (f D = 324), first mode only, L 15 m, 5 Hz, 15 t/m, 1 % damping.

    The first mode is `modes = 1` of the receptance formulation; its hysteretic loss of 0.02 is 1 % viscous damping
    at resonance, and differs off it. The speed comes out. The height does not with N = 18 intermediate coaches and
    2 N + 14 axles (21 bogies): 53.5, and 53.6 by the equation in time with viscous damping; with a bogie more it
    is 54.8 by that equation, so the source's train seems to have 22. All are held against the equation in time,
    within 0.4 %.
    """
    mass, length = 15e3, 15.0
    bending = mass * (2 * np.pi * 5.0 * (length / np.pi) ** 2) ** 2
    line = bridge(bending, 1.0, mass, 0.02, length=length, modes=1)

    def acceleration(axles):
        data = passby(
            line,
            axles,
            sensors=[Place(body="beam", x_m=length / 2)],
            highest_Hz=120.0,
            quantity="acceleration",
            formulation="receptance",
        )
        return float(np.abs(data["history"]).max())

    trains = [hslm_a(1, speed_m_per_s=v / 3.6, body="beam") for v in SPEEDS_KM_PER_H]
    peaks = np.array([acceleration(axles) for axles in trains])
    assert SPEEDS_KM_PER_H[int(peaks.argmax())] == 325.0
    equation = np.array([first_mode(axles, mass, length, 5.0, 0.01) for axles in trains])
    assert np.abs(peaks / equation - 1).max() < 0.004
    longer = one_more_coach(trains[3])
    assert first_mode(longer, mass, length, 5.0, 0.01) == pytest.approx(54.8, abs=0.05)
    assert acceleration(longer) == pytest.approx(54.8, rel=0.004)


def test_a_harmonic_force_meets_the_pinned_pinned_resonance_in_the_middle_of_a_bay():
    """UIC60, bays of 0.6 m, 1067.93 Hz, 0.5 m/s: the rail is loudest mid-bay and quietest over a support.

    The envelope at a fixed sensor while the force stands over it, against the receptance there. The waves of the
    resonance are two bays long and shift by V / 1.2 m, 0.4 Hz, to either side; its half width is 8 Hz, so the two
    differ by less than that share, 5 %. (At 5 m/s they do: 4 Hz take 15 % off the peak.)
    """
    track = supported(uic60(loss_factor=0.01), count=121, spacing_m=0.6, pad=hysteretic(3e8 * (1 + 0.1j)))
    force_Hz, speed = 1067.93, 0.5
    # Support, quarter and middle of a bay; the count is odd, so a support stands at 0.
    sensors = [Place(body="rail", x_m=x) for x in (0.0, 0.15, 0.3)]
    frequency = force_Hz + np.arange(-80.0, 80.0, 0.2)
    path = path_of(
        track,
        "rail",
        from_m=-1.2,
        to_m=1.2,
        ramp_m=0.3,
        highest_Hz=1300.0,
        order=10,
        kinks_m=tuple(s.x_m for s in sensors),
    )
    omega, rotation = 2 * np.pi * frequency, 2 * np.pi * force_Hz
    values = transfer(track, frequency, sensors=sensors, places=path.places())
    # At x = 0 in the middle of a window of five seconds.
    moments = harmonic_moments(path, omega, speed, rotation)
    moments = moments * arrivals(omega, np.ones(1), np.array([2.5]), rotation)[:, None, None]
    spectrum, last = carried(path.coefficients(values), moments)
    assert np.abs(last).max() < 1e-5 * np.abs(spectrum).max()
    passing = [2.5 + s.x_m / speed for s in sensors]
    envelope = np.array(
        [abs(0.2 * (spectrum[:, i] * np.exp(1j * omega * t)).sum()) for i, t in enumerate(passing)]
    )
    standing = transfer(track, np.array([force_Hz]), sensors=sensors, places=sensors)[0]
    standing = np.abs(np.diag(standing))
    assert np.abs(envelope / standing - 1).max() < 0.05
    assert envelope[2] > 1.5 * envelope[1]
    assert envelope[1] > 5.0 * envelope[0]
