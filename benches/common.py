"""What the comparisons share: the Rust binaries, the machine."""

import ctypes
import json
import os
import platform
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent


def build(name: str) -> Path:
    """Build a binary of the benches; its path."""
    command = ["cargo", "build", "--release", "-p", "permway-benches", "--bin", name, "--message-format", "json"]
    done = subprocess.run(command, cwd=HERE.parent, check=True, stdout=subprocess.PIPE, text=True)
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable") and message["target"]["name"] == name:
            return Path(message["executable"])
    raise SystemExit(f"cargo built no binary called {name}")


def rustc() -> str:
    """Version of the compiler."""
    return subprocess.run(["rustc", "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout.split()[1]


def processor() -> dict[str, object]:
    """Processor, cores and load, without any package."""
    model, flags = platform.processor(), []
    info = Path("/proc/cpuinfo")
    if info.exists():
        pairs = (line.split(":", 1) for line in info.read_text().splitlines() if ":" in line)
        fields = {key.strip(): value.strip() for key, value in pairs}
        model = fields.get("model name", model)
        flags = [f for f in ("avx2", "fma", "avx512f") if f in fields.get("flags", "").split()]
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "instructions": flags,
        "system": platform.system(),
        "load_average": [round(load, 2) for load in os.getloadavg()],
    }


def _kernel() -> str | None:
    """Name of the processor whose kernels scipy's OpenBLAS chose; None where it cannot be asked."""
    maps = Path("/proc/self/maps")
    if not maps.exists():
        return None
    for path in {line.split()[-1] for line in maps.read_text().splitlines() if "libscipy_openblas-" in line}:
        corename = getattr(ctypes.CDLL(path), "scipy_openblas_get_corename", None)
        if corename is not None:
            corename.restype = ctypes.c_char_p
            return corename().decode()
    return None


def machine() -> dict[str, object]:
    """Processor and versions."""
    import scipy.linalg

    lock = (HERE.parent / "Cargo.lock").read_text().split("[[package]]")
    faer = next(part for part in lock if 'name = "faer"' in part).split('version = "')[1].split('"')[0]
    blas = scipy.show_config(mode="dicts")["Build Dependencies"]["lapack"]
    return processor() | {
        "python": platform.python_version(),
        "scipy": scipy.__version__,
        "lapack": f"{blas['name']} {blas['version']}",
        "lapack_kernels": _kernel(),
        "faer": faer,
        "rustc": rustc(),
    }
