"""`Capture`: photographs of a flat sample under known lights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from brdfkit.inverse.photographs.capture.checks import require_right
from brdfkit.inverse.photographs.capture.pinhole import Pinhole

CLIPPED = 1e-4  # the share of numbers that equal the largest: not by chance
LOWEST = 0.05  # cosine of a light's angle: below it the sample's own shadows fall where bumps are


@dataclass(frozen=True, eq=False)
class Capture:
    """Photographs of a flat sample, each under one point light, by a camera that rests or moves.

    The sample lies in the plane z = 0, its middle at the origin, x to the right, y up; it is seen
    from above (z > 0).

    Attributes
    ----------
    pictures : ndarray, shape (lights, height, width, 3)
        Linear values: radiance [W/(m² sr)], or anything in proportion, alike in all pictures.
    positions : ndarray, shape (lights, 3)
        Where the lights are [m].
    intensities : ndarray, shape (lights, 3)
        Radiant intensity of the lights [W/sr], in the units of the pictures.
    camera : Pinhole, or tuple of Pinhole
        The camera that rests, or where it was for each picture.
    size : tuple of float
        The sample's width and height [m].
    names : tuple of str
        What the pictures are called.
    lost : ndarray of bool, shape (lights, height, width, 3), optional
        Numbers of the pictures that do not count, as where a shadow falls on the sample. By default
        those at the end of what the camera could hold: see `clipped`.

    Raises
    ------
    BrdfkitError
        For shapes that do not fit each other, values that are not finite, pictures that are black,
        a light or a camera that is not above the sample, and a camera that does not see all of it.
    """

    pictures: NDArray[np.float64]
    positions: NDArray[np.float64]
    intensities: NDArray[np.float64]
    camera: Pinhole | tuple[Pinhole, ...]
    size: tuple[float, float]
    names: tuple[str, ...]
    lost: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        require_right(self)

    @property
    def cameras(self):
        """The camera of each picture, a tuple."""
        if isinstance(self.camera, Pinhole):
            return (self.camera,) * len(self.pictures)
        return tuple(self.camera)

    def texels(self, shape):
        """Points (n, 3) [m] in the middle of the texels of a map of `shape` (height, width), row by
        row from the top."""
        height, width = shape
        x = ((np.arange(width) + 0.5) / width - 0.5) * self.size[0]
        y = (0.5 - (np.arange(height) + 0.5) / height) * self.size[1]
        x, y = np.meshgrid(x, y)
        return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)

    def usual_shape(self, most=512):
        """(height, width) of maps of square texels, about as large as a pixel in the middle."""
        sides = np.array([self.pixel(camera) for camera in self.cameras])
        width, height = np.array(self.size) / np.sqrt(sides.prod(axis=1)).mean()
        shrink = min(1.0, most / max(width, height))
        return max(4, round(height * shrink)), max(4, round(width * shrink))

    def pixel(self, camera):
        """Width and height (2,) of a pixel of a `camera` in the middle of the sample [m]."""
        step = 1e-4 * min(self.size)
        across = np.array([[0, 0, 0], [step, 0, 0], [0, step, 0]])
        middle, right, above = camera.project(across, self.picture_size)
        return step / np.linalg.norm([right - middle, above - middle], axis=1)

    def is_shown(self, k, points):
        """Whether picture k shows points (..., 2) [m] well: a pixel or more within the sample,
        under a light that does not graze it."""
        margin = np.array(self.size) / 2 - self.pixel(self.cameras[k])
        inside = (np.abs(points) < margin).all(axis=-1)
        points = np.where(inside[..., None], points, 0)
        across = np.linalg.norm(self.positions[k, :2] - points, axis=-1)
        height = self.positions[k, 2]
        return inside & (height > LOWEST * np.hypot(across, height))

    @cached_property
    def counted(self):
        """Which numbers (lights, height, width, 3) show the sample alone, and are not left out."""
        shown = [
            self.is_shown(k, camera.on_sample(self.picture_size))
            for k, camera in enumerate(self.cameras)
        ]
        return np.array(shown)[..., None] & ~self.left_out

    @property
    def picture_size(self):
        """(width, height) of the pictures [pixels]."""
        return self.pictures.shape[2], self.pictures.shape[1]

    @cached_property
    def clipped(self):
        """Which numbers (lights, height, width, 3) are at the end of what the camera could hold.

        Each colour has an end of its own, as a white balance moves them apart.
        """
        end = self.pictures.max(axis=(0, 1, 2))
        at_end = (self.pictures == end) & (end > 0)  # without light of a colour all are at 0
        several = at_end.sum(axis=(0, 1, 2)) > 1
        return at_end & several & (at_end.mean(axis=(0, 1, 2)) > CLIPPED)

    @property
    def left_out(self):
        """Which numbers (lights, height, width, 3) do not count: those `lost`, or clipped."""
        return self.clipped if self.lost is None else self.lost
