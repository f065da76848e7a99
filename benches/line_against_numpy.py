"""Whole lines by both formulations against the same dense receptance systems by numpy, one thread each.

numpy's side is written as one would: Green's function of the infinite Timoshenko rail at the distinct distances
only, sums over modes as a matrix product, one dense system with the joint forces as unknowns, one `solve` for all
forces. Its answers must be those of the Rust side. Every run is a process of its own and they alternate.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from common import HERE, build, machine

SPAN, MODES = 32.0, 60


class Rail:
    """Infinite Timoshenko rail, equation (4) of the paper, between given places."""

    def __init__(self, young, shear, moment, area, loss, places):
        self.bending, self.stiffness = (1 + 1j * loss) * young * moment, (1 + 1j * loss) * 0.4 * shear * area
        self.mass, self.rotary = 7850 * area, 7850 * moment
        distance = np.abs(places[:, None] - places)
        self.distances, self.index = np.unique(distance.round(9), return_inverse=True)
        self.index = self.index.reshape(distance.shape)

    def receptance(self, omega):
        """Receptance between all places, m/N."""
        mu, j = self.mass * omega**2, self.rotary * omega**2
        total, product = -(j / self.bending + mu / self.stiffness), mu / self.bending * (j / self.stiffness - 1)
        root = np.sqrt(total**2 - 4 * product + 0j)
        exponents = np.sqrt(np.array([(total + root) / 2, (total - root) / 2]))
        # Waves that decay, or for an undamped rail travel, away from the force.
        grow = np.where(np.abs(exponents.real) > 1e-13 * np.abs(exponents), exponents.real, exponents.imag) > 0
        exponents = np.where(grow, -exponents, exponents)
        force = -mu / exponents
        rotation = exponents - force / self.stiffness
        direct = np.array([rotation[1], -rotation[0]]) / (2 * (rotation[0] * force[1] - rotation[1] * force[0]))
        return (direct @ np.exp(np.outer(exponents, self.distances)))[self.index]


class Plate:
    """Free-free Euler-Bernoulli beam over the span as a sum over modes, at places with signs."""

    def __init__(self, young, moment, density, area, places, signs):
        mass, xi = 0.5 * density * area, places / SPAN
        root = (np.arange(1, MODES + 1) + 0.5) * np.pi
        for _ in range(8):
            f = np.cos(root) - 1 / np.cosh(root)
            root = root - f / (-np.sin(root) + np.tanh(root) / np.cosh(root))
        e = np.exp(-root)
        rest = (-e - np.sin(root) + np.cos(root)) / ((1 - e**2) / 2 - np.sin(root) * e)
        sigma, x = 1 - rest * e, np.outer(xi, root)
        shapes = np.cos(x) - sigma * np.sin(x) + rest / 2 * np.exp(x - root) + (1 + sigma) / 2 * np.exp(-x)
        rigid = np.stack([np.ones_like(xi), np.sqrt(12) * (xi - 0.5)], axis=1)
        self.shapes = signs[:, None] * np.concatenate([rigid, shapes], axis=1) / np.sqrt(mass * SPAN)
        self.omega2 = np.concatenate([[0, 0], 0.5 * young * moment / mass * (root / SPAN) ** 4])

    def receptance(self, omega):
        """Receptance between all places, m/N, with the signs of both."""
        return (self.shapes / (self.omega2 * (1 + 0.1j) - omega**2)) @ self.shapes.T


def rail_on_supports():
    """Return a function of angular frequency: receptances at the middle of 241 supports."""
    x = 0.6 * np.arange(-120, 121)
    rail = Rail(2.1e11, 8.1e10, 3038.3e-8, 76.70e-4, 0.02, np.append(x, 0.0))
    k = np.full(241, 300e6 + 75e6j)

    def respond(omega):
        g = rail.receptance(omega)
        return finish(g[:-1, :-1], k, g[:-1, -1:], g[-1:, -1:])

    return respond


def viaduct():
    """Return a function of angular frequency: receptances at four wheels on the paper's line of 51 fasteners."""
    x = SPAN / 2 + 0.625 * np.arange(-25, 26)
    rail = Rail(2.1e11, 7.7e10, 3.217e-5, 7.745e-3, 0.01, np.append(x, SPAN / 2 + np.array([-10, -7.5, 7.5, 10])))
    # Order of the joints: pads, mortar, sliding layer, bearings; each body is one run of them.
    two, ends = np.concatenate([x, x]), np.concatenate([x, [0.0, SPAN]])
    below_above = np.repeat([-1.0, 1.0], 51)
    plates = [
        (slice(0, 102), Plate(3.6e10, 1.7e-3, 2500, 0.51, two, below_above)),
        (slice(51, 153), Plate(3.0e10, 7.3125e-3, 2500, 0.975, two, below_above)),
        (slice(102, 155), Plate(3.6e10, 11.056, 2650, 9.089, ends, np.append(-np.ones(51), [1.0, 1.0]))),
    ]
    laws = [6e7 * (1 + 0.12j), 0.5 / 51 * 3.79e11 * (1 + 0.2j), 0.5 / 51 * 2.1e11 * (1 + 0.2j)]
    k = np.append(np.repeat(laws, 51), 0.5 * 6e9 * (1 + 0.25j) * np.ones(2))

    def respond(omega):
        r = rail.receptance(omega)
        g = np.zeros((155, 155), complex)
        g[:51, :51] = r[:51, :51]
        for run, plate in plates:
            g[run, run] += plate.receptance(omega)
        by_loads = np.zeros((155, 4), complex)
        by_loads[:51] = r[:51, 51:]
        return finish(g, k, by_loads, r[51:, 51:])

    return respond


