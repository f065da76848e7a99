"""What an amendment gains on records that it was not fitted to.

Parts of the records are left out in turn, base and amended model fitted to the rest, and both held against what
was left out. A fit to the rest starts from the fit to all of them and keeps its slopes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.groups import held_out
from permway.campaign.parts import HeldOut
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.blocks_noise import NoiseBlock
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit, limits_of
from permway.diagnosis.whitener import Whitener
from permway.errors import InputError, SolveError

STEPS = 4
OWN = 1e-3
"""Share of what all records say of a parameter of the recording below which the rest is said not to know it."""

RECORDING = {"campaign.conditions", "campaign.sensors"}
"""What parameters of the recording act on."""

LEAST_NATS = 1e-12
"""Of a gain, so that it has a standard error."""

SURE_DB = 1.0
"""A row of larger standard deviation says nothing of a level in dB."""


@dataclass(frozen=True)
class Part:
    """Rows that are left out together.

    Attributes
    ----------
    axis : str
        What they differ in from the rest: "speed", "temperature", "place", "channel", "band".
    name : str
    rows : ndarray of bool, shape (n,)
    """

    axis: str
    name: str
    rows: np.ndarray


@dataclass(frozen=True)
class Scored:
    """How well a fit to the rest predicts a part.

    Attributes
    ----------
    log_density : float
        Of the part given the rest, parameters and smooth errors integrated out, nats.
    error_dB : float
        Root mean square of levels as measured, no error of chains taken out, where the record knows them to 1 dB.
    z, sigma : ndarray, shape (p,)
        Parameters of the fit to the rest, and their standard deviations.
    """

    log_density: float
    error_dB: float
    z: Reals
    sigma: Reals


def parts(evidence: Evidence) -> Iterator[Part]:
    """What may be left out: the campaign's own groups, or else speeds, temperatures, blows, sensors and a band."""
    own = [Part(g.axis, g.name, _of_group(evidence, g)) for g in evidence.campaign.stated.held_out]
    yield from (p for p in (own or list(_usual(evidence))) if p.rows.any() and not p.rows.all())


def at_fault(evidence: Evidence, channels: Sequence[str]) -> Iterator[Part]:
    """Of channels that are said to be at fault: the upper half of their band, and their noise.

    In the one a fault goes on as below, and errors of a chain wander as they like; of the other the other sensors
    say what is usual.
    """
    rows, names = evidence.rows, " and ".join(channels)
    mine = np.isin(rows.sensor, channels)
    noise = mine & ~np.isin(evidence.block_of, evidence.records)
    mine &= ~noise
    if mine.any():
        middle = np.sqrt(rows.frequency_Hz[mine].min() * rows.frequency_Hz[mine].max())
        yield Part("band", f"upper half of {names}", mine & (rows.frequency_Hz > middle))
    if noise.any():
        yield Part("channel", f"noise of {names}", noise)


def between_lines(evidence: Evidence) -> Iterator[Part]:
    """Of runs: every second sixth of an octave.

    A series of lines is foretold there by its other lines; a chain's smooth error as well with it as without.
    """
    rows = evidence.rows
    runs = [i for i, block in enumerate(evidence.blocks) if isinstance(block, SpectraBlock)]
    sixth = np.floor(6.0 * np.log2(rows.frequency_Hz)).astype(np.int64)
    mine = np.isin(evidence.block_of, runs) & (sixth % 2 == 1)
    if mine.any():
        yield Part("band", "every second sixth of an octave of the runs", mine)


