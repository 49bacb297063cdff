"""`LightFiltering`: the filtering of a light, which a thread of its own may do.

Mitsuba evaluates the light at once; all that follows is NumPy alone, and takes seconds.
"""

from __future__ import annotations

import threading
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.lighting.filtering.filtered_map import (
    LobeMaps,
    Mips,
    Radiance,
    make_finest_level,
    make_latlong_picture,
)
from brdfkit.lighting.filtering.paraboloid_levels import resample_to_discs
from brdfkit.lighting.filtering.sphere_filter import convolve_on_sphere, halve_resolution

# texels along a side of the map of irradiance; few suffice, because it is smooth
IRRADIANCE_SIDE = 64


class LightFiltering:
    """A light as it is now, which is filtered when `levels` or `irradiances` are first needed.

    `radiance` is the function that `make_radiance_function` returns, `kind` the class that looks
    the light up, and `side` the size of its finest level [texels]. Lobes of a concentration above
    `sharpest` are not looked up. `begin` filters in a thread; who needs the result earlier waits
    for that thread.
    """

    def __init__(
        self, radiance: Radiance, kind: type[LobeMaps | Mips], side: int, sharpest: float
    ) -> None:
        self.kind, self.sharpest = kind, sharpest
        self.picture = make_latlong_picture(radiance, side)
        self.finest = make_finest_level(radiance, side)
        self.lock = threading.Lock()
        self.done = False

    def begin(self) -> None:
        """Filter in a thread of its own, which takes no turn in Dr.Jit."""
        threading.Thread(target=self.finish, daemon=True).start()

    def finish(self) -> tuple[list[FloatArray], FloatArray]:
        """Return the levels, each (2, side, side, 3), and the map of `filter_irradiance`."""
        with self.lock:
            found = self._filtered
            self.done = True
        return found

    @cached_property
    def _filtered(self) -> tuple[list[FloatArray], FloatArray]:
        levels = self.kind.make_levels(self.finest, self.picture, self.sharpest)
        return levels, filter_irradiance(self.picture)


def filter_irradiance(picture: FloatArray) -> FloatArray:
    """Return a map of the irradiance divided by π for all normals, from a map of the radiance.

    `picture` is (height, 2 height, channels) by latitude and longitude. The result is a pair of
    discs (2, IRRADIANCE_SIDE, IRRADIANCE_SIDE, channels) as in `paraboloid_levels.py`.
    """
    while len(picture) > 4 * IRRADIANCE_SIDE:
        picture = halve_resolution(picture)
    irradiance = convolve_on_sphere(picture, lambda cos: np.maximum(cos, 0) / np.pi, np.pi / 2)
    return resample_to_discs(irradiance, IRRADIANCE_SIDE)
