"""Derivatives of a model's BRDF by a parameter: exact ones by Dr.Jit, and finite differences."""

import drjit as dr
import numpy as np

from brdfkit.checks.material_subject import random_pairs
from brdfkit.core.jit import double_precision
from brdfkit.model.evaluation import lobe_values


def free_shapes(model):
    """The names of the shape parameters, without those that follow another and equal it."""
    return [name for name in model.free_values if not model.parameters[name].linear]


def has_effect(model, name):
    """Whether any lobe is computed from the parameter."""
    values = {
        n: double_precision.to_scalar(getattr(model, n)) for n in model.shapes(anisotropic=True)
    }
    dr.enable_grad(values[name])
    wi, wo = (double_precision.to_vector(w) for w in random_pairs(2, seed=6))
    lobes = [lobe for _, lobe in model.bind(values).terms()]
    terms = [lobe.eval(wi, wo) for lobe in lobes]
    terms += [lobe.quadratic(wi, wo) for lobe in lobes if lobe.quadratic]
    return any(dr.grad_enabled(term) for term in terms)


def exact_derivative(model, weights, name, wi, wo):
    """The exact derivative (n, channels) of the BRDF by a parameter, equal in all channels.

    `weights`: (lobes, channels). A parameter that follows `name` changes with it. The derivative is
    0 where a sum of signed weights is clamped at 0.
    """
    plain, squared = lobe_values(model, wi, wo)
    if model.parameters[name].linear:
        lobe = model.weights().index(name)
        derivative = plain[:, [lobe]] + 2 * squared[:, [lobe]] * weights[lobe]
    else:
        plain_slopes, squared_slopes = _lobe_slopes(model, name, wi, wo)
        derivative = plain_slopes @ weights + squared_slopes @ weights**2
    if not model.signed():
        return derivative
    return np.where(plain @ weights + squared @ weights**2 > 0, derivative, 0)


def _lobe_slopes(model, name, wi, wo):
    """The exact derivatives by a shape parameter, by Dr.Jit's forward mode: two arrays (n, lobes).

    The first is of the factors of the weights, the second of the factors of the weights' squares.
    """
    values = double_precision.to_shape_scalars(model)
    dr.enable_grad(values[name])
    directions = double_precision.to_vector(wi), double_precision.to_vector(wo)
    Float64 = double_precision.float_type()
    terms = model.bind(values).terms()
    plain = [Float64(lobe.eval(*directions)) for _, lobe in terms]
    squared = [Float64(lobe.quadratic(*directions) if lobe.quadratic else 0) for _, lobe in terms]
    dr.forward_from(values[name])
    return [
        np.stack([np.broadcast_to(np.array(dr.grad(c)), len(wi)) for c in columns], axis=1)
        for columns in (plain, squared)
    ]


def finite_difference(model, name, wi, wo):
    """The derivative (n, channels) of the BRDF by a parameter, by second-order finite differences.

    They are central, and one-sided near a bound of the parameter.
    """
    value = getattr(model, name)
    low, high = model.parameters[name].bounds
    h = 1e-5 * max(abs(value), 1e-2)
    if value + h > high or value - h < low:
        h = -h if value + 2 * h > high else h
        steps, factors = (0, h, 2 * h), (-1.5, 2, -0.5)
    else:
        steps, factors = (-h, h), (-0.5, 0.5)
    values = [model.changed(**{name: value + step}).eval(wi, wo) for step in steps]
    return sum(factor * f for factor, f in zip(factors, values, strict=True)) / h
