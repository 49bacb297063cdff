"""The lights of the ball's pictures: formulas for the grey radiance from each direction.

In the world z points up, and the camera looks at the ball from the south (-y). Each picture has its
own exposure, so that only the ratios of a light's radiances matter.
"""

from collections.abc import Callable
from functools import cache

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.geometry.directions import from_angles

# A light is tabulated in cells: the numbers of cells over polar angle and azimuth, and of points
# along each side of a cell, over which its radiance is averaged
CELLS, POINTS = (96, 192), 4
FLOOR = 0.02  # smallest density of a direction, relative to the mean density


def court_radiance(w: AnyArray) -> AnyArray:
    """Return the radiance (n,) of a courtyard from directions `w` (n, 3): sky, walls, ground."""
    walls = np.where(w[:, 2] < 0, 0.3, 0.5 - 0.25 * w[:, 2])
    return walls + 6 * (w[:, 2] > 0.75)


def hall_radiance(w: AnyArray) -> AnyArray:
    """Return the radiance (n,) of a dim hall with seven small lamps from directions `w` (n, 3)."""
    lamps = (  # (azimuth, elevation) in degrees, and radiance
        ((180, 40), 500),
        ((140, 30), 200),
        ((230, 50), 500),
        ((260, 15), 200),
        ((100, 20), 500),
        ((20, 60), 200),
        ((320, 30), 500),
    )
    return 0.1 * (1 + np.maximum(w[:, 2], 0)) + sum(
        radiance * _is_in_disc(w, *place, radius=1.2) for place, radiance in lamps
    )


def sky_radiance(w: AnyArray) -> AnyArray:
    """Return the radiance (n,) of a clear sky with a low sun from directions `w` (n, 3).

    The sun is behind the ball, to the right.
    """
    sun = 56, 27
    glow = 3 * np.exp(6 * (w @ _direction_to(*sun) - 1))
    above = (
        0.25
        + 0.5 * (1 - np.maximum(w[:, 2], 0)) ** 2
        + glow
        + 150 * _is_in_disc(w, *sun, radius=2.5)
    )
    return np.where(w[:, 2] < 0, 0.25, above)


def studio_radiance(w: AnyArray) -> AnyArray:
    """Return the radiance (n,) of a dim room with two softboxes from directions `w` (n, 3).

    The softboxes are at the upper left and at the right.
    """
    grey = np.where(w[:, 2] < 0, 0.15, 0.05 + 0.25 * w[:, 2])
    softbox, other = (234, 38), (117, 13)
    return grey + 3.3 * _is_in_disc(w, *softbox, radius=22) + 2 * _is_in_disc(w, *other, radius=12)


LIGHTS = {
    "court": court_radiance,
    "hall": hall_radiance,
    "sky": sky_radiance,
    "studio": studio_radiance,
}


def _direction_to(azimuth: float, elevation: float) -> AnyArray:
    """Return the unit vector towards an azimuth, from north (+y) to east, and an elevation.

    The angles are in degrees.
    """
    return from_angles(np.radians(90 - elevation), np.radians(90 - azimuth))


def _is_in_disc(w: AnyArray, azimuth: float, elevation: float, radius: float) -> AnyArray:
    """Return 1 for directions `w` (n, 3) within the `radius` [degrees] of a direction, else 0."""
    return 1.0 * (w @ _direction_to(azimuth, elevation) > np.cos(np.radians(radius)))


class LightSampling:
    """Draws directions in proportion to a light's radiance, from a table over both angles."""

    def __init__(self, light: Callable[[AnyArray], AnyArray]) -> None:
        heights, widths = CELLS
        # Polar angles are divided evenly into rows of cells, whose edges have these cosines
        self.z = np.cos(np.arange(heights + 1) / heights * np.pi)
        inside = (np.arange(POINTS) + 0.5) / POINTS
        z = (self.z[:-1, None] + np.diff(self.z)[:, None] * inside).ravel()
        phi = (np.arange(widths * POINTS) + 0.5) / (widths * POINTS) * 2 * np.pi
        w = from_angles(np.arccos(z)[:, None], phi).reshape(-1, 3)
        means = light(w).reshape(heights, POINTS, widths, POINTS).mean(axis=(1, 3))
        areas = np.broadcast_to(-np.diff(self.z)[:, None] * 2 * np.pi / widths, CELLS)
        masses = (means + FLOOR * np.average(means, weights=areas)) * areas
        self.sums = np.cumsum(masses / masses.sum())
        self.densities = masses / masses.sum() / areas

    def sample(self, u: AnyArray) -> AnyArray:
        """Draw directions (n, 3) by random points `u` (n, 3) of the unit cube."""
        heights, widths = CELLS
        cell = np.minimum(np.searchsorted(self.sums, u[:, 0]), heights * widths - 1)
        row, column = np.divmod(cell, widths)
        z = self.z[row] + np.diff(self.z)[row] * u[:, 1]
        return from_angles(np.arccos(z), (column + u[:, 2]) / widths * 2 * np.pi)

    def pdf(self, w: AnyArray) -> AnyArray:
        """Return the densities (n,) [sr⁻¹] with which `sample` draws the directions `w` (n, 3)."""
        heights, widths = CELLS
        row = np.arccos(np.clip(w[:, 2], -1, 1)) / np.pi * heights
        column = np.arctan2(w[:, 1], w[:, 0]) / (2 * np.pi) % 1 * widths
        cells = (x.astype(int).clip(0, n - 1) for x, n in zip((row, column), CELLS, strict=True))
        return self.densities[tuple(cells)]


@cache
def get_light_sampling(name: str) -> LightSampling:
    """Return the `LightSampling` of the light called `name`; its table is made only once."""
    return LightSampling(LIGHTS[name])
