"""How calibration errors of chains act on the residuals of records, as a sparse design over nodes of frequency."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse

from permway.arrays import Complexes, Reals
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.blocks_passage import PassageBlock
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.posterior.matern import STATES, Nodes
from permway.posterior.tridiagonal import Tridiagonal


@dataclass(frozen=True)
class Entries:
    """Which process moves which row: by its value at a line, and by its slope there.

    Attributes
    ----------
    row, process : ndarray of int, shape (e,)
    x : ndarray, shape (e,)
        Octaves.
    value, slope : ndarray, shape (e,)
        Residual per neper, and per neper an octave.
    """

    row: np.ndarray
    process: np.ndarray
    x: Reals
    value: Reals
    slope: Reals


class Chains:
    """Calibration errors that act on some rows, independent a priori, each a Markov process over frequency.

    Parameters
    ----------
    rows : ndarray of int, shape (n,) or (n, 2)
        Of the residuals; with two columns, real and imaginary parts that the same design moves.
    turn : ndarray of complex128, shape (n,), optional
        By which complex rows are turned so that a gain moves the real part alone.
    kinds : tuple of str
        Of each process; what sizes are known by.
    entries : Entries
    relative : ndarray, shape (n,), optional
        Of each row what an error of 1 neper does to it.

    Attributes
    ----------
    local : slice or ndarray of int
        The rows that the processes act on, ascending.
    order : ndarray of int, shape (local rows,)
        Where each of these stands among `rows`, first column by column.
    acts : sparse array, shape (local rows, parts states)
        How the states act on them; where rows are turned, log gains are the first part and phases the second.
    """

    def __init__(
        self,
        rows: np.ndarray,
        turn: Complexes | None,
        kinds: tuple[str, ...],
        entries: Entries,
        relative: Reals | None = None,
    ) -> None:
        self.rows, self.turn, self.kinds = rows, turn, kinds
        self.relative = np.ones(len(rows)) if relative is None else relative
        self.nodes = Nodes.of(entries.x)
        width = STATES * len(kinds)
        self.size = width * self.nodes.x.size
        before, value, slope = self.nodes.at(entries.x)
        weights = value * entries.value[:, None] + slope * entries.slope[:, None]
        first = (before * width + STATES * entries.process)[:, None] + np.arange(STATES)
        columns = np.concatenate([first, first + width], axis=1)
        # A line at a node has that node's value, and no other state.
        inside = (columns < self.size) & (np.abs(weights) > 1e-12)
        row = np.broadcast_to(entries.row[:, None], columns.shape)
        self.design = sparse.csr_array(
            (weights[inside], (row[inside], columns[inside])), shape=(len(rows), self.size)
        )
        self.parts = 1 if turn is None else 2
        local = rows if turn is None else rows.T.reshape(-1)
        self.order = np.argsort(local)
        self.acts = sparse.csr_array((self.design if turn is None else _turned(self.design, turn))[self.order])
        self.local = contiguous(local[self.order])
        self._pairs()

    def _pairs(self) -> None:
        """Products of entries of one row, and where they stand in the blocks of the normal matrix."""
        design, width = self.design, STATES * len(self.kinds)
        row = np.repeat(np.arange(design.shape[0]), np.diff(design.indptr))
        each = sparse.csr_array((np.ones(design.nnz, dtype=np.int64), (np.arange(design.nnz), row)))
        first, second = (each @ each.T).tocoo().coords
        at, beside = (design.indices[which].astype(np.int64) for which in (first, second))
        low = at // width >= beside // width
        first, second, at, beside = first[low], second[low], at[low], beside[low]
        # Blocks on the diagonal, each with its rows; then those below it.
        block = np.where(at // width == beside // width, at // width, self.nodes.x.size + beside // width)
        place = (block * width + at % width) * width + beside % width
        # Each place once: of all rows that add to it, only weights differ.
        self.place, inverse = np.unique(place, return_inverse=True)
        values = design.data[first] * design.data[second]
        self.products = sparse.csr_array((values, (inverse, row[first])), shape=(self.place.size, design.shape[0]))

    def factor(self, sizes: Reals, length: float, weights: Reals) -> Factor:
        """Factor the normal matrix of the processes.

        Parameters
        ----------
        sizes : ndarray, shape (processes,)
            Standard deviations, neper or rad.
        length : float
            Octaves.
        weights : ndarray, shape (n,)
            Precision of each row.
        """
        diagonal, below, log_prior = self.nodes.precision(length)
        count, processes = self.nodes.x.size, len(self.kinds)
        blocks = np.zeros((2 * count - 1, processes, STATES, processes, STATES))
        blocks.reshape(-1)[self.place] = self.products @ weights
        each = np.arange(processes)
        prior = np.concatenate([diagonal, below])
        blocks[:, each, :, each, :] += prior / (sizes**2)[:, None, None, None]
        square = blocks.reshape(2 * count - 1, processes * STATES, processes * STATES)
        factor = Tridiagonal.of(square[:count], square[count:])
        log_prior = processes * log_prior - STATES * count * float(np.log(sizes**2).sum())
        log_determinant = self.parts * (factor.log_determinant - log_prior)
        return Factor(self, factor, weights, log_determinant)


def contiguous(rows: np.ndarray) -> slice | np.ndarray:
    """Ascending rows, as a slice if none lies between: that copies nothing."""
    first, last = int(rows[0]), int(rows[-1])
    return slice(first, last + 1) if last + 1 - first == rows.size else rows


def _turned(design: sparse.csr_array, turn: Complexes) -> sparse.csr_array:
    """From states of log gains, then of phases, to real parts, then imaginary parts of rows."""
    along, across = (design.multiply(part[:, None]) for part in (turn.real, turn.imag))
    return sparse.csr_array(sparse.block_array([[along, across], [-across, along]]))


@dataclass(frozen=True)
class Factor:
    """Applies the inverse of D + C K C', D diagonal, K that of the processes (Woodbury's identity)."""

    chains: Chains
    factor: Tridiagonal
    weights: Reals
    log_determinant: float
    """Of I + C K C' D^-1."""

    def pulled(self, weighted: Reals) -> Reals:
        """C' times columns that are weighted already, as the factor solves for it: shape (states, parts k)."""
        chains, count = self.chains, weighted.shape[1]
        each = np.asarray(chains.acts.T @ weighted).reshape(chains.parts, chains.size, count)
        return np.ascontiguousarray(np.moveaxis(each, 0, 1).reshape(chains.size, chains.parts * count))

    def half(self, pulled: Reals) -> Reals:
        """L^-1 times what :meth:`pulled` gives, L the factor: shape (states parts, k)."""
        return self.factor.forward(pulled).reshape(self.chains.parts * self.chains.size, -1)

    def states(self, weighted: Reals) -> Reals:
        """Most probable states of the processes, given what rows are: shape (parts states, k)."""
        chains, count = self.chains, weighted.shape[1]
        solved = self.factor.backward(self.factor.forward(self.pulled(weighted)))
        each = solved.reshape(chains.size, chains.parts, count)
        return np.ascontiguousarray(np.moveaxis(each, 1, 0).reshape(chains.parts * chains.size, count))

    @cached_property
    def inverse(self) -> tuple[Reals, Reals]:
        """See :meth:`Tridiagonal.inverse_blocks`."""
        return self.factor.inverse_blocks()

    @cached_property
    def variance(self) -> Reals:
        """Of what the processes do to each of the rows that they act on, given what rows are."""
        chains = self.chains
        at, below = self.inverse
        # Products of entries are there once of two that are in different blocks.
        both = np.concatenate([at, 2.0 * below]).reshape(-1)[chains.place]
        found = np.asarray(chains.products.T @ both)
        return found[chains.order % found.size]

    def apply(self, weighted: Reals) -> Reals:
        """What the processes take off columns that are weighted already, but for the weights."""
        return np.asarray(self.chains.acts @ self.states(weighted))


