"""`LitView`: the surfaces that a camera sees in one light, with their exact shadows.

The exact shadows are the reference to which a comparison compares the techniques.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray, JitColour, MitsubaObject
from brdfkit.mitsuba_bridge.surface_points import spawn_ray
from brdfkit.shadows.volumes.mesh import Mesh


@dataclass(frozen=True)
class LitView:
    """The surfaces at the centres of all pixels of a camera's picture, row by row, in one light.

    scene : the `mi.Scene`.
    sensor : one of the scene's cameras.
    emitter : one of the scene's lights: a point, spot or directional light.
    si : the `mi.SurfaceInteraction3f` of each pixel, where its central ray hits a surface.
    size : (height, width) of the picture.
    """

    scene: Any
    sensor: Any
    emitter: Any
    si: Any
    size: tuple[int, int]

    @classmethod
    def from_sensor(
        cls,
        scene: MitsubaObject,
        sensor: MitsubaObject,
        emitter: MitsubaObject,
        size: tuple[int, int],
    ) -> "LitView":
        """Return the surfaces that a sensor sees in a picture of the `size` (height, width)."""
        import mitsuba as mi

        height, width = size
        index = dr.arange(mi.UInt32, height * width)
        pixel = mi.Point2f(index % width, index // width) + 0.5
        place = pixel / mi.Point2f(width, height)
        ray, _ = sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
        si = scene.ray_intersect(ray)
        dr.eval(si)
        return cls(scene, sensor, emitter, si, (height, width))

    def gather_points(self, pixels: IntArray) -> tuple[MitsubaObject, MitsubaObject]:
        """Return positions and normals of the surfaces in pixels with the given indices (n,)."""
        import mitsuba as mi

        index = mi.UInt32(pixels)
        return dr.gather(mi.Point3f, self.si.p, index), dr.gather(mi.Normal3f, self.si.n, index)

    @cached_property
    def meshes(self) -> list[Mesh]:
        """All shapes of the scene as meshes, for shadow volumes."""
        return [Mesh.from_shape(shape) for shape in self.scene.shapes()]

    @cached_property
    def light_sample(self) -> tuple[MitsubaObject, JitColour]:
        """The `mi.DirectionSample3f` from each surface to the light, and the unshadowed light."""
        import mitsuba as mi

        sample: tuple[Any, Any] = self.emitter.sample_direction(self.si, mi.Point2f(0.5))
        return sample

    @cached_property
    def facing(self) -> BoolArray:
        """True in pixels whose surface the light would reach if there were no shadows, (pixels,).

        Elsewhere the surface is dark, as its visible side faces away or is outside a spot's cone.
        """
        import mitsuba as mi

        ds, light = self.light_sample
        towards = dr.dot(self.si.n, ds.d) * dr.dot(self.si.n, self.si.to_world(self.si.wi))
        shines = dr.max(mi.unpolarized_spectrum(light)) > 0
        return np.array(self.si.is_valid() & (towards > 0) & shines)

    @cached_property
    def exact(self) -> BoolArray:
        """True in pixels where a shadow ray from the surface reaches the light, (pixels,)."""
        import mitsuba as mi

        ds, _ = self.light_sample
        ray = spawn_ray(self.si.p, self.si.n, self.si.t, ds.d)
        ray.maxt = ds.dist * (1 - mi.math.ShadowEpsilon)
        return np.array(~self.scene.ray_test(ray, self.si.is_valid()))

    @cached_property
    def unshadowed(self) -> FloatArray:
        """The radiance (pixels, 3) that each surface reflects if no shadows are cast."""
        import mitsuba as mi

        ds, light = self.light_sample
        valid = self.si.is_valid()
        value = self.si.bsdf().eval(mi.BSDFContext(), self.si, self.si.to_local(ds.d), valid)
        radiance = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light)
        rgb = mi.Color3f(radiance) if mi.is_rgb else mi.Color3f(radiance[0])
        return np.array(dr.select(valid, rgb, 0)).T

    def compute_picture(self, lit: Any) -> FloatArray:
        """Return the picture (height, width, 3) if shares `lit` (pixels,) of the light arrive."""
        return (self.unshadowed * np.asarray(lit)[:, None]).reshape(*self.size, 3)
