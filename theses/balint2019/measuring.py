"""Shadows as numbers: their shares, evaluations, errors and times."""

import drjit as dr
import numpy as np

from brdfkit.theses.claims import measure_cpu_seconds


def evaluate(shadow):
    """Run the kernel of a `Shadow`."""
    dr.eval(shadow.visible, shadow.evaluations)
    dr.sync_thread()


def seconds_in_turns(methods, times):
    """Label → the least seconds of CPU, without what Python takes to record kernels.

    methods : label → function without arguments that returns a `Shadow`. They take turns, so that a
    load that comes and goes meets all of them; the first turn compiles.
    """
    turns = [
        {label: measure_cpu_seconds(evaluate, method()) for label, method in methods.items()}
        for _ in range(1 + times)
    ]
    return {label: min(turn[label] for turn in turns[1:]) for label in methods}


def shares(shadow):
    """The shares of the light (n,)."""
    return np.array(shadow.visible, float)


def rms(values):
    """The root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