def of_products(blocks: list[tuple[int, FrfBlock | PassageBlock]]) -> Chains:
    """Errors that multiply complex values, of all blocks together: one chain has the same in each.

    Parameters
    ----------
    blocks : list of (int, block)
        Each with its first row.
    """
    names: dict[str, int] = {}
    rows, turns, parts, sizes, start = [], [], [], [], 0
    for first, block in blocks:
        shape, count = block.measured.shape, block.measured.size
        at = np.arange(count)
        x = np.broadcast_to(np.log2(block.frequency), shape).reshape(-1)
        relative = block.relative.reshape(-1)
        for of, axis in block.processes:
            which = np.array([names.setdefault(name, len(names)) for name in of])
            along = np.moveaxis(which.reshape(-1, *[1] * (len(shape) - 1)), 0, axis)
            process = np.broadcast_to(along, shape).reshape(-1)
            parts.append(Entries(start + at, process, x, relative, np.zeros(count)))
        rows.append(first + np.stack([at, count + at], axis=1))
        turns.append(block.phase.conj().reshape(-1))
        sizes.append(relative)
        start += count
    kinds = tuple(name.split(" ", 1)[0] for name in names)
    return Chains(np.concatenate(rows), np.concatenate(turns), kinds, joined(parts), np.concatenate(sizes))


