"""A UIC60 rail: pinned-pinned frequencies, on a Winkler bed, and on 241 supports.

Source: closed forms (Timoshenko 1921; Knothe and Grassie, Vehicle System Dynamics 22 (1993) 209-262) and the
track of the benchmark of rolland (TU Berlin), as printed in the project's reference values.

Symbols: E, G, kappa, I, rho, A of the rail -> `youngs_modulus_Pa`, `shear_modulus_Pa`, `shear_coefficient`,
`second_moment_m4`, `density_kg_per_m3`, `area_m2`. Two things the source does not say, found by trial, without
which no row holds to its printed digits: the mass is 60.20 kg/m (not rho A = 60.2095) with rotary inertia rho I
for rho = 7850, and the rail on 241 supports has a loss factor of 0.02, as the one on the Winkler bed.
Signs: exp(+i omega t), displacement along the force; receptance in m/N, |Y| = omega |receptance|.

The frequencies of the 241 supports are printed to 1 mHz; they are points of np.linspace(20, 3000, 1500), and
there all six values hold to the digits printed. At the rounded frequency the flank of the pinned-pinned peak
alone makes 4.6e-7 of a difference.

Left out: nothing. The Winkler bed is continuous and the solver's supports are discrete, so the bed's closed form
is held against the print here, and the solver against the print as the supports draw together.
"""

from itertools import pairwise

import numpy as np
import pytest
from lines import hysteretic, supported, uic60
from permway.model.line import Line
from permway.model.place import Place
from permway.response.decay import decay_rate
from permway.response.receptance import receptance
from scipy.optimize import brentq

FORMULATIONS = ("chain", "receptance")
BED = 300e6 * (1 + 0.25j)
MIDDLE = Place(body="rail", x_m=0.0)


def respond(line, frequency, *, at=(0.0,), formulation="chain"):
    """Receptances (F, sensors) to a force at x = 0."""
    sensors = [Place(body="rail", x_m=x) for x in at]
    data = receptance(line, frequency, forces=[MIDDLE], sensors=sensors, formulation=formulation)
    return data["receptance"].values[:, :, 0]


PINNED_PINNED = [  # bay m, Timoshenko Hz, Euler Hz
    (0.600, 1067.93, 1420.51),
    (0.625, 1000.88, 1309.14),
    (0.650, 939.76, 1210.37),
]


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize(("bay", "timoshenko", "euler"), PINNED_PINNED)
def test_pinned_pinned_frequency_of_one_bay(bay, timoshenko, euler, formulation):
    """One bay between two pins resonates where the stiffness of its middle vanishes."""
    for theory, printed in (("timoshenko", timoshenko), ("euler", euler)):
        # A trace of loss keeps the search off the resonance itself, where the line is singular.
        rail = uic60(theory=theory, loss_factor=1e-6).model_copy(
            update={"intervals_m": ((-bay / 2, bay / 2),), "ends": "pinned"}
        )
        line = Line(bodies={"rail": rail}, joints=(), laws={})

        def stiffness(frequency, line=line):
            return (1.0 / respond(line, [frequency], formulation=formulation)[0, 0]).real

        # Printed to 0.01 Hz.
        assert brentq(stiffness, 0.9 * printed, 1.1 * printed) == pytest.approx(printed, abs=0.0051)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize(("bay", "printed"), [row[:2] for row in PINNED_PINNED])
def test_pinned_pinned_peak_in_the_middle_of_a_bay(bay, printed, formulation):
    """On many supports the rail between them is loudest there, within the grid of 0.5 Hz."""
    track = supported(uic60(loss_factor=2e-4), count=240, spacing_m=bay, pad=hysteretic(BED))
    frequency = printed + np.arange(-20.0, 20.5, 0.5)
    peak = frequency[np.abs(respond(track, frequency, formulation=formulation)[:, 0]).argmax()]
    assert abs(peak - printed) <= 0.5


WINKLER = [  # Hz, receptance m/N, decay dB/m
    (100.0, 3.528752660e-9 - 6.815701399e-10j, 15.6703),
    (300.0, 5.979275029e-9 - 3.426885838e-9j, 10.6363),
    (700.0, -7.287603918e-10 - 1.254730361e-9j, 0.9695),
    (1000.0, -3.489697950e-10 - 7.012028501e-10j, 0.7087),
    (2000.0, -7.621698823e-11 - 2.971769524e-10j, 0.6866),
]
WINKLER_HZ, WINKLER_M_PER_N, WINKLER_DB_PER_M = (np.array(column) for column in zip(*WINKLER, strict=True))


