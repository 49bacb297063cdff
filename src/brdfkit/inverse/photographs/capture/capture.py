"""Defines `Capture`, photographs of a flat sample under known lights."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray
from brdfkit.inverse.photographs.capture.checks import check_capture
from brdfkit.inverse.photographs.capture.pinhole import Pinhole

# pixels with the largest value count as clipped if they are more than this share
CLIPPED_SHARE = 1e-4
# cosine of the light's angle of incidence below which bumps of the sample cast shadows
SMALLEST_COSINE = 0.05
SMALLEST_MAP = 4  # fewest texels along a side of a map
PIXELS_PER_TEXEL = 1.4  # fewest pixels of a reduced photograph per texel, along a side


@dataclass(frozen=True, eq=False)
class Capture:
    """Photographs of a flat sample, each under one point light, by a fixed or a moving camera.

    The sample lies in the plane z = 0 with its middle at the origin, x to the right and y up; it is
    seen from above (z > 0).

    Attributes
    ----------
    pictures : ndarray, shape (lights, height, width, 3)
        Linear values: radiance [W/(m² sr)], or numbers in proportion to it by the same factor in
        all pictures.
    positions : ndarray, shape (lights, 3)
        Positions of the lights [m].
    intensities : ndarray, shape (lights, 3)
        Radiant intensities of the lights [W/sr], in the units of the pictures.
    camera : Pinhole, or tuple of Pinhole
        The fixed camera, or the camera of each picture.
    size : tuple of float
        Width and height of the sample [m].
    names : tuple of str
        Names of the pictures.
    lost : ndarray of bool, shape (lights, height, width, 3), optional
        Which numbers of the pictures do not count, such as those in a shadow on the sample. By
        default those that are clipped: see `clipped`.

    Raises
    ------
    BrdfkitError
        For shapes that do not fit each other, values that are not finite, a light or a camera that
        is not above the sample, and a camera that does not see all of it.
    """

    pictures: FloatArray
    positions: FloatArray
    intensities: FloatArray
    camera: Pinhole | tuple[Pinhole, ...]
    size: tuple[float, float]
    names: tuple[str, ...]
    lost: BoolArray | None = None

    def __post_init__(self) -> None:
        check_capture(self)

    def select_lights(self, lights: IntArray) -> Capture:
        """Return the photographs with the given indices."""
        return replace(
            self,
            pictures=self.pictures[lights],
            positions=self.positions[lights],
            intensities=self.intensities[lights],
            camera=tuple(self.cameras[k] for k in lights),
            names=tuple(self.names[k] for k in lights),
            lost=self.excluded[lights],
        )

    @property
    def cameras(self) -> tuple[Pinhole, ...]:
        """The cameras of all pictures, in their order, which may be one and the same."""
        if isinstance(self.camera, Pinhole):
            return (self.camera,) * len(self.pictures)
        return tuple(self.camera)

    def texel_centres(self, shape: tuple[int, int]) -> FloatArray:
        """Return the centres (n, 3) [m] of the texels of maps of `shape` (height, width).

        The texels go row by row from the sample's upper edge.
        """
        height, width = shape
        x = ((np.arange(width) + 0.5) / width - 0.5) * self.size[0]
        y = (0.5 - (np.arange(height) + 0.5) / height) * self.size[1]
        x, y = np.meshgrid(x, y)
        return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)

    def default_shape(self, longest_side: int) -> tuple[int, int]:
        """Return the shape (height, width) of maps with square texels about as large as pixels.

        The maps are made coarser where they would have more than `longest_side` texels along a
        side.
        """
        sides = np.array([self.pixel_size(camera) for camera in self.cameras])
        width, height = np.array(self.size) / np.sqrt(sides.prod(axis=1)).mean()
        shrink = min(1.0, longest_side / max(width, height))
        return max(SMALLEST_MAP, round(height * shrink)), max(SMALLEST_MAP, round(width * shrink))

    def pixel_size(self, camera: Pinhole) -> FloatArray:
        """Return the width and height (2,) [m] of a camera's pixel in the middle of the sample."""
        step = 1e-4 * min(self.size)
        points = np.array([[0, 0, 0], [step, 0, 0], [0, step, 0]])
        middle, right, above = camera.project(points, self.picture_size)
        return step / np.linalg.norm([right - middle, above - middle], axis=1)

    def is_shown(self, k: int, points: FloatArray) -> BoolArray:
        """Return which points (..., 2) [m] of the sample can be measured in picture `k`.

        These points lie at least a pixel inside the sample's edge, and the light does not graze
        them.
        """
        margin = np.array(self.size) / 2 - self.pixel_size(self.cameras[k])
        inside = np.all(np.abs(points) < margin, axis=-1)
        points = np.where(inside[..., None], points, 0)
        across = np.linalg.norm(self.positions[k, :2] - points, axis=-1)
        height = self.positions[k, 2]
        return inside & (height > SMALLEST_COSINE * np.hypot(across, height))

    @cached_property
    def counted(self) -> BoolArray:
        """The mask (lights, height, width, 3) of usable values: of the sample, and not excluded."""
        shown = [
            self.is_shown(k, camera.on_sample(self.picture_size))
            for k, camera in enumerate(self.cameras)
        ]
        return np.array(shown)[..., None] & ~self.excluded

    @property
    def picture_size(self) -> tuple[int, int]:
        """The width and height of the pictures [pixels]."""
        return self.pictures.shape[2], self.pictures.shape[1]

    @cached_property
    def clipped(self) -> BoolArray:
        """The mask (lights, height, width, 3) of values at which the camera's sensor is saturated.

        Each colour is saturated at a value of its own, because a white balance scales the colours.
        """
        largest = self.pictures.max(axis=(0, 1, 2))
        at_end = (self.pictures == largest) & (largest > 0)  # a black channel is not clipped
        several = at_end.sum(axis=(0, 1, 2)) > 1
        return at_end & several & (at_end.mean(axis=(0, 1, 2)) > CLIPPED_SHARE)

    @property
    def excluded(self) -> BoolArray:
        """The mask (lights, height, width, 3) of values that no fit may use.

        These are values that are `lost` or clipped, and all values of black pictures.
        """
        black = ~(self.pictures.mean(axis=(1, 2, 3), dtype=float) > 0)
        excluded = self.clipped if self.lost is None else self.lost
        return excluded | black[:, None, None, None]


