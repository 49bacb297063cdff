"""`Background`: work in a thread of its own, which a page can follow and cancel."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.progress_bar import Progress
from brdfkit.viewing.application import Message

NAME = "brdfkit work for a page"  # of the threads
INTERVAL = 0.1  # seconds between two messages of the progress

T = TypeVar("T")


class Cancelled(BrdfkitError):
    """Ends work from within, at its next step."""


class Background(Generic[T]):
    """Work that a task of a session only waits for, in steps.

    `work` is called with a function that it is to call with (steps done, steps in all). `share` is
    the part of the steps that are done. In the end there is either a `result` or an `error`.
    """

    def __init__(self, work: Callable[[Progress], T]) -> None:
        self.work = work
        self.share = 0.0
        self.result: T | None = None
        self.error: Exception | None = None
        self._cancelled, self._finished = threading.Event(), threading.Event()

    def follow(self, describe: Callable[[], Message]) -> Iterator[list[Message]]:
        """Do the work; yields a message about its progress from time to time.

        If a session gives the task up, the work ends at its next step.
        """
        threading.Thread(target=self._run, name=NAME, daemon=True).start()
        try:
            while not self._finished.wait(INTERVAL):
                yield [describe()]
        finally:
            self._cancelled.set()

    def _run(self) -> None:
        """Do the work, and keep its result or its error."""
        try:
            self.result = self.work(self._report)
        except Exception as error:  # a page must hear of any
            self.error = error
        finally:
            self._finished.set()

    def _report(self, done: int, total: int) -> None:
        """Keep the progress of the work; end it if it was cancelled."""
        self.share = done / max(total, 1)
        if self._cancelled.is_set():
            raise Cancelled("It was cancelled.")
