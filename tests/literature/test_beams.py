"""Beams alone against closed forms: girder, free slab, infinite beam, static limits, an oscillator.

Sources: the project's reference values (girder and free-free beam); Graff, Wave Motion in Elastic Solids (1975),
infinite beam; Timoshenko, Strength of Materials, static deflections; Hetenyi, Beams on Elastic Foundation (1946).
Symbols: E I, complex, `bending_Nm2`; m, `mass_kg_per_m`; k = (m omega^2 / (E I))^(1/4). Signs: exp(+i omega t),
displacement along the force. The section is given by modulus and inertia as printed; area and density only by
their product.

Moving forces and masses, and trains over bridges, are in `test_moving_loads.py`.
"""

import numpy as np
import pytest
from permway.laws import Hysteretic, KelvinVoigt
from permway.model.bodies import Beam, Mass
from permway.model.joints import GROUND, Joints, Spread
from permway.model.line import Line
from permway.model.place import Place
from permway.response.decay import decay_rate
from permway.response.receptance import receptance
from scipy.optimize import brentq

pytestmark = pytest.mark.parametrize("formulation", ["chain", "receptance"])


def beam(modulus, second_moment, mass, length=None, *, loss_factor=0.0, ends="free", modes=None):
    # An area that goes with the second moment; the mass is what counts.
    area = max(second_moment, 1e-3)
    return Beam(
        youngs_modulus_Pa=modulus,
        second_moment_m4=second_moment,
        density_kg_per_m3=mass / area,
        area_m2=area,
        loss_factor=loss_factor,
        intervals_m=None if length is None else ((0.0, length),),
        ends=ends,
        modes=modes,
    )


def alone(body, **bodies):
    return Line(bodies={"beam": body, **bodies}, joints=(), laws={})


def respond(line, frequency, force, *sensors, formulation, body="beam"):
    places = [Place(body=body, x_m=x) for x in (sensors or (force,))]
    forces = [Place(body=body, x_m=force)]
    data = receptance(line, frequency, forces=forces, sensors=places, formulation=formulation)
    return data["receptance"].values[:, :, 0]


def wavenumber(body, frequency):
    return (body.mass_kg_per_m * (2 * np.pi * np.asarray(frequency)) ** 2 / body.bending_Nm2) ** 0.25


GIRDER = beam(3.45e10, 12.744, 29720.0, 32.5, loss_factor=0.1, ends="pinned")
GIRDER_CENTRE = [(1.0, 1.668317e-9), (5.72, 1.603321e-8), (50.0, 1.648455e-10)]


@pytest.mark.parametrize(("frequency", "printed"), GIRDER_CENTRE)
def test_simply_supported_girder_at_its_centre(frequency, printed, formulation):
    """Seven digits printed; the closed form [tan(kL/2) - tanh(kL/2)] / (4 E I k^3) to 1e-12."""
    value = respond(alone(GIRDER), [frequency], 16.25, formulation=formulation)[0, 0]
    assert abs(value) == pytest.approx(printed, rel=4e-7)
    k = wavenumber(GIRDER, frequency)
    half = k * 16.25
    assert value == pytest.approx((np.tan(half) - np.tanh(half)) / (4 * GIRDER.bending_Nm2 * k**3), rel=1e-12)


SLAB = beam(3.6e10, 1.6e-3, 1200.0, 6.45, loss_factor=0.02)


@pytest.mark.parametrize(("frequency", "printed"), [(10.0, 7.160116e-8), (200.0, 1.603340e-9)])
def test_free_free_beam_at_its_tip(frequency, printed, formulation):
    """Seven digits printed; tip receptance (sin cosh - cos sinh) / (E I k^3 (cos cosh - 1)) of kL to 1e-11."""
    value = respond(alone(SLAB), [frequency], 0.0, formulation=formulation)[0, 0]
    assert abs(value) == pytest.approx(printed, rel=4e-7)
    k = wavenumber(SLAB, frequency)
    a = k * 6.45
    tip = np.sin(a) * np.cosh(a) - np.cos(a) * np.sinh(a)
    assert value == pytest.approx(tip / (SLAB.bending_Nm2 * k**3 * (np.cos(a) * np.cosh(a) - 1)), rel=1e-11)


@pytest.mark.parametrize("printed", [18.752, 51.691, 101.335])
def test_free_free_beam_resonates(printed, formulation):
    """Nearly without loss the stiffness of the tip vanishes there; printed to 1 mHz.

    Without any, a search ends at the singular frequency itself, which the solver refuses.
    """
    lossless = alone(SLAB.model_copy(update={"loss_factor": 1e-6}))

    def stiffness(frequency):
        return (1.0 / respond(lossless, [frequency], 0.0, formulation=formulation)[0, 0]).real

    assert brentq(stiffness, printed - 0.5, printed + 0.5) == pytest.approx(printed, abs=0.0006)


def test_zeng_2014_girder_frequencies(formulation):
    """Zeng et al., Shock and Vibration 2014, 304219: 5.72 and 22.89 Hz, printed to 0.01 Hz.

    The second is 4 times the first, so the unrounded first was 5.7225; the modulus printed as 3.45e10 leaves
    0.07 % of it open. The rest of that line, slabs in lengths on nine spans, is left to a test of layouts.
    """
    lossless = alone(GIRDER.model_copy(update={"loss_factor": 1e-6}))

    def stiffness(frequency):
        # At a quarter of the span neither of the first two modes has a node.
        return (1.0 / respond(lossless, [frequency], 32.5 / 4, formulation=formulation)[0, 0]).real

    for printed in (5.72, 22.89):
        assert brentq(stiffness, printed - 0.5, printed + 0.5) == pytest.approx(printed, rel=7e-4)


