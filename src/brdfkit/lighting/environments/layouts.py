"""Layouts of environment maps: where in a picture the light of a direction lies.

Directions (..., 3) are (right, up, ahead), as an observer in the middle of the map sees it from
inside. Every layout here, and the cubes in `cubes.py`, has

- `aspect`, the picture's width over its height, and `rows`, its height in quarters of a circle;
- `directions(x, y, height, width)`, the directions at places x and y [pixels], where 0 is the
  middle of the first pixel; NaN where the picture is blank;
- `places(directions, height, width)`, the inverse: x, y, and the number of the picture's part that
  holds the place. Pixels of different parts are not neighbours in space, even where they are
  neighbours in the picture;
- `closed`, whether the last column is a neighbour of the first.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry import dual_paraboloid

AT_POLE = 1e-12  # polar angle [rad] of a row at the upper pole, whose pixels keep their azimuths

Places = tuple[FloatArray, FloatArray, IntArray]  # x, y, and the part


@dataclass(frozen=True)
class LatitudeLongitude:
    """The azimuth runs across the picture and the polar angle down; ahead is in the middle.

    `at_poles` says whether the first and the last row lie at the poles, as in Mitsuba. Otherwise
    they lie half a row away from the poles.
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

    def places(self, directions: FloatArray, height: int, width: int) -> Places:
        right, up, ahead = np.moveaxis(directions, -1, 0)
        turn = np.arctan2(right, ahead) / (2 * np.pi) + 0.5
        row = np.arctan2(np.hypot(right, ahead), up) / np.pi
        y = row * (height - 1) if self.at_poles else row * height - 0.5
        return turn * width - 0.5, y, np.zeros(turn.shape, int)


@dataclass(frozen=True)
class Angular:
    """A light probe of P. Debevec: a disc whose middle is ahead and whose rim is behind.

    The distance from the middle is proportional to the angle from the direction ahead.
    """

    aspect: float = 1.0
    rows: float = 4.0
    closed: bool = False

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        s, t = _to_square(x, height), -_to_square(y, height)
        r = np.hypot(s, t)
        across = np.pi * np.sinc(r)  # sin(π r) / r
        towards = np.stack([s * across, t * across, np.cos(np.pi * r)], axis=-1)
        return np.where((r <= 1)[..., None], towards, np.nan)

    def places(self, directions: FloatArray, height: int, width: int) -> Places:
        right, up, ahead = np.moveaxis(directions, -1, 0)
        side = np.hypot(right, up)
        r = np.minimum(np.arctan2(side, ahead) / np.pi, _safe_radius(height))
        scale = r / np.where(side > 0, side, 1)
        x, y = _to_pixel(right * scale, height), _to_pixel(-up * scale, height)
        return x, y, np.zeros(x.shape, int)


@dataclass(frozen=True)
class Paraboloids:
    """A dual-paraboloid map: the hemisphere ahead in the left disc, the one behind in the right."""

    aspect: float = 2.0
    rows: float = 2.0
    closed: bool = False

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        behind = x > height - 0.5
        s, t = _to_square(x - behind * height, height), -_to_square(y, height)
        towards = np.stack(dual_paraboloid.from_disc(s, t, np.where(behind, -1, 1)), axis=-1)
        return np.where((np.hypot(s, t) <= 1)[..., None], towards, np.nan)

    def places(self, directions: FloatArray, height: int, width: int) -> Places:
        s, t = dual_paraboloid.to_disc(*np.moveaxis(directions, -1, 0))
        inside = np.minimum(1, _safe_radius(height) / np.maximum(np.hypot(s, t), 1e-9))
        behind = (directions[..., 2] < 0).astype(int)
        x = _to_pixel(s * inside, height) + behind * height
        return x, _to_pixel(-t * inside, height), behind


def _to_square(pixel: AnyArray, size: int) -> FloatArray:
    """Convert a pixel's coordinate in a square of `size` pixels to the range -1 to 1."""
    return (2 * pixel + 1) / size - 1


def _to_pixel(coordinate: FloatArray, size: int) -> FloatArray:
    """Convert a coordinate in the range -1 to 1 to that of a pixel in a square of `size` pixels."""
    return ((coordinate + 1) * size - 1) / 2


def _safe_radius(size: int) -> float:
    """Return the largest radius whose nearest pixel's middle lies in the disc for certain."""
    return float(1 - np.sqrt(2) / size)
