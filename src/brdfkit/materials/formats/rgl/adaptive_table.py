"""`AdaptiveTable`: a BRDF tabulated in the adaptive parameterisation, which can be evaluated.

The lookup agrees with Mitsuba's plugin `measured`.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.materials.formats.rgl.parameterisation import (
    Parameterisation,
    map_from_square,
    solid_angle_per_area,
)
from brdfkit.materials.formats.rgl.warp import Warp, interpolate, make_even_grid

UP = np.array([0.0, 0.0, 1.0])
# 256 points (x, y) of a Fibonacci lattice, which are spread evenly over the unit square
LATTICE = np.stack(
    [(np.arange(256) + 0.5) / 256, np.arange(256) * (np.sqrt(5) - 1) / 2 % 1], axis=1
)
LEAST_COSINE = 1e-3  # stored directions with a smaller cosine to the normal have no known BRDF


@dataclass(frozen=True, eq=False)
class AdaptiveTable:
    """A BRDF function that interpolates values tabulated in the adaptive parameterisation.

    `parameterisation`: directions of the table, with a azimuths and b polar angles of incidence,
    and for each incidence a grid of points u of the unit square, which stand for views; `values`:
    stored values at these points, (a, b, y, x, channels); `density`: density over u, up to a
    factor, from which Mitsuba draws directions, (a, b, y, x); `divided`: whether the values are
    f cosθ_o, where f is the BRDF, divided by `compute_facet_factor`, or else f cosθ_o itself.
    """

    parameterisation: Parameterisation
    values: FloatArray
    density: FloatArray
    divided: bool = True

    def __call__(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the BRDF [sr⁻¹] (n, channels) for wi and wo (n, 3); it is 0 below the surface.

        It is negative where the stored values are.
        """
        above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        wi, wo = (np.where(above, w, UP) for w in (wi, wo))
        u, slices, factor = self.parameterisation.find_grid_points(wi, wo)
        f_cos = interpolate(self.values.reshape(-1, *self.values.shape[2:]), u, slices)
        if self.divided:
            f_cos *= factor[:, None]
        return np.where(above, f_cos / wo[:, 2:], 0.0)

    def mix_channels(self, weights: FloatArray) -> "AdaptiveTable":
        """Return the BRDF in new channels, mixed from the old ones by `weights` (old, new)."""
        return replace(self, values=self.values @ weights)

    def albedo(self) -> FloatArray:
        """Compute the directional albedo ∫ f cosθ_o dω_o (a, b, channels) of each incidence.

        Importance sampling with 256 directions estimates it; the renderer needs it.
        """
        # Draw points u of the unit square by their density, and find the directions they stand for
        a, b, n, _ = self.density.shape
        warp = Warp(self.density.reshape(-1, n, n))
        u = np.stack([warp.sample(at, LATTICE) for at in range(a * b)])
        wi, wo, m, factor = self.parameterisation.reflect_light(u)
        # Evaluate f cosθ_o, where f is the BRDF, for these directions
        u, slices = u.reshape(-1, 2), [(np.arange(a * b).repeat(len(LATTICE)), 1.0)]
        f_cos = interpolate(self.values.reshape(-1, n, n, self.values.shape[-1]), u, slices)
        if self.divided:
            f_cos *= factor[:, None]
        # Divide by the density of the directions per solid angle dω_o: the product of the densities
        # of both warps, converted from an area of the square of directions
        pdf = warp.pdf(u, slices) * self.parameterisation.warp_to_normals.pdf(m, slices)
        area = solid_angle_per_area(m) * 2 * np.linalg.norm(wi + wo, axis=1)
        lit = (wo[:, 2] > 0) & (pdf > 0)
        weight = np.divide(area, pdf, out=np.zeros_like(pdf), where=lit)
        light = np.maximum(f_cos, 0) * weight[:, None]
        return light.reshape(a, b, len(LATTICE), -1).mean(axis=2)

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary from which `mitsuba.load_dict` makes the BSDF.

        For a spectral BRDF the caller adds the wavelengths.
        """
        import mitsuba as mi

        grid = self.parameterisation
        arrays = {field.name: getattr(grid, field.name) for field in fields(grid)}
        arrays |= {"values": self.values, "density": self.density, "albedo": self.albedo()}
        tensors = {n: mi.TensorXf(np.ascontiguousarray(a, np.float32)) for n, a in arrays.items()}
        flags = {"isotropic": grid.isotropic, "divided": self.divided}
        return {"type": "measured_adaptive", **tensors, **flags, "parts": grid.symmetric_part_count}

    def compute_stored_extents(self, max_angle: float, usable: BoolArray) -> FloatArray:
        """Return the extents (n, 2) of the stored points: the share of directions each stands for.

        `model/samples/measures.py` defines the two measures. Only directions with both angles to
        the normal below `max_angle` [degrees] count, and only points where the mask `usable` (n,)
        is True, in the order of `compute_stored_samples`.

        Each cell of the grid of stored points is split among its usable corners. The normal m at
        its middle is the half vector, so that dω_h = dm and dω_d = dω_i. In angles this is
        dθ_h dθ_d dφ_d = dθ_m dφ_m · sinθ_i dθ_i / sinθ_d.
        """
        grid, n = self.parameterisation, self.values.shape[2]
        a, b = grid.vndf.shape[:2]
        middles = (make_even_grid(n - 1) * (n - 2) + 0.5) / (n - 1)
        wi, wo, m, _ = grid.reflect_light(np.broadcast_to(middles, (a * b, *middles.shape)))
        slices = [(np.arange(a * b).repeat(len(middles)), 1.0)]
        pdf = grid.warp_to_normals.pdf(m, slices) * (n - 1) ** 2
        # Compute the areas dθ_m dφ_m of the cells, which are 2π² x dx dy for the normals' points
        # (x, y) on the square of directions
        area = np.divide(2 * np.pi**2 * m[:, 0], pdf, out=np.zeros_like(pdf), where=pdf > 0)
        area[wo[:, 2] <= np.cos(np.radians(max_angle))] = 0
        # Multiply by the band of polar angles θ_i, and the share of azimuths, that each incidence
        # stands for
        edges = np.concatenate([[0.0], (grid.theta_i[1:] + grid.theta_i[:-1]) / 2])
        edges = np.append(edges, 2 * grid.theta_i[-1] - edges[-1]).clip(0, np.radians(max_angle))
        shares = np.ones(a) if a < 3 else np.pad(np.ones(a - 2), 1, constant_values=0.5)
        bands = np.outer(shares / shares.sum(), -np.diff(np.cos(edges))).ravel()
        area *= bands.repeat(len(middles))
        cos_d = np.linalg.norm(wi + wo, axis=1) / 2
        sin_d = np.sqrt(np.maximum(1 - cos_d**2, 0))
        # Give sinθ_d, by which areas are divided, a lower bound of the cell's size: at the
        # retro-reflection it is 0
        least = np.tile(np.diff(edges), a).repeat(len(middles)) / 4
        theta_m, _ = map_from_square(m)
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

    def compute_stored_samples(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the directions wi, wo (n, 3) of the stored points, and the BRDF [sr⁻¹] there.

        The BRDF (n, channels) is NaN below the surface, at the horizon, and where the distribution
        of normals is 0.
        """
        wi, wo, _, factor = self.parameterisation.reflect_light_on_grid(self.values.shape[2])
        known = (np.minimum(wi, wo)[..., 2] > LEAST_COSINE) & (factor > 0)
        scale = (factor[known] if self.divided else 1.0) / wo[known][:, 2]
        values: FloatArray = np.full(self.values.shape, np.nan)
        values[known] = self.values[known] * scale[:, None]
        return wi.reshape(-1, 3), wo.reshape(-1, 3), values.reshape(-1, values.shape[-1])
