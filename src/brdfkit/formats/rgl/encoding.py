"""Encodes any BRDF in the adaptive parameterisation: what `save` writes as `.bsdf`.

[Dupuy & Jakob 2018]. What is tabulated is a function f(wi, wo) of directions (n, 3);
the mean of its channels shapes the grid.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.formats.rgl.normals import Hemisphere, power_iteration
from brdfkit.formats.rgl.parameterisation import (
    Adaptive,
    Parameterisation,
    from_square,
    solid_angle,
)
from brdfkit.formats.rgl.warp import even_grid, interpolated
from brdfkit.geometry.directions import from_angles, from_half_difference

GRAZING = np.radians(89.5)  # the last incidence: at 90° nothing is seen
# Share of normals in all directions alike, so that M is finite where nothing comes back
EVEN_SHARE = 0.01
INNERMOST = 0.003  # dm/dx dy [sr] at 0.2° from the surface's normal
# Added to wi·m: towards wi·m = 0 the nodes of visible normals thin out, where a BRDF is steepest
LEAST_SEEN = 0.2
SUNKEN = 0.2  # depth cosθ_o below the surface at which few nodes are left


@dataclass(frozen=True)
class Resolution:
    """Numbers of nodes: of incidences, `phi_i` in a quarter of the circle and `theta_i`; of
    normals, `phi_m` in all of it and `theta_m`; and along an edge of the `grid`."""

    phi_i: int
    theta_i: int
    phi_m: int
    theta_m: int
    grid: int


# Files of 16 and 45 MB. What fewer nodes miss is the noise between the cells of a measured table
ISOTROPIC = Resolution(phi_i=0, theta_i=64, phi_m=1, theta_m=256, grid=112)
ANISOTROPIC = Resolution(phi_i=12, theta_i=20, phi_m=64, theta_m=128, grid=48)


def adapted(f):
    """f as an `Adaptive`.

    Raises `BrdfkitError` where f is not finite.
    """
    quarters = symmetry(f)
    over = parameterisation(f, quarters, ANISOTROPIC if quarters else ISOTROPIC)
    n = over.vndf.shape[-1]
    wi, wo, m, facets = over.grid(n)
    above = wo[..., 2] > 0
    f_cos = _evaluated(f, wi[above], wo[above]) * wo[above][:, 2:]
    M = np.zeros((*above.shape, f_cos.shape[1]))
    M[above] = f_cos / facets[above][:, None]

    # What the warp does not do towards f cosθ_o is left to the density over u
    m = m.reshape(-1, 2)
    D = interpolated(over.ndf[None], m)
    cosines = np.linalg.norm(wi + wo, axis=-1) / 2
    excess = (1 + _spread(m) / D).reshape(above.shape) * (1 + LEAST_SEEN / cosines)
    density = np.maximum(M.mean(axis=-1), 0) / excess
    density[~density.any(axis=(2, 3))] = 1  # black
    return Adaptive(over, M, density)


def parameterisation(f, quarters, size):
    """The `Parameterisation` of f, whose azimuths repeat after so many `quarters` (0: isotropic)
    of the circle."""
    phi_i = np.linspace(0, quarters * np.pi / 2, quarters * size.phi_i + 1)
    if quarters:
        phi_i -= np.pi
    theta_i = GRAZING * (1 - np.linspace(1, 0, size.theta_i) ** 1.5)  # closer towards grazing
    ndf, sigma = _microfacets(f, size)
    m = even_grid(size.grid)
    density = (interpolated(ndf[None], m) + _spread(m)) * solid_angle(m)
    wi, normals = from_angles(theta_i, phi_i[:, None]), from_angles(*from_square(m))
    cosines = wi @ normals.T
    height = 2 * cosines * normals[:, 2] - wi[..., 2:]  # cosθ_o
    seen = np.where(cosines > 0, cosines + LEAST_SEEN, 0) * np.clip(1 + height / SUNKEN, 0.02, 1)
    vndf = (seen * density).reshape(*cosines.shape[:2], size.grid, size.grid)
    return Parameterisation(phi_i, theta_i, ndf, sigma, vndf)


def symmetry(f):
    """After how many quarters of the circle the azimuths of f repeat: 0 where they do not count,
    1 with two planes of symmetry, x = 0 and y = 0, 2 with a half turn, else 4."""
    theta_h, theta_d, phi_d, phi_h = np.random.default_rng(0).random((4, 1000))
    # Many half vectors near the normal, where narrow lobes are, but none whose azimuth is lost
    theta_h = np.pi / 2 * (0.01 + 0.99 * theta_h) ** 3
    pairs = from_half_difference(theta_h, np.pi / 2 * theta_d, 2 * np.pi * phi_d, 2 * np.pi * phi_h)
    wi, wo = (w[(pairs[0][:, 2] > 0) & (pairs[1][:, 2] > 0)] for w in pairs)
    values = _evaluated(f, wi, wo)

    def same(matrix):
        turned = _evaluated(f, wi @ matrix, wo @ matrix)
        # nearly all: where scattered samples are as near as others, rounding chooses between them
        return np.isclose(turned, values, rtol=1e-4).all(axis=1).mean() > 0.9

    if same(np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])):
        return 0
    if same(np.diag([1.0, -1, 1])) and same(np.diag([-1.0, 1, 1])):
        return 1
    return 2 if same(np.diag([-1.0, -1, 1])) else 4


def _microfacets(f, size):
    """D and σ over the square of directions."""
    theta = np.linspace(0, 1, size.theta_m) ** 2 * np.pi / 2
    hemisphere = Hemisphere(theta, size.phi_m)
    w = Hemisphere(np.minimum(theta, GRAZING), size.phi_m).directions.reshape(-1, 3)
    retro = np.maximum(_evaluated(f, w, w).mean(axis=1).reshape(size.phi_m, -1), 0)
    even = np.full_like(retro, 1 / np.pi)
    D = power_iteration(retro, hemisphere) if retro.any() else even
    D = (1 - EVEN_SHARE) * D + EVEN_SHARE * even
    return [np.concatenate([x, x[:1]]) for x in (D, hemisphere.projected(D))]


def _spread(m):
    """A density [sr⁻¹] that is even over the square of directions, but for the innermost part.

    Beside the normals' it leaves half of the grid to the slopes of a highlight, where D is small
    and M changes most, and narrow cells to a peak that comes back from no other direction.
    """
    return 1 / (solid_angle(m) + INNERMOST)


def _evaluated(f, wi, wo):
    values = f(wi, wo)
    if not np.isfinite(values).all():
        row = np.argmin(np.isfinite(values).all(axis=1))
        theta_i, theta_o = np.degrees(np.arccos([wi[row, 2], wo[row, 2]]))
        raise BrdfkitError(
            f"its BRDF is not finite at theta_i {theta_i:.1f}°, theta_o {theta_o:.1f}°; mend it."
        )
    return values
