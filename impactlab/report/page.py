"""Pages from templates."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from impactlab.figures.files import replaced


def write_page(template: str, path: Path, **context: Any) -> None:
    """Render a template of this package into a file, whole or not at all.

    Raises OSError where the folder cannot be written.
    """
    text = _environment().get_template(template).render(context)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@cache
def _environment() -> Environment:
    """Every value is escaped; a misspelled name in a template is an error."""
    return Environment(
        loader=PackageLoader("impactlab.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
