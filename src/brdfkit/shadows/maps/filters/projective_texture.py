"""Projective shadow texture: casters in one flat colour, projected onto the receivers behind them.

The light draws the silhouettes of casters, and receivers look up whether a caster covers their
texel. For one shadow, an object is a caster or a receiver but never both, so that no object shadows
itself. In this implementation the map holds depths midway between the last surface of the first
shape on each ray and the next shape behind it. One comparison then tells whether a point belongs to
the caster or to a receiver. There is no acne and no bias is needed, but shapes that were merged
into one do not shadow each other.

[Ergun 2008, 2.2.1.1], [Woo 1992]
"""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, MitsubaObject
from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.maps.depth_pass import compute_depth, make_texel_rays, reshape_to_map
from brdfkit.shadows.maps.filters.depth import Lookup as Lookup
from brdfkit.shadows.maps.projection import AnyProjection

MAX_SURFACES = 64  # a ray stops after this many surfaces of one caster


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MitsubaObject:
    """Render the depths between casters and receivers, a `mi.TensorXf` (resolution, resolution)."""
    import mitsuba as mi

    opaque = projection.make_opaque()
    ray = make_texel_rays(scene, opaque, resolution)
    first = scene.ray_intersect_preliminary(ray)
    caster = dr.reinterpret_array(mi.UInt32, first.shape)

    def find_next(i: JitInt, last: JitFloat, t: JitFloat, shape: JitInt) -> tuple[Any, ...]:
        place = ray(t)
        begin = t + clearance(place, t)
        hit = scene.ray_intersect_preliminary(mi.Ray3f(ray(begin), ray.d))
        return i + 1, t, begin + hit.t, dr.reinterpret_array(mi.UInt32, hit.shape)

    _, last, t, _ = dr.while_loop(
        (mi.UInt32(0), mi.Float(first.t), mi.Float(first.t), mi.UInt32(caster)),
        lambda i, last, t, shape: first.is_valid() & (shape == caster) & (i < MAX_SURFACES),
        find_next,
    )
    depth = (compute_depth(opaque, ray(last)) + compute_depth(opaque, ray(t))) / 2
    return reshape_to_map(dr.select(first.is_valid() & dr.isfinite(t), depth, dr.inf), resolution)
