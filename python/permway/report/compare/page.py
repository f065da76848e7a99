"""A comparison as one page of HTML that needs nothing from outside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from permway import _core
from permway.campaign.compare import UNSURE_DB
from permway.diagnosis.compare import CLEAN, Comparison
from permway.report.compare.curves import nearest_points
from permway.report.compare.looks import NAME
from permway.report.compare.maps import LEVEL_DB, SIGMAS, UNSEEN_DB, groups
from permway.report.compare.tables import (
    NOTABLE_DB,
    band_table,
    calibration_rows,
    decibels,
    parameter_rows,
    sensor_rows,
    share,
)
from permway.report.compare.writing import NUMBERS, PICTURES, file_name
from permway.report.readout import Drawn

FEW = 30
"""Channels of a record up to which its table shows all."""


def render(comparison: Comparison, drawn: Mapping[str, Drawn]) -> str:
    """Render the page.

    Parameters
    ----------
    comparison : Comparison
    drawn : mapping of name to Drawn
        From :func:`permway.report.compare.pictures.pictures`.

    Returns
    -------
    str
        HTML.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader("permway.report.compare"), PackageLoader("permway.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(decibels=decibels, share=share)
    summary = comparison.summary()
    return environment.get_template("compare.html.j2").render(
        version=_core.__version__,
        title=comparison.campaign.stated.title or "A campaign",
        recalibrated=comparison.fit is not None,
        sentence=_sentence(comparison),
        fits=summary["fits"],
        images=drawn,
        groups=[_group(comparison, name, members, drawn) for name, members in groups(comparison)],
        parameters=parameter_rows(comparison),
        left=summary.get("left_tolerance", []),
        silent=summary.get("not_informed", []),
        smooth=calibration_rows(comparison),
        sensors=sensor_rows(comparison),
        models=[NAME.get(str(m), str(m)) for m in comparison.residuals[0]["model"].values],
        clean=_clean_share(comparison),
        left_out=_reasons(comparison),
        level_dB=LEVEL_DB,
        sigmas=SIGMAS,
        unseen_dB=UNSEEN_DB,
        unsure_dB=UNSURE_DB,
        notable_dB=NOTABLE_DB,
        numbers=NUMBERS,
        pictures=PICTURES,
    )


def _sentence(comparison: Comparison) -> str:
    """What an engineer wants to know first."""
    words = []
    for fit in comparison.fits():
        raw = f"the nominal values miss the measured levels by {decibels(fit['raw_dB_rms'])} rms"
        held = f"{share(fit['raw_within_2_sigma'])} of residuals lie within two sigma"
        text = f"{fit['kind'].capitalize()}: {raw}, and {held}"
        if comparison.fit is not None:
            best = f"{decibels(fit['recalibrated_dB_rms'])} and {share(fit['recalibrated_within_2_sigma'])}"
            text += f"; recalibrated {best}"
        words.append(f"{text}.")
    return " ".join(words)


def _clean_share(comparison: Comparison) -> list[tuple[str, str]]:
    """By record, the share of residuals within two sigma with calibration errors taken out."""
    found = []
    for data in comparison.residuals:
        if CLEAN in data["model"].values:
            z = data["z"].sel(model=CLEAN).values
            z = z[z == z]
            found.append((str(data.attrs["record"]), share(float((abs(z) <= 2.0).mean()))))
    return found


def _reasons(comparison: Comparison) -> dict[str, list[str]]:
    """Why records were left out, and which."""
    found: dict[str, list[str]] = {}
    for name, why in comparison.left_out.items():
        found.setdefault(why.removeprefix(f"records.{name}: ").removeprefix(f"records.{name}."), []).append(name)
    return found


def _group(comparison: Comparison, name: str, members: list[int], images: Mapping[str, Drawn]) -> dict[str, Any]:
    stem = file_name(name)
    tables, hidden = [], []
    channels = 0
    for i in members:
        record, bands = comparison.records[i], comparison.bands[i]
        channels += record.sizes["channel"]
        every = list(range(record.sizes["channel"]))
        chosen = every
        if record.attrs["statistic"] == "frf" and len(every) > FEW:
            chosen = nearest_points(comparison.campaign, record)
            hidden.append(band_table(bands, str(record.attrs["record"]), every))
        tables.append(band_table(bands, str(record.attrs["record"]), chosen))
    curves = [n for n in images if n == f"curves-{stem}" or n.startswith(f"curves-{stem}-")]
    return {
        "name": name,
        "id": stem,
        "statistic": str(comparison.records[members[0]].attrs["statistic"]),
        "channels": channels,
        "curves": curves,
        "tables": _joined(tables),
        "hidden": hidden,
    }


def _joined(tables: list[Any]) -> list[Any]:
    """Tables of the same bands and a channel or two each become one."""
    if len(tables) < 2 or any(len(t.rows) > 2 for t in tables):
        return tables
    bands = sorted({band for t in tables for band in t.bands}, key=float)
    rows = []
    for t in tables:
        for label, cells in t.rows:
            mine = dict(zip(t.bands, cells, strict=True))
            name = t.record if len(t.rows) == 1 else f"{t.record}: {label}"
            rows.append((name, [mine.get(band, ("", "", False)) for band in bands]))
    return [type(tables[0])("", bands, rows)]
