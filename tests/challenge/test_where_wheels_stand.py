"""Generator and importer read one sentence of a sheet: where the wheelsets stand, halfway at the even multiple."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.campaign.importers.sheet_form import Sheet
from permway.campaign.importers.sheet_position import position
from permway.challenge.layout import NOMINAL, Layout, draw_layout, draw_nominal, draw_tests
from permway.challenge.sheet import sheet


def imported(layout: Layout, seed: int = 0) -> list[float]:
    tests = draw_tests(np.random.default_rng(seed), layout, temperatures=1)
    read = Sheet.model_validate(sheet(layout, draw_nominal(np.random.default_rng(seed)), tests))
    return list(position(read).wheels_m)


@pytest.mark.parametrize("seed", range(200))
def test_both_have_them_at_the_same_places(seed: int) -> None:
    layout = draw_layout(np.random.default_rng(seed))
    assert imported(layout, seed) == layout.wheels_m(NOMINAL["vehicle"])


def test_what_is_halfway_is_so_whatever_its_last_digit() -> None:
    """Three spans of 31.4 m are 94.19999999999999 m; 39.6 m is halfway from 39.52 to 39.68 m, 248 times 0.16."""
    layout = replace(Layout(), spans=3, bays=157, spacing_m=0.6)
    assert layout.wheels_m(NOMINAL["vehicle"]) == [57.12, 54.56, 39.68, 37.12]
    assert imported(layout) == [57.12, 54.56, 39.68, 37.12]
