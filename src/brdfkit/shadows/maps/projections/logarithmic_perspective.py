"""Logarithmic perspective shadow maps (LogPSM): texels equally large in the picture at all depths.

A perspective warps the light's map along the line of sight, as in `line_of_sight.py`. Then a
logarithm replaces the coordinate along this line:

    v = 2 ln(y / n) / ln(y_f / n) - 1

y is the distance from the apex of the perspective, from n at the near end to y_f at the far end of
the map. If view and light are at right angles, the apex is the eye, and a texel has the same size
in the picture wherever it is. In general n = z_n / sin γ, times the setting `apex`; γ is the angle
between view and light, and z_n the nearest visible depth. The projection is the focused one where
the eye looks along the light or is behind it.

A logarithm needs rays, as here: hardware that draws triangles can only apply a matrix [Lloyd et al.
2008]. The projection is best for far views over a ground. Planes are bent on its map, though little
within a texel.
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
    """Make the logarithmic perspective projection; the focused one without a line of sight.

    apex : factor of the distance of the perspective's apex; below 1, it favours what is near.
    """
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    near, far = sight.y_range
    n = apex * placement.visible_depths[0] / sight.sine_to_light * sight.map_scale
    warped = sight.make_warped_projection(n)
    # At a ratio of 1, the formula is 0/0; at this slightly larger ratio, the map is nearly linear
    ratio = max(1 + (far - near) / n, 1 + 1e-4)
    return Logarithmic(warped.matrix, warped.inverse, warped.light, ratio=ratio)


@dataclass(frozen=True)
class Logarithmic(Projection):
    """A perspective by a matrix, followed by a logarithm along the second axis of the map.

    ratio : distance of the map's far end from the perspective's apex, divided by that of its near
        end; above 1.
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
        if self.depth:  # a `LightDepth`, for which `light_ray` undoes the logarithm
            return super().unproject(x, y, z)
        return super().unproject(x, self.undo_logarithm(y), z)

    def nearness(self, v: JitFloat) -> JitFloat:
        """Return the near end's distance from the perspective's apex, divided by a point's.

        v : second map coordinate of the point after the perspective, before the logarithm; the
            result is linear in it.
        """
        return 1 - (v + 1) / 2 * (1 - 1 / self.ratio)

    def undo_logarithm(self, v: JitFloat) -> JitFloat:
        """Return the second map coordinate before the logarithm, given `v` after it."""
        exp, log = find_array_module(v).exp, find_array_module(v).log
        return 2 * (1 - exp(-(v + 1) / 2 * log(self.ratio))) / (1 - 1 / self.ratio) - 1


def find_array_module(value: JitFloat) -> Any:
    """Return the module whose `exp` and `log` fit a value: Dr.Jit or NumPy."""
    return dr if dr.is_jit_v(value) else np
