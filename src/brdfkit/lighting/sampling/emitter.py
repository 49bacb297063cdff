"""The base of environment emitters: all but the way in which points of the map are drawn.

It has the convention of rows and columns of Mitsuba's `envmap`, and its bilinear interpolation.
"""

import math

import drjit as dr
import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.sampling.power_map import compensated, require_light
from brdfkit.mitsuba_bridge.channels import emission_of_rgb
from brdfkit.mitsuba_bridge.properties.declarations import declared, flag, number, picture, text
from brdfkit.mitsuba_bridge.properties.picture_file import pixels_of, read_pixels

MAP = {
    "filename": text("", "the map: a picture, azimuth across and polar angle down"),
    "bitmap": picture("the map itself, in place of a file"),
    "scale": number(1.0, (0.0, math.inf), "what the map is multiplied by"),
    "compensated": flag(False, "sample only what is brighter than the mean; surfaces do the rest"),
}
FAR = 1e7  # distance of the environment: Mitsuba does not tell a plugin how large the scene is
LEAST_SINE = 1e-4  # of the polar angle: nearer the poles, the density divides by this


def environment_emitter(mi, parameters):
    """The base class for the current variant, with `parameters`, which have those of `MAP`.

    A derived class has `sampler_of(brightness)`, which returns a sampler (`map_samplers`).
    """

    class EnvironmentEmitter(declared(mi.Emitter, parameters)):
        def __init__(self, props):
            self.name = props.plugin_name()
            _require_rotation(self.name, props)
            super().__init__(props)
            self.m_flags = mi.EmitterFlags.Infinite | mi.EmitterFlags.SpatiallyVarying
            self.data = mi.TensorXf(_pixels(mi, self.name, self.filename, self.bitmap))
            self.to_local = self.world_transform().inverse()
            self.spectrum = emission_of_rgb()
            self.parameters_changed(["data"])

        def traverse(self, callback):
            super().traverse(callback)
            callback.put("data", self.data, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys=()):
            if not keys or "data" in keys:
                pixels = np.array(dr.detach(self.data), float)
                require_light(f"{self.name}: data", pixels)
                # The first row is at the polar angle 0, the last at π; a column is at the middle of
                # its azimuths
                self.texture = mi.Texture2f(_close_circle(mi, self.data), True, False)
                self.height, self.width = self.data.shape[0], self.data.shape[1]
                bright = luminance(pixels).clip(0)  # an optimiser may step below 0
                self.points = self.sampler_of(compensated(bright) if self.compensated else bright)

        def eval(self, si, active=True):
            x, y = self.place(-si.wi)
            return mi.depolarizer(self.radiance(x, y, si, active))

        def radiance(self, x, y, si, active):
            uv = mi.Point2f((x + 0.5) / (self.width + 1), (y + 0.5) / self.height)
            rgb = mi.Color3f(*self.texture.eval(uv, active))
            return dr.select(active, self.spectrum(rgb, si) * self.scale, 0)

        def place(self, direction):
            """The column (0 at the middle of the first, periodic) and the row of a direction."""
            d = self.to_local @ direction
            turn = dr.atan2(d.x, -d.z) * (0.5 / dr.pi) - 0.5 / self.width
            turn = turn - dr.floor(turn)
            return turn * self.width, dr.safe_acos(d.y) / dr.pi * (self.height - 1)

        def sample_direction(self, it, sample, active=True):
            x, y, density = self.points.sample(sample, active)
            sin_phi, cos_phi = dr.sincos((x + 0.5) / self.width * (2 * dr.pi))
            sin_theta, cos_theta = dr.sincos(y / (self.height - 1) * dr.pi)
            direction = mi.Vector3f(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)

            ds = mi.DirectionSample3f()
            ds.d = self.world_transform() @ direction
            ds.p, ds.n, ds.dist = it.p + ds.d * FAR, -ds.d, mi.Float(FAR)
            ds.uv, ds.time, ds.delta = sample, it.time, mi.Bool(False)
            ds.pdf = dr.select(active, per_solid_angle(density, sin_theta), 0)
            ds.emitter = self if mi.variant().startswith("scalar") else mi.EmitterPtr(self)
            weight = self.radiance(x, y, it, active) / dr.select(ds.pdf > 0, ds.pdf, 1)
            return ds, mi.depolarizer(dr.select(active & (ds.pdf > 0), weight, 0))

        def pdf_direction(self, it, ds, active=True):
            x, y = self.place(ds.d)
            density = self.points.density(x, y, active)
            return per_solid_angle(density, dr.sin(dr.pi * y / (self.height - 1)))

        def eval_direction(self, it, ds, active=True):
            x, y = self.place(ds.d)
            return mi.depolarizer(self.radiance(x, y, it, active))

        def bbox(self):
            return mi.ScalarBoundingBox3f()

    return EnvironmentEmitter


def per_solid_angle(density, sin_theta):
    """The density per solid angle of one over the map, relative to an even one."""
    return density / (2 * dr.pi**2 * dr.maximum(sin_theta, LEAST_SINE))


def _pixels(mi, name, filename, bitmap):
    """The map (height, width, 3) in linear sRGB.

    Raises `BrdfkitError` for a map that cannot light a scene.
    """
    if bool(filename) == (bitmap is not None):
        raise BrdfkitError(f"{name} needs a filename, or a bitmap in its place.")
    what = f"{name}: {filename or 'the bitmap'}"
    if bitmap is None:
        pixels = read_pixels(str(mi.file_resolver().resolve(filename)), what)
    else:
        pixels = pixels_of(bitmap)
    if pixels.min(initial=0) < 0:
        raise BrdfkitError(f"{what} has values below 0; mend them.")
    require_light(what, pixels)
    return pixels


def _require_rotation(name, props):
    """Raise `BrdfkitError` for a `to_world` that changes angles."""
    if "to_world" not in props:
        return
    matrix = np.array(props["to_world"].matrix, float).reshape(4, 4)[:3, :3]
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-4):
        raise BrdfkitError(
            f"{name}: to_world scales or shears; an environment can only be turned and mirrored."
        )


def _close_circle(mi, data):
    """A map (height, width, 3) with its first column again behind the last, for interpolation."""
    if mi.variant().startswith("scalar"):
        pixels = np.array(data)
        return mi.TensorXf(np.concatenate([pixels, pixels[:, :1]], axis=1))
    return dr.concat((data, data[:, :1]), axis=1)


def small_sky():
    """A small sky with a sun, a `mi.Bitmap`, for the checks."""
    import mitsuba as mi

    v, u = np.meshgrid(np.linspace(0, 1, 16), (np.arange(32) + 0.5) / 32, indexing="ij")
    sky = (
        np.stack([0.4 + 0.2 * v, 0.5 + 0 * v, 0.9 - 0.4 * v], axis=-1) * (v < 0.5)[..., None] + 0.1
    )
    sun = 40 * np.exp(-((u - 0.3) ** 2 + (v - 0.2) ** 2) / 0.002)
    return mi.Bitmap((sky + sun[..., None]).astype(np.float32))
