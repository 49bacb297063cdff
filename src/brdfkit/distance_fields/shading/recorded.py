"""`recorded`: loops without derivatives in one kernel, also while a picture is differentiated.

Mitsuba turns the recording of loops off then, because it cannot differentiate recorded ones. Each
step of a march was a kernel of its own, a thousand for a picture, and the whole some 10 times as
slow.
"""

from functools import wraps

import drjit as dr


def recorded(function):
    """The same function, whose loops are recorded; they must carry no derivatives."""

    @wraps(function)
    def call(*args, **settings):
        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, True):
            return function(*args, **settings)

    return call
