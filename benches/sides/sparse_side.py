"""scipy's side: the same line as a sparse matrix of spectral (exact) beam elements, splu per frequency.

Nodes stand at the joints, at the ends of the beams and at the loads; displacement and rotation are the unknowns.
Elements of equal section and length are one 4 x 4 matrix per frequency, from `expm` of the beam's state equations.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import problems
from scipy.linalg import expm
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu


def states(bending, shear, mass, rotary, omega: np.ndarray) -> np.ndarray:
    """Matrix of y' = A y, y deflection, rotation, force and moment over the bending stiffness, shape (F, 4, 4)."""
    a = np.zeros((omega.size, 4, 4), complex)
    a[:, 0, 1], a[:, 0, 2] = 1.0, bending / shear if shear else 0.0
    a[:, 1, 3] = 1.0
    a[:, 2, 0] = -mass * omega**2 / bending
    a[:, 3, 1], a[:, 3, 2] = -rotary * omega**2 / bending, -1.0
    return a


def element(a: np.ndarray, bending: complex, length: float) -> np.ndarray:
    """Dynamic stiffness of a length of beam, shape (F, 4, 4)."""
    t = expm(a * length)
    inverse = np.linalg.inv(t[:, :2, 2:])
    near, far = inverse @ t[:, :2, :2], t[:, 2:, 2:] @ inverse
    return bending * np.block([[near, -inverse], [t[:, 2:, :2] - t[:, 2:, 2:] @ near, far]])


def beyond(a: np.ndarray, bending: complex, side: int) -> np.ndarray:
    """Dynamic stiffness of the endless beam beyond a node, on its right (1) or left (-1), shape (F, 2, 2)."""
    values, vectors = np.linalg.eig(a)
    order = np.argsort(side * values.real, axis=1)[:, :2]
    waves = np.take_along_axis(vectors, order[:, None, :], axis=2)
    return -side * bending * waves[:, 2:] @ np.linalg.inv(waves[:, :2])


def prepare(case: str, grid: np.ndarray, folder: Path) -> Callable[[], np.ndarray]:
    tables = dict(np.load(folder / f"{case}.npz"))
    x, loads = tables["x"], np.array(problems.places(case))
    omega, whole = 2.0 * np.pi * grid, problems.frequencies(case)
    laws = tables["stiffness"][np.searchsorted(whole, grid)]
    nodes = []
    for body, interval in enumerate(tables["interval"]):
        on = x[(tables["upper"] == body) | (tables["lower"] == body)]
        more = loads if body == 0 else loads[:0]
        ends = interval[np.isfinite(interval)]
        nodes += [(place, body) for place in np.unique(np.concatenate([on, more, ends]).round(9))]
    # Along the line, so that the matrix is banded whatever the ordering makes of it.
    nodes.sort()
    number = {(body, place): i for i, (place, body) in enumerate(nodes)}
    find = np.vectorize(lambda body, place: 2 * number[int(body), float(np.round(place, 9))], otypes=[int])

    # Each kind of block: the unknowns it ties, and how it is computed.
    section = [
        tuple(tables[k][b] for k in ("bending", "shear", "mass", "rotary")) for b in range(len(tables["mass"]))
    ]
    kinds: dict[tuple, list[list[int]]] = {}
    for body, properties in enumerate(section):
        along = [(place, 2 * i) for i, (place, b) in enumerate(nodes) if b == body]
        for (left, i), (right, j) in pairwise(along):
            kinds.setdefault((properties, round(right - left, 9)), []).append([i, i + 1, j, j + 1])
        if np.isinf(tables["interval"][body][0]):
            kinds[properties, -np.inf] = [[along[0][1], along[0][1] + 1]]
            kinds[properties, np.inf] = [[along[-1][1], along[-1][1] + 1]]
    rows, columns = [], []
    for ties in kinds.values():
        ties = np.array(ties)
        rows.append(np.repeat(ties, ties.shape[1], axis=1).ravel())
        columns.append(np.tile(ties, ties.shape[1]).ravel())
    grounded = tables["lower"] < 0
    upper = find(tables["upper"], x)
    lower = np.where(grounded, upper, 0)
    lower[~grounded] = find(tables["lower"][~grounded], x[~grounded])
    rows += [upper, lower[~grounded], upper[~grounded], lower[~grounded]]
    columns += [upper, lower[~grounded], lower[~grounded], upper[~grounded]]
    size = 2 * len(nodes)
    keys, slots = np.unique(np.concatenate(columns) * size + np.concatenate(rows), return_inverse=True)
    indices, starts = keys % size, np.searchsorted(keys, size * np.arange(size + 1))
    at = find(np.zeros(loads.size), loads)
    push = np.zeros((size, loads.size), complex)
    push[at, np.arange(loads.size)] = 1.0

    def block(properties, length: float) -> np.ndarray:
        a = states(*properties, omega)
        if np.isinf(length):
            return beyond(a, properties[0], int(np.sign(length)))
        return element(a, properties[0], length)

    def solve() -> np.ndarray:
        blocks = [(block(*kind).reshape(grid.size, -1), len(ties)) for kind, ties in kinds.items()]
        out = np.empty((grid.size, loads.size, loads.size), complex)
        for f in range(grid.size):
            k = laws[f, tables["law"]] * tables["scale"]
            tied = k[~grounded]
            values = np.concatenate([np.tile(b[f], n) for b, n in blocks] + [k, tied, -tied, -tied])
            data = np.bincount(slots, values.real, keys.size) + 1j * np.bincount(slots, values.imag, keys.size)
            matrix = csc_array((data, indices, starts), shape=(size, size))
            # The fastest of the orderings that splu offers for this matrix.
            factor = splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
            out[f] = factor.solve(push)[at]
        return out

    return solve


if __name__ == "__main__":
    problems.run(prepare)
