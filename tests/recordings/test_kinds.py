"""A kind of record is one class: what is particular to it is asked of that class alone."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import xarray as xr
from permway.campaign.campaign import Campaign
from permway.campaign.compare import curves
from permway.campaign.groups import held_out
from permway.campaign.kinds import KINDS
from permway.campaign.kinds.kind import RecordKind
from permway.campaign.load import Dataset, load_record
from permway.campaign.parts import HeldOut, Record, Statistic
from permway.campaign.predict import predict
from permway.diagnosis.block_of import BLOCKS
from test_campaign_load import table_campaign


class Loud(RecordKind):
    """Levels that a file need not hold."""

    name = "loud"
    statistics = ("bands",)
    variable = "level"
    dimensions = ("channel", "frequency")

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        return xr.Dataset(
            {"level": (("channel", "frequency"), [[4.0, 8.0]], {"long_name": "level", "units": "phon"})},
            coords={"channel": ["floor"], "frequency": [100.0, 200.0]},
        )

    def request(self, *_: object) -> None:
        return None

    def predicted(self, campaign: Campaign, dataset: Dataset, *_: object) -> xr.Dataset:
        return dataset.template(self.blank).copy(data={"level": np.full((1, 2), 2.0)})


def test_every_statistic_has_a_kind() -> None:
    assert set(KINDS) == set(get_args(Statistic))
    assert set(BLOCKS) <= {kind.name for kind in KINDS.values()}


def test_a_kind_is_read_predicted_and_drawn_by_its_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "bands", Loud())
    campaign = table_campaign(tmp_path, "bands", select={"test": 1})
    dataset = load_record(campaign, campaign.stated.records[0])
    (found,) = predict(campaign, [dataset])
    seen = curves(campaign, dataset, {"raw": found}, np.ones((1, 2)))
    assert seen["deviation_dB"].values.ravel() == pytest.approx(20.0 * np.log10([2.0, 4.0]))
    assert seen["unit"].item() == "phon"
    group = HeldOut(name="high", axis="band", band_Hz=(150.0, 300.0))
    assert held_out(campaign, group, dataset).values.tolist() == [[False, True]]
