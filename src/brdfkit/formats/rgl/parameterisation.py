"""The adaptive parameterisation of a BRDF: what an RGL `.bsdf` file holds.

From the distribution D of the normals m of microfacets, and their area σ(wi) projected along wi,
follows the distribution of the normals that wi sees. The unit square is warped to it, u → m, and
wi reflected about m is wo. So an even grid over u looks where the light goes. Stored is there

    M(wi, u) = f(wi, wo) cosθ_o · 4 σ(wi) / D(m),

which varies little as far as the surface is made of microfacets.

[Dupuy & Jakob 2018]; looked up as Mitsuba's plugin `measured` does.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from brdfkit.formats.rgl.warp import Warp, between, even_grid, interpolated
from brdfkit.geometry.directions import from_angles, normalize, to_angles

UP = np.array([0.0, 0.0, 1.0])
# Points (x, y) of the unit square, evenly
EVEN = np.stack([(np.arange(256) + 0.5) / 256, np.arange(256) * (np.sqrt(5) - 1) / 2 % 1], axis=1)
LEAST_COSINE = 1e-3  # nearer the horizon the cosine in f cosθ_o cannot be divided out


@dataclass(frozen=True, eq=False)
class Parameterisation:
    """Where a BRDF is tabulated.

    `phi_i` (a,), `theta_i` (b,): incidences [rad]; `ndf`, `sigma` (y, x): D and σ over the square
    of directions; `vndf` (a, b, y, x): density of the normals over it, up to a factor.

    On the square of directions (`to_square`) an isotropic surface, one with one or two phi_i, has
    φ_m - φ_i. More phi_i may span half or a quarter of the circle: the rest is symmetric.
    """

    phi_i: np.ndarray
    theta_i: np.ndarray
    ndf: np.ndarray
    sigma: np.ndarray
    vndf: np.ndarray

    @property
    def isotropic(self):
        """Whether the surface's azimuth does not count."""
        return len(self.phi_i) <= 2

    @property
    def parts(self):
        """Of how many parts of the circle phi_i spans one, the others being symmetric to it."""
        return 1 if self.isotropic else round(2 * np.pi / (self.phi_i[-1] - self.phi_i[0]))

    @cached_property
    def normals(self):
        """The warp u → m."""
        return Warp(self.vndf.reshape(-1, *self.vndf.shape[2:]))

    def facets(self, theta_i, phi_i, m):
        """D(m) / 4σ(wi) (n,), by which M becomes f cosθ_o; `m` (n, 2) on the square."""
        wi = to_square(theta_i, phi_i)
        return interpolated(self.ndf[None], m) / (4 * interpolated(self.sigma[None], wi))

    def locate(self, wi, wo):
        """Of pairs (n, 3) above the surface: u (n, 2), the incidences among the slices of a table
        (`warp.between`), and `facets` (n,)."""
        wi, wo = self._folded(wi, wo)
        theta_i, phi_i = to_angles(wi)
        theta_m, phi_m = to_angles(normalize(wi + wo))
        m = to_square(theta_m, phi_m - phi_i if self.isotropic else phi_m)
        m[:, 1] %= 1
        slices = between((self.phi_i, self.theta_i), (phi_i, theta_i))
        return self.normals.invert(m, slices), slices, self.facets(theta_i, phi_i, m)

    def grid(self, n):
        """`mirrored` at an even grid of n × n points u: the same, shaped (a, b, n, n, ...)."""
        incidences = self.vndf.shape[:2]
        found = self.mirrored(np.broadcast_to(even_grid(n), (np.prod(incidences), n * n, 2)))
        return [x.reshape(*incidences, n, n, *x.shape[1:]) for x in found]

    def mirrored(self, u):
        """At points u (a b, k, 2), as many of each incidence: wi, wo (n, 3), m on the square (n, 2)
        and `facets` (n,), where n is a b k. wo may lie below the surface."""
        incidences = np.meshgrid(self.phi_i, self.theta_i, indexing="ij")
        phi_i, theta_i = (angle.ravel().repeat(u.shape[1]) for angle in incidences)
        m = np.concatenate([self.normals.sample(at, points) for at, points in enumerate(u)])

        theta_m, phi_m = from_square(m)
        normal = from_angles(theta_m, phi_m + phi_i if self.isotropic else phi_m)
        wi = from_angles(theta_i, phi_i)
        wo = 2 * np.sum(wi * normal, axis=1, keepdims=True) * normal - wi
        return wi, wo, m, self.facets(theta_i, phi_i, m)

    def _folded(self, wi, wo):
        """The same pair, turned or mirrored to where phi_i has its nodes."""
        if self.parts < 2:
            return wi, wo
        sign_y = np.where(np.signbit(wi[:, 1]), 1, -1)
        sign_x = np.where(np.signbit(wi[:, 0]), 1, -1) if self.parts == 4 else sign_y
        turn = np.stack([sign_x, sign_y, np.ones_like(sign_x)], axis=1)
        return wi * turn, wo * turn


