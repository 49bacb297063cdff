"""Collects the radiances that photographs show of each texel, with the directions of the lights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray
from brdfkit.inverse.photographs.capture.capture import Capture

ARRAYS = "radiance", "weights", "to_light", "irradiance", "to_camera"
# When maps are coarsened, a large texel takes over the observations of this many small texels along
# a side at most
POOLED_TEXELS = 8
# Share of the mean radiance that is added to radiances before errors are divided by them, so that
# relative errors of dark pixels stay finite
DARK_OFFSET = 0.05


@dataclass(frozen=True)
class Observations:
    """Radiances of n texels in k photographs, each under one light, with the geometry behind them.

    The arrays are in single precision if they are collected from photographs, to save memory.

    radiance : radiances in the photographs, (k, n, 3) [W/(m² sr)].
    weights : weights of squared errors, (k, n, 3): about 1 / radiance², 0 where lost or clipped.
    to_light : unit vectors from the texels to the lights, (k, n, 3).
    irradiance : irradiances of a surface that faces the light, (k, n, 3) [W/m²].
    to_camera : unit vectors from the texels to the cameras, (k, n, 3).
    shape : height and width of the map that the texels form.
    """

    radiance: FloatArray
    weights: FloatArray
    to_light: FloatArray
    irradiance: FloatArray
    to_camera: FloatArray
    shape: tuple[int, int]

    @classmethod
    def collect(cls, capture: Capture, shape: tuple[int, int]) -> Observations:
        """Return the observations of a `Capture` at the texels of maps of `shape` (height, width).

        A photograph without any usable value of the sample has the weight 0.
        """
        points = capture.texel_centres(shape)
        radiance = sample_at_texels(capture, capture.pictures, shape)
        lost = sample_at_texels(capture, capture.excluded, shape) > 0
        to_light, irradiance = illuminate_points(points, capture.positions, capture.intensities)
        to_camera = np.array([find_directions(camera.origin, points) for camera in capture.cameras])
        # Pixels at the edge do not count, because they also show the sample's surroundings
        for light in range(len(lost)):
            lost[light] |= ~capture.is_shown(light, points[:, :2])[:, None]
        shown = np.any(~lost & (irradiance > 0), axis=(1, 2))
        shown &= np.any(capture.counted, axis=(1, 2, 3))
        lost[~shown] = True
        brightness = radiance[shown].mean() if shown.any() else 1.0
        scale = np.maximum(radiance, 0) + DARK_OFFSET * brightness
        weights = np.where(lost, 0, 1 / scale**2)
        arrays = (radiance, weights, to_light, irradiance, to_camera)
        single = {n: a.astype(np.float32) for n, a in zip(ARRAYS, arrays, strict=True)}
        return cls(**single, shape=shape)

    def select_lights(self, lights: IntArray) -> Observations:
        """Return the observations in the photographs with the given indices."""
        return self._apply_to_arrays(lambda values: values[lights], self.shape)

    def select_texels(self, texels: IntArray | slice) -> Observations:
        """Return the observations of the texels with the given indices, as a map of one row."""
        part = self._apply_to_arrays(lambda values: values[:, texels], (1, 0))
        return replace(part, shape=(1, part.radiance.shape[1]))

    def pool_texels(self, side: int) -> Observations:
        """Return the observations of texels that are `side` times as large.

        A large texel receives the observations of all texels within it, but of at most 8 × 8.
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
        return self._apply_to_arrays(
            lambda values: values[:, blocks].reshape(-1, rows * columns, 3), (rows, columns)
        )

    def find_usable_photographs(self) -> BoolArray:
        """Return in which photographs (k,) any value of the sample counts."""
        return np.any(self.weights > 0, axis=(1, 2))

    def find_lit_channels(self) -> BoolArray:
        """Return which of red, green and blue (3,) any light has; the others cannot be observed."""
        return np.any(self.weights * self.irradiance > 0, axis=(0, 1))

    def _apply_to_arrays(
        self, function: Callable[[FloatArray], FloatArray], shape: tuple[int, int]
    ) -> Observations:
        """Apply a `function` to each array; return the results as observations for a `shape`."""
        arrays = {name: function(getattr(self, name)) for name in ARRAYS}
        return Observations(**arrays, shape=shape)


def sample_at_texels(capture: Capture, pictures: AnyArray, shape: tuple[int, int]) -> FloatArray:
    """Return the values (k, n, c) of pictures (k, height, width, c) at the centres of the n texels.

    `shape` is the height and width of the maps, in texels.
    """
    points = capture.texel_centres(shape)
    return np.array(
        [
            _interpolate(picture, camera.project(points, capture.picture_size))
            for picture, camera in zip(pictures, capture.cameras, strict=True)
        ]
    )


def find_directions(place: FloatArray, points: FloatArray) -> FloatArray:
    """Return the unit vectors (n, 3) from `points` (n, 3) to a `place` (3,)."""
    away = place - points
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def illuminate_points(
    points: FloatArray, positions: FloatArray, intensities: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the unit vectors from points to lights, and the irradiance on surfaces facing them.

    Both are (k, n, 3), for `points` (n, 3) [m] and for k point lights at `positions` (k, 3) [m]
    with `intensities` (k, 3) [W/sr].
    """
    away = positions[:, None] - points
    square = (away**2).sum(axis=2, keepdims=True)
    return away / np.sqrt(square), intensities[:, None] / square


def _interpolate(picture: AnyArray, places: FloatArray) -> FloatArray:
    """Return the values (n, c) of a picture between its pixels, by bilinear interpolation.

    The picture is (height, width, c); `places` (n, 2) are columns and rows [pixels].
    """
    height, width = picture.shape[:2]
    x, y = (places - 0.5).T
    x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    a, b = (x - left)[:, None], (y - top)[:, None]
    upper = (1 - a) * picture[top, left] + a * picture[top, left + 1]
    lower = (1 - a) * picture[top + 1, left] + a * picture[top + 1, left + 1]
    return (1 - b) * upper + b * lower
