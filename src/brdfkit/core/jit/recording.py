"""Records functions of Dr.Jit arrays, so that later calls start their kernels without tracing.

To trace a formula in Python takes longer than its kernel does on a few hundred samples. Dr.Jit can
record which kernels a function starts, and start them again for other arrays. Such a recording
would be wrong if the function used an array that is not among its arguments, or made an array of a
constant size. So the first calls of every recording are checked against the function itself.

Dr.Jit 1.5 ends the process if the memory of a NumPy array is freed during a recording, and if an
argument is empty. So a recorded function must not convert NumPy arrays, and Python collects no
garbage meanwhile.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.jit import double_precision

CHECKS = 2  # number of calls of each recording that are checked


class Recorded:
    """A function of Dr.Jit arrays, and lists of them, that is traced only in its first calls.

    `function`: returns nested lists of arrays. If Dr.Jit cannot record it, or a recording does not
    repeat its results to the last bit, it is traced in each call. `is_safe`: whether the function
    converts no NumPy array; otherwise it is never recorded.

    >>> twice = Recorded(lambda x: [2 * x], is_safe=True)
    >>> np.asarray(twice(double_precision.to_array(np.array([3.0])))[0])
    array([6.])
    """

    def __init__(self, function: Callable[..., list[Any]], is_safe: bool) -> None:
        self.function = function
        can_record = is_safe and double_precision.has_derivatives()
        self._frozen: Any = dr.freeze(function) if can_record else None
        self._checks_left = 0

    def __call__(self, *arrays: Any) -> list[Any]:
        """Return the results of the function, evaluated."""
        if self._frozen is None or not all(len(array) for array in _iterate_arrays(arrays)):
            return self._trace(*arrays)
        recordings = self._frozen.n_recordings
        try:
            with _collect_no_garbage():
                results: list[Any] = self._frozen(*arrays)
        except Exception:  # tracing then works, or raises an error that is easier to read
            self._frozen = None
            return self._trace(*arrays)
        if self._frozen.n_recordings > recordings:
            self._checks_left = CHECKS
        elif self._checks_left:
            self._checks_left -= 1
            expected = self._trace(*arrays)
            if not _are_equal(results, expected):
                self._frozen = None
                return expected
        return results

    def _trace(self, *arrays: Any) -> list[Any]:
        results = self.function(*arrays)
        dr.eval(results)
        return results


@contextmanager
def _collect_no_garbage() -> Iterator[None]:
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def _are_equal(ours: list[Any], theirs: list[Any]) -> bool:
    """Return whether two nested lists of arrays are equal to the last bit."""
    return all(
        np.array_equal(np.asarray(a), np.asarray(b), equal_nan=True)
        for a, b in zip(_iterate_arrays(ours), _iterate_arrays(theirs), strict=True)
    )


def _iterate_arrays(results: Any) -> Iterator[Any]:
    if isinstance(results, (list, tuple)):
        for result in results:
            yield from _iterate_arrays(result)
    else:
        yield results
