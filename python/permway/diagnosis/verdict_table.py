"""The verdict as a small table, for notebooks."""

from __future__ import annotations

from html import escape

from permway.diagnosis.plain_names import chance, ends, estimate, name_of, parameter_of
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_words import DOMAIN, STATUS


def html_table(verdict: Verdict) -> str:
    """The verdict as a small table: the sentence, then of each effect place, name and parameters."""
    rows = []
    for effect in verdict.effects:
        values = ", ".join(
            f"{parameter_of(name)} {estimate(one)}" + (f" ({ends(one)})" if ends(one) else "")
            for name, one in effect.parameters.items()
        )
        rivals = ", ".join(f"{name_of(m.name)} {chance(m.probability)}" for m in effect.class_)
        name = name_of(effect.name) if effect.name else ""
        cells = (DOMAIN[effect.domain], effect.place.label, name, rivals, values)
        rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
    heads = ("domain", "place", "name", "class", "parameters (90 %)")
    head = "<tr>" + "".join(f"<th>{one}</th>" for one in heads) + "</tr>"
    words = f"<b>{escape(STATUS[verdict.status])}.</b> {escape(verdict.sentence)}"
    body = f"<thead>{head}</thead><tbody>{''.join(rows)}</tbody>" if rows else ""
    return f'<table><caption style="text-align: left">{words}</caption>{body}</table>'
