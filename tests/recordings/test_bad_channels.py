"""Bad channels: reported, and left out of what is estimated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from permway.arrays import Reals
from permway.campaign.bad_channels import BadChannel, without_bad_channels
from permway.campaign.campaign import Campaign
from permway.campaign.importers.sheet import import_sheet
from permway.diagnosis.gather import predictable
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_parts import ClassMember, Effect, Place
from permway.diagnosis.verdict_records import with_bad_channels
from permway.errors import InputError
from sheets import make_folder

CLIPPED = BadChannel("run", "axlebox2", "clipping", "4 samples flat at 3")


@pytest.fixture
def campaign(tmp_path: Path) -> Campaign:
    return import_sheet(make_folder(tmp_path / "folder"), tmp_path / "imported")


def alter(campaign: Campaign, run: int, change: Callable[[Reals], None]) -> None:
    """Write a run's file anew, its samples changed."""
    path = [campaign.path(record) for record in campaign.stated.records if record.statistic == "csd"][run]
    with np.load(path) as stored:
        content = dict(stored)
    change(content["acceleration"])
    np.savez(path, **content)


def clip(column: int) -> Callable[[Reals], None]:
    def change(values: Reals) -> None:
        most = 1.5 * values[:, column].std()
        values[:, column] = np.clip(values[:, column], -most, most)

    return change


def test_a_sound_campaign_is_left_as_it_is(campaign: Campaign) -> None:
    whole, bad = without_bad_channels(campaign)
    assert whole is campaign
    assert bad == ()


def test_a_clipped_channel_is_left_out_of_the_run_in_which_it_is(campaign: Campaign) -> None:
    alter(campaign, 1, clip(1))
    kept, left_out, bad = predictable(campaign)
    assert [(one.channel, one.kind) for one in bad] == [("axlebox2", "clipping")]
    assert list(left_out) == [f"{bad[0].record}: axlebox2"]
    first, second = (one.data for one in kept if one.record.statistic == "csd")
    assert "axlebox2" in first["channel"].values
    assert [*second["channel"].values] == [name for name in first["channel"].values if name != "axlebox2"]
    everything = predictable(campaign, screened=False)
    assert [one.data["channel"].size for one in everything.kept if one.record.statistic == "csd"] == [6, 6]


def test_a_run_with_no_channel_left_is_left_out(campaign: Campaign) -> None:
    def die(values: Reals) -> None:
        values[:] = 0.5

    alter(campaign, 0, die)
    kept, _, bad = predictable(campaign)
    assert {one.kind for one in bad} >= {"dead"}
    assert len([one for one in kept if one.record.statistic == "csd"]) == 1
    runs = tuple(record for record in campaign.stated.records if record.statistic == "csd")
    with pytest.raises(InputError, match="every record is bad"):
        without_bad_channels(campaign.with_records(runs[:1]))


def test_a_verdict_states_what_channels_were_bad() -> None:
    plain = with_bad_channels(Verdict(status="recalibrated"), [CLIPPED])
    assert (plain.status, plain.effects[0].name) == ("measurement", "clipping")
    assert plain.effects[0].place.channels == ("axlebox2",)
    assert "at fault" in plain.sentence
    assert "4 samples flat at 3" in plain.sentence
    unsure = with_bad_channels(Verdict(status="insufficient"), [CLIPPED])
    assert unsure.status == "insufficient"
    assert "suspicion" not in unsure.sentence
    assert "at fault is clipping at axlebox2: run: 4 samples flat at 3; left out" in unsure.sentence
    lost = Effect(
        domain="path",
        place=Place(joint="pad"),
        name="fastener_loss",
        class_=(ClassMember(name="fastener_loss", probability=0.95),),
    )
    both = with_bad_channels(Verdict(status="named", effects=(lost,)), [CLIPPED])
    assert [effect.name for effect in both.effects] == ["fastener_loss", "clipping"]
    assert with_bad_channels(plain, []) is plain
