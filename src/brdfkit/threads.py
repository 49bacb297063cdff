"""One thread at a time in Mitsuba and Dr.Jit.

A thread that waits for a kernel of Dr.Jit 1.5 helps with the kernels of all threads, and now and
then with one that is gone: the process ends. So whatever runs kernels does it in turn, and brdfkit
can be used from any thread. A kernel runs on all cores anyway.
"""

import functools
import threading

TURN = threading.RLock()  # what has its turn may call what takes one


def in_turn(function):
    """`function`, which runs kernels, in one thread at a time."""

    @functools.wraps(function)
    def waiting(*args, **kwargs):
        with TURN:
            return function(*args, **kwargs)

    return waiting


class cached_in_turn(functools.cached_property):
    """A `cached_property` whose function runs kernels.

    The turn comes first: Python 3.11 has a lock of its own for every cached property, and two
    locks that two threads take in different orders are never released.
    """

    def __get__(self, instance, owner=None):
        with TURN:
            return super().__get__(instance, owner)
