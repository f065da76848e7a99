"""The whole reproduction: pads identified, runs made, tables and statements judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import xarray as xr

from permway import _core
from permway.laws import AnyLaw, Hysteretic, StorageLossPair, law_from_dict
from permway.laws.checks import LawCheck
from permway.paper.choices import Choice, choices
from permway.paper.conventions import CONVENTIONS, PAPER, PAPER_FREE_GIRDER, RIGHT
from permway.paper.identify import BAND_HZ, FAMILIES, PAPERS_FAMILY, SEED, TWO_SPRINGPOTS, Fit, free_pad, one_law
from permway.paper.pad_layer import PadLayer
from permway.paper.printed import TABLE_1, TEMPERATURES_C
from permway.paper.statements import Judge, Statement
from permway.paper.table8 import Bound, Trial, bounds, trials
from permway.paper.tables import FREE, ONE_LAW, Row, rows
from permway.response.receptance import Progress


@dataclass(frozen=True)
class Reproduction:
    """Everything the report shows.

    Attributes
    ----------
    free : dict of convention to dict of temperature to Hysteretic
        Pads identified freely at each temperature.
    fits : dict of convention to list of Fit
        Laws for all three temperatures, the paper's own form first, then by cost.
    runs : dict of (convention, pad) to dict of temperature to Dataset
    rows : list of Row
    statements : list of Statement
        On the paper's convention with one law.
    bounds, trials
        Table 8.
    choices : list of Choice
    table_1 : LawCheck
        Of the printed pair of FVMP parameters.
    """

    free: Mapping[str, Mapping[int, Hysteretic]]
    fits: Mapping[str, list[Fit]]
    runs: Mapping[tuple[str, str], Mapping[int, xr.Dataset]]
    rows: list[Row]
    statements: list[Statement]
    bounds: list[Bound]
    trials: list[Trial]
    choices: list[Choice]
    table_1: LawCheck

    def law(self, convention: str) -> AnyLaw:
        """The paper's form of law under a convention."""
        return self.fits[convention][0].law

    def tables(self) -> dict[str, Any]:
        """What `tables.json` holds."""
        return {
            "format": 1,
            "paper": "Insights into Underrail Rubber Pad's Effect on Vehicle-Track-Viaduct System Dynamics, "
            "Shock and Vibration, 2021",
            "permway_version": _core.__version__,
            "seed": SEED,
            "conventions": {c.name: c.description for c in CONVENTIONS.values()},
            "rows": [r.as_dict() for r in self.rows],
            "pads": {
                name: {str(t): {"stiffness_N_per_m": p.stiffness, "loss_factor": p.eta} for t, p in pads.items()}
                for name, pads in self.free.items()
            },
            "laws": {
                name: [
                    {
                        "family": f.family,
                        "parameters": f.parameters.size,
                        "cost": f.cost,
                        "law": f.law.model_dump(mode="json", by_alias=True),
                    }
                    for f in fits
                ]
                for name, fits in self.fits.items()
            },
            "statements": [s.as_dict() for s in self.statements],
            "table_8": {
                "status": "open",
                "bounds": [b.as_dict() for b in self.bounds],
                "trials": [t.as_dict() for t in self.trials],
            },
            "choices": [c.as_dict() for c in self.choices],
        }


def table_1_pair() -> StorageLossPair:
    """Table 1 as a law: storage from one column, loss from the other, MPa."""
    law = law_from_dict(
        {
            "type": "storage_loss_pair",
            "storage_law": {"type": "fvmp", **TABLE_1["storage"]},
            "loss_law": {"type": "fvmp", **TABLE_1["loss"]},
        }
    )
    assert isinstance(law, StorageLossPair)
    return law


def reproduce(*, threads: int | None = None, progress: Progress | None = None) -> Reproduction:
    """Identify the pads, run all conventions, judge tables and statements.

    Parameters
    ----------
    threads : int, optional
    progress : callable, optional
        Called with (done, total).
    """
    steps = 2 + len(FAMILIES) + 2 + 15 + 2
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, steps)

    free: dict[str, dict[int, Hysteretic]] = {}
    fits: dict[str, list[Fit]] = {}
    for convention in (PAPER, PAPER_FREE_GIRDER):
        layer = PadLayer.of(convention, BAND_HZ)
        free[convention.name] = {t: free_pad(layer, t) for t in TEMPERATURES_C}
        step()
        found: list[Fit] = []
        for family in FAMILIES:
            # Other forms of law are compared once, under the paper's own convention.
            if convention is PAPER or family.name in (TWO_SPRINGPOTS, PAPERS_FAMILY):
                simpler = next((f for f in found if f.family == TWO_SPRINGPOTS), None)
                found.append(one_law(layer, family, free[convention.name], simpler=simpler))
                step()
        fits[convention.name] = sorted(found, key=lambda fit: (fit.family != PAPERS_FAMILY, fit.cost))
    # The right convention differs in irregularity only, and has the free girder's pad.
    free[RIGHT.name], fits[RIGHT.name] = free[PAPER_FREE_GIRDER.name], fits[PAPER_FREE_GIRDER.name]

    runs: dict[tuple[str, str], dict[int, xr.Dataset]] = {}
    table: list[Row] = []
    for convention in CONVENTIONS.values():
        for pad in (FREE, ONE_LAW):
            if convention is RIGHT and pad == FREE:
                continue
            runs[convention.name, pad] = {}
            for t in TEMPERATURES_C:
                law = free[convention.name][t] if pad == FREE else fits[convention.name][0].law
                runs[convention.name, pad][t] = convention.run(law, t, threads=threads)
                step()
            table += rows(
                runs[convention.name, pad], convention=convention.name, pad=pad, judged=convention is not RIGHT
            )
    statements = Judge(runs[PAPER.name, ONE_LAW], fits[PAPER.name][0].law).all()
    step()
    result = Reproduction(
        free=free,
        fits=fits,
        runs=runs,
        rows=table,
        statements=statements,
        bounds=bounds(PAPER),
        trials=trials(PAPER, runs[PAPER.name, FREE]),
        choices=choices(PAPER, fits[PAPER.name][0].law),
        table_1=table_1_pair().check((1.0, 1000.0)),
    )
    step()
    return result
