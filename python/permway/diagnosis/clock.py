"""Times the stages of a diagnosis and says where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter

Progress = Callable[[str, int, int], object]
"""Told a stage, how much of it is done, and of how much."""


@dataclass
class Clock:
    """Times the stages and says where it is."""

    progress: Progress | None
    _times: dict[str, float] = field(default_factory=dict)
    _stage: str = ""
    _since: float = 0.0

    def __call__(self, stage: str, done: int = 0, total: int = 0) -> None:
        """A stage begins, or is so far."""
        now = perf_counter()
        if self._stage:
            self._times[self._stage] = self._times.get(self._stage, 0.0) + now - self._since
        self._stage, self._since = stage, now
        if self.progress is not None:
            self.progress(stage, done, total)

    def seconds(self) -> dict[str, float]:
        """By stage."""
        self(self._stage)
        return dict(self._times)
