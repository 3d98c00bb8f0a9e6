"""Sphinx configuration of the site: `make docs` builds it into site/."""

import os
import re
import sys
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree

from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent))
import made

project = "impactlab"
author = "impactlab developers"
copyright = "impactlab developers, BSD-3-Clause"
version = release = metadata.version("impactlab")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
]
exclude_patterns = ["gallery/_*.md"]  # parts of other pages
suppress_warnings = ["mystnb.unknown_mime_type"]  # of widgets, which have a plain form, too
default_role = "py:obj"  # names of docstrings become links, all else is set as code
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
autodoc_preserve_defaults = True  # the number of cores is that of each machine
autodoc_typehints = "none"
autodoc_class_signature = "mixed"
napoleon_google_docstring = False
napoleon_preprocess_types = True
napoleon_use_ivar = True
napoleon_use_rtype = False
napoleon_type_aliases = {
    name: f":py:obj:`{name} <impactlab.{module}.{name}>`"
    for name, module in {
        "Estimate": "study.estimate",
        "Problem": "study.errors",
        "Quantity": "model.quantities",
        "Section": "model.cross_section",
        "Status": "study.runs",
        "Surrogate": "analysis.surrogate.stored",
    }.items()
}

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
    visitor.body.append(_subscripts_beside(tex2mathml(text, as_block=display)))
    raise SkipNode


def _subscripts_beside(mathml: str) -> str:
    """Return MathML in which the subscript of an accented letter stands beside it, not beneath."""
    namespace = "http://www.w3.org/1998/Math/MathML"
    ElementTree.register_namespace("", namespace)
    root = ElementTree.fromstring(mathml.replace("&ApplyFunction;", "\N{FUNCTION APPLICATION}"))
    for scripted in root.iter(f"{{{namespace}}}munderover"):
        base, subscript, accent = scripted
        if accent.get("stretchy") == "false":
            accented = ElementTree.Element(f"{{{namespace}}}mover", accent="true")
            accented.extend([base, accent])
            scripted.tag = f"{{{namespace}}}msub"
            scripted[:] = [accented, subscript]
    return ElementTree.tostring(root, encoding="unicode")


def _link(app: Sphinx, what: str, name: str, thing, options, lines: list[str]) -> None:
    """Let names such as `il.simulate` lead to their entries."""
    lines[:] = [re.sub(r"`il\.([\w.]+)`", r"`il.\1 <impactlab.\1>`", line) for line in lines]


def _download(app: Sphinx, doctree) -> None:
    """Begin each tutorial with a link to its executed notebook."""
    from docutils.nodes import paragraph, section
    from sphinx.addnodes import download_reference

    name = app.env.docname
    notebook = Path(app.env.mystnb_config.output_folder, f"{name}.ipynb")
    if name.startswith("tutorials/") and notebook.exists():
        target = f"/{os.path.relpath(notebook, app.srcdir)}"
        link = download_reference("", "Download this page as a notebook", reftarget=target)
        doctree.next_node(section).insert(1, paragraph("", "", link))


def setup(app: Sphinx) -> dict[str, bool]:
    """Write pages from results first; equations become MathML, which needs no script."""
    app.add_html_math_renderer(
        "mathml",
        inline_renderers=(lambda visitor, node: _mathml(visitor, node, False), None),
        block_renderers=(lambda visitor, node: _mathml(visitor, node, True), None),
    )
    app.connect("autodoc-process-docstring", _link)
    app.connect("builder-inited", lambda app: made.make())
    app.connect("doctree-read", _download, priority=400)  # before Sphinx collects downloads
    return {"parallel_read_safe": True, "parallel_write_safe": True}
