"""One thread at a time in Mitsuba and Dr.Jit.

A thread that waits for a kernel of Dr.Jit 1.5 helps with the kernels of all threads, and now and
then with one that is gone: the process ends. So whatever runs kernels does it in turn, and brdfkit
can be used from any thread. A kernel runs on all cores anyway.
"""

import functools
import threading
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

TURN = threading.RLock()  # what has its turn may call what takes one


def in_turn(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, which runs kernels, in one thread at a time."""

    @functools.wraps(function)
    def waiting(*args: P.args, **kwargs: P.kwargs) -> R:
        with TURN:
            return function(*args, **kwargs)

    return waiting


class cached_in_turn(functools.cached_property[R]):
    """A `cached_property` whose function runs kernels.

    The turn comes first: Python 3.11 has a lock of its own for every cached property, and two
    locks that two threads take in different orders are never released.
    """

    def __get__(self, instance: object, owner: type[Any] | None = None) -> Any:
        with TURN:
            return super().__get__(instance, owner)
