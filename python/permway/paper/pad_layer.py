"""The paper's train on its line as an exact function of the pads' stiffness.

All pads are alike, so the track's receptance at the wheels follows for any pad stiffness k from one solution
without pads: with G the receptance between fasteners, rail and slab together, and G = V diag(lambda) V^-1,
`beta(k) = R_ww - R_wn V diag(1 / (lambda + 1/k)) V^-1 R_nw`. A thousand pads then cost what one sweep does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.paper.conventions import Convention, train
from permway.paper.readings import Curves
from permway.response.pseudo import pseudo_excitation
from permway.response.receptance import receptance


@dataclass(frozen=True)
class PadLayer:
    """What is needed to change the pads: see the module.

    Attributes
    ----------
    frequency : ndarray, shape (F,)
    rigid : ndarray, shape (F, 4, 4)
        Receptance of rail at the wheels without pads, plus wheels and contact, m/N.
    rail : ndarray, shape (F, 4, 4)
        Receptance of the rail at the wheels without pads, m/N.
    values : ndarray, shape (F, N)
        Eigenvalues lambda of the fasteners' receptance, m/N.
    left, right : ndarray, shape (F, 4, N) and (F, N, 4)
        R_wn V and V^-1 R_nw.
    excitation : ndarray, shape (F, 4)
        Pseudo-excitation under the wheels, m/sqrt(Hz).
    wheel : ndarray, shape (F, 4, 4)
        Receptance of the wheels, m/N.
    """

    frequency: Reals
    rigid: Complexes
    rail: Complexes
    values: Complexes
    left: Complexes
    right: Complexes
    excitation: Complexes
    wheel: Complexes

    @classmethod
    def of(cls, convention: Convention, frequency: Reals) -> PadLayer:
        """Solve the line without pads once for all."""
        whole = slab_track_viaduct_32m(girder=convention.girder, pad=wj7b_constant())
        fasteners, *others = whole.joints
        stations = fasteners.at
        assert isinstance(stations, tuple)
        line = Line(bodies=whole.bodies, laws=whole.laws, joints=(*_lost(fasteners), *others))
        wheels = train().wheels()
        rail = [Place(body="rail", x_m=x) for x in stations]
        slab = [Place(body="slab", x_m=x) for x in stations]
        places = [*wheels, *rail, *slab]
        h = receptance(line, frequency, forces=places, sensors=places)["receptance"].values
        w, n = len(wheels), len(stations)
        on_rail, on_slab = slice(w, w + n), slice(w + n, w + 2 * n)
        values, vectors = np.linalg.eig(h[:, on_rail, on_rail] + h[:, on_slab, on_slab])
        vehicle = train().vehicle
        wheel = vehicle.wheel_receptance(frequency)
        contact = train().contact.receptance(vehicle.share) * np.eye(w)
        speed = train().speed_m_per_s
        density = convention.irregularity.density(frequency, speed, convention.conversion)
        return cls(
            frequency=frequency,
            rigid=h[:, :w, :w] + wheel + contact,
            rail=h[:, :w, :w],
            values=values,
            left=h[:, :w, on_rail] @ vectors,
            right=np.linalg.solve(vectors, h[:, on_rail, :w]),
            excitation=pseudo_excitation(frequency, density, vehicle.lags_m(), speed),
            wheel=wheel,
        )

    def curves(self, pad: Complexes) -> Curves:
        """Force, wheelset, rail and total flexibility at wheel 1 with pads of stiffness `pad`, shape (F,), N/m."""
        softer = (self.left / (self.values + 1.0 / pad[:, None])[:, None, :]) @ self.right
        total = self.rigid - softer
        force = -np.linalg.solve(total, self.excitation[:, :, None])[:, :, 0]
        omega2 = (2.0 * np.pi * self.frequency) ** 2
        wheelset = omega2 * np.abs(np.einsum("fj,fj->f", self.wheel[:, 0], force))
        rail = omega2 * np.abs(np.einsum("fj,fj->f", (self.rail - softer)[:, 0], force))
        return Curves(self.frequency, np.abs(force[:, 0]), wheelset**2, rail**2, np.abs(total[:, 0, 0]))


def _lost(layer: Joints) -> tuple[Joints, ...]:
    """The layer without stiffness: its stations stay, so that forces and sensors find them."""
    return (layer.model_copy(update={"scale": 0.0}),)
