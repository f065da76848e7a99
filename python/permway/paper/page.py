"""The report on the paper as one page of HTML that needs nothing from outside."""

from __future__ import annotations

import re
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from plotly.offline import get_plotlyjs

from permway import _core
from permway.laws import FVMP, TFDV, WLF, AnyLaw
from permway.paper import figures
from permway.paper.captions import CAPTIONS
from permway.paper.conventions import CONTACT_N_PER_M, CONVENTIONS, PAPER, PAPER_FREE_GIRDER
from permway.paper.figures.style import celsius
from permway.paper.identify import SEED
from permway.paper.misprints import TO_HERTZ, misprints
from permway.paper.printed import TEMPERATURES_C
from permway.paper.report_tables import count, number, table
from permway.paper.reproduce import Reproduction

_SHOWN_C = {20: 55.0, -20: 75.0, -30: 85.0}
"""Where the force peaks at each temperature, Hz: the law is shown there."""
_TABLES_AFTER = {13: ["Figures 11-13"], 16: ["Table 5"], 17: ["Table 6"], 18: ["Table 7", "Table 8"]}


def render(result: Reproduction) -> str:
    """Render the whole page.

    Parameters
    ----------
    result : Reproduction

    Returns
    -------
    str
        HTML.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader("permway.paper"), PackageLoader("permway.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    environment.filters["celsius"] = celsius
    environment.filters["minus"] = _minus
    environment.filters["subscript"] = _subscript
    return environment.get_template("paper.html.j2").render(
        plotly=get_plotlyjs(),
        version=_core.__version__,
        seed=SEED,
        factor=TO_HERTZ,
        contact=CONTACT_N_PER_M,
        conventions=list(CONVENTIONS.values()),
        temperatures=TEMPERATURES_C,
        held=count(result.rows, "holds"),
        missed=count(result.rows, "missed"),
        open=count(result.rows, "open"),
        missed_rows=[r for r in result.rows if r.status == "missed"],
        statements_held=sum(s.holds for s in result.statements),
        statements=len(result.statements),
        pads=_pads(result),
        fits=_fits(result),
        parameters=[_parameters(result.law(c.name)) for c in (PAPER, PAPER_FREE_GIRDER)],
        figures=[_figure(result, number) for number in CAPTIONS],
        bounds=result.bounds,
        trials=result.trials,
        choices=result.choices,
        misprints=misprints(result),
    )


def _minus(text: str) -> str:
    """True minus signs and degrees."""
    return re.sub(r"(?<!\w)-(?=[\d ])", "−", text).replace("degC", "°C").replace("rho", "ρ")


def _subscript(text: str) -> Markup:
    """Subscripts and powers for w_s, x^n and their like."""
    lowered = re.sub(r"(?<!\w)([A-Za-zρ])_([A-Za-z])(?!\w)", r"\1<sub>\2</sub>", str(escape(text)))
    return Markup(re.sub(r"\^\(?(−?\w)\)?", r"<sup>\1</sup>", lowered))


def _figure(result: Reproduction, number: int) -> dict[str, Any]:
    law, runs = result.law(PAPER.name), result.runs
    drawn: dict[str, Any] = {
        "7": lambda: figures.figure_7(law),
        "8": lambda: figures.figure_8(law),
        "9a": lambda: figures.figure_9_storage(law),
        "9b": lambda: figures.figure_9_loss_factor(law),
        "10": lambda: figures.figure_10(),
        **{str(n): lambda n=n: getattr(figures, f"figure_{n}")(runs) for n in range(11, 19)},
    }
    caption, note = CAPTIONS[number]
    return {
        "number": number,
        "caption": caption,
        "note": note,
        "plots": [
            # A closing tag inside a script would end it.
            (name, draw().to_json().replace("</", "<\\/"))
            for name, draw in drawn.items()
            if re.sub(r"\D", "", name) == str(number)
        ],
        "statements": [
            s for s in result.statements if re.match(rf"Figure {number}\b|Figure {number}[ab]", s.figure)
        ],
        "tables": [(name, table(result, name)) for name in _TABLES_AFTER.get(number, [])],
    }


def _pads(result: Reproduction) -> list[dict[str, Any]]:
    """Stiffness and loss factor at each temperature: free, and by the law at the printed peak's frequency."""
    rows = []
    for t in TEMPERATURES_C:
        cells = []
        for convention in (PAPER, PAPER_FREE_GIRDER):
            free = result.free[convention.name][t]
            law = result.law(convention.name).complex(_SHOWN_C[t], float(t))[()]
            cells.append((free.stiffness / 1e6, free.eta, law.real / 1e6, law.imag / law.real))
        rows.append({"temperature": t, "at_Hz": _SHOWN_C[t], "cells": cells})
    return rows


def _fits(result: Reproduction) -> list[dict[str, Any]]:
    rows = []
    for convention in (PAPER, PAPER_FREE_GIRDER):
        for place, fit in enumerate(result.fits[convention.name]):
            checks = [fit.law.check((1.0, 1000.0), float(t)) for t in TEMPERATURES_C]
            rows.append(
                {
                    "convention": convention.name,
                    "family": fit.family,
                    "parameters": fit.parameters.size,
                    "cost": fit.cost,
                    "sound": all(c.passive and c.causal for c in checks),
                    "used": place == 0,
                }
            )
    return rows


def _parameters(law: AnyLaw) -> list[tuple[str, str, str]]:
    """Symbol, value and unit of the paper's form of law, for one fastener of the half model."""
    assert isinstance(law, TFDV)
    form, shift = law.law, law.shift
    assert isinstance(form, FVMP)
    assert isinstance(shift, WLF)
    return [
        ("μ<sub>1</sub>", number(form.mu1), "N/m"),
        ("η<sub>1</sub>", number(form.eta1), "N s<sup>γ</sup>/m"),
        ("μ<sub>2</sub>", number(form.mu2), "N s<sup>β−α</sup>/m"),
        ("η<sub>2</sub>", number(form.eta2), "N s<sup>β</sup>/m"),
        ("α", number(form.alpha), ""),
        ("β", number(form.beta), ""),
        ("γ", number(form.gamma), ""),
        ("WLF C<sub>1</sub>", number(shift.c1), ""),
        ("WLF C<sub>2</sub>", number(shift.c2_K), "K"),
        ("T<sub>s</sub>", number(law.reference_temperature_C), "°C"),
    ]
