"""One check, made: what it raises is an outcome, too."""

from __future__ import annotations

import logging
import traceback
from time import perf_counter

from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Finding
from impactlab.verification.outcome import Outcome

log = logging.getLogger(__name__)


def run(name: str) -> Outcome:
    """Make a check of the catalogue. Whatever it raises becomes the outcome's reason."""
    file, start = CATALOGUE[name], perf_counter()
    finding, reason = Finding(()), ""
    try:
        finding = file.check()
    except Exception as error:
        reason = _words(error)
        log.debug("the check %s ended in an error", name, exc_info=True)
    return Outcome(name, file.TITLE, file.SOURCE, perf_counter() - start, finding, reason)


def _words(error: Exception) -> str:
    """An error with the innermost place that it came from."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    file = place.filename.replace("\\", "/").rpartition("/")[2]
    return f"{type(error).__name__}: {error} ({file}, line {place.lineno})"
