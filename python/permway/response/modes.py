"""Natural frequencies, damping ratios and mode shapes of a line, as some places see them."""

from __future__ import annotations

from collections.abc import Sequence

from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.response.poles import Poles, lines_for, poles_of
from permway.response.receptance import Formulation, between


def modes(
    line: Line,
    low_Hz: float,
    high_Hz: float,
    *,
    places: Sequence[Place],
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> Poles:
    """Modes of a line between two frequencies that move at least one of some places.

    They are poles of the response, not peaks: modes that overlap, or that damping hides, stay apart. Of two modes
    at one frequency the response has one pole.

    Parameters
    ----------
    line : Line
    low_Hz, high_Hz : float
    places : sequence of Place
        A mode that moves none of them by a hundredth of what the liveliest does is not seen.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    formulation, threads
        As in :func:`permway.response.receptance.receptance`.

    Raises
    ------
    InputError
        For a band or places that do not fit.
    SolveError
        If the line cannot be solved, or its response is not one of modes.
    """
    if not 0.0 < low_Hz < high_Hz:
        raise InputError("must run from low to high, above 0 Hz", where="low_Hz, high_Hz", value=(low_Hz, high_Hz))
    if not places:
        raise InputError("no place to see a mode at", where="places", remedy="give one at least")
    frequency = lines_for(low_Hz, high_Hz)
    solved = between(
        line,
        frequency,
        forces=places,
        sensors=places,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
    )
    return poles_of(frequency, solved.receptance)
