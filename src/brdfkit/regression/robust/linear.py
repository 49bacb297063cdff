"""Runs the passes of a robust fit whose residuals are linear in all its parameters.

Each pass is a small weighted least squares problem per channel, so no kernel runs again.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.robust.problem import RobustProblem
from brdfkit.regression.robust.reweighting import orthonormalise


def reweight_linear_model(
    robust: RobustProblem, weights: FloatArray, tolerance: float, most: int
) -> tuple[FloatArray, int]:
    """Return the lobes' weights (1, channels, lobes) after ordinary passes, and their number.

    `weights`: the weights to start from. A channel's passes end after one that changed its fitted
    values by less than the `tolerance`, a share of their standard deviation, or after `most`. So
    they may end on a cycle, or before the solution.
    """
    ends, passes = weights.copy(), 0
    residuals, jacobians = robust.problem.compute_jacobians(np.zeros((1, 0)), weights)
    for c, (start, columns) in enumerate(zip(residuals, jacobians, strict=True)):
        basis, to_weights = orthonormalise(columns)
        ridge = 1e-14 * np.eye(len(basis))  # samples without weight may leave too few
        change, number, size = np.zeros(len(basis)), 0, np.inf
        while size > tolerance * robust.spread and number < most:
            residual = start + change @ basis
            weighted = basis * robust.weigh_residuals(c, residual)
            step = np.linalg.solve(weighted @ basis.T + ridge, weighted @ residual)
            change, number, size = change - step, number + 1, float(np.sqrt(step @ step))
        ends[0, c] += to_weights @ change
        passes = max(passes, number)
    return ends, passes
