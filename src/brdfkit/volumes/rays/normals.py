"""Which way a surface in a volume looks: gradients of a function of its values, and box faces."""

import drjit as dr

from brdfkit.volumes.rays.along_ray import to_cube

EDGE = 1e-3  # the least cosine to the eye


def gradient(f, p, volume):
    """∇f at points p, by the differences between a voxel ahead and a voxel behind."""
    import mitsuba as mi

    to_world, size = to_cube(volume).inverse(), volume.resolution()
    slopes = mi.Normal3f()
    for axis in range(3):
        step = mi.Vector3f(0)
        step[axis] = 1 / size[axis]
        step = to_world @ step
        slopes[axis] = (f(p + step) - f(p - step)) * (size[axis] / 2)
    return mi.Vector3f(to_world @ slopes)  # as normals are transformed


def face_normal(p, volume):
    """The normal, outwards, of the face of a volume's box that the points p are on."""
    import mitsuba as mi

    beside = to_cube(volume) @ p - 0.5
    largest = dr.max(dr.abs(beside))
    normal = mi.Normal3f(dr.select(dr.abs(beside) == largest, dr.sign(beside), 0))
    return mi.Vector3f(dr.normalize(to_cube(volume).inverse() @ normal))


def facing(n, d):
    """The normal n, bent where a ray of direction d sees its back, until it sees its edge.

    Normals by differences lean past the silhouette, where materials with one side would be black.
    """
    behind = dr.maximum(dr.dot(n, d) + EDGE, 0)
    return dr.normalize(n - d * behind)


def per_voxel(d, volume):
    """How many voxels a ray of direction d passes per unit of length, along each axis."""
    import mitsuba as mi

    return (to_cube(volume) @ mi.Vector3f(d)) * mi.Vector3f(volume.resolution())
