"""A real cluster whose scheduler and workers are processes of their own, to be killed and started anew."""

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

QUIET = {"DASK_LOGGING__DISTRIBUTED": "critical"}


class Cluster:
    """A scheduler and so many workers of one thread; whatever of it ends stays ended until it is started again."""

    def __init__(self, workers):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.workers = []
        self.start(workers)

    def _run(self, *words):
        path = os.pathsep.join([str(Path(__file__).parent), *filter(None, [os.environ.get("PYTHONPATH")])])
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *words, "--no-dashboard", "--host", "127.0.0.1"],
            env={**os.environ, **QUIET, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def start(self, workers):
        """A scheduler at the address, and workers that belong to it."""
        self.scheduler = self._run("scheduler", "--port", str(self.port))
        for _ in range(workers):
            self.add()

    def add(self):
        """One more worker, without the nanny that would start it again."""
        self.workers.append(self._run("worker", self.address, "--nthreads", "1", "--no-nanny"))

    def kill(self, process):
        process.send_signal(signal.SIGKILL)
        process.wait()

    def kill_worker(self, chance):
        """One of those that run, and another in its place."""
        self.kill(victim := chance.choice([w for w in self.workers if w.poll() is None]))
        self.workers.remove(victim)
        self.add()

    def stop(self):
        for process in (*self.workers, self.scheduler):
            if process.poll() is None:
                self.kill(process)
        self.workers = []
