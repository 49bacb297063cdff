"""Integrals over the hemisphere: `albedo`, the directional albedo of anything."""

import numpy as np

from brdfkit.directions import from_angles, normalize

# Points on each of as many rings about the mirror direction, refined until the sum settles
POINTS = (128, 256, 512, 1024)
TOLERANCE = 2e-4


def albedo(brdf, wi):
    """Directional albedo (channels,) ∫ f cosθ_o dω_o at an incidence `wi` (3,), a unit vector.

    `brdf`: a model with values, a fit or a measured material. Rings about the mirror direction
    lie at γ = π t³, so that lobes from a thousandth of a radian to the whole hemisphere are seen;
    they are doubled until the sum changes by less than 2e-4 of itself. A lobe that is a line, a
    hundred times narrower one way than the other, is seen too faint.

    >>> albedo(models()["lambert"](diffuse_reflectance=0.5), [0, 0, 1])    # doctest: +SKIP
    array([0.5])
    """
    coarse = _sum(brdf, normalize(wi), POINTS[0])
    for points in POINTS[1:]:
        fine = _sum(brdf, normalize(wi), points)
        if abs(fine.sum() - coarse.sum()) <= TOLERANCE * abs(fine.sum()):
            break
        coarse = fine
    return fine


def _sum(brdf, wi, points):
    t = (np.arange(points) + 0.5) / points
    gamma, width = np.pi * t**3, np.pi * 3 * t**2 / points
    psi = t * 2 * np.pi
    mirror = wi * [-1, -1, 1]
    across = normalize(np.cross([0, 1, 0] if abs(wi[1]) < 0.9 else [1, 0, 0], mirror))
    ring = np.cos(psi)[:, None] * across + np.sin(psi)[:, None] * np.cross(mirror, across)
    wo = np.cos(gamma)[:, None, None] * mirror + np.sin(gamma)[:, None, None] * ring
    wo = wo.reshape(-1, 3)
    above = wo[:, 2] > 0
    wo = wo[above]
    solid_angle = np.repeat(np.sin(gamma) * width * 2 * np.pi / points, points)[above]
    return (wo[:, 2] * solid_angle) @ brdf.eval(np.broadcast_to(wi, wo.shape), wo)


def cosine_directions(n):
    """Unit vectors (n, 3) that follow the cosine: π f in their mean is the albedo of f."""
    square = (np.arange(n) + 0.5) / n
    golden = (np.sqrt(5) - 1) / 2  # of a turn from one to the next fills the circle most evenly
    return from_angles(np.arcsin(np.sqrt(square)), 2 * np.pi * golden * np.arange(n))
