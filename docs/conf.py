"""Sphinx configuration. The package is read from the source tree; only its dependencies must be installed."""

import sys
from html import escape
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "docs" / "_ext")]

from equipoise import __version__  # noqa: E402 - from the source tree, which has to be on the path first

project = "equipoise"
author = "The equipoise developers"
release = version = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "executed"]
exclude_patterns = ["_build", "_generated"]
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


def _inline(self, node):
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(self, node):
    # aligned rows are a construct of their own to the converter, so nothing is wrapped around them
    formula = convert(node.astext(), display="block")
    self.body.append(f'<div class="formula" title="{escape(node.astext())}">{formula}</div>')
    raise nodes.SkipNode


def setup(app):
    """Formulas as MathML, made at build time: the usual renderer fetches a script when a page is read."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))


html_math_renderer = "mathml"
