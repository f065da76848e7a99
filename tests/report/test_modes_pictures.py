"""Pictures of mode shapes."""

from __future__ import annotations

from pathlib import Path

import permway
from permway.laws import KelvinVoigt
from permway.model.bodies import Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.report.modes import _figure, draw_modes

LAWS = {"soft": KelvinVoigt(stiffness=4.0e4, damping=200.0), "tie": KelvinVoigt(stiffness=1.0e4, damping=0.0)}


def chain(count: int) -> Line:
    """Masses on springs, tied in a row: as many modes."""
    joints = tuple(Joints(between=(f"m{i}", "ground"), law="soft", at=(float(i),)) for i in range(count))
    joints += tuple(Joints(between=(f"m{i}", f"m{i + 1}"), law="tie", at=(i + 0.5,)) for i in range(count - 1))
    return Line(bodies={f"m{i}": Mass(mass_kg=10.0) for i in range(count)}, joints=joints, laws=LAWS)


def test_twelve_modes_a_picture(tmp_path: Path) -> None:
    data = permway.modes(chain(13), 2.0, 40.0)
    assert data.sizes["mode"] == 13
    paths = draw_modes(data, tmp_path / "new")
    assert [p.name for p in paths] == ["modes.png", "modes-2.png"]
    assert all(p.read_bytes().startswith(b"\x89PNG") for p in paths)
    again = draw_modes(data, tmp_path / "again")
    assert [p.read_bytes() for p in again] == [p.read_bytes() for p in paths]


def test_no_mode_no_picture(tmp_path: Path) -> None:
    assert draw_modes(permway.modes(chain(2), 100.0, 200.0), tmp_path) == []


def test_down_is_down_and_titles_state_frequency_and_damping() -> None:
    data = permway.modes(chain(2), 2.0, 40.0)
    figure = _figure(data)
    first = figure.axes[0]
    assert first.yaxis_inverted()
    frequency = data.natural_frequency.values[0]
    assert first.get_title(loc="left").startswith(f"1:  {frequency:.5g} Hz")
