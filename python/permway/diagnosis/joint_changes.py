"""Predictions of lines that differ in joints alone: exactly, by a change of low rank, without a solve.

A joint whose stiffness is another pushes its two ends apart by what it changes. With H the receptances between
places, U those from places to the ends of the changed joints (upper less lower), G those between these joints and
D the changes of their stiffness,

    H' = H - U' (1 + D G)^-1 D U

(Sherman, Morrison and Woodbury; Golub and Van Loan 2013, Matrix Computations, section 2.1.4).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.factors import model_under
from permway.campaign.predict import Key, Request, Result, predict_one, request_of
from permway.campaign.predictions.sweeps import Location, Sweep, places_of
from permway.diagnosis.observations import Observations, Solved
from permway.diagnosis.side_by_side import threads_of_solver
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.response.ports import Port, between_pairs, from_places

MOST_JOINTS, MOST_SMALL = 32, 4
"""Joints that change, above which a line is solved anew: at 45 lines 32 take 1.5 ms (16 take 0.6, 64 take 4.7), a
solve of the demo's line about 2. And those above which a small change counts to first order: no change is small of
a single resonator at its resonance."""


EXACT = ("frf", "csd")
"""Kinds of record that joints change by receptances alone: not tables of a law, nor of modes, which are poles."""

MOST_BYTES = 2**22
"""Of the changes of one line, that are handed between processes: beyond, it is solved anew."""


@dataclass(frozen=True)
class Changed:
    """Joints that a line has otherwise.

    Attributes
    ----------
    ports : tuple of Port
    stiffness : tuple of ndarray, shape (F, ports)
        By which they are stiffer, N/m, in each of the states that records ask for.
    """

    ports: tuple[Port, ...]
    stiffness: tuple[Complexes, ...]


@dataclass(frozen=True)
class _State:
    """A line under one condition, at the frequencies of a need, with all places that records need there."""

    need: Request
    line: Line
    places: tuple[Location, ...]

    @cached_property
    def laws(self) -> Complexes:
        """Stiffness of the line's laws, (F, laws)."""
        return self.line.stiffness(self.need.frequency_Hz, self.need.temperature_C)

    @cached_property
    def joints(self) -> Complexes:
        """Stiffness of its joints, (F, joints)."""
        table = self.line.joint_table()
        return np.asarray(self.laws[:, table.law] * table.scale)

    def changed(self, line: Line) -> Complexes | None:
        """By how much another line's joints are stiffer, (F, joints); None if they are not these and more."""
        own, table = self.line.joint_table(), line.joint_table()
        count = own.x.size
        for name in ("x", "upper", "lower"):
            if not np.array_equal(getattr(table, name)[:count], getattr(own, name)):
                return None
        laws = line.stiffness(self.need.frequency_Hz, self.need.temperature_C)
        for name in _rotating(line):
            if not np.array_equal(laws[:, _index(line, name)], self.laws[:, _index(self.line, name)]):
                return None
        stiffer = laws[:, table.law] * table.scale
        stiffer[:, :count] -= self.joints
        return np.asarray(stiffer)


