"""Environment map by blocks: light from all around, sampled by the blocks of a tree.

    {"type": "kdtree_envmap", "filename": "studio.exr", "scale": 1.0, "to_world": ...}

takes the place of Mitsuba's `envmap`: latitude over longitude, y up, with the same convention of
rows and columns and the same bilinear interpolation. The map is cut into `blocks` of nearly
constant power per angle (least sum of squared errors). A sample chooses a block by its exact share
of the power, and a point of the block uniformly in both angles. The density is stored for every
pixel, so that multiple importance sampling costs one look-up. `to_world` may turn and mirror the
map, nothing else.

[Ergun 2015, chapter 6]. In spectral variants a colour of the map becomes a smooth spectrum under
D65 [Mallett & Yuksel 2019], linear in the colour.
"""

import math

import drjit as dr
import numpy as np

from brdfkit.colours import luminance
from brdfkit.errors import BrdfkitError
from brdfkit.host.arrays import Rows
from brdfkit.host.channels import emission_of_rgb
from brdfkit.host.declared import count, declared, number, picture, text
from brdfkit.lighting import environment_tree

PARAMETERS = {
    "filename": text("", "the map: a picture, azimuth across and polar angle down"),
    "bitmap": picture("the map itself, in place of a file"),
    "scale": number(1.0, (0.0, math.inf), "what the map is multiplied by"),
    "blocks": count(4096, (1, 1_000_000), "blocks that the map is cut into at most"),
}
FAR = 1e7  # distance of the environment: Mitsuba does not tell a plugin how large the scene is
LEAST_SINE = 1e-4  # of the polar angle: nearer the poles, the density divides by this


def define(mi):
    """The class of `mi.Emitter` for the current variant."""

    class KdtreeEnvmap(declared(mi.Emitter, PARAMETERS)):
        def __init__(self, props):
            _require_rotation(props)
            super().__init__(props)
            self.m_flags = mi.EmitterFlags.Infinite | mi.EmitterFlags.SpatiallyVarying
            self.data = mi.TensorXf(_pixels(mi, self.filename, self.bitmap))
            self.to_local = self.world_transform().inverse()
            self.spectrum = emission_of_rgb()
            self.parameters_changed(["data"])

        def traverse(self, callback):
            super().traverse(callback)
            callback.put("data", self.data, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys=()):
            if not keys or "data" in keys:
                pixels = np.array(dr.detach(self.data), float)
                _require_light("kdtree_envmap: data", pixels)
                # The first row is at the polar angle 0, the last at π; a column is at the middle of
                # its azimuths
                self.texture = mi.Texture2f(_close_circle(mi, self.data), True, False)
                self.height, self.width = self.data.shape[0], self.data.shape[1]
                self.cut(pixels)

        def cut(self, pixels):
            """Compute the blocks of a map, the probability of each, and the density of every cell.

            A cell lies between four pixels and is as bright as their mean: it is black only where
            the interpolated map is black.
            """
            bright = luminance(pixels).clip(0)  # an optimiser may step below 0
            between = bright + np.roll(bright, -1, axis=1)
            between = (between[:-1] + between[1:]) / 4
            theta = np.pi * (np.arange(self.height - 1) + 0.5) / (self.height - 1)
            power = between * np.sin(theta)[:, None]

            # Blocks of nearly constant power, and their shares of it
            found = environment_tree.blocks(power, self.blocks)
            x0, x1, y0, y1 = found.T
            share = environment_tree.block_sums(power, found).clip(0)
            share = share / share.sum()
            self.choice = mi.DiscreteDistribution(share.tolist())
            self.corners = Rows(np.stack([x0, y0], axis=1))
            self.sizes = Rows(np.stack([x1 - x0, y1 - y0], axis=1))

            # Probability per cell, over the solid angle of an average cell
            density = np.zeros_like(power)
            for block, value in zip(found, share / ((x1 - x0) * (y1 - y0)), strict=True):
                density[block[2] : block[3], block[0] : block[1]] = value
            self.density = Rows(density.ravel() * density.size / (2 * np.pi**2))

        def eval(self, si, active=True):
            return mi.depolarizer(self.radiance(-si.wi, si, active))

        def radiance(self, direction, si, active):
            x, y = self.place(direction)
            x = dr.select(x < 0, x + self.width, x)
            uv = mi.Point2f((x + 0.5) / (self.width + 1), (y + 0.5) / self.height)
            rgb = mi.Color3f(*self.texture.eval(uv, active))
            return dr.select(active, self.spectrum(rgb, si) * self.scale, 0)

        def place(self, direction):
            """The column (periodic, 0 at the middle of the first) and the row of a direction."""
            d = self.to_local @ direction
            turn = dr.atan2(d.x, -d.z) * (0.5 / dr.pi)
            turn = turn - dr.floor(turn)
            return turn * self.width - 0.5, dr.safe_acos(d.y) / dr.pi * (self.height - 1)

        def sample_direction(self, it, sample, active=True):
            # A block, a point in it, and the point's direction in the map's frame
            block, rest = self.choice.sample_reuse(sample.x, active)
            corner, size = (r.at(block, mi.Vector2f, active) for r in (self.corners, self.sizes))
            x, y = corner.x + rest * size.x, corner.y + sample.y * size.y
            sin_phi, cos_phi = dr.sincos((x + 0.5) / self.width * (2 * dr.pi))
            sin_theta, cos_theta = dr.sincos(y / (self.height - 1) * dr.pi)
            direction = mi.Vector3f(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)

            ds = mi.DirectionSample3f()
            ds.d = self.world_transform() @ direction
            ds.p, ds.n, ds.dist = it.p + ds.d * FAR, -ds.d, mi.Float(FAR)
            ds.uv, ds.time, ds.delta = sample, it.time, mi.Bool(False)
            ds.pdf = self.pdf_direction(it, ds, active)
            ds.emitter = self if mi.variant().startswith("scalar") else mi.EmitterPtr(self)
            weight = self.radiance(ds.d, it, active) / dr.select(ds.pdf > 0, ds.pdf, 1)
            return ds, mi.depolarizer(dr.select(active & (ds.pdf > 0), weight, 0))

        def pdf_direction(self, it, ds, active=True):
            x, y = self.place(ds.d)
            column = mi.UInt32(x - self.width * dr.floor(x / self.width))
            column, row = dr.minimum(column, self.width - 1), mi.UInt32(y)
            row = dr.minimum(row, self.height - 2)
            sine = dr.sin(dr.pi * y / (self.height - 1))
            density = self.density.at(row * self.width + column, active=active)
            return density / dr.maximum(sine, LEAST_SINE)

        def eval_direction(self, it, ds, active=True):
            return mi.depolarizer(self.radiance(ds.d, it, active))

        def bbox(self):
            return mi.ScalarBoundingBox3f()

    return KdtreeEnvmap


