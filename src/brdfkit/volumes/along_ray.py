"""What integrators ask of a camera ray: where it is within a volume, and what it sees behind it."""

import drjit as dr


def within(ray, volume):
    """The distances at which a ray enters and leaves the box of a volume.

    The second is smaller if it misses. The box is oblique where the volume has a `to_local`.
    """
    import mitsuba as mi

    o, d = mi.Point3f(ray.o), mi.Vector3f(ray.d)
    low, high = (mi.Point3f(corner) for corner in (volume.bbox().min, volume.bbox().max))
    to_local = getattr(volume, "to_local", None)
    if to_local is not None:
        o, d, low, high = to_local @ o, to_local @ d, mi.Point3f(0), mi.Point3f(1)
    inverse = dr.rcp(d)
    a, b = (low - o) * inverse, (high - o) * inverse
    return dr.maximum(dr.max(dr.minimum(a, b)), 0), dr.min(dr.maximum(a, b))


def light_behind(scene, ray, active):
    """The distance of the first surface, and its own light, or that of the environment."""
    import mitsuba as mi

    si = scene.ray_intersect(mi.Ray3f(ray), active)
    emitter = si.emitter(scene)
    if emitter is None:  # it may be in scalar variants; elsewhere a missing one emits 0
        return si.t, mi.UnpolarizedSpectrum(0)
    return si.t, mi.unpolarized_spectrum(emitter.eval(si, active))
