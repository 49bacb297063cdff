"""Projective shadow texture: a silhouette of the casters, projected onto the receivers behind them.

The light draws the silhouettes of casters, and receivers look up whether a caster covers their
texel. For one shadow, an object is a caster or a receiver but never both, so no object shadows
itself: there is no acne, and no bias is needed.

In this implementation the caster of a texel is the first shape on its light ray. The map holds a
depth midway between the caster's last surface and the next shape behind it, so that one comparison
tells whether a point belongs to the caster. Shapes that were merged into one do not shadow each
other.

[Ergun 2008, 2.2.1.1], [Woo 1992]
"""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, MitsubaObject
from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.maps.depth_pass import compute_depth, make_texel_rays, reshape_to_map
from brdfkit.shadows.maps.filters.depth import Lookup as Lookup
from brdfkit.shadows.maps.projection import AnyProjection

MAX_SURFACES = 64  # largest number of surfaces of one caster that a light ray passes through


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MitsubaObject:
    """Render depths midway between caster and receiver, `mi.TensorXf` (resolution, resolution)."""
    import mitsuba as mi

    opaque = projection.make_opaque()
    ray = make_texel_rays(scene, opaque, resolution)
    first = scene.ray_intersect_preliminary(ray)
    caster = dr.reinterpret_array(mi.UInt32, first.shape)

    def find_next_surface(i: JitInt, last: JitFloat, t: JitFloat, shape: JitInt) -> tuple[Any, ...]:
        place = ray(t)
        begin = t + clearance(place, t)
        hit = scene.ray_intersect_preliminary(mi.Ray3f(ray(begin), ray.d))
        return i + 1, t, begin + hit.t, dr.reinterpret_array(mi.UInt32, hit.shape)

    _, last, t, _ = dr.while_loop(
        (mi.UInt32(0), mi.Float(first.t), mi.Float(first.t), mi.UInt32(caster)),
        lambda i, last, t, shape: first.is_valid() & (shape == caster) & (i < MAX_SURFACES),
        find_next_surface,
    )
    depth = (compute_depth(opaque, ray(last)) + compute_depth(opaque, ray(t))) / 2
    return reshape_to_map(dr.select(first.is_valid() & dr.isfinite(t), depth, dr.inf), resolution)