def of_spectra(blocks: list[tuple[int, SpectraBlock]]) -> Chains:
    """Errors of the channels of all runs together: log gain and phase of each, and of what it does not share.

    What a channel shares with no other is little, and of much that no model has: its noise, its crosstalk, what
    the window tears apart. So the density of it is off by as smooth an error.
    """
    names: dict[tuple[str, complex | str], int] = {}
    rows, parts, start = [], [], 0

    def add(what: tuple[str, complex | str], at: Reals, row: int, value: Reals, slope: Reals) -> None:
        process = names.setdefault(what, len(names))
        where = np.flatnonzero((np.abs(value) > 0.0) | (np.abs(slope) > 0.0))
        each = np.full(where.size, process)
        parts.append(Entries(row + where, each, np.log2(at[where]), value[where], slope[where]))

    for first, block in blocks:
        channels = block.dataset.data["channel"].values.astype(str)
        moved, count = block.moved, block.rows.channel.size
        # From line to line, in octaves.
        step = 1.0 / (block.dataset.record.segment_s * block.frequency * np.log(2.0))
        nothing = np.zeros(channels.size, dtype=np.complex128)
        for index, channel in enumerate(channels):
            for part in (1.0 + 0.0j, 1.0j):
                one = nothing.copy()
                one[index] = part
                row = start
                both = (moved.answers(one, nothing), moved.answers(nothing, one))
                for (what, _, _, at, sigma), by_value, by_rate in zip(moved.parts, *both, strict=True):
                    for take in (np.real, np.imag)[: 2 if what == "transfer" else 1]:
                        slope = take(by_rate) * step[at] / sigma
                        add((channel, part), block.frequency[at], row, take(by_value) / sigma, slope)
                        row += at.size
        row = start
        for what, child, _, at, sigma in moved.parts:
            if what == "rest":
                add((channels[child], "unshared"), block.frequency[at], row, 1.0 / sigma, np.zeros(at.size))
            row += at.size * (2 if what == "transfer" else 1)
        rows.append(first + np.arange(count))
        start += count
    kinds = tuple("unshared" if part == "unshared" else "channel" for _, part in names)
    return Chains(np.concatenate(rows), None, kinds, joined(parts))


def joined(parts: list[Entries]) -> Entries:
    """All of several lists."""
    fields = ("row", "process", "x", "value", "slope")
    return Entries(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))


CHAINS: dict[str, Callable[[list[tuple[int, Any]]], Chains]] = {
    "responses": of_products,
    "spectra": of_spectra,
    "passages": of_products,
}
"""By what :class:`permway.diagnosis.blocks.Block` names as its `chained`."""


def chains_of(blocks: tuple[Block, ...]) -> list[Chains]:
    """All chains of a campaign's blocks."""
    starts = np.cumsum([0, *(block.rows.channel.size for block in blocks)])
    placed = list(zip(starts[:-1].tolist(), blocks, strict=True))
    each = [(make, [one for one in placed if one[1].chained == what]) for what, make in CHAINS.items()]
    return [make(mine) for make, mine in each if mine]
