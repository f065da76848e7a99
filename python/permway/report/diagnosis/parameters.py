"""The nominal parameters as stated, recalibrated and amended, with units that fit and digits that are known."""

from __future__ import annotations

from typing import Any

from permway.diagnosis.compare_tables import LEFT
from permway.diagnosis.plain_names import ends, estimate, stated
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict_parts import Moved
from permway.report.compare.tables import signed

WENT_BACK = 0.5
"""Standard deviations of the prior by which a parameter must near its nominal value to have gone back."""


def stated_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Of each parameter: name, stated value and tolerance, then value, 90 % interval and z before and after.

    `left` says whether recalibration alone leaves the tolerance, `change` what the amendment did.
    """
    verdict, rows = diagnosis.verdict.recalibrated, []
    for known in diagnosis.comparison.campaign.parameters.known.values():
        unit = known.parameter.unit
        low, high = sorted((known.value(-2.0), known.value(2.0)))
        before, after = verdict.before.get(known.name), verdict.after.get(known.name)
        rows.append(
            {
                "name": known.name,
                "stated": stated(known.nominal, unit),
                "tolerance": ends(
                    Moved(value=known.nominal, prior=known.nominal, z=0.0, low=low, high=high, unit=unit)
                ),
                "before": _estimate(before),
                "after": _estimate(after),
                "left": before is not None and abs(before.z) > LEFT,
                "change": _went(before, after),
            }
        )
    return rows


def _estimate(one: Moved | None) -> tuple[str, str, str]:
    """Value, interval and z in words."""
    return ("", "", "") if one is None else (estimate(one), ends(one), signed(one.z, 2))


def _went(before: Moved | None, after: Moved | None) -> str:
    if before is None or after is None:
        return ""
    if abs(after.z) > LEFT:
        return "outside its tolerance"
    return "went back" if abs(after.z) < abs(before.z) - WENT_BACK else ""
