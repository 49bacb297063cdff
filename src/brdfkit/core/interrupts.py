"""Handles Ctrl-C and SIGTERM, the signal that `kill` and batch systems send to end a program.

A search that Ctrl-C ends raises `Interrupted` with its best result so far. A command turns both
signals into KeyboardInterrupt by `stop_on_signals`. `delay_signals` delays both while native code
runs that they could crash.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

SIGNALS = signal.SIGINT, signal.SIGTERM
_received: int | None = None  # the number of the signal that ended the command


class Interrupted(KeyboardInterrupt):
    """The error that Ctrl-C raises in a fit or a search, with the best result so far.

    It ends loops and programs like any KeyboardInterrupt. In an interactive session the result is
    then in ``sys.last_value.best``.

    Attributes
    ----------
    best : object
        The best result so far: of `brdfkit.fit` the `Fit`, of `refine` the `Refinement`, of
        `svbrdf` the `Svbrdf`. Inner searches hand their own kind of result up to these functions.
    """

    def __init__(self, best: Any, message: str = "interrupted") -> None:
        super().__init__(message)
        self.best = best


@contextmanager
def stop_on_signals() -> Iterator[None]:
    """Let Ctrl-C and SIGTERM raise KeyboardInterrupt within the block.

    A command that the shell runs in the background still ignores Ctrl-C.
    """
    global _received
    _received = None
    # Only the main thread gets signals
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, _raise_interrupt)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def is_stopped_by_signal() -> bool:
    """Return whether a signal ended the command; native code may then raise any other error."""
    return _received is not None


def find_exit_status() -> int:
    """Return the exit status of a command that a signal ended: 130 by Ctrl-C, 143 by SIGTERM."""
    # After a Ctrl-C within exec, which dataclasses use, Python would kill itself by the signal and
    # give no exit status; another exec makes it forget that
    exec("")
    return 128 + (_received or signal.SIGINT)


def _raise_interrupt(number: int, _frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, and keep the number of the signal for the exit status."""
    global _received
    _received = number
    raise KeyboardInterrupt


def is_interrupt(error: BaseException | None) -> bool:
    """Return whether Ctrl-C is the cause of an error, which native code may turn into another."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False


@contextmanager
def delay_signals() -> Iterator[None]:
    """Delay Ctrl-C and SIGTERM to the end of the block, where they have their usual effect.

    A KeyboardInterrupt within the import of Dr.Jit or Mitsuba is lost in native code, or ends the
    process. Blocking the signals of this thread would not help: another thread would get them.
    """
    # Only the main thread may set handlers
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    received: list[int] = []
    # `getsignal` returns None for a handler that native code has set; such a handler stays
    handlers = ((number, signal.getsignal(number)) for number in SIGNALS)
    before = {number: handler for number, handler in handlers if handler is not None}
    for number in before:
        signal.signal(number, lambda number, _frame: received.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if received:
            signal.raise_signal(received[0])


def restore_interrupt_handler() -> None:
    """Let Ctrl-C raise KeyboardInterrupt again after native code replaced Python's handler.

    Mitsuba sets a handler of its own while it renders. Where the Python method `render` of an
    integrator calls that of its base class, Mitsuba takes its own handler for the one to restore:
    afterwards Ctrl-C does nothing, or ends the process, as the handler calls an integrator that no
    longer exists.
    """
    handler = signal.getsignal(signal.SIGINT)
    if handler is not None and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, handler)
