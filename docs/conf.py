"""Sphinx configuration of the site: `make docs` builds it into site/."""

import os
import sys
from hashlib import sha256
from importlib import metadata
from pathlib import Path

from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent))
import made

project = "impactlab"
author = "impactlab developers"
copyright = "impactlab developers, BSD-3-Clause"
version = release = metadata.version("impactlab")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_design"]
exclude_patterns = ["gallery/_checks.md"]  # a part of verification.md
suppress_warnings = ["mystnb.unknown_mime_type"]  # of widgets, which have a plain form, too
default_role = "code"
highlight_language = "python"

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4

nb_execution_mode = "cache"
_root = Path(__file__).parents[1]  # executed again where the package is another one
_program = b"".join(path.read_bytes() for path in sorted(_root.glob("impactlab/**/*.py")))
nb_execution_cache_path = str(_root / "build" / "notebooks" / sha256(_program).hexdigest()[:16])
nb_execution_timeout = 240
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_merge_streams = True
os.environ["IMPACTLAB_DOCS"] = str(Path(__file__).parent)  # where notebooks find files of docs
os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_class_signature = "mixed"

html_theme = "furo"
html_title = f"impactlab {release}"
html_math_renderer = "mathml"
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]


def _mathml(visitor, node, display: bool) -> None:
    from docutils.nodes import SkipNode

    text = node.astext()
    if display and "\\\\" in text and "\\begin" not in text:
        text = rf"\begin{{aligned}}{text}\end{{aligned}}"
    visitor.body.append(tex2mathml(text, as_block=display))
    raise SkipNode


def setup(app: Sphinx) -> None:
    """Write pages from results first; equations become MathML, which needs no script."""
    app.add_html_math_renderer(
        "mathml",
        inline_renderers=(lambda visitor, node: _mathml(visitor, node, False), None),
        block_renderers=(lambda visitor, node: _mathml(visitor, node, True), None),
    )
    app.connect("builder-inited", lambda app: made.make())
