"""Integrals over the hemisphere, to the precision that narrow lobes need."""

from functools import cache

import numpy as np

from brdfkit.geometry.directions import from_angles, normalize

# Points on each of twice as many rings about the mirror direction, refined until the sum settles
POINTS = (64, 128, 256, 512, 1024)
TOLERANCE = 2e-4


def directional_albedo(f, wi):
    """∫ f cosθ_o dω_o (channels,) at one incidence `wi` (3,), a unit vector above the surface.

    `f(wi, wo)` takes direction pairs (n, 3) and gives (n, channels). Rings about the mirror
    direction close up towards it, so that lobes from a thousandth of a radian to the whole
    hemisphere are seen; on each ring the points close up towards the plane of incidence and across
    it, where lobes are that are narrow one way. Both are doubled until the sum changes by less than
    2e-4 of itself, at most to 2048 rings of 1024 points: a `ward` a hundred times narrower one way
    is then known to 2e-5.
    """
    coarse = _sum(f, wi, POINTS[0])
    for points in POINTS[1:]:
        fine = _sum(f, wi, points)
        if abs(fine.sum() - coarse.sum()) <= TOLERANCE * abs(fine.sum()):
            break
        coarse = fine
    return fine


def _sum(f, wi, points):
    mirror = wi * [-1, -1, 1]
    cos_theta, sin_theta = mirror[2], np.hypot(mirror[0], mirror[1])
    # Rings are whole up to the horizon's nearest point, from there on arcs about their highest
    t, weight = _gauss(points)
    whole = np.arctan2(cos_theta, sin_theta)
    gamma = np.concatenate([whole * t**3, whole + (np.pi - 2 * whole) * t**2])
    width = np.concatenate([whole * 3 * t**2, (np.pi - 2 * whole) * 2 * t]) * np.tile(weight, 2)
    highest = np.maximum(np.sin(gamma) * sin_theta, 1e-12)
    half = np.arccos(np.clip(-np.cos(gamma) * cos_theta / highest, -1, 1))

    t, weight = _gauss(points, pieces=4)
    psi = np.outer(half, 2 * t - 1)
    up = normalize(np.cross(mirror, [-mirror[1], mirror[0], 0]) if sin_theta else [1.0, 0, 0])
    ring = np.cos(psi)[..., None] * up + np.sin(psi)[..., None] * np.cross(mirror, up)
    wo = np.cos(gamma)[:, None, None] * mirror + np.sin(gamma)[:, None, None] * ring
    solid_angle = np.outer(np.sin(gamma) * width * 2 * half, weight)
    above = (wo[..., 2] > 0) & (solid_angle > 0)
    wo, solid_angle = wo[above], solid_angle[above]
    return (wo[:, 2] * solid_angle) @ f(np.broadcast_to(wi, wo.shape), wo)


@cache
def _gauss(points, pieces=1):
    """Gauss and Legendre's nodes and weights on each of equal pieces of the unit interval."""
    nodes, weights = np.polynomial.legendre.leggauss(points // pieces)
    nodes = np.arange(pieces)[:, None] + (nodes + 1) / 2
    return nodes.ravel() / pieces, np.tile(weights / 2 / pieces, pieces)


def cosine_directions(n):
    """Unit vectors (n, 3) that follow the cosine: π f in their mean is the albedo of f."""
    square = (np.arange(n) + 0.5) / n
    golden = (np.sqrt(5) - 1) / 2  # of a turn from one to the next fills the circle most evenly
    return from_angles(np.arcsin(np.sqrt(square)), 2 * np.pi * golden * np.arange(n))
