"""Noise floors that nobody stated are estimated from what channels do not share, and stated as such."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small.make import make_small
from permway.checking.check import check
from permway.checking.noise import unshared
from permway.laws.toml import to_toml

NOISE = np.array([1e-3, 4e-2, 2.0])
"""Density of each channel's own noise."""


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("averages", [16, 80])
def test_what_is_not_shared_is_the_noise(seed: int, averages: int) -> None:
    random = np.random.default_rng(seed)
    lines = 400
    source, own = (
        random.standard_normal((averages, lines, count)) + 1j * random.standard_normal((averages, lines, count))
        for count in (1, 3)
    )
    gains = np.array([1.0, -3.0j, 0.5 + 2.0j])
    read = (gains * source + np.sqrt(NOISE) * own) / np.sqrt(2.0)
    csd = np.einsum("afi,afj->fij", read, read.conj()) / averages
    # The others know the source up to their own noise, over their gains: that much of it is left in a channel.
    known = np.abs(gains) ** 2 / NOISE
    left = NOISE + np.abs(gains) ** 2 / (1.0 + known.sum() - known)
    assert unshared(csd, averages).mean(axis=0) == pytest.approx(left, rel=0.1)


def test_channels_without_a_floor_are_asked_for_one(tmp_path: Path) -> None:
    """Of the generator's campaigns one with a run and four channels: what it drew, and left out here, is found."""
    folder = tmp_path / make_small(7701, 13, tmp_path)
    table = tomllib.loads((folder / "campaign.toml").read_text())
    true = {}
    for sensor in table["sensors"]:
        if "degree" in sensor:
            true[sensor["name"]] = sensor.pop("chain")["noise_floor"]
    (folder / "campaign.toml").write_text(to_toml(table))
    found = check(read_campaign(folder / "campaign.toml"), threads=1).blunders
    asked = [one for one in found if one.where != "parameters"]
    assert {(one.kind, one.asked, one.where) for one in asked} == {
        ("noise_floor", True, f"records.run: {name}") for name in true
    }
    for one in asked:
        name, _, rest = one.remedy.removeprefix('sensors "').partition('"')
        stated = float(rest.partition("noise_floor = ")[2].partition(" }")[0])
        # The two wheelsets' noise is far below what moves them, and only bounded.
        assert 0.6 * true[name] < stated < (50.0 if name.startswith("axlebox") else 1.6) * true[name]
