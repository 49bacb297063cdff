"""Recorded functions of Dr.Jit arrays return what the functions themselves return."""

import gc
from unittest.mock import Mock

import drjit as dr
import numpy as np
import pytest

from brdfkit.core.jit import double_precision
from brdfkit.core.jit.recording import CHECKS, Recorded

pytestmark = [
    pytest.mark.quick,
    pytest.mark.skipif(not double_precision.has_derivatives(), reason="needs LLVM or CUDA"),
]


def arrays(n, seed):
    rng = np.random.default_rng(seed)
    return [double_precision.to_array(rng.random(n)) for _ in range(2)]


def differentiated(x, y):
    """A function with a derivative, a sum over two arrays, and an argument among its results."""
    value, slope = double_precision.differentiate(lambda v: dr.exp(v) * y, x + 0 * y)
    return [[value, slope], x]


def test_it_returns_what_the_function_returns():
    recorded = Recorded(differentiated, is_safe=True)
    traced = []
    for seed, n in enumerate((200, 200, 7, 30_000, 1, 1, 200)):
        given = arrays(n, seed)
        (value, slope), first = recorded(*given)
        x, y = (np.asarray(a) for a in given)
        np.testing.assert_allclose(value, np.exp(x) * y, rtol=1e-14)
        np.testing.assert_allclose(slope, np.exp(x) * y, rtol=1e-14)
        np.testing.assert_array_equal(first, x)
        traced.append(len(np.asarray(value)))
    assert traced == [200, 200, 7, 30_000, 1, 1, 200]


def test_later_calls_are_not_traced():
    trace = Mock(side_effect=lambda x, y: [x + y])
    recorded = Recorded(lambda *given: trace(*given), is_safe=True)
    for seed in range(10):
        recorded(*arrays(50, seed))
    assert trace.call_count == 1 + CHECKS
    recorded(*arrays(0, 0))  # Dr.Jit would end the process
    assert trace.call_count == 2 + CHECKS
    never = Recorded(lambda *given: trace(*given), is_safe=False)
    for seed in range(10):
        never(*arrays(50, seed))
    assert trace.call_count == 12 + CHECKS


def test_a_recording_that_does_not_repeat_its_results_is_given_up():
    """A constant array keeps the size that it had in the recording."""
    recorded = Recorded(lambda x, y: [dr.full(type(x), 2.0, len(x))], is_safe=True)
    sizes = [len(recorded(*arrays(n, n))[0]) for n in (10, 20, 30, 40, 50)]
    assert sizes == [10, 20, 30, 40, 50]


def test_garbage_with_arrays_of_numpy_does_no_harm():
    """Dr.Jit ends the process if the memory of such an array is freed during a recording."""

    def make_garbage(x, y):
        for _ in range(2000):  # containers, so many that Python would collect
            _ = [[], {}]
        return [x * y]

    for seed in range(5):
        cycle = [double_precision.to_array(np.arange(9.0))]
        cycle.append(cycle)
        del cycle
        x, y = arrays(20, seed)
        recorded = Recorded(make_garbage, is_safe=True)
        np.testing.assert_array_equal(recorded(x, y)[0], np.asarray(x) * np.asarray(y))
    assert gc.isenabled()
