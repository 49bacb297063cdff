"""`ShadowedLight`: a filtered light as the points of a scene see it, with shadows."""

from brdfkit.lighting.visibility.lobes import visible_share

RAYS = 4  # per lobe


class ShadowedLight:
    """A filtered `light` times its visible share: of each lobe, and of the irradiance.

    si : the points, a `mitsuba.SurfaceInteraction3f`.
    visible : a function of directions, `mitsuba.Vector3f`, to whether the points see that far.
    drawn : directions from which the light comes, see `DrawnLight`.

    Directions count by the light that comes from them, so that a shadow is that of the lamp which
    is hidden; those below the surface do not count.
    """

    def __init__(self, light, si, visible, drawn):
        self.light, self.si, self.visible, self.drawn = light, si, visible, drawn

    def mean_over_lobe(self, axis, kappa):
        """Mean radiance over a von Mises-Fisher lobe, linear sRGB."""
        import drjit as dr

        normal = self.si.to_world(type(axis)(0, 0, dr.sign(self.si.wi.z)))

        def weight(direction):
            found = self.light.mean_over_lobe(direction, kappa * RAYS)
            return dr.select(dr.dot(direction, normal) > 0, found, 0)

        share = visible_share(self.visible, axis, kappa, weight, RAYS)
        return self.light.mean_over_lobe(axis, kappa) * share

    def irradiance(self, normal):
        """What a white matte surface of this `normal` shows, linear sRGB."""
        import drjit as dr
        import mitsuba as mi

        ray = dr.arange(mi.UInt32, dr.width(normal)) % self.drawn.rays

        def add(i, seen, total):
            direction, power = self.drawn.at(i, ray)
            received = power * dr.maximum(dr.dot(direction, normal), 0)
            return i + 1, seen + dr.select(self.visible(direction), received, 0), total + received

        _, seen, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0), mi.Color3f(0)),
            lambda i, seen, total: i < self.drawn.per_ray,
            add,
        )
        return self.light.irradiance(normal) * dr.select(total > 0, seen / total, 1)
