"""Isosurface: direct light on the surface where a volume has a given value, of any material.

    {"type": "isosurface", "volume": {...}, "level": 110.0, "bsdf": {"type": "ggx"}}

The inside of the surface is where F = V - `level` > 0. V is the value of the volume, or for a
volume of the type `transfer_function` its opacity, with `surface_of` "values" the value that it
looks up. A ray is cut into `steps` equal parts within the
box of the volume. The first end of a part that lies inside is refined to the exact crossing, so
that no picture shows the parts. Without this refinement the surface would lie half a part too deep.
With N random points on a length D instead of parts, as in [Lesar 2018, eq. 6.2], it would lie
D / (N + 1) too deep. Details that are thinner than a part may be missed. Where the box cuts through
the inside, its face is visible.

The normal is -∇F, computed by differences over a voxel to each side, which is smoother than the
derivative of the interpolated values. `bsdf` is the material, white and matte by default. Textures
have u = x and v = y, the tangent is the x axis projected onto the surface. All lights of the scene
are sampled, by the lights and by the bsdf. With `shadows` the surface hides lights from itself.
Other shapes always hide lights; they are visible only by the light that they emit. With
`background`, the camera sees this radiance where it would see the environment.

Derivatives flow to the values, the level, the transfer function, the bsdf and the lights, including
the motion of the surface. They do not include changes at silhouettes and at the edges of shadows.
"""

from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.channels import make_rgb_emission
from brdfkit.mitsuba_bridge.check_scenes import make_cube_camera
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bool,
    declare_bsdf,
    declare_choice,
    declare_int,
    declare_number,
    declare_volume,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised
from brdfkit.mitsuba_bridge.surface_points import make_interaction
from brdfkit.volumes.light.surface_light import sample_direct_light
from brdfkit.volumes.rays.box import (
    BACKGROUND,
    bend_normal_to_viewer,
    compute_gradient,
    count_voxels_per_length,
    evaluate_light_behind,
    face_normal,
    intersect_box,
)
from brdfkit.volumes.rays.search import (
    attach_crossing_derivatives,
    find_first_crossing,
    find_first_positive_step,
)

PARAMETERS = {
    "volume": declare_volume(1.0, "the values, or a transfer_function", False, least=-np.inf),
    "level": declare_number(0.5, (-1e9, 1e9), "larger values, or A, are inside"),
    "steps": declare_int(256, (1, 1_000_000), "parts that a ray is cut into"),
    "bsdf": declare_bsdf("the material"),
    "shadows": declare_bool(False, "whether the surface hides lights from itself"),
    "surface_of": declare_choice(
        ("opacity", "values"), "what has the level in a transfer_function"
    ),
    "background": BACKGROUND,
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class Isosurface(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.light = make_rgb_emission()

        def value_above_level(self, p: JitVector, active: JitMask = True) -> JitFloat:
            """Return F = V(p) - `level`, which is above 0 inside the surface."""
            it = mi.Interaction3f()
            it.p = p
            if not hasattr(self.volume, "eval_rgba"):
                return self.volume.eval_1(it, active) - self.level
            if self.surface_of == "values":
                return self.volume.eval_arguments(it, active)[0] - self.level
            return self.volume.eval_rgba(it, active)[1] - self.level

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            require_vectorised("isosurface")
            end, behind = evaluate_light_behind(scene, ray, active, self.background, self.light)
            near, far = intersect_box(ray, self.volume)
            far = dr.minimum(far, end)
            crossed = active & (far > near)
            t, hit = find_first_crossing(
                lambda t: self.value_above_level(ray(t), crossed), near, far, self.steps, crossed
            )
            si = self.make_surface_interaction(ray, dr.select(hit, t, 0), near, hit)
            lit = sample_direct_light(scene, si, self.bsdf, sampler, self.is_unblocked, hit)
            return mi.depolarizer(dr.select(active, dr.select(hit, lit, behind), 0)), active, []

        def make_surface_interaction(
            self, ray: MitsubaObject, t: JitFloat, near: JitFloat, hit: JitMask
        ) -> MitsubaObject:
            """Return the surface interaction where a ray meets the isosurface, at the distance `t`.

            `near` is the distance at which the ray enters the box of the volume.
            """
            on_face = t <= near
            with dr.suspend_grad():
                step = 0.02 / dr.norm(
                    dr.select(hit, count_voxels_per_length(ray.d, self.volume), 1)
                )
                slope = (
                    self.value_above_level(ray(t + step)) - self.value_above_level(ray(t - step))
                ) / (2 * step)
            t = attach_crossing_derivatives(
                lambda t: self.value_above_level(ray(t)), t, dr.select(on_face, 0, slope)
            )
            outwards = -compute_gradient(self.value_above_level, ray(t), self.volume)
            flat = dr.squared_norm(outwards) == 0
            n = dr.normalize(dr.select(flat, -ray.d, outwards))
            n = dr.select(on_face, face_normal(ray(t), self.volume), n)
            return make_interaction(ray, t, ray(t), bend_normal_to_viewer(n, ray.d), hit)

        def is_unblocked(self, ray: MitsubaObject, active: JitMask) -> JitMask:
            """Return whether a ray up to `ray.maxt` does not meet the isosurface."""
            if not self.shadows:
                return active
            near, far = intersect_box(ray, self.volume)
            far = dr.minimum(far, ray.maxt)
            crossed = active & (far > near)
            _, _, above = find_first_positive_step(
                lambda t: self.value_above_level(ray(t), crossed), near, far, self.steps, crossed
            )
            return active & ~(crossed & (above > 0))

    return Isosurface


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, a matte plane under an even sky, and its radiance (3,)."""
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
        "sensor": make_cube_camera(),
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": radiance}},
    }
    return scene, [radiance * value for value in albedo]
