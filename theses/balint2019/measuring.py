"""Measures shadows: their shares of the light, evaluations, errors and times."""

from dataclasses import dataclass

import drjit as dr
import numpy as np
from scipy.stats import t as student

from brdfkit.core.jit.threads import use_one_thread
from brdfkit.theses.claims import measure_cpu_seconds

ALIKE = 1.5  # ratios of times on two machines agree up to this factor


@dataclass(frozen=True)
class Ratio:
    """The ratio of two times, and its 95 % interval."""

    value: float
    low: float
    high: float

    def __str__(self):
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"

    def is_at_least(self, printed):
        """Return whether the whole interval is above a printed ratio, less the factor `ALIKE`."""
        return self.low * ALIKE >= printed

    def is_at_most(self, printed):
        """Return whether the whole interval is below a printed ratio, times the factor `ALIKE`."""
        return self.high <= printed * ALIKE


def compare_times(some, others):
    """Return the `Ratio` of two arrays of times (turn, ...), of which each turn is a pair."""
    logs = np.log(np.divide(some, others))
    n = len(logs)
    wide = student.ppf(0.975, n - 1) * logs.std(ddof=1) / np.sqrt(n) if n > 1 else 0.0
    return Ratio(*(float(np.exp(logs.mean() + side * wide)) for side in (0, -1, 1)))


def wait_for(*arrays):
    """Run the kernel of Dr.Jit arrays and wait for its end."""
    dr.eval(*arrays)
    dr.sync_thread()


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
