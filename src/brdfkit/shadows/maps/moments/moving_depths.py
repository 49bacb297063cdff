"""Depths with the derivatives of their edges, for maps that are averaged.

A texel holds the depth that one ray meets. Its derivative says how the surface moves along that
ray, but nothing about a silhouette that passes, where the depth jumps. The mean of any function f
of depth, though, changes steadily as a silhouette moves with the velocity v over the map:

    ∂/∂θ ∫ f dA = ∫ ∂f/∂θ dA - ∮ [f] v·n ds

θ is the parameter, n the silhouette's normal and s the length along it. [f] is the jump of f, and v
the velocity of the nearer surface's point, which moves with its shape. Along rows of texels each
pair across the silhouette stands for n_u ds = ±1, along columns for n_v ds. So their products with
v sum up to the second integral, whatever the silhouette's course between them. Half of each goes to
both texels.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import MitsubaObject
from brdfkit.shadows.maps.depth_pass import depth_of, texel_rays, to_square
from brdfkit.shadows.maps.map_point import plane_slopes
from brdfkit.shadows.maps.projection import AnyProjection

CONTINUOUS_STEP = 1e-3  # a smaller step of depth between texels is no silhouette


@dataclass(frozen=True)
class TexelMotion:
    """The motion and the slope, along one axis of the map, of the surfaces in all texels.

    place : their places [texels], with the derivatives of points that move with their shapes.
    slope : the change of depth in their planes, per texel.
    """

    place: Any
    slope: Any


@dataclass(frozen=True)
class MovingDepths:
    """The depths of a map, and the motions of their surfaces.

    values : (resolution, resolution).
    motions : along columns and rows of texels; None where nothing moves.
    """

    values: Any
    motions: tuple[TexelMotion, TexelMotion] | None = None

    def attach_edges(self, f: MitsubaObject) -> MitsubaObject:
        """Return the tensor `f` of a function of the depths, with the derivatives of its means."""
        if self.motions is None:
            return f
        return f + sum(self._edges(f, axis, motion) for axis, motion in enumerate(self.motions))

    def _edges(self, f: MitsubaObject, axis: int, motion: TexelMotion) -> MitsubaObject:
        """Return 0, with the derivatives by the silhouettes between neighbours along an axis."""
        with dr.suspend_grad():
            z, z_next = pair_neighbours(self.values, axis)
            slope, slope_next = pair_neighbours(motion.slope, axis)
            # Where two faces meet, the depth continues in the plane of one of them
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
    """Return each value but the last of an axis, and the next one."""
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MovingDepths:
    """Render the depths that the light sees, as `render_depths` does, with their motions."""
    import mitsuba as mi

    opaque, half = projection.opaque(), dr.opaque(mi.Float, resolution / 2)
    ray = texel_rays(scene, opaque, resolution)
    hit = scene.ray_intersect_preliminary(ray)
    si = hit.compute_surface_interaction(ray)
    valid = si.is_valid() & opaque.is_before(*si.p)
    depths = to_square(dr.select(si.is_valid(), depth_of(opaque, si.p), dr.inf), resolution)
    values = dr.clip(depths, -1, 1)
    if not dr.grad_enabled(values):
        return MovingDepths(values)

    moving = hit.compute_surface_interaction(ray, mi.RayFlags.All | mi.RayFlags.FollowShape)
    places = opaque.to_map(*moving.p)
    with dr.suspend_grad():
        slopes = plane_slopes(opaque, half, si.p, si.n)
    u, v = (
        TexelMotion(
            to_square(dr.select(valid, half * place, 0), resolution),
            to_square(dr.select(valid, slope, 0), resolution),
        )
        for place, slope in zip(places[:2], slopes[:2], strict=True)
    )
    return MovingDepths(values, (v, u))
