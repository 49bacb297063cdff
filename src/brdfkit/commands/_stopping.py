"""Ends a command early on Ctrl-C, and on SIGTERM, which `kill` and batch systems send."""

import signal
import threading
from contextlib import contextmanager

_received = signal.SIGINT  # the signal that ended the command, if any did


@contextmanager
def stop_on_sigterm():
    """Within the block SIGTERM raises KeyboardInterrupt, as Ctrl-C does."""
    global _received
    _received = signal.SIGINT
    if threading.current_thread() is not threading.main_thread():  # only it gets signals
        yield
        return
    before = signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


def status():
    """The exit status of a command that ended early: 130 by Ctrl-C, 143 by SIGTERM."""
    return 128 + _received


def _terminate(number, _frame):
    global _received
    _received = number
    raise KeyboardInterrupt
