"""Defines lobes as the thesis prints them: a warped Gaussian of half vectors, and its kernels.

brdfkit fits a lobe to the BSDF itself, and sharpens what kernels blur. Here the lobe has a closed
form: Ward's Gaussian of half vectors is a spherical Gaussian of concentration 2 / α² about the
normal n, which is warped to light directions for a view o [Wang et al. 2009]:

    μ = 2 (o·n) n - o,  κ = 2 / (4 α² |o·n|)

Its height stays the same, and the other factors of the BSDF are those at μ. Kernels of equal weight
about points of this lobe have the width of [García-Portugués 2013], and are wider together than it.
[Ergun 2015, section 8.6]
"""

import numpy as np

from brdfkit.core.geometry.directions import from_angles
from brdfkit.lighting.filtering.lobe_light import LobeLight, ViewedLobes
from brdfkit.lighting.filtering.paraboloid_levels import COVERAGE
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf
from brdfkit.lighting.spherical_gaussians.lobe_table import LARGEST_THETA_O, LobeTable
from brdfkit.lighting.spherical_gaussians.single_lobe import kernel_bandwidth

VIEWS = 512  # stored polar angles, so many that interpolation between them adds no error


class PrintedLobes(LobeLight):
    """Lights surfaces of Ward's BSDF by its warped lobe, or by kernels in its place.

    `kernels` is the number of kernels, or 1 for the lobe itself. `coverage` is the share of a lobe
    that a texel of its mip level covers, a in eq. 8.9, which the thesis does not tell.
    """

    def __init__(self, kernels, coverage=COVERAGE):
        super().__init__("printed", kernels)
        # Levels are looked up with COVERAGE, by the solid angle log(1 - a) / κ
        self.wider = np.log(1 - COVERAGE) / np.log(1 - coverage)

    def fit_lobes(self, bsdf):
        """Return the lobes of a BSDF of `make_ward_bsdf`, in place of those that are fitted."""
        import mitsuba as mi

        entries = mi.traverse(bsdf)
        names = "alpha_u", "diffuse_reflectance", "specular_reflectance"
        alpha, diffuse, specular = (float(entries[f"brdf_0.{name}.value"][0]) for name in names)
        axes, kappa, weights = warp_lobe(np.linspace(0, LARGEST_THETA_O, VIEWS), alpha, specular)
        if self.count > 1:
            axes, kappa = split_as_printed(axes, kappa, self.count)
        else:
            axes, kappa = axes[:, None], kappa[:, None]
        shares = np.broadcast_to((weights / self.count)[:, None, None], (*kappa.shape, 1))
        return ViewedLobes(
            LobeTable(
                np.linspace(0, LARGEST_THETA_O, VIEWS),
                np.zeros(1),
                np.full((VIEWS, 1), diffuse),
                shares,
                axes,
                kappa * self.wider,
            )
        )


def warp_lobe(theta, alpha, specular):
    """Return axes (n, 3), concentrations (n,) and integrals (n,) of Ward's lobe as it is warped.

    They are for views at the polar angles `theta` (n,), for the roughness `alpha` and the weight
    k_s `specular`. At μ, BRDF × cosine has the height k_s / (4π α²).
    """
    axes = from_angles(theta, np.pi)
    kappa = 1 / (2 * alpha**2 * np.cos(theta))
    height = specular / (4 * np.pi * alpha**2)
    return axes, kappa, height * 2 * np.pi / kappa * -np.expm1(-2 * kappa)


def split_as_printed(axes, kappa, count):
    """Return the axes (n, count, 3) and concentrations (n, count) of kernels in place of lobes.

    Kernels lie at evenly spread points of each lobe: the thesis says only that they are carefully
    chosen.
    """
    kernels = kernel_bandwidth(kappa, count) ** -2
    spread = vmf.spread_lobe_points(axes, kappa, count)
    return spread, np.repeat(kernels[:, None], count, axis=1)
