"""Maps of moments: means of powers of depth, which may be blurred and interpolated as pictures are.

Depths are taken in [-1, 1]: where the light sees nothing, 1; what is before the map, -1.
"""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import count, plain_number

BLUR = count(2, (0, 31), "texels on each side over which moments are averaged")
BLEEDING = plain_number(0.2, (0.0, 0.99), "share of the light below which a point counts as dark")


class MomentMap:
    """The means of moments over a square about any place of a map.

    moments : of depths, a tensor; a function that gives a list of tensors.
    depths : `MovingDepths`.
    blur : texels on each side of a texel over which its moments are averaged; places between
        texels are interpolated.
    """

    def __init__(self, moments, depths, blur):
        import mitsuba as mi

        values = dr.stack([depths.averaged(m) for m in moments(depths.values)], axis=2)
        if blur:
            side = 2 * blur + 1
            values = dr.convolve(values, [1 / side] * side, axis=(0, 1), boundary="nearest")
        self.resolution = values.shape[0]
        self.texture = mi.Texture2f(values, False, False, wrap_mode=dr.WrapMode.Clamp)

    def at(self, point):
        """The list of means about a `MapPoint`."""
        import mitsuba as mi

        scale = dr.opaque(mi.Float, 1 / self.resolution)
        return self.texture.eval(mi.Point2f(point.u, point.v) * scale, point.active)

    def within(self, point):
        """Whether the map shows a `MapPoint`; beyond its edge all is lit."""
        size = dr.opaque(type(point.u), self.resolution)
        inside = (point.u >= 0) & (point.u <= size) & (point.v >= 0) & (point.v <= size)
        return point.active & inside


def without_bleeding(lit, bleeding):
    """The share of light, of which up to `bleeding` is taken for a leak: (lit - ε)₊ / (1 - ε)."""
    return dr.clip((lit - bleeding) / (1 - bleeding), 0, 1)
