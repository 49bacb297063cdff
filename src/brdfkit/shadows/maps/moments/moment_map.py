"""Shadow maps of moments, mean powers of depth, which can be blurred and interpolated as pictures.

Depths are clamped to [-1, 1]: 1 where the light sees no surface, -1 where the surface is nearer to
the light than the map's near plane.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float, declare_int
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.moments.moving_depths import MovingDepths

BLUR = declare_int(2, (0, 31), "texels on each side over which moments are averaged")
BLEEDING = declare_float(0.2, (0.0, 0.99), "share of the light below which a point counts as dark")


class MomentMap:
    """A shadow map that stores moments of depth, averaged over a square of texels.

    moments : function from the tensor of depths to a list of tensors, powers of the depths; their
        means over the square are the moments.
    depths : the depths that the light sees.
    blur : number of texels on each side of a texel over which its moments are averaged.
    bleeding : largest share of light that counts as a leak, and becomes 0.
    """

    def __init__(
        self, moments: Callable[[Any], list[Any]], depths: MovingDepths, blur: int, bleeding: float
    ) -> None:
        values = dr.stack(moments(dr.detach(depths.values)), axis=2)
        if blur:
            side = 2 * blur + 1
            values = dr.convolve(values, [1 / side] * side, axis=(0, 1), boundary="nearest")
        self.resolution, self.bleeding = values.shape[0], bleeding
        self.means = make_texture(values)
        moving = depths.average_with_derivatives(moments, blur)
        self.moving_means = None if moving is None else make_texture(moving)

    def bound_light(self, point: MapPoint, bound: Callable[[list[Any]], JitFloat]) -> JitFloat:
        """Return the largest share of the light at a receiver, less the light that leaks.

        If shapes move, its derivatives are those by means that know how silhouettes move.

        bound : function from the moments around the receiver to the largest share of the light.
        """
        import mitsuba as mi

        scale: JitFloat = dr.opaque(mi.Float, 1 / self.resolution)
        place = mi.Point2f(point.u, point.v) * scale

        def look_up(means: MitsubaObject) -> JitFloat:
            return self._reduce_light_bleeding(point, bound(means.eval(place, point.active)))

        share = look_up(self.means)
        if self.moving_means is None:
            return share
        return dr.replace_grad(share, look_up(self.moving_means))

    def _reduce_light_bleeding(self, point: MapPoint, bound: JitFloat) -> JitFloat:
        """Return an upper `bound` on a receiver's light, less the light that leaks; 1 off the map.

        Bounds up to the setting `bleeding` become 0, and larger ones are stretched to end at 1.
        """
        size: JitFloat = dr.opaque(type(point.u), self.resolution)
        inside = (point.u >= 0) & (point.u <= size) & (point.v >= 0) & (point.v <= size)
        share = dr.clip((bound - self.bleeding) / (1 - self.bleeding), 0, 1)
        return dr.select(point.active & inside, share, 1)


def make_texture(values: MitsubaObject) -> MitsubaObject:
    """Return a `mi.Texture2f` of a tensor (rows, columns, channels), continued beyond its edge."""
    import mitsuba as mi

    texture: Any = mi.Texture2f  # `Any`, because mypy thinks that it cannot be called
    return texture(values, False, False, wrap_mode=dr.WrapMode.Clamp)
