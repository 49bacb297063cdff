"""Shadows in filtered light: it is multiplied by the visible share of the lobe or hemisphere."""

import math
from collections.abc import Callable
from typing import TypeAlias

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.lighting.filtering.filtered_light import Light, LightDirections

Visible: TypeAlias = Callable[[JitVector], JitMask]

GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))
RAYS = 4  # number of shadow rays per lobe of light


class ShadowedLight:
    """Filtered light with shadows: look-ups of a `light` are multiplied by their visible shares.

    `si` are the lit points, a `mi.SurfaceInteraction3f`, and `visible(direction)` returns whether
    light from a direction reaches them. `directions` sample the light in proportion to its
    brightness, so that hidden lamps cast shadows in the irradiance. Shadow rays have `sharpness`
    times the concentration of the lobe of light: more than 1 where lobes overlap each other, since
    light from around an obstacle would leak into the darkest shadow.
    """

    def __init__(
        self,
        light: Light,
        si: MitsubaObject,
        visible: Visible,
        directions: LightDirections,
        sharpness: float = 1.0,
    ) -> None:
        self.light, self.si, self.visible, self.directions = light, si, visible, directions
        self.sharpness = sharpness

    def mean_radiance_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean visible radiance, in linear sRGB, over a von Mises-Fisher lobe."""
        import drjit as dr

        normal = self.si.to_world(type(axis)(0, 0, dr.sign(self.si.wi.z)))
        sharp = kappa * self.sharpness

        def weigh_direction(direction: JitVector) -> JitColour:
            radiance = self.light.mean_radiance_over_lobe(direction, sharp * RAYS)
            return dr.select(dr.dot(direction, normal) > 0, radiance, 0)

        share = visible_share(self.visible, axis, sharp, weigh_direction, RAYS)
        return self.light.mean_radiance_over_lobe(axis, kappa) * share

    def irradiance(self, normal: JitVector) -> JitColour:
        """Return the visible irradiance for this `normal` divided by π, in linear sRGB."""
        import drjit as dr
        import mitsuba as mi

        ray = dr.arange(mi.UInt32, dr.width(normal)) % self.directions.rays

        def add_direction(
            i: JitInt, seen: JitColour, total: JitColour
        ) -> tuple[JitInt, JitColour, JitColour]:
            direction, power = self.directions.get_direction(i, ray)
            received = power * dr.maximum(dr.dot(direction, normal), 0)
            return i + 1, seen + dr.select(self.visible(direction), received, 0), total + received

        _, seen, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0), mi.Color3f(0)),
            lambda i, seen, total: i < self.directions.per_ray,
            add_direction,
        )
        return self.light.irradiance(normal) * dr.select(total > 0, seen / total, 1)


def visible_share(
    visible: Visible,
    axes: JitVector,
    kappa: JitFloat,
    weight: Callable[[JitVector], JitColour],
    rays: int = 16,
) -> JitColour:
    """Return the visible share (0 to 1, by channel) of von Mises-Fisher lobes.

    It is ∫ g(ω; μ, κ) L(ω) V(ω) dω / ∫ g(ω; μ, κ) L(ω) dω, with the lobe g of axis μ and
    concentration κ > 0, the visibility V (`visible`) and the weight L (`weight`), both functions of
    directions in the world; or 1 where the weight is 0. It is estimated by as many shadow rays as
    `rays`, on a spiral of equal probabilities, with an error of about 1 / rays.
    """
    import drjit as dr
    import mitsuba as mi

    frame = mi.Frame3f(axes)

    def add_ray(
        i: JitInt, seen: JitColour, total: JitColour
    ) -> tuple[JitInt, JitColour, JitColour]:
        # The cosines of the rays to the axis are those in the middle of rings of equal probability
        x = (mi.Float(i) + 0.5) / rays
        cos = 1 + dr.log(x + (1 - x) * dr.exp(-2 * kappa)) / kappa
        sin = dr.safe_sqrt(1 - cos * cos)
        sin_phi, cos_phi = dr.sincos(mi.Float(i) * GOLDEN_ANGLE)
        direction = frame.to_world(mi.Vector3f(sin * cos_phi, sin * sin_phi, cos))
        counted = mi.Color3f(weight(direction))
        return i + 1, seen + dr.select(visible(direction), counted, 0), total + counted

    count = mi.UInt32(rays)
    dr.make_opaque(count)
    _, seen, total = dr.while_loop(
        (mi.UInt32(0), mi.Color3f(0), mi.Color3f(0)), lambda i, seen, total: i < count, add_ray
    )
    return dr.select(total > 0, seen / total, 1)
