"""`Capture`: photographs of a flat sample under known lights."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from brdfkit.errors import BrdfkitError
from brdfkit.photographs.pinhole import Pinhole

SMALLEST = 8  # pixels along the longer side of the sample
CLIPPED = 1e-4  # the share of numbers that equal the largest: not by chance


@dataclass(frozen=True)
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
        For shapes that do not fit each other, values that are not finite, a light or a camera that
        is not above the sample, and a camera that does not see all of it.
    """

    pictures: NDArray[np.float64]
    positions: NDArray[np.float64]
    intensities: NDArray[np.float64]
    camera: Pinhole | tuple[Pinhole, ...]
    size: tuple[float, float]
    names: tuple[str, ...]
    lost: NDArray[np.bool_] | None = None

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
        if len(self.cameras) != count:
            raise BrdfkitError(
                f"camera: there are {len(self.cameras)} for {count} pictures; give one for all, or "
                "one for each."
            )
        if self.lost is not None and np.shape(self.lost) != self.pictures.shape:
            raise BrdfkitError(
                f"lost: its shape {np.shape(self.lost)} should be that of the pictures, "
                f"{self.pictures.shape}."
            )
        for name, camera in zip(self.names, self.cameras, strict=True):
            if not camera.origin[2] > 0:
                raise BrdfkitError(
                    f"{name}: its camera is at z = {camera.origin[2]:g} m, behind the sample; z "
                    "should be above 0."
                )
            _require_seen(self, name, camera)

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

    def is_inside(self, camera, points):
        """Whether points (..., 2) [m] are a pixel of a `camera`, or more, within the sample."""
        margin = np.array(self.size) / 2 - self.pixel(camera)
        return (np.abs(points) < margin).all(axis=-1)

    @cached_property
    def counted(self):
        """Which numbers (lights, height, width, 3) show the sample alone, and are not left out."""
        inside = [
            self.is_inside(camera, camera.on_sample(self.picture_size)) for camera in self.cameras
        ]
        return np.array(inside)[..., None] & ~self.left_out

    @property
    def picture_size(self):
        """(width, height) of the pictures [pixels]."""
        return self.pictures.shape[2], self.pictures.shape[1]

    @cached_property
    def clipped(self):
        """Which numbers (lights, height, width, 3) are at the end of what the camera could hold.

        Each colour has an end of its own, as a white balance moves them apart.
        """
        at_end = self.pictures == self.pictures.max(axis=(0, 1, 2))
        return at_end & (at_end.mean(axis=(0, 1, 2)) > CLIPPED)

    @property
    def left_out(self):
        """Which numbers (lights, height, width, 3) do not count: those `lost`, or clipped."""
        return self.clipped if self.lost is None else self.lost


def _require_seen(capture, name, camera):
    """Raise `BrdfkitError` unless the sample's corners are in the picture of a camera."""
    width, height = capture.picture_size
    places = camera.project(corners_of(capture.size), (width, height))
    inside = (places >= -1) & (places <= np.array([width, height]) + 1)
    if inside.all() and np.ptp(places, axis=0).max() < SMALLEST:
        raise BrdfkitError(
            f"{name}: the sample is smaller than {SMALLEST} pixels; check that its size and the "
            "place of the camera are both in metres."
        )
    if not inside.all():
        raise BrdfkitError(
            f"{name}: its camera does not see all four corners of the sample; check its place, its "
            "target, its fov, and the sample's width and height in metres."
        )


def corners_of(size):
    """The corners (4, 3) of a sample of `size` [m], clockwise from the upper left."""
    w, h = np.array(size) / 2
    return np.array([[-w, h, 0], [w, h, 0], [w, -h, 0], [-w, -h, 0]])
