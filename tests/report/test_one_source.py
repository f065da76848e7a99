"""One number has one source: page, verdict, amended model and comparison of a diagnosis say the same."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.paths import parse_path, value_at
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.plain_names import name_of, seen
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict_parts import Smallest
from permway.formats.model_file import read_model
from permway.posterior.diagnose import diagnose
from permway.problem.model import Model
from permway.report.compare.tables import parameter_rows
from permway.report.diagnosis import write_diagnosis
from permway.report.diagnosis.better import parameter_picture
from simulated import simulate


def lost(campaign: Campaign) -> Campaign:
    return weakened(campaign, "pad", 7.5, 0.6, 0.05)


def loud(campaign: Campaign) -> Campaign:
    chain = campaign.sensor("deck@3").chain
    return with_chain(campaign, "deck@3", chain.model_copy(update={"gain": 1.26 * chain.gain}))


def nothing(campaign: Campaign) -> Campaign:
    return campaign


def concealed(amend: Callable[[Campaign], Campaign], noise: float = 0.05) -> Callable[[Path], Campaign]:
    return lambda folder: simulate(folder, 3, amend=amend, noise=noise, smooth=0.4 * noise).campaign


CASES: dict[str, tuple[Callable[[Path], Campaign], str]] = {
    "lost fasteners": (concealed(lost), "named"),
    "a loud sensor": (concealed(loud), "measurement"),
    "nothing": (concealed(nothing), "recalibrated"),
    # Where what the model idealises is most of what is not known.
    "nothing, and no noise": (concealed(nothing, 1e-3), "recalibrated"),
}
"""What makes the campaign, and what is stated about it."""

IN_EVERY_RUN = ("lost fasteners", "nothing")
"""A diagnosis that names an effect, with all its tables, and one that leaves the nominal model: every check runs
these. Each case costs a whole diagnosis; the others are run with the injections."""


@dataclass(frozen=True)
class Written:
    """A diagnosis and the three files."""

    diagnosis: Diagnosis
    reported: dict[str, Any]
    verdict: dict[str, Any]
    page: str
    amended: Model

    def rows(self, heads: str) -> list[list[str]]:
        """Of all tables of the page whose heads begin so, one after the other."""
        return [
            row for found, rows in Tables(self.page).tables if ", ".join(found).startswith(heads) for row in rows
        ]


class Tables(HTMLParser):
    """Every table of a page: its heads, and the text of its cells row by row."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tables: list[tuple[list[str], list[list[str]]]] = []
        self._inside, self._cell = False, False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "table":
            self.tables.append(([], []))
            self._inside = False
        elif tag == "tbody":
            self._inside = True
        elif tag == "tr" and self._inside:
            self.tables[-1][1].append([])
        elif tag in ("td", "th"):
            self._cell = True
            (self.tables[-1][1][-1] if self._inside else self.tables[-1][0]).append("")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data: str) -> None:
        if self._cell:
            (self.tables[-1][1][-1] if self._inside else self.tables[-1][0])[-1] += data


NUMBER = re.compile(r"([-+]?)(\d+)\.?(\d*)(?:e([-+]?\d+))?")
PREFIX = re.compile(r" ([kMG])(?:N|Pa)")
"""Of a unit that engineers write with kilo, mega and giga."""


def numbers(text: str) -> list[tuple[float, float]]:
    """All numbers in a text, in the unit without prefix, each with half a unit of its last digit that is none of
    the zeros before the point, which only fill."""
    unit = PREFIX.search(text)
    factor = {"k": 1e3, "M": 1e6, "G": 1e9}[unit[1]] if unit else 1.0
    # Units bear digits, too.
    bare = re.sub(r" [A-Za-z/]+[0-9]?", " ", text.replace("−", "-"))
    found = []
    for match in NUMBER.finditer(bare):
        _, whole, decimals, power = match.groups()
        fill = 0 if decimals else len(whole) - len(whole.rstrip("0"))
        found.append((factor * float(match[0]), factor * 0.501 * 10.0 ** (int(power or 0) + fill - len(decimals))))
    return found


