"""Checks arguments of public functions: a wrong value raises an error that names the argument.

Each `to_…` function takes `what`, the argument's name in the error, and the value that a user gave;
it returns the value in the type that the caller works with.
"""

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeGuard

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError

LONGEST = 80  # the most characters of a value that an error message shows


def wrong_value_error(what: str, value: object, expected: str) -> BrdfkitError:
    """Return the error for an argument whose value is not as `expected`.

    >>> wrong_value_error("spp", -3, "a whole number, at least 1")
    BrdfkitError('spp = -3 should be a whole number, at least 1.')
    """
    text = " ".join(repr(value).split())
    short = text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
    return BrdfkitError(f"{what} = {short} should be {expected}.")


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a finite real number of Python or NumPy; True and False are not."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number that is larger than any float
        return False


def describe_range(
    noun: str, least: float | None, most: float | None = None, above: float | None = None
) -> str:
    """Return a noun with the range in which a value should lie, for an error message.

    `least` and `most` are allowed values, `above` is not; an infinite `most` is no limit.

    >>> describe_range("a number", 0, 1), describe_range("a whole number", 2)
    ('a number between 0 and 1', 'a whole number, at least 2')
    """
    upper = None if most is None or math.isinf(most) else f"{most:g}"
    if least is not None and upper:
        return f"{noun} between {least:g} and {upper}"
    lower = f" above {above:g}" if above is not None else ""
    lower = f", at least {least:g}" if least is not None else lower
    return noun + lower + (f", at most {upper}" if upper else "")


def to_number(
    what: str,
    value: object,
    least: float | None = None,
    most: float | None = None,
    *,
    above: float | None = None,
) -> float:
    """Check that the argument `what` is in [`least`, `most`], or above `above`; return a float."""
    if is_number(value):
        number = float(value)
        low = (least is None or number >= least) and (above is None or number > above)
        if low and (most is None or number <= most):
            return number
    raise wrong_value_error(what, value, describe_range("a number", least, most, above))


def to_positive_number(what: str, value: object) -> float:
    """Check that the argument `what` is a finite number above 0; return it as a float."""
    return to_number(what, value, above=0)


def to_whole_number(
    what: str, value: object, least: int | None = None, most: int | None = None
) -> int:
    """Check that the argument `what` is an integer from `least` to `most`; return it as an int."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool):
        number = int(value)
        if (least is None or number >= least) and (most is None or number <= most):
            return number
    raise wrong_value_error(what, value, describe_range("a whole number", least, most))


def to_number_pair(what: str, value: Any) -> tuple[float, float]:
    """Check that the argument `what` is a pair (low, high) of numbers; return two floats."""
    try:
        low, high = map(float, value)
    except (TypeError, ValueError):
        raise wrong_value_error(what, value, "two numbers, (low, high)") from None
    return low, high


def to_dictionary(what: str, value: Any) -> dict[str, Any]:
    """Check that the argument `what` is a mapping by names; return a dictionary, empty for None."""
    if not isinstance(value, Mapping | None):
        raise wrong_value_error(what, value, "a dictionary by the names of parameters")
    return dict(value or {})


def to_array(what: str, value: Any, shape: tuple[int, ...] | None = None) -> FloatArray:
    """Check that the argument `what` is an array or nested lists of numbers; return an array.

    An array of floats is not copied. Where a `shape` is given, the array must have it, and all of
    its numbers must be finite.
    """
    try:
        array: AnyArray = np.asarray(value)
        if array.dtype not in (np.float32, np.float64):
            array = array.astype(float)
    except (TypeError, ValueError):
        raise BrdfkitError(f"{what}: they should be numbers, in lists of one length.") from None
    if shape is not None and array.shape != shape:
        raise BrdfkitError(f"{what}: their shape {array.shape} should be {shape}.")
    if shape is not None and not np.isfinite(array).all():
        raise BrdfkitError(f"{what}: they should be finite numbers.")
    return array


def check_number_fields(solver: Any) -> None:
    """Check that the fields of a solver, a frozen dataclass, are numbers above 0.

    A field whose default is an integer must be one. Afterwards all are plain ints and floats.
    """
    for field in fields(solver):
        what, value = f"{type(solver).__name__}: {field.name}", getattr(solver, field.name)
        whole = isinstance(field.default, int)
        checked = to_whole_number(what, value, 1) if whole else to_positive_number(what, value)
        object.__setattr__(solver, field.name, checked)