def winkler(frequency, distance=0.0):
    """Receptance of the rail on the bed, and exponents (2, F) of its two waves: the bed lessens the mass."""
    rail, omega = uic60(loss_factor=0.02), 2 * np.pi * frequency
    bending, shear = rail.bending_Nm2, rail.shear_N
    load, rotary = rail.mass_kg_per_m * omega**2 - BED, rail.rotary_kg_m * omega**2
    total, product = -(rotary / bending + load / shear), load / bending * (rotary / shear - 1.0)
    root = np.sqrt(total**2 - 4.0 * product)
    exponents = -np.sqrt(np.stack([total + root, total - root]) / 2.0)
    force = -load / exponents
    rotation = exponents - force / shear
    size = rotation[0] * force[1] - rotation[1] * force[0]
    waves = np.exp(exponents * distance)
    return (rotation[1] * waves[0] - rotation[0] * waves[1]) / (2.0 * size), exponents


def test_winkler_closed_form_has_the_printed_digits():
    """Ten digits printed, the last off by at most one; decay to 0.0001 dB/m, with 8.686 for 20 lg e."""
    value, exponents = winkler(WINKLER_HZ)
    assert np.abs(value - WINKLER_M_PER_N) == pytest.approx(0.0, abs=1e-10 * 6.8e-9)
    assert np.abs(value / WINKLER_M_PER_N - 1.0).max() < 2e-10
    assert 8.686 * np.abs(exponents.real).min(axis=0) == pytest.approx(WINKLER_DB_PER_M, abs=0.000051)


def bed_of_supports(spacing, reach=120.0):
    """So long that what its ends send back, after 240 m at 0.69 dB/m, is below 1e-8."""
    count = 2 * round(reach / spacing) + 1
    rail = uic60(loss_factor=0.02)
    return supported(rail, count=count, spacing_m=spacing, pad=hysteretic(BED * spacing))


def test_supports_drawn_together_become_the_winkler_bed():
    """The difference falls as the square of the spacing; extrapolated, it is below 1e-7.

    Sampling a bed at a spacing d is its integral by the trapezium rule, whose error is a d^2 + b d^4.
    """
    spacings = (0.1, 0.05, 0.025)
    values = [respond(bed_of_supports(d), WINKLER_HZ)[:, 0] for d in spacings]
    errors = [np.abs(v / WINKLER_M_PER_N - 1.0) for v in values]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.05)
    first, second = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(values))
    assert np.abs((16.0 * second - first) / 15.0 / WINKLER_M_PER_N - 1.0).max() < 1e-7


def test_decay_rate_of_the_solved_track_is_that_of_the_slower_wave():
    """Between 6 and 7 m both waves count below 700 Hz: held against the closed form, and from there to print.

    Supports every 25 mm; the rate differs by the square of the spacing, a few 1e-4 of itself.
    """
    near, far = (winkler(WINKLER_HZ, x)[0] for x in (6.0, 7.0))
    solved = respond(bed_of_supports(0.025), WINKLER_HZ, at=(6.0, 7.0))
    rate = decay_rate(solved[:, 0], solved[:, 1], 1.0)
    assert rate == pytest.approx(decay_rate(near, far, 1.0), rel=1e-3)
    assert rate[2:] == pytest.approx(WINKLER_DB_PER_M[2:], rel=1e-3)


SUPPORTS = [  # point of the grid, as printed Hz, |Y| on pads m/s/N, |Y| on pads, sleepers and ballast
    (0, 20.0, 2.7166909598e-7, 9.6359842565e-7),
    (241, 499.106, 1.35155979e-5, 1.33928724e-5),
    (493, 1000.080, 3.23204212e-6, 3.22827255e-6),
    (996, 2000.040, 3.91022320e-6, 3.91157520e-6),
]


@pytest.mark.parametrize(("sleeper_kg", "column"), [(None, 2), (162.0, 3)])
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_241_supports(sleeper_kg, column, formulation):
    """Nine digits printed, eleven at 20 Hz: half a unit of the last is below 5e-9, and 5e-11."""
    grid = np.linspace(20.0, 3000.0, 1500)[[row[0] for row in SUPPORTS]]
    assert grid == pytest.approx([row[1] for row in SUPPORTS], abs=0.0005)
    ballast = hysteretic(50e6 * (1 + 1j))
    rail = uic60(loss_factor=0.02)
    track = supported(rail, count=241, spacing_m=0.6, pad=hysteretic(BED), ballast=ballast, sleeper_kg=sleeper_kg)
    mobility = 2 * np.pi * grid * np.abs(respond(track, grid, formulation=formulation)[:, 0])
    printed = np.array([row[column] for row in SUPPORTS])
    assert np.abs(mobility / printed - 1.0).max() < 5e-9
    assert mobility[0] == pytest.approx(printed[0], rel=5e-11)
