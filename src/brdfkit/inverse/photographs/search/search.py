"""The search for maps: damped Gauss-Newton steps of all texels at once.

Of each texel the weighted squares of its residuals, and of all neighbours the squares of their
differences over τ², in units of the noise σ² [Levenberg 1944]; [Marquardt 1963]:

    E² = Σ_t Σ_i w (L_i - J_i)² + (σ² / τ²) Σ_t,t' |x_t - x_t'|²
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.regression.problem.box_quadratic import minimise_in_box

STEPS = 12
DAMPING = 1e-2
BLOCK = 8192  # texels whose equations are set up at once
RIDGE = 1e-9  # of the diagonal, where the lights leave numbers open


@dataclass
class Equations:
    """E² of each texel (n,), half its gradient (n, count) and Hessian (n, count, count)."""

    error: np.ndarray
    gradient: np.ndarray
    hessian: np.ndarray


def equations(numbers, x, seen, slopes=True):
    """The `Equations` of rows `x` (n, count) by `Observations`; without `slopes` the errors."""
    texels, p, lobes = len(x), numbers.count, len(numbers.lobes)
    error = np.zeros(texels)
    gradient = np.zeros((texels, p)) if slopes else None
    hessian = np.zeros((texels, p, p)) if slopes else None
    for first in range(0, texels, BLOCK):
        rows = slice(first, min(first + BLOCK, texels))
        part = seen.at(rows)
        value, by_number = numbers.radiances(x[rows], part, slopes)
        for c in range(CHANNELS):
            of_channel = [CHANNELS * lobe + c for lobe in range(lobes)]
            weights = x[rows][:, of_channel].T
            light = part.irradiance[..., c]
            root = np.sqrt(part.weights[..., c])
            shown = sum(w * lobe for w, lobe in zip(weights, value, strict=True))
            residual = root * (light * shown - part.radiance[..., c])
            error[rows] += (residual * residual).sum(axis=0)
            if not slopes:
                continue
            own = of_channel + list(range(numbers.shapes.start, p))
            moved = [sum(w * d for w, d in zip(weights, of, strict=True)) for of in by_number]
            factor = root * light
            columns = [factor * column for column in (*value, *moved)]
            for a, column in zip(own, columns, strict=True):
                gradient[rows, a] += (column * residual).sum(axis=0)
                for b, other in zip(own, columns, strict=True):
                    if b >= a:
                        hessian[rows, a, b] += (column * other).sum(axis=0)
    if slopes:
        hessian += np.triu(hessian, 1).transpose(0, 2, 1)
    return Equations(error, gradient, hessian)


def search_each(numbers, x, seen, steps=STEPS, report=lambda: None):
    """(rows x (n, count), their errors (n,)) of the least squares of each texel for itself."""
    low, high = numbers.limits()
    x = np.clip(x, low, high)
    damping = np.full(len(x), DAMPING)
    now = equations(numbers, x, seen)
    for _ in range(steps):
        diagonal = np.diagonal(now.hessian, axis1=1, axis2=2)
        floor = RIDGE * diagonal.max(axis=1, keepdims=True) + 1e-300
        damped = now.hessian + np.einsum(
            "np,pq->npq", damping[:, None] * diagonal + floor, np.eye(x.shape[1])
        )
        step = minimise_in_box(damped, now.gradient, low - x, high - x)
        trial = np.clip(x + step, low, high)
        there = equations(numbers, trial, seen)
        better = there.error < now.error
        damping *= np.where(better, 0.2, 6)
        x[better] = trial[better]
        for name in ("error", "gradient", "hessian"):
            getattr(now, name)[better] = getattr(there, name)[better]
        report()
    return x, now.error


def search_together(numbers, x, seen, strength, steps=6, report=lambda: None):
    """Rows x (n, count) of the least squares and differences of neighbours together; `strength`
    (count,): σ² / τ² of each number."""
    low, high = numbers.limits()
    shape, damping = seen.shape, 1e-3
    now = equations(numbers, x, seen)
    total = now.error.sum() + (strength * roughness(x, shape)).sum()
    for _ in range(steps):
        pull = strength * laplacian(x, shape)
        step = conjugate_gradients(now, pull, strength, shape, damping)
        trial = np.clip(x + step, low, high)
        there = equations(numbers, trial, seen)
        error = there.error.sum() + (strength * roughness(trial, shape)).sum()
        report()
        if error < total:
            gain, x, now, total, damping = total - error, trial, there, error, damping * 0.2
            if gain < 1e-4 * error:
                break
        else:
            damping *= 10
    return x


def conjugate_gradients(now, pull, strength, shape, damping, rounds=40, enough=1e-3):
    """The step (n, count) that solves (H + damping diag H + strength Laplacian) s = -(g + pull).

    [Hestenes & Stiefel 1952], with the blocks of the texels as the preconditioner.
    """
    count = now.gradient.shape[1]
    diagonal = np.diagonal(now.hessian, axis1=1, axis2=2)
    floor = RIDGE * diagonal.max(axis=1, keepdims=True) + 1e-300
    matrix = now.hessian + np.einsum("np,pq->npq", damping * diagonal + floor, np.eye(count))
    inverse = np.linalg.inv(matrix + 4 * np.diag(strength))

    def times(s):
        return np.einsum("npq,nq->np", matrix, s) + strength * laplacian(s, shape)

    residual = -(now.gradient + pull)
    step = np.zeros_like(residual)
    preconditioned = np.einsum("npq,nq->np", inverse, residual)
    direction, size = preconditioned, (residual * preconditioned).sum()
    first = size
    for _ in range(rounds):
        if not size > enough**2 * first:
            break
        image = times(direction)
        along = size / (direction * image).sum()
        step += along * direction
        residual -= along * image
        preconditioned = np.einsum("npq,nq->np", inverse, residual)
        before, size = size, (residual * preconditioned).sum()
        direction = preconditioned + size / before * direction
    return step


def roughness(x, shape):
    """The sum (count,) of squared differences of neighbours."""
    grid = x.reshape(*shape, -1)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    return (down**2).sum(axis=(0, 1)) + (right**2).sum(axis=(0, 1))


def laplacian(x, shape):
    """Half the derivative (n, count) of `roughness`."""
    grid = x.reshape(*shape, -1)
    found = np.zeros_like(grid)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    found[1:] += down
    found[:-1] -= down
    found[:, 1:] += right
    found[:, :-1] -= right
    return found.reshape(x.shape)
