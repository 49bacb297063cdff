"""Layouts of environment maps: relations between the pixels of a picture and directions.

Directions (..., 3) have the components right, up and ahead, for an observer within the environment.
Every layout here, and the cube maps in `cubes.py`, has

- `aspect`: the picture's width over its height;
- `rows`: the angle along the picture's height in quarters of a circle, 2 from pole to pole;
- `directions(x, y, height, width)`: the directions at x and y [pixels], where whole numbers are the
  middles of pixels; NaN where the picture is blank;
- `pixel_coordinates(directions, height, width)`: the inverse, which returns x, y, and the number of
  the picture's part, such as a face of a cube. Neighbouring pixels of different parts are not
  neighbours in space;
- `closed`: whether the last column of pixels is a neighbour of the first.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry import dual_paraboloid

AT_POLE = 1e-12  # polar angle [rad] that replaces 0, where a direction would lose its azimuth

# x and y of pixels, and the index of the part of the picture in which each lies
PixelCoordinates = tuple[FloatArray, FloatArray, IntArray]


@dataclass(frozen=True)
class LatitudeLongitude:
    """The layout by latitude and longitude: azimuth across, polar angle down, middle pixel ahead.

    `at_poles` says whether the first and the last row of pixels lie at the poles, as in Mitsuba.
    Otherwise they lie half a row away from the poles.
    """

    at_poles: bool
    aspect: float = 2.0
    rows: float = 2.0
    closed: bool = True

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        phi = 2 * np.pi * ((x + 0.5) / width - 0.5)
        theta = np.pi * (y / (height - 1) if self.at_poles else (y + 0.5) / height)
        theta = np.where(theta == 0, AT_POLE, theta)
        sine = np.sin(theta)
        return np.stack([sine * np.sin(phi), np.cos(theta) + 0 * phi, sine * np.cos(phi)], axis=-1)

    def pixel_coordinates(
        self, directions: FloatArray, height: int, width: int
    ) -> PixelCoordinates:
        right, up, ahead = np.moveaxis(directions, -1, 0)
        turn = np.arctan2(right, ahead) / (2 * np.pi) + 0.5
        row = np.arctan2(np.hypot(right, ahead), up) / np.pi
        y = row * (height - 1) if self.at_poles else row * height - 0.5
        return turn * width - 0.5, y, np.zeros(turn.shape, int)


@dataclass(frozen=True)
class Angular:
    """The layout of P. Debevec's light probes: a disc whose middle is ahead, its rim behind.

    The distance from the middle is proportional to the angle to the direction ahead.
    """

    aspect: float = 1.0
    rows: float = 4.0
    closed: bool = False

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        s, t = _pixel_to_square(x, height), -_pixel_to_square(y, height)
        r = np.hypot(s, t)
        across = np.pi * np.sinc(r)  # sin(π r) / r, with its limit π at r = 0
        towards = np.stack([s * across, t * across, np.cos(np.pi * r)], axis=-1)
        return np.where((r <= 1)[..., None], towards, np.nan)

    def pixel_coordinates(
        self, directions: FloatArray, height: int, width: int
    ) -> PixelCoordinates:
        right, up, ahead = np.moveaxis(directions, -1, 0)
        side = np.hypot(right, up)
        r = np.minimum(np.arctan2(side, ahead) / np.pi, _largest_disc_radius(height))
        scale = r / np.where(side > 0, side, 1)
        x, y = _square_to_pixel(right * scale, height), _square_to_pixel(-up * scale, height)
        return x, y, np.zeros(x.shape, int)


@dataclass(frozen=True)
class Paraboloids:
    """The dual-paraboloid layout: discs with the hemispheres ahead (left) and behind (right)."""

    aspect: float = 2.0
    rows: float = 2.0
    closed: bool = False

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        behind = x > height - 0.5
        s, t = _pixel_to_square(x - behind * height, height), -_pixel_to_square(y, height)
        towards = np.stack(dual_paraboloid.from_disc(s, t, np.where(behind, -1, 1)), axis=-1)
        return np.where((np.hypot(s, t) <= 1)[..., None], towards, np.nan)

    def pixel_coordinates(
        self, directions: FloatArray, height: int, width: int
    ) -> PixelCoordinates:
        s, t = dual_paraboloid.to_disc(*np.moveaxis(directions, -1, 0))
        inside = np.minimum(1, _largest_disc_radius(height) / np.maximum(np.hypot(s, t), 1e-9))
        behind = (directions[..., 2] < 0).astype(int)
        x = _square_to_pixel(s * inside, height) + behind * height
        return x, _square_to_pixel(-t * inside, height), behind


def _pixel_to_square(pixel: AnyArray, size: int) -> FloatArray:
    """Convert a coordinate [pixels] in a square picture of `size` pixels to the range -1 to 1."""
    return (2 * pixel + 1) / size - 1


def _square_to_pixel(coordinate: FloatArray, size: int) -> FloatArray:
    """Convert a coordinate from -1 to 1 to pixels, in a square picture of `size` pixels."""
    return ((coordinate + 1) * size - 1) / 2


def _largest_disc_radius(size: int) -> float:
    """Return the largest radius at which every point's nearest pixel has its centre in the disc.

    The disc fills a square picture of `size` pixels and has the radius 1. Pixels outside it are
    blank, so that points closer to its rim are looked up at this radius.
    """
    return float(1 - np.sqrt(2) / size)
