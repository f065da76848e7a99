"""What is found wrong with a record, and where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Finding:
    """One thing found.

    Attributes
    ----------
    kind : str
        "not finite", "dead", "clipping", "dropout", "spike", "offset", "drift", "quantisation", "identical",
        "sampling" or "mains".
    severity : "error", "warning" or "note"
        An error spoils whatever is estimated; a warning may; a note is to be known.
    channel : str
        Name, or "" for the record as a whole.
    what : str
        In words, with numbers.
    first, last : int or None
        Samples, both included; None if it holds all along.
    time_s : float or None
        Of the first, if the rate is known.
    value : float or None
        What was met there: the level clipped at, the height of a spike, a frequency in Hz.
    """

    kind: str
    severity: Severity
    channel: str
    what: str
    first: int | None = None
    last: int | None = None
    time_s: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class Screening:
    """All findings of a record; as text, a table."""

    source: str
    findings: tuple[Finding, ...]

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def of(self, *severities: Severity) -> tuple[Finding, ...]:
        """Findings of these severities."""
        return tuple(finding for finding in self.findings if finding.severity in severities)

    def __str__(self) -> str:
        if not self.findings:
            return f"{self.source or 'record'}: nothing found"
        rows = [("severity", "channel", "kind", "samples", "time, s", "what")]
        for finding in self.findings:
            span = "all" if finding.first is None else str(finding.first)
            if finding.last is not None and finding.last != finding.first:
                span += f" to {finding.last}"
            time = "" if finding.time_s is None else f"{finding.time_s:.4f}"
            rows.append((finding.severity, finding.channel or "(record)", finding.kind, span, time, finding.what))
        widths = [max(len(row[i]) for row in rows) for i in range(5)]
        return "\n".join("  ".join([*(row[i].ljust(widths[i]) for i in range(5)), row[5]]) for row in rows)
