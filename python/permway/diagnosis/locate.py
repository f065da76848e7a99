"""Where path and model part: a free complex stiffness at every joint and at every place of every body.

A stiffness dZ added at a place changes a receptance by `-e_s dZ e_f`, with e the motion there by a unit force at
the sensor and at the hammer. For every place the dZ(f), smooth over frequency, that explains most of what
recalibration left is found in one linear step, with all that recalibration could still do projected out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Complexes, Reals
from permway.diagnosis.blocks import Basis, FrfBlock
from permway.diagnosis.recalibrate import Fit
from permway.errors import InputError
from permway.recordings.predict.hammer import read, temperature
from permway.response.receptance import Place, receptance
from permway.response.sensitivity import sensitivity

KNOTS_PER_OCTAVE = 1.5
"""Of dZ over frequency."""

STEP_M = 1.0
"""Between the places of a body, about."""

FITS = 2.0
"""Mean square of the deviations below which a base nearly fits."""

RIDGE = 1e-9
"""Share of the largest curvature that keeps the linear step finite."""


@dataclass(frozen=True)
class Spot:
    """A place where a stiffness may be added.

    Attributes
    ----------
    kind : "joint" or "body"
    name : str
        Law and station, or body.
    x_m : (float, float)
        From and to.
    joints : tuple of int
        Indices in the table of joints; empty for a body.
    """

    kind: str
    name: str
    x_m: tuple[float, float]
    joints: tuple[int, ...] = ()

    @property
    def label(self) -> str:
        """For people."""
        low, high = self.x_m
        return f"{self.name} at {low:g} m" if low == high else f"{self.name}, {low:g} to {high:g} m"


@dataclass(frozen=True)
class Found:
    """What a free stiffness at a spot explains.

    Attributes
    ----------
    spot : Spot
    gain : float
        Of chi square, recalibration projected out.
    degrees : int
        Numbers that were free.
    frequency_Hz : ndarray, shape (F,)
    stiffness_N_per_m : ndarray of complex128, shape (F,)
        The dZ that explains most.
    sigma_N_per_m : ndarray, shape (F,)
        Standard deviation of its real and of its imaginary part.
    by_band : ndarray, shape (F,)
        Share of each frequency in the gain.
    """

    spot: Spot
    gain: float
    degrees: int
    frequency_Hz: Reals
    stiffness_N_per_m: Complexes
    sigma_N_per_m: Reals
    by_band: Reals

    @property
    def surplus(self) -> float:
        """Gain beyond what the free numbers would explain of noise."""
        return self.gain - self.degrees


class Scan:
    """Everything that the spots of one campaign share.

    Parameters
    ----------
    fit : Fit
        The recalibrated base.
    block : FrfBlock
        Frequency responses under one condition.

    Raises
    ------
    InputError
        If the block is none of the fit's.
    """

    def __init__(self, fit: Fit, block: FrfBlock) -> None:
        index = next((i for i, b in enumerate(fit.evidence.blocks) if b is block), None)
        if index is None:
            raise InputError("is no block of the fit", where="block")
        self.fit, self.block = fit, block
        self.campaign = fit.campaign
        data, record = block.dataset.data, block.dataset
        self.frequency: Reals = data["frequency"].values
        sensors, points = ([str(v) for v in data[kind].values] for kind in ("sensor", "force"))
        self.read = np.moveaxis(read(self.campaign, sensors, points, self.frequency), 0, -1)
        self.temperature = temperature(self.campaign, record.condition)
        self.sensors = [
            Place(body=str(s.body), x_m=float(s.x_m or 0.0), name=s.name)
            for s in map(self.campaign.sensor, sensors)
        ]
        self.points = [Place(body=p.body, x_m=p.x_m, name=p.name) for p in map(self.campaign.point, points)]
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
        self.slopes: Complexes = (jacobian[:half] + 1j * jacobian[half:]).reshape(*shape, -1)
        # What remains free is held by all other records, too: their curvature and the priors.
        self._normal = share**2 * fit.jacobian.T @ fit.jacobian + np.eye(fit.z.size)
        self._basis = Basis(float(self.frequency[0]), float(self.frequency[-1]), KNOTS_PER_OCTAVE)

    def joints(self) -> Iterator[tuple[Spot, Complexes]]:
        """Each joint, with its extensions by a force at a sensor times those by a force at a point."""
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
            product = np.einsum("fs,fp->spf", sensor[:, j], force[:, j])
            yield Spot("joint", laws[table.law[j]], (x, x), (j,)), product

    def bodies(self) -> Iterator[tuple[Spot, Complexes]]:
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
            yield (
                Spot("body", place.body, (place.x_m, place.x_m)),
                np.einsum("fs,fp->spf", sensor[:, i], force[:, i]),
            )

    def of(self, spot: Spot, product: Complexes) -> Found:
        """The dZ at a spot that explains most."""
        block, basis = self.block, self._basis.values(self.frequency)
        # Deviations are measured less predicted: an added stiffness lessens the prediction.
        effect = self._share * block.white(product * self.read * block.weight)
        columns = (effect[..., None] * basis).reshape(-1, basis.shape[1])
        left, slopes = self.left.reshape(-1), self.slopes.reshape(-1, self.slopes.shape[-1])
        inner = columns.conj().T @ columns
        cross = columns.conj().T @ slopes
        pull = columns.conj().T @ left
        normal = np.block([[inner.real, -inner.imag], [inner.imag, inner.real]])
        # A real coefficient of i times a column: conj(i c) . v = -i conj(c) . v.
        coupling = np.vstack([cross.real, cross.imag])
        force = np.concatenate([pull.real, pull.imag])
        normal = normal - coupling @ linalg.solve(self._normal, coupling.T, assume_a="pos")
        normal = 0.5 * (normal + normal.T)
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        scaled = normal / scale[:, None] / scale[None, :] + RIDGE * np.eye(scale.size)
        value, vectors = linalg.eigh(scaled)
        kept = value > 1e-7 * value[-1]
        parts = (vectors.T @ (force / scale))[kept]
        gain = float((parts**2 / value[kept]).sum())
        solution = (vectors[:, kept] @ (parts / value[kept])) / scale
        spread = vectors[:, kept] / np.sqrt(value[kept]) / scale[:, None]
        # The model lacks what the deviations show: the coefficient is that of what must be added.
        count = basis.shape[1]
        stiffness = basis @ (solution[:count] + 1j * solution[count:])
        sigma = np.sqrt(((basis @ spread[:count]) ** 2).sum(axis=1))
        shown = (effect * stiffness).conj() * self.left
        return Found(
            spot, gain, int(kept.sum()), self.frequency, -stiffness, sigma, np.asarray(shown.real.sum(axis=(0, 1)))
        )


def scan(fit: Fit) -> list[Found]:
    """All single joints and places of bodies, the most telling first.

    Raises
    ------
    InputError
        If the campaign has no frequency responses.
    """
    blocks = [b for b in fit.evidence.blocks if isinstance(b, FrfBlock)]
    if not blocks:
        raise InputError(
            "no frequency response to locate by", where="records", remedy="measure some with a hammer"
        )
    total: dict[Spot, Found] = {}
    for block in blocks:
        one = Scan(fit, block)
        for spot, product in (*one.joints(), *one.bodies()):
            found = one.of(spot, product)
            old = total.get(spot)
            total[spot] = found if old is None else _both(old, found)
    return sorted(total.values(), key=lambda f: -f.surplus)


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
    )


def _among(place: Place, places: Sequence[Place]) -> bool:
    return any(p.body == place.body and p.x_m == place.x_m for p in places)


def _named(places: Sequence[Place]) -> list[Place]:
    return [Place(body=p.body, x_m=p.x_m, name=f"port{i}") for i, p in enumerate(places)]
