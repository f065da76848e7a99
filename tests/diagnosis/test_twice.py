"""One effect found twice: at one place, or all along one body."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from permway.diagnosis.hypothesis import Where
from permway.diagnosis.twice import twice_of


def found(entry: str, what: str, x_m: float | None, **values: float) -> Any:
    where = Where(what, None if x_m is None else (x_m, x_m))
    hypothesis = SimpleNamespace(entry=entry, locate=lambda _: where)
    return SimpleNamespace(hypothesis=hypothesis, values={"frequency_Hz": 9.0, "loss_factor": 0.1, **values})


def test_the_heavier_of_two_along_one_body() -> None:
    light, heavy = (found("girder_local_modes", "girder", None, mass_share=share) for share in (0.004, 0.05))
    assert twice_of([light, heavy]) is heavy
    assert twice_of([heavy, light]) is heavy
    other = found("girder_local_modes", "girder[1]", None, mass_share=0.05)
    assert twice_of([light, other]) is None
    assert twice_of([light]) is None


def test_the_heavier_of_two_at_one_place() -> None:
    here, near, far = (found("deck_attachment", "girder", x, mass_kg=900.0 + x) for x in (8.0, 8.3, 12.0))
    assert twice_of([here, near]) is near
    assert twice_of([here, far]) is None
    assert twice_of([here, found("rail_absorber", "girder", 8.0, mass_kg=5.0)]) is None
    # One at a place and one all along are two.
    assert twice_of([here, found("deck_attachment", "girder", None, mass_kg=900.0)]) is None
    # What is no mass on a spring may well be there twice.
    spring = cast(Any, SimpleNamespace(hypothesis=here.hypothesis, values={"factor": 2.0}))
    assert twice_of([spring, spring]) is None
