"""The adaptive parameterisation of a BRDF, in which an RGL `.bsdf` file stores it.

D is the distribution of the normals m of microfacets, and σ(wi) their area projected along the
direction wi of the light. Both determine which normals are visible from wi. Points u of the unit
square are warped to normals m so that the density of m follows that of the visible normals. The
view wo is wi reflected about m. Points of an even grid over u are thus dense where the surface
reflects much light. A file stores at these points

    M(wi, u) = f(wi, wo) cosθ_o · 4 σ(wi) / D(m),

where f is the BRDF and θ_o the angle of wo to the normal. M varies little if the surface is made of
microfacets.

[Dupuy & Jakob 2018] describe it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles, normalize, to_angles
from brdfkit.materials.formats.rgl.warp import (
    Slices,
    Warp,
    find_slices,
    interpolate,
    make_even_grid,
)


@dataclass(frozen=True, eq=False)
class Parameterisation:
    """The directions at which a BRDF is tabulated: incidences, and normals visible from each.

    `phi_i`, `theta_i`: azimuths (a,) and polar angles (b,) of incidence [rad]; `ndf`, `sigma`:
    distribution of normals D, and projected area σ, over the square of directions, (y, x), which
    `map_to_square` defines; `vndf`: density of the visible normals over this square, up to a
    factor, (a, b, y, x).

    With one or two `phi_i` the surface is isotropic, and azimuths on the square are relative to the
    azimuth of the light. More `phi_i` may span half or a quarter of the circle, if the BRDF is
    symmetric in the rest of it.
    """

    phi_i: FloatArray
    theta_i: FloatArray
    ndf: FloatArray
    sigma: FloatArray
    vndf: FloatArray

    @property
    def isotropic(self) -> bool:
        """Whether the BRDF does not change when the surface turns about its normal."""
        return len(self.phi_i) <= 2

    @property
    def symmetric_part_count(self) -> int:
        """The number of symmetric parts of the circle of azimuths, of which `phi_i` spans one."""
        return 1 if self.isotropic else round(2 * np.pi / (self.phi_i[-1] - self.phi_i[0]))

    @cached_property
    def warp_to_normals(self) -> Warp:
        """The warp of points u of the unit square to the visible normals m, for each incidence."""
        return Warp(self.vndf.reshape(-1, *self.vndf.shape[2:]))

    def compute_facet_factor(
        self, theta_i: FloatArray, phi_i: FloatArray, m: FloatArray
    ) -> FloatArray:
        """Return the factors (n,) that turn values M stored in the file into BRDF times cosθ_o.

        A factor is D(m) / 4σ(wi), where D is the distribution of normals m, and σ the projected
        area of microfacets. `theta_i` and `phi_i` [rad] are the angles of the light wi. `m` (n, 2)
        are the normals as points of the square of directions, which `map_to_square` defines.
        """
        wi = map_to_square(theta_i, phi_i)
        return interpolate(self.ndf[None], m) / (4 * interpolate(self.sigma[None], wi))

    def find_grid_points(
        self, wi: FloatArray, wo: FloatArray
    ) -> tuple[FloatArray, Slices, FloatArray]:
        """Return the points u (n, 2) of the unit square that stand for pairs of directions (n, 3).

        The directions must be above the surface. The other results are the slices of the table for
        the incidences, as `warp.find_slices` returns them, and the factors (n,) of
        `compute_facet_factor`.
        """
        wi, wo = self._fold_azimuths(wi, wo)
        theta_i, phi_i = to_angles(wi)
        theta_m, phi_m = to_angles(normalize(wi + wo))
        m = map_to_square(theta_m, phi_m - phi_i if self.isotropic else phi_m)
        m[:, 1] %= 1
        slices = find_slices((self.phi_i, self.theta_i), (phi_i, theta_i))
        return (
            self.warp_to_normals.invert(m, slices),
            slices,
            self.compute_facet_factor(theta_i, phi_i, m),
        )

    def reflect_light_on_grid(self, n: int) -> list[FloatArray]:
        """Return the results of `reflect_light` for all incidences, at a grid of n × n points u.

        The arrays have the shape (a, b, n, n, ...), for a azimuths and b polar angles of incidence.
        """
        a, b = self.vndf.shape[:2]
        arrays = self.reflect_light(np.broadcast_to(make_even_grid(n), (a * b, n * n, 2)))
        return [x.reshape(a, b, n, n, *x.shape[1:]) for x in arrays]

    def reflect_light(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Reflect the light of each incidence about the normals to which points `u` are warped.

        `u` (incidences, k, 2) has k points for each incidence, n in all. The results are wi and wo
        (n, 3), the normals' points on the square of directions (n, 2), and the factors of
        `compute_facet_factor` (n,). wo may lie below the surface.
        """
        incidences = np.meshgrid(self.phi_i, self.theta_i, indexing="ij")
        phi_i, theta_i = (angle.ravel().repeat(u.shape[1]) for angle in incidences)
        m = np.concatenate([self.warp_to_normals.sample(at, points) for at, points in enumerate(u)])

        theta_m, phi_m = map_from_square(m)
        normal = from_angles(theta_m, phi_m + phi_i if self.isotropic else phi_m)
        wi = from_angles(theta_i, phi_i)
        wo = 2 * np.sum(wi * normal, axis=1, keepdims=True) * normal - wi
        return wi, wo, m, self.compute_facet_factor(theta_i, phi_i, m)

    def _fold_azimuths(self, wi: FloatArray, wo: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rotate or mirror wi and wo (n, 3) so that wi lies in the stored part of the circle."""
        if self.symmetric_part_count < 2:
            return wi, wo
        sign_y = np.where(np.signbit(wi[:, 1]), 1, -1)
        sign_x = np.where(np.signbit(wi[:, 0]), 1, -1) if self.symmetric_part_count == 4 else sign_y
        turn = np.stack([sign_x, sign_y, np.ones_like(sign_x)], axis=1)
        return wi * turn, wo * turn


def map_to_square(theta: FloatArray, phi: FloatArray) -> FloatArray:
    """Map directions, given by angles [rad], to points (x, y) of the square of directions, (n, 2).

    On this unit square θ = x² π/2 and φ = (2y - 1) π.
    """
    return np.stack([np.sqrt(theta * 2 / np.pi), (phi + np.pi) / (2 * np.pi)], axis=-1)


def map_from_square(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles θ and φ [rad] of points (n, 2), the inverse of `map_to_square`."""
    return points[:, 0] ** 2 * np.pi / 2, (2 * points[:, 1] - 1) * np.pi


def solid_angle_per_area(points: FloatArray) -> FloatArray:
    """Return the solid angle per area [sr] at points (n, 2) of the square of `map_to_square`."""
    theta, _ = map_from_square(points)
    return 2 * np.pi**2 * points[:, 0] * np.sin(theta)