def _pixels(mi, filename, bitmap):
    """The map (height, width, 3) in linear sRGB.

    Raises `BrdfkitError` for a map that cannot light a scene.
    """
    if bool(filename) == (bitmap is not None):
        raise BrdfkitError("kdtree_envmap needs a filename, or a bitmap in its place.")
    if bitmap is None:
        bitmap = mi.Bitmap(str(mi.file_resolver().resolve(filename)))
    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32
    pixels = np.array(bitmap.convert(*kind, srgb_gamma=False))
    what = f"kdtree_envmap: {filename or 'the bitmap'}"
    if pixels.min(initial=0) < 0:
        raise BrdfkitError(f"{what} has values below 0; mend them.")
    _require_light(what, pixels)
    return pixels


def _require_light(what, pixels):
    """Raise `BrdfkitError`, which begins with `what`, for pixels that give no light."""
    if pixels.ndim != 3 or min(pixels.shape[:2]) < 2:
        size = "×".join(map(str, pixels.shape[1::-1]))
        raise BrdfkitError(f"{what} has {size} pixels; give 2×2 or more.")
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{what} has values that are not finite; mend them.")
    if pixels.max() <= 0:
        raise BrdfkitError(f"{what} is black all over and lights nothing; give another map.")


def _require_rotation(props):
    """Raise `BrdfkitError` for a `to_world` that changes angles."""
    if "to_world" not in props:
        return
    matrix = np.array(props["to_world"].matrix, float).reshape(4, 4)[:3, :3]
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-4):
        raise BrdfkitError(
            "kdtree_envmap: to_world scales or shears; an environment can only be turned and "
            "mirrored."
        )


def _close_circle(mi, data):
    """A map (height, width, 3) with its first column again behind the last, for interpolation."""
    if mi.variant().startswith("scalar"):
        pixels = np.array(data)
        return mi.TensorXf(np.concatenate([pixels, pixels[:, :1]], axis=1))
    return dr.concat((data, data[:, :1]), axis=1)


def example():
    """A small sky with a sun, for the checks."""
    import mitsuba as mi

    v, u = np.meshgrid(np.linspace(0, 1, 16), (np.arange(32) + 0.5) / 32, indexing="ij")
    sky = (
        np.stack([0.4 + 0.2 * v, 0.5 + 0 * v, 0.9 - 0.4 * v], axis=-1) * (v < 0.5)[..., None] + 0.1
    )
    sun = 40 * np.exp(-((u - 0.3) ** 2 + (v - 0.2) ** 2) / 0.002)
    bitmap = mi.Bitmap((sky + sun[..., None]).astype(np.float32))
    return {"type": "kdtree_envmap", "bitmap": bitmap, "blocks": 64}
