"""All chains of a campaign: of hammer tests, of runs, and of passages, where errors multiply a prediction."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.blocks_passage import PassageBlock
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.posterior.chains import Chains, Entries, joined, of_responses, of_spectra


def of_passages(blocks: list[tuple[int, PassageBlock]]) -> Chains:
    """Errors of the channels of all passages together: one channel has the same in each.

    Parameters
    ----------
    blocks : list of (int, PassageBlock)
        Each with its first row.
    """
    names: dict[str, int] = {}
    rows, turns, parts, sizes, start = [], [], [], [], 0
    for first, block in blocks:
        shape, count = block.measured.shape, block.measured.size
        which = np.array([names.setdefault(name, len(names)) for name in block.names.tolist()])
        process = np.repeat(which, shape[1])
        x = np.broadcast_to(np.log2(block.frequency), shape).reshape(-1)
        relative = block.relative.reshape(-1)
        parts.append(Entries(start + np.arange(count), process, x, relative, np.zeros(count)))
        rows.append(first + np.stack([np.arange(count), count + np.arange(count)], axis=1))
        turns.append(block.phase.conj().reshape(-1))
        sizes.append(relative)
        start += count
    kinds = ("channel",) * len(names)
    return Chains(np.concatenate(rows), np.concatenate(turns), kinds, joined(parts), np.concatenate(sizes))


def chains_of(blocks: tuple[Block, ...]) -> list[Chains]:
    """All chains of a campaign's blocks."""
    starts = np.cumsum([0, *(block.rows.channel.size for block in blocks)])
    placed = list(zip(starts[:-1].tolist(), blocks, strict=True))
    responses = [(first, block) for first, block in placed if isinstance(block, FrfBlock)]
    spectra = [(first, block) for first, block in placed if isinstance(block, SpectraBlock)]
    passages = [(first, block) for first, block in placed if isinstance(block, PassageBlock)]
    found = []
    if responses:
        found.append(of_responses(responses))
    if spectra:
        found.append(of_spectra(spectra))
    if passages:
        found.append(of_passages(passages))
    return found
