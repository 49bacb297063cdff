"""Rays at the box of a volume, what lies behind it, and normals of surfaces within it."""

from collections.abc import Callable

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject

SMALLEST_COSINE = 1e-3  # between a bent normal and the direction to the eye


def to_cube(volume: MitsubaObject) -> MitsubaObject:
    """Return the transform from the world to the unit cube that is the volume's box.

    A volume with a `to_local` may be oblique; the box of any other is along the world's axes.
    """
    import mitsuba as mi

    if hasattr(volume, "to_local"):
        return volume.to_local
    box = volume.bbox()
    return mi.Transform4f().translate(box.min).scale(box.extents()).inverse()


def intersect_box(ray: MitsubaObject, volume: MitsubaObject) -> tuple[JitFloat, JitFloat]:
    """Return the distances at which a ray enters and leaves a volume's box.

    The second is smaller than the first if the ray misses the box.
    """
    import mitsuba as mi

    o, d = to_cube(volume) @ mi.Point3f(ray.o), to_cube(volume) @ mi.Vector3f(ray.d)
    inverse = dr.rcp(d)
    a, b = -o * inverse, (1 - o) * inverse
    return dr.maximum(dr.max(dr.minimum(a, b)), 0), dr.min(dr.maximum(a, b))


def light_behind(
    scene: MitsubaObject, ray: MitsubaObject, active: JitMask
) -> tuple[JitFloat, JitColour]:
    """Return the distance of the first surface, and its emission or that of the environment."""
    import mitsuba as mi

    si = scene.ray_intersect(mi.Ray3f(ray), active)
    emitter = si.emitter(scene)
    if emitter is None:  # only in scalar variants; elsewhere a missing emitter emits 0
        return si.t, mi.UnpolarizedSpectrum(0)
    return si.t, mi.unpolarized_spectrum(emitter.eval(si, active))


def gradient(f: Callable[[JitVector], JitFloat], p: JitVector, volume: MitsubaObject) -> JitVector:
    """Return ∇f at points `p`, by the differences between a voxel ahead and a voxel behind."""
    import mitsuba as mi

    to_world, size = to_cube(volume).inverse(), volume.resolution()
    slopes = mi.Normal3f()
    for axis in range(3):
        step = mi.Vector3f(0)
        step[axis] = 1 / size[axis]
        step = to_world @ step
        slopes[axis] = (f(p + step) - f(p - step)) * (size[axis] / 2)
    return mi.Vector3f(to_world @ slopes)  # gradients are transformed as normals are


def face_normal(p: JitVector, volume: MitsubaObject) -> JitVector:
    """Return the outward normal of the face of a volume's box on which the points `p` lie."""
    import mitsuba as mi

    beside = to_cube(volume) @ p - 0.5
    largest = dr.max(dr.abs(beside))
    normal = mi.Normal3f(dr.select(dr.abs(beside) == largest, dr.sign(beside), 0))
    return mi.Vector3f(dr.normalize(to_cube(volume).inverse() @ normal))


def bend_to_viewer(n: JitVector, d: JitVector) -> JitVector:
    """Bend the normal `n` towards the viewer where a ray of direction `d` would see its back.

    Normals by differences lean past the silhouette, where one-sided materials would be black.
    """
    behind = dr.maximum(dr.dot(n, d) + SMALLEST_COSINE, 0)
    return dr.normalize(n - d * behind)


def voxels_per_length(d: JitVector, volume: MitsubaObject) -> JitVector:
    """Return how many voxels a ray of direction `d` passes per unit of length, along each axis."""
    import mitsuba as mi

    return (to_cube(volume) @ mi.Vector3f(d)) * mi.Vector3f(volume.resolution())
