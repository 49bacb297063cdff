"""Filtered environment maps in Mitsuba: the mean radiance over a lobe by one trilinear look-up.

`LobeMaps` and `Mips` are made of their levels. `make_levels` makes these in NumPy alone, in any
thread: of the finest one, and of a `picture` of the light by latitude and longitude.
`mean_over_lobe` returns the mean radiance over the von Mises-Fisher lobe with an `axis` and the
concentration `kappa`.
"""

import math
from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import FloatArray, JitColour, JitFloat, JitInt, JitVector
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.dual_paraboloid import to_disc
from brdfkit.lighting.filtering import paraboloid_levels as levels
from brdfkit.lighting.filtering.sphere_filter import column_azimuths, row_polar_angles
from brdfkit.mitsuba_bridge.arrays import Rows

Radiance = Callable[[FloatArray], FloatArray]


class FilteredMap:
    """Environment maps of decreasing resolution, the levels, to look up by direction and level.

    A level (2, side, side, 3) has a picture of each hemisphere, as in `paraboloid_levels.py`.
    """

    def __init__(self, levels: list[FloatArray]) -> None:
        sides = np.array([level.shape[1] for level in levels])
        starts = np.cumsum(2 * sides**2) - 2 * sides**2
        texels = np.concatenate([level.reshape(-1, 3).astype(np.float32) for level in levels])
        # A fourth channel is added, since a texel of four numbers is read by one memory access
        self.texels = Rows(np.pad(texels, ((0, 0), (0, 1))))
        self.places = Rows(np.stack([starts, sides], axis=1))
        self.count = len(levels)

    def interpolate_trilinearly(self, direction: JitVector, level: JitFloat) -> JitColour:
        """Return the radiance in a `direction` at a fractional `level`, between two levels."""
        import drjit as dr
        import mitsuba as mi

        level = dr.clip(level, 0, self.count - 1)
        lower = dr.minimum(mi.UInt32(level), max(self.count - 2, 0))
        upper = dr.minimum(lower + 1, self.count - 1)
        below, above = (self.interpolate_bilinearly(direction, whole) for whole in (lower, upper))
        return dr.lerp(below, above, level - mi.Float(lower))

    def interpolate_bilinearly(self, direction: JitVector, level: JitInt) -> JitColour:
        """Return the radiance in a `direction` at a whole `level`, between four texels."""
        import drjit as dr
        import mitsuba as mi

        place = self.places.at(level, mi.Vector2f)
        start, side = mi.UInt32(place.x), place.y
        s, t = to_disc(direction.x, direction.y, direction.z)
        start += dr.select(direction.z < 0, mi.UInt32(side * side), 0)
        x, y = ((c / levels.BORDER + 1) * (0.5 * side) - 0.5 for c in (s, t))
        x0, y0 = dr.floor(x), dr.floor(y)
        first, side = start + mi.UInt32(y0 * side + x0), mi.UInt32(side)
        corners = (first, first + 1, first + side, first + side + 1)
        a, b, c, d = (self.texels.at(corner, mi.Vector4f) for corner in corners)
        value = dr.lerp(dr.lerp(a, b, x - x0), dr.lerp(c, d, x - x0), y - y0)
        return mi.Color3f(value.x, value.y, value.z)


class Mips(FilteredMap):
    """A filtered map with mip levels, in which a texel is the mean of four of the level before.

    A lobe is looked up at the level that [Ergun 2015, eq. 8.9] gives.
    """

    def __init__(self, maps: list[FloatArray]) -> None:
        self.side = maps[0].shape[1]
        super().__init__(maps)

    @staticmethod
    def make_levels(
        finest: FloatArray, picture: FloatArray, sharpest: float = math.inf
    ) -> list[FloatArray]:
        """Return the levels (2, side, side, 3); they are made of the finest level alone."""
        return levels.make_mips(finest)

    def mean_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the approximate mean radiance over a lobe of concentration `kappa`."""
        return self.interpolate_trilinearly(axis, levels.mip_level(kappa, axis.z, self.side))


class LobeMaps(FilteredMap):
    """A filtered map whose levels, after the map itself, are convolved with ever wider lobes."""

    def __init__(self, maps: list[FloatArray]) -> None:
        self.sharpest = levels.sharpest_kappa(maps[0].shape[1])
        super().__init__(maps)

    @staticmethod
    def make_levels(
        finest: FloatArray, picture: FloatArray, sharpest: float = math.inf
    ) -> list[FloatArray]:
        """Return the levels (2, side, side, 3), for look-ups of lobes up to κ = `sharpest`."""
        return [finest, *levels.convolve_with_lobes(picture, finest.shape[1], sharpest)]

    def mean_over_lobe(self, axis: JitVector, kappa: JitFloat) -> JitColour:
        """Return the mean radiance over a von Mises-Fisher lobe of concentration `kappa`."""
        import drjit as dr

        # Find the level between whose lobes the given lobe lies. `variance` is its variance 1/κ,
        # relative to that of level 1. Level 0 is not blurred, so its variance is 0; from level 1
        # on, the variance grows by equal ratios
        variance = self.sharpest / kappa
        level = dr.select(variance < 1, variance, 1 + dr.log2(variance) / math.log2(levels.STEP))
        return self.interpolate_trilinearly(axis, level)


def make_finest_level(radiance: Radiance, side: int) -> FloatArray:
    """Return the finest level (hemispheres, side, side, 3): the radiance at its texels."""
    directions = levels.texel_directions(side)
    return radiance(directions.reshape(-1, 3)).reshape(directions.shape)


def make_latlong_picture(radiance: Radiance, height: int) -> FloatArray:
    """Return a picture (height, 2 height, 3) of the radiance by latitude and longitude, z up."""
    theta, phi = np.meshgrid(row_polar_angles(height), column_azimuths(2 * height), indexing="ij")
    return radiance(from_angles(theta, phi).reshape(-1, 3)).reshape(height, 2 * height, 3)
