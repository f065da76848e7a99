"""The sheet that goes with a folder: what the measuring team knows and believes."""

from __future__ import annotations

from typing import Any

from permway.challenge.layout import GRID_M, TOLERANCE, WHEEL_RADIUS_M, Layout, Tests, Values
from permway.challenge.plan import CONTACT_N_PER_M


def sheet(layout: Layout, nominal: Values, tests: Tests) -> dict[str, Any]:
    """The content of `sheet.json`; nothing of the truth is in it."""
    spacing, length = layout.spacing_m, layout.length_m
    first, last = -layout.approach_m, length + layout.approach_m
    many = layout.spans > 1
    return {
        "layout": {
            "spans": layout.spans,
            "span_m": layout.span_m,
            "fastener_spacing_m": spacing,
            "approach_m": layout.approach_m,
            "approach_bed": "rigid under the fasteners",
            "slab_length_m": layout.span_m,
            "slab": "free ends" + (", one slab to a span" * many),
            "base": "continuous over all spans, free ends",
            "girder": "free-free Euler beam on two bearings at its ends"
            + (", one to a span; piers stand between fasteners" * many),
            "beyond_approach": "the rail runs on without supports and without end, on both sides",
            "station_x": f"fasteners, mortar and sliding springs at x = 0.00, {spacing:.2f}, ..., {length:.2f} m; "
            f"in the approaches fasteners only, at {first:.2f} ... {-spacing:.2f} and "
            f"{length + spacing:.2f} ... {last:.2f} m",
        },
        "half_model": "one rail; sections, masses and stiffnesses below are already halved",
        "values": {group: dict(table) for group, table in nominal.items()},
        "layer_note": "pad.k is per fastener; mortar.k and sliding.k are totals over the whole deck, spread over "
        "the fastener stations (end stations take half a share); bearing.k per bearing, two per span",
        "contact_stiffness_N_per_m": CONTACT_N_PER_M,
        "tolerance_2sigma_relative": {group: dict(table) for group, table in TOLERANCE.items()},
        "temperature_C": list(tests.temperatures_C),
        "hammer": {
            "quantity": f"accelerance (m/s^2)/N, H1 of {tests.blows} blows, with coherence",
            "lines_Hz": list(tests.lines_Hz),
            "sensors": [list(location) for location in tests.sensors],
            "points": [list(location) for location in tests.points],
            "node_numbers": "UFF nodes: 10000*(rail 1, slab 2, base 3, girder 4) + x in cm",
        },
        "runs": {
            "sampling_Hz": tests.sampling_Hz,
            "seconds": tests.seconds,
            "unit": "m/s^2",
            "speeds_kmh": list(tests.speeds_kmh),
            "channels": list(tests.channels),
            "temperature": "the first of the hammer tests'",
            "position": f"wheelsets 1..4 at x0+10, x0+7.5, x0-7.5, x0-10 with x0 = {0.5 * length:g} m "
            f"(moving-irregularity model), each rounded to the nearest {GRID_M} m, halfway to the even multiple",
            "irregularity": "one-sided vertical PSD over wavenumber, m^2/(rad/m): German low disturbance "
            "4.032e-7*0.8246^2/((W^2+0.0206^2)(W^2+0.8246^2)) to W = 2 pi, then falling as W^-3.06, continuous; "
            f"measured to within 2 dB; wheel radius {WHEEL_RADIUS_M} m",
            "filter": "recorder's high-pass at 0.5 Hz, low-pass at 440 Hz",
        },
    }
