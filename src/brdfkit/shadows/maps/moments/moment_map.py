"""Shadow maps of moments: mean powers of depth, which may be blurred and interpolated as pictures.

Depths are clamped to [-1, 1]: 1 where the light sees nothing, -1 for surfaces before the map.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.mitsuba_bridge.properties.declarations import declare_float, declare_int
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.moments.moving_depths import MovingDepths

BLUR = declare_int(2, (0, 31), "texels on each side over which moments are averaged")
BLEEDING = declare_float(0.2, (0.0, 0.99), "share of the light below which a point counts as dark")


class MomentMap:
    """A shadow map that stores moments of depth, averaged over a square of texels.

    moments : function from the tensor of depths to the list of tensors whose means are the moments.
    depths : the depths that the light sees.
    blur : number of texels on each side of a texel over which its moments are averaged; between
        texels they are interpolated.
    bleeding : shares of light up to this one count as leaks, and become 0.
    """

    def __init__(
        self, moments: Callable[[Any], list[Any]], depths: MovingDepths, blur: int, bleeding: float
    ) -> None:
        import mitsuba as mi

        values = dr.stack(
            [depths.attach_edge_derivatives(m) for m in moments(depths.values)], axis=2
        )
        if blur:
            side = 2 * blur + 1
            values = dr.convolve(values, [1 / side] * side, axis=(0, 1), boundary="nearest")
        self.resolution, self.bleeding = values.shape[0], bleeding
        texture: Any = mi.Texture2f  # `Any`, as mypy takes it for an object that cannot be called
        self.texture = texture(values, False, False, wrap_mode=dr.WrapMode.Clamp)

    def interpolate_moments(self, point: MapPoint) -> list[JitFloat]:
        """Return the moments of the depths around a receiver."""
        import mitsuba as mi

        scale: JitFloat = dr.opaque(mi.Float, 1 / self.resolution)
        return self.texture.eval(mi.Point2f(point.u, point.v) * scale, point.active)

    def reduce_light_bleeding(self, point: MapPoint, bound: JitFloat) -> JitFloat:
        """Return an upper bound on a receiver's light, less the light that leaks; 1 beyond the map.

        A leak of up to ε = `bleeding` is removed by (bound - ε)₊ / (1 - ε).
        """
        size: JitFloat = dr.opaque(type(point.u), self.resolution)
        inside = (point.u >= 0) & (point.u <= size) & (point.v >= 0) & (point.v <= size)
        share = dr.clip((bound - self.bleeding) / (1 - self.bleeding), 0, 1)
        return dr.select(point.active & inside, share, 1)
