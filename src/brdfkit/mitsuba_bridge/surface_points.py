"""Points on surfaces: their interactions, and rays that begin off the surface by a safe distance.

Rounding would make a ray hit the surface that it begins on. Mitsuba begins its rays at ε (1 + max
|p_i|). In a world of 1e-5, such as an object of 10 µm in metres, the 1 is larger than the whole
world, and a tenth and more of the shadows are wrong. Here the distance is

    max(ε/2 |p|, ε/40 t),   |p| the largest coordinate, t the distance from the eye to p

since both the point and the distance were rounded. Half of Mitsuba's ε is as far as in scenes of
usual size. With twice or a quarter of it, single pixels of leaves or of a street differ between
rays and shadow volumes. A share ε/2 of t would be too long for a distant eye: half of a house.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector, MitsubaObject


def make_interaction(
    ray: MitsubaObject, t: JitFloat, p: JitVector, n: JitVector, found: JitMask
) -> MitsubaObject:
    """Return the `mi.SurfaceInteraction3f` of rays at points p with the normals n.

    u and v are x and y; t is infinite where no point was `found`. The tangent is the x axis
    projected onto the surface, or the z axis where the surface stands upright.
    """
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(t))
    si.t, si.p = dr.select(found, t, dr.inf), p
    si.time, si.wavelengths = ray.time, ray.wavelengths
    si.n = si.sh_frame.n = mi.Normal3f(n)
    si.uv = mi.Point2f(si.p.x, si.p.y)
    upright = dr.abs(n.x) > 0.999
    si.dp_du = mi.Vector3f(dr.select(upright, 0, 1), 0, dr.select(upright, 1, 0))
    si.dp_dv = mi.Vector3f(0, 1, 0)
    si.initialize_sh_frame()
    si.wi = si.to_local(-ray.d)
    return si


def clearance(p: JitVector, t: JitFloat) -> JitFloat:
    """Return how far off a surface rays from `p` begin, which the eye sees at the distance `t`."""
    import mitsuba as mi

    return mi.math.RayEpsilon * dr.maximum(0.025 * t, 0.5 * dr.max(dr.abs(p)))


def spawn_ray(p: JitVector, n: JitVector, t: JitFloat, direction: JitVector) -> MitsubaObject:
    """Return the `mi.Ray3f` from `p`, which begins off the surface with the normal `n`."""
    import mitsuba as mi

    off = dr.mulsign(clearance(p, t), dr.dot(n, direction))
    return mi.Ray3f(p + off * mi.Vector3f(n), direction)
