"""`progress`: a bar that shows how far a long computation is, in a terminal and in a notebook."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from threading import Timer
from time import monotonic
from typing import TypeAlias

from brdfkit.core.errors import BrdfkitError

Progress: TypeAlias = Callable[[int, int], object]  # called with (steps done, steps in all)

DELAY = 1.0  # seconds before the bar appears, since a bar that only flashes up disturbs
SPEED_PERIOD = 3600.0  # seconds over which the speed is averaged: one fit may take minutes
INTERVAL = 0.1  # seconds between two updates of the bar in a notebook


def make_step_counter(function: Progress | None, total: int) -> Callable[[], None]:
    """Return a function that reports one more step, of about `total`, to a progress function."""
    done = 0

    def report_step() -> None:
        """Count a step, and report the number of steps so far."""
        nonlocal done
        done += 1
        if function:
            function(done, max(done, total))

    return report_step


@contextmanager
def progress(what: str) -> Iterator[Progress]:
    """Show a bar within the block for a function that takes long; it disappears with the block.

    In a notebook the bar is a line of HTML, which needs no widgets; otherwise it is drawn on
    standard error if that is a terminal.

    Parameters
    ----------
    what : str
        The name of the computation, in a word or two.

    Yields
    ------
    callable
        The function (done, total) to be passed as the argument ``progress``.

    Raises
    ------
    BrdfkitError
        Where `what` is not a text.

    Examples
    --------
    >>> with progress("ranking") as bar:    # doctest: +SKIP
    ...     ranking = rank("plaster", progress=bar)
    """
    if not isinstance(what, str):
        raise BrdfkitError(
            f"progress: what = {what!r} should be text, as in: with progress('fit') as bar."
        )
    with (_show_in_notebook if _is_in_notebook() else _show_in_terminal)(what) as bar:
        yield bar


def _is_in_notebook() -> bool:
    """Return whether this process is the kernel of a notebook."""
    shell = "IPython" in sys.modules and sys.modules["IPython"].get_ipython()
    return hasattr(shell, "kernel")


@contextmanager
def _show_in_notebook(what: str) -> Iterator[Callable[[int, int], object]]:
    """Show the bar as HTML below the current cell of a notebook."""
    from IPython.display import HTML, display

    handle, drawn = None, monotonic() + DELAY - INTERVAL

    def update_bar(done: int, total: int) -> None:
        nonlocal handle, drawn
        if monotonic() - drawn < INTERVAL:
            return
        drawn = monotonic()
        bar = HTML(
            f'<progress value="{done}" max="{total}"></progress> '
            f"{escape(what)}, {done:,} of {total:,}"
        )
        if handle:
            handle.update(bar)
        else:
            handle = display(bar, display_id=True)

    try:
        yield update_bar
    finally:
        if handle:
            handle.update({"text/plain": ""}, raw=True)


@contextmanager
def _show_in_terminal(what: str) -> Iterator[Callable[[int, int], object]]:
    """Show the bar on standard error, from a thread of its own.

    So the bar appears at once, even before the first call of the function that this yields.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    terminal = Console(stderr=True)
    text = TextColumn("{task.description}", markup=False)
    columns = text, BarColumn(), TimeRemainingColumn(compact=True)
    bar = Progress(*columns, console=terminal, transient=True, speed_estimate_period=SPEED_PERIOD)
    task = bar.add_task(what, total=None)
    timer = Timer(DELAY, bar.start)
    timer.daemon = True
    if terminal.is_terminal:
        timer.start()
    try:
        yield lambda done, total: bar.update(task, completed=done, total=total)
    finally:
        timer.cancel()
        if timer.ident:
            timer.join()
        if bar.live.is_started:  # stopping a bar that was not started prints an empty line
            bar.stop()
