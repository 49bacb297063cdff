"""Compares times in turns, so that other load of the machine meets all that is compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.jit.threads import use_one_thread
from brdfkit.theses.claims import measure_cpu_seconds

ALIKE = 1.5  # ratios of times on two machines agree up to this factor


@dataclass(frozen=True)
class Ratio:
    """The ratio of two times, and its 95 % interval from `low` to `high`."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"

    def is_at_least(self, printed: float) -> bool:
        """Return whether the whole interval is above a printed ratio, less the factor `ALIKE`."""
        return self.low * ALIKE >= printed

    def is_at_most(self, printed: float) -> bool:
        """Return whether the whole interval is below a printed ratio, times the factor `ALIKE`."""
        return self.high <= printed * ALIKE


def compare_times(times: ArrayLike, others: ArrayLike) -> Ratio:
    """Return the `Ratio` of two arrays of times (turn, ...), in which each turn is a pair.

    >>> print(compare_times([2.0, 4.0], [1.0, 2.0]))
    2 (2 to 2)
    """
    from scipy.stats import t as student

    logs = np.log(np.divide(times, others))
    n = len(logs)
    wide = student.ppf(0.975, n - 1) * logs.std(ddof=1) / np.sqrt(n) if n > 1 else 0.0
    return Ratio(*(float(np.exp(logs.mean() + side * wide)) for side in (0, -1, 1)))


def wait_for(*arrays: Any) -> None:
    """Run the kernel of Dr.Jit arrays and wait for its end."""
    import drjit as dr

    dr.eval(*arrays)
    dr.sync_thread()


def measure_in_turns(
    functions: Mapping[Any, Callable[[], Any]], turns: int
) -> dict[Any, FloatArray]:
    """Return the CPU seconds (turns,) of each function in one thread.

    functions : by label; they take turns. Each runs twice before, since its first call compiles
        kernels, and its second one may record them.
    turns : how often each is measured.
    """
    seconds: dict[Any, list[float]] = {label: [] for label in functions}
    with use_one_thread():
        for function in [*functions.values()] * 2:
            function()
        for _ in range(turns):
            for label, function in functions.items():
                seconds[label].append(measure_cpu_seconds(function))
    return {label: np.array(found) for label, found in seconds.items()}
