"""Residuals of starts about one fit, batch by batch: of joints by low rank, of all else by a prediction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.joint_changes import Changed, JointChanges
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError
from permway.posterior.cells import Cell
from permway.posterior.fit import Fit, grown

BATCH = 128
"""Cells whose residuals are held at once: 20 MB of a large campaign's. Of twice as many against half as many, a
demo takes 2 s less of 46, and a large campaign 0.15 GB more of 1.3."""

LINEAR = 1.0
"""Standard deviations of its tolerance, by which a nominal parameter moves in a straight line in a look at small
changes: of those 0.15, of large ones 5."""


class Changes:
    """What starts do to the residuals of a fit.

    Parameters
    ----------
    fit : Fit
    small : bool
        Whether they are small changes.
    """

    def __init__(self, fit: Fit, *, small: bool) -> None:
        self.fit, self.names = fit, [free.name for free in fit.model.free]
        self.base = fit.model.build(fit.values())
        self.observations, self.solved = fit.frame.observations, fit.state.solved
        self.joints = JointChanges(self.observations, self.base, self.solved, small=small)

    def batches(self, cells: Sequence[Cell]) -> Iterator[list[Reals | None]]:
        """Residuals of each cell, None where it cannot be solved; so many cells at once."""
        threads = self.observations.threads
        for start in range(0, len(cells), BATCH):
            some = cells[start : start + BATCH]
            changed = each(self._changed, some, threads=threads, least=4 * SMALL)
            try:
                self.joints.solve([one for one in changed if one is not None])
            except (InputError, SolveError):
                # Each by itself may be solved yet.
                changed = [None] * len(some)
            yield each(self._residuals, list(zip(some, changed, strict=True)), threads=threads, least=SMALL)

    def _amended(self, cell: Cell) -> Campaign:
        if not cell.hypothesis.moves:
            return cell.hypothesis.amend(self.base, cell.values)
        own = {f"+{name}": value for name, value in cell.values.items()}
        return grown(self.fit, cell.hypothesis, "+").build({**self.fit.values(), **own})

    def _changed(self, cell: Cell) -> Changed | None:
        """Its joints, if these are all that it changes."""
        if cell.hypothesis.domain != "path" or cell.hypothesis.moves:
            return None
        try:
            return self.joints.of(self._amended(cell))
        except InputError:
            return None

    def _residuals(self, pair: tuple[Cell, Changed | None]) -> Reals | None:
        cell, changed = pair
        moves = cell.hypothesis.moves
        if moves in self.names:
            shift = cell.hypothesis.free[0].value(float(cell.z[0]))
            if abs(shift) < LINEAR:
                # The parameter itself moves back along: what is left by a bent path would be all that shows.
                slope = self.fit.jacobian[:, self.names.index(moves)]
                return np.asarray(self.fit.state.residuals + shift * slope)
        try:
            if changed is not None:
                found = self.joints.residuals(changed, lambda: self._amended(cell))
            else:
                predicted = self.observations.predicted(self._amended(cell), self.solved)
                found = self.observations.residuals(predicted.datasets)
        except (InputError, SolveError, np.linalg.LinAlgError):
            return None
        return found if np.isfinite(found).all() else None
