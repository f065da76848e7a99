"""The page of operating deflection shapes, in a browser: what is drawn is what was computed."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from browser import DESK, PHONE, opened, overflow
from permway.errors import InputError
from permway.laws import KelvinVoigt
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.report.operating import FARTHEST, LEVEL, animate_shapes
from permway.response.operating import operating_shapes

LINE = Line(
    bodies={
        "deck": Beam(
            youngs_modulus_Pa=3.4e10,
            second_moment_m4=1.2,
            density_kg_per_m3=2500.0,
            area_m2=4.0,
            loss_factor=0.01,
            intervals_m=((0.0, 24.0),),
            ends="pinned",
        ),
        "block": Mass(mass_kg=500.0),
    },
    joints=(
        Joints(between=("block", "deck"), law="pad", at=(6.0,)),
        Joints(between=("deck", "ground"), law="pad", at=(18.0,)),
    ),
    laws={"pad": KelvinVoigt(stiffness=2.0e5, damping=1.0e4)},
)


def page(folder: Path) -> Path:
    data = operating_shapes(LINE, [5.0, 30.0], forces=[Place(body="deck", x_m=12.0)])
    return animate_shapes(data, LINE, folder / "shapes.html", title="A <deck>")


def heights(path: str) -> list[float]:
    return [float(y) for y in re.findall(r"[-\d.]+,([-\d.]+)", path)]


def test_without_scripts_the_farthest_moment_is_drawn(tmp_path: Path) -> None:
    text = page(tmp_path).read_text("utf-8")
    assert "<h1>A &lt;deck&gt;: operating deflection shapes</h1>" in text
    deck = heights(re.findall(r'class="body" d="([^"]+)"', text)[0])
    # The middle moves most; its ends are held.
    assert max(deck) - deck[0] == pytest.approx(FARTHEST * LEVEL, abs=0.2)
    assert deck[-1] == pytest.approx(deck[0], abs=0.11)
    assert re.search(r"Most: [\d.]+ (nm|pm|µm) per N, deck at 12 m", text)


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_it_moves_and_stops(size: tuple[int, int], tmp_path: Path) -> None:
    with opened(page(tmp_path), size) as (shown, complaints):
        first = shown.locator("figure.shape").first
        first.locator("button").click()
        slider = first.locator("input.phase")
        drawn = []
        for phase in (10, 190):
            slider.fill(str(phase))
            drawn.append(np.array(heights(first.locator(".body").first.get_attribute("d"))))
            assert first.locator("output").first.text_content() == f"{phase}°"
        # Half a period later all is on the other side.
        middle = 0.5 * (drawn[0] + drawn[1])
        assert np.ptp(middle) < 0.2
        assert np.ptp(drawn[0]) > 1.0
        assert len(heights(first.locator(".joint").get_attribute("d"))) == 4
        assert first.locator("button").text_content() == "Play"
        assert overflow(shown) <= 0
        assert complaints == []


def test_nothing_moves_under_a_force_on_a_held_end(tmp_path: Path) -> None:
    data = operating_shapes(LINE, [5.0], forces=[Place(body="deck", x_m=12.0)])
    with pytest.raises(InputError, match="nothing moves"):
        animate_shapes(data * 0.0, LINE, tmp_path / "shapes.html")
