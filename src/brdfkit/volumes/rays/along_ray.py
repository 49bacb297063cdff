"""What integrators ask of a ray: where it is within a volume's box, and what it sees behind it."""

import drjit as dr


def to_cube(volume):
    """The transform from the world to the unit cube that the volume's box is.

    That of a volume with a `to_local` may be oblique; that of another is along the world's axes.
    """
    import mitsuba as mi

    if hasattr(volume, "to_local"):
        return volume.to_local
    box = volume.bbox()
    return mi.Transform4f().translate(box.min).scale(box.extents()).inverse()


def within(ray, volume):
    """The distances at which a ray enters and leaves a volume's box; the second is smaller if it
    misses."""
    import mitsuba as mi

    o, d = to_cube(volume) @ mi.Point3f(ray.o), to_cube(volume) @ mi.Vector3f(ray.d)
    inverse = dr.rcp(d)
    a, b = -o * inverse, (1 - o) * inverse
    return dr.maximum(dr.max(dr.minimum(a, b)), 0), dr.min(dr.maximum(a, b))


def light_behind(scene, ray, active):
    """The distance of the first surface, and its own light, or that of the environment."""
    import mitsuba as mi

    si = scene.ray_intersect(mi.Ray3f(ray), active)
    emitter = si.emitter(scene)
    if emitter is None:  # it may be in scalar variants; elsewhere a missing one emits 0
        return si.t, mi.UnpolarizedSpectrum(0)
    return si.t, mi.unpolarized_spectrum(emitter.eval(si, active))
