"""`Capture`: photographs of a flat sample under known lights."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brdfkit.errors import BrdfkitError
from brdfkit.photographs.pinhole import Pinhole

CLIPPED = 1e-4  # the share of numbers that equal the largest: not by chance


@dataclass(frozen=True)
class Capture:
    """Photographs of a flat sample, each under one point light; the camera rests.

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
    camera : Pinhole
        The camera.
    size : tuple of float
        The sample's width and height [m].
    names : tuple of str
        What the pictures are called.

    Raises
    ------
    BrdfkitError
        For shapes that do not fit each other, values that are not finite, a light or a camera that
        is not above the sample, and a camera that does not see all of it.
    """

    pictures: NDArray[np.float64]
    positions: NDArray[np.float64]
    intensities: NDArray[np.float64]
    camera: Pinhole
    size: tuple[float, float]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        count = len(self.pictures)
        if self.pictures.ndim != 4 or self.pictures.shape[3] != 3 or not count:
            raise BrdfkitError(
                f"pictures: their shape {self.pictures.shape} should be (lights, height, width, 3)."
            )
        for name in ("positions", "intensities"):
            shape = np.shape(getattr(self, name))
            if shape != (count, 3):
                raise BrdfkitError(
                    f"{name}: their shape {shape} should be ({count}, 3), for {count} pictures."
                )
        for name, picture, position in zip(self.names, self.pictures, self.positions, strict=True):
            if not np.isfinite(picture).all():
                bad = int((~np.isfinite(picture)).any(axis=2).sum())
                raise BrdfkitError(f"{name}: {bad:,} of its pixels are not finite.")
            if not position[2] > 0:
                raise BrdfkitError(
                    f"{name}: its light is at z = {position[2]:g} m, behind the sample; z should "
                    "be above 0."
                )
        if not (self.intensities > 0).any(axis=1).all():
            raise BrdfkitError("intensities: each light needs one above 0.")
        if not self.camera.origin[2] > 0:
            raise BrdfkitError(
                f"camera: it is at z = {self.camera.origin[2]:g} m, behind the sample; z should be "
                "above 0."
            )
        _require_seen(self)

    def texels(self, shape):
        """Points (n, 3) [m] in the middle of the texels of a map of `shape` (height, width), row by
        row from the top."""
        height, width = shape
        x = ((np.arange(width) + 0.5) / width - 0.5) * self.size[0]
        y = (0.5 - (np.arange(height) + 0.5) / height) * self.size[1]
        x, y = np.meshgrid(x, y)
        return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)

    def usual_shape(self, most=512):
        """(height, width) of maps whose texels are about as large as a pixel in the middle."""
        width, height = np.array(self.size) / self.pixel
        shrink = min(1.0, most / max(width, height))
        return max(4, round(height * shrink)), max(4, round(width * shrink))

    @property
    def pixel(self):
        """Width and height (2,) of a pixel in the middle of the sample [m]."""
        step = 1e-4 * min(self.size)
        across = np.array([[0, 0, 0], [step, 0, 0], [0, step, 0]])
        middle, right, above = self.camera.project(across, self.picture_size)
        return step / np.linalg.norm([right - middle, above - middle], axis=1)

    @property
    def picture_size(self):
        """(width, height) of the pictures [pixels]."""
        return self.pictures.shape[2], self.pictures.shape[1]

    @property
    def clipped(self):
        """Which numbers (lights, height, width, 3) are at the end of what the camera could hold.

        Each colour has an end of its own, as a white balance moves them apart.
        """
        at_end = self.pictures == self.pictures.max(axis=(0, 1, 2))
        return at_end & (at_end.mean(axis=(0, 1, 2)) > CLIPPED)


def _require_seen(capture):
    """Raise `BrdfkitError` unless the sample's corners are in the pictures."""
    w, h = capture.size
    corners = np.array([[x, y, 0] for x in (-w / 2, w / 2) for y in (-h / 2, h / 2)])
    width, height = capture.picture_size
    places = capture.camera.project(corners, (width, height))
    inside = (places >= -1) & (places <= np.array([width, height]) + 1)
    if not inside.all():
        raise BrdfkitError(
            "camera: it does not see all four corners of the sample; check its place, its target, "
            "its fov, and the sample's width and height in metres."
        )
