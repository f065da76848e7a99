"""Numbers of a verdict: as words have them, and those that it is summed up by."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.verdict import Effect, Estimate, HeldOutGain, Moved, Verdict

MOST_DIGITS = 7
"""Of an interval's ends."""


def quantity(value: float, unit: str = "", digits: int = 3) -> str:
    """Three significant digits, or a whole number below 100 000, and the unit; a ratio has none."""
    plain = f"{value:.0f}" if 1000.0 <= abs(value) < 1e5 and digits == 3 else f"{value:.{digits}g}"
    text = plain.replace("e+0", "e").replace("e+", "e").replace("e-0", "e-").replace("-", "−")
    return text if unit in ("", "1") else f"{text} {unit}"


def span(low: float, high: float) -> str:
    """From and to, with so many digits that the two differ, if seven do."""
    ends = quantity(low), quantity(high)
    for digits in range(4, MOST_DIGITS + 1):
        if ends[0] != ends[1]:
            break
        ends = quantity(low, digits=digits), quantity(high, digits=digits)
    return f"{ends[0]} to {ends[1]}"


def interval(one: Estimate | Moved) -> str:
    """The 90 % interval, or ""."""
    return "" if one.low is None or one.high is None else span(one.low, one.high)


def probability(effect: Effect) -> float | None:
    """Of the effect's name, or of the first of its class."""
    chosen = [m.probability for m in effect.class_ if m.name == effect.name] or [
        m.probability for m in effect.class_
    ]
    return chosen[0] if chosen else None


def strongest(verdict: Verdict) -> tuple[str, HeldOutGain] | None:
    """The axis of held-out records that gains most, of those whose decibels are known."""
    known = {axis: g for axis, g in verdict.held_out.items() if None not in (g.db_before, g.db_after)}
    return max(known.items(), key=lambda item: item[1].gain_nats, default=None)


def held_dB(verdict: Verdict) -> tuple[float, float] | None:
    """Error of all held-out records, one group after the other, root mean square: before and after."""
    known = [(g.db_before, g.db_after) for g in verdict.held_out.values()]
    decibels = np.array([(b, a) for b, a in known if b is not None and a is not None]).reshape(-1, 2)
    if not decibels.size:
        return None
    before, after = np.sqrt(np.mean(decibels**2, axis=0)).tolist()
    return float(before), float(after)
