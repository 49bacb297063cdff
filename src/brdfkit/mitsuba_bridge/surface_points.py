"""Points on surfaces: their interactions, and rays that begin off the surface by a safe distance.

Because of rounding, a ray that begins exactly on a surface may hit it again. Mitsuba begins rays at
the distance ε (1 + |p|) from the surface, where |p| is the largest coordinate of the point p. In a
tiny world, such as an object of 10 µm in metres, the 1 is larger than the whole world, and a tenth
and more of the shadows are wrong. Here the distance is

    max(ε/2 |p|, ε/40 t),   t the distance from the eye to p

since both p and t were rounded. With twice or a quarter of ε/2, single pixels of leaves or of a
street differ between rays and shadow volumes. The factor of t is smaller, since with ε/2 a distant
eye would make rays begin half a house off the surface.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector, MitsubaObject


def make_interaction(
    ray: MitsubaObject, t: JitFloat, p: JitVector, n: JitVector, found: JitMask
) -> MitsubaObject:
    """Return the `mi.SurfaceInteraction3f` of rays at points `p` with the normals `n`.

    The texture coordinates are x and y of the point; t is infinite where no point was `found`. The
    tangent is the x axis projected onto the surface, or the z axis where the surface is upright.
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
    """Return how far off the surface rays from `p` begin; `t` is the distance from the eye to p."""
    import mitsuba as mi

    return mi.math.RayEpsilon * dr.maximum(0.025 * t, 0.5 * dr.max(dr.abs(p)))


def spawn_ray(p: JitVector, n: JitVector, t: JitFloat, direction: JitVector) -> MitsubaObject:
    """Return the `mi.Ray3f` from `p` in a direction, which begins off the surface of normal `n`.

    `t` is the distance from the eye to p.
    """
    import mitsuba as mi

    off = dr.mulsign(clearance(p, t), dr.dot(n, direction))
    return mi.Ray3f(p + off * mi.Vector3f(n), direction)
