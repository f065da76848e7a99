"""numpy's side: the paper's dense systems, (I + K G) F = K d0, by numpy and its LAPACK.

Green's functions in closed form: the infinite beam's at the distinct distances, and for beams with free ends the
waves that their ends send back, a product of rank four. Joint forces are the unknowns.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import problems

SOLVE = problems.Part(np.linalg.solve)


class Beam:
    """One beam of the tables, between the joints on it (and the loads, behind them)."""

    def __init__(self, tables, index: int, places: np.ndarray, signs: np.ndarray):
        self.bending, self.shear = tables["bending"][index], tables["shear"][index]
        self.mass, self.rotary = tables["mass"][index], tables["rotary"][index]
        self.start, self.stop = tables["interval"][index]
        self.places, self.signs = places, signs
        distance = np.abs(places[:, None] - places).round(9)
        self.distances, inverse = np.unique(distance, return_inverse=True)
        self.inverse = inverse.reshape(distance.shape)

    def green(self, omega: float) -> np.ndarray:
        """Receptance between all places, m/N, with the signs of both."""
        mu, j = self.mass * omega**2, self.rotary * omega**2
        compliance = 1.0 / self.shear if self.shear else 0.0
        total = -(j / self.bending + mu * compliance)
        product = mu / self.bending * (j * compliance - 1.0)
        root = np.sqrt(total**2 - 4.0 * product + 0j)
        waves = np.sqrt(np.array([(total + root) / 2.0, (total - root) / 2.0]))
        # Waves that decay away from the force; all beams here have losses.
        waves = np.where(waves.real > 0.0, -waves, waves)
        force = -mu / waves
        turn = waves - force * compliance
        direct = np.array([turn[1], -turn[0]]) / (2.0 * (turn[0] * force[1] - turn[1] * force[0]))
        green = (direct @ np.exp(np.outer(waves, self.distances)))[self.inverse]
        if np.isfinite(self.start):
            shapes = np.exp(np.outer(np.concatenate([self.places - self.start, self.stop - self.places]), waves))
            shapes = np.hstack(np.split(shapes, 2))
            green += shapes @ self.reflection(waves, direct) @ shapes.T
        return self.signs[:, None] * green * self.signs

    def reflection(self, waves: np.ndarray, direct: np.ndarray) -> np.ndarray:
        """Waves that the two free ends (no moment, no shear force) send back, of what each of the four brings."""
        across = np.exp(waves * (self.stop - self.start))
        second, third = waves**2, waves**3
        ends = np.block(
            [
                [second, second * across],
                [third, -third * across],
                [second * across, second],
                [third * across, -third],
            ]
        )
        none = np.zeros(2)
        brought = np.block(
            [[direct * second, none], [-direct * third, none], [none, direct * second], [none, direct * third]]
        )
        return np.linalg.solve(ends, -brought)


def prepare(case: str, grid: np.ndarray, folder: Path) -> Callable[[], np.ndarray]:
    tables = dict(np.load(folder / f"{case}.npz"))
    x, loads = tables["x"], np.array(problems.places(case))
    whole = problems.frequencies(case)
    k = tables["stiffness"][np.searchsorted(whole, grid)][:, tables["law"]] * tables["scale"]
    parts = []
    for body in range(len(tables["mass"])):
        upper, lower = tables["upper"] == body, tables["lower"] == body
        rows = np.flatnonzero(upper | lower)
        signs = np.where(upper[rows], 1.0, -1.0)
        behind = loads if body == 0 else loads[:0]
        beam = Beam(tables, body, np.append(x[rows], behind), np.append(signs, np.ones(behind.size)))
        run = slice(rows[0], rows[-1] + 1) if np.all(np.diff(rows) == 1) else None
        parts.append((beam, (run, run) if run else np.ix_(rows, rows), rows))

    def respond(omega: float, k: np.ndarray) -> np.ndarray:
        system, by_loads = np.zeros((x.size, x.size), complex), np.zeros((x.size, loads.size), complex)
        direct = None
        for beam, block, rows in parts:
            green, n = beam.green(omega), rows.size
            system[block] += green[:n, :n]
            if direct is None:
                by_loads[rows], direct = green[:n, n:], green[n:, n:]
        system *= k[:, None]
        system.flat[:: x.size + 1] += 1.0
        return direct - by_loads.T @ SOLVE(system, k[:, None] * by_loads)

    return lambda: np.array([respond(2.0 * np.pi * f, row) for f, row in zip(grid, k, strict=True)])


if __name__ == "__main__":
    problems.run(prepare, SOLVE)
