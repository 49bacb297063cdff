"""`record_loops`: loops in one kernel, also while a picture is differentiated.

Mitsuba turns the recording of loops off then, because Dr.Jit goes backwards only through those of
which it knows the `max_iterations`. Each step of a march was a kernel of its own, a thousand for a
picture, and the whole some 10 times as slow.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import wraps

import drjit as dr


@contextmanager
def raise_first_cause() -> Iterator[None]:
    """Within the block, a RuntimeError that another error caused gives way to the first of them."""
    try:
        yield
    except RuntimeError as error:
        first: BaseException = error
        while isinstance(first, RuntimeError) and first.__cause__:
            first = first.__cause__
        raise first from None


def is_interrupt(error: BaseException | None) -> bool:
    """Whether Ctrl-C is the error, or caused it."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def record_loops(function):
    """The same function, whose loops are recorded.

    Those that carry derivatives should have `max_iterations`, or `dr.backward` is an error; too few
    would give a wrong derivative, unsaid.
    """

    @wraps(function)
    def call(*args, **settings):
        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, True):
            return function(*args, **settings)

    return call
