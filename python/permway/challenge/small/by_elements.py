"""Records by the challenge's own finite elements, which share no code with the solver: hammer tests alone."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.concealed import Concealed
from permway.challenge.small.elements_effects import OUTSIDE, PATH
from permway.challenge.small.elements_faults import FAMILIES, fault
from permway.challenge.small.elements_line import Line, line_of
from permway.challenge.small.layouts import Layout
from permway.challenge.small.places import Tests
from permway.errors import InputError

STEP = 1e-3
"""Of slopes, in standard deviations of a prior."""

AT_A_POINT = 0.3
"""Share of effects of the line that stand right at a hammer point, where they are hardest to place."""


class ByElements:
    """Records of one campaign with its true parameters.

    Parameters
    ----------
    tests : Tests
    layout : Layout
    values : mapping of str to float
        True values of the parameters.
    beyond : mapping of str to float
        Values one step away, by which slopes are taken.
    """

    name = "elements"

    def __init__(
        self, tests: Tests, layout: Layout, values: Mapping[str, float], beyond: Mapping[str, float]
    ) -> None:
        self.tests, self.layout, self.values, self.beyond = tests, layout, dict(values), dict(beyond)
        self.base = self._solved(values, ())

    def responses(self, effects: Sequence[tuple[Concealed, float]]) -> list[Complexes]:
        """Hammer tests, (tests, sensors, points, F)."""
        return self._solved(self.values, effects) if effects else self.base

    def slopes(self) -> list[list[Complexes]]:
        """Responses one step away in each parameter."""
        return [self._solved({**self.values, name: value}, ()) for name, value in self.beyond.items()]

    def in_detail(self, effects: Sequence[tuple[Concealed, float]]) -> tuple[Reals, Complexes]:
        """Of a run: there is none."""
        raise InputError("has no runs", where="maker", value=self.name)

    def draw(self, random: np.random.Generator, name: str | None) -> Concealed | None:
        """See :meth:`permway.challenge.small.by_model.ByModel.draw`."""
        forces = [f["x_m"] for f in self.tests.forces]
        at_a_point = random.random() < AT_A_POINT
        place = (
            forces[int(random.integers(len(forces)))]
            if at_a_point
            else (float(random.uniform(0.0, self.layout.length_m)))
        )
        if name is None:
            return OUTSIDE(random, self.layout, place)
        if name in FAMILIES:
            sensors = [sensor["name"] for sensor in self.tests.sensors]
            return fault(random, name, sensors[int(random.integers(len(sensors)))], self.layout.top_Hz)
        if name not in PATH or (name == "pad_temperature" and len(self.tests.temperatures_C) < 2):
            return None
        return PATH[name](random, self.layout, place)

    def line(self, values: Mapping[str, float]) -> Line:
        """The line with other values of the parameters."""
        table = copy.deepcopy(self.layout.line)
        paths = {p["name"]: p["paths"] for p in self.tests.campaign.get("parameters", [])}
        for name, value in values.items():
            _set(table, paths[name].split(".")[1:], value)
        return line_of(table)

    def _solved(self, values: Mapping[str, float], effects: Sequence[tuple[Concealed, float]]) -> list[Complexes]:
        line = self.line(values)
        for effect, share in effects:
            line = effect.change(line, share)
        frequency = self.tests.frequency_Hz
        rows = [(s["body"], s["x_m"]) for s in self.tests.sensors]
        columns = [(f["body"], f["x_m"]) for f in self.tests.forces]
        chains = np.array(
            [
                line.chains[s["name"]](frequency) if s["name"] in line.chains else np.ones(frequency.size, complex)
                for s in self.tests.sensors
            ]
        )
        rates = -((2.0 * np.pi * frequency) ** 2) * chains[:, None, :]
        found, known = [], {}
        # Only one effect knows of temperatures.
        warm = any(effect.id == "pad_temperature" for effect, _ in effects)
        for temperature in self.tests.temperatures_C:
            key = temperature if warm else 0.0
            if key not in known:
                known[key] = line.receptance(frequency, temperature, rows, columns)
            found.append(known[key] * rates)
        return [np.stack(found)]


def _set(table: dict[str, Any], path: list[str], value: float) -> None:
    for step in path[:-1]:
        table = table[step]
    table[path[-1]] = value
