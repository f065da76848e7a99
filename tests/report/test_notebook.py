"""What notebooks show of lines, models and campaigns: drawings that are sound, small and true."""

from __future__ import annotations

import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from permway.campaign.campaign import read_campaign
from permway.demo.run import campaign_files
from permway.formats.model_file import model_from_dict, read_model
from permway.model.presets import slab_track_viaduct_32m
from permway.report.notebook import MOST_DRAWN, line_svg

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
MODELS = [p for p in sorted(EXAMPLES.glob("*.toml")) if "frequencies" in tomllib.loads(p.read_text())]


def drawn(html: str) -> ElementTree.Element:
    svg = html[html.index("<svg") : html.index("</svg>") + 6]
    return ElementTree.fromstring(svg)


def ties(svg: ElementTree.Element) -> int:
    return sum((p.get("d") or "").count("V") for p in svg.findall("path"))


def named(svg: ElementTree.Element, kind: str) -> list[str]:
    return [t.text for t in svg.iter("title") if t.text is not None and t.text.startswith(f"{kind}: ")]


def test_a_line_is_drawn_joint_by_joint() -> None:
    svg = drawn(slab_track_viaduct_32m()._repr_html_())
    # 51 fasteners, as many springs of both layers, two bearings.
    assert ties(svg) == 3 * 51 + 2
    assert len(list(svg.iter("rect"))) == 4
    texts = [t.text for t in svg.iter("text")]
    assert {"rail", "slab", "base", "girder", "ground", "0", "10", "20", "30 m"} == set(texts)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_models_of_the_examples(path: Path) -> None:
    model = read_model(path)
    html = model._repr_html_()
    svg = drawn(html)
    assert len(named(svg, "force")) == len(model.forces)
    assert len(named(svg, "sensor")) == len(model.sensors)
    for place in model.sensors:
        assert f"sensor: {place.body} at {place.x_m:g} m" in named(svg, "sensor")
    assert model.title in html
    assert "http" not in html
    assert "<script" not in html


def test_nothing_lies_outside_the_drawing() -> None:
    svg = drawn(read_model(EXAMPLES / "layout.toml")._repr_html_())
    width, height = map(float, (svg.get("viewBox") or "").split()[2:])
    for rect in svg.iter("rect"):
        x, y, w, h = (float(rect.get(key) or "nan") for key in ("x", "y", "width", "height"))
        assert 0.0 <= x <= x + w <= width
        assert 0.0 <= y <= y + h <= height


def test_a_long_line_stays_small() -> None:
    line = slab_track_viaduct_32m(spans=100)
    svg = line_svg(line)
    assert len(svg) < 60_000
    assert ties(drawn(svg)) <= 4 * MOST_DRAWN


def test_a_campaign(tmp_path: Path) -> None:
    for name, content in campaign_files().items():
        (tmp_path / name).write_bytes(content)
    campaign = read_campaign(tmp_path / "campaign.toml")
    html = campaign._repr_html_()
    assert (len(named(drawn(html), "force")), len(named(drawn(html), "sensor"))) == (9, 5)
    assert "hammer_+12C.mat" in html
    assert all(p.name in html for p in campaign.stated.parameters)


def test_names_cannot_bring_markup() -> None:
    table = tomllib.loads((EXAMPLES / "viaduct.toml").read_text())
    table["title"] = "<script>alert(1)</script>"
    html = model_from_dict(table)._repr_html_()
    assert "<script" not in html
    assert "&lt;script&gt;" in html


def test_a_single_mass_and_a_rail_without_ends() -> None:
    table = tomllib.loads((EXAMPLES / "viaduct.toml").read_text())
    del table["train"], table["irregularity"]
    table["line"] = {
        "bodies": {"block": {"type": "mass", "mass_kg": 100.0}},
        "laws": {"spring": {"type": "hysteretic", "stiffness": 4000.0}},
        "joints": [{"between": ["block", "ground"], "law": "spring", "at": [0.0]}],
    }
    table["forces"] = table["sensors"] = [{"body": "block", "x_m": 0.0}]
    svg = drawn(model_from_dict(table)._repr_html_())
    assert (ties(svg), len(list(svg.iter("rect")))) == (1, 1)
