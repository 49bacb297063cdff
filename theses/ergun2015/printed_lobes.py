"""Defines lobes as the thesis prints them: a warped Gaussian, kernels in its place, and mixtures.

brdfkit fits a lobe to the BSDF itself, sharpens what kernels blur, and interpolates mixtures that
are fitted from neighbour to neighbour. Here the lobe has a closed form at every view: Ward's
Gaussian of half vectors is a spherical Gaussian of concentration 2 / α² about the normal n, which
is warped to light directions for a view o [Wang et al. 2009]:

    μ = 2 (o·n) n - o,  κ = 2 / (4 α² |o·n|)

Its height stays the same, and the other factors of the BSDF are those at μ. Kernels of equal weight
about points of this lobe have the width of [García-Portugués 2013], and are wider together than it.
Mixtures are fitted apart at stored views, of which a point takes the nearest. [Ergun 2015, sections
8.3, 8.6]
"""

import drjit as dr
import numpy as np

from brdfkit.lighting.filtering.lobe_light import LobeLight, ViewedLobes
from brdfkit.lighting.filtering.paraboloid_levels import COVERAGE
from brdfkit.lighting.spherical_gaussians import gmm
from brdfkit.lighting.spherical_gaussians.lobe_table import LARGEST_THETA_O, LobeTable
from brdfkit.lighting.spherical_gaussians.mixture import fit_mixture
from brdfkit.lighting.spherical_gaussians.one_view import sample_view
from brdfkit.mitsuba_bridge.arrays import Rows
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf

LOBES, VIEWS = 32, 24  # of mixtures: lobes as in the thesis, and as many views as brdfkit's
GOLDEN = np.pi * (np.sqrt(5) - 1)  # turn between successive kernels [rad]


class PrintedLobes(LobeLight):
    """Lights surfaces of Ward's BSDF by its warped lobe, or by kernels in its place.

    `kernels` is the number of kernels, or 1 for the lobe itself. `coverage` is the share of a lobe
    that a texel of its mip level covers, a in eq. 8.9, which the thesis does not tell.
    """

    def __init__(self, kernels, coverage=COVERAGE):
        super().__init__("printed", kernels)
        self.wider = compute_widening(coverage)

    def fit_lobes(self, bsdf):
        """Return the lobes of a BSDF of `make_ward_bsdf`, in place of those that are fitted."""
        import mitsuba as mi

        entries = mi.traverse(bsdf)
        names = "alpha_u", "diffuse_reflectance", "specular_reflectance"
        return ClosedLobes(
            *(float(entries[f"brdf_0.{name}.value"][0]) for name in names), self.count, self.wider
        )


class ClosedLobes:
    """The kernels of Ward's warped lobe, which are computed at each point."""

    def __init__(self, alpha, diffuse, specular, count, wider):
        import mitsuba as mi

        numbers = [mi.Float(number) for number in (alpha, diffuse, specular, wider)]
        dr.make_opaque(*numbers)  # so that another material needs no new kernel
        self.alpha, self.diffuse, self.specular, self.wider = numbers
        self.count = count
        m = np.arange(count)
        # Evenly spread by the lobe's probability: the thesis says only that they are well chosen
        self.points = Rows(np.stack([(m + 0.5) / count, *_turn(m * GOLDEN)], axis=1))

    def radiance(self, si, light, active):
        """Return the radiance that the points `si` reflect towards `si.wi`, on both sides."""
        import mitsuba as mi

        side, cos = dr.sign(si.wi.z), dr.maximum(dr.abs(si.wi.z), gmm.SMALLEST_COSINE)
        kappa, weight = warp_lobe(cos, self.alpha, self.specular)
        mirror = mi.Frame3f(mi.Vector3f(-si.wi.x, -si.wi.y, dr.abs(si.wi.z)))
        kernel = kappa if self.count == 1 else find_kernel_kappa(kappa, self.count)

        def add_kernel(k, total):
            point = self.points.at(k, mi.Vector3f)
            # 1 - cosine to the lobe's axis, below which is this share of its light
            height = -dr.log(point.x + (1 - point.x) * dr.exp(-2 * kappa)) / kappa
            sin = dr.safe_sqrt(height * (2 - height)) if self.count > 1 else mi.Float(0)
            height = height if self.count > 1 else mi.Float(0)
            axis = mirror.to_world(mi.Vector3f(sin * point.y, sin * point.z, 1 - height))
            axis = si.to_world(mi.Vector3f(axis.x, axis.y, axis.z * side))
            return k + 1, total + light.mean_radiance_over_lobe(axis, kernel * self.wider)

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0)), lambda k, total: active & (k < self.count), add_kernel
        )
        matte = self.diffuse * light.irradiance(si.to_world(mi.Vector3f(0, 0, side)))
        return dr.select(active, matte + total * weight / self.count, 0)


class PrintedMixtures(LobeLight):
    """Lights surfaces by mixtures that are fitted apart at views; a point takes the nearest one."""

    def __init__(self, coverage=COVERAGE):
        super().__init__("printed", LOBES)
        self.wider = compute_widening(coverage)

    def fit_lobes(self, bsdf):
        """Fit a mixture to each view of an isotropic BSDF, from intervals of an angle."""
        theta, lobes = np.linspace(0, LARGEST_THETA_O, VIEWS), []
        for angle in theta:
            one = sample_view(lambda wi, wo: eval_bsdf(bsdf, wo, wi), angle, 0.0)
            start = gmm.guess_mixture_by_intervals(*one.samples(), self.count)
            fitted, _ = fit_mixture(*one.samples(), start)
            weights = gmm.fit_channel_weights(fitted, one)
            lobes.append((one.diffuse, weights, fitted.axes, fitted.kappa * self.wider))
        columns = (np.array(column) for column in zip(*lobes, strict=True))
        return NearestLobes(LobeTable(theta, np.zeros(1), *columns))


class NearestLobes(ViewedLobes):
    """Lobes of stored views, of which a point takes those of the nearest view."""

    def find_surrounding_views(self, wo):
        """Return the nearest stored view, and the sine and cosine of the azimuth of `wo`."""
        ((low, share), (high, _)), sin, cos = super().find_surrounding_views(wo)
        return [(dr.select(share > 0.5, low, high), 1.0)], sin, cos


def compute_widening(coverage):
    """Return the factor of concentrations by which levels, made for COVERAGE, have another one.

    A level's texels have the solid angle -2π log(1 - a) / κ.
    """
    return np.log(1 - COVERAGE) / np.log(1 - coverage)


def warp_lobe(cos, alpha, specular):
    """Return the concentration and the integral of Ward's lobe as it is warped.

    `cos` is the cosine of the view, and BRDF × cosine at μ has the height k_s / (4π α²).
    """
    kappa = 1 / (2 * alpha**2 * cos)
    height = specular / (4 * np.pi * alpha**2)
    return kappa, height * 2 * np.pi / kappa * (1 - dr.exp(-2 * kappa))


def find_kernel_kappa(kappa, count):
    """Return the concentration of each of `count` kernels in place of a lobe, 1 / h²."""
    # Numerator and denominator are multiplied by e^(-2κ), to avoid overflow
    once, twice = dr.exp(-2 * kappa), dr.exp(-4 * kappa)
    sinh_squared = dr.square((1 - once) / 2)
    spread = (1 + 4 * kappa**2) * (1 - twice) / 2 - kappa * (1 + twice)
    return dr.power(kappa * count * spread / (8 * sinh_squared), 1 / 3)


def _turn(angle):
    """Return the cosine and the sine of an angle."""
    return np.cos(angle), np.sin(angle)
