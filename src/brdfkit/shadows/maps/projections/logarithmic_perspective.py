"""A perspective across the map, then a logarithm along it: all depths are equally fine (LogPSM).

    v = 2 ln(y / n) / ln(y_f / n) - 1

y, from n to y_f, is the distance from the apex of the perspective. At right angles to the light the
apex is the eye, and a texel has the same size in the picture, across and along, wherever it is. At
the angle γ, n is z_n / sin γ here, times `apex`, with the nearest visible depth z_n. No matrix does
that, so no hardware that draws triangles, but rays do [Lloyd et al. 2008]. It is the focused map
where the eye looks along the light or is not before it.

Best for far views over a ground. Planes are bent on its map, by little within a texel.
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
    """Make the projection, or the focused one without a line of sight."""
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    near, far = sight.ends
    n = apex * placement.depths[0] / sight.sine * sight.scale
    warped = sight.warp(n)
    # A ratio of 1 has no logarithmic map, but the map of this ratio is nearly linear
    ratio = max(1 + (far - near) / n, 1 + 1e-4)
    return Logarithmic(warped.matrix, warped.inverse, warped.light, ratio=ratio)


@dataclass(frozen=True)
class Logarithmic(Projection):
    """A perspective by a matrix, and a logarithm along the second axis of its cube.

    ratio : y_f / n > 1, the ratio of the distances of the cube's two ends from the apex.
    """

    ratio: Any = np.e

    def opaque(self) -> "Logarithmic":
        """Return the projection with opaque Dr.Jit numbers, so that one kernel serves all."""
        import mitsuba as mi

        opaque: Any = super().opaque()
        logarithmic: Logarithmic = replace(opaque, ratio=dr.opaque(mi.Float, self.ratio))
        return logarithmic

    def to_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return where a point of the world is in the map's cube."""
        u, v, depth = super().to_map(x, y, z)
        log = array_module(v).log
        return u, -2 * log(self.nearness(v)) / log(self.ratio) - 1, depth

    def derivative_along(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        """Return the derivative of `to_map` at a `point` along a vector `way`."""
        v = super().to_map(*point)[1]
        u_way, v_way, depth_way = super().derivative_along(point, way)
        slope = (1 - 1 / self.ratio) / (self.nearness(v) * array_module(v).log(self.ratio))
        return u_way, v_way * slope, depth_way

    def ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        """Return the ray of light at a place of the map: its origin and its unit direction."""
        return super().ray(x, self.undo_logarithm(y))

    def from_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the point of the world at a place in the map's cube."""
        if self.depth:  # then the base class calls `ray`, which undoes the logarithm
            return super().from_map(x, y, z)
        return super().from_map(x, self.undo_logarithm(y), z)

    def nearness(self, v: JitFloat) -> JitFloat:
        """Return n / y, which is linear in the v of the perspective."""
        return 1 - (v + 1) / 2 * (1 - 1 / self.ratio)

    def undo_logarithm(self, v: JitFloat) -> JitFloat:
        """Return the v of the perspective for the v of the map."""
        exp, log = array_module(v).exp, array_module(v).log
        return 2 * (1 - exp(-(v + 1) / 2 * log(self.ratio))) / (1 - 1 / self.ratio) - 1


def array_module(value: JitFloat) -> Any:
    """Return the module with functions for a value: Dr.Jit's or NumPy's."""
    return dr if dr.is_jit_v(value) else np
