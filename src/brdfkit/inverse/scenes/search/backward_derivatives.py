"""E² of rendered pictures, and its derivatives by thousands of numbers: renderings backwards.

Of two halves I_A, I_B of independent samples beside a picture J,

    E² = Σ w (I_A - J)(I_B - J),    ∂E²/∂I_A = w (I_B - J)

and what goes backwards through the samples of one half is made of the other: so the derivatives are
those of the same samples, and right in the mean. See `normal_equations.py`.
"""

import drjit as dr
import numpy as np

from brdfkit.core.jit.loops import first_error
from brdfkit.inverse.scenes.search.forward_derivatives import DERIVATIVE_COST, differentiated


def error_and_slopes(views, x, spp, seed, weights):
    """(E², its derivatives (n,) by the coordinates `x`), of `spp` samples for each half."""
    a, b = (views.residuals(x, spp, seed + 1000 * half) for half in (0, 1))
    gradient = np.zeros(len(x))
    for half, other in ((0, b), (1, a)):
        for number, onto in enumerate(views.as_pictures(weights * other)):
            gradient += _backwards(views, x, number, onto, spp, seed + 1000 * half)
    views.renders += 2 * DERIVATIVE_COST * spp
    return float((weights * a * b).sum()), gradient * views.slopes(x)


def _backwards(views, x, number, onto, spp, seed):
    """The derivatives (n,) of Σ `onto` · I by the values, I the picture of sensor `number`."""
    import mitsuba as mi

    sensor = views.scene.sensors()[number]
    height, width = onto.shape[:2]
    given = np.zeros((height, width, _channels(sensor)), np.float32)
    given[..., : onto.shape[2]] = onto
    with first_error(), differentiated(views, x) as leaves:
        views.integrator.render_backward(
            views.scene,
            views.parameters,
            mi.TensorXf(given),
            sensor=sensor,
            seed=int(seed) + number,
            spp=int(spp),
        )
        found = [np.array(dr.grad(leaf), float).ravel() for leaf in leaves]
    parts = zip(views.unknowns, found, strict=True)
    return np.concatenate([unknown.gathered(slopes) for unknown, slopes in parts])


def _channels(sensor):
    """How many channels the pictures of a sensor have."""
    sensor.film().prepare([])
    return sensor.film().develop().shape[2]
