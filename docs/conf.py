"""How Sphinx builds the site: `docs/build`. Nothing is fetched, neither here nor by the pages."""

from __future__ import annotations

import sys
from pathlib import Path

from permway import __version__

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "permway"
author = "the permway authors"
project_copyright = "2026, the permway authors"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "breaks",
    "mathml",
    "docstrings",
    "effects_page",
    "homes",
    "outside",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
myst_dmath_double_inline = True
exclude_patterns = ["_build", "_extensions", "examples"]

math_number_all = False
math_numfig = True
math_eqref_format = "({number})"
numfig = True
html_math_renderer = "mathml"

napoleon_google_docstring = False
default_role = "literal"
# Words of types, as "channels", that are attributes of several records.
suppress_warnings = ["ref.python"]
napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
# What pydantic adds to every record states nothing of the record.
autodoc_default_options = {
    "members": True,
    "exclude-members": "model_config, model_fields, model_computed_fields, model_post_init",
}
autosummary_generate = False

html_theme = "furo"
html_title = f"permway {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
pygments_dark_style = "native"
