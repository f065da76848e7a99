"""`permway doctor`: what permway runs with, and whether it works here."""

from __future__ import annotations

import os
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import Any

PACKAGES = (
    *("numpy", "scipy", "xarray", "h5py", "h5netcdf", "pydantic", "typer", "matplotlib", "plotly", "nptdms"),
    "distributed",
)
CLOSE = 1e-12
"""Relative error of the core's answer for a mass on a spring."""


def account() -> dict[str, Any]:
    """Machine, threads, vector instructions, versions, and the core's answer compared with a closed form."""
    import h5py

    from permway import _core

    return {
        "permway": _core.__version__,
        "python": platform.python_version(),
        "executable": sys.executable,
        "machine": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "processors": os.cpu_count(),
        "threads": _core_threads(),
        "vectors": _core.vectors,
        "memory_GiB": _memory_GiB(),
        **{name: _version(name) for name in PACKAGES},
        "hdf5": h5py.version.hdf5_version,
        "self_test": "passed" if _answers() else "failed: the core's answer for a mass on a spring is wrong",
    }


def _core_threads() -> int:
    """Threads that a command takes where none are asked for."""
    return os.cpu_count() or 1


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((line.partition(":")[2].strip() for line in file if line.startswith("model name")), "")
    except OSError:
        return platform.processor()


def _memory_GiB() -> float | None:
    try:
        return round(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30, 1)
    except (AttributeError, ValueError, OSError):
        return None


def _answers() -> bool:
    import numpy as np

    from permway.laws import Hysteretic
    from permway.model.bodies import Mass
    from permway.model.joints import Joints
    from permway.model.line import Line
    from permway.model.place import Place
    from permway.response.receptance import receptance

    line = Line(
        bodies={"block": Mass(mass_kg=100.0)},
        joints=(Joints(between=("block", "ground"), law="spring", at=(0.0,)),),
        laws={"spring": Hysteretic(stiffness=1e6, loss_factor=0.1)},
    )
    frequency = np.array([1.0, 15.0, 200.0])
    here = [Place(body="block", x_m=0.0)]
    got = receptance(line, frequency, forces=here, sensors=here, threads=1).receptance.values[:, 0, 0]
    right = 1.0 / (1e6 * (1.0 + 0.1j) - 100.0 * (2.0 * np.pi * frequency) ** 2)
    return bool(np.all(np.abs(got / right - 1.0) < CLOSE))
