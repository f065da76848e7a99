"""Calls of the compiled core with tables damaged at random: it may refuse or solve, and never panic."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from permway import _core
from permway.laws import Hysteretic
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response import core as caller
from permway.response.receptance import receptance
from permway.response.sensitivity import sensitivity

SPECIAL = [0.0, -0.0, -1.0, 1e-300, 1e300, -1e300, 5e-324, np.nan, np.inf, -np.inf, 1e9, 1e-9, 1.0, 0.6, 1e15]
INDICES = [0, 1, 2, 3, -1, -2, 7, 1000, 2**31, 2**62, -(2**63)]


@cache
def calls() -> list[dict[str, Any]]:
    """What the package itself hands over, for lines of all kinds of bodies."""
    beam = {
        "youngs_modulus_Pa": 2.1e11,
        "second_moment_m4": 3e-5,
        "density_kg_per_m3": 7850.0,
        "area_m2": 7.7e-3,
        "loss_factor": 0.01,
    }
    pad = Hysteretic(stiffness=6e7, loss_factor=0.2)
    at = tuple(0.6 * k for k in range(6))
    bodies = {
        "rail": Beam(**beam, theory="timoshenko", shear_modulus_Pa=8e10, shear_coefficient=0.4),
        "deck": Beam(**beam, intervals_m=((0.0, 1.5), (1.5, 3.0)), modes=6),
        "block": Mass(mass_kg=80.0, at=(0.6, 1.8)),
    }
    joints = (
        Joints(between=("rail", "deck"), law="pad", at=at[1:3]),
        Joints(between=("rail", "block"), law="pad", at=(0.6, 1.8)),
        Joints(between=("block", "ground"), law="pad", at=(0.6, 1.8)),
        Joints(between=("deck", "ground"), law="pad", at=(0.3, 2.4)),
    )
    modal = Line(bodies=bodies, joints=joints, laws={"pad": pad})
    exact = Line(
        bodies={**bodies, "deck": bodies["deck"].model_copy(update={"modes": None})},
        joints=joints,
        laws={"pad": pad},
    )
    here = [Place(body="rail", x_m=0.5), Place(body="rail", x_m=1.2)]
    frequency = np.array([5.0, 50.0, 400.0])
    caught: list[dict[str, Any]] = []

    class Listening:
        TablesError = _core.TablesError

        @staticmethod
        def solve_line(**given: Any) -> Any:
            caught.append(given)
            return _core.solve_line(**given)

    before = caller._core
    caller._core = Listening  # type: ignore[assignment]
    try:
        for line, formulation in ((exact, "chain"), (modal, "receptance")):
            receptance(line, frequency, forces=here[:1], sensors=here, formulation=formulation, threads=1)
        sensitivity(exact, frequency, forces=here[:1], sensors=here, threads=1, bodies=True, places=True)
    finally:
        caller._core = before
    assert len(caught) == 3
    return caught


def attempt(number: int) -> str:
    """Damage a call by a random number, make it, and say what came of it."""
    random = np.random.default_rng(number)
    known = calls()
    call = _copied(known[int(random.integers(len(known)))])
    for _ in range(int(random.integers(1, 4))):
        _damage(call, random)
    # Divisions by zero are those of a callback for progress.
    refusals = (_core.TablesError, TypeError, ValueError, KeyError, OverflowError, IndexError, ZeroDivisionError)
    try:
        _core.solve_line(**call)
    except refusals as error:
        return f"refused {type(error).__name__}"
    except BaseException as error:  # noqa: BLE001 - a panic is no Exception
        return f"broken: {type(error).__name__}: {str(error)[:200]}"
    return "solved"


def _copied(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return value.copy() if isinstance(value, np.ndarray) else value


def _arrays(table: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    found = [(table, key) for key, value in table.items() if isinstance(value, np.ndarray)]
    for value in table.values():
        if isinstance(value, dict):
            found += _arrays(value)
    return found


def _damage(call: dict[str, Any], random: np.random.Generator) -> None:
    arrays = _arrays(call)
    table, key = arrays[int(random.integers(len(arrays)))]
    array = table[key]
    kind = str(random.choice(["value", "value", "value", "shape", "type", "layout", "swap", "drop", "plain"]))
    if kind == "value" and array.size:
        at = tuple(int(random.integers(n)) for n in array.shape)
        pool = INDICES if array.dtype.kind in "iu" else SPECIAL
        value = pool[int(random.integers(len(pool)))]
        if array.dtype.kind == "c" and random.random() < 0.5:
            array[at] = complex(array[at].real, value)
        else:
            array[at] = bool(value) if array.dtype.kind == "b" else value
    elif kind == "shape":
        table[key] = _reshaped(array, random)
    elif kind == "type":
        with np.errstate(all="ignore"):
            table[key] = np.real(array).astype(str(random.choice(["f4", "i8", "c16", "O", "f8", "U9"])))
    elif kind == "layout":
        wide = np.repeat(np.atleast_1d(array), 2, axis=-1)
        table[key] = wide[..., ::2] if random.random() < 0.5 else np.asfortranarray(array)[..., ::-1]
    elif kind == "swap":
        other, name = arrays[int(random.integers(len(arrays)))]
        table[key], other[name] = other[name], table[key]
    elif kind == "drop":
        del table[key]
    else:
        choices: dict[str, list[Any]] = {
            "formulation": ["chain", "receptance", "", "x"],
            "threads": [0, 1, 2, -1],
            "extensions": [True, False],
            "names": [[], ["rail"], ["a"] * 9],
            "progress": [None, lambda done, total: 1 / 0],
        }
        name = str(random.choice(list(choices)))
        call[name] = choices[name][int(random.integers(len(choices[name])))]
        if isinstance(call.get("derived"), dict):
            derived = call["derived"]
            derived["n_groups"] = int(random.choice([0, 1, 3, 1000]))


def _reshaped(array: np.ndarray, random: np.random.Generator) -> np.ndarray:
    kind = int(random.integers(6))
    if kind == 0:
        return array[:0]
    if kind == 1:
        return array[:-1]
    if kind == 2:
        return np.concatenate([array, array])
    if kind == 3:
        return array[None]
    if kind == 4:
        return array.ravel()
    return np.asarray(array[..., :1])
