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
between texels; u and v are the map's axes. The silhouette is taken to be halfway between the
centres of the texels, and [f] is the jump between their tangent planes there.

As a silhouette passes a texel, the mean changes at once. What is computed from the mean, such as a
bound on the light, may be curved, so its slope has to be taken halfway through the change: before
it, where the window may not yet hold one of the two depths, a bound can be so steep that a few
texels would outweigh all others. So derivatives are those of means whose first and last texels
count half, and of silhouettes between two texels of the window. Both depths then have weight.
"""

from collections.abc import Callable
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

    def average_with_derivatives(
        self, compute: Callable[[Any], list[Any]], blur: int
    ) -> MitsubaObject | None:
        """Return means of functions of the depths, with right derivatives as shapes move, or None.

        The means are a tensor (resolution, resolution, functions), over windows whose first and
        last texels count half. They are None if nothing moves.

        compute : function from a tensor of depths to a list of tensors.
        blur : number of texels on each side of a texel over which to average, at least 1.
        """
        if self.motions is None:
            return None
        steps = 2 * max(blur, 1)
        window = [0.5 / steps, *[1 / steps] * (steps - 1), 0.5 / steps]
        means = dr.stack(compute(self.values), axis=2)
        means = dr.convolve(means, window, axis=(0, 1), boundary="nearest")
        for axis, motion in enumerate(self.motions):
            edges = self._compute_edge_derivatives(compute, axis, motion)
            # A kernel of even length averages the edges between the texels of a window
            edges = dr.convolve(edges, [1 / steps] * steps, axis=axis)
            means += dr.convolve(edges, window, axis=1 - axis)
        return means

    def _compute_edge_derivatives(
        self, compute: Callable[[Any], list[Any]], axis: int, motion: TexelMotion
    ) -> MitsubaObject:
        """Return a tensor of zeros with the derivatives of functions due to moving silhouettes.

        Each texel has those of the silhouette between it and the next texel.

        compute : function from a tensor of depths to a list of tensors.
        axis : the axis of the tensors along which neighbouring texels are compared.
        motion : motion of the surfaces along this axis.
        """
        with dr.suspend_grad():
            z, z_next = pair_neighbours(self.values, axis)
            slope, slope_next = pair_neighbours(motion.slope, axis)
            # A change of depth that the tangent plane of either texel explains is no silhouette
            deepest = dr.maximum(dr.maximum(slope, slope_next), 0) + CONTINUOUS_STEP
            highest = dr.minimum(dr.minimum(slope, slope_next), 0) - CONTINUOUS_STEP
            here_nearer, next_nearer = z_next - z > deepest, z_next - z < highest
            f_here = compute(dr.clip(z + slope / 2, -1, 1))
            f_next = compute(dr.clip(z_next - slope_next / 2, -1, 1))
            jumps = [beyond - here for here, beyond in zip(f_here, f_next, strict=True)]
        moved, moved_next = pair_neighbours(motion.place - dr.detach(motion.place), axis)
        moved = dr.select(here_nearer, moved, dr.select(next_nearer, moved_next, 0))
        edges = dr.stack([-moved * jump for jump in jumps], axis=2)
        last = [1 if i == axis else size for i, size in enumerate(edges.shape)]
        return dr.concat([edges, dr.zeros(type(edges), last)], axis)


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
