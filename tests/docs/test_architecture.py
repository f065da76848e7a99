"""What the page on the architecture states about imports and threads, by the code."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import permway
import pytest

ROOT = Path(permway.__file__).parent
PAGE = (Path(__file__).parents[2] / "docs" / "architecture.md").read_text("utf-8")
BASE = (
    "_core",
    "arrays",
    "errors",
    "files",
    "interrupt",
    "notebook",
    "reading",
    "records",
    "staged",
    "tables",
    "units",
)
LIBRARY = (
    "laws model response problem formats recordings campaign checking diagnosis posterior public report study"
)
USERS = ("paper", "challenge", "demo")
ORDER = {
    **dict.fromkeys((*BASE, "unit_grammar", "unit_symbols"), 0),
    **{name: 1 + index for index, name in enumerate(LIBRARY.split())},
    **dict.fromkeys(USERS, 50),
    **dict.fromkeys(("cli", "__main__"), 60),
    "__init__": 60,  # the names that `import permway` offers
}
"""Package or module, and its layer."""


def imported(path: Path) -> Iterator[str]:
    """First name below `permway` of every import of a file, wherever in it and for whatever purpose."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports are not followed"
            names = [alias.name for alias in node.names]
            modules = [f"permway.{n}" for n in names] if node.module == "permway" else [node.module or ""]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        else:
            continue
        found = [module.split(".") for module in modules]
        yield from ([*parts, "__init__"][1] for parts in found if parts[0] == "permway")


@pytest.mark.parametrize("package", sorted({p.relative_to(ROOT).parts[0] for p in ROOT.rglob("*.py")}))
def test_no_import_runs_upward(package: str) -> None:
    name = package.removesuffix(".py")
    files = [ROOT / package] if package.endswith(".py") else sorted((ROOT / package).rglob("*.py"))
    found = [(str(file.relative_to(ROOT)), of) for file in files for of in imported(file)]
    assert [(file, of) for file, of in found if ORDER[of] > ORDER[name]] == []


def test_the_order_is_that_of_the_page() -> None:
    chain = [name for name in LIBRARY.split() if name != "public"]
    assert ", ".join(f"`{name}`" for name in [*chain, "cli"]) in " ".join(PAGE.split())


def test_the_challenge_imports_errors_only() -> None:
    small = ROOT / "challenge" / "small"
    files = [p for p in (ROOT / "challenge").rglob("*.py") if small not in p.parents]
    assert {of for file in files for of in imported(file)} == {"challenge", "errors"}


THREADS = """
import os
import numpy as np
import permway
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.model.place import Place
from permway.response.receptance import receptance

def count():
    return len(os.listdir("/proc/self/task"))

before = count()
at = [Place(body="rail", x_m=16.0)]
line = slab_track_viaduct_32m(pad=wj7b_constant())
receptance(line, np.linspace(1.0, 100.0, 100), forces=at, sensors=at, threads=7)
print(before, count())
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted by Linux")
def test_no_thread_is_left_of_an_import_or_a_sweep() -> None:
    # Threads that other packages start at import are theirs: of NumPy, and of numexpr where it is installed.
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "NUMEXPR_NUM_THREADS": "1"}
    done = subprocess.run([sys.executable, "-c", THREADS], capture_output=True, text=True, check=True, env=env)
    assert done.stdout.split() == ["1", "1"]


def test_the_core_knows_no_python() -> None:
    manifest = Path(__file__).parents[2] / "rust" / "core" / "Cargo.toml"
    assert "pyo3" not in manifest.read_text("utf-8")
