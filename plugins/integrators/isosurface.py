"""Isosurface: the surface on which a volume has one value, of any material, in direct light.

    {"type": "isosurface", "volume": {...}, "level": 110.0, "bsdf": {"type": "ggx"}}

Inside is where F = V - `level` > 0; of a volume of the type `transfer_function`, where its A is
above the level. The first point of a ray that is inside is looked for at the ends of `steps` equal
parts of its way through the volume's box, and then refined, so that no picture shows the parts:
without that the surface lies half a part too deep, and D / (N + 1) of a way D with N random points,
as in [Lesar 2018, eq. 6.2]. What is thinner than a part may be missed. A box that cuts the solid
shows its face.

The normal is -∇F, by differences of a voxel to each side, which is smoother than the derivative of
the interpolated values. `bsdf` is the material, white and matte by default; u and v are x and y,
the tangent is the x axis laid onto the surface. Every light of the scene lights it, drawn by the
lights and by the bsdf. With `shadows` the surface, too, hides lights from itself; shapes do in any
case, and are seen by their own light alone.

Derivatives go to the values, the level, the transfer function, the bsdf and the lights: the
surface moves as F changes. What appears or vanishes at a silhouette or at the edge of a shadow is
missing in them.
"""

import drjit as dr
import numpy as np

from brdfkit.mitsuba_bridge.check_scenes import through_unit_cube
from brdfkit.mitsuba_bridge.properties.declarations import (
    bsdf,
    count,
    declared,
    flag,
    number,
    volume,
)
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar
from brdfkit.mitsuba_bridge.surface_points import interaction
from brdfkit.volumes.light.surface_light import direct_light
from brdfkit.volumes.rays.along_ray import light_behind, within
from brdfkit.volumes.rays.first_crossing import first_above, first_crossing, reattach
from brdfkit.volumes.rays.normals import face_normal, facing, gradient, per_voxel

PARAMETERS = {
    "volume": volume(1.0, "the values, or of the type transfer_function", False, least=-np.inf),
    "level": number(0.5, (-1e9, 1e9), "value, or A, above which is inside"),
    "steps": count(256, (1, 1_000_000), "parts that a ray is cut into"),
    "bsdf": bsdf("the material"),
    "shadows": flag(False, "whether the surface hides lights from itself"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class Isosurface(declared(mi.SamplingIntegrator, PARAMETERS)):
        def f(self, p, active=True):
            """F at points."""
            it = mi.Interaction3f()
            it.p = p
            if hasattr(self.volume, "rgba"):
                return self.volume.rgba(it, active)[1] - self.level
            return self.volume.eval_1(it, active) - self.level

        def sample(self, scene, sampler, ray, medium=None, active=True):
            refuse_scalar("isosurface")
            end, behind = light_behind(scene, ray, active)
            near, far = within(ray, self.volume)
            far = dr.minimum(far, end)
            crossed = active & (far > near)
            t, found = first_crossing(
                lambda t: self.f(ray(t), crossed), near, far, self.steps, crossed
            )
            si = self.surface(ray, dr.select(found, t, 0), near, found)
            lit = direct_light(scene, si, self.bsdf, sampler, self.is_free, found)
            return mi.depolarizer(dr.select(active, dr.select(found, lit, behind), 0)), active, []

        def surface(self, ray, t, near, found):
            """The `mi.SurfaceInteraction3f` where a ray meets the surface."""
            on_face = t <= near
            with dr.suspend_grad():
                step = 0.02 / dr.norm(dr.select(found, per_voxel(ray.d, self.volume), 1))
                slope = (self.f(ray(t + step)) - self.f(ray(t - step))) / (2 * step)
            t = reattach(lambda t: self.f(ray(t)), t, dr.select(on_face, 0, slope))
            outwards = -gradient(self.f, ray(t), self.volume)
            flat = dr.squared_norm(outwards) == 0
            n = dr.normalize(dr.select(flat, -ray.d, outwards))
            n = dr.select(on_face, face_normal(ray(t), self.volume), n)
            return interaction(ray, t, ray(t), facing(n, ray.d), found)

        def is_free(self, ray, active):
            """Whether the surface leaves light through, from where the ray begins to its end."""
            if not self.shadows:
                return active
            near, far = within(ray, self.volume)
            far = dr.minimum(far, ray.maxt)
            crossed = active & (far > near)
            _, _, above = first_above(
                lambda t: self.f(ray(t), crossed), near, far, self.steps, crossed
            )
            return active & ~(crossed & (above > 0))

    return Isosurface


def reference():
    """A scene, and the radiance (3,) of each of its pixels: albedo L.

    A matte level plane below an even sky.
    """
    import mitsuba as mi

    albedo, radiance = [0.6, 0.5, 0.2], 0.7
    ramp = np.array([3, 2, 1], np.float32).reshape(3, 1, 1, 1)
    scene = {
        "type": "scene",
        "integrator": {
            "type": "isosurface",
            "volume": {"type": "gridvolume", "grid": mi.VolumeGrid(ramp), "raw": True},
            "level": 1.7,
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}},
        },
        "sensor": through_unit_cube(),
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": radiance}},
    }
    return scene, [radiance * value for value in albedo]
