"""`first_error`: what is raised within a loop of Dr.Jit's leaves it as it was.

Dr.Jit raises a RuntimeError "see above" in the place of any error, a sentence for people and Ctrl-C
among them.
"""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def first_error() -> Iterator[None]:
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
