"""`evaluate`: the BRDF of anything, a model, a fit or a measured material."""

import numpy as np

from brdfkit.errors import BrdfkitError


def evaluate(brdf, wi, wo):
    """BRDF (n, channels) in sr⁻¹, without cosine, of direction pairs `wi`, `wo` (n, 3).

    `brdf`: a model with values, a fit or a measured material. Directions are unit vectors in
    the local frame; where one is not above the surface the BRDF is 0.

    >>> evaluate(models()["lambert"](), [[0, 0, 1]], [[0.6, 0, 0.8]])
    array([[0.15915494]])
    """
    wi, wo = (np.array(w, float, ndmin=2) for w in (wi, wo))
    if wi.shape != wo.shape or wi.shape[-1] != 3 or wi.ndim != 2:
        raise BrdfkitError(
            f"evaluate: wi {wi.shape} and wo {wo.shape} should both be of shape (n, 3)."
        )
    if not np.allclose(np.linalg.norm([wi, wo], axis=-1), 1, atol=1e-4):
        raise BrdfkitError("evaluate: wi and wo should be unit vectors.")
    return brdf.eval(wi, wo)


def evaluate_model(model, wi, wo):
    """`evaluate` for a `Model`: Σ weight · lobe, in double precision."""
    wi, wo = np.asarray(wi, float), np.asarray(wo, float)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    up = np.array([0.0, 0.0, 1.0])
    lobes = lobe_values(model, np.where(above[:, None], wi, up), np.where(above[:, None], wo, up))
    return np.where(above[:, None], lobes @ weight_matrix(model), 0.0)


def weight_matrix(model):
    """Weights (lobes, channels) of a model."""
    weights = [np.atleast_1d(getattr(model, name)) for name in model.weights()]
    channels = max(len(w) for w in weights)
    return np.array([np.broadcast_to(w, channels) for w in weights])


def lobe_values(model, wi, wo):
    """Lobes (n, lobes) in sr⁻¹ of directions (n, 3) above the surface."""
    from brdfkit import backend

    bound = model.bind(backend.shapes(model))
    wi, wo = backend.vector(wi), backend.vector(wo)
    columns = [np.asarray(lobe.eval(wi, wo)) for _, lobe in bound.terms()]
    return np.stack([np.broadcast_to(c, len(wi.x)) for c in columns], axis=1)
