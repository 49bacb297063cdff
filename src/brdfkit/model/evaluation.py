"""Evaluates a model in NumPy, in double precision: the sum of its lobes times their weights."""

from functools import lru_cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.recording import Recorded
from brdfkit.core.jit.threads import in_turn


def evaluate_model(model: Any, wi: ArrayLike, wo: ArrayLike) -> AnyArray:
    """Compute the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3).

    The BRDF is the sum of weight · `Lobe.eval` + weight² · `Lobe.quadratic` over the lobes, and of
    the lobes without a weight. It is clamped at 0 if weights may be negative, and 0 where a
    direction is not above the surface.
    """
    wi, wo = np.asarray(wi, float), np.asarray(wo, float)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    if above.all():
        return mix_lobes(model, to_weight_matrix(model), wi, wo)
    up = np.array([0.0, 0.0, 1.0])
    wi, wo = np.where(above[:, None], wi, up), np.where(above[:, None], wo, up)
    return np.where(above[:, None], mix_lobes(model, to_weight_matrix(model), wi, wo), 0.0)


def mix_lobes(model: Any, weights: AnyArray, wi: AnyArray, wo: AnyArray) -> AnyArray:
    """Compute the BRDF (n, channels) in sr⁻¹ with `weights` (lobes, channels) of the caller.

    They take the place of the model's own weights. The direction pairs `wi` and `wo` (n, 3) have to
    be above the surface.
    """
    plain, squared = compute_lobe_values(model, wi, wo)
    values = plain @ weights
    if squared.any():
        values += squared @ weights**2
    values += compute_fixed_values(model, wi, wo)
    return np.maximum(values, 0) if model.has_signed_weights() else values


def compute_clamped_share(model: Any, n: int = 20_000) -> float:
    """Return the share of direction pairs at which a channel would be negative without clamping.

    The `n` pairs are drawn uniformly in solid angle with a fixed seed. The share is 0 unless
    weights of the model may be negative.
    """
    z, phi = np.random.default_rng(0).random((2, 2, n))
    sine, phi = np.sqrt(1 - z * z), 2 * np.pi * phi
    wi, wo = np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=-1)
    plain, squared = compute_lobe_values(model, wi, wo)
    weights = to_weight_matrix(model)
    return float((plain @ weights + squared @ weights**2 < 0).any(axis=1).mean())


def to_weight_matrix(model: Any) -> Any:
    """Return the weights of a model's lobes as an array (lobes, channels)."""
    weights = [np.atleast_1d(getattr(model, name)) for name in model.weights()]
    channels = max(len(model.wavelengths), *(len(w) for w in weights))
    return np.array([np.broadcast_to(w, channels) for w in weights])


def make_model(
    model: Any, shapes: dict[str, Any], weights: AnyArray, wavelengths: ArrayLike = ()
) -> Any:
    """Make an object of the class `model` from shape parameters and weights (channels, lobes)."""
    named = dict(zip(model.weights(), map(tuple, weights.T), strict=True))
    return model(wavelengths=wavelengths, **shapes, **named)


def to_shape_scalars(model: Any) -> dict[str, JitFloat]:
    """Convert a model's shape parameters to Dr.Jit scalars in double precision, by name.

    They are opaque to Dr.Jit, that is, inputs of a kernel, so that one kernel serves all values.
    """
    linear = model.weights()
    values = model.free_values.items()
    return {name: double_precision.to_scalar(v) for name, v in values if name not in linear}


@in_turn
def compute_lobe_values(model: Any, wi: AnyArray, wo: AnyArray) -> list[AnyArray]:
    """Compute the values of all lobes, without weights, at direction pairs (n, 3).

    Returns two arrays (n, lobes) in sr⁻¹: the values of `Lobe.eval`, and of `Lobe.quadratic`, which
    are 0 for a lobe without it. The directions have to be above the surface.
    """
    pair = [np.asarray(w) for w in (wi, wo)]
    directions = [double_precision.to_array(w[:, k]) for w in pair for k in range(3)]
    shapes = to_shape_scalars(model)
    kind: Any = type(model)
    evaluate, rows = _make_lobe_function(kind, tuple(shapes))
    values = evaluate(directions, [*shapes.values(), double_precision.to_scalar(0.0)])
    both = np.zeros((2 * len(model.weights()), len(pair[0])))  # each column contiguous
    for row, value in zip(rows, values, strict=True):
        both[row] = np.asarray(value)
    plain, squared = np.split(both, 2)
    return [plain.T, squared.T]


@lru_cache(maxsize=64)
def _make_lobe_function(model: Any, names: tuple[str, ...]) -> tuple[Recorded, list[int]]:
    """Return a function that evaluates all lobes of a model class, and the rows of its results.

    The function takes the coordinates of wi and wo as arrays (n,), and the shape parameters of
    these `names` and 0 as scalars. It returns the values of the lobes, and after them those of
    `Lobe.quadratic`. The rows count the lobes twice, for both kinds of values.
    """
    lobes = [lobe for _, lobe in model().terms()]
    quadratic = [k for k, lobe in enumerate(lobes) if lobe.quadratic]

    def evaluate(directions: list[JitFloat], shapes: list[JitFloat]) -> list[JitFloat]:
        *values, zero = shapes
        lobes = [lobe for _, lobe in model.bind(dict(zip(names, values, strict=True))).terms()]
        wi, wo = double_precision.Vector(*directions[:3]), double_precision.Vector(*directions[3:])
        results = [lobe.eval(wi, wo) for lobe in lobes]
        results += [lobes[k].quadratic(wi, wo) for k in quadratic]
        zeros = zero * wi.z  # a constant lobe is one number, or an array of a constant size
        return [result + zeros for result in results]

    rows = [*range(len(lobes)), *(len(lobes) + k for k in quadratic)]
    return Recorded(evaluate, is_safe=is_own(model)), rows


def is_own(model: Any) -> bool:
    """Return whether a model class is brdfkit's own, and so are all models that it sums up."""
    return all(part.__module__.startswith("brdfkit.plugins.") for part in model.made_of())


@in_turn
def compute_fixed_values(model: Any, wi: AnyArray, wo: AnyArray) -> Any:
    """Compute the sum (n, 1) in sr⁻¹ of a model's lobes without a weight; 0.0 if it has none."""
    if not (lobes := model.bind(to_shape_scalars(model)).fixed_lobes()):
        return 0.0
    pair = double_precision.to_vector(wi), double_precision.to_vector(wo)
    values = np.asarray(sum(lobe.eval(*pair) for lobe in lobes))
    return np.broadcast_to(values, len(wi))[:, None]
