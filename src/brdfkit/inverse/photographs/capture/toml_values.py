"""Values of a file capture.toml: each error names the file and the entry."""

import numpy as np

from brdfkit.core.errors import BrdfkitError

LARGEST = 1e30  # of a number: squares of lengths, and their sums, stay finite


def to_number(path, table, name, where):
    """The number `name` of a table."""
    value = table.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < LARGEST:
        raise BrdfkitError(f"{path}: {where} {name} = {value!r} should be a number below 1e30.")
    return float(value)


def to_numbers(path, value, what, shape):
    """An array of a `shape`, of lists of numbers."""
    shape = tuple(np.atleast_1d(shape))
    try:
        found = np.array(value)
    except ValueError:
        found = np.array("lists of different lengths")
    numbers = found.shape == shape and found.dtype.kind in "if"
    if not numbers or not (np.abs(found.astype(float)) < LARGEST).all():
        count = " × ".join(map(str, shape))
        raise BrdfkitError(f"{path}: {what} = {value!r} should be {count} numbers below 1e30.")
    return found.astype(float)


def require_known(path, table, known, where):
    """Raise `BrdfkitError` unless this is a table, whose entries are `known`."""
    if not isinstance(table, dict):
        raise BrdfkitError(f"{path}: {where} should be a table, of {', '.join(known)}.")
    for name in table:
        if name not in known:
            raise BrdfkitError(
                f"{path}: {where} has {name!r}, which is not known; known are {', '.join(known)}."
            )
