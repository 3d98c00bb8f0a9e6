"""Progress bars: runs done, speed, time left, failures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.progress import Progress as Bar


class Progress:
    """A bar on the terminal's error stream, as a context; silent where there is no terminal."""

    def __init__(self, total: int, done: int, what: str = "runs") -> None:
        """Make a bar of `total` items, `done` of them before; what: the name of the items."""
        self._what = what
        self._failed = 0
        self._fresh = 0
        self._console = Console(stderr=True)
        self._bar = Bar(
            TextColumn(what),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[failed]} failed"),
            console=self._console,
            disable=not self._console.is_terminal,
        )
        self._task: TaskID = self._bar.add_task(
            what, total=total, completed=done, failed=0, rate=""
        )

    def __enter__(self) -> Progress:
        """Show the bar."""
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the bar, also on an error."""
        self._bar.stop()

    def advance(self, done: int, failed: int) -> None:
        """Count this many more done, and those of them that failed."""
        self._failed += failed
        self._fresh += done
        elapsed = self._bar.tasks[self._task].elapsed or 0.0
        speed = self._fresh / elapsed if elapsed > 0 else 0.0
        rate = f"{speed:,.0f} {self._what}/s" if speed >= 1 else ""
        self._bar.update(self._task, advance=done, failed=self._failed, rate=rate)


@contextmanager
def share_done(what: str) -> Iterator[Callable[[float], None]]:
    """Show a bar for one long run; the function that it gives takes the share done, 0 to 1.

    The bar is on the terminal's error stream, and silent where there is no terminal.
    """
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Bar(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda share: bar.update(task, completed=share)