def finish(g, k, by_loads, direct):
    """Solve (I + K G) F = K d0 and take what the joints add off the direct receptances."""
    system = k[:, None] * g
    system.flat[:: len(k) + 1] += 1
    return direct - by_loads.T @ np.linalg.solve(system, k[:, None] * by_loads)


def numpy_side(line: str, n: int, repeat: int) -> dict[str, object]:
    """Least time of a sweep over `n` frequencies, as the Rust binary gives it."""
    respond = {"rail": rail_on_supports, "viaduct-modes": viaduct}[line]()
    omegas = 2 * np.pi * 3000 ** np.linspace(0, 1, n)
    least, answers = np.inf, []
    for _ in range(repeat + 1):
        start = time.perf_counter()
        answers = [respond(omega) for omega in omegas]
        least = min(least, time.perf_counter() - start)
    return {
        "line": line,
        "formulation": "receptance by numpy",
        "ms_per_frequency": 1e3 * least / n,
        "peak_memory_kib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
        "direct_m_per_N": [[a[0, 0].real, a[0, 0].imag] for a in answers],
    }


def run(*command: object) -> dict[str, object]:
    """What a process says."""
    done = subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


def difference(row: dict, other: dict) -> float:
    """Largest relative difference of two rows' answers."""
    a, b = (np.array(r["direct_m_per_N"]) @ [1, 1j] for r in (row, other))
    return float(np.max(np.abs(a - b) / np.abs(b)))


def main() -> None:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7, help="times all alternate (default: %(default)s)")
    parser.add_argument("--frequencies", type=int, default=20, help="from 1 to 3000 Hz (default: %(default)s)")
    parser.add_argument("--binary", type=Path, help="the Rust side, if already built")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "line.json", help="default: %(default)s")
    parser.add_argument("--one", choices=("rail", "viaduct-modes"), help="numpy's side of one line, as JSON")
    options = parser.parse_args()
    n, repeat = options.frequencies, 5
    if options.one:
        print(json.dumps(numpy_side(options.one, n, repeat)))
        return
    binary = options.binary or build("line")
    numpy_command = (sys.executable, __file__, "--frequencies", n, "--one")
    cases = [
        ("rail", "chain", (binary, "rail", "chain", n, "--repeat", 20)),
        ("rail", "receptance", (binary, "rail", "receptance", n, "--repeat", repeat)),
        ("rail", "numpy", (*numpy_command, "rail")),
        ("viaduct", "chain", (binary, "viaduct", "chain", n, "--repeat", 20)),
        ("viaduct", "receptance", (binary, "viaduct", "receptance", n, "--repeat", repeat)),
        ("viaduct, 60 modes", "receptance", (binary, "viaduct-modes", "receptance", n, "--repeat", repeat)),
        ("viaduct, 60 modes", "numpy", (*numpy_command, "viaduct-modes")),
    ]
    rounds = [[run(*command) for *_, command in cases] for _ in range(options.rounds)]
    print("| line | formulation | ms per frequency | peak memory, MiB | difference from the line's first row |")
    print("|------|-------------|-----------------:|-----------------:|------------------------------------:|")
    rows = []
    for i, (line, formulation, _) in enumerate(cases):
        ms = min(r[i]["ms_per_frequency"] for r in rounds)
        memory = max(r[i]["peak_memory_kib"] for r in rounds) / 1024
        first = next(j for j, case in enumerate(cases) if case[0] == line)
        off = difference(rounds[0][i], rounds[0][first])
        row = {"line": line, "formulation": formulation, "ms_per_frequency": ms, "peak_memory_MiB": memory}
        rows.append(row | {"difference": off})
        print(f"| {line} | {formulation} | {ms:.4f} | {memory:.1f} | {off:.1e} |")
    text = json.dumps({"machine": machine(), "rounds": options.rounds, "frequencies": n, "rows": rows}, indent=2)
    options.output.write_text(text + "\n")


if __name__ == "__main__":
    main()
