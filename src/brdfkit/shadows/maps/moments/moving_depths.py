"""Depths that also know how silhouettes move, so that their blurred means have right derivatives.

A texel holds the depth that one ray meets. Its derivative says how the surface moves along that
ray, but nothing about a silhouette that passes, where the depth jumps. The mean of any function f
of depth, though, changes steadily as a silhouette moves with the velocity v over the map:

    ∂/∂θ ∫ f dA = ∫ ∂f/∂θ dA - ∮ [f] v·n ds

θ is the parameter, n the silhouette's normal and s the length along it. [f] is the jump of f across
it, and v the velocity of the point on the nearer surface, which moves with its shape.

Along rows of texels, each pair of neighbours on either side of the silhouette stands for n_u ds =
±1, along columns for n_v ds = ±1. So the sum of these steps times v is the second integral,
whatever the silhouette's course between the texels. Each of the two texels gets half of it.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import MitsubaObject
from brdfkit.shadows.maps.depth_pass import compute_depth, make_texel_rays, reshape_to_map
from brdfkit.shadows.maps.map_point import plane_slopes
from brdfkit.shadows.maps.projection import AnyProjection

CONTINUOUS_STEP = 1e-3  # steps of depth between texels below this one are no silhouettes


@dataclass(frozen=True)
class TexelMotion:
    """The motion and the slope of the surfaces that a map's texels show, along one axis of the map.

    place : coordinates of the surface points [texels], with the derivatives of points that move
        with their shapes.
    slope : change of depth in the planes of the surfaces, per texel.
    """

    place: Any
    slope: Any


@dataclass(frozen=True)
class MovingDepths:
    """The depths of a shadow map, and the motions of the surfaces that it shows.

    values : depths (resolution, resolution), in [-1, 1].
    motions : motions along the first axis of `values` and along the second; None if nothing moves.
    """

    values: Any
    motions: tuple[TexelMotion, TexelMotion] | None = None

    def attach_edge_derivatives(self, f: MitsubaObject) -> MitsubaObject:
        """Return the tensor `f`, a function of the depths, with the derivatives due to silhouettes.

        Blurred means of the result change as they should when shapes move.
        """
        if self.motions is None:
            return f
        return f + sum(self._edge_derivatives(f, i, each) for i, each in enumerate(self.motions))

    def _edge_derivatives(self, f: MitsubaObject, axis: int, motion: TexelMotion) -> MitsubaObject:
        """Return zeros that carry the derivatives of `f` by silhouettes across an axis.

        motion : motion of the surfaces along the axis.
        """
        with dr.suspend_grad():
            z, z_next = pair_neighbours(self.values, axis)
            slope, slope_next = pair_neighbours(motion.slope, axis)
            # Depths that continue in either texel's plane are an edge between faces, no silhouette
            deepest = dr.maximum(dr.maximum(slope, slope_next), 0) + CONTINUOUS_STEP
            highest = dr.minimum(dr.minimum(slope, slope_next), 0) - CONTINUOUS_STEP
            here_nearer, next_nearer = z_next - z > deepest, z_next - z < highest
            f_here, f_next = pair_neighbours(f, axis)
            jump = f_next - f_here
        moved, moved_next = pair_neighbours(motion.place - dr.detach(motion.place), axis)
        moved = dr.select(here_nearer, moved, dr.select(next_nearer, moved_next, 0))
        half = -moved * jump / 2
        none = dr.zeros(type(half), (1, half.shape[1]) if axis == 0 else (half.shape[0], 1))
        return dr.concat([half, none], axis) + dr.concat([none, half], axis)


def pair_neighbours(values: MitsubaObject, axis: int) -> tuple[MitsubaObject, MitsubaObject]:
    """Return a tensor without its last values on an axis, and without its first ones."""
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MovingDepths:
    """Render the depths that a light sees, as `render_depths` does, with the surfaces' motions."""
    import mitsuba as mi

    opaque, half = projection.make_opaque(), dr.opaque(mi.Float, resolution / 2)
    ray = make_texel_rays(scene, opaque, resolution)
    hit = scene.ray_intersect_preliminary(ray)
    si = hit.compute_surface_interaction(ray)
    valid = si.is_valid() & opaque.is_projectable(*si.p)
    depths = dr.select(si.is_valid(), compute_depth(opaque, si.p), dr.inf)
    values = dr.clip(reshape_to_map(depths, resolution), -1, 1)
    if not dr.grad_enabled(values):
        return MovingDepths(values)

    moving = hit.compute_surface_interaction(ray, mi.RayFlags.All | mi.RayFlags.FollowShape)
    places = opaque.project(*moving.p)
    with dr.suspend_grad():
        slopes = plane_slopes(opaque, half, si.p, si.n)
    u, v = (
        TexelMotion(
            reshape_to_map(dr.select(valid, half * place, 0), resolution),
            reshape_to_map(dr.select(valid, slope, 0), resolution),
        )
        for place, slope in zip(places[:2], slopes[:2], strict=True)
    )
    return MovingDepths(values, (v, u))
