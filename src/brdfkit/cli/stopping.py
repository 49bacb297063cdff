"""Ends a command early on Ctrl-C, and on SIGTERM, which `kill` and batch systems send."""

import signal
import threading
from contextlib import contextmanager

SIGNALS = signal.SIGINT, signal.SIGTERM
_received = None  # the signal that ends the command, if any does


@contextmanager
def stop_on_signals():
    """Within the block Ctrl-C and SIGTERM raise KeyboardInterrupt, and `is_stopped` knows of it.

    A Ctrl-C that the shell has the command ignore, in the background, stays ignored.
    """
    global _received
    _received = None
    if threading.current_thread() is not threading.main_thread():  # only it gets signals
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, _stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def is_stopped():
    """Whether a signal ended the command: native code may make another error of it."""
    return _received is not None


def status():
    """The exit status of a command that ended early: 130 by Ctrl-C, 143 by SIGTERM."""
    # Python ends by the signal itself, and no status, where Ctrl-C came within exec, as in making a
    # dataclass, until the next exec
    exec("")
    return 128 + (_received or signal.SIGINT)


def _stop(number, _frame):
    global _received
    _received = number
    raise KeyboardInterrupt
