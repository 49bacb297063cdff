"""Fits the numbers of all texels by damped Gauss-Newton steps.

The search minimises the weighted squares of the residuals of each texel t, plus the squared
differences of neighbouring texels t and t' in units of τ. With the modelled radiances L_i, the
photographed ones J_i, the weights w and the variance σ² of the noise,

    E² = Σ_t Σ_i w (L_i - J_i)² + (σ² / τ²) Σ_t,t' |x_t - x_t'|².

The damping is that of [Levenberg 1944] and [Marquardt 1963].
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.search.problem import Equations, Problem
from brdfkit.regression.problem.box_quadratic import minimise_in_box

STEPS = 12  # for a texel by itself
STEPS_TOGETHER = 6
DAMPING, DAMPING_TOGETHER = 1e-2, 1e-3  # at the start
SMALLEST_GAIN = 1e-4  # relative to E²: a smaller gain ends the search of all texels
SOLVER_ROUNDS, SOLVER_TOLERANCE = 40, 1e-3  # limits of the conjugate gradients


def fit_each_texel(
    problem: Problem, x: FloatArray, steps: int = STEPS
) -> tuple[FloatArray, FloatArray]:
    """Return the numbers (n, count) of texels that are each fitted alone from `x`, and E² (n,)."""
    low, high = problem.parameters.limits()
    x = np.clip(x, low, high)
    damping = np.full(len(x), DAMPING)
    now = problem.compute_equations(x)
    for _ in range(steps):
        step = minimise_in_box(now.damp(damping[:, None]), now.gradient, low - x, high - x)
        trial = np.clip(x + step, low, high)
        there = problem.compute_equations(trial)
        better = there.error < now.error
        damping *= np.where(better, 0.2, 6)
        x[better] = trial[better]
        now.replace(better, there)
        problem.report()
    return x, now.error


def fit_all_texels(
    problem: Problem, x: FloatArray, strength: FloatArray, steps: int = STEPS_TOGETHER
) -> FloatArray:
    """Return the numbers (n, count) of texels that are fitted together from `x`, and smoothly.

    `strength` (count,) holds σ² / τ² for each number.
    """
    low, high = problem.parameters.limits()
    shape, damping = problem.observed.shape, DAMPING_TOGETHER
    now = problem.compute_equations(x)
    total = now.error.sum() + (strength * sum_squared_differences(x, shape)).sum()
    for _ in range(steps):
        step = _solve(now, x, strength, shape, damping)
        trial = np.clip(x + step, low, high)
        there = problem.compute_equations(trial)
        error = there.error.sum() + (strength * sum_squared_differences(trial, shape)).sum()
        problem.report()
        if error < total:
            gain, x, now, total, damping = total - error, trial, there, error, damping * 0.2
            if gain < SMALLEST_GAIN * error:
                break
        else:
            damping *= 10
    return x


def _solve(
    now: Equations, x: FloatArray, strength: FloatArray, shape: tuple[int, int], damping: float
) -> FloatArray:
    """Return the step (n, count) s that solves (H + D + A) s = -(g + A x) for all texels.

    H and g are the Hessian and gradient of the texels, D the damping, and A the Laplacian of
    neighbouring texels times their strength. The method is conjugate gradients
    [Hestenes & Stiefel 1952] with the blocks of the texels as the preconditioner.
    """
    matrix = now.damp(damping)
    inverse = np.linalg.inv(matrix + 4 * np.diag(strength))

    def multiply(s: FloatArray) -> FloatArray:
        """Return (H + D + A) s."""
        return np.einsum("npq,nq->np", matrix, s) + strength * apply_laplacian(s, shape)

    residual = -(now.gradient + strength * apply_laplacian(x, shape))
    step = np.zeros_like(residual)
    preconditioned = np.einsum("npq,nq->np", inverse, residual)
    direction, size = preconditioned, (residual * preconditioned).sum()
    first = size
    for _ in range(SOLVER_ROUNDS):
        if not size > SOLVER_TOLERANCE**2 * first:
            break
        image = multiply(direction)
        along = size / (direction * image).sum()
        step += along * direction
        residual -= along * image
        preconditioned = np.einsum("npq,nq->np", inverse, residual)
        before, size = size, (residual * preconditioned).sum()
        direction = preconditioned + size / before * direction
    return step


def sum_squared_differences(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return the sums (count,) of squared differences of neighbours with numbers `x` (n, count)."""
    grid = x.reshape(*shape, -1)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    sums: FloatArray = (down**2).sum(axis=(0, 1)) + (right**2).sum(axis=(0, 1))
    return sums


def apply_laplacian(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return half of the derivative (n, count) of `sum_squared_differences`."""
    grid = x.reshape(*shape, -1)
    result = np.zeros_like(grid)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    result[1:] += down
    result[:-1] -= down
    result[:, 1:] += right
    result[:, :-1] -= right
    return result.reshape(x.shape)
