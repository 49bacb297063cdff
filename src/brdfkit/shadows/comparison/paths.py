"""A light that moves a little from picture to picture, as the sun of a game does."""

from dataclasses import replace

import numpy as np

from brdfkit.shadows.comparison.camera_path import STEPS

TURN = 0.01  # of a step, as what is farthest from the light sees it [rad]


def path(placement, steps=STEPS):
    """The `Placement`s of a light that goes across its way to what is seen, in equal steps."""
    light = placement.light
    way = light.point[:3] - light.point[3] * placement.seen.middle
    step = TURN * across(way) * (1 if light.is_directional else placement.reach)
    return [replace(placement, light=moved(light, k * step)) for k in range(steps)]


def across(way):
    """The unit vector (3,) at right angles to a `way` (3,) that is nearest to an axis."""
    way = way / max(np.linalg.norm(way), 1e-9)
    found = np.eye(3)[np.argmin(np.abs(way))]
    found = found - (found @ way) * way
    return found / np.linalg.norm(found)


def moved(light, step):
    """A `Light` whose place, or the unit vector to it, is moved by a `step` (3,)."""
    place = light.point[:3] + step
    if light.is_directional:
        place = place / np.linalg.norm(place)
    return replace(light, point=np.append(place, light.point[3]))


def faced_by_all(placements, points, normals):
    """Whether (n,) points (n, 3) with `normals` (n, 3) turn one side to all lights."""
    cosines = [(normals * each.light.directions_from(points)).sum(axis=1) for each in placements]
    return (np.min(cosines, axis=0) > 0) | (np.max(cosines, axis=0) < 0)


def arrives(scene, light, p, n):
    """Whether (points,) a shadow ray from surfaces at `p` with normals `n` reaches a `Light`."""
    import drjit as dr
    import mitsuba as mi

    surface = dr.zeros(mi.Interaction3f, dr.width(p))
    surface.p, surface.n = p, n
    place = light.point[:3].tolist()
    if light.is_directional:
        ray = surface.spawn_ray(dr.opaque(mi.Vector3f, place))
    else:
        ray = surface.spawn_ray_to(dr.opaque(mi.Point3f, place))
    return np.array(~scene.ray_test(ray))
