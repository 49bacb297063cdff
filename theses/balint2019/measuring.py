"""Measures shadows: their shares of the light, evaluations, errors and times."""

import drjit as dr
import numpy as np

from brdfkit.theses.claims import measure_cpu_seconds


def evaluate_shadow(shadow):
    """Run the kernel of a `Shadow` and wait for its end."""
    dr.eval(shadow.visible, shadow.evaluations)
    dr.sync_thread()


def measure_in_turns(methods, times):
    """Return the least CPU seconds of each method, without the time to record kernels.

    methods : functions without arguments that return a `Shadow`, by label. They take turns, so that
        other load of the machine meets all of them; the first turn compiles.
    """
    turns = [
        {label: measure_cpu_seconds(evaluate_shadow, method()) for label, method in methods.items()}
        for _ in range(1 + times)
    ]
    return {label: min(turn[label] for turn in turns[1:]) for label in methods}


def read_shares(shadow):
    """Return the shares of the light (n,) of a `Shadow` as an array."""
    return np.array(shadow.visible, float)


def compute_rms(values):
    """Return the root mean square of values."""
    return float(np.sqrt(np.mean(np.square(values))))
