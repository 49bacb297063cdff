"""Depths with the derivatives of their edges, for maps that are averaged.

A texel holds the depth that one ray meets. Its derivative says how the surface moves along that
ray, and nothing of a silhouette that passes: there the depth jumps. But the mean of any function f
of depth changes steadily as a silhouette moves with the velocity v over the map:

    ∂/∂θ ∫ f dA = ∫ ∂f/∂θ dA - ∮ [f] v·n ds

[f] is the jump of f, and v that of the nearer surface's point, which moves with its shape. Along
rows of texels each pair across the silhouette stands for n_u ds = ±1, along columns for n_v ds; so
their products with v sum up to the second integral, whatever the silhouette's course between them.
Half of each goes to both texels.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.shadows.maps.depth_pass import depth_of, rays_of_light, square
from brdfkit.shadows.maps.map_point import plane_on_map

CONTINUOUS = 1e-3  # of depths: a step that is no silhouette


@dataclass(frozen=True)
class Side:
    """Of the surfaces in all texels, along rows or columns of the map.

    place : where they are [texels], with the derivatives of points that move with their shapes.
    slope : the change of depth in their planes, per texel.
    """

    place: Any
    slope: Any


@dataclass(frozen=True)
class MovingDepths:
    """The `values` (resolution, resolution) of a map, and the `Side`s along columns and rows of
    texels; None where nothing moves."""

    values: Any
    sides: tuple[Side, Side] | None = None

    def averaged(self, f):
        """The tensor `f` of the depths, with the derivatives of its means."""
        if self.sides is None:
            return f
        return f + sum(self._across(f, axis, side) for axis, side in enumerate(self.sides))

    def _across(self, f, axis, side):
        """0, with the derivatives by the silhouettes between neighbours along an axis."""
        with dr.suspend_grad():
            (z, z_next), (slope, slope_next) = pairs(self.values, axis), pairs(side.slope, axis)
            # where two faces meet the depth goes on in the plane of one of them
            deepest = dr.maximum(dr.maximum(slope, slope_next), 0) + CONTINUOUS
            highest = dr.minimum(dr.minimum(slope, slope_next), 0) - CONTINUOUS
            here_nearer, next_nearer = z_next - z > deepest, z_next - z < highest
            f_here, f_next = pairs(f, axis)
            jump = f_next - f_here
        moved, moved_next = pairs(side.place - dr.detach(side.place), axis)
        moved = dr.select(here_nearer, moved, dr.select(next_nearer, moved_next, 0))
        half = -moved * jump / 2
        none = dr.zeros(type(half), (1, half.shape[1]) if axis == 0 else (half.shape[0], 1))
        return dr.concat([half, none], axis) + dr.concat([none, half], axis)


def pairs(values, axis):
    """Each value but the last of an axis, and its next."""
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])


def see(scene, projection, resolution):
    """The `MovingDepths` that the light sees, as `depth_pass` does."""
    import mitsuba as mi

    opaque, half = projection.opaque(), dr.opaque(mi.Float, resolution / 2)
    ray = rays_of_light(scene, opaque, resolution)
    hit = scene.ray_intersect_preliminary(ray)
    si = hit.compute_surface_interaction(ray)
    valid = si.is_valid() & opaque.is_before(*si.p)
    depths = square(dr.select(si.is_valid(), depth_of(opaque, si.p), dr.inf), resolution)
    values = dr.clip(depths, -1, 1)
    if not dr.grad_enabled(values):
        return MovingDepths(values)

    moving = hit.compute_surface_interaction(ray, mi.RayFlags.All | mi.RayFlags.FollowShape)
    places = opaque.to_map(*moving.p)
    with dr.suspend_grad():
        slopes = plane_on_map(opaque, half, si.p, si.n)
    u, v = (
        Side(
            square(dr.select(valid, half * place, 0), resolution),
            square(dr.select(valid, slope, 0), resolution),
        )
        for place, slope in zip(places[:2], slopes[:2], strict=True)
    )
    return MovingDepths(values, (v, u))
