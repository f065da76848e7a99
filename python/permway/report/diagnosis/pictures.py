"""All pictures of a diagnosis, by name."""

from __future__ import annotations

from collections.abc import Iterator

from matplotlib.figure import Figure

from permway.diagnosis.result import Diagnosis
from permway.report.diagnosis.better import curve_pictures, gain_picture, parameter_picture
from permway.report.diagnosis.where import frequency_picture, track_picture


def pictures(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """Names and figures: `track`, `frequency`, `gain-` and `curves-` of records, `parameters`."""
    if diagnosis.found:
        yield "track", track_picture(diagnosis)
        yield "frequency", frequency_picture(diagnosis)
    yield from gain_picture(diagnosis)
    yield from curve_pictures(diagnosis)
    if diagnosis.base.free:
        yield "parameters", parameter_picture(diagnosis)