class JointChanges:
    """Lines that differ from one that was solved in the stiffness of joints, and by further ones.

    Parameters
    ----------
    observations : Observations
    campaign : Campaign
        That was solved.
    solved : Solved
        What it predicts.
    small : bool
        Whether changes are small: of many joints they then count to first order.
    """

    def __init__(
        self, observations: Observations, campaign: Campaign, solved: Solved, *, small: bool = False
    ) -> None:
        self.observations, self.campaign, self.solved = observations, campaign, solved
        self.small, self._most = small, MOST_SMALL if small else MOST_JOINTS
        needs: dict[Key, list[Request]] = {}
        exact = all(dataset.record.statistic in EXACT for dataset in observations.datasets)
        for need in solved.needs if exact else ():
            if need is not None:
                needs.setdefault(need.key, []).append(need)
        self._states = {key: self._state(alike) for key, alike in needs.items()}
        self._ports: dict[Port, int] = {}
        self._pairs: dict[tuple[Port, Port], int] = {}
        self._reached = {key: _none(s, 0, len(s.places)) for key, s in self._states.items()}
        self._own = {key: _none(s, 0) for key, s in self._states.items()}
        self._between = {key: _none(s, 0) for key, s in self._states.items()}
        self._at: dict[int, tuple[list[int], list[int]]] = {}

    def _state(self, needs: Sequence[Request]) -> _State:
        line = model_under(self.campaign.model, needs[0].factors).line
        return _State(needs[0], line, tuple(dict.fromkeys(at for n in needs for at in (*n.rows, *n.columns))))

    def of(self, campaign: Campaign) -> Changed | None:
        """What a campaign's joints have otherwise; None if it differs by more, or by too many of them.

        Raises
        ------
        InputError
            For a line that cannot be compiled.
        """
        if not self._states or not _differs_by_joints(self.campaign, campaign):
            return None
        table, found = campaign.model.line.joint_table(), []
        for state in self._states.values():
            stiffer = state.changed(model_under(campaign.model, state.need.factors).line)
            if stiffer is None:
                return None
            found.append(stiffer)
        moved = np.any([np.any(stiffer, axis=0) for stiffer in found], axis=0)
        count = int(np.count_nonzero(moved))
        if (not self.small and count > MOST_JOINTS) or 16 * count * sum(map(len, found)) > MOST_BYTES:
            return None
        columns = (column[moved].tolist() for column in (table.upper, table.lower, table.x))
        return Changed(tuple(zip(*columns, strict=True)), tuple(stiffer[:, moved] for stiffer in found))

    def solve(self, changes: Sequence[Changed]) -> None:
        """Take what these changes need of the line, before processes share the work.

        Raises
        ------
        InputError, SolveError
            If it cannot be solved.
        """
        ports = sorted({port for one in changes for port in one.ports} - self._ports.keys())
        several = {one.ports for one in changes if 1 < len(one.ports) <= self._most}
        pairs = sorted({(a, b) for own in several for a in own for b in own} - self._pairs.keys())
        threads = threads_of_solver(self.observations.threads)
        reached, own, between = dict(self._reached), dict(self._own), dict(self._between)
        for key, s in self._states.items():
            at, warm = s.need.frequency_Hz, s.need.temperature_C
            if ports:
                places = places_of(s.places)
                more = from_places(s.line, at, places, ports, temperature_C=warm, threads=threads)
                for known, further in zip((reached, own), more, strict=True):
                    known[key] = np.concatenate([known[key], further], axis=1)
            if pairs:
                further = between_pairs(s.line, at, pairs, temperature_C=warm, threads=threads)
                between[key] = np.concatenate([between[key], further], axis=1)
        # All at once: what fails midway leaves what is known as it was.
        self._reached, self._own, self._between = reached, own, between
        self._ports |= {port: len(self._ports) + i for i, port in enumerate(ports)}
        self._pairs |= {pair: len(self._pairs) + i for i, pair in enumerate(pairs)}

    def residuals(self, changed: Changed, campaign: Callable[[], Campaign]) -> Reals:
        """Standardised, of all rows.

        Parameters
        ----------
        changed : Changed
            Of those that were solved for.
        campaign : callable
            The campaign that has these joints, for records that are not of hammer tests.
        """
        pushed = {key: self._pushed(key, changed, index) for index, key in enumerate(self._states)}
        found, solved = [], self.solved
        for block, need, data in zip(self.observations.blocks, solved.needs, solved.datasets, strict=True):
            if need is None:
                found.append(block.residuals(data))
                continue
            rows, columns = self._places(need)
            reached, push = pushed[need.key]
            change = -reached[:, :, rows].swapaxes(1, 2) @ push[:, :, columns]
            residuals = block.changed(data, change)
            if residuals is None:
                other = campaign()
                asked = request_of(other, block.dataset)
                if asked is None or not asked.is_like(need):
                    # It needs other receptances than the line as it was.
                    return self.observations.residuals(self.observations.predicted(other, solved).datasets)
                residuals = block.residuals(predict_one(other, block.dataset, need, self._answer(need, change)))
            found.append(residuals)
        return np.concatenate(found)

    def _places(self, need: Request) -> tuple[list[int], list[int]]:
        """Where a need's rows and columns stand among its state's places."""
        if id(need) not in self._at:
            places = self._states[need.key].places
            rows, columns = ([places.index(place) for place in side] for side in (need.rows, need.columns))
            self._at[id(need)] = rows, columns
        return self._at[id(need)]

    def _answer(self, need: Request, change: Complexes) -> Result:
        """A need's receptances, changed."""
        places = places_of(need.columns), places_of(need.rows)
        sweep = Sweep(need.temperature_C, need.frequency_Hz, *places, need.factors)
        return Result(sweep, self.solved.answers[need.key].of(need) + change)

    def _pushed(self, key: Key, changed: Changed, state: int) -> tuple[Complexes, Complexes]:
        """What changed joints open by for forces at a state's places, and press with, each (F, joints, places)."""
        at, stiffer = [self._ports[port] for port in changed.ports], changed.stiffness[state]
        reached = self._reached[key][:, at]
        pushed = stiffer[:, :, None] * reached
        if len(at) == 1:
            pushed /= (1.0 + stiffer * self._own[key][:, at])[:, :, None]
        elif 0 < len(at) <= self._most:
            pairs = [self._pairs[a, b] for a in changed.ports for b in changed.ports]
            between = self._between[key][:, pairs].reshape(-1, len(at), len(at))
            pushed[:] = np.linalg.solve(np.eye(len(at)) + stiffer[:, :, None] * between, pushed)
        return reached, pushed


def _none(state: _State, *shape: int) -> Complexes:
    return np.zeros((state.need.frequency_Hz.size, *shape), dtype=np.complex128)


def _differs_by_joints(one: Campaign, other: Campaign) -> bool:
    """Whether the line's joints, and their laws, are all that may differ."""
    first, second = one.model.line, other.model.line
    if second.needs_temperature and not first.needs_temperature:
        # Its states are of all temperatures.
        return False
    if other.stated is not one.stated or one.model.formulation != "chain" or not first.laws:
        return False
    if first.bodies.keys() != second.bodies.keys():
        return False
    if any(second.bodies[name] is not body for name, body in first.bodies.items()):
        return False
    return other.model.model_copy(update={"line": first}) == one.model


def _rotating(line: Line) -> list[str]:
    """Laws of rotational springs, which are no joints."""
    beams = (body for body in line.bodies.values() if isinstance(body, Beam))
    return [law for beam in beams for law in beam.rotation_laws if law is not None]


def _index(line: Line, law: str) -> int:
    return list(line.laws).index(law)
