"""Filtered importance sampling: a few directions of a BSDF, the same everywhere, and the mean
light about each.

[Colbert & Křivánek 2007]
"""

import numpy as np

from brdfkit.host.arrays import Rows


class FilteredSampling:
    """Takes `count` directions of the BSDF at every point that is seen."""

    def __init__(self, count):
        self.count = count
        self.points = Rows(spread(count))

    def radiance(self, si, bsdf, light, spectrum, active):
        """The radiance towards `si.wi`; `spectrum`: of a colour (rgb, si)."""
        import drjit as dr
        import mitsuba as mi

        # The diffuse part as a constant, in full daylight and without directions
        context = mi.BSDFContext()
        context.type_mask = mi.BSDFFlags.DiffuseReflection
        up = mi.Vector3f(0, 0, 1)
        constant = mi.unpolarized_spectrum(bsdf.eval(context, si, up, active))
        received = spectrum(light.irradiance(si.to_world(up)), si)

        def one(i, total):
            point = self.points.at(i, mi.Point3f)
            drawn, weight = bsdf.sample(
                mi.BSDFContext(), si, point.x, mi.Point2f(point.y, point.z), active
            )
            wo = si.to_world(drawn.wo)
            # A lobe as wide as the distance to the next direction; a mirror has no width
            delta = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
            kappa = dr.select(delta, dr.inf, 2 * dr.pi * self.count * drawn.pdf)
            rest = constant * dr.maximum(drawn.wo.z, 0) / dr.select(delta, dr.inf, drawn.pdf)
            weight = mi.unpolarized_spectrum(weight) - rest
            valid = active & (drawn.pdf > 0)
            seen = spectrum(light.over_lobe(wo, kappa), si)
            return i + 1, total + dr.select(valid, weight * seen, 0)

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.UnpolarizedSpectrum(0)),
            lambda i, total: active & (i < self.count),
            one,
        )
        return dr.maximum(dr.pi * constant * received + total / self.count, 0)


def spread(count):
    """`count` points (count, 3) of the unit cube, evenly spread, the same always.

    Two coordinates advance by the powers of the plastic number, the solution of x³ = x + 1
    [Roberts 2018].

    >>> spread(2).shape
    (2, 3)
    """
    i = np.arange(count) + 0.5
    plastic = 1.32471795724474602596
    return np.stack([i / plastic**2, i / count, i / plastic], axis=1) % 1
