"""Keeps loops in one kernel while a picture is differentiated, and finds the first cause of errors.

While Mitsuba differentiates a picture it turns the recording of loops off, since Dr.Jit
differentiates backwards only through loops with known `max_iterations`. Then each step of a march
along rays becomes a kernel of its own, and a picture of a thousand steps takes ten times as long.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import ParamSpec, TypeVar

import drjit as dr

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def raise_first_cause() -> Iterator[None]:
    """Replace a RuntimeError of the block by the error that caused it first, such as a plugin's."""
    try:
        yield
    except RuntimeError as error:
        first: BaseException = error
        while isinstance(first, RuntimeError) and first.__cause__:
            first = first.__cause__
        raise first from None


def record_loops(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that Dr.Jit records its loops, each in one kernel.

    Loops that carry derivatives need `max_iterations`, or `dr.backward` raises an error; too small
    a number silently gives a wrong derivative.
    """

    @wraps(function)
    def call_with_recorded_loops(*args: P.args, **settings: P.kwargs) -> R:
        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, True):
            return function(*args, **settings)

    return call_with_recorded_loops
