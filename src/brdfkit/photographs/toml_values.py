"""Values of a file capture.toml: each error names the file and the entry."""

import numpy as np

from brdfkit.errors import BrdfkitError


def to_number(path, table, name, where):
    """The number `name` of a table."""
    value = table.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise BrdfkitError(f"{path}: {where} {name} = {value!r} should be a number.")
    return float(value)


def to_numbers(path, value, what, shape):
    """An array of a `shape`, of lists of numbers."""
    shape = tuple(np.atleast_1d(shape))
    try:
        found = np.array(value)
    except ValueError:
        found = np.array("lists of different lengths")
    if found.shape != shape or found.dtype.kind not in "if" or not np.isfinite(found).all():
        count = " × ".join(map(str, shape))
        raise BrdfkitError(f"{path}: {what} = {value!r} should be {count} numbers.")
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
