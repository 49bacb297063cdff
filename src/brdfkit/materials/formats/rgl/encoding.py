"""Tabulates any BRDF in the adaptive parameterisation of [Dupuy & Jakob 2018], for `.bsdf` files.

A BRDF is here a function f(wi, wo) of directions (n, 3) that returns values (n, channels). The mean
of its channels determines the parameterisation, which `parameterisation.py` explains.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.materials.formats.rgl.adaptive_table import AdaptiveTable
from brdfkit.materials.formats.rgl.normals import Hemisphere, find_normal_distribution
from brdfkit.materials.formats.rgl.parameterisation import (
    Parameterisation,
    map_from_square,
    solid_angle_per_area,
)
from brdfkit.materials.formats.rgl.warp import interpolate, make_even_grid
from brdfkit.materials.measured.measured_data import Lookup

# Largest angle of incidence in a table [rad]: at 90° the surface is seen edge-on
GRAZING = np.radians(89.5)
# Share of a uniform distribution in the distribution of normals, so that stored values are not
# divided by 0 where the BRDF has no retro-reflection
EVEN_SHARE = 0.01
# Added to the solid angle per area of the square of directions [sr], a divisor that is 0 at the
# normal; it has this value at 0.2° from the normal
INNERMOST = 0.003
# Added to the cosine between light and facet's normal, to which the density of a table's nodes is
# proportional: otherwise few nodes would lie near the cosine 0, where a BRDF is steepest
GRAZING_DENSITY = 0.2
# Nodes that reflect light below the surface are the rarer, the deeper the reflected direction. They
# are rarest where its cosine to the normal is minus this number, or less
LARGEST_DEPTH = 0.2


@dataclass(frozen=True)
class Resolution:
    """The numbers of nodes of a table in the adaptive parameterisation.

    `phi_i`: azimuths of incidence in a quarter of the circle; `theta_i`: polar angles of incidence;
    `phi_m`, `theta_m`: azimuths, in the full circle, and polar angles of the distribution of
    normals; `grid`: points along an edge of the grid of stored values.
    """

    phi_i: int
    theta_i: int
    phi_m: int
    theta_m: int
    grid: int


# Resolutions of written files, which then have 16 and 45 MB. Fewer nodes would smooth out the noise
# of a measured table
ISOTROPIC = Resolution(phi_i=0, theta_i=64, phi_m=1, theta_m=256, grid=112)
ANISOTROPIC = Resolution(phi_i=12, theta_i=20, phi_m=64, theta_m=128, grid=48)


def encode_brdf(
    f: Lookup, sizes: tuple[Resolution, Resolution] | None = None, *, whole_circle: bool = False
) -> AdaptiveTable:
    """Tabulate the BRDF f in the adaptive parameterisation, densely where f is large.

    `sizes` are the numbers of nodes if f is isotropic, and if not; by default those of written
    files. `whole_circle` says whether a table that is not isotropic has azimuths in the whole
    circle even where f is symmetric. Raises `BrdfkitError` where f is not finite.
    """
    # Choose the directions at which f is tabulated
    quarters = detect_symmetry(f)
    size = (sizes or (ISOTROPIC, ANISOTROPIC))[quarters > 0]
    grid = build_parameterisation(f, 4 if whole_circle and quarters else quarters, size)
    n = grid.vndf.shape[-1]
    wi, wo, m, factor = grid.reflect_light_on_grid(n)
    # Compute the values M that the file stores for these directions
    above = wo[..., 2] > 0
    f_cos = _evaluate_finite(f, wi[above], wo[above]) * wo[above][:, 2:]
    M = np.zeros((*above.shape, f_cos.shape[1]))
    M[above] = f_cos / factor[above][:, None]

    # Compute the density over points u from which Mitsuba draws directions: the stored values M,
    # divided by the two factors by which the warp from u to normals m draws them more densely than
    # visible normals are, D wi·m
    m = m.reshape(-1, 2)
    D = interpolate(grid.ndf[None], m)
    cosines = np.linalg.norm(wi + wo, axis=-1) / 2
    excess = (1 + _compute_even_density(m) / D).reshape(above.shape) * (
        1 + GRAZING_DENSITY / cosines
    )
    density = np.maximum(M.mean(axis=-1), 0) / excess
    density[~density.any(axis=(2, 3))] = 1  # uniform for an incidence at which the BRDF is 0
    return AdaptiveTable(grid, M, density)


def build_parameterisation(f: Lookup, quarters: int, size: Resolution) -> Parameterisation:
    """Choose the directions at which the BRDF f is tabulated, as a `Parameterisation`.

    f repeats after this number of `quarters` of the circle, as `detect_symmetry` finds. `size` has
    the numbers of directions.
    """
    # Choose the directions of incidence
    phi_i = np.linspace(0, quarters * np.pi / 2, quarters * size.phi_i + 1)
    if quarters:
        phi_i -= np.pi
    theta_i = GRAZING * (1 - np.linspace(1, 0, size.theta_i) ** 1.5)  # dense near grazing angles
    # Choose the density of facets' normals: their distribution D plus a nearly uniform density
    ndf, sigma = _compute_microfacets(f, size)
    m = make_even_grid(size.grid)
    density = (interpolate(ndf[None], m) + _compute_even_density(m)) * solid_angle_per_area(m)
    # Weight the normals by their visibility from each incidence, and reduce the number of those
    # that reflect light below the surface
    wi, normals = from_angles(theta_i, phi_i[:, None]), from_angles(*map_from_square(m))
    cosines = wi @ normals.T
    height = 2 * cosines * normals[:, 2] - wi[..., 2:]  # cosine of the reflected direction wo
    visible = np.where(cosines > 0, cosines + GRAZING_DENSITY, 0)
    visible *= np.clip(1 + height / LARGEST_DEPTH, 0.02, 1)
    vndf = (visible * density).reshape(*cosines.shape[:2], size.grid, size.grid)
    return Parameterisation(phi_i, theta_i, ndf, sigma, vndf)


def detect_symmetry(f: Lookup) -> int:
    """Return after how many quarters of a turn about the normal the BRDF f repeats.

    The result is 0 if f is isotropic, 1 if f has the planes of symmetry x = 0 and y = 0, 2 if a
    half turn leaves f equal, otherwise 4. It is found by comparing f at 1,000 random pairs of
    directions that are rotated and mirrored.
    """
    theta_h, theta_d, phi_d, phi_h = np.random.default_rng(0).random((4, 1000))
    # Draw many half vectors near the normal, where lobes are narrow, but none so near that rounding
    # changes its azimuth
    theta_h = np.pi / 2 * (0.01 + 0.99 * theta_h) ** 3
    pairs = from_half_difference(theta_h, np.pi / 2 * theta_d, 2 * np.pi * phi_d, 2 * np.pi * phi_h)
    wi, wo = (w[(pairs[0][:, 2] > 0) & (pairs[1][:, 2] > 0)] for w in pairs)
    values = _evaluate_finite(f, wi, wo)

    def is_symmetric(matrix: FloatArray) -> bool:
        turned = _evaluate_finite(f, wi @ matrix, wo @ matrix)
        # 90 % of equal values suffice: where f interpolates scattered samples, rounding decides
        # which one of two samples at equal distances is the nearest
        return bool(np.isclose(turned, values, rtol=1e-4).all(axis=1).mean() > 0.9)

    if is_symmetric(np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])):
        return 0
    if is_symmetric(np.diag([1.0, -1, 1])) and is_symmetric(np.diag([-1.0, 1, 1])):
        return 1
    return 2 if is_symmetric(np.diag([-1.0, -1, 1])) else 4


def _compute_microfacets(f: Lookup, size: Resolution) -> list[FloatArray]:
    """Compute the distribution of facets' normals, and the facets' projected area, (y, x) each.

    They follow from the retro-reflection f(w, w) of the BRDF f.
    """
    theta = np.linspace(0, 1, size.theta_m) ** 2 * np.pi / 2
    hemisphere = Hemisphere(theta, size.phi_m)
    w = Hemisphere(np.minimum(theta, GRAZING), size.phi_m).directions.reshape(-1, 3)
    retro = np.maximum(_evaluate_finite(f, w, w).mean(axis=1).reshape(size.phi_m, -1), 0)
    even = np.full_like(retro, 1 / np.pi)
    D = find_normal_distribution(retro, hemisphere) if retro.any() else even
    D = (1 - EVEN_SHARE) * D + EVEN_SHARE * even
    return [np.concatenate([x, x[:1]]) for x in (D, hemisphere.projected_area(D))]


def _compute_even_density(m: FloatArray) -> FloatArray:
    """Return a density [sr⁻¹] at points `m` (n, 2) of the square of directions (`map_to_square`).

    It is uniform over the square except near the surface's normal. Added to the density D of the
    normals, it gives half of the grid's points to the slopes of a highlight, where D is small.
    """
    return 1 / (solid_angle_per_area(m) + INNERMOST)


def _evaluate_finite(f: Lookup, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Evaluate the BRDF f for directions (n, 3); raise `BrdfkitError` where it is not finite."""
    values = f(wi, wo)
    if not np.isfinite(values).all():
        row = np.argmin(np.isfinite(values).all(axis=1))
        theta_i, theta_o = np.degrees(np.arccos([wi[row, 2], wo[row, 2]]))
        raise BrdfkitError(
            f"its BRDF is not finite at theta_i {theta_i:.1f}°, theta_o {theta_o:.1f}°; mend it."
        )
    return values
