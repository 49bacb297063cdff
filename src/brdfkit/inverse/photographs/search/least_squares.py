"""Fits the searched numbers of all texels with damped Gauss-Newton steps.

The search minimises the weighted squared residuals of each texel t, plus the squared differences of
neighbouring texels t and t', whose typical size is τ. With the modelled radiances L_i, the
photographed ones J_i, their weights w, the texels' numbers x and the variance σ² of the noise,

    E² = Σ_t Σ_i w (L_i - J_i)² + (σ² / τ²) Σ_t,t' |x_t - x_t'|².

The damping is that of [Levenberg 1944] and [Marquardt 1963].
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.search.problem import Equations, Problem
from brdfkit.regression.problem.box_quadratic import minimise_in_box

# Largest number of steps: where each texel is fitted alone, and where all are fitted together
STEPS, STEPS_TOGETHER = 12, 6
# Damping of the first step: where each texel is fitted alone, and where all are fitted together
DAMPING, DAMPING_TOGETHER = 1e-2, 1e-3
# Where all texels are fitted together, the search ends when a step reduces the error E² by less
# than this share
SMALLEST_GAIN = 1e-4
# The conjugate gradients that compute a step end after this many rounds, or at this residual
# relative to the first
SOLVER_ROUNDS, SOLVER_TOLERANCE = 40, 1e-3


def fit_each_texel(
    problem: Problem, x: FloatArray, steps: int = STEPS
) -> tuple[FloatArray, FloatArray]:
    """Fit each texel by itself; return the fitted numbers and the squared residuals (texels,).

    The search begins at `x` (texels, numbers), and the fitted numbers have the same shape.
    """
    low, high = problem.parameters.find_limits()
    x = np.clip(x, low, high)
    damping = np.full(len(x), DAMPING)
    now = problem.compute_equations(x)
    for _ in range(steps):
        step = minimise_in_box(now.damp_hessians(damping[:, None]), now.gradient, low - x, high - x)
        trial = np.clip(x + step, low, high)
        there = problem.compute_equations(trial)
        better = there.error < now.error
        damping *= np.where(better, 0.2, 6)
        x[better] = trial[better]
        now.overwrite_texels(better, there)
        problem.report()
    return x, now.error


def fit_all_texels(
    problem: Problem, x: FloatArray, strength: FloatArray, steps: int = STEPS_TOGETHER
) -> FloatArray:
    """Fit all texels together, so that maps are smooth; return the fitted numbers.

    The search begins at `x` (texels, numbers). `strength` (numbers,) is the weight of squared
    differences of neighbours in each number.
    """
    low, high = problem.parameters.find_limits()
    shape, damping = problem.observed.shape, DAMPING_TOGETHER
    now = problem.compute_equations(x)
    total = now.error.sum() + (strength * sum_squared_differences(x, shape)).sum()
    for _ in range(steps):
        step = _solve_step(now, x, strength, shape, damping)
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


def _solve_step(
    now: Equations, x: FloatArray, strength: FloatArray, shape: tuple[int, int], damping: float
) -> FloatArray:
    """Return the damped Gauss-Newton step (texels, numbers) of all texels together.

    It solves (H + D + A) s = -(g + A x), where H and g are the Hessian and gradient of the texels,
    D is the damping, and A the Laplacian of neighbouring texels times their `strength` (numbers,).
    The method is conjugate gradients [Hestenes & Stiefel 1952] with the blocks of the texels as
    preconditioner.
    """
    matrix = now.damp_hessians(damping)
    inverse = np.linalg.inv(matrix + 4 * np.diag(strength))

    def multiply_matrix(s: FloatArray) -> FloatArray:
        """Return the matrix of the linear system times a vector `s`, both (texels, numbers)."""
        return np.einsum("npq,nq->np", matrix, s) + strength * apply_laplacian(s, shape)

    residual = -(now.gradient + strength * apply_laplacian(x, shape))
    step = np.zeros_like(residual)
    preconditioned = np.einsum("npq,nq->np", inverse, residual)
    direction, size = preconditioned, (residual * preconditioned).sum()
    first = size
    for _ in range(SOLVER_ROUNDS):
        if not size > SOLVER_TOLERANCE**2 * first:
            break
        image = multiply_matrix(direction)
        along = size / (direction * image).sum()
        step += along * direction
        residual -= along * image
        preconditioned = np.einsum("npq,nq->np", inverse, residual)
        before, size = size, (residual * preconditioned).sum()
        direction = preconditioned + size / before * direction
    return step


def sum_squared_differences(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return the sum (numbers,) of squared differences of neighbouring texels, for each number.

    `x` (texels, numbers) are the texels' numbers, in maps of `shape` (height, width).
    """
    grid = x.reshape(*shape, -1)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    sums: FloatArray = (down**2).sum(axis=(0, 1)) + (right**2).sum(axis=(0, 1))
    return sums


def apply_laplacian(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return half of the gradient (texels, numbers) of the sum of squared neighbour differences.

    This is the discrete Laplacian of the texels' numbers `x`, with the opposite sign; `shape` is
    the height and width of the maps.
    """
    grid = x.reshape(*shape, -1)
    result = np.zeros_like(grid)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    result[1:] += down
    result[:-1] -= down
    result[:, 1:] += right
    result[:, :-1] -= right
    return result.reshape(x.shape)
