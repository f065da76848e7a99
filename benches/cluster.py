"""What a Dask cluster costs beside the work: `python benches/cluster.py`.

A study of small cases is swept by one and by two workers on this machine, each a process of its own. Processor
time of the client, of the scheduler and of the workers, for each case: what is of the client or the scheduler is
done in one place, and bounds how many workers are of use.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from pathlib import Path

from common import HERE

sys.path.insert(0, str(HERE.parent / "tests" / "study"))

from clusters import Cluster
from conftest import TOML
from permway.study import cluster, read_study, run_study

CASES = 200


def spent(pid: int) -> float:
    """Processor time of a process so far, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(workers: int, folder: Path) -> dict[str, float]:
    """Milliseconds of processor a case, by who spends them."""
    study = folder / "study.toml"
    study.write_text(TOML.replace("COUNT", str(CASES // 2)))
    started = Cluster(workers)
    try:
        # The first cases load what the workers need.
        run_study(read_study(study), folder / f"first-{workers}", scheduler=started.address)
        who = {"client": [os.getpid()], "scheduler": [started.scheduler.pid]}
        who["workers"] = [worker.pid for worker in started.workers]
        before = {name: sum(map(spent, pids)) for name, pids in who.items()}
        done = run_study(read_study(study), folder / f"then-{workers}", scheduler=started.address)
        assert not done.failed
        return {name: 1e3 * (sum(map(spent, pids)) - before[name]) / CASES for name, pids in who.items()}
    finally:
        started.stop()


def main() -> None:
    """Print a row for one and for two workers."""
    cluster.CONNECT_S = 60.0
    with tempfile.TemporaryDirectory() as place:
        for workers in (1, 2):
            print(json.dumps({"workers": workers, "ms_per_case": measured(workers, Path(place))}), flush=True)


if __name__ == "__main__":
    main()
