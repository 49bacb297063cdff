"""What ends a command early: Ctrl-C, and SIGTERM, which `kill` and batch systems send."""

import signal
import threading
from contextlib import contextmanager

_received = signal.SIGINT  # the signal that ended the command, if any did


@contextmanager
def stoppable():
    """Within the block SIGTERM does what Ctrl-C does, and raises KeyboardInterrupt."""
    global _received
    _received = signal.SIGINT
    if threading.current_thread() is not threading.main_thread():  # which alone gets signals
        yield
        return
    before = signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


def status():
    """Exit status of a command that was ended early: 130 by Ctrl-C, 143 by SIGTERM."""
    return 128 + _received


def _terminate(number, _frame):
    global _received
    _received = number
    raise KeyboardInterrupt
