"""`evaluate`: the BRDF of anything, a model, a fit or a measured material."""

import numpy as np

from brdfkit.errors import BrdfkitError


def evaluate(brdf, wi, wo):
    """BRDF (n, channels) in sr⁻¹, without cosine, of direction pairs `wi`, `wo` (n, 3).

    `brdf`: a model with values, a fit or a measured material. Directions are unit vectors in
    the local frame; where one is not above the surface the BRDF is 0. Of no directions the result
    is empty. Raises `BrdfkitError` for what is no material, other shapes, and directions whose
    length is not 1 (to 1e-4).

    >>> evaluate(models()["lambert"](), [[0, 0, 1]], [[0.6, 0, 0.8]])
    array([[0.15915494]])
    """
    from brdfkit.materials import require_material

    require_material(brdf)
    wi, wo = (np.array(w, float, ndmin=2) if np.size(w) else np.empty((0, 3)) for w in (wi, wo))
    if wi.shape != wo.shape or wi.shape[-1] != 3 or wi.ndim != 2:
        raise BrdfkitError(
            f"evaluate: wi {wi.shape} and wo {wo.shape} should both be of shape (n, 3)."
        )
    if not np.allclose(np.linalg.norm([wi, wo], axis=-1), 1, atol=1e-4):
        raise BrdfkitError("evaluate: wi and wo should be unit vectors.")
    if len(wi) == 0:  # no direction, but as many channels as of any
        return brdf.eval(*[np.array([[0.0, 0.0, 1.0]])] * 2)[:0]
    return brdf.eval(wi, wo)


def evaluate_model(model, wi, wo):
    """`evaluate` for a `Model`: Σ weight · lobe + weight² · quadratic, in double precision."""
    wi, wo = np.asarray(wi, float), np.asarray(wo, float)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    up = np.array([0.0, 0.0, 1.0])
    wi, wo = np.where(above[:, None], wi, up), np.where(above[:, None], wo, up)
    plain, squared = lobe_values(model, wi, wo)
    weights = weight_matrix(model)
    values = plain @ weights + squared @ weights**2
    return np.where(above[:, None], np.maximum(values, 0) if model.signed() else values, 0.0)


def clamped_share(model, n=20_000):
    """Share of direction pairs, even in solid angle, where a channel of a signed model is below 0
    and clamped."""
    z, phi = np.random.default_rng(0).random((2, 2, n))
    sine, phi = np.sqrt(1 - z * z), 2 * np.pi * phi
    wi, wo = np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=-1)
    plain, squared = lobe_values(model, wi, wo)
    weights = weight_matrix(model)
    return float((plain @ weights + squared @ weights**2 < 0).any(axis=1).mean())


def weight_matrix(model):
    """Weights (lobes, channels) of a model."""
    weights = [np.atleast_1d(getattr(model, name)) for name in model.weights()]
    channels = max(len(w) for w in weights)
    return np.array([np.broadcast_to(w, channels) for w in weights])


def lobe_values(model, wi, wo):
    """Lobes (n, lobes) in sr⁻¹ of directions (n, 3) above the surface, and those of the weights'
    squares, likewise."""
    import drjit as dr

    from brdfkit.model import double_precision

    terms = model.bind(double_precision.shapes(model)).terms()
    wi, wo = double_precision.vector(wi), double_precision.vector(wo)
    plain = [lobe.eval(wi, wo) for _, lobe in terms]
    squared = [lobe.quadratic(wi, wo) if lobe.quadratic else 0.0 for _, lobe in terms]
    dr.eval(plain, squared)  # together: a kernel for each takes six times as long
    shape = len(wi.x), len(terms)
    return [
        np.stack([np.broadcast_to(np.asarray(c), shape[0]) for c in columns], axis=1)
        for columns in (plain, squared)
    ]
