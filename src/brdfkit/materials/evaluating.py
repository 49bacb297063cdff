"""`evaluate` and `albedo`: the BRDF of a material, and the share of light that it reflects."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import normalize
from brdfkit.core.geometry.quadrature import directional_albedo
from brdfkit.materials.resolve import MaterialLike, to_material


def evaluate(material: MaterialLike, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
    """The BRDF of a material for pairs of directions, without a cosine.

    Parameters
    ----------
    material : Measured, Fit, Model, str, Path or dict
        The material, its name or path, or a BSDF's dictionary.
    wi, wo : array_like, shape (n, 3)
        Unit vectors in the local frame, z along the normal; below the surface the BRDF is 0.

    Returns
    -------
    ndarray, shape (n, channels)
        BRDF [sr⁻¹]: one channel, linear R, G, B, or the material's wavelengths.

    Raises
    ------
    BrdfkitError
        For what is no material, other shapes, and vectors whose length is not 1 (to 1e-4).

    Examples
    --------
    >>> evaluate(models()["lambert"](), [[0, 0, 1]], [[0.6, 0, 0.8]])
    array([[0.15915494]])
    """
    brdf = to_material(material)
    wi, wo = (np.array(w, float, ndmin=2) if np.size(w) else np.empty((0, 3)) for w in (wi, wo))
    if wi.shape != wo.shape or wi.shape[-1] != 3 or wi.ndim != 2:
        raise BrdfkitError(
            f"evaluate: wi {wi.shape} and wo {wo.shape} should both be of shape (n, 3)."
        )
    if not np.allclose(np.linalg.norm([wi, wo], axis=-1), 1, atol=1e-4):
        raise BrdfkitError("evaluate: wi and wo should be unit vectors.")
    if len(wi) == 0:  # an empty array, with the channels of the material
        return brdf.eval(*[np.array([[0.0, 0.0, 1.0]])] * 2)[:0]
    return brdf.eval(wi, wo)


def albedo(material: MaterialLike, wi: ArrayLike) -> NDArray[np.float64]:
    """The directional albedo ∫ f cosθ_o dω_o of a material: what it reflects of light from `wi`.

    By quadrature that settles to 2e-4 of the value, of the narrowest lobes, too.

    Parameters
    ----------
    material : Measured, Fit, Model, str, Path or dict
        The material, its name or path, or a BSDF's dictionary.
    wi : array_like, shape (3,)
        Where light comes from: a unit vector above the surface.

    Returns
    -------
    ndarray, shape (channels,)
        Reflected over incident light; a material that gains no light has at most 1.

    Raises
    ------
    BrdfkitError
        For what is no material, and for what is no unit vector above the surface.

    Examples
    --------
    >>> albedo(models()["lambert"](diffuse_reflectance=0.5), [0, 0, 1]).round(4)
    array([0.5])
    """
    return directional_albedo(to_material(material, needed=("eval",)).eval, _check_incidence(wi))


def _check_incidence(wi: ArrayLike) -> NDArray[np.float64]:
    """`wi` as a unit vector (3,) above the surface; `BrdfkitError` for anything else."""
    try:
        found = np.array(wi, float)
    except (TypeError, ValueError):
        found = np.empty(0)
    # "not (a <= b)" in place of "a > b", so that NaN is refused, too
    if found.shape != (3,) or not (abs(np.linalg.norm(found) - 1) <= 1e-4 and found[2] > 0):
        raise BrdfkitError(
            f"albedo: wi = {wi} should be one unit vector above the surface, such as [0, 0, 1]."
        )
    return normalize(found)
