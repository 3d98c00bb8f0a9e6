"""A verification as its file declares it: which checks of the solver are made."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated

from pydantic import ValidationError, create_model

from impactlab.study.declaration import messages
from impactlab.study.declaration.form import names
from impactlab.study.declaration.heading import Heading
from impactlab.study.declaration.reading import Source
from impactlab.study.errors import StudyError


@dataclass(frozen=True)
class Verification:
    """Which checks to make and why.

    name: the file's, without the ending; path: as it was given. checks: names out of
    verification.catalogue, in the file's order. text: the file as it was read.
    """

    name: str
    path: Path
    title: str
    description: str
    checks: tuple[str, ...]
    text: str

    @property
    def size(self) -> str:
        """How much there is to do, in words."""
        return f"{len(self.checks)} check{'s' * (len(self.checks) > 1)}"

    @property
    def sha256(self) -> str:
        """The SHA-256 of the text, in hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()


def verification(source: Source) -> Verification:
    """The verification that a file declares. Raises StudyError that holds all that is wrong."""
    keys: dict[int, tuple[str, ...]] = {}
    try:
        form = _form().model_validate(source.data, context=keys)
    except ValidationError as error:
        problems = messages.problems(error, source.data, str(source.path), keys)
        raise StudyError(*problems) from None
    stated = form.model_dump()
    return Verification(name=source.name, path=source.path, text=source.text, **stated)


@cache
def _form() -> type[Heading]:
    from impactlab.verification.catalogue import CATALOGUE  # late: brings all independent solutions

    checks = Annotated[tuple[str, ...], names("check", CATALOGUE)]
    return create_model("VerificationForm", __base__=Heading, checks=(checks, ...))
