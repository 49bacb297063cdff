"""The adaptive parameterisation of a BRDF, which an RGL `.bsdf` file holds.

D is the distribution of the normals m of microfacets, and σ(wi) their area projected along the
direction wi of the light. They determine the distribution of the normals that are visible from wi.
A warp of points u of the unit square follows this distribution, and the view wo is wi reflected
about m. So an even grid over u has its points where the light goes. A file stores at these points

    M(wi, u) = f(wi, wo) cosθ_o · 4 σ(wi) / D(m),

where f is the BRDF and θ_o the angle of wo to the normal. M varies little if the surface is made of
microfacets.

[Dupuy & Jakob 2018] describe it; the lookup agrees with Mitsuba's plugin `measured`.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles, normalize, to_angles
from brdfkit.materials.formats.rgl.warp import Slices, Warp, even_grid, find_slices, interpolate

UP = np.array([0.0, 0.0, 1.0])
# 256 points (x, y) spread evenly over the unit square, a Fibonacci lattice
LATTICE = np.stack(
    [(np.arange(256) + 0.5) / 256, np.arange(256) * (np.sqrt(5) - 1) / 2 % 1], axis=1
)
LEAST_COSINE = 1e-3  # f cosθ_o is not divided by a smaller cosine


@dataclass(frozen=True, eq=False)
class Parameterisation:
    """The directions at which a BRDF is tabulated.

    `phi_i` (a,), `theta_i` (b,): incidences [rad]; `ndf`, `sigma` (y, x): D and σ over the square
    of directions (`to_square`); `vndf` (a, b, y, x): the density of the visible normals over this
    square, up to a factor.

    A surface with one or two phi_i is isotropic: the azimuth on the square is then φ_m - φ_i. If
    there are more, they may span half or a quarter of the circle, and the other parts are symmetric
    to it.
    """

    phi_i: FloatArray
    theta_i: FloatArray
    ndf: FloatArray
    sigma: FloatArray
    vndf: FloatArray

    @property
    def isotropic(self) -> bool:
        """Whether the BRDF stays as it is when the surface turns about its normal."""
        return len(self.phi_i) <= 2

    @property
    def parts(self) -> int:
        """The number of symmetric parts of the circle; phi_i spans one of them."""
        return 1 if self.isotropic else round(2 * np.pi / (self.phi_i[-1] - self.phi_i[0]))

    @cached_property
    def normals(self) -> Warp:
        """The warp from u to the visible normals m."""
        return Warp(self.vndf.reshape(-1, *self.vndf.shape[2:]))

    def facet_factor(self, theta_i: FloatArray, phi_i: FloatArray, m: FloatArray) -> FloatArray:
        """Return D(m) / 4σ(wi) (n,); M times this factor is f cosθ_o.

        wi has the angles `theta_i`, `phi_i` [rad]; `m` (n, 2) are normals on the square.
        """
        wi = to_square(theta_i, phi_i)
        return interpolate(self.ndf[None], m) / (4 * interpolate(self.sigma[None], wi))

    def locate(self, wi: FloatArray, wo: FloatArray) -> tuple[FloatArray, Slices, FloatArray]:
        """Return u (n, 2) of direction pairs (n, 3) above the surface.

        The other results are the slices of the incidences (`warp.find_slices`) and the
        `facet_factor` (n,).
        """
        wi, wo = self._fold(wi, wo)
        theta_i, phi_i = to_angles(wi)
        theta_m, phi_m = to_angles(normalize(wi + wo))
        m = to_square(theta_m, phi_m - phi_i if self.isotropic else phi_m)
        m[:, 1] %= 1
        slices = find_slices((self.phi_i, self.theta_i), (phi_i, theta_i))
        return self.normals.invert(m, slices), slices, self.facet_factor(theta_i, phi_i, m)

    def reflect_grid(self, n: int) -> list[FloatArray]:
        """Return the arrays of `reflect` at an even grid of n × n points u.

        Their shape is (a, b, n, n, ...).
        """
        a, b = self.vndf.shape[:2]
        arrays = self.reflect(np.broadcast_to(even_grid(n), (a * b, n * n, 2)))
        return [x.reshape(a, b, n, n, *x.shape[1:]) for x in arrays]

    def reflect(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Reflect the light about the normals at points `u` (a b, k, 2): wi and wo (n, 3).

        `u` has k points for each incidence; n is a b k. The other results are the normals m on the
        square (n, 2) and the `facet_factor` (n,). wo may lie below the surface.
        """
        incidences = np.meshgrid(self.phi_i, self.theta_i, indexing="ij")
        phi_i, theta_i = (angle.ravel().repeat(u.shape[1]) for angle in incidences)
        m = np.concatenate([self.normals.sample(at, points) for at, points in enumerate(u)])

        theta_m, phi_m = from_square(m)
        normal = from_angles(theta_m, phi_m + phi_i if self.isotropic else phi_m)
        wi = from_angles(theta_i, phi_i)
        wo = 2 * np.sum(wi * normal, axis=1, keepdims=True) * normal - wi
        return wi, wo, m, self.facet_factor(theta_i, phi_i, m)

    def _fold(self, wi: FloatArray, wo: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rotate or mirror direction pairs into the part of the circle that phi_i spans."""
        if self.parts < 2:
            return wi, wo
        sign_y = np.where(np.signbit(wi[:, 1]), 1, -1)
        sign_x = np.where(np.signbit(wi[:, 0]), 1, -1) if self.parts == 4 else sign_y
        turn = np.stack([sign_x, sign_y, np.ones_like(sign_x)], axis=1)
        return wi * turn, wo * turn


@dataclass(frozen=True, eq=False)
class AdaptiveTable:
    """A BRDF that is tabulated in a `Parameterisation`: a function of directions.

    `values` (a, b, y, x, channels): M over u, or f cosθ_o if not `divided`; `density` (a, b, y, x):
    the density over u from which directions are drawn, up to a factor.
    """

    parameterisation: Parameterisation
    values: FloatArray
    density: FloatArray
    divided: bool = True

    def __call__(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the BRDF [sr⁻¹] (n, channels) of directions (n, 3), 0 below the surface.

        Where stored values are negative, so is the BRDF.
        """
        above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        wi, wo = (np.where(above, w, UP) for w in (wi, wo))
        u, slices, factor = self.parameterisation.locate(wi, wo)
        f_cos = interpolate(self.values.reshape(-1, *self.values.shape[2:]), u, slices)
        if self.divided:
            f_cos *= factor[:, None]
        return np.where(above, f_cos / wo[:, 2:], 0.0)

    def mix_channels(self, weights: FloatArray) -> "AdaptiveTable":
        """Return the BRDF in other channels, mixed from the old ones by `weights` (old, new)."""
        return replace(self, values=self.values @ weights)

    def albedo(self) -> FloatArray:
        """Return the albedo ∫ f cosθ_o dω_o (a, b, channels) at the incidences.

        It is found by importance sampling, with 256 directions for each incidence.
        """
        # Directions drawn by the density over u
        a, b, n, _ = self.density.shape
        warp = Warp(self.density.reshape(-1, n, n))
        u = np.stack([warp.sample(at, LATTICE) for at in range(a * b)])
        wi, wo, m, factor = self.parameterisation.reflect(u)
        # f cosθ_o there
        u, slices = u.reshape(-1, 2), [(np.arange(a * b).repeat(len(LATTICE)), 1.0)]
        f_cos = interpolate(self.values.reshape(-1, n, n, self.values.shape[-1]), u, slices)
        if self.divided:
            f_cos *= factor[:, None]
        # The densities of both warps, and the solid angle dω_o of an area on the square
        pdf = warp.pdf(u, slices) * self.parameterisation.normals.pdf(m, slices)
        area = solid_angle(m) * 2 * np.linalg.norm(wi + wo, axis=1)
        lit = (wo[:, 2] > 0) & (pdf > 0)
        weight = np.divide(area, pdf, out=np.zeros_like(pdf), where=lit)
        light = np.maximum(f_cos, 0) * weight[:, None]
        return light.reshape(a, b, len(LATTICE), -1).mean(axis=2)

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`, without a spectral BRDF's wavelengths."""
        import mitsuba as mi

        grid = self.parameterisation
        arrays = {field.name: getattr(grid, field.name) for field in fields(grid)}
        arrays |= {"values": self.values, "density": self.density, "albedo": self.albedo()}
        tensors = {n: mi.TensorXf(np.ascontiguousarray(a, np.float32)) for n, a in arrays.items()}
        flags = {"isotropic": grid.isotropic, "divided": self.divided}
        return {"type": "measured_adaptive", **tensors, **flags, "parts": grid.parts}

    def stored_extents(self, max_angle: float, usable: BoolArray) -> FloatArray:
        """Return the extents (n, 2) of the stored points, in the order of `stored_samples`.

        `model/samples/measures.py` explains extents; here they are of the directions with both
        angles below `max_angle` [degrees]. `usable` is a mask (n,) of the points that count.

        A cell of the grid over u is split among its usable corners. At its
        middle m, dω_h = dm and dω_d = dω_i, so that dθ_h dθ_d dφ_d = dθ_m dφ_m · sinθ_i dθ_i /
        sinθ_d.
        """
        grid, n = self.parameterisation, self.values.shape[2]
        a, b = grid.vndf.shape[:2]
        middles = (even_grid(n - 1) * (n - 2) + 0.5) / (n - 1)
        wi, wo, m, _ = grid.reflect(np.broadcast_to(middles, (a * b, *middles.shape)))
        slices = [(np.arange(a * b).repeat(len(middles)), 1.0)]
        pdf = grid.normals.pdf(m, slices) * (n - 1) ** 2
        # dθ_m dφ_m = 2π² x dx dy
        area = np.divide(2 * np.pi**2 * m[:, 0], pdf, out=np.zeros_like(pdf), where=pdf > 0)
        area[wo[:, 2] <= np.cos(np.radians(max_angle))] = 0
        # Each incidence stands for a band of θ_i, and for its share of the azimuths
        edges = np.concatenate([[0.0], (grid.theta_i[1:] + grid.theta_i[:-1]) / 2])
        edges = np.append(edges, 2 * grid.theta_i[-1] - edges[-1]).clip(0, np.radians(max_angle))
        shares = np.ones(a) if a < 3 else np.pad(np.ones(a - 2), 1, constant_values=0.5)
        bands = np.outer(shares / shares.sum(), -np.diff(np.cos(edges))).ravel()
        area *= bands.repeat(len(middles))
        cos_d = np.linalg.norm(wi + wo, axis=1) / 2
        sin_d = np.sqrt(np.maximum(1 - cos_d**2, 0))
        # No cell is nearer to the retro-reflection, where sinθ_d = 0, than its own size
        least = np.tile(np.diff(edges), a).repeat(len(middles)) / 4
        theta_m, _ = from_square(m)
        cells = np.stack([area / np.maximum(sin_d, least), area * np.sin(theta_m) * cos_d], axis=1)
        usable = usable.reshape(a * b, n, n, 1)
        ends = slice(None, -1), slice(1, None)
        places = [(slice(None), y, x) for y in ends for x in ends]
        counts = sum(usable[place].astype(int) for place in places)
        cells = cells.reshape(a * b, n - 1, n - 1, 2) / np.maximum(counts, 1)
        corners = np.zeros((a * b, n, n, 2))
        for place in places:
            corners[place] += cells
        return (corners * usable).reshape(-1, 2)

    def stored_samples(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return wi, wo (n, 3) and the BRDF [sr⁻¹] (n, channels) at the stored points.

        The BRDF is NaN below the surface, at the horizon and where D is 0.
        """
        wi, wo, _, factor = self.parameterisation.reflect_grid(self.values.shape[2])
        known = (np.minimum(wi, wo)[..., 2] > LEAST_COSINE) & (factor > 0)
        scale = (factor[known] if self.divided else 1.0) / wo[known][:, 2]
        values: FloatArray = np.full(self.values.shape, np.nan)
        values[known] = self.values[known] * scale[:, None]
        return wi.reshape(-1, 3), wo.reshape(-1, 3), values.reshape(-1, values.shape[-1])


def to_square(theta: FloatArray, phi: FloatArray) -> FloatArray:
    """Return the points (x, y) of directions [rad] on the unit square, as (n, 2).

    There θ = x² π/2 and φ = (2y - 1) π.
    """
    return np.stack([np.sqrt(theta * 2 / np.pi), (phi + np.pi) / (2 * np.pi)], axis=-1)


def from_square(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return θ and φ [rad] of points (n, 2) of the square."""
    return points[:, 0] ** 2 * np.pi / 2, (2 * points[:, 1] - 1) * np.pi


def solid_angle(points: FloatArray) -> FloatArray:
    """Return the solid angle per area of the square, dm/dx dy [sr], at points (n, 2)."""
    theta, _ = from_square(points)
    return 2 * np.pi**2 * points[:, 0] * np.sin(theta)
