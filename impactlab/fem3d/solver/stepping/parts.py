"""Work cut into parts, one a thread; who does which part changes no bit of the results."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any


class Parts:
    """Runs compiled functions over ranges of numbers, on `threads` threads (one is the caller's).

    Use it as a context: it ends its threads.
    """

    def __init__(self, threads: int) -> None:
        """With that many threads, at least 1."""
        self.threads = threads
        self._pool = ThreadPoolExecutor(max(threads - 1, 1))

    def __enter__(self) -> Parts:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    def run(self, work: Callable[[int], Any]) -> None:
        """Call work(part) for every part from 0 to threads - 1, and wait for all."""
        others = [self._pool.submit(work, part) for part in range(1, self.threads)]
        work(0)
        for other in others:
            other.result()

    def share(self, part: int, count: int) -> tuple[int, int]:
        """The first and the one past the last of `count` numbers that are this part's."""
        return count * part // self.threads, count * (part + 1) // self.threads
