"""Small random campaigns: the same bytes for the same seed, two makers that agree, files that are read."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small import places
from permway.challenge.small.by_elements import ByElements
from permway.challenge.small.by_model import ByModel
from permway.challenge.small.draws import generator
from permway.challenge.small.fixture import fixture_names, make_fixture
from permway.challenge.small.layouts import Layout, draw_layout
from permway.challenge.small.make import NEVER, draw_small, make_small, true_values
from permway.challenge.small.write import write_tables
from permway.diagnosis.catalogue import entries
from permway.diagnosis.gather import gather
from permway.errors import InputError

LAYOUTS = ("deck", "ballast", "slab", "beam", "rig")


def digests(folder: Path) -> dict[str, str]:
    """Of all files below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def drawn(name: str, seed: int) -> tuple[Layout, places.Tests]:
    """The first layout of a name that a seed draws, and tests on it without a run."""
    for index in range(100):
        random = generator(seed, index, "layout")
        layout = draw_layout(random)
        if layout.name == name:
            return layout, places.draw_tests(random, layout, runs=False)
    raise AssertionError(name)


@pytest.mark.parametrize("index", range(5))
def test_a_seed_and_a_number_give_the_same_bytes_whatever_was_made_before(tmp_path: Path, index: int) -> None:
    make_small(11, index, tmp_path / "one")
    make_small(11, index + 1, tmp_path / "other")
    make_small(11, index, tmp_path / "other")
    made = digests(tmp_path / "one")
    again = digests(tmp_path / "other")
    assert made
    assert {name: again[name] for name in made} == made


def test_another_number_and_another_seed_are_other_campaigns(tmp_path: Path) -> None:
    for seed, index in ((11, 0), (11, 1), (12, 0)):
        make_small(seed, index, tmp_path)
    files = [path.read_text() for path in sorted(tmp_path.glob("small-*/model.toml"))]
    assert len(set(files)) == 3


def test_the_truth_has_its_digest_and_the_campaign_can_be_read(tmp_path: Path) -> None:
    for index in range(6):
        name = make_small(13, index, tmp_path)
        path = tmp_path / "truth" / f"{name}.json"
        digest = path.with_name(path.name + ".sha256").read_text().split()[0]
        assert digest == hashlib.sha256(path.read_bytes()).hexdigest()
        truth = json.loads(path.read_text())
        campaign = read_campaign(tmp_path / name / "campaign.toml")
        assert set(truth["parameters"]) == set(campaign.parameters.known)
        assert bool(truth["effects"]) == (truth["deviance"] > 0.0)
        assert all(np.isfinite(gather(campaign, threads=1).rows.frequency_Hz))


@pytest.mark.parametrize("name", LAYOUTS)
@pytest.mark.parametrize("seed", [21, 22])
def test_the_two_makers_agree_where_nothing_is_concealed(tmp_path: Path, name: str, seed: int) -> None:
    # The mesh is right to some 1e-4 of a wave; at a narrow antiresonance that is more.
    layout, tests = drawn(name, seed)
    campaign = read_campaign(write_tables(tmp_path, tests.campaign, tests.model))
    values, beyond = true_values(campaign, generator(seed, 0, "parameters"))
    (one, *_) = ByElements(tests, layout, values, beyond).base
    (other, *_) = ByModel(campaign, tests, layout, values).base
    off = np.abs(np.log(one / other))
    assert np.median(off) < 1e-4
    assert np.sqrt(np.mean(off**2)) < 2e-3


def test_every_kind_is_drawn_and_deviances_are_spread(tmp_path: Path) -> None:
    kinds, deviances = set(), []
    for index in range(24):
        small = draw_small(31, index, tmp_path / str(index))
        kinds.add((small.maker.name, len(small.chosen)))
        deviances += [one for effect, _, one in small.chosen if effect.scales]
    assert {(maker, count) for maker in ("model", "elements") for count in (0, 1)} <= kinds
    assert any(count > 1 for _, count in kinds)
    assert min(deviances) > 3.0
    assert max(deviances) < 1.6e4
    assert sum(one < 50.0 for one in deviances) > 2
    assert sum(one > 500.0 for one in deviances) > 2


def test_the_fixture_is_made_again_byte_for_byte(tmp_path: Path) -> None:
    name = fixture_names()[1]
    for folder in ("one", "other"):
        make_fixture(name, tmp_path / folder)
    assert len(fixture_names()) == 40
    assert digests(tmp_path / "one") == digests(tmp_path / "other")


def test_a_campaign_that_the_fixture_has_not_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no campaign of the fixture"):
        make_fixture("fixture-0.7-01", tmp_path)


def test_entries_that_came_after_the_published_seeds_are_drawn_by_none() -> None:
    """An entry more among those that are drawn, and every published seed makes other campaigns."""
    assert len(set(entries()) - set(NEVER)) == 49
