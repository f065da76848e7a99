"""What the paper prints: tables 5 to 8, read as data."""

from __future__ import annotations

from dataclasses import dataclass

TEMPERATURES_C = (20, -20, -30)
SPEED_M_PER_S = 350.0 / 3.6
LOSS_FACTOR_PEAK = 0.55
"""Largest loss factor of the pad's DMA test at 2 Hz, section 3.5.1 (at -45.7 degC)."""
GLASS_TRANSITION_C = -45.7
LOSS_MODULUS_PEAK_C = -50.7


@dataclass(frozen=True)
class Printed:
    """One number of a table.

    Attributes
    ----------
    table : str
        Table or figure.
    quantity : str
        Key of what is computed for it: see :mod:`permway.paper.readings`.
    temperature_C : int
    value : float
        As printed.
    unit : str
    at_Hz : float or None
        Printed frequency of a value; None where the value itself is a frequency.
    """

    table: str
    quantity: str
    temperature_C: int
    value: float
    unit: str
    at_Hz: float | None = None


def _rows() -> tuple[Printed, ...]:
    psd = "(m/s2)2/Hz"
    rows = []
    for t, minimum, force, wheelset, rail, body, pitch in (
        (20, 59, (3.646e4, 55), (1703.0, 55), (3074.0, 55), (0.40840, 0.06800), (0.01041, 0.00081)),
        (-20, 75, (1.470e4, 75), (275.6, 75), (625.7, 75), (0.40860, 0.06732), (0.01040, 0.00080)),
        (-30, 93, (1.203e4, 85), (184.0, 85), (473.8, 98), (0.40870, 0.06700), (0.01039, 0.00079)),
    ):
        rows += [
            Printed("Figures 11-13", "flexibility_minimum_Hz", t, minimum, "Hz"),
            Printed("Table 5", "force", t, force[0], "N", force[1]),
            Printed("Table 5", "force_peak_Hz", t, force[1], "Hz"),
            Printed("Table 6", "body_bounce", t, body[0], psd, 1),
            Printed("Table 6", "body_bounce", t, body[1], psd, 5),
            Printed("Table 6", "body_pitch", t, pitch[0], "(rad/s2)2/Hz", 1),
            Printed("Table 6", "body_pitch", t, pitch[1], "(rad/s2)2/Hz", 7),
            Printed("Table 7", "wheelset", t, wheelset[0], psd, wheelset[1]),
            Printed("Table 7", "wheelset_peak_Hz", t, wheelset[1], "Hz"),
            Printed("Table 8", "rail", t, rail[0], psd, rail[1]),
            Printed("Table 8", "rail_peak_Hz", t, rail[1], "Hz"),
        ]
    rows.append(Printed("Figures 11-13", "bridge_peak_Hz", 20, 5, "Hz"))
    return tuple(rows)


PRINTED = _rows()
"""All rows, in the order of the temperatures."""

TABLE_1 = {
    "storage": {
        "mu1": 0.008,
        "eta1": 0.004,
        "mu2": 59.672,
        "eta2": 17.537,
        "alpha": 0.041,
        "beta": 0.08,
        "gamma": 0.232,
    },
    "loss": {
        "mu1": 0.0,
        "eta1": 2.757,
        "mu2": 0.001,
        "eta2": 0.001,
        "alpha": 1.754,
        "beta": 2.813,
        "gamma": 0.216,
    },
}
"""Table 1: FVMP parameters in MPa, fitted separately to storage and loss modulus at 20 degC."""