@dataclass(frozen=True, eq=False)
class Adaptive:
    """A BRDF over a `Parameterisation`, to be called with directions.

    `values` (a, b, y, x, channels): M over u, or f cosθ_o itself where not `divided`; `density`
    (a, b, y, x): over u, by which to draw from it, up to a factor.
    """

    over: Parameterisation
    values: np.ndarray
    density: np.ndarray
    divided: bool = True

    def __call__(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of directions (n, 3), as stored: it may be negative.

        0 below the surface.
        """
        above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        wi, wo = (np.where(above, w, UP) for w in (wi, wo))
        u, slices, facets = self.over.locate(wi, wo)
        f_cos = interpolated(self.values.reshape(-1, *self.values.shape[2:]), u, slices)
        if self.divided:
            f_cos *= facets[:, None]
        return np.where(above, f_cos / wo[:, 2:], 0.0)

    def mixed(self, weights):
        """The BRDF in other channels, the old ones mixed by `weights` (old, new)."""
        return replace(self, values=self.values @ weights)

    def albedo(self):
        """∫ f cosθ_o dω_o (a, b, channels) at the incidences: the mean weight of even samples."""
        a, b, n, _ = self.density.shape
        drawn = Warp(self.density.reshape(-1, n, n))
        u = np.stack([drawn.sample(at, EVEN) for at in range(a * b)])
        wi, wo, m, facets = self.over.mirrored(u)
        u, slices = u.reshape(-1, 2), [(np.arange(a * b).repeat(len(EVEN)), 1.0)]
        f_cos = interpolated(self.values.reshape(-1, n, n, self.values.shape[-1]), u, slices)
        if self.divided:
            f_cos *= facets[:, None]
        pdf = drawn.pdf(u, slices) * self.over.normals.pdf(m, slices)
        area = solid_angle(m) * 2 * np.linalg.norm(wi + wo, axis=1)
        lit = (wo[:, 2] > 0) & (pdf > 0)
        weight = np.divide(area, pdf, out=np.zeros_like(pdf), where=lit)
        light = np.maximum(f_cos, 0) * weight[:, None]
        return light.reshape(a, b, len(EVEN), -1).mean(axis=2)

    def scene_dict(self):
        """The dictionary for `mitsuba.load_dict`; wavelengths are left to who knows them."""
        import mitsuba as mi

        arrays = {field.name: getattr(self.over, field.name) for field in fields(self.over)}
        arrays |= {"values": self.values, "density": self.density, "albedo": self.albedo()}
        tensors = {n: mi.TensorXf(np.ascontiguousarray(a, np.float32)) for n, a in arrays.items()}
        flags = {"isotropic": self.over.isotropic, "divided": self.divided}
        return {"type": "measured_adaptive", **tensors, **flags, "parts": self.over.parts}

    def at_grid(self):
        """The stored points: wi, wo (n, 3) and the BRDF (n, channels), NaN below the surface, at
        the horizon and where D is 0."""
        wi, wo, _, facets = self.over.grid(self.values.shape[2])
        known = (np.minimum(wi, wo)[..., 2] > LEAST_COSINE) & (facets > 0)
        factor = facets[known] if self.divided else 1.0
        values = np.full(self.values.shape, np.nan)
        values[known] = self.values[known] * (factor / wo[known][:, 2])[:, None]
        return wi.reshape(-1, 3), wo.reshape(-1, 3), values.reshape(-1, values.shape[-1])


def to_square(theta, phi):
    """The points (n, 2), (x, y), of directions [rad]: θ = x² π/2, φ = (2y - 1) π."""
    return np.stack([np.sqrt(theta * 2 / np.pi), (phi + np.pi) / (2 * np.pi)], axis=-1)


def from_square(points):
    """θ and φ [rad] of points (n, 2) of the square."""
    return points[:, 0] ** 2 * np.pi / 2, (2 * points[:, 1] - 1) * np.pi


def solid_angle(points):
    """dm/dx dy [sr] at points (n, 2) of the square."""
    theta, _ = from_square(points)
    return 2 * np.pi**2 * points[:, 0] * np.sin(theta)
