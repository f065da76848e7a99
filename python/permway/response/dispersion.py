"""Free waves along a track on continuous beds: dispersion, and the critical speed of a moving load.

The joints of each layer are shared out over the length, rows of masses too. A wave exp(i (kappa x - omega t))
of all bodies is then an eigenvector of a small matrix; loss is left out. Where the phase speed of a branch is
lowest, waves carry their energy as fast as they run, and a constant load at that speed excites them without
bound: the critical speed, for an Euler beam on a bed (4 s E I / m^2)^(1/4) (Fryba, Vibration of Solids and
Structures under Moving Loads, 3rd ed., 1999, chapter 13).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.line import Line
from permway.response.continuous import Bed, continuous
from permway.response.receptance import check_line

_POINTS = 400
"""Wavenumbers at equal ratios. Half still shows every bend; the critical speed is refined between them."""
_LOWEST_RAD_PER_M = 1e-2
"""Waves of 630 m. Half and twice change nothing for tracks, whose critical waves have 2 to 40 m."""
_SAME = 1e-8
_SETTLED = 1e-3
"""Relative change of a frequency in the last round that is an answer. Rounding in stiff layers leaves 1e-6."""
_MOST_ROUNDS = 60


@dataclass(frozen=True)
class Dispersion:
    """Waves of a track.

    Attributes
    ----------
    bed : Bed
        The continuous track.
    wavenumber_rad_per_m : ndarray, shape (K,)
        Rising, up to waves of two spacings of the densest layer.
    frequency_Hz : ndarray, shape (K, branches)
        Rising from branch to branch.
    critical_speed_m_per_s : float or None
        The least of the local minima of phase speed over all branches; None if there is none.
    critical_wavenumber_rad_per_m : float or None
        Where.
    notes : tuple of str
    """

    bed: Bed
    wavenumber_rad_per_m: Reals
    frequency_Hz: Reals
    critical_speed_m_per_s: float | None
    critical_wavenumber_rad_per_m: float | None
    notes: tuple[str, ...]

    @property
    def phase_speed_m_per_s(self) -> Reals:
        """Shape (K, branches)."""
        return np.asarray(2.0 * np.pi * self.frequency_Hz / self.wavenumber_rad_per_m[:, None])

    def to_dataset(self) -> xr.Dataset:
        """`frequency` in Hz and `phase_speed` in m/s over `wavenumber` in rad/m and `branch`."""
        over = ("wavenumber", "branch")
        critical = {
            "critical_speed_m_per_s": self.critical_speed_m_per_s,
            "critical_wavenumber_rad_per_m": self.critical_wavenumber_rad_per_m,
        }
        return xr.Dataset(
            {
                "frequency": (over, self.frequency_Hz, {"long_name": "frequency", "units": "Hz"}),
                "phase_speed": (over, self.phase_speed_m_per_s, {"long_name": "phase speed", "units": "m/s"}),
            },
            coords={
                "wavenumber": (
                    "wavenumber",
                    self.wavenumber_rad_per_m,
                    {"long_name": "wavenumber", "units": "rad/m"},
                ),
                "branch": np.arange(1, self.frequency_Hz.shape[1] + 1),
            },
            attrs={
                "bodies": list(self.bed.bodies),
                "notes": "; ".join(self.notes),
                **{name: value for name, value in critical.items() if value is not None},
            },
        )


def dispersion(
    line: Line,
    *,
    body: str | None = None,
    from_m: float | None = None,
    to_m: float | None = None,
    held: Sequence[str] = (),
    temperature_C: float | None = None,
) -> Dispersion:
    """Dispersion curves of the track along a line.

    Parameters
    ----------
    line : Line
    body : str, optional
        The beam that the load moves on; by default the first beam without ends, or else the first beam.
    from_m, to_m : float, optional
        Stretch over which joints and masses are shared out; by default that of the layer below the body.
    held : sequence of str
        Bodies taken as rigid and at rest.
    temperature_C : float, optional
        Needed if a law of the line depends on it.

    Returns
    -------
    Dispersion

    Raises
    ------
    InputError
        For a body that is no beam, a stretch without joints, or laws that need a temperature.
    """
    check_line(line)
    held = (held,) if isinstance(held, str) else tuple(held)
    bed = continuous(line, body=body, from_m=from_m, to_m=to_m, held=held)
    waves = _Waves(line, bed, temperature_C)
    wavenumber = np.geomspace(_LOWEST_RAD_PER_M, math.pi / bed.spacing_m, _POINTS)
    branches = len(bed.bodies)
    omega = np.array([waves.omega(kappa, branches) for kappa in wavenumber])
    notes = list(bed.notes)
    lowest = _minima(waves, wavenumber, omega / wavenumber[:, None])
    critical, where = min(lowest, default=(None, None))
    if critical is None:
        notes.append("no critical speed: no wave has a lowest phase speed within the band")
    elif (omega[-1, 0] / wavenumber[-1]) < critical:
        notes.append(
            f"waves near two spacings ({2.0 * math.pi / wavenumber[-1]:.3g} m) are slower still, for masses below "
            "the rail hardly move one another; a load excites them little, and discrete supports change them"
        )
    return Dispersion(bed, wavenumber, omega / (2.0 * np.pi), critical, where, tuple(notes))


def _minima(waves: _Waves, wavenumber: Reals, speed: Reals) -> list[tuple[float, float]]:
    """Lowest phase speeds of the branches, with their wavenumbers; there energy runs as fast as the wave."""
    found = []
    for branch in range(speed.shape[1]):
        c = speed[:, branch]
        for at in np.flatnonzero((c[1:-1] < c[:-2]) & (c[1:-1] <= c[2:])) + 1:
            best = minimize_scalar(
                lambda u, branch=branch: float(waves.omega(math.exp(u), branch + 1)[branch] / math.exp(u)),
                bounds=(math.log(wavenumber[at - 1]), math.log(wavenumber[at + 1])),
                method="bounded",
                options={"xatol": 1e-9},
            )
            found.append((float(best.fun), float(math.exp(best.x))))
    return found


class _Waves:
    """Circular frequencies of the waves of one wavenumber."""

    def __init__(self, line: Line, bed: Bed, temperature_C: float | None) -> None:
        self.line, self.bed, self.temperature = line, bed, temperature_C
        low, high = (self._laws(2.0 * np.pi * f) for f in (1.0, 1000.0))
        self.constant = bool(np.allclose(low, high, rtol=1e-12))
        self.first = low

    def _laws(self, omega: float) -> Reals:
        frequency = np.array([max(omega / (2.0 * np.pi), 1e-3)])
        return np.asarray(self.line.stiffness(frequency, self.temperature)[0].real)

    def omega(self, kappa: float, branches: int) -> Reals:
        """The lowest circular frequencies, rad/s, shape (branches,)."""
        found = self._solve(kappa, self.first)[:branches]
        if self.constant:
            return found
        # A law that depends on frequency is taken at the wave's own, branch by branch.
        for branch in range(branches):
            displaced = np.inf
            for _ in range(_MOST_ROUNDS):
                once = found[branch]
                found[branch] = self._solve(kappa, self._laws(float(once)))[branch]
                displaced = abs(found[branch] - once)
                if displaced <= _SAME * found[branch]:
                    break
            if not displaced <= _SETTLED * found[branch]:
                raise InputError(
                    f"the law's stiffness jumps, so that no wave of {2.0 * np.pi / kappa:.3g} m settles",
                    where="line.laws",
                    remedy="take laws that change smoothly with frequency",
                )
        return found

    def _solve(self, kappa: float, laws: Reals) -> Reals:
        stiffness, mass = self.bed.matrices(kappa, laws)
        values = eigh(stiffness, mass, eigvals_only=True)
        return np.sqrt(np.maximum(values, 0.0))
