"""Maximum intensity: a projection of a volume that shows the largest value along each ray.

    L = A RGB + (1 - A) L_behind,   (RGB, A) = T(v),   v = max V(t) along the ray

Angiography and PET use such pictures. T is the transfer function of a `volume` of the type
`transfer_function`: a colour RGB and an opacity A for each value v. For a colour map alone, with
A = 1, use `TransferFunction.from_colormap(name, range, opacity=[(0, 1), (1, 1)])`. Any other volume
is shown in grey: L = v. L_behind is the emission of the first surface, which ends the ray, or
`background`, or else the environment.

The ray is cut into `steps` equal parts within the box of the volume. Each part is read at one
point, at a random share of its length that is the same for all parts; then the largest value is
refined in the neighbourhood of its point. The result is never above the true maximum, and
approaches it as the steps become shorter than the voxels. Each ray has its own maximum, and a pixel
is the mean of its rays, over all passes.

[Lesar 2018, eq. 6.1]. Derivatives flow from the colour to the largest value, and from there to the
values of the grid about it.
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
    declare_int,
    declare_volume,
    derive_plugin,
)
from brdfkit.volumes.rays.box import BACKGROUND, evaluate_light_behind, intersect_box
from brdfkit.volumes.rays.search import find_distance_of_maximum
from brdfkit.volumes.transfer.transfer_function import TransferFunction

PARAMETERS = {
    "volume": declare_volume(0.0, "a transfer_function, or any other volume in grey", False),
    "steps": declare_int(256, (1, 1_000_000), "parts that a ray is cut into"),
    "jitter": declare_bool(True, "whether the place in each part is random"),
    "background": BACKGROUND,
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class MaximumIntensity(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.light = make_rgb_emission()
            self.has_colours = hasattr(self.volume, "eval_extinction_and_colour")

        def eval_value(self, it: MitsubaObject, active: JitMask) -> JitFloat:
            if self.has_colours:
                return self.volume.eval_arguments(it, active)[0]
            return self.volume.eval_1(it, active)

        def eval_colour(self, it: MitsubaObject, active: JitMask) -> tuple[JitVector, JitFloat]:
            """Return the colour RGB in linear sRGB and the opacity A at a point."""
            if self.has_colours:
                return self.volume.eval_rgba(it, active)
            return mi.Color3f(self.volume.eval_1(it, active)), 1

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            end, behind = evaluate_light_behind(scene, ray, active, self.background, self.light)
            near, far = intersect_box(ray, self.volume)
            far = dr.minimum(far, end)
            inside = active & (far > near)

            def make_point(t: JitFloat) -> MitsubaObject:
                it = mi.Interaction3f()
                it.p, it.wavelengths = ray(t), ray.wavelengths
                return it

            place = sampler.next_1d(active) if self.jitter else mi.Float(0.5)
            t = find_distance_of_maximum(
                lambda t: self.eval_value(make_point(t), inside),
                near,
                far,
                self.steps,
                place,
                inside,
            )
            it = make_point(t)
            rgb, a = self.eval_colour(it, inside)
            radiance = dr.select(inside, a * self.light(rgb, it) + (1 - a) * behind, behind)
            return mi.depolarizer(dr.select(active, radiance, 0)), active, []

    return MaximumIntensity


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, and the radiance (3,) that every pixel of its picture should have.

    The largest value of the volume is in its middle voxel, so that A RGB + (1 - A) L_behind of this
    value is visible.
    """
    import mitsuba as mi

    rgb, a, behind = np.array([0.9, 0.5, 0.1]), 0.75, 0.3
    hill = np.array([0, 4, 1], np.float32).reshape(3, 1, 1, 1)
    function = TransferFunction([0, 4, 9], [[0, 0, 0, 0], [*rgb, a], [1, 1, 1, 1]])
    volume = {
        "type": "transfer_function",
        "values": {"type": "gridvolume", "grid": mi.VolumeGrid(hill)},
        "transfer": function.to_json(),
    }
    scene = {
        "type": "scene",
        "integrator": {"type": "maximum_intensity", "volume": volume, "steps": 16},
        "sensor": make_cube_camera(),
        "behind": {"type": "constant", "radiance": {"type": "rgb", "value": behind}},
    }
    return scene, a * rgb + (1 - a) * behind
