"""Computes the difference of pictures, and its derivatives for thousands of numbers at once.

The squared difference E² of a target picture J is from two renderings I_A and I_B, whose samples
are independent so that noise does not bias it (see `normal_equations.py`). With a weight w for each
pixel,

    E² = Σ w (I_A - J)(I_B - J),    ∂E²/∂I_A = w (I_B - J).

Mitsuba renders backwards: it propagates ∂E²/∂I_A through the samples of I_A to the parameters, and
likewise for I_B. The derivatives are then exact for these samples, and unbiased. By the places of
lamps Mitsuba has no derivatives; there ∂I_A and ∂I_B are differences of pictures.
"""

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.forward_derivatives import (
    DERIVATIVE_COST,
    compute_finite_differences,
    track_derivatives,
)


def compute_error_and_gradient(
    views: Views, x: FloatArray, spp: int, seed: int, weights: FloatArray
) -> tuple[float, FloatArray]:
    """Return the squared difference from the targets and its gradient (n,) for the coordinates `x`.

    Each of the two renderings has `spp` samples; `weights` (pixels, channels) multiply the squared
    differences.
    """
    a, b = (views.render_residuals(x, spp, seed + 1000 * half) for half in (0, 1))
    gradient, by_place = np.zeros((2, len(x)))
    for half, other in ((0, b), (1, a)):
        for number, adjoint in enumerate(views.split_pictures(weights * other)):
            gradient += _render_backward(views, x, number, adjoint, spp, seed + 1000 * half)
        for row in np.nonzero(views.is_place)[0]:
            change = compute_finite_differences(views, x, [int(row)], spp, seed + 1000 * half)
            by_place[row] += (weights * other * change).sum()
    views.cost += 2 * DERIVATIVE_COST * spp
    gradient = np.where(views.is_place, by_place, gradient * views.differentiate_values(x))
    return float((weights * a * b).sum()), gradient


def _render_backward(
    views: Views, x: FloatArray, number: int, adjoint: AnyArray, spp: int, seed: int
) -> FloatArray:
    """Return a loss's derivatives (n,) for the scene's values, through one picture.

    `number` is the picture's index. `adjoint` (height, width, channels) holds the derivatives of
    the loss by the picture's pixels.
    """
    import mitsuba as mi

    sensor = views.sensors[number]
    height, width = adjoint.shape[:2]
    padded = np.zeros((height, width, _count_channels(sensor)), np.float32)
    padded[..., : adjoint.shape[2]] = adjoint
    with raise_first_cause(), track_derivatives(views, x, number) as entries:
        views.integrator.render_backward(
            views.scene,
            views.parameters,
            mi.TensorXf(padded),
            sensor=sensor,
            seed=int(seed) + number,
            spp=int(spp),
        )
        by_entry = [
            np.zeros(len(unknown.start))
            if unknown.place
            else np.array(dr.grad(entry), float).ravel()
            for unknown, entry in zip(views.unknowns, entries, strict=True)
        ]
    parts = zip(views.unknowns, by_entry, strict=True)
    return np.concatenate([unknown.sum_over_copies(part) for unknown, part in parts])


def _count_channels(sensor: MitsubaObject) -> int:
    """Return how many channels the pictures of a sensor have, such as 4 with alpha."""
    sensor.film().prepare([])
    return int(sensor.film().develop().shape[2])
