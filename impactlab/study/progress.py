"""The progress bar: runs done, runs a second, time left, failures."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar


class Progress:
    """A bar on the terminal's error stream, as a context; silent where there is no terminal."""

    def __init__(self, total: int, done: int) -> None:
        """total: runs of the study; done: those solved before."""
        self._failed = 0
        self._fresh = 0
        self._console = Console(stderr=True)
        self._bar = Bar(
            TextColumn("runs"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[failed]} failed"),
            console=self._console,
            disable=not self._console.is_terminal,
        )
        self._task: TaskID = self._bar.add_task(
            "runs", total=total, completed=done, failed=0, rate=""
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

    def advance(self, runs: int, failed: int) -> None:
        """Count this many more runs done, and how many of them failed."""
        self._failed += failed
        self._fresh += runs
        elapsed = self._bar.tasks[self._task].elapsed or 0.0
        rate = f"{self._fresh / elapsed:,.0f} runs/s" if elapsed > 0 else ""
        self._bar.update(self._task, advance=runs, failed=self._failed, rate=rate)
