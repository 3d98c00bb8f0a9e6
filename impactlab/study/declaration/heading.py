"""What every study file begins with."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, StringConstraints

from impactlab.study.declaration.form import Form


def _printable(text: str) -> str:
    if not all(line.isprintable() for line in text.replace("\t", " ").split("\n")):
        raise ValueError("holds characters that cannot be printed: take them out")
    return text


def _one_line(text: str) -> str:
    if len(text.splitlines()) != 1:
        raise ValueError("must be one line of text; more goes to the key description")
    return text


Text = Annotated[
    str,
    StringConstraints(strict=True, strip_whitespace=True, max_length=2000),
    AfterValidator(_printable),
]


class Heading(Form):
    """Title and description, the head of the report."""

    title: Annotated[Text, StringConstraints(max_length=200), AfterValidator(_one_line)]
    description: Text = ""
