"""Makes blurred shadow maps differentiable: depths that also know how silhouettes move.

Moment shadow maps store means of a function f of depth over many texels. Such a mean changes
smoothly as a shape moves, even where the depth jumps, at the silhouette of the shape. But a texel
holds the depth on a single ray, whose derivative does not notice a silhouette that passes.

The derivative of the integral of f over the map, with respect to a parameter θ of the scene, is

    ∂/∂θ ∫ f dA = ∫ ∂f/∂θ dA - ∮ [f] v·n ds

The first term is the derivative of the texels. The second one, which is added here, is an integral
over the silhouettes: [f] is the jump of f across the silhouette, n its normal on the map, s the
length along it, and v the velocity of the nearer surface on the map, its change with θ.

The integral becomes a sum over pairs of neighbouring texels that a silhouette separates. A pair in
a row stands for n_u ds = ±1, and a pair in a column for n_v ds = ±1, however the silhouette runs
between texels; u and v are the map's axes. Each texel of a pair gets half of the pair's term.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import MitsubaObject
from brdfkit.shadows.maps.depth_pass import compute_depth, make_texel_rays, reshape_to_map
from brdfkit.shadows.maps.map_point import plane_slopes
from brdfkit.shadows.maps.projection import AnyProjection

CONTINUOUS_STEP = 1e-3  # largest change of depth between texels that is no silhouette


@dataclass(frozen=True)
class TexelMotion:
    """The motion and the slope of the surfaces that a map's texels show, along one axis of the map.

    place : the coordinate of each texel's surface point on this axis [texels]. Its derivatives are
        those of a point that moves with its shape.
    slope : the change of depth per texel on this axis, in the surface's tangent plane.
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
        """Return the tensor `f`, a function of the depths, with the derivatives that edges add.

        Where a silhouette moves, the depth of a texel jumps. With the derivatives added, those of
        blurred means are right when shapes move; the values do not change.
        """
        if self.motions is None:
            return f
        return f + sum(
            self._compute_edge_derivatives(f, i, each) for i, each in enumerate(self.motions)
        )

    def _compute_edge_derivatives(
        self, f: MitsubaObject, axis: int, motion: TexelMotion
    ) -> MitsubaObject:
        """Return a tensor of zeros whose derivatives are those of `f` due to moving silhouettes.

        axis : the axis of the tensor along which neighbouring texels are compared.
        motion : motion of the surfaces along this axis.
        """
        with dr.suspend_grad():
            z, z_next = pair_neighbours(self.values, axis)
            slope, slope_next = pair_neighbours(motion.slope, axis)
            # A change of depth that the tangent plane of either texel explains is no silhouette
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
    """Return each value but the last along an axis of a tensor, and its next neighbour."""
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MovingDepths:
    """Render the depths that a light sees, and the motions of the surfaces if any has gradients."""
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
