"""Times what a diagnosis does thousands of times: `python benches/evaluation.py CAMPAIGN.toml`.

Least processor time of several, ms, on one thread. To compare two states run it with the
Python of each in turns.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from permway.campaign.campaign import read_campaign
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.tangent import Problem
from permway.diagnosis.whitener import Whitener

REPEATS = 7


def least_ms(work: Callable[[], object]) -> float:
    """Of several times."""
    found = []
    for _ in range(REPEATS):
        start = time.process_time()
        work()
        found.append(time.process_time() - start)
    return 1e3 * min(found)


def main() -> None:
    """Prints one line a part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign", type=Path)
    campaign = read_campaign(parser.parse_args().campaign)
    observations = gather(campaign, predictable(campaign).kept, threads=1)
    free = free_parameters(campaign)
    problem = Problem(observations, campaign.with_values, free)
    state = problem.at(np.zeros(len(free)))
    assert state is not None
    parts: dict[str, Callable[[], object]] = {
        "all records predicted": lambda: observations.predicted(campaign),
        "calibration errors taken out": lambda: observations.whitener.reduce(state.residuals),
        "their factors": lambda: Whitener.of(observations.columns, observations.sizes, observations.length),
        f"slopes by {len(free)} parameters": lambda: problem.jacobian(state),
    }
    for name, work in parts.items():
        print(f"{name:28s} {least_ms(work):9.2f} ms")


if __name__ == "__main__":
    main()
