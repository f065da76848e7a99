"""A diagnosis as one page of HTML that needs nothing from outside."""

from __future__ import annotations

from collections.abc import Mapping

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict import UNPROVED
from permway.report.compare.tables import NOTABLE_DB
from permway.report.diagnosis.assumed import assumed
from permway.report.diagnosis.better import LEVEL_DB
from permway.report.diagnosis.changes import MOST_CURVES, changes
from permway.report.diagnosis.tables import (
    BAR_ERRORS,
    candidate_rows,
    change_table,
    detectable_rows,
    effect_blocks,
    headline,
    held_out_rows,
    looked_for,
    next_rows,
    parameter_rows,
    weight_rows,
)
from permway.report.readout import Drawn

FEW_CANDIDATES = 12
"""Candidates that the page shows openly."""


def render(diagnosis: Diagnosis, drawn: Mapping[str, Drawn]) -> str:
    """Render the page.

    Parameters
    ----------
    diagnosis : Diagnosis
    drawn : mapping of name to Drawn
        From :func:`permway.report.diagnosis.pictures.pictures`.

    Returns
    -------
    str
        HTML.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader("permway.report.diagnosis"), PackageLoader("permway.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    verdict, candidates = diagnosis.verdict, candidate_rows(diagnosis)
    return environment.get_template("diagnosis.html.j2").render(
        title=diagnosis.comparison.campaign.stated.title or "A campaign",
        sentence=verdict.sentence,
        blunders=verdict.blunders,
        missing=verdict.status not in UNPROVED,
        headline=headline(verdict),
        images=drawn,
        scanned=len(diagnosis.found),
        after_scan=bool(diagnosis.left),
        effects=effect_blocks(verdict),
        looked_for=looked_for(diagnosis),
        weights=weight_rows(verdict),
        candidates=candidates[:FEW_CANDIDATES],
        others=candidates[FEW_CANDIDATES:],
        held_out=held_out_rows(verdict),
        placebo=bool(verdict.placebo),
        amended=diagnosis.after is not None,
        tables=[change_table(change) for change in changes(diagnosis)],
        next=next_rows(verdict),
        detectable=detectable_rows(verdict),
        parameters=parameter_rows(diagnosis),
        assumed=assumed(diagnosis),
        most_curves=MOST_CURVES,
        notable_dB=NOTABLE_DB,
        level_dB=LEVEL_DB,
        errors=BAR_ERRORS,
    )