@pytest.mark.parametrize("frequency", [1.0, 55.0, 3000.0])
def test_infinite_euler_beam(frequency, formulation):
    """w(x) = -(i exp(-ikx) + exp(-kx)) / (4 E I k^3) for a unit force at 0 (Graff, section 3.2)."""
    rail = beam(2.1e11, 3.217e-5, 60.8, loss_factor=0.01)
    distance = np.array([0.0, 0.3, 2.0])
    value = respond(alone(rail), [frequency], 0.0, *distance, formulation=formulation)[0]
    k = wavenumber(rail, frequency)
    closed = -(1j * np.exp(-1j * k * distance) + np.exp(-k * distance)) / (4 * rail.bending_Nm2 * k**3)
    # The chain's transfers lose e^4 of 1e-16 a wavelength at most.
    assert np.abs(value / closed - 1).max() < 1e-11


@pytest.mark.parametrize("loss_factor", [0.05, 0.3])
def test_decay_rate_of_one_wave(loss_factor, formulation):
    """Far from the force one wave exp(-b x) is left: 8.686 b dB/m, whatever two places it is read at."""
    rail = beam(2.1e11, 3.217e-5, 60.8, loss_factor=loss_factor)
    frequency = np.array([300.0, 1000.0])
    near, far, further = respond(alone(rail), frequency, 0.0, 12.0, 15.0, 22.0, formulation=formulation).T
    b = -wavenumber(rail, frequency).imag
    for rate in (decay_rate(near, far, 3.0), decay_rate(far, further, 7.0)):
        assert rate == pytest.approx(20.0 / np.log(10.0) * b, rel=1e-9)
        assert rate == pytest.approx(8.686 * b, rel=2e-5)


SPRING = 3.0e8


@pytest.mark.parametrize(
    ("ends", "at", "springs", "closed"),
    [
        ("pinned", 4.0, (), lambda bending: 8.0**3 / (48 * bending)),
        # A lever about the pin: tip of a bar on a spring at its middle, plus what it bends.
        (("pinned", "free"), 8.0, (4.0,), lambda bending: 4.0 / SPRING + 4.0**2 * 8.0 / (3 * bending)),
        # Two springs at the ends, force in the middle; and a force at a free overhang.
        ("free", 4.0, (0.0, 8.0), lambda bending: 1 / (2 * SPRING) + 8.0**3 / (48 * bending)),
        ("free", 8.0, (0.0, 5.0), lambda bending: (0.6**2 + 1.6**2) / SPRING + 3.0**2 * 8.0 / (3 * bending)),
    ],
)
def test_static_limit(ends, at, springs, closed, formulation):
    """At 1e-3 Hz a beam of 30 MN m2 deflects as at rest: its first resonance is 1e4 times higher."""
    body = beam(3e10, 1e-3, 640.0, 8.0, ends=ends)
    ground = tuple(Joints(between=("beam", GROUND), law="spring", at=(x,)) for x in springs)
    line = Line(bodies={"beam": body}, joints=ground, laws={"spring": Hysteretic(stiffness=SPRING)})
    value = respond(line, [1e-3], at, formulation=formulation)[0, 0]
    assert value == pytest.approx(closed(3e7), rel=1e-7)


def test_static_deflection_of_a_beam_on_an_elastic_bed(formulation):
    """P / (8 E I beta^3) under the force (Hetenyi), beta^4 = s / (4 E I), from supports every 0.05 m.

    Sampling the bed errs by (beta d)^4, 4e-6 here; 30 m either side are 40 / beta.
    """
    bending, bed, spacing = 2.1e11 * 3.217e-5, 1e8, 0.05
    at = Spread(from_m=-15.0, to_m=15.0, spacing_m=spacing)
    line = Line(
        bodies={"beam": beam(2.1e11, 3.217e-5, 60.8)},
        joints=(Joints(between=("beam", GROUND), law="bed", at=at),),
        laws={"bed": Hysteretic(stiffness=bed * spacing)},
    )
    beta = (bed / (4 * bending)) ** 0.25
    value = respond(line, [1e-2], 0.0, formulation=formulation)[0, 0]
    assert value == pytest.approx(1 / (8 * bending * beta**3), rel=1e-4)


def test_two_mass_oscillator(formulation):
    """Two masses on springs with dashpots against the two equations of motion, to 1e-12.

    The beam that a line must have is not tied to them.
    """
    upper, lower, frequency = 130.0, 900.0, np.array([1.0, 17.0, 60.0, 400.0, 3000.0])
    line = Line(
        bodies={"beam": beam(3e10, 1e-3, 640.0, 8.0), "upper": Mass(mass_kg=upper), "lower": Mass(mass_kg=lower)},
        joints=(
            Joints(between=("upper", "lower"), law="soft", at=(2.0,)),
            Joints(between=("lower", GROUND), law="stiff", at=(2.0,)),
        ),
        laws={"soft": KelvinVoigt(stiffness=4e6, damping=3e3), "stiff": KelvinVoigt(stiffness=9e7, damping=4e4)},
    )
    places = [Place(body=name, x_m=2.0) for name in ("upper", "lower")]
    data = receptance(line, frequency, forces=places, sensors=places, formulation=formulation)
    value = data["receptance"].values
    omega = 2 * np.pi * frequency
    soft, stiff = 4e6 + 3e3j * omega, 9e7 + 4e4j * omega
    first, second = soft - omega**2 * upper, soft + stiff - omega**2 * lower
    size = first * second - soft**2
    closed = np.moveaxis(np.array([[second, soft], [soft, first]]) / size, 2, 0)
    assert np.abs(value / closed - 1).max() < 1e-12
