"""The base class of environment emitters, to which plugins add the sampler of the map.

Rows, columns and bilinear interpolation of the map are those of Mitsuba's `envmap`.
"""

from __future__ import annotations

import math
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
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.sampling.power_map import require_lit_map, subtract_mean_brightness
from brdfkit.mitsuba_bridge.channels import make_rgb_emission
from brdfkit.mitsuba_bridge.properties.declarations import (
    Setting,
    declare_bool,
    declare_number,
    declare_picture,
    declare_text,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.properties.picture_file import read_pixels, to_pixels

MAP_PARAMETERS = {
    "filename": declare_text("", "the map: a picture, azimuth across and polar angle down"),
    "bitmap": declare_picture("the map itself, in place of a file"),
    "scale": declare_number(1.0, (0.0, math.inf), "what the map is multiplied by"),
    "compensated": declare_bool(
        False, "sample only what is brighter than the mean; surfaces do the rest"
    ),
}
# distance of points sampled on the environment; plugins do not know the scene's size
ENVIRONMENT_DISTANCE = 1e7
SMALLEST_SINE = 1e-4  # lower limit of the polar angle's sine, by which densities are divided


def derive_environment_emitter(mi: MitsubaModule, parameters: dict[str, Setting]) -> Any:
    """Return the base class of environment emitters for the current variant of Mitsuba.

    `parameters` are the plugin's, and include `MAP_PARAMETERS`. A derived class has to define
    `make_sampler(brightness)`, which returns a map sampler.
    """

    # The base class depends on the variant, so a type checker cannot know it
    class EnvironmentEmitter(derive_plugin(mi.Emitter, parameters)):  # type: ignore[misc]
        make_sampler: Any  # method of derived classes

        def __init__(self, props: Any) -> None:
            self.name = props.plugin_name()
            _require_rotation(self.name, props)
            super().__init__(props)
            self.m_flags = mi.EmitterFlags.Infinite | mi.EmitterFlags.SpatiallyVarying
            self.data = mi.TensorXf(_load_map_pixels(mi, self.name, self.filename, self.bitmap))
            self.to_local = self.world_transform().inverse()
            self.spectrum = make_rgb_emission()
            self.parameters_changed(["data"])

        def traverse(self, callback: Any) -> None:
            super().traverse(callback)
            callback.put("data", self.data, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Any = ()) -> None:
            super().parameters_changed(keys)
            if not keys or "data" in keys:
                pixels = np.array(dr.detach(self.data), float)
                require_lit_map(f"{self.name}: data", pixels)
                # The first row lies at the upper pole, the last one at the lower pole
                self.texture = mi.Texture2f(_repeat_first_column(mi, self.data), True, False)
                self.height, self.width = self.data.shape[0], self.data.shape[1]
                brightness = luminance(pixels).clip(0)  # an optimiser may step below 0
                if self.compensated:
                    brightness = subtract_mean_brightness(brightness)
                self.map_sampler = self.make_sampler(brightness)

        def eval(self, si: MitsubaObject, active: JitMask = True) -> JitColour:
            x, y = self.find_map_point(-si.wi)
            return mi.depolarizer(self.radiance(x, y, si, active))

        def radiance(
            self, x: JitFloat, y: JitFloat, si: MitsubaObject, active: JitMask
        ) -> JitColour:
            """Return the radiance at a point (x, y) of the map, as the variant's spectrum."""
            uv = mi.Point2f((x + 0.5) / (self.width + 1), (y + 0.5) / self.height)
            rgb = mi.Color3f(*self.texture.eval(uv, active))
            return dr.select(active, self.spectrum(rgb, si) * self.scale, 0)

        def find_map_point(self, direction: JitVector) -> tuple[JitFloat, JitFloat]:
            """Return the map's column and row in a `direction`; pixels lie at whole numbers."""
            d = self.to_local @ direction
            turn = dr.atan2(d.x, -d.z) * (0.5 / dr.pi) - 0.5 / self.width
            turn = turn - dr.floor(turn)
            return turn * self.width, dr.safe_acos(d.y) / dr.pi * (self.height - 1)

        def sample_direction(
            self, it: MitsubaObject, sample: JitVector, active: JitMask = True
        ) -> tuple[MitsubaObject, JitColour]:
            x, y, density = self.map_sampler.sample(sample, active)
            sin_phi, cos_phi = dr.sincos((x + 0.5) / self.width * (2 * dr.pi))
            sin_theta, cos_theta = dr.sincos(y / (self.height - 1) * dr.pi)
            direction = mi.Vector3f(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)

            ds = mi.DirectionSample3f()
            ds.d = self.world_transform() @ direction
            ds.p, ds.n = it.p + ds.d * ENVIRONMENT_DISTANCE, -ds.d
            ds.dist = mi.Float(ENVIRONMENT_DISTANCE)
            ds.uv, ds.time, ds.delta = sample, it.time, mi.Bool(False)
            ds.pdf = dr.select(active, to_density_per_solid_angle(density, sin_theta), 0)
            ds.emitter = self if mi.variant().startswith("scalar") else mi.EmitterPtr(self)
            weight = self.radiance(x, y, it, active) / dr.select(ds.pdf > 0, ds.pdf, 1)
            return ds, mi.depolarizer(dr.select(active & (ds.pdf > 0), weight, 0))

        def pdf_direction(
            self, it: MitsubaObject, ds: MitsubaObject, active: JitMask = True
        ) -> JitFloat:
            x, y = self.find_map_point(ds.d)
            density = self.map_sampler.density(x, y, active)
            return to_density_per_solid_angle(density, dr.sin(dr.pi * y / (self.height - 1)))

        def eval_direction(
            self, it: MitsubaObject, ds: MitsubaObject, active: JitMask = True
        ) -> JitColour:
            x, y = self.find_map_point(ds.d)
            return mi.depolarizer(self.radiance(x, y, it, active))

        def bbox(self) -> MitsubaObject:
            return mi.ScalarBoundingBox3f()

    return EnvironmentEmitter


def to_density_per_solid_angle(density: JitFloat, sin_theta: JitFloat) -> JitFloat:
    """Convert a density over the map, relative to a uniform one, to one per solid angle [sr⁻¹]."""
    return density / (2 * dr.pi**2 * dr.maximum(sin_theta, SMALLEST_SINE))


def _load_map_pixels(
    mi: MitsubaModule, name: str, filename: str, bitmap: MitsubaObject | None
) -> FloatArray:
    """Load a map (height, width, 3) in linear sRGB from a file or a bitmap.

    Raises `BrdfkitError`, which begins with the plugin's `name`, for a map that gives no light.
    """
    if bool(filename) == (bitmap is not None):
        raise BrdfkitError(f"{name} needs a filename, or a bitmap in its place.")
    source = f"{name}: {filename or 'the bitmap'}"
    if bitmap is None:
        pixels = read_pixels(str(mi.file_resolver().resolve(filename)), source)
    else:
        pixels = to_pixels(bitmap)
    if pixels.min(initial=0) < 0:
        raise BrdfkitError(f"{source} has values below 0; mend them.")
    require_lit_map(source, pixels)
    return pixels


def _require_rotation(name: str, props: Any) -> None:
    """Raise `BrdfkitError` if the emitter's transform `to_world` scales or shears."""
    if "to_world" not in props:
        return
    matrix = np.array(props["to_world"].matrix, float).reshape(4, 4)[:3, :3]
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-4):
        raise BrdfkitError(
            f"{name}: to_world scales or shears; an environment can only be turned and mirrored."
        )


def _repeat_first_column(mi: MitsubaModule, data: Any) -> Any:
    """Append a map's first column behind its last, to interpolate between the two."""
    if mi.variant().startswith("scalar"):
        pixels = np.array(data)
        return mi.TensorXf(np.concatenate([pixels, pixels[:, :1]], axis=1))
    return dr.concat((data, data[:, :1]), axis=1)


def make_small_sky() -> MitsubaObject:
    """Make a small environment map of a sky with a sun, a `mi.Bitmap`, to check plugins with."""
    import mitsuba as mi

    v, u = np.meshgrid(np.linspace(0, 1, 16), (np.arange(32) + 0.5) / 32, indexing="ij")
    sky = (
        np.stack([0.4 + 0.2 * v, 0.5 + 0 * v, 0.9 - 0.4 * v], axis=-1) * (v < 0.5)[..., None] + 0.1
    )
    sun = 40 * np.exp(-((u - 0.3) ** 2 + (v - 0.2) ** 2) / 0.002)
    return mi.Bitmap((sky + sun[..., None]).astype(np.float32))
