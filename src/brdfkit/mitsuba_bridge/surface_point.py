"""Points of surfaces that are no shapes of Mitsuba's, as its BSDFs and emitters want them."""

import drjit as dr


def interaction(ray, t, p, n, found):
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
