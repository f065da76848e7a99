"""A rod that waves cross: against a chain of masses and springs, and as a model's joint."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.laws import Waves, law_from_dict, law_to_dict
from permway.problem.model import Model
from simulated import MODEL


def two_port(frequency: np.ndarray, stiffness: float, delay_s: float, eta: float) -> np.ndarray:
    """Forces at both ends by movements of both, (F, 2, 2), from the parts of a rod."""
    through, end = (
        Waves(stiffness=stiffness, delay_s=delay_s, loss_factor=eta, part=part).complex(frequency)
        for part in ("through", "end")
    )
    return np.moveaxis(np.array([[through + end, -through], [-through, through + end]]), -1, 0)


def chain(frequency: np.ndarray, stiffness: float, delay_s: float, eta: float, pieces: int) -> np.ndarray:
    """The same of a chain: springs in a row, masses between them, inner movements eliminated."""
    spring, mass = stiffness * pieces * (1.0 + 1j * eta), stiffness * delay_s**2 / pieces
    count = pieces + 1
    springs = np.zeros((count, count), dtype=np.complex128)
    for i in range(pieces):
        springs[i : i + 2, i : i + 2] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    masses = mass * np.diag([0.5, *[1.0] * (pieces - 1), 0.5])
    kept = []
    for f in frequency:
        whole = springs - (2.0 * np.pi * f) ** 2 * masses
        inner = whole[1:-1, 1:-1]
        outer = whole[np.ix_([0, -1], [0, -1])]
        kept.append(outer - whole[[0, -1], 1:-1] @ np.linalg.solve(inner, whole[1:-1, [0, -1]]))
    return np.array(kept)


def test_a_rod_is_a_chain_of_many_masses() -> None:
    frequency = np.linspace(1.0, 900.0, 60)
    rod = two_port(frequency, 4e6, 1.3e-3, 0.12)
    np.testing.assert_allclose(chain(frequency, 4e6, 1.3e-3, 0.12, 600), rod, rtol=1e-3, atol=1e-4 * 4e6)


@given(
    stiffness=st.floats(1e3, 1e9),
    delay_s=st.floats(1e-5, 1e-2),
    eta=st.floats(0.0, 1.0),
    frequency=st.floats(0.5, 2000.0),
)
def test_a_rod_gives_no_energy(stiffness: float, delay_s: float, eta: float, frequency: float) -> None:
    (port,) = two_port(np.array([frequency]), stiffness, delay_s, eta)
    assert np.linalg.eigvalsh(port.imag).min() >= -1e-9 * np.abs(port).max()


def test_at_rest_a_rod_is_a_spring_and_two_halves_of_its_mass() -> None:
    frequency = np.array([0.01])
    through = Waves(stiffness=5e6, delay_s=2e-3, part="through")
    end = Waves(stiffness=5e6, delay_s=2e-3, part="end")
    assert through.complex(frequency)[0] == pytest.approx(5e6)
    assert end.complex(frequency)[0] / -((2.0 * np.pi * 0.01) ** 2) == pytest.approx(0.5 * 5e6 * 2e-3**2)


def test_what_is_written_reads_back() -> None:
    law = Waves(stiffness=5e6, delay_s=2e-3, loss_factor=0.1, part="end")
    assert law_from_dict(law_to_dict(law)) == law
    with pytest.raises(InputError, match="delay_s must be above zero"):
        law_from_dict({"type": "waves", "stiffness": 5e6, "delay_s": 0.0, "part": "end"})


def with_rods(*layers: tuple[list[str], str], scale: float = 1.0) -> Model:
    """The small bridge with rods beside its pads."""
    rod = {"type": "waves", "stiffness": 2e6, "delay_s": 1e-3, "loss_factor": 0.1}
    line = MODEL["line"]
    laws = {**line["laws"], "mat": {**rod, "part": "through"}, "mat_end": {**rod, "part": "end"}}
    at = [3.0, 4.2]
    joints: list[dict[str, Any]] = [{"between": list(b), "law": law, "at": at} for b, law in layers]
    joints[0]["scale"] = scale
    return model_from_dict({**MODEL, "line": {**line, "laws": laws, "joints": [*line["joints"], *joints]}})


THROUGH = (["rail", "deck"], "mat")
UPPER, LOWER = (["rail", "ground"], "mat_end"), (["deck", "ground"], "mat_end")


def test_a_model_may_have_rods() -> None:
    line = with_rods(THROUGH, UPPER, LOWER).line
    assert np.isfinite(line.stiffness(np.array([100.0, 700.0]))).all()


@pytest.mark.parametrize(("layers", "lacks"), [((THROUGH, UPPER), "deck"), ((THROUGH, LOWER), "rail")])
def test_a_rod_lacks_an_end(layers: tuple[tuple[list[str], str], ...], lacks: str) -> None:
    with pytest.raises(InputError, match=f"'{lacks}' has no end of the rod"):
        with_rods(*layers)


def test_ends_of_another_size_are_not_its_ends() -> None:
    with pytest.raises(InputError, match="has no end of the rod"):
        with_rods(THROUGH, UPPER, LOWER, scale=0.5)
