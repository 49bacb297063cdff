"""What Ctrl-C raises within a search."""

import signal
import threading
from contextlib import contextmanager

HELD = signal.SIGINT, signal.SIGTERM


@contextmanager
def hold_signals():
    """Within the block Ctrl-C and SIGTERM wait; they have their effect at its end.

    A KeyboardInterrupt within the import of Dr.Jit or Mitsuba is lost in native code, or ends the
    process. Blocking the signals of this thread would not do: another one would get them.
    """
    if threading.current_thread() is not threading.main_thread():  # only it may set handlers
        yield
        return
    received = []
    before = {number: signal.getsignal(number) for number in HELD}
    before = {number: h for number, h in before.items() if h is not None}  # not set by Python
    for number in before:
        signal.signal(number, lambda number, _frame: received.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in received[:1]:
            signal.raise_signal(number)


def give_back_interrupts():
    """Let Ctrl-C raise KeyboardInterrupt again, whatever native code has put into its place.

    Mitsuba, while it renders, has a handler of its own. It takes that for the one to be restored
    where the Python method `render` of an integrator calls that of its base class: afterwards
    Ctrl-C does nothing, or ends the process, as the handler calls an integrator that is gone.
    """
    handler = signal.getsignal(signal.SIGINT)
    if handler is not None and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, handler)


class Stopped(KeyboardInterrupt):
    """Ctrl-C ended a search; `best`: what it had come to."""

    def __init__(self, best):
        super().__init__("interrupted")
        self.best = best
