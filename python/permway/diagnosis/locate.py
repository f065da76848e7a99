"""Where path and model part: a free complex stiffness at every joint and at every place of every body.

A stiffness dZ added at a place changes a receptance by `-e_s dZ e_f`, with e the motion there by a unit force at
the sensor and at the hammer. For every place the dZ(f), smooth over frequency, that explains most of what
recalibration left is found in one linear step, with all that recalibration could still do projected out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import reduce

import numpy as np
import xarray as xr
from scipy import linalg

from permway.arrays import Complexes
from permway.campaign.factors import campaign_under
from permway.campaign.predict.hammer import read, temperature
from permway.diagnosis.blocks import Basis
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.fit import Fit
from permway.diagnosis.side_by_side import SMALL, each
from permway.diagnosis.spot import Found, Spot
from permway.errors import InputError
from permway.model.place import Place
from permway.response.receptance import receptance
from permway.response.sensitivity import sensitivity

KNOTS_PER_OCTAVE = 1.5
"""Of dZ over frequency."""

STEP_M = 1.0
"""Between the places of a body, about."""

COARSE, BESIDE = 3, 2
"""Of how many spots in a row one is looked at first, and beside how many of the best all are."""

_At = tuple[tuple[str, str], int]
"""Kind and name of a layer or a body, and which of its places."""

Motion = tuple[Complexes, Complexes]
"""Motion of a spot by unit forces at the sensors and at the points, each of shape (F, places)."""

FITS = 2.0
"""Mean square of the deviations below which a base nearly fits."""

RIDGE = 1e-9
"""Share of the largest curvature that keeps the linear step finite."""


class Scan:
    """Everything that the spots of one campaign share.

    Parameters
    ----------
    fit : Fit
        The recalibrated base.
    block : FrfBlock
        Frequency responses under one condition.
    predicted : Dataset
        By the fit, of the block.

    Raises
    ------
    InputError
        If the block is none of the fit's.
    """

    def __init__(self, fit: Fit, block: FrfBlock, predicted: xr.Dataset) -> None:
        index = next((i for i, b in enumerate(fit.evidence.blocks) if b is block), None)
        if index is None:
            raise InputError("is no block of the fit", where="block")
        self.fit, self.block = fit, block
        condition = fit.campaign.condition(block.dataset.condition.name)
        self.campaign = campaign_under(fit.campaign, condition)
        self.frequency = block.dataset.frequency_Hz
        sensors = [self.campaign.sensor(name) for name in block.dataset.names("sensor")]
        points = [self.campaign.point(name) for name in block.dataset.names("force")]
        self.read = np.moveaxis(read(sensors, points, self.frequency), 0, -1)
        self.temperature = temperature(self.campaign, condition)
        self.sensors = [Place(body=str(s.body), x_m=float(s.x_m or 0.0), name=s.name) for s in sensors]
        self.points = [Place(body=p.body, x_m=p.x_m, name=p.name) for p in points]
        rows = fit.evidence.block_of == index
        half = int(rows.sum()) // 2
        # While no model fits, all records count as if they were no better than they fit.
        share = 1.0 / np.sqrt(fit.heat)
        # Where one nearly does, what smooth errors explain is taken out first.
        left = fit.clean if fit.heat < FITS else fit.deviations
        clean, jacobian = share * left[rows], share * fit.jacobian[rows]
        self._share = share
        shape = block.measured.shape
        self.left: Complexes = (clean[:half] + 1j * clean[half:]).reshape(shape)
        self.slopes: Complexes = (jacobian[:half] + 1j * jacobian[half:]).reshape(*shape, fit.z.size)
        # What remains free is held by all other records, too: their curvature and the priors.
        self._normal = share**2 * fit.jacobian.T @ fit.jacobian + np.eye(fit.z.size)
        self._slope = share**2 * fit.jacobian.T @ left + fit.z
        self._total = share**2 * float(left @ left)
        self._steep = block.weight * block.slope(predicted)
        self._basis = Basis(float(self.frequency[0]), float(self.frequency[-1]), KNOTS_PER_OCTAVE)

    def joints(self) -> Iterator[tuple[Spot, Motion]]:
        """Each joint, with its extensions by forces at the sensors and at the points."""
        line = self.campaign.model.line
        data = sensitivity(
            line,
            self.frequency,
            forces=self.points,
            sensors=self.sensors,
            bodies=False,
            places=True,
            temperature_C=self.temperature,
        )
        table, laws = line.joint_table(), list(line.laws)
        sensor, force = data["sensor_extension"].values, data["force_extension"].values
        for j in range(table.x.size):
            x = float(table.x[j])
            yield Spot("joint", laws[table.law[j]], (x, x), (j,)), (sensor[:, j], force[:, j])

    def bodies(self) -> Iterator[tuple[Spot, Motion]]:
        """Places along each beam between its finite ends, or where the line is."""
        line = self.campaign.model.line
        table = line.joint_table()
        places: list[Place] = []
        for beam, segment in line.beams():
            low = max(segment.start, float(table.x.min()))
            high = min(segment.stop, float(table.x.max()))
            name = segment.name
            if high > low and beam is not None:
                count = max(2, round((high - low) / STEP_M) + 1)
                inside = np.linspace(low, high, count)
                places.extend(Place(body=name, x_m=float(x), name=f"{name}@{x!r}") for x in inside)
        ports = [*self.sensors, *(p for p in self.points if not _among(p, self.sensors))]
        moved = receptance(
            line, self.frequency, forces=_named(ports), sensors=places, temperature_C=self.temperature
        )["receptance"].values
        at = {(p.body, p.x_m): i for i, p in enumerate(ports)}
        sensor = moved[:, :, [at[p.body, p.x_m] for p in self.sensors]]
        force = moved[:, :, [at[p.body, p.x_m] for p in self.points]]
        for i, place in enumerate(places):
            yield Spot("body", place.body, (place.x_m, place.x_m)), (sensor[:, i], force[:, i])

    def of(self, spot: Spot, motion: Motion) -> Found:
        """The dZ at a spot that explains most."""
        block, basis = self.block, self._basis.values(self.frequency)
        product = motion[0].T[:, None, :] * motion[1].T[None, :, :]
        # Deviations are measured less predicted: an added stiffness lessens the prediction.
        effect = self._share * block.white(product * self.read * self._steep)
        columns = (effect[..., None] * basis).reshape(-1, basis.shape[1])
        left, slopes = self.left.reshape(-1), self.slopes.reshape(self.left.size, self.slopes.shape[-1])
        inner = columns.conj().T @ columns
        cross = columns.conj().T @ slopes
        pull = columns.conj().T @ left
        normal = np.block([[inner.real, -inner.imag], [inner.imag, inner.real]])
        # A real coefficient of i times a column: conj(i c) . v = -i conj(c) . v.
        coupling = np.vstack([cross.real, cross.imag])
        force = np.concatenate([pull.real, pull.imag])
        moved = linalg.solve(self._normal, np.column_stack([coupling.T, self._slope]), assume_a="pos")
        normal, force = normal - coupling @ moved[:, :-1], force - coupling @ moved[:, -1]
        normal = 0.5 * (normal + normal.T)
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        scaled = normal / scale[:, None] / scale[None, :] + RIDGE * np.eye(scale.size)
        value, vectors = linalg.eigh(scaled)
        kept = value > 1e-7 * value[-1]
        parts = (vectors.T @ (force / scale))[kept]
        gain = min(float((parts**2 / value[kept]).sum()), self._total)
        solution = (vectors[:, kept] @ (parts / value[kept])) / scale
        spread = vectors[:, kept] / np.sqrt(value[kept]) / scale[:, None]
        # The model lacks what the deviations show: the coefficient is that of what must be added.
        count = basis.shape[1]
        stiffness = basis @ (solution[:count] + 1j * solution[count:])
        sigma = np.sqrt(((basis @ spread[:count]) ** 2).sum(axis=1))
        shown = (effect * stiffness).conj() * self.left
        by_band = np.asarray(shown.real.sum(axis=(0, 1)))
        return Found(spot, gain, int(kept.sum()), self.frequency, -stiffness, sigma, by_band, self._total)


def scan(fit: Fit, also: Callable[[Spot], bool] = lambda _: False) -> list[Found]:
    """Single joints and places of bodies, the most telling first: every third, and all beside the best.

    Parameters
    ----------
    fit : Fit
    also : callable
        Whether a spot is looked at in any case.

    Raises
    ------
    InputError
        If the campaign has no frequency responses.
    """
    if not any(isinstance(block, FrfBlock) for block in fit.evidence.blocks):
        raise InputError(
            "no frequency response to locate by", where="records", remedy="measure some with a hammer"
        )
    scans = _scans(fit)
    rows = [_rows(one) for one in scans]

    def found(at: _At) -> Found:
        key, index = at
        return reduce(_both, (one.of(*row[key][index]) for one, row in zip(scans, rows, strict=True)))

    def all_of(places: Sequence[_At]) -> dict[_At, Found]:
        return dict(zip(places, each(found, places, threads=fit.evidence.threads, least=SMALL), strict=True))

    known = all_of([(key, i) for key, row in rows[0].items() for i in range(0, len(row), COARSE)])
    further: list[_At] = []
    for key, row in rows[0].items():
        mine = [at for at in known if at[0] == key]
        best = sorted(mine, key=lambda at: -known[at].surplus)[:BESIDE]
        asked = {i for i, (spot, _) in enumerate(row) if also(spot)}
        beside = {i + d for _, i in best for d in range(1 - COARSE, COARSE)} | asked
        further += [(key, i) for i in sorted(beside) if 0 <= i < len(row) and (key, i) not in known]
    known |= all_of(further)
    order = {key: place for place, key in enumerate(rows[0])}
    total = [known[at] for at in sorted(known, key=lambda at: (order[at[0]], at in further))]
    return sorted(total, key=lambda f: -f.surplus)


def scanned(fit: Fit, also: Callable[[Spot], bool] = lambda _: False) -> tuple[Found, ...]:
    """The same; nothing where there is no hammer test."""
    return tuple(scan(fit, also)) if any(isinstance(b, FrfBlock) for b in fit.evidence.blocks) else ()


def unseen(fit: Fit) -> list[Found]:
    """A quarter, the middle and three quarters of each layer and body, as places of which nothing is known yet."""
    scans = _scans(fit)
    if not scans:
        return []
    one = scans[0]
    rows = _rows(one)
    nothing, flat = np.zeros(one.frequency.size, dtype=np.complex128), np.ones(one.frequency.size)
    return [
        Found(row[round(share * (len(row) - 1))][0], 0.0, 0, one.frequency, nothing, flat, flat, 1.0)
        for share in (0.5, 0.25, 0.75)
        for row in rows.values()
    ]


def _scans(fit: Fit) -> list[Scan]:
    """One of each hammer test."""
    predicted = fit.evidence.predicted(fit.campaign).datasets
    blocks = zip(fit.evidence.blocks, predicted, strict=True)
    return [Scan(fit, block, data) for block, data in blocks if isinstance(block, FrfBlock)]


def _rows(one: Scan) -> dict[tuple[str, str], list[tuple[Spot, Motion]]]:
    """The spots of each layer and of each body, in order."""
    rows: dict[tuple[str, str], list[tuple[Spot, Motion]]] = {}
    for spot, motion in (*one.joints(), *one.bodies()):
        rows.setdefault((spot.kind, spot.name), []).append((spot, motion))
    for row in rows.values():
        row.sort(key=lambda pair: pair[0].x_m)
    return rows


def _both(old: Found, new: Found) -> Found:
    """Under two conditions: each with its own dZ, the gains added, the better known dZ shown."""
    better = old if old.gain >= new.gain else new
    return Found(
        better.spot,
        old.gain + new.gain,
        old.degrees + new.degrees,
        better.frequency_Hz,
        better.stiffness_N_per_m,
        better.sigma_N_per_m,
        better.by_band,
        old.total + new.total,
    )


def _among(place: Place, places: Sequence[Place]) -> bool:
    return any(p.body == place.body and p.x_m == place.x_m for p in places)


def _named(places: Sequence[Place]) -> list[Place]:
    return [Place(body=p.body, x_m=p.x_m, name=f"port{i}") for i, p in enumerate(places)]
