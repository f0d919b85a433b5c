"""Sphinx configuration. The package is read from the source tree; only its dependencies must be installed."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "src"))

from equipoise import __version__  # noqa: E402 - from the source tree, which has to be on the path first

project = "equipoise"
author = "The equipoise developers"
release = version = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_build"]
default_role = "code"  # `name` in a docstring is code

myst_enable_extensions = ["amsmath", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True  # attributes are described once, in their class

html_theme = "furo"
html_title = f"equipoise {release}"
html_show_copyright = False
html_copy_source = False
