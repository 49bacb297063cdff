"""Fits the numbers of all texels by damped Gauss-Newton steps.

The search minimises the weighted squares of the residuals of each texel t, plus the squared
differences of neighbouring texels t and t' in units of τ. With the modelled radiances L_i, the
photographed ones J_i, the weights w and the variance σ² of the noise,

    E² = Σ_t Σ_i w (L_i - J_i)² + (σ² / τ²) Σ_t,t' |x_t - x_t'|².

The damping is that of [Levenberg 1944] and [Marquardt 1963].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.inverse.photographs.search.smoothness import apply_laplacian, sum_squared_differences
from brdfkit.regression.problem.box_quadratic import minimise_in_box

STEPS = 12  # for a texel by itself
STEPS_TOGETHER = 6
DAMPING, DAMPING_TOGETHER = 1e-2, 1e-3  # at the start
SMALLEST_GAIN = 1e-4  # relative to E²: a smaller gain ends the search of all texels
BLOCK = 8192  # texels whose equations are computed at once
RIDGE = 1e-9  # relative to the diagonal; it keeps undetermined numbers from making H singular
SOLVER_ROUNDS, SOLVER_TOLERANCE = 40, 1e-3  # limits of the conjugate gradients

Report = Callable[[], object]


@dataclass
class Equations:
    """The normal equations of n texels, each by itself.

    error : E² (n,) without the differences of neighbours.
    gradient : half of its gradient (n, count).
    hessian : half of its Gauss-Newton Hessian (n, count, count).
    """

    error: FloatArray
    gradient: FloatArray
    hessian: FloatArray

    def damp(self, damping: FloatArray | float) -> FloatArray:
        """Return the Hessians with a diagonal that is larger by a factor `damping` and a ridge."""
        diagonal = np.diagonal(self.hessian, axis1=1, axis2=2)
        floor = RIDGE * diagonal.max(axis=1, keepdims=True) + 1e-300
        added = np.einsum("np,pq->npq", damping * diagonal + floor, np.eye(diagonal.shape[1]))
        return self.hessian + added

    def replace(self, texels: BoolArray, other: Equations) -> None:
        """Take over the equations of some texels from `other`."""
        self.error[texels] = other.error[texels]
        self.gradient[texels] = other.gradient[texels]
        self.hessian[texels] = other.hessian[texels]


def compute_errors(
    parameters: TexelParameters, x: FloatArray, observed: Observations
) -> FloatArray:
    """Return E² (n,) of texels with the numbers `x` (n, count), without their differences."""
    return _compute(parameters, x, observed, differentiate=False).error


def compute_equations(
    parameters: TexelParameters, x: FloatArray, observed: Observations
) -> Equations:
    """Return the `Equations` of texels with the numbers `x` (n, count)."""
    return _compute(parameters, x, observed, differentiate=True)


def _compute(
    parameters: TexelParameters, x: FloatArray, observed: Observations, differentiate: bool
) -> Equations:
    """Return the `Equations` of texels; unless `differentiate`, only their error is set."""
    texels, count, lobes = len(x), parameters.count, len(parameters.lobes)
    error = np.zeros(texels)
    gradient = np.zeros((texels, count) if differentiate else 0)
    hessian = np.zeros((texels, count, count) if differentiate else 0)
    for first in range(0, texels, BLOCK):
        rows = slice(first, min(first + BLOCK, texels))
        part = observed.select_texels(rows)
        values, derivatives = parameters.evaluate_lobes(x[rows], part, differentiate)
        for c in range(CHANNELS):
            of_channel = [CHANNELS * lobe + c for lobe in range(lobes)]
            weights = x[rows][:, of_channel].T
            light = part.irradiance[..., c]
            root = np.sqrt(part.weights[..., c])
            shown = sum(w * lobe for w, lobe in zip(weights, values, strict=True))
            residual = root * (light * shown - part.radiance[..., c])
            error[rows] += (residual * residual).sum(axis=0)
            if not differentiate:
                continue
            own = of_channel + list(range(parameters.shape_columns.start, count))
            slopes = [
                sum(w * slope for w, slope in zip(weights, by_lobe, strict=True))
                for by_lobe in derivatives
            ]
            factor = root * light
            columns = [factor * column for column in (*values, *slopes)]
            for a, column in zip(own, columns, strict=True):
                gradient[rows, a] += (column * residual).sum(axis=0)
                for b, other in zip(own, columns, strict=True):
                    if b >= a:
                        hessian[rows, a, b] += (column * other).sum(axis=0)
    if differentiate:
        hessian += np.triu(hessian, 1).transpose(0, 2, 1)
    return Equations(error, gradient, hessian)


def fit_each_texel(
    parameters: TexelParameters,
    x: FloatArray,
    observed: Observations,
    steps: int = STEPS,
    report: Report = lambda: None,
) -> tuple[FloatArray, FloatArray]:
    """Return the numbers (n, count) of texels that are each fitted alone, and their E² (n,).

    The search begins at `x`; `report()` is called after each step.
    """
    low, high = parameters.limits()
    x = np.clip(x, low, high)
    damping = np.full(len(x), DAMPING)
    now = compute_equations(parameters, x, observed)
    for _ in range(steps):
        step = minimise_in_box(now.damp(damping[:, None]), now.gradient, low - x, high - x)
        trial = np.clip(x + step, low, high)
        there = compute_equations(parameters, trial, observed)
        better = there.error < now.error
        damping *= np.where(better, 0.2, 6)
        x[better] = trial[better]
        now.replace(better, there)
        report()
    return x, now.error


def fit_all_texels(
    parameters: TexelParameters,
    x: FloatArray,
    observed: Observations,
    strength: FloatArray,
    steps: int = STEPS_TOGETHER,
    report: Report = lambda: None,
) -> FloatArray:
    """Return the numbers (n, count) of texels that are fitted together, with smooth differences.

    `strength` (count,) holds σ² / τ² for each number. The search begins at `x`; `report()` is
    called after each step.
    """
    low, high = parameters.limits()
    shape, damping = observed.shape, DAMPING_TOGETHER
    now = compute_equations(parameters, x, observed)
    total = now.error.sum() + (strength * sum_squared_differences(x, shape)).sum()
    for _ in range(steps):
        step = _solve(now, x, strength, shape, damping)
        trial = np.clip(x + step, low, high)
        there = compute_equations(parameters, trial, observed)
        error = there.error.sum() + (strength * sum_squared_differences(trial, shape)).sum()
        report()
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
