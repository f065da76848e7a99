"""All pictures of a comparison, by name: curves, maps, parameters, what is left."""

from __future__ import annotations

from collections.abc import Iterator

from matplotlib.figure import Figure

from permway.diagnosis.compare import Comparison
from permway.report.compare.curves import curve_pictures
from permway.report.compare.maps import level_maps, sigma_maps
from permway.report.compare.remains import noise_pictures, parameter_picture


def pictures(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Names and figures: `level-`, `sigma-`, `curves-`, `left-` of records or kinds, and `parameters`."""
    yield from level_maps(comparison)
    yield from sigma_maps(comparison)
    yield from curve_pictures(comparison)
    if comparison.fit is not None:
        if comparison.parameters.sizes["parameter"]:
            yield "parameters", parameter_picture(comparison)
        yield from noise_pictures(comparison)