def _usual(evidence: Evidence) -> Iterator[Part]:
    rows, block_of, blocks = evidence.rows, evidence.block_of, evidence.blocks
    conditions = [b.dataset.condition for b in blocks]
    speeds = sorted({c.speed_m_per_s for c in conditions if c.speed_m_per_s is not None})
    for speed in speeds[-1:] if len(speeds) > 1 else []:
        mine = [i for i, c in enumerate(conditions) if c.speed_m_per_s == speed]
        yield Part("speed", f"{3.6 * speed:.0f} km/h", np.isin(block_of, mine))
    temperatures = sorted(
        {c.temperature_C for c in conditions if c.temperature_C is not None and c.kind != "train"}
    )
    for value in temperatures[:1] if len(temperatures) > 1 else []:
        mine = [i for i, c in enumerate(conditions) if c.temperature_C == value]
        yield Part("temperature", f"{value:g} degC", np.isin(block_of, mine))
    points = list(dict.fromkeys(rows.force[rows.force != ""]))
    if len(points) > 2:
        yield Part("place", "every third point", np.isin(rows.force, points[1::3]))
    hammer = np.isin(block_of, [i for i, b in enumerate(blocks) if isinstance(b, FrfBlock)])
    sensors = list(dict.fromkeys(rows.sensor[hammer]))
    if len(sensors) > 2:
        yield Part("channel", "every third sensor", hammer & np.isin(rows.sensor, sensors[1::3]))
    low, high = rows.frequency_Hz.min(), rows.frequency_Hz.max()
    edges = np.geomspace(low, high * 1.0001, 13)
    # Every third of a dozen bands: what lies between is known on either side.
    inside = (np.searchsorted(edges, rows.frequency_Hz, side="right") - 1) % 3 == 1
    yield Part("band", "every third band", inside)


def _of_group(evidence: Evidence, group: HeldOut) -> np.ndarray:
    """Rows that a group of the campaign file holds."""
    return np.concatenate([_rows_of(held_out(evidence.campaign, group, b.dataset), b) for b in evidence.blocks])


def _rows_of(mask: xr.DataArray, block: Block) -> np.ndarray:
    """A mark of a dataset's data, for each of its block's rows."""
    if isinstance(block, FrfBlock):
        return np.tile(mask.values.reshape(-1), 2)
    if isinstance(block, NoiseBlock):
        return block.held(mask.transpose("sensor", "force", "frequency").values)
    if "channel" not in mask.dims:
        return np.resize(mask.values, block.rows.channel.size)
    channels = [str(name) for name in mask["channel"].values]
    place = np.array([channels.index(str(name)) for name in block.rows.sensor])
    line = np.searchsorted(mask["frequency"].values, block.rows.frequency_Hz)
    return np.asarray(mask.transpose("channel", "frequency").values[place, line])


