"""A sheet whose spans end on fasteners, as the importer reads it, against finite elements of the same deck."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.predict import predict
from permway.challenge import plan as planning
from permway.challenge import write
from permway.challenge.assembly import assemble
from permway.challenge.layout import Layout, Values
from permway.challenge.track import Track
from short_deck import small_case

MEETING = Layout(spans=2, bays=40, spacing_m=0.64, approach_bays=14)
PIER_M = 12.8
ROWS = ("slab", "girder")


def halved(layout: Layout, values: Values) -> Track:
    """The track with half of each joint at the pier on either of the beams that meet there."""
    track = assemble(layout, values)
    links = []
    for link in track.links:
        bodies = [body for body, _ in link.locations]
        if len(bodies) < 2 or abs(link.locations[0][1] - PIER_M) > 1e-9 or not set(ROWS) & set(bodies):
            links.append(link)
            continue
        for behind in (False, True):
            after = tuple(behind and body in ROWS for body in bodies)
            links.append(replace(link, scale=0.5 * link.scale, after=after))
    assert len(links) == len(track.links) + 3
    track.links = links
    return track


def test_frequency_responses_agree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planning, "assemble", halved)
    case = small_case(clean=True, layout=MEETING)
    write(case, tmp_path / "folder")
    campaign = import_sheet(tmp_path / "folder", tmp_path / "imported")
    values = {
        f"{group}.{name}": v for group, table in case.truth["parameters"].items() for name, v in table.items()
    }
    campaign = campaign.with_values(values)
    blows = campaign.load()[0]
    (predicted,) = predict(campaign, [blows], threads=1)
    decibels = 8.686 * np.abs(np.log((blows.data["frf"] / predicted["frf"]).values).real)
    # The elements' own error, as on decks whose spans end between fasteners.
    assert np.median(decibels) < 0.001
    assert np.quantile(decibels, 0.99) < 0.03
