"""`recorded`: loops in one kernel, also while a picture is differentiated.

Mitsuba turns the recording of loops off then, because Dr.Jit goes backwards only through those of
which it knows the `max_iterations`. Each step of a march was a kernel of its own, a thousand for a
picture, and the whole some 10 times as slow.
"""

from functools import wraps

import drjit as dr


def recorded(function):
    """The same function, whose loops are recorded.

    Those that carry derivatives should have `max_iterations`, or `dr.backward` is an error; too few
    would give a wrong derivative, unsaid.
    """

    @wraps(function)
    def call(*args, **settings):
        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, True):
            return function(*args, **settings)

    return call
