"""How much there is of the diagnosis: `python benches/budget.py`.

Prints files, lines, numbers that module-level constants state, and the longest function of `permway.diagnosis`
(the catalogue apart) and `permway.posterior`.
"""

from __future__ import annotations

import ast
from pathlib import Path

import permway

ROOT = Path(permway.__file__).parent
Function = ast.FunctionDef | ast.AsyncFunctionDef


def numbers(tree: ast.Module) -> int:
    """Numbers within the module's assignments to names in capitals."""
    found = 0
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        names = [one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)]
        if names and all(name.isupper() for name in names):
            values = [one.value for one in ast.walk(node) if isinstance(one, ast.Constant)]
            found += sum(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return found


def main() -> None:
    """A line for each package."""
    for package in ("diagnosis", "posterior"):
        paths = [path for path in sorted((ROOT / package).rglob("*.py")) if "catalogue" not in path.parts]
        texts = {path: path.read_text("utf-8") for path in paths}
        trees = {path: ast.parse(text) for path, text in texts.items()}
        functions = [
            ((node.end_lineno or 0) - node.lineno + 1, f"{path.name}: {node.name}")
            for path, tree in trees.items()
            for node in ast.walk(tree)
            if isinstance(node, Function)
        ]
        lines = sum(len(text.splitlines()) for text in texts.values())
        constants = sum(numbers(tree) for tree in trees.values())
        print(f"{package}: {len(paths)} files, {lines} lines, {constants} constants, longest {max(functions)}")


if __name__ == "__main__":
    main()
