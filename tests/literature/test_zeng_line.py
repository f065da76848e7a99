"""The nine-span line of Zeng et al. (2014): printed frequencies and values of its girder, and the line as a whole.

Source: Numerical Simulation of Vertical Random Vibration of Train-Slab Track-Bridge Interaction System by PEM,
Shock and Vibration 2014, 304219, Table 2, and closed forms as printed in the project's reference values.

Symbols: E, I, m of the girder -> `youngs_modulus_Pa`, `second_moment_m4`, `mass_kg_per_m`; its damping ratio of
5 % -> `loss_factor` 0.1; k and c of fastener, CA layer and bearing -> Kelvin-Voigt laws.

Left out: the printed random vibration, for which the fastener spacing, the number of slabs and the irregularity
would have to be known; they are not in the table.
"""

import numpy as np
import pytest
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import LINES
from permway.response.receptance import receptance
from scipy.optimize import brentq

SPAN_M = 32.5


def girder(loss_factor):
    """One simply supported girder of the preset alone."""
    whole = LINES["zeng2014_nine_spans"](girder="pinned").bodies["girder"]
    alone = whole.model_copy(update={"intervals_m": ((0.0, SPAN_M),), "loss_factor": loss_factor})
    return Line(bodies={"girder": alone}, joints=(), laws={})


def direct(line, frequency, x_m, body="girder", formulation="chain"):
    place = [Place(body=body, x_m=x_m)]
    data = receptance(line, frequency, forces=place, sensors=place, formulation=formulation, threads=1)
    return data["receptance"].values[:, 0, 0]


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize(("printed", "x_m"), [(5.72, SPAN_M / 2), (22.89, SPAN_M / 4)])
def test_printed_natural_frequencies_of_the_girder(printed, x_m, formulation):
    """Printed to 0.01 Hz; where the girder, all but lossless, no longer resists: at its middle, at a quarter."""

    def resistance(frequency):
        return 1.0 / direct(girder(1e-6), [frequency], x_m, formulation=formulation)[0].real

    found = brentq(resistance, printed - 0.2, printed + 0.2)
    # 5.7199 and 22.8797, four times the first: the print of the second is 0.01 high.
    assert found == pytest.approx(printed, abs=0.012)


def test_printed_receptance_of_the_girder():
    """Seven digits printed: [tan(kL/2) - tanh(kL/2)] / (4 E I k^3)."""
    printed = [1.668317e-9, 1.603321e-8, 1.648455e-10]
    found = direct(girder(0.1), [1.0, 5.72, 50.0], SPAN_M / 2)
    assert np.abs(found) == pytest.approx(printed, rel=4e-7)


def test_the_track_lowers_the_first_resonance_by_its_mass():
    """31041 instead of 29720 kg/m: 5.72 becomes 5.60 Hz, hardly more for the rails' stiffness."""
    line = LINES["zeng2014_nine_spans"](girder="pinned", spans=3)
    frequency = np.arange(5.0, 6.5, 0.01)
    peak = frequency[np.abs(direct(line, frequency, 1.5 * SPAN_M, body="girder[2]")).argmax()]
    assert peak == pytest.approx(5.72 * np.sqrt(29720.0 / 31041.3), abs=0.05)


def test_bearings_lower_it_further():
    """On 6e9 N/m under either end the girder also moves as a block: below the pinned one, by less than a tenth."""
    frequency = np.arange(4.5, 6.5, 0.01)
    peaks = []
    for support in ("pinned", "elastic_bearings"):
        line = LINES["zeng2014_nine_spans"](girder=support, spans=3)
        peaks.append(frequency[np.abs(direct(line, frequency, 1.5 * SPAN_M, body="girder[2]")).argmax()])
    assert 0.9 * peaks[0] < peaks[1] < peaks[0]
