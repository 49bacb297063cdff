"""Makes changes of Mitsuba's variant take a tenth of the time, of which the tests have hundreds.

Mitsuba loads its Python integrators again at each change, and `dr.syntax` rewrites and compiles
each of their loops anew, to the same code. Here it does so once.
"""

from functools import partial
from types import FunctionType


def remember():
    """Let `dr.syntax` remember the code of functions that it has rewritten."""
    import drjit as dr  # after brdfkit, which chooses its LLVM

    dr.syntax = partial(rewrite, dr.syntax, {})


def rewrite(syntax, rewritten, function=None, **options):
    """What `syntax` returns, `function` with its loops and conditions rewritten."""
    if function is None:
        return partial(rewrite, syntax, rewritten, **options)
    code = function.__code__
    key = code, code.co_filename, *options.items()
    if key not in rewritten:
        rewritten[key] = syntax(function, **options).__code__
    again = FunctionType(rewritten[key], function.__globals__)
    again.__defaults__ = function.__defaults__
    return again
