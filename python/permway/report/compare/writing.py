"""Writes a comparison: `report.html`, `comparison.nc` and `pictures/`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import xarray as xr

from permway.diagnosis.compare import Comparison
from permway.files import prepare_folder, write_bytes, write_text
from permway.problem.solve import netcdf_bytes

PAGE, NUMBERS, PICTURES = "report.html", "comparison.nc", "pictures"


def write_comparison(comparison: Comparison, output: Path, *, dpi: int = 140) -> dict[str, Any]:
    """Write page, numbers and pictures.

    Parameters
    ----------
    comparison : Comparison
    output : Path
        Folder; made if its parent exists.
    dpi : int
        Of the pictures.

    Returns
    -------
    dict
        Paths, and the comparison's summary.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    # Drawing is slow to import.
    from permway.report.compare.page import render
    from permway.report.compare.pictures import pictures
    from permway.report.readout import drawn

    output = Path(output)
    prepare_folder(output, (PAGE, NUMBERS))
    folder = prepare_folder(output / PICTURES)
    images = drawn(pictures(comparison), dpi)
    for name, picture in images.items():
        write_bytes(folder / f"{name}.png", picture.png)
    return {
        "report": str(write_text(output / PAGE, render(comparison, images))),
        "numbers": str(write_bytes(output / NUMBERS, netcdf(comparison))),
        "pictures": len(images),
        **comparison.summary(),
    }


def netcdf(comparison: Comparison) -> bytes:
    """All numbers as NetCDF: groups `parameters`, `calibration_errors`, and of each record `records/NAME/...`.

    Records' groups are `curves`, `third_octaves` and `standardised`.
    """
    groups: dict[str, xr.Dataset] = {
        "parameters": comparison.parameters,
        "calibration_errors": comparison.calibration,
    }
    for record, bands, z in zip(comparison.records, comparison.bands, comparison.residuals, strict=True):
        base = f"records/{file_name(str(record.attrs['record']))}"
        groups |= {f"{base}/curves": record, f"{base}/third_octaves": bands, f"{base}/standardised": z}
    summary = json.dumps(comparison.summary(), allow_nan=False, ensure_ascii=False)
    return netcdf_bytes({"": xr.Dataset(attrs={"summary": summary}), **groups})


def file_name(label: str) -> str:
    """A label as a name that any file system takes."""
    return re.sub(r"[^A-Za-z0-9.+]+", "-", label).strip("-.") or "record"
