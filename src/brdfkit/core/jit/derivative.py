"""The derivative of a function of one array."""

import drjit as dr

from brdfkit.core.jit import double_precision


def differentiate(function, x):
    """A function of arrays at `x`, and its derivative there."""
    if not double_precision.differentiable():
        h = 1e-6 * dr.maximum(x, 1e-3)
        return function(x), (function(x + h) - function(x - h)) / (2 * h)
    dr.enable_grad(x)
    y = function(x)
    dr.forward_from(x)
    return dr.detach(y), dr.grad(y)
