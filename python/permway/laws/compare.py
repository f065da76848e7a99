"""Candidate laws side by side on one table, at equal numbers of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from permway.laws.dma import DmaTable
from permway.laws.identify import Identification, identify
from permway.laws.search import Progress

CANDIDATES = (
    "springpot_parallel",
    "zener",
    "fractional_zener",
    "maxwell:2",
    "havriliak_negami",
    "prony:2",
    "fvmp",
    "prony:3",
)
"""In pairs of one fractional and one integer law with 3, 4, 5 and 7 parameters each."""


@dataclass(frozen=True)
class Comparison:
    """Identifications of one table, best BIC first.

    Attributes
    ----------
    rows : tuple of Identification
        One per candidate.
    """

    rows: tuple[Identification, ...]

    @property
    def best(self) -> Identification:
        """The law with the lowest BIC."""
        return self.rows[0]

    def row(self, law: str) -> Identification:
        """The identification of one candidate, by the name of its family; KeyError if it was not one."""
        for entry in self.rows:
            if entry.family == law:
                return entry
        raise KeyError(law)

    def table(self) -> list[dict[str, str | int | float]]:
        """Rows for people and files: law, shift, numbers of parameters, errors, and BIC above the best."""
        return [
            {
                "law": entry.family,
                "shift": entry.shift,
                "parameters": entry.n_parameters,
                "rms_log10_modulus": entry.rms_log10_modulus,
                "rms_loss_factor": entry.rms_loss_factor,
                "aic": entry.aic,
                "bic": entry.bic,
                "bic_above_best": entry.bic - self.best.bic,
            }
            for entry in self.rows
        ]


def compare_laws(
    table: DmaTable,
    *,
    laws: Sequence[str] = CANDIDATES,
    shifts: Sequence[str] = ("wlf",),
    reference_temperature_C: float | None = None,
    vertical: str = "none",
    seed: int = 0,
    progress: Progress | None = None,
) -> Comparison:
    """Identify every candidate from one table and sort by BIC.

    Parameters
    ----------
    table : DmaTable
        Measured.
    laws : sequence of str
        Families, see :func:`permway.laws.families.family`.
    shifts : sequence of str
        Each law is tried with each shift; ("none",) for a table of one temperature.
    reference_temperature_C, vertical, seed
        As for :func:`permway.laws.identify.identify`.
    progress : callable, optional
        Called with the steps done and the steps in all.

    Returns
    -------
    Comparison
        Best BIC first. A difference above 10 is strong, provided the residuals are independent.
    """
    cases = [(law, shift) for shift in shifts for law in laws]
    rows = []
    for index, (law, shift) in enumerate(cases):

        def within(done: int, total: int, index: int = index) -> None:
            if progress is not None:
                progress(index * total + done, len(cases) * total)

        rows.append(
            identify(
                table,
                law=law,
                shift=shift,
                reference_temperature_C=reference_temperature_C,
                vertical=vertical,
                seed=seed,
                progress=within,
            )
        )
    return Comparison(tuple(sorted(rows, key=lambda entry: entry.bic)))
