"""The page of a diagnosis: first what to act on, then what it rests on, folded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from matplotlib.figure import Figure

from permway.diagnosis.plain_names import name_of
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict import RIGHT, UNPROVED
from permway.diagnosis.verdict_words import INCOMPLETE
from permway.report.compare.tables import NOTABLE_DB
from permway.report.diagnosis.acting import (
    effect_cards,
    elsewhere,
    facts_first,
    next_steps,
    rival_tables,
)
from permway.report.diagnosis.assumed import assumed
from permway.report.diagnosis.better import LEVEL_DB, curve_pictures, first_curve, gain_picture, parameter_picture
from permway.report.diagnosis.changes import MOST_CURVES, changes
from permway.report.diagnosis.parameters import stated_rows
from permway.report.diagnosis.places import along, map_picture, ringed
from permway.report.diagnosis.tables import change_table, detectable_rows, held_out_rows
from permway.report.readout import Drawn


def verdict_pictures(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """Names and figures: `map`, `curve`, then `gain-` and `curves-` of records, `parameters`."""
    yield "map", map_picture(diagnosis)
    yield from first_curve(diagnosis)
    yield from gain_picture(diagnosis)
    yield from curve_pictures(diagnosis)
    if diagnosis.base.free:
        yield "parameters", parameter_picture(diagnosis)


def render_verdict(diagnosis: Diagnosis, drawn: Mapping[str, Drawn]) -> str:
    """Render the page.

    Parameters
    ----------
    diagnosis : Diagnosis
    drawn : mapping of name to Drawn
        From :func:`verdict_pictures`.

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
    verdict, weighed = diagnosis.verdict, diagnosis.weighed
    rivals, others = rival_tables(weighed)
    return environment.get_template("verdict.html.j2").render(
        title=diagnosis.comparison.campaign.stated.title or "A campaign",
        sentence=verdict.sentence,
        right=verdict.status in RIGHT,
        missing=verdict.status not in UNPROVED,
        explained=verdict.status in RIGHT and (verdict.evidence.misfit_before or np.inf) < INCOMPLETE,
        facts_first=facts_first(verdict),
        effects=effect_cards(verdict),
        steps=next_steps(diagnosis),
        images=drawn,
        along=bool(along(weighed)),
        ringed=bool(ringed(weighed, diagnosis.base.campaign)),
        elsewhere=elsewhere(weighed, diagnosis.base.campaign.model.line),
        rivals=rivals,
        others=others,
        held_out=held_out_rows(verdict),
        amended=diagnosis.after is not None,
        tables=[change_table(change) for change in changes(diagnosis)],
        detectable=detectable_rows(verdict),
        parameters=stated_rows(diagnosis),
        assumed=assumed(diagnosis) | {"ruled_out": [name_of(one) for one in verdict.ruled_out]},
        most_curves=MOST_CURVES,
        notable_dB=NOTABLE_DB,
        level_dB=LEVEL_DB,
    )
