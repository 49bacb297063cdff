"""How far off a surface rays begin, lest rounding make them meet it: over the scale of the world.

Rays of Mitsuba begin at ε (1 + max |p_i|). In a world of 1e-5, one in metres of an object of 10 µm,
the 1 leaps over all there is: a tenth and more of the shadows are wrong. Here

    max(ε/2 |p|, ε/40 t),   |p| the largest coordinate, t the distance from which p was seen

since both the point and the distance were rounded on the way, the distance once. Half of Mitsuba's
ε is as far as in scenes of usual size; with twice or a quarter of it, single pixels of leaves or of
a street differ between rays and shadow volumes. As much of t would be half a house from afar.
"""

import drjit as dr


def make_interaction(ray, t, p, n, found):
    """The `mi.SurfaceInteraction3f` at p: u and v are x and y, the tangent is the x axis laid onto
    the surface; where that stands upright, the z axis."""
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


def clearance(p, t):
    """The length off a surface at `p`, a point that was seen from the distance `t`."""
    import mitsuba as mi

    return mi.math.RayEpsilon * dr.maximum(0.025 * t, 0.5 * dr.max(dr.abs(p)))


def spawn_ray(p, n, t, direction):
    """The `mi.Ray3f` from a surface at `p` with the normal `n`, on the side of its direction."""
    import mitsuba as mi

    off = dr.mulsign(clearance(p, t), dr.dot(n, direction))
    return mi.Ray3f(p + off * mi.Vector3f(n), direction)
