"""A perspective across the map, then a logarithm along it: all depths are equally fine (LogPSM).

    v = 2 ln(y / n) / ln(y_f / n) - 1

y, from n to y_f, is the distance from the apex of the perspective. At right angles to the light the
apex is the eye, and a texel has the same size in the picture, across and along, wherever it is. At
the angle γ between view and light, n is z_n / sin γ here, times `apex`, with the nearest visible
depth z_n. No matrix can do this, and so no hardware that draws triangles, but rays can [Lloyd et
al. 2008]. The projection is the focused one where the eye looks along the light or is behind it.

It is best for far views over a ground. Planes are bent on its map, though little within a texel.
"""

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.shadows.maps.line_of_sight import APEX, find_line_of_sight
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused

SETTINGS = {"apex": APEX}


def make_projection(placement: Placement, apex: float) -> Projection:
    """Make the logarithmic perspective projection; the focused one without a line of sight."""
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    near, far = sight.y_range
    n = apex * placement.depths[0] / sight.sine_to_light * sight.map_scale
    warped = sight.make_warped_projection(n)
    # A ratio of 1 has no logarithmic map, but the map of this ratio is nearly linear
    ratio = max(1 + (far - near) / n, 1 + 1e-4)
    return Logarithmic(warped.matrix, warped.inverse, warped.light, ratio=ratio)


@dataclass(frozen=True)
class Logarithmic(Projection):
    """A perspective by a matrix, followed by a logarithm along the second axis of the map.

    ratio : the ratio of the distances of the map's far and near end from the apex, > 1.
    """

    ratio: Any = np.e

    def make_opaque(self) -> "Logarithmic":
        import mitsuba as mi

        opaque: Any = super().make_opaque()
        logarithmic: Logarithmic = replace(opaque, ratio=dr.opaque(mi.Float, self.ratio))
        return logarithmic

    def project(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        u, v, depth = super().project(x, y, z)
        log = find_array_module(v).log
        return u, -2 * log(self.nearness(v)) / log(self.ratio) - 1, depth

    def directional_derivative(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        v = super().project(*point)[1]
        u_way, v_way, depth_way = super().directional_derivative(point, way)
        slope = (1 - 1 / self.ratio) / (self.nearness(v) * find_array_module(v).log(self.ratio))
        return u_way, v_way * slope, depth_way

    def light_ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        return super().light_ray(x, self.undo_logarithm(y))

    def unproject(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        if self.depth:  # then the base class calls `light_ray`, which undoes the logarithm
            return super().unproject(x, y, z)
        return super().unproject(x, self.undo_logarithm(y), z)

    def nearness(self, v: JitFloat) -> JitFloat:
        """Return n / y, the ratio of the distances of the near end and of a point from the apex.

        v : second map coordinate of the point before the logarithm, in which the ratio is linear.
        """
        return 1 - (v + 1) / 2 * (1 - 1 / self.ratio)

    def undo_logarithm(self, v: JitFloat) -> JitFloat:
        """Return the second map coordinate before the logarithm, for the one after it, v."""
        exp, log = find_array_module(v).exp, find_array_module(v).log
        return 2 * (1 - exp(-(v + 1) / 2 * log(self.ratio))) / (1 - 1 / self.ratio) - 1


def find_array_module(value: JitFloat) -> Any:
    """Return the module whose `exp` and `log` fit a value: Dr.Jit or NumPy."""
    return dr if dr.is_jit_v(value) else np
