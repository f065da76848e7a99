"""What the paper says of its figures, and whether it holds in the reproduction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.laws import AnyLaw
from permway.paper.printed import (
    GLASS_TRANSITION_C,
    LOSS_FACTOR_PEAK,
    LOSS_MODULUS_PEAK_C,
    PRINTED,
    TEMPERATURES_C,
)
from permway.paper.readings import MINIMUM_BAND_HZ, Curves, extremum
from permway.response.decay import decay_rate

MOST = 0.95
"""Share of a band over which an ordering must hold for the statement to hold."""
SAME = 0.10
"""Relative difference under which curves "coincide" or show "no obvious difference"."""
RULES = 3.0
"""Ratio of moduli from which one flexibility "mainly" makes the total."""
DISTANCE_M = 17.5
"""Between contact points 1 and 3."""


@dataclass(frozen=True)
class Statement:
    """A sentence of the paper, in short, with the verdict and its evidence."""

    figure: str
    text: str
    holds: bool
    evidence: str

    def as_dict(self) -> dict[str, Any]:
        """The statement as plain data."""
        return {**asdict(self), "holds": bool(self.holds)}


class Judge:
    """Judges the statements on the runs of one convention and one law.

    Parameters
    ----------
    runs : dict of temperature to Dataset
    law : law
        Of the pad, over temperature and frequency.
    """

    def __init__(self, runs: Mapping[int, xr.Dataset], law: AnyLaw) -> None:
        self.law = law
        self.curves = {t: Curves.of(runs[t]) for t in TEMPERATURES_C}
        self.f = self.curves[20].frequency
        self.runs = runs

    def all(self) -> list[Statement]:
        """Every statement, in the order of the figures."""
        return [*self._pad(), *self._flexibility(), *self._decay(), *self._random()]

    def _pad(self) -> list[Statement]:
        temperature = np.arange(-60.0, 40.5, 0.5)
        two = np.array([self.law.complex(2.0, float(t))[()] for t in temperature])
        eta, loss = two.imag / two.real, two.imag
        hot, peak = temperature[np.argmax(eta)], float(eta.max())
        f = np.geomspace(1.0, 1000.0, 200)
        k = self.law.complex(f, 20.0)
        grid = np.array([self.law.complex(np.arange(1.0, 201.0), t) for t in np.arange(-30.0, 21.0, 1.0)])
        storage, factor = grid.real, grid.imag / grid.real
        rises = {
            name: bool((np.diff(values, axis=1) > 0).all() and (np.diff(values, axis=0) < 0).all())
            for name, values in (("storage", storage), ("loss factor", factor))
        }
        drop = float((1.0 - storage / np.maximum.accumulate(storage[::-1], axis=0)[::-1]).max())
        return [
            Statement(
                "Figure 7",
                f"the loss factor at 2 Hz peaks at {GLASS_TRANSITION_C} degC with {LOSS_FACTOR_PEAK}",
                abs(hot - GLASS_TRANSITION_C) <= 2.0 and abs(peak - LOSS_FACTOR_PEAK) <= 0.05,
                f"the law behind the tables peaks at {hot:.1f} degC with {peak:.2f} (within -60 to 40 degC); "
                f"the tables ask for {float(factor[0, 84]):.2f} at -30 degC and 85 Hz, above the highest measured",
            ),
            Statement(
                "Figure 7",
                f"the loss modulus at 2 Hz peaks at {LOSS_MODULUS_PEAK_C} degC",
                abs(temperature[np.argmax(loss)] - LOSS_MODULUS_PEAK_C) <= 2.0,
                f"it peaks at {temperature[np.argmax(loss)]:.1f} degC",
            ),
            Statement(
                "Figure 8",
                "storage modulus, loss modulus and loss factor grow with frequency at 20 degC",
                all((np.diff(v) > 0).all() for v in (k.real, k.imag, k.imag / k.real)),
                f"from 1 to 1000 Hz: storage x {k[-1].real / k[0].real:.2f}, loss x {k[-1].imag / k[0].imag:.1f}",
            ),
            Statement(
                "Figure 9",
                "storage and loss factor grow with falling temperature and rising frequency",
                all(rises.values()),
                "on 1 to 200 Hz, -30 to 20 degC: "
                + ", ".join(f"{n} {'monotonic' if r else 'not monotonic'}" for n, r in rises.items())
                + (
                    f"; where warm and slow, the factor rho T / (rho_s T_s) of (27) lowers the storage as it "
                    f"cools, by up to {100 * drop:.1f} % of it"
                    if drop > 0.0005
                    else ""
                ),
            ),
        ]

    def _flexibility(self) -> list[Statement]:
        found = []
        # Figure, temperature, where wheels rule below, where the track rules from, printed minimum.
        for figure, t, below, above, printed in (
            ("Figure 11", 20, 25, 120, 59),
            ("Figure 12", -20, 30, 150, 75),
            ("Figure 13", -30, 40, 170, 93),
        ):
            data = self.runs[t]
            wheel, track = (
                data[f"{part}_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values
                for part in ("wheel", "track")
            )
            share = np.abs(wheel) / np.abs(track)
            low, high = self.f <= below, self.f >= above
            at = extremum(self.f, self.curves[t].total, MINIMUM_BAND_HZ, lowest=True).at_Hz
            here = int(np.flatnonzero(self.f == at)[0])
            phase = abs(np.degrees(np.angle(wheel[here] / track[here])))
            found += [
                Statement(
                    figure,
                    f"at {t} degC the total flexibility has its minimum at {printed} Hz",
                    abs(at - printed) <= 3.0,
                    f"at {at:g} Hz",
                ),
                Statement(
                    figure,
                    f"below {below} Hz the wheels mainly make the total flexibility",
                    float(np.mean(share[low] > RULES)) >= MOST,
                    f"wheel over track at least {share[low].min():.1f} (by the ratio {RULES:g} up to "
                    f"{_reach(self.f, share > RULES):g} Hz)",
                ),
                Statement(
                    figure,
                    f"above {above} Hz the track and bridge mainly make it",
                    float(np.mean(1.0 / share[high] > RULES)) >= MOST,
                    f"track over wheel {1.0 / share[high].max():.1f} to {1.0 / share[high].min():.1f}",
                ),
                Statement(
                    figure,
                    "at the minimum, wheel and track are equal in amplitude and opposite in phase",
                    abs(share[here] - 1.0) <= SAME and phase >= 170.0,
                    f"amplitudes 1 : {1.0 / share[here]:.2f}, {phase:.0f} degrees apart: a loss factor keeps them "
                    "from opposing fully",
                ),
            ]
        wheel = np.abs(self.runs[20]["wheel_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values)
        rises = np.count_nonzero(np.diff(wheel) > 0)
        found.insert(
            0,
            Statement(
                "Figure 11",
                "the wheel's flexibility is largest at 1 Hz and falls all the way to 200 Hz",
                bool(np.argmax(wheel) == 0 and (np.diff(wheel) < 0).all()),
                f"largest at {self.f[np.argmax(wheel)]:g} Hz; rises in {rises} of 199 steps",
            ),
        )
        track = np.abs(self.runs[20]["track_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values)
        peak = extremum(self.f, track, (2.0, 15.0)).at_Hz
        found.insert(
            1, Statement("Figure 11", "the rail-bridge flexibility peaks at 5 Hz", peak == 5.0, f"at {peak:g} Hz")
        )
        totals = {t: c.total for t, c in self.curves.items()}
        minima = [extremum(self.f, totals[t], MINIMUM_BAND_HZ, lowest=True) for t in TEMPERATURES_C]
        found += [
            self._coincide("Figure 14", "total flexibilities coincide below 25 Hz", totals, 25.0),
            Statement(
                "Figure 14",
                "the colder, the higher the frequency of the minimum",
                minima[0].at_Hz < minima[1].at_Hz < minima[2].at_Hz,
                ", ".join(f"{m.at_Hz:g} Hz" for m in minima),
            ),
            Statement(
                "Figure 14 and conclusion 2",
                "the colder, the smaller the minimum of the total flexibility",
                minima[0].value > minima[1].value > minima[2].value,
                ", ".join(f"{m.value:.2e} m/N at {t} degC" for m, t in zip(minima, TEMPERATURES_C, strict=True))
                + "; Table 5 says the same: its forces and the irregularity ask for one "
                f"{self._minimum_by_table_5():.2f} times larger at -20 than at 20 degC: the loss factor fills it",
            ),
        ]
        return found

    def _minimum_by_table_5(self) -> float:
        """Ratio of the flexibilities |R| / |P| at the printed force peaks, -20 over 20 degC, one wheel alone."""
        flexibility = []
        for t in (20, -20):
            row = next(r for r in PRINTED if r.quantity == "force" and r.temperature_C == t)
            profile = float(self.runs[t]["irregularity_psd"].sel(frequency=row.at_Hz)) ** 0.5
            flexibility.append(profile / row.value)
        return float(flexibility[1] / flexibility[0])

    def _decay(self) -> list[Statement]:
        rates = {t: track_decay(self.runs[t]) for t in TEMPERATURES_C}
        return [
            self._ordered(
                "Figure 15",
                "up to 122 Hz the decay rate is smaller the colder it is",
                rates,
                (1, 122),
                rises=False,
            ),
            self._ordered(
                "Figure 15", "from 181 Hz the decay rate grows as it gets colder", rates, (181, 200), rises=True
            ),
        ]

    def _random(self) -> list[Statement]:
        force = {t: c.force for t, c in self.curves.items()}
        wheelset = {t: c.wheelset for t, c in self.curves.items()}
        rail = {t: c.rail for t, c in self.curves.items()}
        peaks = [extremum(self.f, force[t], (40.0, 130.0)).at_Hz for t in TEMPERATURES_C]
        rail_peaks = [extremum(self.f, rail[t], (40.0, 130.0)).at_Hz for t in TEMPERATURES_C]
        found = [
            self._coincide("Figure 16", "no difference of force below 25 Hz", force, 25.0),
            Statement(
                "Figure 16",
                "the peak of the force moves up as it gets colder",
                peaks[0] < peaks[1] < peaks[2],
                ", ".join(f"{p:g} Hz" for p in peaks),
            ),
            self._ordered(
                "Figure 16",
                "at high frequency (from 85 Hz) the force grows as it gets colder",
                force,
                (85, 200),
                rises=True,
            ),
        ]
        for degree, at, most in (
            ("body.bounce", 1.0, 0.0007),
            ("body.bounce", 5.0, 0.015),
            ("body.pitch", 1.0, 0.002),
            ("body.pitch", 7.0, 0.025),
        ):
            values = [
                float(self.runs[t]["vehicle_acceleration_psd"].sel(degree=f"car1.{degree}", frequency=at))
                for t in TEMPERATURES_C
            ]
            spread = max(values) / min(values) - 1.0
            named = degree.replace("body.", "car body ")
            found.append(
                Statement(
                    "Figure 17",
                    f"{named} at {at:g} Hz differs by {100 * most:g} % between the temperatures",
                    spread <= 1.25 * most,
                    f"by {100 * spread:.2f} %",
                )
            )
        return [
            *found,
            self._coincide("Figure 18a", "no difference of wheelset acceleration below 25 Hz", wheelset, 25.0),
            self._ordered("Figure 18a", "up to 61 Hz, the colder the smaller", wheelset, (25, 61), rises=False),
            self._ordered("Figure 18a", "from 81 Hz, the colder the larger", wheelset, (81, 200), rises=True),
            self._coincide("Figure 18b", "no difference of rail acceleration below 20 Hz", rail, 20.0),
            Statement(
                "Figure 18b",
                "the rail's peaks lie between 55 and 98 Hz and move up as it gets colder",
                rail_peaks[0] < rail_peaks[1] < rail_peaks[2] and rail_peaks[0] >= 55 and rail_peaks[2] <= 98,
                ", ".join(f"{p:g} Hz" for p in rail_peaks),
            ),
            self._ordered("Figure 18b", "up to 66 Hz, the colder the smaller", rail, (25, 66), rises=False),
            self._ordered("Figure 18b", "from 85 Hz, the colder the larger", rail, (85, 200), rises=True),
        ]

    def _coincide(self, figure: str, text: str, curves: Mapping[int, Reals], below: float) -> Statement:
        inside = self.f <= below
        stack = np.array([curves[t] for t in TEMPERATURES_C])
        spread = stack.max(axis=0) / stack.min(axis=0) - 1.0
        worst = self.f[inside][np.argmax(spread[inside])]
        return Statement(
            figure,
            text,
            bool(spread[inside].max() <= SAME),
            f"largest difference {100 * spread[inside].max():.1f} %, at {worst:g} Hz",
        )

    def _ordered(
        self, figure: str, text: str, curves: Mapping[int, Reals], band: tuple[float, float], *, rises: bool
    ) -> Statement:
        inside = (self.f >= band[0]) & (self.f <= band[1])
        warm, cold, coldest = (curves[t] for t in TEMPERATURES_C)
        order = (warm < cold) & (cold < coldest) if rises else (warm > cold) & (cold > coldest)
        share = float(np.mean(order[inside]))
        where = self.f[inside & order]
        reach = f"; true between {where.min():g} and {where.max():g} Hz" if where.size and share < 1.0 else ""
        return Statement(
            figure, text, share >= MOST, f"at {100 * share:.0f} % of {band[0]:g} to {band[1]:g} Hz{reach}"
        )


def track_decay(data: xr.Dataset) -> Reals:
    """Decay rate between contact points 1 and 3, dB/m (paper, equation (30))."""
    track = data["track_receptance"].sel(wheel_force="wheel1")
    return decay_rate(track.sel(wheel="wheel1").values, track.sel(wheel="wheel3").values, DISTANCE_M)


def _reach(frequency: Reals, holds: np.ndarray) -> float:
    """Highest frequency up to which it holds without a gap."""
    fails = np.flatnonzero(~holds)
    return float(frequency[fails[0] - 1]) if fails.size and fails[0] > 0 else float(frequency[-1])
