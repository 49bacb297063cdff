"""Lets one thread at a time into Mitsuba and Dr.Jit.

In Dr.Jit 1.5 a thread that waits for a kernel also works on the kernels of other threads, and
sometimes on one that is already freed, which crashes the process. So all functions that run kernels
take turns by one lock, and brdfkit can be used from any thread. A kernel runs on all cores anyway.
"""

import functools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

TURN = threading.RLock()  # re-entrant, since a function that holds it may call another one


def in_turn(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function that runs kernels, so that one thread at a time calls any of them."""

    @functools.wraps(function)
    def call_in_turn(*args: P.args, **kwargs: P.kwargs) -> R:
        with TURN:
            return function(*args, **kwargs)

    return call_in_turn


class cached_in_turn(functools.cached_property[R]):
    """A `cached_property` whose function runs kernels.

    The lock of `in_turn` is taken first. Python 3.11 has a lock of its own for every cached
    property, and two threads that take two locks in different orders would wait for each other for
    ever.
    """

    def __get__(self, instance: object, owner: type[Any] | None = None) -> Any:
        with TURN:
            return super().__get__(instance, owner)


@in_turn
def set_thread_count(count: int) -> None:
    """Run the kernels of this process in `count` threads, since other processes run beside it."""
    import drjit as dr

    dr.set_thread_count(count)


@contextmanager
def use_one_thread() -> Iterator[None]:
    """Run the kernels of the block in the calling thread alone, to measure their CPU time.

    Other threads of Dr.Jit use the processor while they wait, and CPU time counts that, too.
    """
    import drjit as dr

    count = dr.thread_count()
    dr.set_thread_count(0)
    try:
        yield
    finally:
        dr.set_thread_count(count)


@contextmanager
def use_two_threads() -> Iterator[None]:
    """Run the kernels of the block in at least two threads.

    In one thread alone Mitsuba 3.9 waits for ever for the pixels of an OpenEXR file, read or
    written.
    """
    import drjit as dr

    count = dr.thread_count()
    if count < 2:
        dr.set_thread_count(2)
    try:
        yield
    finally:
        if count < 2:
            dr.set_thread_count(count)