def same(text: str, values: list[float | None]) -> None:
    """That a text prints these numbers, to its last digit, and no others; once what is one to that digit."""
    printed, expected = numbers(text), [value for value in values if value is not None]
    printed = printed * len(expected) if len(printed) == 1 else printed
    assert len(printed) == len(expected), (text, expected)
    for (number, half), value in zip(printed, expected, strict=True):
        assert number == pytest.approx(value, abs=half, rel=1e-12), (text, expected)


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, marks=() if name in IN_EVERY_RUN else pytest.mark.injection) for name in CASES],
)
def written(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Written:
    make, status = CASES[request.param]
    folder = tmp_path_factory.mktemp("one")
    found = diagnose(make(folder / "c"), threads=1)
    reported = write_diagnosis(found, folder / "d")
    assert found.verdict.status == status
    return Written(
        found,
        reported,
        json.loads((folder / "d" / "verdict.json").read_text(encoding="utf-8")),
        (folder / "d" / "report.html").read_text(encoding="utf-8"),
        read_model(folder / "d" / "amended.toml"),
    )


def test_parameters_and_their_intervals(written: Written) -> None:
    before, after = (written.verdict["recalibrated"][when] for when in ("before", "after"))
    rows = written.rows("Parameter, Stated")
    assert [row[0] for row in rows] == list(before)
    for name, prior, _, *cells in rows:
        same(prior, [before[name]["prior"]])
        for moved in (before, after) if after else (before,):
            value, span, z, *cells = cells
            same(value, [moved[name]["value"]])
            same(span, [moved[name]["low"], moved[name]["high"]])
            same(z, [moved[name]["z"]])
        if not after:
            assert cells == []


def test_the_comparison_states_what_the_verdict_states_of_the_base(written: Written) -> None:
    before = written.verdict["recalibrated"]["before"]
    table = written.diagnosis.comparison.parameters
    for row in parameter_rows(written.diagnosis.comparison):
        one, moved = table.sel(parameter=row["name"]), before[row["name"]]
        for key in ("value", "low", "high", "z"):
            assert float(one[key]) == moved[key]
        same(row["found"], [moved["value"]])
        same(row["interval"], [moved["low"], moved["high"]])


def test_the_picture_shows_the_intervals_of_the_verdict(written: Written) -> None:
    known = written.diagnosis.comparison.campaign.parameters.known
    reported = [moved for moved in written.verdict["recalibrated"].values() if moved]
    bars = parameter_picture(written.diagnosis).axes[0].containers
    assert len(bars) == len(reported)
    for bar, moved in zip(bars, reported, strict=True):
        ends = np.array([segment[:, 0] for segment in bar.lines[2][0].get_segments()])
        expected = [[known[name].z(moved[name][end]) for end in ("low", "high")] for name in known]
        np.testing.assert_allclose(ends, expected, atol=1e-9)


def test_effects(written: Written) -> None:
    effects = written.verdict["effects"]
    estimates = [one for effect in effects for one in effect["parameters"].values()]
    rows = written.rows("Parameter, Value, 90 % interval")
    assert len(rows) == len(estimates)
    for (_, value, span), one in zip(rows, estimates, strict=True):
        same(value, [one["value"]])
        if span:
            same(span, [one["low"], one["high"]])
        else:
            # Ends that are the value to its last digit are not printed beside it.
            same(value, [one["low"]])
            same(value, [one["high"]])


def test_what_was_held_out(written: Written) -> None:
    gains = written.verdict["held_out"]
    rows = written.rows("Held out")
    assert [row[0] for row in rows] == list(gains)
    for axis, gain, before, after in rows:
        same(gain, [gains[axis]["gain_nats"]])
        same(before, [gains[axis]["db_before"]])
        same(after, [gains[axis]["db_after"]])


def test_sizes_and_advice(written: Written) -> None:
    smallest = {name: Smallest.model_validate(one) for name, one in written.verdict["detectable"].items()}
    assert [tuple(row) for row in written.rows("Effect, Seen from")] == [
        (name_of(name).capitalize(), seen(one)) for name, one in smallest.items()
    ]
    rows = written.rows("Measure, States")
    assert len(rows) == len(written.verdict["next"])
    for (_, _, now, then), one in zip(rows, written.verdict["next"], strict=True):
        same(now, [one["separation_before"]])
        same(then, [one["separation_after"]])


def test_the_amended_model_has_the_values_that_the_verdict_states(written: Written) -> None:
    called = written.verdict["status"] not in ("recalibrated", "insufficient")
    stated = written.verdict["recalibrated"]["after" if called else "before"]
    campaign = written.diagnosis.comparison.campaign
    for name, known in campaign.parameters.known.items():
        path = parse_path(known.parameter.paths[0], name)
        ratio = value_at(written.amended, path) / value_at(campaign.model, path)
        assert ratio == pytest.approx(stated[name]["value"] / stated[name]["prior"], rel=1e-9)
    # And where nothing is called missing, nothing beside them.
    if not called:
        assert written.amended.line.joints == campaign.model.line.joints


def test_what_is_printed_is_the_verdict(written: Written) -> None:
    assert written.reported["status"] == written.verdict["status"]
    assert written.reported["verdict"] in re.sub(r"&#39;", "'", written.page)
    assert [one["place"] for one in written.reported["effects"]] == [
        effect.place.label for effect in written.diagnosis.verdict.effects
    ]
    amended = bool(written.verdict["recalibrated"]["after"])
    assert ("How well the recalibrated model fits" in written.page) is not amended