class Rest:
    """A fit, ready to be fitted again without some of its rows.

    Parameters
    ----------
    fit : Fit
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self._whole = fit.evidence.whitener
        # Speeds and noise floors of what is left out are as all records have them, before and after.
        known = fit.evidence.campaign.parameters
        self._recording = np.array(
            [f.name in known.names and known.touches(f.name) <= RECORDING for f in fit.free], dtype=bool
        )
        # What the blocks take out themselves, shared out among their rows.
        blocks = fit.evidence.blocks
        self._volume = np.concatenate(
            [np.full(b.rows.channel.size, b.log_determinant / b.rows.channel.size) for b in blocks]
        )

    def _of(self, rows: np.ndarray) -> Whitener:
        evidence = self.fit.evidence
        return Whitener.of(evidence.columns.masked(rows), evidence.sizes, evidence.length)

    def _predicted(self, z: Reals) -> tuple[Reals, list[xr.Dataset]] | None:
        """Deviations, and the predictions that they are of; None if the model cannot be solved."""
        values = {f.name: f.value(float(v)) for f, v in zip(self.fit.free, z, strict=True)}
        try:
            predicted = self.fit.evidence.predicted(self.fit.build(values)).datasets
        except (InputError, SolveError):
            return None
        found = self.fit.evidence.deviations(predicted)
        return (found, predicted) if np.isfinite(found).all() else None

    def fitted(self, rows: np.ndarray) -> tuple[Reals, Reals, Reals]:
        """Values z, all deviations and all levels in dB of a fit to some rows."""
        fit, whitener = self.fit, self._of(rows)
        jacobian = np.where(rows[:, None], fit.jacobian, 0.0)
        reduced = whitener.reduce(jacobian)
        information = jacobian.T @ jacobian - reduced.T @ reduced
        normal = information / fit.heat + np.eye(fit.z.size)
        known = ~(self._recording & (np.diag(jacobian.T @ jacobian) < OWN * (fit.jacobian**2).sum(axis=0)))
        low, high = limits_of(fit.free)
        z, deviations = fit.z, fit.deviations
        datasets: list[xr.Dataset] | None = None
        value = whitener.square(deviations * rows) / fit.heat + float(z @ z)
        for _ in range(STEPS):
            left = whitener.reduce(deviations * rows)
            slope = (jacobian.T @ deviations - reduced.T @ left) / fit.heat + z
            shift, moved = np.zeros(z.size), False
            shift[known] = -linalg.solve(normal[np.ix_(known, known)], slope[known], assume_a="pos")
            for share in (1.0, 0.3):
                tried = np.clip(z + share * shift, low, high)
                new = self._predicted(tried)
                if new is not None:
                    objective = whitener.square(new[0] * rows) / fit.heat + float(tried @ tried)
                    if objective < value:
                        gained, moved = value - objective, True
                        z, value, (deviations, datasets) = tried, objective, new
                        break
            if not moved or gained < 0.5:
                break
        if datasets is None:
            datasets = fit.evidence.predicted(fit.campaign).datasets
        return z, deviations, fit.evidence.levels_dB(datasets)

    def scored(self, part: np.ndarray) -> Scored:
        """How well the fit to all else predicts a part.

        Parameters
        ----------
        part : ndarray of bool, shape (n,)
        """
        z, deviations, levels = self.fitted(~part)
        rest, fit = self._of(~part), self.fit
        square, _ = self._evidence(self._whole, fit.deviations, fit.z)
        less, sigma = self._evidence(rest, deviations * ~part, z, ~part)
        square -= less
        volume = self._whole.log_determinant - rest.log_determinant + float(self._volume[part].sum())
        # A model that does not fit knows so: its deviations are as much larger on what it has not seen.
        spread = float(np.log(fit.heat))
        log_density = -0.5 * (square + volume + spread * float(part.sum()))
        return Scored(log_density, error_dB(fit.evidence, levels, part), z, sigma)

    def _evidence(
        self, whitener: Whitener, deviations: Reals, z: Reals, rows: np.ndarray | None = None
    ) -> tuple[float, Reals]:
        """Quadratic form of some rows and the prior, and what integrating over the parameters adds (Laplace).

        And the parameters' standard deviations, by these rows.
        """
        jacobian = self.fit.jacobian if rows is None else np.where(rows[:, None], self.fit.jacobian, 0.0)
        reduced = whitener.reduce(jacobian)
        normal = (jacobian.T @ jacobian - reduced.T @ reduced) / self.fit.heat + np.eye(z.size)
        square = whitener.square(deviations) / self.fit.heat + float(z @ z)
        factor = linalg.cholesky(normal, lower=True)
        inverse = linalg.solve_triangular(factor, np.eye(z.size), lower=True)
        volume = 2.0 * float(np.log(np.diag(factor)).sum())
        return square + volume, np.sqrt((inverse**2).sum(axis=0))


def error_dB(evidence: Evidence, levels: Reals, part: np.ndarray) -> float:
    """Root mean square of levels of a part, where the record knows them; NaN where it knows none."""
    level = levels[part][evidence.rows.scale_dB[part] < SURE_DB]
    level = level[np.isfinite(level)]
    return float(np.sqrt(np.mean(level**2))) if level.size else float("nan")


@dataclass(frozen=True)
class Gain:
    """Amended against recalibrated on a part that was left out.

    Attributes
    ----------
    part : Part
    nats, standard_error : float
        Gain of log predictive density; its error is the root of twice the gain, as where two normal densities of
        one width differ in their means.
    before_dB, after_dB : float
    z, sigma : ndarray, shape (p,)
        Parameters of the amended model fitted to the rest, and their standard deviations.
    """

    part: Part
    nats: float
    standard_error: float
    before_dB: float
    after_dB: float
    z: Reals
    sigma: Reals


def gains(base: Rest, amended: Rest, chosen: Sequence[Part]) -> list[Gain]:
    """Of every part."""
    return [gain(part, base.scored(part.rows), amended.scored(part.rows)) for part in chosen]


def gain(part: Part, before: Scored, after: Scored) -> Gain:
    """Of one."""
    nats = after.log_density - before.log_density
    error = float(np.sqrt(2.0 * max(abs(nats), LEAST_NATS)))
    return Gain(part, nats, error, before.error_dB, after.error_dB, after.z, after.sigma)
