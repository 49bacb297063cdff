"""Looks up and samples a BRDF in RGL's adaptive parameterisation within Mitsuba.

The folder `materials/formats/rgl/` explains it (`parameterisation.py`), and evaluates it in NumPy
(`adaptive_table.py`). Here Mitsuba's own distributions warp the unit square of stored values to
half vectors, and interpolate between the stored incidences.

[Dupuy & Jakob 2018]
"""

from collections.abc import Iterator
from typing import Any

import drjit as dr

from brdfkit.core.array_types import AnyArray, JitFloat, JitInt, JitVector, MitsubaObject
from brdfkit.core.geometry import multilinear
from brdfkit.core.geometry.vectors import cos_theta_d, half_vector, reflect
from brdfkit.mitsuba_bridge.arrays import Nodes, find_bracket

# The least coordinate x of a half vector on the unit square; at 0 its density is infinite
LEAST_X = 1e-4


class AdaptiveLookup:
    """Finds the stored values around a direction pair and samples the BRDF, in the current variant.

    The arguments are attributes of the BRDF's `Parameterisation` and of its `AdaptiveTable`:

    - `phi_i` (a,), `theta_i` (b,): azimuths and polar angles of the stored incidences [rad]
    - `ndf`, `sigma` (y, x): distribution of normals and projected area, on a square of directions
    - `vndf` (a, b, y, x): density of the normals visible from each incidence, on the same square
    - `isotropic`, `parts`: the symmetry, as in `Parameterisation`
    - `density` (a, b, n, n): density on the square of stored values, to draw directions
    - `divided`: whether the stored values are f cosθ_o divided by the factor of `ndf` and `sigma`
    """

    def __init__(
        self,
        phi_i: AnyArray,
        theta_i: AnyArray,
        ndf: AnyArray,
        sigma: AnyArray,
        vndf: AnyArray,
        density: AnyArray,
        isotropic: bool,
        parts: int,
        divided: bool,
    ) -> None:
        import mitsuba as mi

        self.isotropic, self.parts, self.divided = isotropic, parts, divided
        self.nodes, self.n = (Nodes(phi_i), Nodes(theta_i)), density.shape[-1]
        plain: dict[str, Any] = {"normalize": False, "enable_sampling": False}
        self.ndf, self.sigma = (mi.MarginalContinuous2D0(x, **plain) for x in (ndf, sigma))
        angles = [phi_i.tolist(), theta_i.tolist()]
        self.normals: Any = mi.MarginalContinuous2D2(vndf, angles)
        self.density: Any = mi.MarginalContinuous2D2(density, angles)

    def find_incidences(self, wi: JitVector) -> list[tuple[JitInt, JitFloat]]:
        """Return (index, share) of the stored incidences around `wi`; the shares add up to 1."""
        angles = self._incident_angles(self._fold_azimuth(wi, wi))
        axes = [(nodes, x) for nodes, x in zip(self.nodes, angles, strict=True) if nodes.count > 1]
        brackets, shape = [nodes.find_bracket(x) for nodes, x in axes], [n.count for n, _ in axes]
        return [
            (multilinear.to_flat_index(at, shape), t)
            for at, t in multilinear.list_corners(brackets)
        ]

    def find_corners(self, wi: JitVector, wo: JitVector) -> Iterator[tuple[JitInt, JitFloat]]:
        """Yield (row, factor) of stored values; the BRDF is the sum of factor times value.

        A row is an index among the stored values of all incidences, a · b · n · n numbers.
        """
        incidences = self.find_incidences(wi)
        wi, wo = self._fold_azimuth(wi, wi), self._fold_azimuth(wo, wi)
        m, u, _ = self._find_half_vector(wi, wo)
        factor = 1 / wo.z
        if self.divided:
            phi_i, theta_i = self._incident_angles(wi)
            factor *= self.ndf.eval(m) / (4 * self.sigma.eval(_to_unit_square(theta_i, phi_i)))
        n = self.n
        for cell, share in multilinear.list_corners(
            [find_bracket(x * (n - 1), n) for x in (u.y, u.x)]
        ):
            for incidence, weight in incidences:
                yield (
                    incidence * n * n + multilinear.to_flat_index(cell, (n, n)),
                    weight * share * factor,
                )

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw a direction, possibly below the surface, from the random numbers u.x and u.y."""
        import mitsuba as mi

        folded = self._fold_azimuth(wi, wi)
        angles = self._incident_angles(folded)
        # Draw a point on the square of stored values, and warp it to the square of directions
        point, _ = self.density.sample(mi.Point2f(u.x, u.y), angles)
        m, _ = self.normals.sample(point, angles)
        sin_theta, cos_theta = dr.sincos(m.x * m.x * (dr.pi / 2))
        phi_m = (2 * m.y - 1) * dr.pi
        sin_phi, cos_phi = dr.sincos(phi_m + angles[0] if self.isotropic else phi_m)
        normal = type(wi)(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
        return self._fold_azimuth(reflect(folded, normal), wi)

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the density, per solid angle, with which `sample` draws `wo`."""
        wi, wo = self._fold_azimuth(wi, wi), self._fold_azimuth(wo, wi)
        m, u, density = self._find_half_vector(wi, wo)
        density *= self.density.eval(u, self._incident_angles(wi))
        # The solid angle of half vectors per area on the square of directions
        solid_angle = 2 * dr.pi**2 * m.x * dr.sin(m.x * m.x * (dr.pi / 2))
        return density / (solid_angle * 4 * cos_theta_d(wi, wo))

    def _find_half_vector(
        self, wi: JitVector, wo: JitVector
    ) -> tuple[MitsubaObject, MitsubaObject, JitFloat]:
        """Return (m, u, density) of a direction pair that `_fold_azimuth` has transformed.

        m is the half vector as a point in the unit square of directions, u the point in the unit
        square of stored values that is warped to m, and density that of the warp at m.
        """
        import mitsuba as mi

        angles, h = self._incident_angles(wi), half_vector(wi, wo)
        phi_m = dr.atan2(h.y, h.x)
        m = _to_unit_square(_polar_angle(h), phi_m - angles[0] if self.isotropic else phi_m)
        m = mi.Point2f(dr.maximum(m.x, LEAST_X), m.y - dr.floor(m.y))
        return m, *self.normals.invert(m, angles)

    def _incident_angles(self, wi: JitVector) -> list[JitFloat]:
        """Return [phi_i, theta_i] of a direction within the stored azimuths."""
        phi_i = dr.atan2(wi.y, wi.x)
        # Azimuths of a part of the circle begin at -π, for which atan2 may give π
        return [phi_i if self.parts < 2 else -dr.abs(phi_i), _polar_angle(wi)]

    def _fold_azimuth(self, w: JitVector, wi: JitVector) -> JitVector:
        """Return `w` after the rotation or reflection that brings `wi` to the stored azimuths.

        The transformation is its own inverse.
        """
        if self.parts < 2:
            return w
        sign_y = dr.select(wi.y < 0, 1, -1)
        sign_x = dr.select(wi.x < 0, 1, -1) if self.parts == 4 else sign_y
        return type(w)(w.x * sign_x, w.y * sign_y, w.z)


def _polar_angle(w: JitVector) -> JitFloat:
    """Return the polar angle [rad], eight times as exact in single precision as by `dr.atan2`."""
    return 2 * dr.safe_asin(0.5 * dr.norm(w - type(w)(0, 0, 1)))


def _to_unit_square(theta: JitFloat, phi: JitFloat) -> MitsubaObject:
    """Return the point (x, y) of the unit square for θ = x² π/2 and φ = (2y - 1) π [rad]."""
    import mitsuba as mi

    return mi.Point2f(dr.sqrt(theta * (2 / dr.pi)), (phi + dr.pi) / (2 * dr.pi))
