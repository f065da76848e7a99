"""A name of permway's is documented once, and found by the module it is defined in as well."""

from __future__ import annotations

from typing import Any

import permway
from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx


def _resolve(app: Sphinx, env: Any, node: pending_xref, content: nodes.Element) -> nodes.Element | None:
    target = str(node.get("reftarget", ""))
    home, _, name = target.rpartition(".")
    if node.get("refdomain") != "py" or not home.startswith("permway.") or name not in permway.__all__:
        return None
    found = env.get_domain("py").resolve_any_xref(
        env, node["refdoc"], app.builder, f"permway.{name}", node, content
    )
    return found[0][1] if found else None


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the resolution."""
    app.connect("missing-reference", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
