"""The first pass of shadow mapping: trace rays from the light and store the depths they reach."""

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector, MitsubaObject
from brdfkit.shadows.maps.projection import AnyProjection


def render_depths(
    scene: MitsubaObject, projection: AnyProjection, resolution: int
) -> MitsubaObject:
    """Render a shadow map: the depths that a light sees, a `mi.TensorXf` (resolution, resolution).

    The first row is at y = -1 of the map. A texel holds the depth of the first surface on its light
    ray, or infinity if there is none. The depth is below -1 if the surface is nearer to the light
    than the region that the projection encloses. The depths keep their derivatives with respect to
    the scene's geometry.
    """
    opaque = projection.make_opaque()
    si = scene.ray_intersect(make_texel_rays(scene, opaque, resolution))
    return reshape_to_map(dr.select(si.is_valid(), compute_depth(opaque, si.p), dr.inf), resolution)


def make_texel_rays(scene: MitsubaObject, opaque: AnyProjection, resolution: int) -> MitsubaObject:
    """Return the `mi.Ray3f` from the light through the centre of each texel of a shadow map.

    Rays of a directional light start outside the scene.

    opaque : the map's projection, in opaque Dr.Jit numbers (`make_opaque`).
    """
    import mitsuba as mi

    index = dr.arange(mi.UInt32, resolution**2)
    texel = dr.opaque(mi.Float, 2 / resolution)
    side = dr.opaque(mi.UInt32, resolution)
    x = (mi.Float(index % side) + 0.5) * texel - 1
    y = (mi.Float(index // side) + 0.5) * texel - 1
    origin, direction = (mi.Vector3f(*vector) for vector in opaque.light_ray(x, y))
    if opaque.light.is_directional:
        bounds = scene.bbox()
        radius = float(np.linalg.norm(np.ravel(bounds.extents()))) / 2
        away: JitFloat = dr.norm(origin - mi.Vector3f(bounds.center()))
        away = away + dr.opaque(mi.Float, radius)
        origin -= away * direction
    return mi.Ray3f(mi.Point3f(origin), direction)


def compute_depth(opaque: AnyProjection, p: JitVector) -> JitFloat:
    """Return the depth that points `p` have in a map; infinity where they cannot be projected.

    opaque : the map's projection, in opaque Dr.Jit numbers (`make_opaque`).
    """
    return dr.select(opaque.is_projectable(*p), opaque.project(*p)[2], dr.inf)


def reshape_to_map(values: JitFloat, resolution: int) -> MitsubaObject:
    """Return one value per texel as a `mi.TensorXf` (resolution, resolution)."""
    import mitsuba as mi

    return mi.TensorXf(values, (resolution, resolution))
