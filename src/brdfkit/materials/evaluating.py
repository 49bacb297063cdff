"""`evaluate` computes a material's BRDF, and `albedo` the share of light that it reflects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import ArrayLike
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import normalize
from brdfkit.core.geometry.quadrature import directional_albedo
from brdfkit.materials.resolve import MaterialLike, to_material


def evaluate(material: MaterialLike, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
    """Evaluate the BRDF of a material for pairs of directions, without a cosine.

    Parameters
    ----------
    material : Measured, Fit, Model, str, Path or dict
        The material, its name or path, or a BSDF's dictionary.
    wi, wo : array_like, shape (n, 3)
        Directions to the light and to the viewer: unit vectors in the local frame, z along the
        normal. Where one of them is below the surface, the BRDF is 0.

    Returns
    -------
    ndarray, shape (n, channels)
        BRDF [sr⁻¹]. The channels are a single one, or linear R, G, B, or the material's
        wavelengths.

    Raises
    ------
    BrdfkitError
        For an object that is no material, for directions of another shape, and for vectors whose
        length differs from 1 by more than 1e-4.

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
    if len(wi) == 0:  # evaluate one pair nevertheless, to find out the number of channels
        return brdf.eval(*[np.array([[0.0, 0.0, 1.0]])] * 2)[:0]
    return brdf.eval(wi, wo)


def albedo(material: MaterialLike, wi: ArrayLike) -> NDArray[np.float64]:
    """Compute the directional albedo ∫ f cosθ_o dω_o: the share of light that a material reflects.

    The integral is over the directions ω_o to the viewer, f is the BRDF and θ_o the angle of ω_o to
    the normal. The quadrature is refined until the result changes by less than 2e-4 of itself, even
    for the narrowest lobes.

    Parameters
    ----------
    material : Measured, Fit, Model, str, Path or dict
        The material, its name or path, or a BSDF's dictionary.
    wi : array_like, shape (3,)
        The direction to the light: a unit vector above the surface.

    Returns
    -------
    ndarray, shape (channels,)
        Reflected light over incident light; at most 1 for a material that conserves energy.

    Raises
    ------
    BrdfkitError
        For an object that is no material, and for any `wi` but a unit vector above the surface.

    Examples
    --------
    >>> albedo(models()["lambert"](diffuse_reflectance=0.5), [0, 0, 1]).round(4)
    array([0.5])
    """
    return directional_albedo(to_material(material, needed=("eval",)).eval, _check_incidence(wi))


def _check_incidence(wi: ArrayLike) -> NDArray[np.float64]:
    """Return `wi` (3,) normalised; raise `BrdfkitError` unless it is a unit vector with z > 0."""
    try:
        direction = np.array(wi, float)
    except (TypeError, ValueError):
        direction = np.empty(0)
    # Test that the vector is a unit vector, not that it is none: comparisons with NaN are False
    is_unit = direction.shape == (3,) and abs(np.linalg.norm(direction) - 1) <= 1e-4
    if not (is_unit and direction[2] > 0):
        raise BrdfkitError(
            f"albedo: wi = {wi} should be one unit vector above the surface, such as [0, 0, 1]."
        )
    return normalize(direction)
