"""`progress`: a bar for what takes long, in a terminal and in a notebook."""

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

PATIENCE = 1.0  # seconds until the bar shows: a bar that flashes up only disturbs
MEMORY = 3600.0  # seconds of which the time left is estimated: one fit of a sweep may take minutes
INTERVAL = 0.1  # seconds between two pictures of the bar in a notebook


@contextmanager
def progress(what: str) -> Iterator[Progress]:
    """A bar, for the block, of how far a verb is; it goes with the block.

    In a notebook it is a line of HTML, which needs no widgets; else it is drawn on standard error,
    where that is a terminal.

    Parameters
    ----------
    what : str
        What takes long, in a word or two.

    Yields
    ------
    callable
        The function (done, total) for the argument ``progress`` of a verb.

    Raises
    ------
    BrdfkitError
        Where `what` is no text.

    Examples
    --------
    >>> with progress("ranking") as bar:    # doctest: +SKIP
    ...     ranking = rank("plaster", progress=bar)
    """
    if not isinstance(what, str):
        raise BrdfkitError(
            f"progress: what = {what!r} should be text, as in: with progress('fit') as bar."
        )
    with (_show_in_notebook if _in_notebook() else _show_in_terminal)(what) as bar:
        yield bar


def _in_notebook():
    """Whether this process is the kernel of a notebook."""
    shell = "IPython" in sys.modules and sys.modules["IPython"].get_ipython()
    return hasattr(shell, "kernel")


@contextmanager
def _show_in_notebook(what):
    from IPython.display import HTML, display

    handle, drawn = None, monotonic() + PATIENCE - INTERVAL

    def show(done, total):
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
        yield show
    finally:
        if handle:
            handle.update({"text/plain": ""}, raw=True)


@contextmanager
def _show_in_terminal(what):
    """The bar appears from a thread of its own: also where its function is not called yet."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    terminal = Console(stderr=True)
    text = TextColumn("{task.description}", markup=False)
    columns = text, BarColumn(), TimeRemainingColumn(compact=True)
    bar = Progress(*columns, console=terminal, transient=True, speed_estimate_period=MEMORY)
    task = bar.add_task(what, total=None)
    patience = Timer(PATIENCE, bar.start)
    patience.daemon = True
    if terminal.is_terminal:
        patience.start()
    try:
        yield lambda done, total: bar.update(task, completed=done, total=total)
    finally:
        patience.cancel()
        if patience.ident:
            patience.join()
        if bar.live.is_started:  # stopping an unstarted bar prints an empty line
            bar.stop()
