"""Geometry of rays and a volume's box: intersections, light from behind, normals and gradients."""

import json
import re
from collections.abc import Callable

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.properties.declarations import declare_radiance

# The parameter `background` of integrators of volumes
BACKGROUND = declare_radiance("radiance behind the volume, by default the environment's")
SMALLEST_COSINE = 1e-3  # cosine of the angle between a bent normal and the direction to the viewer


def get_world_to_cube(volume: MitsubaObject) -> MitsubaObject:
    """Return the transform from the world to the unit cube that the volume fills.

    It is the attribute `to_local` of brdfkit's volumes. Mitsuba's own volumes tell their bounding
    box along the world's axes, and an oblique one in their description alone.
    """
    import mitsuba as mi

    if hasattr(volume, "to_local"):
        return volume.to_local
    described = read_described_transform(str(volume))
    if described is not None and not is_along_axes(described):
        return mi.Transform4f(described)
    box = volume.bbox()
    return mi.Transform4f().translate(box.min).scale(box.extents()).inverse()


def read_described_transform(description: str) -> FloatArray | None:
    """Return the transform (4, 4) to the unit cube that a volume's description contains, or None.

    Its numbers have six digits.
    """
    found = re.search(r"to_local = Transform\[\s*matrix=(\[\[.*?\]\])", description, re.DOTALL)
    return None if found is None else np.array(json.loads(found[1]))


def is_along_axes(transform: FloatArray) -> bool:
    """Return whether a transform (4, 4) only scales and moves along the world's axes."""
    return not (transform[:3, :3] - np.diag(np.diag(transform)[:3])).any()


def get_visible_part(volume: MitsubaObject) -> tuple[JitVector | float, JitVector | float]:
    """Return the lowest and the highest corner of a volume's visible part, in its unit cube.

    The plugin `transfer_function` may be clipped to a part of its cube; other volumes are not.
    """
    return getattr(volume, "clip_low", 0.0), getattr(volume, "clip_high", 1.0)


def intersect_box(ray: MitsubaObject, volume: MitsubaObject) -> tuple[JitFloat, JitFloat]:
    """Return the distances at which a ray enters and leaves the visible part of a volume's box.

    The second distance is smaller than the first one if the ray misses the box.
    """
    import mitsuba as mi

    to_cube, (low, high) = get_world_to_cube(volume), get_visible_part(volume)
    o, inverse = to_cube @ mi.Point3f(ray.o), dr.rcp(to_cube @ mi.Vector3f(ray.d))
    a, b = (low - o) * inverse, (high - o) * inverse
    return dr.maximum(dr.max(dr.minimum(a, b)), 0), dr.min(dr.maximum(a, b))


def evaluate_light_behind(
    scene: MitsubaObject,
    ray: MitsubaObject,
    active: JitMask,
    background: JitColour | None,
    to_spectrum: Callable[[JitColour, MitsubaObject], JitColour],
) -> tuple[JitFloat, JitColour]:
    """Return the distance of the first surface along a ray, and the light emitted from there.

    Where there is no surface, the light is the `background`, a radiance in linear sRGB, or that of
    the environment map if the background is None. `to_spectrum` is the result of
    `make_rgb_emission()`, which the caller makes once.
    """
    import mitsuba as mi

    si = scene.ray_intersect(mi.Ray3f(ray), active)
    emitter, light = si.emitter(scene), mi.UnpolarizedSpectrum(0)
    if emitter is not None:  # in scalar variants; in others a missing emitter evaluates to 0
        light = mi.unpolarized_spectrum(emitter.eval(si, active))
    if background is not None:
        light = dr.select(si.is_valid(), light, to_spectrum(background, si))
    return si.t, light


def compute_gradient(
    f: Callable[[JitVector], JitFloat], p: JitVector, volume: MitsubaObject
) -> JitVector:
    """Return the gradient of a function `f` at points `p`, by differences between p ± one voxel."""
    import mitsuba as mi

    to_world, size = get_world_to_cube(volume).inverse(), volume.resolution()
    slopes = mi.Normal3f()
    for axis in range(3):
        step = mi.Vector3f(0)
        step[axis] = 1 / size[axis]
        step = to_world @ step
        slopes[axis] = (f(p + step) - f(p - step)) * (size[axis] / 2)
    return mi.Vector3f(to_world @ slopes)  # `Normal3f`, since gradients transform like normals


def face_normal(p: JitVector, volume: MitsubaObject) -> JitVector:
    """Return the outward unit normal of the visible box's face on which the points `p` lie."""
    import mitsuba as mi

    low, high = get_visible_part(volume)
    beside = (get_world_to_cube(volume) @ p - low) / (high - low) - 0.5
    largest = dr.max(dr.abs(beside))
    normal = mi.Normal3f(dr.select(dr.abs(beside) == largest, dr.sign(beside), 0))
    return mi.Vector3f(dr.normalize(get_world_to_cube(volume).inverse() @ normal))


def bend_normal_to_viewer(n: JitVector, d: JitVector) -> JitVector:
    """Bend normals `n` towards the viewer where rays of direction `d` would meet their back.

    Near silhouettes, normals from central differences may face away from the viewer, and one-sided
    materials would be black there.
    """
    behind = dr.maximum(dr.dot(n, d) + SMALLEST_COSINE, 0)
    return dr.normalize(n - d * behind)


def count_voxels_per_length(d: JitVector, volume: MitsubaObject) -> JitVector:
    """Return the number of voxels that rays of direction `d` pass per unit of length on each axis.

    The numbers have signs, since they are components along the axes of the grid.
    """
    import mitsuba as mi

    return (get_world_to_cube(volume) @ mi.Vector3f(d)) * mi.Vector3f(volume.resolution())
