"""Measures shadows: their shares of the light, evaluations, errors and times."""

import numpy as np

from brdfkit.core.jit.threads import use_one_thread
from brdfkit.theses.claims import measure_cpu_seconds
from brdfkit.theses.timing import wait_for


def measure_in_turns(methods, times):
    """Return CPU seconds (times,) of each method in one thread, without those to record kernels.

    methods : functions without arguments that return a `Shadow` or an array, by label. They take
        turns, so that other load of the machine meets all of them; the first turn compiles.
    """
    turns = {label: [] for label in methods}
    with use_one_thread():
        for _ in range(1 + times):
            for label, method in methods.items():
                found = method()
                arrays = (found.visible, found.evaluations) if hasattr(found, "r") else (found,)
                turns[label].append(measure_cpu_seconds(wait_for, *arrays))
    return {label: np.array(seconds[1:]) for label, seconds in turns.items()}


def read_shares(shadow):
    """Return the shares of the light (n,) of a `Shadow` as an array."""
    return np.array(shadow.visible, float)


def compute_rms(values):
    """Return the root mean square of values."""
    return float(np.sqrt(np.mean(np.square(values))))
