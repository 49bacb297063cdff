"""A perspective across the map, then a logarithm along it: all depths are equally fine (LogPSM).

    v = 2 ln(y / n) / ln(y_f / n) - 1

with y, from n to y_f, the distance from the apex of the perspective. At right angles to the light
the apex is the eye, and a texel has the same size in the picture, across and along, wherever it
is; at the angle γ, n is z_n / sin γ here, times `apex`. No matrix does that, so no hardware that
draws triangles, but rays do [Lloyd et al. 2008]. The focused map where the eye looks along the
light or is not before it.

Best for far views over a ground. Planes are bent on its map, by little within a texel.
"""

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.maps.sight import APEX, line_of_sight

SETTINGS = {"apex": APEX}


def projection(placement, apex):
    sight = line_of_sight(placement)
    if sight is None:
        return focused.projection(placement)
    near, far = sight.ends
    n = apex * placement.depths[0] / sight.sine * sight.scale
    warped = sight.warped(n)
    # the logarithm of a ratio of 1 is no map, but nearly the same as none
    ratio = max(1 + (far - near) / n, 1 + 1e-4)
    return Logarithmic(warped.matrix, warped.inverse, warped.light, ratio=ratio)


@dataclass(frozen=True)
class Logarithmic(Projection):
    """A perspective by a matrix, and a logarithm along the second axis of its cube.

    ratio : y_f / n, > 1, of the distances of the cube's two ends from the apex.
    """

    ratio: Any = np.e

    def opaque(self):
        import mitsuba as mi

        return replace(super().opaque(), ratio=dr.opaque(mi.Float, self.ratio))

    def to_map(self, x, y, z):
        """Where a point of the world is in the cube."""
        u, v, depth = super().to_map(x, y, z)
        log = numbers(v).log
        return u, -2 * log(self.nearness(v)) / log(self.ratio) - 1, depth

    def along(self, point, way):
        """The derivative of `to_map` at a `point` along a `way`, both of three components."""
        v = super().to_map(*point)[1]
        u_way, v_way, depth_way = super().along(point, way)
        slope = (1 - 1 / self.ratio) / (self.nearness(v) * numbers(v).log(self.ratio))
        return u_way, v_way * slope, depth_way

    def ray(self, x, y):
        """The ray of light at a place of the map: its origin and its unit direction."""
        return super().ray(x, self.unbent(y))

    def from_map(self, x, y, z):
        """The point of the world at a place in the cube."""
        if self.depth:  # then the way is by `ray`, which unbends
            return super().from_map(x, y, z)
        return super().from_map(x, self.unbent(y), z)

    def nearness(self, v):
        """n / y, linear in the v of the perspective."""
        return 1 - (v + 1) / 2 * (1 - 1 / self.ratio)

    def unbent(self, v):
        """The v of the perspective."""
        exp, log = numbers(v).exp, numbers(v).log
        return 2 * (1 - exp(-(v + 1) / 2 * log(self.ratio))) / (1 - 1 / self.ratio) - 1


def numbers(value):
    """The functions for it: Dr.Jit's or NumPy's."""
    return dr if dr.is_jit_v(value) else np
