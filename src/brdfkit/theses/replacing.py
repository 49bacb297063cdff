"""Replaces a method in an experiment, and checks that the experiment really used it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def replace_part(owner: Any, name: str, part: Callable[..., Any] | None = None) -> Iterator[None]:
    """Replace the method `name` of the object `owner` within the block; it must be called there.

    Without `part`, the method stays the same, and only its use is checked. An experiment whose
    part is never called measures something else than it says, and its verdict means nothing.

    Raises
    ------
    AssertionError
        If the block ends without a call.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> lamp = SimpleNamespace(power=lambda: 1)
    >>> with replace_part(lamp, "power", lambda: 2):
    ...     lamp.power()
    2
    >>> lamp.power()
    1
    """
    used, is_own, before = False, name in vars(owner), getattr(owner, name)
    part = part or before

    def call(*arguments: Any, **settings: Any) -> Any:
        nonlocal used
        used = True
        return part(*arguments, **settings)

    setattr(owner, name, call)
    try:
        yield
    finally:
        if is_own:
            setattr(owner, name, before)
        else:
            delattr(owner, name)
    if not used:
        raise AssertionError(
            f"{type(owner).__name__}.{name} was replaced but never called: the experiment does not "
            "measure what it says."
        )
