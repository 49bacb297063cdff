"""What the photographs say of each texel: radiances, and the directions to the lights."""

from dataclasses import dataclass, replace

import numpy as np

ARRAYS = "radiance", "weights", "to_light", "irradiance", "to_camera"
POOLED = 8  # texels along a side: more tell a large texel nothing new
DARK = 0.05  # of the mean radiance, added to a radiance: its relative difference is no noise then


@dataclass(frozen=True)
class Observations:
    """Of n texels under k lights:

    radiance : (k, n, 3) [W/(m² sr)].
    weights : (k, n, 3), 0 where a value is clipped; else 1 over about the radiance's square.
    to_light : (k, n, 3) unit vectors.
    irradiance : (k, n, 3) on a surface that faces the light [W/m²].
    to_camera : (k, n, 3) unit vectors.
    shape : (height, width) of the map.
    """

    radiance: np.ndarray
    weights: np.ndarray
    to_light: np.ndarray
    irradiance: np.ndarray
    to_camera: np.ndarray
    shape: tuple[int, int]

    @classmethod
    def of(cls, capture, shape):
        """Of a `Capture`, for maps of this shape."""
        points = capture.texels(shape)
        radiance = gathered(capture, capture.pictures, shape)
        lost = gathered(capture, capture.left_out, shape) > 0
        to_light, irradiance = light_on(points, capture.positions, capture.intensities)
        to_camera = np.array([directions(camera.origin, points) for camera in capture.cameras])
        scale = np.maximum(radiance, 0) + DARK * radiance.mean()
        # pixels at the edge see what is beside the sample, too: there neighbours decide
        for light in range(len(lost)):
            lost[light] |= ~capture.is_shown(light, points[:, :2])[:, None]
        weights = np.where(lost, 0, 1 / scale**2)
        return cls(radiance, weights, to_light, irradiance, to_camera, tuple(shape))

    def under(self, lights):
        """The same under some of the lights."""
        return self._each(lambda values: values[lights], self.shape)

    def at(self, texels):
        """The same of some of the texels, a slice or their numbers, in a row."""
        found = self._each(lambda values: values[:, texels], (1, 0))
        return replace(found, shape=(1, found.radiance.shape[1]))

    def pooled(self, side):
        """Texels `side` times as large: what is observed of those within one, or of `POOLED` ×
        `POOLED` evenly among them, is observed of it."""
        height, width = self.shape
        rows, columns = -(-height // side), -(-width // side)
        texel = np.arange(height * width).reshape(height, width)
        spare = (0, rows * side - height), (0, columns * side - width)
        blocks = np.pad(texel, spare, mode="edge").reshape(rows, side, columns, side)
        step = max(1, side // POOLED)
        blocks = blocks[:, step // 2 :: step, :, step // 2 :: step]
        blocks = blocks.transpose(1, 3, 0, 2).reshape(-1, rows * columns)

        def pool(values):
            return values[:, blocks].reshape(-1, rows * columns, 3)

        return self._each(pool, (rows, columns))

    def _each(self, change, shape):
        arrays = {name: change(getattr(self, name)) for name in ARRAYS}
        return Observations(**arrays, shape=shape)


def gathered(capture, pictures, shape):
    """Values (k, n, c) at the texels of a map of `shape`, of pictures (k, height, width, c)."""
    points = capture.texels(shape)
    return np.array(
        [
            bilinear(picture, camera.project(points, capture.picture_size))
            for picture, camera in zip(pictures, capture.cameras, strict=True)
        ]
    )


def shown_colours(seen):
    """Which of red, green and blue (3,) `Observations` show anywhere: lights may be red alone."""
    return (seen.weights * seen.irradiance > 0).any(axis=(0, 1))


def directions(place, points):
    """Unit vectors (n, 3) from `points` to a `place`."""
    away = place - points
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def light_on(points, positions, intensities):
    """(unit vectors to the lights, irradiance on what faces them), each (k, n, 3), at `points`."""
    away = positions[:, None] - points
    square = (away**2).sum(axis=2, keepdims=True)
    return away / np.sqrt(square), intensities[:, None] / square


def bilinear(picture, places):
    """Values (n, c) of a `picture` (height, width, c) at `places` (n, 2), columns and rows."""
    height, width = picture.shape[:2]
    x, y = (places - 0.5).T
    x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    a, b = (x - left)[:, None], (y - top)[:, None]
    upper = (1 - a) * picture[top, left] + a * picture[top, left + 1]
    lower = (1 - a) * picture[top + 1, left] + a * picture[top + 1, left + 1]
    return (1 - b) * upper + b * lower
