"""A track as finite elements, and its response, frequency by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import lapack

from permway.challenge.beams import Blocks, Complexes, Reals, Section, cable_element, dynamic, element, endless
from permway.challenge.track import BODIES, TOUCH_M, Beam, Link, Location, Track
from permway.errors import InputError, SolveError

NDIndex = NDArray[np.int64]
Entries = tuple[NDIndex, NDIndex, Complexes]
"""Rows, columns and values."""


class Mesh:
    """Nodes of a track and the pattern of its band matrix.

    Parameters
    ----------
    track : Track
    locations : sequence of Location
        Where it will be struck or read: there are nodes there.
    """

    def __init__(self, track: Track, locations: Sequence[Location]) -> None:
        self.track = track
        self.columns = _columns(track, locations)
        self._number()
        self._assemble()

    def at(self, location: Location, *, after: bool = False) -> int:
        """The degree of freedom of a place's deflection.

        Raises
        ------
        InputError
            If the body has no node there.
        """
        body, x = location
        column = int(np.argmin(np.abs(self.columns - x)))
        found = self.nodes[body].get((column, int(after)), self.nodes[body].get((column, 0)))
        if found is None or abs(self.columns[column] - x) > TOUCH_M:
            raise InputError("there is no node", where=f"{body} at {x:g} m")
        return found

    def _number(self) -> None:
        self.nodes: dict[str, dict[tuple[int, int], int]] = {body: {} for body in self.track.beams}
        count = 0
        names = [body for body in BODIES if body in self.track.beams]
        for column, x in enumerate(self.columns):
            for body in names:
                beam = self.track.beams[body]
                if beam.start - TOUCH_M < x < beam.stop + TOUCH_M:
                    for side in range(1 + any(abs(x - place) < TOUCH_M for place in beam.breaks)):
                        self.nodes[body][column, side] = count
                        count += 2
        self.size = count

    def elements(self, body: str) -> list[tuple[NDIndex, float, float]]:
        """Degrees of freedom of each element of a body, from where to where, m."""
        nodes, found = self.nodes[body], []
        for column in sorted({column for column, _ in nodes})[:-1]:
            left = nodes.get((column, 1), nodes[column, 0])
            right = nodes[column + 1, 0]
            dofs = np.array([left, left + 1, right, right + 1])
            found.append((dofs, float(self.columns[column]), float(self.columns[column + 1])))
        return found

    def _assemble(self) -> None:
        """Entries of the band matrix as (row, column, value) for each group that one coefficient multiplies."""
        groups: list[list[Entries]] = [[], []]
        dashpots: list[Entries] = []
        self.pieces: list[tuple[Section, float, int, int]] = []
        for body, beam in self.track.beams.items():
            if np.isfinite(beam.section.shear):
                groups += self._fine(body, beam)
                continue
            for dofs, left, right in self.elements(body):
                stiffness, mass = element(beam.part(left, right), right - left)
                if beam.tension:
                    stiffness = stiffness + cable_element(beam.tension, right - left)
                rows, columns = np.meshgrid(dofs, dofs, indexing="ij")
                groups[0].append((rows.ravel(), columns.ravel(), mass.ravel().astype(complex)))
                stiff = (1.0 + 1j * beam.section.loss) * stiffness
                groups[1].append((rows.ravel(), columns.ravel(), np.asarray(stiff.ravel())))
                if any(beam.viscous):
                    by_mass, by_stiffness, by_slope = beam.viscous
                    loss = by_mass * mass + by_stiffness * stiffness + cable_element(by_slope, right - left)
                    dashpots.append((rows.ravel(), columns.ravel(), loss.ravel().astype(complex)))
        self.has_dashpots = bool(dashpots)
        if dashpots:
            groups.append(dashpots)
        self.law_groups: list[tuple[str, int, int]] = []
        for name in dict.fromkeys(link.law for link in self.track.links):
            links = [link for link in self.track.links if link.law == name]
            dofs = np.array([self.tied(link) for link in links])
            scale = np.array([link.scale for link in links], dtype=complex)
            for i in range(dofs.shape[1]):
                for j in range(dofs.shape[1]):
                    self.law_groups.append((name, i, j))
                    groups.append([(dofs[:, i], dofs[:, j], scale)])
        self.ends: dict[str, tuple[int, int]] = {}
        for body, beam in self.track.beams.items():
            if beam.endless:
                elements = self.elements(body)
                self.ends[body] = int(elements[0][0][0]), int(elements[-1][0][2])
        self._pattern(groups)

    def _fine(self, body: str, beam: Beam) -> list[list[Entries]]:
        """Entries of a body of finer elements: a group for each length, section and place in a block."""
        alike: dict[tuple[Section, float], list[NDIndex]] = {}
        for dofs, left, right in self.elements(body):
            alike.setdefault((beam.part(left, right), round(right - left, 7)), []).append(dofs)
        groups: list[list[Entries]] = []
        for (section, length), found in alike.items():
            places = np.array(found)
            for i in range(4):
                for j in range(4):
                    self.pieces.append((section, length, i, j))
                    groups.append([(places[:, i], places[:, j], np.ones(len(found), dtype=np.complex128))])
        return groups

    def _pattern(self, groups: list[list[Entries]]) -> None:
        rows = [np.concatenate([part[0] for part in group]) for group in groups]
        columns = [np.concatenate([part[1] for part in group]) for group in groups]
        values = [np.concatenate([part[2] for part in group]) for group in groups]
        self.reach = max(int(np.abs(r - c).max()) for r, c in zip(rows, columns, strict=True))
        self.tall = 3 * self.reach + 1
        # Band storage of LAPACK, Fortran order: entry (i, j) stands in row 2 reach + i - j of column j.
        flat = [c * self.tall + 2 * self.reach + r - c for r, c in zip(rows, columns, strict=True)]
        self.filled = np.unique(np.concatenate(flat))
        entries = [
            (np.searchsorted(self.filled, places), np.full(places.size, index), value)
            for index, (places, value) in enumerate(zip(flat, values, strict=True))
        ]
        at, group, value = (np.concatenate(part) for part in zip(*entries, strict=True))
        self.table = sparse.csr_array((value, (at, group)), shape=(self.filled.size, len(groups)))

    def tied(self, link: Link) -> list[int]:
        """Degrees of freedom of a link's points."""
        after = link.after or (False,) * len(link.locations)
        return [self.at(location, after=side) for location, side in zip(link.locations, after, strict=True)]

    def receptance(
        self, frequency_Hz: Reals, temperature_C: float, rows: Sequence[Location], columns: Sequence[Location]
    ) -> Complexes:
        """Deflections at `rows` per force at `columns`.

        Solved for forces at `rows`, of which there should be the fewer; reciprocity does the rest.

        Returns
        -------
        ndarray of complex128, shape (F, rows, columns)
            m/N.

        Raises
        ------
        SolveError
            At a frequency where the matrix is singular.
        """
        coefficients = self._coefficients(frequency_Hz, temperature_C)
        ends = {
            body: endless(self.track.beams[body].section, self.track.step_m, frequency_Hz) for body in self.ends
        }
        forces = np.zeros((self.size, len(rows)), dtype=np.complex128, order="F")
        forces[[self.at(location) for location in rows], range(len(rows))] = 1.0
        read = [self.at(location) for location in columns]
        answer = np.empty((frequency_Hz.size, len(rows), len(columns)), dtype=np.complex128)
        flat = np.zeros(self.tall * self.size, dtype=np.complex128)
        for index, hertz in enumerate(frequency_Hz):
            flat[:] = 0.0
            flat[self.filled] = self.table @ coefficients[index]
            band = flat.reshape(self.size, self.tall).T
            for body, places in self.ends.items():
                for dof, stiffness in zip(places, ends[body], strict=True):
                    for i in (0, 1):
                        for j in (0, 1):
                            band[2 * self.reach + i - j, dof + j] += stiffness[index, i, j]
            _, _, displaced, info = lapack.zgbsv(self.reach, self.reach, band, forces, overwrite_ab=1)
            if info:
                raise SolveError(f"singular at {hertz:g} Hz")
            answer[index] = displaced[read].T
        return answer

    def _coefficients(self, frequency_Hz: Reals, temperature_C: float) -> Complexes:
        rows: list[Reals | Complexes] = [-((2.0 * np.pi * frequency_Hz) ** 2), np.ones(frequency_Hz.size)]
        blocks: dict[tuple[Section, float], Blocks] = {
            (section, length): dynamic(section, length, frequency_Hz) for section, length, _, _ in self.pieces
        }
        rows += [
            blocks[section, length][2 * (i // 2) + j // 2][:, i % 2, j % 2]
            for section, length, i, j in self.pieces
        ]
        if self.has_dashpots:
            rows.append((2j * np.pi * frequency_Hz).astype(np.complex128))
        laws = {name: self.track.laws[name](frequency_Hz, temperature_C) for name, _, _ in self.law_groups}
        rows += [laws[name][:, i, j] for name, i, j in self.law_groups]
        return np.stack(rows, axis=1).astype(np.complex128)


def _columns(track: Track, locations: Sequence[Location]) -> Reals:
    """Places of nodes: where something is tied, cut, struck or read, and between these every `step_m` or less."""
    needed = [x for _, x in locations]
    needed += [x for link in track.links for _, x in link.locations]
    for beam in track.beams.values():
        needed += [beam.start, beam.stop, *beam.breaks]
        needed += [x for stretch in beam.stretches for x in stretch[:2]]
    fixed = np.unique(np.round(np.array(needed), 6))
    fixed = fixed[np.concatenate([[True], np.diff(fixed) > TOUCH_M])]
    parts = [
        np.linspace(left, right, int(np.ceil((right - left) / track.step_m - 1e-6)) + 1)[:-1]
        for left, right in pairwise(fixed)
    ]
    return np.concatenate([*parts, fixed[-1:]])
