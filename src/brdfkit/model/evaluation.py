"""Evaluates a model in double precision: the values of its lobes times its weights."""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn


def evaluate_model(model: Any, wi: ArrayLike, wo: ArrayLike) -> AnyArray:
    """Compute the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3).

    It is the sum of weight · `eval` + weight² · `quadratic` over the lobes, clamped at 0 where
    weights are signed, and 0 where a direction is not above the surface.
    """
    wi, wo = np.asarray(wi, float), np.asarray(wo, float)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    up = np.array([0.0, 0.0, 1.0])
    wi, wo = np.where(above[:, None], wi, up), np.where(above[:, None], wo, up)
    return np.where(above[:, None], mix_lobes(model, to_weight_matrix(model), wi, wo), 0.0)


def mix_lobes(model: Any, weights: AnyArray, wi: AnyArray, wo: AnyArray) -> AnyArray:
    """Compute the BRDF as `evaluate_model` does, with other weights (lobes, channels).

    The direction pairs (n, 3) have to be above the surface.
    """
    plain, squared = compute_lobe_values(model, wi, wo)
    values = plain @ weights + squared @ weights**2
    return np.maximum(values, 0) if model.has_signed_weights() else values


def compute_clamped_share(model: Any, n: int = 20_000) -> float:
    """Return the share of direction pairs at which a channel of a signed model is clamped at 0.

    The `n` pairs are drawn uniformly in solid angle with a fixed seed.
    """
    z, phi = np.random.default_rng(0).random((2, 2, n))
    sine, phi = np.sqrt(1 - z * z), 2 * np.pi * phi
    wi, wo = np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=-1)
    plain, squared = compute_lobe_values(model, wi, wo)
    weights = to_weight_matrix(model)
    return float((plain @ weights + squared @ weights**2 < 0).any(axis=1).mean())


def to_weight_matrix(model: Any) -> Any:
    """Return the weights (lobes, channels) of a model with values."""
    weights = [np.atleast_1d(getattr(model, name)) for name in model.weights()]
    channels = max(len(model.wavelengths), *(len(w) for w in weights))
    return np.array([np.broadcast_to(w, channels) for w in weights])


def make_model(
    model: Any, shapes: dict[str, Any], weights: AnyArray, wavelengths: ArrayLike = ()
) -> Any:
    """Make a model of a class from shape parameters by name and weights (channels, lobes)."""
    named = dict(zip(model.weights(), map(tuple, weights.T), strict=True))
    return model(wavelengths=wavelengths, **shapes, **named)


def to_shape_scalars(model: Any) -> dict[str, JitFloat]:
    """Return the free shape parameters of a model with values, by name, as opaque scalars."""
    linear = model.weights()
    values = model.free_values.items()
    return {name: double_precision.to_scalar(v) for name, v in values if name not in linear}


@in_turn
def compute_lobe_values(model: Any, wi: AnyArray, wo: AnyArray) -> list[AnyArray]:
    """Compute two arrays (n, lobes) in sr⁻¹ at direction pairs (n, 3) above the surface.

    The first holds the values of every `Lobe.eval`, the second those of every `Lobe.quadratic`, or
    0 for a lobe without one.
    """
    terms = model.bind(to_shape_scalars(model)).terms()
    pair = double_precision.to_vector(wi), double_precision.to_vector(wo)
    plain = [lobe.eval(*pair) for _, lobe in terms]
    squared = [lobe.quadratic(*pair) if lobe.quadratic else 0.0 for _, lobe in terms]
    dr.eval(plain, squared)  # in one kernel, since one for each lobe takes six times as long
    shape = len(wi), len(terms)
    return [
        np.stack([np.broadcast_to(np.asarray(c), shape[0]) for c in columns], axis=1)
        for columns in (plain, squared)
    ]
