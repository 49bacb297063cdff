"""The numbers of a material: `evaluate`, its BRDF, and `albedo`, what it reflects of all light."""

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.geometry.directions import normalize
from brdfkit.geometry.quadrature import directional_albedo
from brdfkit.materials import material


def evaluate(brdf, wi, wo):
    """BRDF (n, channels) in sr⁻¹, without cosine, of direction pairs `wi`, `wo` (n, 3).

    `brdf`: a model with values, a fit or a measured material. Directions are unit vectors in
    the local frame; where one is not above the surface the BRDF is 0. Of no directions the result
    is empty. Raises `BrdfkitError` for what is no material, other shapes, and directions whose
    length is not 1 (to 1e-4).

    >>> evaluate(models()["lambert"](), [[0, 0, 1]], [[0.6, 0, 0.8]])
    array([[0.15915494]])
    """
    brdf = material(brdf)
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


def albedo(brdf, wi):
    """Directional albedo (channels,) ∫ f cosθ_o dω_o at one incidence `wi`, of shape (3,).

    `brdf`: a model with values, a fit or a measured material; `wi`: a unit vector above the
    surface, else it raises `BrdfkitError`. By quadrature that settles to 2e-4 of the value:
    `geometry/quadrature.py`.

    >>> albedo(models()["lambert"](diffuse_reflectance=0.5), [0, 0, 1])    # doctest: +SKIP
    array([0.5])
    """
    return directional_albedo(material(brdf, needed=("eval",)).eval, _incidence(wi))


def _incidence(wi):
    """`wi` as a unit vector (3,) above the surface, or an error."""
    try:
        found = np.array(wi, float)
    except (TypeError, ValueError):
        found = np.empty(0)
    # not <: NaN is refused as well
    if found.shape != (3,) or not (abs(np.linalg.norm(found) - 1) <= 1e-4 and found[2] > 0):
        raise BrdfkitError(
            f"albedo: wi = {wi} should be one unit vector above the surface, such as [0, 0, 1]."
        )
    return normalize(found)
