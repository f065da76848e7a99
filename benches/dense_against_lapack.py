"""A dense complex system by faer's LU against LAPACK's zgetrf and zgetrs (scipy's OpenBLAS), one thread each.

The two alternate, round after round, and the least time of each counts, so that other work on the machine does not
decide. Both copy the matrix, factor it with partial pivoting and solve one right side.
"""

import argparse
import json
import os
import subprocess
import time
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from common import HERE, build, machine
from scipy.linalg import lapack

ORDERS = (100, 153, 200, 300, 500, 700, 1000)


def openblas_ms(n: int, repeat: int) -> tuple[float, float]:
    """Least time in ms of copying, factoring and solving a system of order `n`, and its residual."""
    random = np.random.default_rng(n)
    matrix = np.asfortranarray(random.uniform(-1, 1, (n, n)) + 1j * random.uniform(-1, 1, (n, n)))
    load = np.asfortranarray(random.uniform(-1, 1, (n, 1)) + 1j * random.uniform(-1, 1, (n, 1)))
    least, x = np.inf, load
    for _ in range(repeat + 1):
        start = time.perf_counter()
        factor, pivots, _ = lapack.zgetrf(matrix)
        x, _ = lapack.zgetrs(factor, pivots, load)
        least = min(least, time.perf_counter() - start)
    return 1e3 * least, float(np.abs(matrix @ x - load).max() / np.abs(load).max())


def faer_ms(binary: Path, n: int, repeat: int) -> dict[str, float]:
    """Least times in ms of the same by faer, memory taken anew and kept, and the residual."""
    command = [str(binary), str(n), "--repeat", str(repeat)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)[0]


def measure(binary: Path, n: int, rounds: int) -> dict[str, float]:
    """One row of the table: the least of all rounds."""
    # About a quarter of a second for each in every round.
    repeat = int(np.clip(5e9 / n**3, 5, 2000))
    blas, faer = [], []
    for _ in range(rounds):
        blas.append(openblas_ms(n, repeat))
        faer.append(faer_ms(binary, n, repeat))
    row = {"n": n, "openblas_ms": min(t for t, _ in blas)}
    row |= {f"faer_{kind}_ms": min(f[f"{kind}_ms"] for f in faer) for kind in ("fresh", "reused")}
    row |= {f"ratio_{kind}": row["openblas_ms"] / row[f"faer_{kind}_ms"] for kind in ("fresh", "reused")}
    gflop = (8 / 3 * n**3 + 8 * n**2) / 1e6
    row |= {"openblas_gflops": gflop / row["openblas_ms"], "faer_gflops": gflop / row["faer_reused_ms"]}
    return row | {"openblas_residual": max(r for _, r in blas), "faer_residual": max(f["residual"] for f in faer)}


def main() -> None:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("orders", type=int, nargs="*", default=ORDERS, metavar="ORDER")
    parser.add_argument("--rounds", type=int, default=7, help="times the two alternate (default: %(default)s)")
    parser.add_argument("--binary", type=Path, help="the faer side, if already built")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "dense.json", help="default: %(default)s")
    options = parser.parse_args()
    binary = options.binary or build("dense")
    print("|    n | OpenBLAS ms | faer ms, fresh | faer ms, reused | ratio fresh | ratio reused | faer Gflop/s |")
    print("|-----:|------------:|---------------:|----------------:|------------:|-------------:|-------------:|")
    rows = []
    for n in options.orders:
        row = measure(binary, n, options.rounds)
        rows.append(row)
        print(
            f"| {n:4} | {row['openblas_ms']:11.4f} | {row['faer_fresh_ms']:14.4f} | {row['faer_reused_ms']:15.4f} "
            f"| {row['ratio_fresh']:11.2f} | {row['ratio_reused']:12.2f} | {row['faer_gflops']:12.1f} |",
            flush=True,
        )
    text = json.dumps({"machine": machine(), "rounds": options.rounds, "rows": rows}, indent=2)
    options.output.write_text(text + "\n")


if __name__ == "__main__":
    main()
