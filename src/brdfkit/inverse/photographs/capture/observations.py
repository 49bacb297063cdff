"""Collects what the photographs show of each texel: radiances, and the directions of the lights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.capture import Capture

ARRAYS = "radiance", "weights", "to_light", "irradiance", "to_camera"
POOLED_TEXELS = 8  # along a side of a large texel: more of them add nothing
DARK_OFFSET = 0.05  # times the mean radiance, added so that relative errors stay finite


@dataclass(frozen=True)
class Observations:
    """The content of k photographs at n texels.

    radiance : (k, n, 3) [W/(m² sr)].
    weights : (k, n, 3), the weights of squared errors: about 1 / radiance², 0 if lost or clipped.
    to_light : (k, n, 3), unit vectors.
    irradiance : (k, n, 3), on a surface that faces the light [W/m²].
    to_camera : (k, n, 3), unit vectors.
    shape : (height, width) of the map.
    """

    radiance: FloatArray
    weights: FloatArray
    to_light: FloatArray
    irradiance: FloatArray
    to_camera: FloatArray
    shape: tuple[int, int]

    @classmethod
    def collect(cls, capture: Capture, shape: tuple[int, int]) -> Observations:
        """Return what a `Capture` shows of the texels of maps of `shape` (height, width).

        Raises `BrdfkitError` for a photograph that shows nothing of the sample that counts.
        """
        points = capture.texel_centres(shape)
        radiance = sample_pictures(capture, capture.pictures, shape)
        lost = sample_pictures(capture, capture.excluded, shape) > 0
        to_light, irradiance = illuminate(points, capture.positions, capture.intensities)
        to_camera = np.array([directions_to(camera.origin, points) for camera in capture.cameras])
        scale = np.maximum(radiance, 0) + DARK_OFFSET * radiance.mean()
        # Pixels at the edge also see what lies beside the sample; neighbours decide there
        for light in range(len(lost)):
            lost[light] |= ~capture.is_shown(light, points[:, :2])[:, None]
        weights = np.where(lost, 0, 1 / scale**2)
        shown = np.any(weights * irradiance > 0, axis=(1, 2))
        shown &= np.any(capture.counted, axis=(1, 2, 3))
        for name, is_shown in zip(capture.names, shown, strict=True):
            if not is_shown:
                raise BrdfkitError(
                    f"{name}: nothing of the sample counts in it, as all is clipped, lost, within "
                    "a pixel of the edge, or under a light that grazes; leave this picture out."
                )
        return cls(radiance, weights, to_light, irradiance, to_camera, shape)

    def select_lights(self, lights: IntArray) -> Observations:
        """Return the observations under some of the lights."""
        return self._map_arrays(lambda values: values[lights], self.shape)

    def select_texels(self, texels: IntArray | slice) -> Observations:
        """Return the observations of some of the texels, as a map of one row."""
        part = self._map_arrays(lambda values: values[:, texels], (1, 0))
        return replace(part, shape=(1, part.radiance.shape[1]))

    def pool(self, side: int) -> Observations:
        """Return the observations of texels that are `side` times as large.

        A large texel receives all observations of the texels within it, or of 8 × 8 of them.
        """
        height, width = self.shape
        rows, columns = -(-height // side), -(-width // side)
        texel = np.arange(height * width).reshape(height, width)
        margin = (0, rows * side - height), (0, columns * side - width)
        padded = np.pad(texel, margin, mode="edge")
        blocks: IntArray = padded.reshape(rows, side, columns, side)
        step = max(1, side // POOLED_TEXELS)
        blocks = blocks[:, step // 2 :: step, :, step // 2 :: step]
        blocks = blocks.transpose(1, 3, 0, 2).reshape(-1, rows * columns)
        return self._map_arrays(
            lambda values: values[:, blocks].reshape(-1, rows * columns, 3), (rows, columns)
        )

    def lit_channels(self) -> BoolArray:
        """Return which of red, green and blue (3,) are observed at all; lights may be coloured."""
        return np.any(self.weights * self.irradiance > 0, axis=(0, 1))

    def _map_arrays(
        self, function: Callable[[FloatArray], FloatArray], shape: tuple[int, int]
    ) -> Observations:
        """Return the observations with a function applied to each array."""
        arrays = {name: function(getattr(self, name)) for name in ARRAYS}
        return Observations(**arrays, shape=shape)


def sample_pictures(capture: Capture, pictures: AnyArray, shape: tuple[int, int]) -> FloatArray:
    """Return the values (k, n, c) of pictures (k, height, width, c) at the texels of maps."""
    points = capture.texel_centres(shape)
    return np.array(
        [
            _interpolate(picture, camera.project(points, capture.picture_size))
            for picture, camera in zip(pictures, capture.cameras, strict=True)
        ]
    )


def directions_to(place: FloatArray, points: FloatArray) -> FloatArray:
    """Return the unit vectors (n, 3) from `points` (n, 3) to a `place` (3,)."""
    away = place - points
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def illuminate(
    points: FloatArray, positions: FloatArray, intensities: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the unit vectors from points to lights, and the irradiance on surfaces facing them.

    Both are (k, n, 3), for `points` (n, 3) [m], `positions` (k, 3) [m] and `intensities` (k, 3).
    """
    away = positions[:, None] - points
    square = (away**2).sum(axis=2, keepdims=True)
    return away / np.sqrt(square), intensities[:, None] / square


def _interpolate(picture: AnyArray, places: FloatArray) -> FloatArray:
    """Return the values (n, c) of a picture between its pixels, by bilinear interpolation.

    The picture is (height, width, c); `places` (n, 2) are columns and rows.
    """
    height, width = picture.shape[:2]
    x, y = (places - 0.5).T
    x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    a, b = (x - left)[:, None], (y - top)[:, None]
    upper = (1 - a) * picture[top, left] + a * picture[top, left + 1]
    lower = (1 - a) * picture[top + 1, left] + a * picture[top + 1, left + 1]
    return (1 - b) * upper + b * lower
