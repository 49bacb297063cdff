"""Layouts: where in a picture the light of a direction lies.

A direction is given in the frame of somebody in the middle who looks at the map from inside: right,
up and ahead. All layouts show the map as it is seen so, not mirrored. A layout has

- `aspect`, the width over the height, and `rows`, the rows of the picture per quarter of a circle;
- `directions(x, y, height, width)`: the directions (..., 3) at places, NaN where the picture is
  blank; the middle of the first pixel is at x = y = 0;
- `places(directions, height, width)`: the inverse, x and y, and the part of the picture: pixels of
  another part are no neighbours in space, even where they are in the picture;
- `closed`: whether the last column is beside the first.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.geometry import dual_paraboloid

AT_POLE = 1e-12  # polar angle of a row at the upper pole: its pixels keep their azimuths


@dataclass(frozen=True)
class LatitudeLongitude:
    """Azimuth across, polar angle down; ahead is in the middle. `at_poles`: the first and the last
    row lie at the poles themselves, as in Mitsuba; else rows lie half a row from them."""

    at_poles: bool
    aspect: float = 2.0
    rows: float = 2.0
    closed: bool = True

    def directions(self, x, y, height, width):
        phi = 2 * np.pi * ((x + 0.5) / width - 0.5)
        theta = np.pi * (y / (height - 1) if self.at_poles else (y + 0.5) / height)
        theta = np.where(theta == 0, AT_POLE, theta)
        sine = np.sin(theta)
        return np.stack([sine * np.sin(phi), np.cos(theta) + 0 * phi, sine * np.cos(phi)], axis=-1)

    def places(self, directions, height, width):
        right, up, ahead = np.moveaxis(directions, -1, 0)
        turn = np.arctan2(right, ahead) / (2 * np.pi) + 0.5
        row = np.arctan2(np.hypot(right, ahead), up) / np.pi
        y = row * (height - 1) if self.at_poles else row * height - 0.5
        return turn * width - 0.5, y, np.zeros(turn.shape, int)


@dataclass(frozen=True)
class Angular:
    """P. Debevec's light probes: a disc, whose middle is ahead and whose rim is behind; the
    distance from the middle is the angle."""

    aspect: float = 1.0
    rows: float = 4.0
    closed: bool = False

    def directions(self, x, y, height, width):
        s, t = _centred(x, height), -_centred(y, height)
        r = np.hypot(s, t)
        across = np.pi * np.sinc(r)  # sin(π r) / r
        found = np.stack([s * across, t * across, np.cos(np.pi * r)], axis=-1)
        return np.where((r <= 1)[..., None], found, np.nan)

    def places(self, directions, height, width):
        right, up, ahead = np.moveaxis(directions, -1, 0)
        side = np.hypot(right, up)
        r = np.minimum(np.arctan2(side, ahead) / np.pi, _rim(height))
        scale = r / np.where(side > 0, side, 1)
        x, y = _pixel(right * scale, height), _pixel(-up * scale, height)
        return x, y, np.zeros(x.shape, int)


@dataclass(frozen=True)
class Paraboloids:
    """The dual-paraboloid map: what is ahead in the left disc, what is behind in the right one."""

    aspect: float = 2.0
    rows: float = 2.0
    closed: bool = False

    def directions(self, x, y, height, width):
        behind = x > height - 0.5
        s, t = _centred(x - behind * height, height), -_centred(y, height)
        found = np.stack(dual_paraboloid.from_disc(s, t, np.where(behind, -1, 1)), axis=-1)
        return np.where((np.hypot(s, t) <= 1)[..., None], found, np.nan)

    def places(self, directions, height, width):
        s, t = dual_paraboloid.to_disc(*np.moveaxis(directions, -1, 0))
        inside = np.minimum(1, _rim(height) / np.maximum(np.hypot(s, t), 1e-9))
        behind = (directions[..., 2] < 0).astype(int)
        return _pixel(s * inside, height) + behind * height, _pixel(-t * inside, height), behind


def _centred(pixel, size):
    """-1 to 1 of a pixel's coordinate in a square of `size` pixels."""
    return (2 * pixel + 1) / size - 1


def _pixel(centred, size):
    return ((centred + 1) * size - 1) / 2


def _rim(size):
    """The largest radius at which the nearest pixel's middle lies in the disc for sure."""
    return 1 - np.sqrt(2) / size
