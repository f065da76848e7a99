"""Residuals of starts about one fit: of joints by low rank, of all else by a prediction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.joint_changes import Changed, JointChanges
from permway.errors import InputError, SolveError
from permway.posterior.cells import Cell
from permway.posterior.fit import Fit, grown

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
        self.observations, self.solved, self.small = fit.frame.observations, fit.state.solved, small

    def residuals(self, cells: Sequence[Cell]) -> list[Reals | None]:
        """Of each cell, None where it cannot be solved; what joints need of the line is solved for together."""
        joints = JointChanges(self.observations, self.base, self.solved, small=self.small)
        changed = [self._changed(joints, cell) for cell in cells]
        try:
            joints.solve([one for one in changed if one is not None])
        except (InputError, SolveError):
            # Each by itself may be solved yet.
            changed = [None] * len(cells)
        return [self._residuals(joints, cell, one) for cell, one in zip(cells, changed, strict=True)]

    def _amended(self, cell: Cell) -> Campaign:
        if not cell.hypothesis.moves:
            return cell.hypothesis.amend(self.base, cell.values)
        own = {f"+{name}": value for name, value in cell.values.items()}
        return grown(self.fit, cell.hypothesis, "+").build({**self.fit.values(), **own})

    def _changed(self, joints: JointChanges, cell: Cell) -> Changed | None:
        """Its joints, if these are all that it changes."""
        if cell.hypothesis.domain != "path" or cell.hypothesis.moves:
            return None
        try:
            return joints.of(self._amended(cell))
        except InputError:
            return None

    def _residuals(self, joints: JointChanges, cell: Cell, changed: Changed | None) -> Reals | None:
        moves = cell.hypothesis.moves
        if moves in self.names:
            shift = cell.hypothesis.free[0].value(float(cell.z[0]))
            if abs(shift) < LINEAR:
                # The parameter itself moves back along: what is left by a bent path would be all that shows.
                slope = self.fit.jacobian[:, self.names.index(moves)]
                return np.asarray(self.fit.state.residuals + shift * slope)
        try:
            if changed is not None:
                found = joints.residuals(changed, lambda: self._amended(cell))
            else:
                predicted = self.observations.predicted(self._amended(cell), self.solved)
                found = self.observations.residuals(predicted.datasets)
        except (InputError, SolveError, np.linalg.LinAlgError):
            return None
        return found if np.isfinite(found).all() else None
