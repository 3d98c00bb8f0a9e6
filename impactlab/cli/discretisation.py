"""The price of a study and its `auto` discretisation, as commands print them."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from impactlab.study.engine import Engine
    from impactlab.study.steps import AnyStudy, Price


def affordable(price: Price, workers: int, *, dry_run: bool, force: bool) -> bool:
    """Log what is implausible and return whether to go on; a dry run prints the price and does not.

    Raises StudyError where the study exceeds a limit, unless `force`.
    """
    from impactlab.report.console import print_estimate
    from impactlab.study.errors import StudyError

    for problem in price.implausible:
        logging.getLogger("impactlab").warning("%s", problem)
    if dry_run:
        print_estimate(price.cost, workers, price.free, price.exceeded)
    elif price.exceeded and not force:
        raise StudyError(*price.exceeded)
    return not dry_run


def with_discretisation(study: AnyStudy, folder: Path, engine: Engine) -> AnyStudy:
    """Return the study with its discretisation, found by pilot runs and printed where `auto`."""
    from impactlab.report.console import print_recommendation
    from impactlab.study import steps

    found = steps.find_resolution(study, folder, engine)
    if found is not None:
        print_recommendation(found)
    return steps.apply_resolution(study, found)
