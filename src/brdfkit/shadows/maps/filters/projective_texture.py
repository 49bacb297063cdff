"""Projective shadow texture: casters in one flat colour, projected onto the receivers behind them.

The light draws the silhouettes of casters, and receivers look up whether one covers their texel.
An object is a caster or a receiver of one shadow, never both, so that none shadows itself. Here a
map holds depths midway between each caster's last surface and the first of another shape behind it;
one look-up tells which of the two a point belongs to. There is no acne and no bias; shapes that
were merged into one do not shadow each other.

[Ergun 2008, 2.2.1.1], [Woo 1992]
"""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, MitsubaObject
from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.maps.depth_pass import depth_of, texel_rays, to_square
from brdfkit.shadows.maps.filters.depth import Lookup as Lookup
from brdfkit.shadows.maps.projection import AnyProjection

MAX_SURFACES = 64  # the most surfaces of one caster that a ray passes through


def render_map(scene: MitsubaObject, projection: AnyProjection, resolution: int) -> MitsubaObject:
    """Render the `mi.TensorXf` (resolution, resolution) of depths between casters and receivers."""
    import mitsuba as mi

    opaque = projection.opaque()
    ray = texel_rays(scene, opaque, resolution)
    first = scene.ray_intersect_preliminary(ray)
    caster = dr.reinterpret_array(mi.UInt32, first.shape)

    def step(i: JitInt, last: JitFloat, t: JitFloat, shape: JitInt) -> tuple[Any, ...]:
        place = ray(t)
        begin = t + clearance(place, t)
        hit = scene.ray_intersect_preliminary(mi.Ray3f(ray(begin), ray.d))
        return i + 1, t, begin + hit.t, dr.reinterpret_array(mi.UInt32, hit.shape)

    _, last, t, _ = dr.while_loop(
        (mi.UInt32(0), mi.Float(first.t), mi.Float(first.t), mi.UInt32(caster)),
        lambda i, last, t, shape: first.is_valid() & (shape == caster) & (i < MAX_SURFACES),
        step,
    )
    depth = (depth_of(opaque, ray(last)) + depth_of(opaque, ray(t))) / 2
    return to_square(dr.select(first.is_valid() & dr.isfinite(t), depth, dr.inf), resolution)
