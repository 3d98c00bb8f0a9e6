"""Progress bars on the terminal's error stream or in a notebook, silent elsewhere."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)


def _console() -> Console:
    """Return where bars are drawn: in notebooks as text, for which no widgets are needed."""
    notebook = Console().is_jupyter
    return Console(
        file=sys.stdout if notebook else sys.stderr,
        force_jupyter=False,
        force_terminal=notebook or None,
        width=100 if notebook else None,
    )


@contextmanager
def items_done(total: int, done: int, items: str) -> Iterator[Callable[[int, int], None]]:
    """Show a bar of `total` items, `done` of them before: their number, speed and failures.

    items: their name. The function that it gives counts so many more done, and those of
    them that failed.
    """
    console, failed, fresh = _console(), 0, 0
    columns = (
        TextColumn(items),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[failed]} failed"),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(items, total=total, completed=done, failed=0, rate="")

        def advance(more: int, failures: int) -> None:
            nonlocal failed, fresh
            failed, fresh = failed + failures, fresh + more
            elapsed = bar.tasks[task].elapsed or 0.0
            speed = fresh / elapsed if elapsed > 0 else 0.0
            rate = f"{speed:,.0f} {items}/s" if speed >= 1 else ""
            bar.update(task, advance=more, failed=failed, rate=rate)

        yield advance


@contextmanager
def share_done(title: str) -> Iterator[Callable[[float], None]]:
    """Show a bar for one long run; the function that it gives takes the share done, 0 to 1."""
    console = _console()
    columns = (TextColumn(title), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=1.0)
        yield lambda share: bar.update(task, completed=share)