def downsample(capture: Capture, shape: tuple[int, int]) -> Capture:
    """Return a `Capture` with as few pixels as maps of `shape` (height, width) need.

    Square blocks of pixels are averaged. Their sides are odd, so that a picture can be padded by
    equal numbers of pixels on both sides, and the camera's axis stays in its middle.
    """
    height, width = shape
    texel = np.array(capture.size) / (width, height)
    pixel = np.max([capture.pixel_size(camera) for camera in capture.cameras], axis=0)
    side = int((texel / pixel).min() / PIXELS_PER_TEXEL)
    side -= (side + 1) % 2
    if side < 2:
        return capture
    wide, high = (_find_padding(pixels, side) for pixels in capture.picture_size)
    around = (0, 0), (high, high), (wide, wide), (0, 0)
    lost = np.pad(capture.excluded, around, constant_values=True)
    pictures = np.pad(capture.pictures, around)
    scale = pictures.shape[2] / capture.picture_size[0]
    cameras = [replace(camera, fov=_widen_fov(camera.fov, scale)) for camera in capture.cameras]
    return replace(
        capture,
        pictures=_split_into_blocks(pictures, side).mean(axis=(2, 4)),
        lost=np.any(_split_into_blocks(lost, side), axis=(2, 4)),
        camera=cameras[0] if len(set(map(id, capture.cameras))) == 1 else tuple(cameras),
    )


def _find_padding(pixels: int, side: int) -> int:
    """Return how many pixels each end of a row needs, to make its length a multiple of `side`."""
    return next(n for n in range(side) if (pixels + 2 * n) % side == 0)


def _widen_fov(fov: float, scale: float) -> float:
    """Return the field of view [degrees] of a picture that is padded to `scale` times its width."""
    return float(2 * np.degrees(np.arctan(scale * np.tan(np.radians(fov) / 2))))


def _split_into_blocks(values: AnyArray, side: int) -> AnyArray:
    """Return pictures (k, height, width, c) as square blocks (k, rows, side, columns, side, c)."""
    lights, height, width, channels = values.shape
    return values.reshape(lights, height // side, side, width // side, side, channels)
